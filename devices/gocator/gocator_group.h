#pragma once
// What a Gocator sends of one exposure, message by message: stamps, profiles, their intensities.
//
// A job's tools may send contours of their own in the same messages: cleaned, aligned, cut out. The sensor's contour is the
// one of its profile step; data whose step is not said stand for it where there is no other. Two that stand equally well cannot
// be told apart, and the exposure is worth nothing.

#include <vector>

#include "core/profile/profile.h"
#include "devices/gocator/gdp_message.h"

namespace seamwright {

class GocatorGroup {
  public:
    // `source`: whose profiles are taken (gdp::Profiles::source).
    void take(const gdp::Message& message, int source);
    // A message that cannot be read, two contours, or not a stamp for each profile.
    bool unclear() const { return broken_ || (!profiles.empty() && stamps.size() != profiles.size()); }

    std::vector<gdp::Stamp> stamps;
    std::vector<Profile> profiles;
    std::vector<std::vector<float>> intensities;

  private:
    bool broken_ = false;
    int profiles_standing_ = 0, intensities_standing_ = 0;
};

}  // namespace seamwright
