#pragma once
// What is taken from the live profile by hand: only from a picture of now, and only where the spot was taught.

#include <memory>

#include "widgets/desk/desk.h"

namespace seamwright {

// The sensor's newest profile. Error (device): there is none, or it is older than kStale.
Expected<std::shared_ptr<const LiveSnapshot>> live_profile(Desk& desk, const std::string& sensor_id);

// Error (device, input): the spot's robot tells no pose, moves for a job, or stands more than kAtSpotMm or kAtSpotDeg off
// the spot's pose.
inline constexpr double kAtSpotMm = 0.5, kAtSpotDeg = 0.1;
Expected<void> stands_at(Desk& desk, const Spot& spot);

// `spot`, of the kind template, with the landmark that lies at `at_mm` (sensor frame x, z) where its template is found in
// `seen` (filtered):
//     template_reference' = template_reference + R(-phi) (at - found),
// so that a part that is displaced now carries it along. Error (input): the template is not found there.
Expected<Spot> with_landmark(const Spot& spot, const Profile& seen, const Eigen::Vector2d& at_mm);

}  // namespace seamwright
