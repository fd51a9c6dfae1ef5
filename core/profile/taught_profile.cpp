#include "core/profile/taught_profile.h"

#include <algorithm>
#include <limits>

#include "core/profile/filter.h"

namespace seamwright {

Profile mean_profile(std::span<const Profile> profiles) {
    if (profiles.empty()) return {};
    Profile mean = profiles.front();
    const std::size_t n = mean.size();
    const bool bright = mean.intensity.size() == n;
    for (const Profile& p : profiles)
        if (p.size() != n || p.filtered() != mean.filtered()) return mean;
    const double share = 1.0 / static_cast<double>(profiles.size());
    for (std::size_t i = 0; i < n; ++i) {
        double x = 0, z = 0, intensity = 0;
        for (const Profile& p : profiles) {
            const bool outlier = p.filtered() && p.segment[i] == kOutlier;
            x += outlier ? std::numeric_limits<double>::quiet_NaN() : share * p.x_mm[i];
            z += share * p.z_mm[i];
            if (bright && p.intensity.size() == n) intensity += share * static_cast<double>(p.intensity[i]);
        }
        mean.x_mm[i] = x;
        mean.z_mm[i] = x == x ? z : std::numeric_limits<double>::quiet_NaN();
        if (bright) mean.intensity[i] = static_cast<float>(intensity);
    }
    (void)filter_profile(mean, {});  // refuses only arrays of different length
    return mean;
}

Profile cut_out(const Profile& profile, const Eigen::AlignedBox2d& window) {
    Profile piece;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (profile.filtered() && profile.segment[i] == kOutlier) continue;
        if (!window.contains(Eigen::Vector2d(profile.x_mm[i], profile.z_mm[i]))) continue;
        piece.x_mm.push_back(profile.x_mm[i]);
        piece.z_mm.push_back(profile.z_mm[i]);
        if (!profile.intensity.empty()) piece.intensity.push_back(profile.intensity[i]);
        if (profile.filtered()) piece.segment.push_back(profile.segment[i]);
    }
    return piece;
}

Profile cut_out(const Profile& profile, double from_mm, double to_mm) {
    constexpr double kOpen = std::numeric_limits<double>::infinity();
    return cut_out(profile,
                   Eigen::AlignedBox2d(Eigen::Vector2d(from_mm, -kOpen), Eigen::Vector2d(to_mm, kOpen)));
}

}  // namespace seamwright
