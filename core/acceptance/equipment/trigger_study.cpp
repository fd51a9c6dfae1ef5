#include "core/acceptance/equipment/trigger_study.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/acceptance/distributions.h"
#include "core/acceptance/levels.h"
#include "core/correction/contour_fit.h"
#include "core/geometry/pose.h"

namespace seamwright {
namespace {

constexpr double kSlopeKnown = 0.1;
constexpr int kPivots = 64;
// Standing scatter below this is rounding.
constexpr double kLeastVariance_mm2 = 1e-14;
// Of the bracket of a root: its first upper end at least, and its last width as a share of the root.
constexpr double kLeastHigh_s2 = 1e-12, kRootShare = 1e-9;

// The weighted line s0 + b h + tau v at given variances.
struct WeightedLine {
    Eigen::Vector3d value;  // s0, b, tau
    Eigen::Matrix3d covariance;
    double squares = 0;  // Q
};

struct StoppedSide {
    double n = 0, mean = 0;
};

class TriggerModel {
  public:
    explicit TriggerModel(std::span<const TriggerPass> passes) {
        std::array<std::vector<double>, 2> stopped;
        for (const TriggerPass& p : passes) {
            if (p.velocity_mm_s == 0)
                stopped[p.backward].push_back(p.travel_mm);
            else
                moving.push_back(p);
        }
        double squares = 0;
        for (std::size_t side = 0; side < 2; ++side) {
            const Moments m = moments(stopped[side]);
            const auto n = static_cast<double>(stopped[side].size());
            sides[side] = {n, m.mean};
            squares += m.s * m.s * (n - 1);
        }
        standing = {0, sides[0].n + sides[1].n - 2};
        standing.value = std::max(kLeastVariance_mm2, squares / standing.degrees);
    }

    double degrees() const { return static_cast<double>(moving.size()) - 1; }

    WeightedLine line(double jitter_s2, double standing_mm2) const {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        double squares = 0;
        const auto each = [&](const auto& take) {
            for (std::size_t side = 0; side < 2; ++side)
                take(Eigen::Vector3d(1, side ? -1 : 1, 0), sides[side].mean, standing_mm2 / sides[side].n);
            for (const TriggerPass& p : moving)
                take(Eigen::Vector3d(1, p.backward ? -1 : 1, p.velocity_mm_s), p.travel_mm,
                     standing_mm2 + p.velocity_mm_s * p.velocity_mm_s * jitter_s2);
        };
        each([&](const Eigen::Vector3d& row, double value, double variance) {
            normal += row * row.transpose() / variance;
            right += row * value / variance;
        });
        WeightedLine out;
        out.covariance = normal.inverse();
        out.value = out.covariance * right;
        each([&](const Eigen::Vector3d& row, double value, double variance) {
            const double off = value - row.dot(out.value);
            squares += off * off / variance;
        });
        out.squares = squares;
        return out;
    }

    // Where a function that falls with the jitter's variance reaches 0; 0 where it is below 0 at once.
    template <class Falling>
    double root(const Falling& f) const {
        if (f(0.0) <= 0) return 0;
        double low = 0, high = 0;
        for (const TriggerPass& p : moving) high = std::max(high, std::pow(p.travel_mm / p.velocity_mm_s, 2));
        high = std::max(high, kLeastHigh_s2);
        for (int doubled = 0; f(high) > 0; ++doubled) {
            if (doubled > 200) return std::numeric_limits<double>::infinity();
            low = high;
            high *= 2;
        }
        for (int step = 0; step < 60 && high - low > kRootShare * high; ++step) {
            const double middle = (low + high) / 2;
            (f(middle) > 0 ? low : high) = middle;
        }
        return (low + high) / 2;
    }

    std::vector<TriggerPass> moving;
    std::array<StoppedSide, 2> sides;
    MeanSquare standing;
};

}  // namespace

Eigen::Vector2d TravelSight::at(double s) const {
    const double a = rad_from_deg(travel_deg), y = s * std::cos(a);
    const Eigen::Vector3d powers(y, y * y, y * y * y);
    return place + Eigen::Vector2d(curve.x_coefficients.dot(powers) - s * std::sin(a),
                                   curve.z_coefficients.dot(powers));
}

double TravelSight::travel_of(const Eigen::Vector2d& point) const {
    const auto observed = [&](Eigen::Vector2d v) {
        if (!x) v.x() = 0;
        if (!z) v.y() = 0;
        return v;
    };
    constexpr double kStep_mm = 1e-3;
    double s = observed(point - place).dot(slope) / slope.squaredNorm();
    for (int round = 0; round < 5; ++round) {  // the curve bends little over a latency
        const Eigen::Vector2d turned = observed(at(s + kStep_mm) - at(s - kStep_mm)) / (2 * kStep_mm);
        s += observed(point - at(s)).dot(turned) / turned.squaredNorm();
    }
    return s;
}

bool TravelSight::sees() const {
    return slope.norm() >= kLeastSlope && slope_sigma <= kSlopeKnown * slope.norm();
}

Expected<TravelSight> travel_sight(std::span<const TravelPoint> points, double travel_deg, bool x, bool z) {
    if (!(std::abs(travel_deg) <= 90))
        return input_error(Text("a travel of {} degrees from the sensor's Y", travel_deg), "trigger study",
                           "give -90 to 90");
    if (!x && !z) return input_error("the spot observes neither x nor z", "trigger study", "take another");
    SEAM_TRY(auto curve, fit_contour_curve(points));
    TravelSight sight;
    sight.travel_deg = travel_deg;
    sight.x = x;
    sight.z = z;
    sight.curve = curve;
    std::vector<double> y, px, pz;
    for (const TravelPoint& p : points) {
        if (!std::isfinite(p.travel_mm) || !std::isfinite(p.x_mm) || !std::isfinite(p.z_mm)) continue;
        y.push_back(p.travel_mm);
        px.push_back(p.x_mm);
        pz.push_back(p.z_mm);
    }
    const PolynomialFit fx = fit_lowest_order(y, px, 1, 3), fz = fit_lowest_order(y, pz, 1, 3);
    sight.place = {fx.coefficient[0], fz.coefficient[0]};
    const double a = rad_from_deg(travel_deg);
    Eigen::Vector2d sigma(fx.coefficient_sigma[1], fz.coefficient_sigma[1]);
    sight.slope = {fx.coefficient[1] * std::cos(a) - std::sin(a), fz.coefficient[1] * std::cos(a)};
    for (int i = 0; i < 2; ++i)
        if (!(i == 0 ? x : z)) sight.slope[i] = sigma[i] = 0;
    sigma *= std::cos(a);
    const double length = sight.slope.norm();
    sight.slope_sigma = length > 0 ? sight.slope.cwiseProduct(sigma).norm() / length : sigma.norm();
    return sight;
}

double TriggerStudy::half_width_mm(double speed_mm_s) const {
    return std::sqrt(3.0) * 1e-3 * (jitter_seen() ? jitter_ms : jitter_limits_ms.high) * speed_mm_s;
}

Expected<TriggerStudy> trigger_study(std::span<const TriggerPass> passes, double slope_share) {
    const Text where("trigger study");
    std::map<double, std::array<int, 2>> ways;
    for (const TriggerPass& p : passes) {
        if (!std::isfinite(p.velocity_mm_s) || !std::isfinite(p.travel_mm))
            return input_error("a value is not finite", where);
        if (p.velocity_mm_s != 0 && (p.velocity_mm_s < 0) != p.backward)
            return input_error("a pass moves against its own direction", where);
        ++ways[std::abs(p.velocity_mm_s)][p.backward];
    }
    for (const auto& [speed, n] : ways)
        if (n[0] < 2 || n[1] < 2)
            return input_error(Text("{} and {} passes at {:.0f} mm/s each way", n[0], n[1], speed), where,
                               "make two or more each way");
    if (!ways.contains(0))
        return input_error("no pass stopped at the spot, so the robot's own scatter is not known", where,
                           "make two or more each way");
    if (ways.size() < kTriggerSpeeds + 1)
        return input_error(Text("{} speeds", ways.size() - 1), where,
                           Text("pass at {} or more different ones", kTriggerSpeeds));
    if (!std::isfinite(slope_share) || slope_share < 0 || slope_share > 1)
        return input_error("the slope of the contour is not known", where);

    const TriggerModel model(passes);
    TriggerStudy study;
    study.moving = static_cast<int>(model.moving.size());
    study.standing = static_cast<int>(model.standing.degrees) + 2;
    for (const auto& [speed, n] : ways)
        if (speed > 0) study.speeds_mm_s.push_back(speed);
    const double degrees = model.degrees(), a = model.standing.value;
    study.standing_mm = std::sqrt(a);

    const double variance = model.root([&](double v) { return model.line(v, a).squares - degrees; });
    const std::vector<double> standing = pivots(model.standing, kPivots);
    const auto limit = [&](double probability) {
        return model.root([&](double v) {
            double below = 0;  // P(variance* <= v)
            for (const double at : standing) below += 1 - chi_square_cdf(degrees, model.line(v, at).squares);
            return probability - below / kPivots;
        });
    };
    const double wider = 2 * slope_share;
    study.jitter_ms = 1e3 * std::sqrt(variance);
    study.jitter_limits_ms = {1e3 * std::sqrt(limit(kBelowLow95)) * std::max(0.0, 1 - wider),
                              1e3 * std::sqrt(limit(kBelowHigh95)) * (1 + wider)};

    const WeightedLine line = model.line(variance, a);
    const auto about = [&](double value, double sigma, double of_degrees) {
        const double by = t_quantile(of_degrees, kBelowHigh95) * sigma + wider * std::abs(value);
        return Interval{value - by, value + by};
    };
    study.reversal_mm = line.value[1];
    study.reversal_limits_mm = about(line.value[1], std::sqrt(line.covariance(1, 1)), model.standing.degrees);
    study.latency_ms = 1e3 * line.value[2];
    study.latency_limits_ms = about(study.latency_ms, 1e3 * std::sqrt(line.covariance(2, 2)), degrees);
    return study;
}

}  // namespace seamwright
