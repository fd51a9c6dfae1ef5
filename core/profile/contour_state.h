#pragma once
// State of a contour being followed point by point: the inside of filter_profile and track_stripe (not for
// others).
//
// Running straight line with spacing: foot point (x, z), advance (vx, vz) per line of the sensor, whose
// length is the spacing. Its covariance is one 2x2 matrix (position, advance) in units of the measuring
// covariance diag(sx^2, sz^2): recursive regression over the line number, whose direction does a random walk.
// Along the contour the advance is the MAP spacing of (3.7) and the prediction i lines ahead spreads as
// (3.5); drift and variance are averages (3.20).

#include <algorithm>
#include <cmath>

#include "core/profile/filter.h"

namespace seamwright::contour {

inline constexpr double kTurn = 0.04;  // rad, what the direction may turn from line to line (one sigma)
inline constexpr double kSpacingReach = 3.5;  // spacing ratio a sharp edge may show; 1/cos 70 degrees = 2.9
inline constexpr double kFlankReach = 9;  // the same into a flank, in usual spacings; 1/cos 83 degrees = 8.2
inline constexpr double kMinSpacingSigma = 0.05;
inline constexpr double kMaxTurnNoise = 4;  // the same across the contour, in units of the measuring variance
inline constexpr int kShortGap = 10;  // lines without points across which the direction is still believed
inline constexpr int kSettled = 5;  // points after which the tracker knows better than a line through the end
inline constexpr double kCalm = 0.8, kCalmVariance = 2, kCalmExcess = 1.5;  // see is_calm()
inline constexpr int kSteady = 6, kHeldPoints = 11;  // see Held; points after which the gains stand still
inline constexpr int kMature = 3;                    // points after which the direction carries the spacing

// Of the usual spacing's square: what a spacing may shrink and grow to while a contour is followed, and after two points.
inline constexpr double kLeastSpacing2 = 0.01, kMostSpacing2 = 225;
inline constexpr double kLeastFirst2 = 0.09, kMostFirst2 = 100;
// Costs: of an outlier beyond half the band's square; then in outliers: of a sharp edge, of a new segment beyond the
// lookahead, of a point at the end of its reach.
inline constexpr double kOutlierMore = 0.75, kEdgeCost = 2.2, kJumpMore = 0.6, kReachCost = 0.6;
inline constexpr double kPriorSpacings = 1.5;  // sigma of each coordinate of an unknown advance
inline constexpr double kReachNoise = 1.5;     // of the band, by which noise widens a reach
// Of the spacing, in a line: its drift, its growth at a point, and what the drift makes of it over a gap.
inline constexpr double kMostDrift = 0.1, kMostGrowth = 0.5, kMostDriftAhead = 0.3;
// Up to which one chord step solves map_ratio(): the measured ratio, and how far its start lies off 1.
inline constexpr double kNearMeasured = 1.7, kNearStart = 0.25;
// Of the excess, and of d2, which is 2 of mere noise: what a point leaves of the one and adds of the other.
inline constexpr double kExcessKept = 0.95, kExcessTaken = 0.025;

// What the profile itself says: noise of x and z, typical spacing per line.
struct Scale {
    double sx = 0, sz = 0, spacing = 0;
    double largest() const { return std::max(sx, sz); }
};

struct Model {
    Scale scale;
    double sx2 = 0, sz2 = 0, sxz = 0, inv_sxz = 0;    // squares of sx and sz, their product and its inverse
    double least_spacing2 = 0, largest_spacing2 = 0;  // what a spacing may shrink and grow to, squared
    double band = 4, average = 0.15, initial_sigma = 0.15;
    double outlier_cost = 0, edge_cost = 0, jump_cost = 0;
    double jump_size_cost = 0;  // more for every factor e of a jump's size beyond a spacing
    // Cost of leaving n lines in a row out: open + n line; to come back to the same contour not more than
    // most.
    double skip_open = 0, skip_line = 0, skip_most = 1e300;
    double skip(int n) const { return n > 0 ? std::min(skip_open + n * skip_line, skip_most) : 0; }
    int window = 8, longest_gap = kShortGap;  // lines with points, and lines, over which a state may coast
    int edge_window = 4;                      // the same for a sharp edge
    Model(const Scale& s, const FilterOptions& o)
        : scale(s), band(o.band_sigmas), average(o.average), initial_sigma(o.initial_sigma) {
        sx2 = scale.sx * scale.sx, sz2 = scale.sz * scale.sz;
        sxz = sx2 * sz2, inv_sxz = 1 / sxz;
        least_spacing2 = kLeastSpacing2 * scale.spacing * scale.spacing;
        largest_spacing2 = kMostSpacing2 * scale.spacing * scale.spacing;
        outlier_cost = 0.5 * band * band + kOutlierMore;
        edge_cost = kEdgeCost * outlier_cost;
        jump_cost = (o.lookahead + kJumpMore) * outlier_cost;
        skip_line = outlier_cost;
        window = 2 * o.lookahead + 2;
        edge_window = o.lookahead + 1;
    }
};

struct State {
    double x = 0, z = 0, vx = 0, vz = 0;
    double p11 = 1, p12 = 0, p22 = 0;              // covariance in units of the measuring covariance
    double spacing2 = 0, drift = 0, variance = 0;  // GBM: s_0^2, mu, sigma^2
    double excess = 1;                             // average of the squared normalised deviation, at least 1
    int age = 0;                                   // points since the direction was last unknown
    double spacing() const { return std::sqrt(spacing2); }
};

// Where the next point is expected, i lines ahead, and how far off a given point is.
struct Deviation {
    double straight = 0;    // p11 if the direction keeps still
    double grown = 1;       // predicted distance in present spacings
    double ex = 0, ez = 0;  // point minus prediction
    double p11 = 0, p12 = 0, p22 = 0;
    double along = 0;  // variance of the spacing process in units of (vx, vz) squared
    double across = 0,
           inv_across = 0;  // measuring variance across the contour times that square; inverse or 0
    double d2 = 0;          // squared normalised distance
};

inline State first_point(const Model& m, double x, double z) {
    State s;
    s.x = x, s.z = z;
    s.spacing2 = m.scale.spacing * m.scale.spacing;
    s.variance = m.initial_sigma * m.initial_sigma;
    s.age = 1;
    return s;
}

// Measuring variance across the direction (vx, vz), times that vector's square.
inline double across_variance(const Model& m, const State& s) {
    return s.vz * s.vz * m.sx2 + s.vx * s.vx * m.sz2;
}

// Squared normalised distance of (ex, ez) under the covariance S diag(sx^2, sz^2) + along (vx, vz)(vx, vz)^T,
// by its determinant S (S sx^2 sz^2 + along across).
inline double squared_distance(const Model& m, const State& s, double ex, double ez, double S, double along,
                               double across) {
    const double off = ex * s.vz - ez * s.vx;
    return (S * (ex * ex * m.sz2 + ez * ez * m.sx2) + along * off * off) / (S * (S * m.sxz + along * across));
}

[[gnu::always_inline]] inline Deviation deviation(const Model& m, const State& s, double x, double z, int i) {
    Deviation d;
    const double n = i, length2 = s.vx * s.vx + s.vz * s.vz;
    d.across = across_variance(m, s);
    double turn, clamped = 1;  // the latter: where the spacing was held within its bounds
    if (d.across > 0) {
        d.inv_across = 1 / d.across;
        turn = kTurn * kTurn * s.spacing2 * length2 * d.inv_across;
        if (s.spacing2 != length2) clamped = s.spacing2 / length2;
    } else {
        turn = kTurn * kTurn * s.spacing2 / std::max(m.sx2, m.sz2);
    }
    const double q = std::min(turn, kMaxTurnNoise);
    d.straight = s.p11 + n * (2 * s.p12 + n * s.p22);
    d.p11 = d.straight + q * n * n * n * (1. / 3);
    d.p12 = s.p12 + n * s.p22 + 0.5 * q * n * n;
    d.p22 = s.p22 + q * n;
    // (3.4), (3.5) for the distance of i lines: drift as the mean growth over them.
    d.grown = n;
    if (i > 1 && s.drift != 0)
        d.grown = n * (1 + std::clamp(0.5 * s.drift * (n - 1), -kMostDriftAhead, kMostDriftAhead));
    d.ex = x - s.x - d.grown * s.vx;
    d.ez = z - s.z - d.grown * s.vz;
    const double relative = s.variance * n;
    d.along = (relative + 0.5 * relative * relative) * n * n * clamped;
    d.d2 = squared_distance(m, s, d.ex, d.ez, 1 + d.p11, d.along, d.across);
    if (s.excess > 1) d.d2 /= s.excess;
    return d;
}

// In the band by so much, and predicted so sharply, that the view from the other side would not change it.
inline bool is_calm(const Model& m, const State& s, const Deviation& d) {
    return s.age >= kSettled && d.p11 < kCalmVariance && s.excess < kCalmExcess &&
           d.d2 < kCalm * m.outlier_cost;
}

// MAP ratio s / s_0 of (3.7) for a measured ratio rm, K = v / rho^2 and `mode` of the prediction's logarithm:
// (rm - r) r K = ln r - mode. Near 1 the linear equation and one chord step, within 2 % of the maximum (1 %
// where that is within 10 % of 1), else map_spacing.
inline double map_ratio(double rm, double K, double mode, const State& s, int i) {
    const double inverse = 1 / (1 + K);
    const double start = (rm * K + 1 + mode) * inverse, e = start - 1;
    if (rm < kNearMeasured && std::abs(e) < kNearStart) {
        const double logarithm = e * (1 + e * (-0.5 + e * (1. / 3 + e * (-0.25 + e * 0.2))));
        return start * (1 + ((rm - start) * start * K - (logarithm - mode)) * inverse);
    }
    return map_spacing(rm, 1, s.drift, std::sqrt(s.variance), std::sqrt(s.variance * i / K), i);
}

// The state after a point that fits; `d` is its deviation. What the spacing process explains is taken along
// the contour by MAP (its measured spacing is the generalised least squares estimate of the advance, with the
// noise of the prediction in it); the rest is measuring noise and passes the gains of the regression.
[[gnu::always_inline]] inline void accept(const Model& m, State& s, const Deviation& d, int i) {
    const double inv_S = 1 / (1 + d.p11), g1 = d.p11 * inv_S, g2 = d.p12 * inv_S;
    double ex = d.ex, ez = d.ez;
    s.x += d.grown * s.vx, s.z += d.grown * s.vz;
    if (s.age >= kMature && d.inv_across > 0) {
        const double n = i, per_line = i == 1 ? 1 : 1 / n;
        const double expected = d.grown * per_line;
        const double measured = expected + (s.vx * ex * m.sz2 + s.vz * ez * m.sx2) * d.inv_across * per_line;
        const double v = s.variance * n;
        const double K = v * d.across * n * n * inv_S * m.inv_sxz;
        const double ratio = map_ratio(measured, K, s.drift * n - 1.5 * v, s, i);
        const double growth = std::clamp(ratio - 1, -kMostGrowth, kMostGrowth) * per_line;
        const double surprise = growth - s.drift;
        s.variance = std::max((1 - m.average) * s.variance + m.average * surprise * surprise,
                              kMinSpacingSigma * kMinSpacingSigma);
        s.drift = std::clamp((1 - m.average) * s.drift + m.average * growth, -kMostDrift, kMostDrift);
        const double advance = (ratio - expected) * n;
        const double ax = s.vx * advance, az = s.vz * advance;
        s.x += ax, s.z += az;
        ex -= ax, ez -= az;
        s.vx *= ratio, s.vz *= ratio;
    }
    s.x += g1 * ex, s.z += g1 * ez;
    s.vx += g2 * ex, s.vz += g2 * ez;
    s.spacing2 = std::clamp(s.vx * s.vx + s.vz * s.vz, m.least_spacing2, m.largest_spacing2);
    s.p11 = g1, s.p12 = g2, s.p22 = d.p22 - d.p12 * g2;
    ++s.age;
    s.excess = std::max(1., s.excess * (kExcessKept + kExcessTaken * d.d2));
}

// What changes slowly from point to point of a contour followed calmly: the factors of deviation() and
// accept(), kept for the next kHeldPoints points one line apart.
struct Held {
    int points = 0;                                // left
    double S = 0, along = 0, inv_determinant = 0;  // of the distance
    double inv_across = 0, share = 0, shift = 0;   // of the spacing: ratio - 1 = share (measured - 1) + shift
    double g1 = 0, g2 = 0;
};

// `d` is the deviation, one line ahead, of the point that `s` has just accepted.
inline void hold(const Model& m, const State& s, const Deviation& d, Held& h) {
    h.points = s.age > kSteady && d.inv_across > 0 && d.d2 < kCalm * m.outlier_cost ? kHeldPoints : 0;
    if (h.points == 0) return;
    h.S = 1 + d.p11, h.along = d.along;
    const double inv_S = 1 / h.S;
    h.inv_determinant = 1 / (h.S * (h.S * m.sxz + h.along * d.across) * s.excess);
    h.inv_across = d.inv_across;
    const double K = s.variance * d.across * inv_S * m.inv_sxz, inverse = 1 / (1 + K);
    h.share = K * inverse;
    h.shift = (s.drift - 1.5 * s.variance) * inverse;
    h.g1 = d.p11 * inv_S, h.g2 = d.p12 * inv_S;
}

// Accepts a point one line ahead with held factors and the linear form of map_ratio(). False, and nothing
// done, where none are held or the point is not calm. `d2` as in Deviation.
[[gnu::always_inline]] inline bool follow(const Model& m, Held& h, State& s, double x, double z,
                                          double most_d2, double& d2) {
    if (h.points == 0) return false;
    double ex = x - s.x - s.vx, ez = z - s.z - s.vz;
    const double off = ex * s.vz - ez * s.vx, wx = ex * m.sz2, wz = ez * m.sx2;
    d2 = (h.S * (ex * wx + ez * wz) + h.along * off * off) * h.inv_determinant;
    if (!(d2 < most_d2)) {
        h.points = 0;
        return false;
    }
    --h.points;
    const double growth =
        std::clamp(h.share * ((s.vx * wx + s.vz * wz) * h.inv_across) + h.shift, -kMostGrowth, kMostGrowth);
    const double surprise = growth - s.drift;
    s.variance = std::max((1 - m.average) * s.variance + m.average * surprise * surprise,
                          kMinSpacingSigma * kMinSpacingSigma);
    s.drift = std::clamp((1 - m.average) * s.drift + m.average * growth, -kMostDrift, kMostDrift);
    const double ax = s.vx * growth, az = s.vz * growth;
    ex -= ax, ez -= az;
    s.vx += ax, s.vz += az;
    s.x += s.vx + h.g1 * ex, s.z += s.vz + h.g1 * ez;
    s.vx += h.g2 * ex, s.vz += h.g2 * ez;
    s.spacing2 = std::clamp(s.vx * s.vx + s.vz * s.vz, m.least_spacing2, m.largest_spacing2);
    ++s.age;
    s.excess = std::max(1., s.excess * (kExcessKept + kExcessTaken * d2));
    return true;
}

// A point that lies within reach of the foot point in any direction: the thesis's test of the spacing alone.
// Used where the direction is unknown: second point of a segment, first point after a sharp edge. Returns the
// ratio to the reach. The next line may stand up a flank, farther off than any spacing before.
inline double reach_ratio(const Model& m, const State& s, double x, double z, int i) {
    const double dx = x - s.x, dz = z - s.z;
    double reach = kSpacingReach * std::max(s.spacing(), 0.5 * m.scale.spacing) * i;
    if (i == 1) reach = std::max(reach, kFlankReach * m.scale.spacing);
    return std::sqrt(dx * dx + dz * dz) / (reach + m.band * kReachNoise * m.scale.largest());
}

// The state after such a point: direction from the two points, shrunk to what spacing and noise make
// probable.
inline void accept_any_direction(const Model& m, State& s, double x, double z, int i) {
    const double prior = kPriorSpacings * m.scale.spacing, prior2 = prior * prior * i * i;
    const auto weight = [&](double sigma) { return prior2 / (prior2 + 2 * sigma * sigma); };
    const double w = weight(m.scale.largest());
    s.vx = weight(m.scale.sx) * (x - s.x) / i;
    s.vz = weight(m.scale.sz) * (z - s.z) / i;
    s.x = x, s.z = z;
    s.p11 = 1, s.p12 = w / i, s.p22 = 2 * w / (double(i) * i);
    const double usual2 = m.scale.spacing * m.scale.spacing;
    s.spacing2 = std::clamp(s.vx * s.vx + s.vz * s.vz, kLeastFirst2 * usual2, kMostFirst2 * usual2);
    s.drift = 0;
    s.variance = m.initial_sigma * m.initial_sigma;
    s.excess = 1;
    s.age = 2;
}

}  // namespace seamwright::contour
