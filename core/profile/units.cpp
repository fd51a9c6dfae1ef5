#include "core/profile/units.h"
#include "core/median.h"
#include "core/numbers.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace seamwright {
namespace {

constexpr double kLeastSpan = 1, kMostSpan = 5000;  // mm
constexpr double kWideInMetres = 3,
                 kCloseInMetres = 4e-3;  // mm: up to 3 m at 4 mm a point, if it were metres
constexpr double kWideInInches = 6, kCloseInInches = 0.02;  // mm: up to 6 in (or m) at 0.02 of it a point
constexpr double kNarrowInMicrometres = 50, kFarInMicrometres = 5, kNoisyInMicrometres = 2;  // mm
constexpr double kMmPerInch = 25.4;
constexpr double kRound = 1e-5, kRoundOfGrid = 1e-6;  // of the value
constexpr double kEven = 1e-4;                        // of the pitch: steps of one grid
constexpr std::size_t kLeastPoints = 10;
constexpr const char* kMend = "give x and z in millimetres";

}  // namespace

Expected<void> check_span_millimetres(double span_mm, const Text& where) {
    if (span_mm > 0 && span_mm < kLeastSpan)
        return input_error(Text("the laser points span {:.3g} mm, which looks like metres", span_mm), where,
                           kMend);
    if (span_mm > kMostSpan)
        return input_error(Text("the laser points span {:.4g} mm, which looks like micrometres", span_mm),
                           where, kMend);
    return {};
}

namespace {

// At most three digits that count.
bool is_round(double value, double share) {
    const double scaled = value / std::pow(10, std::floor(std::log10(value)) - 2);
    return std::abs(scaled - std::round(scaled)) < share * scaled;
}

// A grid in x that was round in millimetres before somebody divided by 25.4. Of grids as they come, such as 80 mm over 639
// steps, one in seventy is nearly round in inches: so the pitch is that of the whole grid, which its rounding leaves exact.
bool inch_grid(const std::vector<double>& x_steps) {
    std::vector<double> sorted = x_steps;
    const double pitch = std::abs(median(sorted));
    if (!(pitch > 0)) return false;
    const auto even = std::count_if(x_steps.begin(), x_steps.end(),
                                    [&](double s) { return std::abs(std::abs(s) - pitch) < kEven * pitch; });
    if (10 * static_cast<std::size_t>(even) <= 9 * x_steps.size() || is_round(pitch, kRound)) return false;
    double span = 0, steps = 0;
    for (const double s : x_steps) {
        span += std::abs(s);
        steps += std::round(std::abs(s) / pitch);
    }
    return is_round(span / steps * kMmPerInch, kRoundOfGrid + kEven / steps);
}

void suspect(ProfileScale& s, const std::vector<double>& x_steps) {
    const auto say = [&](const char* unit, Text why) {
        s.suspected = unit;
        s.why = std::move(why);
    };
    const Text apart = Text("the points stand {:.2g} mm apart and span {:.3g} mm", s.pitch, s.span);
    if (s.span > 0 && s.span < kLeastSpan)
        say("metres or inches", Text("the laser points span {:.3g} mm", s.span));
    else if (s.span > kMostSpan)
        say("micrometres", Text("the laser points span {:.4g} mm", s.span));
    else if (s.span < kWideInMetres && s.pitch < kCloseInMetres)
        say("metres or inches", apart);
    else if (s.span < kWideInInches && s.pitch < kCloseInInches)
        say("metres or inches", apart);
    else if (s.span > kNarrowInMicrometres && s.pitch > kFarInMicrometres)
        say("micrometres", apart);
    else if (s.span > kNarrowInMicrometres && s.noise > kNoisyInMicrometres)
        say("micrometres", Text("the points scatter by {:.2g} mm", s.noise));
    else if (inch_grid(x_steps))
        say("inches", Text("the pitch is {:.6g}, which is {:.3g} mm if it is inches", s.pitch,
                           std::abs(x_steps.front()) * kMmPerInch));
}

}  // namespace

ProfileScale profile_scale(const Profile& profile) {
    ProfileScale s;
    Eigen::Array2d low = Eigen::Array2d::Constant(INFINITY), high = -low;
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const Eigen::Array2d point(profile.x_mm[i], profile.z_mm[i]);
        if (!point.allFinite()) continue;
        low = low.min(point);
        high = high.max(point);
        points.emplace_back(point);
    }
    s.points = points.size();
    s.span = s.pitch = s.noise = s.x_low = s.x_high = s.z_low = s.z_high =
        std::numeric_limits<double>::quiet_NaN();
    if (s.points < kLeastPoints) return s;
    s.x_low = low.x(), s.x_high = high.x(), s.z_low = low.y(), s.z_high = high.y();
    s.span = (high - low).matrix().norm();
    std::vector<double> steps, x_steps, bends;
    for (std::size_t i = 1; i < points.size(); ++i) {
        steps.push_back((points[i] - points[i - 1]).norm());
        x_steps.push_back(points[i].x() - points[i - 1].x());
        // Second differences of white noise scatter by sqrt(6) of its sigma.
        if (i > 1)
            bends.push_back(std::abs(points[i].y() - 2 * points[i - 1].y() + points[i - 2].y()) *
                            kMadToSigma / std::sqrt(6.0));
    }
    s.pitch = median(steps);
    s.noise = median(bends);
    suspect(s, x_steps);
    return s;
}

Expected<void> check_profile_millimetres(const Profile& profile, const Text& where) {
    const ProfileScale s = profile_scale(profile);
    if (s.suspected.empty()) return {};
    return input_error(Text("{}, which looks like {}", s.why, s.suspected), where, kMend);
}

}  // namespace seamwright
