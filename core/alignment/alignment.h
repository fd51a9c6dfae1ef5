#pragma once
// The frozen contour (methods.md 4; thesis 5.2.1): does the contour stand still while the robot passes the spot?

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/correction/correction.h"
#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

// One profile of the pass, at `travel_mm` along the sensor's +Y; 0 = trigger position.
struct TravelProfile {
    double travel_mm = 0;
    Profile profile;
};

struct AlignmentOptions {
    double jitter_mm = 5.0;        // half width of the trigger jitter
    double tolerance_mm = 0.05;    // error that the jitter may cause at most
    double window_mm = 20.0;       // profiles beyond this travel are not judged
};

enum class AlignmentStatus { frozen, drifting, shape_changes, not_enough_profiles };
std::string_view to_string(AlignmentStatus status);

// Registration of each profile to that of the trigger position.
struct TravelOffset {
    double travel_mm = 0, dx_mm = 0, dz_mm = 0, dphi_deg = 0, rms_mm = 0;
    bool ok = false;
};

struct AlignmentResult {
    AlignmentStatus status = AlignmentStatus::not_enough_profiles;
    // Misalignment of the travel against the contour: yaw about the sensor's Z from dx/dy, pitch about X from dz/dy, roll
    // about Y (change of phi over 1 mm of travel times the jitter, i.e. twist).
    double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
    double dx_mm_per_mm = 0, dz_mm_per_mm = 0;
    double sigma_yaw_deg = 0, sigma_pitch_deg = 0;
    double radius_mm = 0;            // of the contour's curvature over the travel; infinity when straight within noise
    double expected_error_mm = 0;    // from jitter and slope (and curvature) at this spot
    double shape_change_mm = 0;      // what remains after rigid registration
    ContourCurve curve;              // for the correction, see correction.h
    std::vector<TravelOffset> offsets;
    std::string cure;                // "rotate the sensor about Z by -0.6 degrees"
};

Expected<AlignmentResult> check_alignment(std::span<const TravelProfile> pass, const AlignmentOptions& options);

}  // namespace seamwright
