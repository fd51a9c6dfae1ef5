#include "projects/calibrate/session/sphere_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/pose.h"

namespace seamwright {
namespace {

constexpr double kBulge = 0.5;  // least mean_side
constexpr double kNearShare =
    0.25;  // of the radius: points so near to its line belong to the arc, or speak against it
constexpr double kAloneShare = 0.5;  // of the points near the arc
constexpr double kRunsOn = 0.4;      // of the radius
constexpr double kJumpShare = 0.08;  // of the radius: between neighbours that hang together no more than this
constexpr double kSmooth_deg = 35;   // from the arc's direction at its end
constexpr double kMostNoise_mm =
    0.3;                        // of an arc's points; what scatters more is what is left of other things
constexpr int kCandidates = 4;  // circles that are looked at in one profile

enum class Sight { sphere, hollow, crowded, runs_on };

Eigen::Vector2d at(const Profile& p, std::size_t i) {
    return {p.x_mm[i], p.z_mm[i]};
}

bool returned(const Profile& p, std::size_t i) {
    return std::isfinite(p.x_mm[i]) && std::isfinite(p.z_mm[i]);
}

// How far the contour hangs together behind an end of the arc, where it leaves it in the arc's own direction. A corner
// ends the arc as well as a jump does.
double run_on_mm(const Profile& p, const CircleSection& c, int step) {
    const auto last = static_cast<std::size_t>(step < 0 ? c.inliers.front() : c.inliers.back());
    const Eigen::Vector2d end = at(p, last), out = (end - Eigen::Vector2d(c.x_mm, c.z_mm)).normalized();
    const auto inner = static_cast<std::size_t>(c.inliers[c.inliers.size() / 2]);
    Eigen::Vector2d ahead(-out.y(), out.x());
    if (ahead.dot(end - at(p, inner)) < 0) ahead = -ahead;
    const double jump = kJumpShare * c.radius_mm, enough = kRunsOn * c.radius_mm;
    double length = 0;
    Eigen::Vector2d before = end;
    for (auto i = static_cast<std::ptrdiff_t>(last) + step;
         i >= 0 && i < static_cast<std::ptrdiff_t>(p.size()) && length < enough; i += step) {
        const auto k = static_cast<std::size_t>(i);
        if (!returned(p, k)) continue;
        const double gap = (at(p, k) - before).norm();
        if (gap > jump) break;
        length += gap;
        before = at(p, k);
    }
    const Eigen::Vector2d way = before - end;
    const bool smooth = way.dot(ahead) > std::cos(rad_from_deg(kSmooth_deg)) * way.norm();
    return smooth ? length : 0;
}

Sight sight_of(const Profile& p, const CircleSection& c, bool either_side) {
    if ((either_side ? std::abs(c.mean_side) : c.mean_side) < kBulge) return Sight::hollow;
    std::size_t near = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (returned(p, i) && std::abs((at(p, i) - Eigen::Vector2d(c.x_mm, c.z_mm)).norm() - c.radius_mm) <
                                  kNearShare * c.radius_mm)
            ++near;
    if (static_cast<double>(c.inliers.size()) < kAloneShare * static_cast<double>(near))
        return Sight::crowded;
    for (const int step : {-1, 1})
        if (run_on_mm(p, c, step) >= kRunsOn * c.radius_mm) return Sight::runs_on;
    return Sight::sphere;
}

}  // namespace

Expected<CircleSection> sphere_in_profile(const Profile& profile, double radius_mm, bool either_side,
                                          const Text& where) {
    const CircleSectionLimits limits = radius_mm > 0 ? limits_of_sphere(radius_mm) : CircleSectionLimits();
    Profile rest = profile;
    std::optional<std::pair<Sight, double>> refused;  // the most prominent one, and its radius
    for (int n = 0; n < kCandidates; ++n) {
        const auto circle = find_circle_section(rest, limits);
        if (!circle) break;
        const Sight sight = sight_of(profile, *circle, either_side);
        const bool arc = circle->noise_mm <= kMostNoise_mm;
        if (arc && sight == Sight::sphere) return *circle;
        if (arc && !refused) refused = {sight, circle->radius_mm};
        for (const int i : circle->inliers)
            rest.z_mm[static_cast<std::size_t>(i)] = std::numeric_limits<double>::quiet_NaN();
    }
    const char* cure = "bring the stripe onto the sphere, a little off its middle, and check its radius";
    if (!refused) return input_error("no circle of the sphere is seen in the profile", where, cure);
    const double radius = refused->second;
    switch (refused->first) {
        case Sight::hollow:
            return input_error(Text("the round piece of {:.1f} mm radius in the profile is hollow: a sphere "
                                    "bulges towards the sensor",
                                    radius),
                               where, cure);
        case Sight::crowded:
            return input_error(
                Text("the round piece of {:.1f} mm radius in the profile is too small a part of what lies "
                     "around it to be a sphere",
                     radius),
                where, cure);
        default:
            return input_error(Text("the round piece of {:.1f} mm radius in the profile runs on into what is "
                                    "beside it: a sphere ends",
                                    radius),
                               where, cure);
    }
}

}  // namespace seamwright
