#include "core/profile/units.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace seamwright {
namespace {

constexpr double kLeastSpan = 1, kMostSpan = 5000;  // mm
constexpr double kWideInMetres = 3,
                 kCloseInMetres = 4e-3;  // mm: up to 3 m at 4 mm a point, if it were metres
constexpr std::size_t kLeastPoints = 10;
constexpr const char* kMend = "give x and z in millimetres";

}  // namespace

Expected<void> check_span_millimetres(double span_mm, const std::string& where) {
    if (span_mm > 0 && span_mm < kLeastSpan)
        return input_error(fmt::format("the laser points span {:.3g} mm, which looks like metres", span_mm),
                           where, kMend);
    if (span_mm > kMostSpan)
        return input_error(
            fmt::format("the laser points span {:.4g} mm, which looks like micrometres", span_mm), where,
            kMend);
    return {};
}

Expected<void> check_profile_millimetres(const Profile& profile, const std::string& where) {
    Eigen::Array2d low = Eigen::Array2d::Constant(INFINITY), high = -low, last = low;
    std::vector<double> steps;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const Eigen::Array2d point(profile.x_mm[i], profile.z_mm[i]);
        if (!point.allFinite()) continue;
        low = low.min(point);
        high = high.max(point);
        if (seen++ > 0) steps.push_back((point - last).matrix().norm());
        last = point;
    }
    if (seen < kLeastPoints) return {};
    const double span = (high - low).matrix().norm();
    if (auto ok = check_span_millimetres(span, where); !ok) return ok;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    if (span < kWideInMetres && *middle < kCloseInMetres)
        return input_error(
            fmt::format("the points stand {:.2g} mm apart and span {:.3g} mm, which looks like metres",
                        *middle, span),
            where, kMend);
    return {};
}

}  // namespace seamwright
