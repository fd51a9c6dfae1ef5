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
inline constexpr double kMinSpacingSigma = 0.05;
inline constexpr double kMaxTurnNoise = 4;  // the same across the contour, in units of the measuring variance
inline constexpr int kShortGap = 10;  // lines without points across which the direction is still believed
inline constexpr int kMature = 3;     // points after which the direction carries the spacing

// What the profile itself says: noise of x and z, typical spacing per line.
struct Scale {
    double sx = 0, sz = 0, spacing = 0;
    double largest() const { return std::max(sx, sz); }
};

struct Model {
    Scale scale;
    double sx2 = 0, sz2 = 0, inv_sx2 = 0, inv_sz2 = 0;
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
        inv_sx2 = 1 / sx2, inv_sz2 = 1 / sz2;
        outlier_cost = 0.5 * band * band + 0.75;
        edge_cost = 2.2 * outlier_cost;
        jump_cost = (o.lookahead + 0.6) * outlier_cost;
        skip_line = outlier_cost;
        window = 2 * o.lookahead + 2;
        edge_window = o.lookahead + 1;
    }
};

struct State {
    double x = 0, z = 0, vx = 0, vz = 0;
    double p11 = 1, p12 = 0, p22 = 0;             // covariance in units of the measuring covariance
    double spacing = 0, drift = 0, variance = 0;  // GBM: s_0, mu, sigma^2
    double excess = 1;                            // average of the squared normalised deviation, at least 1
    int age = 0;                                  // points since the direction was last unknown
};

// Where the next point is expected, i lines ahead, and how far off a given point is.
struct Deviation {
    double straight = 0;    // p11 if the direction keeps still
    double grown = 1;       // predicted distance in present spacings
    double ex = 0, ez = 0;  // point minus prediction
    double p11 = 0, p12 = 0, p22 = 0;
    double along_variance = 0;  // of the spacing process, mm^2
    double sigma_across2 = 0;   // measuring variance across the contour
    double d2 = 0;              // squared normalised distance
};

inline State first_point(const Model& m, double x, double z) {
    State s;
    s.x = x, s.z = z;
    s.spacing = m.scale.spacing;
    s.variance = m.initial_sigma * m.initial_sigma;
    s.age = 1;
    return s;
}

inline Deviation deviation(const Model& m, const State& s, double x, double z, int i) {
    Deviation d;
    const double sx2 = m.sx2, sz2 = m.sz2;
    const double length2 = s.vx * s.vx + s.vz * s.vz;
    const double inverse = length2 > 0 ? 1 / length2 : 0;
    const double txx = s.vx * s.vx * inverse, tzz = s.vz * s.vz * inverse, txz = s.vx * s.vz * inverse;
    d.sigma_across2 = tzz * sx2 + txx * sz2;
    if (!(d.sigma_across2 > 0)) d.sigma_across2 = std::max(sx2, sz2);
    const double q = std::min(kTurn * kTurn * s.spacing * s.spacing / d.sigma_across2, kMaxTurnNoise);
    const double n = i;
    d.straight = s.p11 + n * (2 * s.p12 + n * s.p22);
    d.p11 = d.straight + q * n * n * n * (1. / 3);
    d.p12 = s.p12 + n * s.p22 + 0.5 * q * n * n;
    d.p22 = s.p22 + q * n;
    // (3.4), (3.5) for the distance of i lines: drift as the mean growth over them.
    double& grown = d.grown = n;
    if (i > 1 && s.drift != 0) grown = n * (1 + std::clamp(0.5 * s.drift * (n - 1), -0.3, 0.3));
    d.ex = x - s.x - grown * s.vx;
    d.ez = z - s.z - grown * s.vz;
    const double relative = s.variance * n;
    d.along_variance = (relative + 0.5 * relative * relative) * n * n * s.spacing * s.spacing;
    const double S = 1 + d.p11;
    const double cxx = S * sx2 + d.along_variance * txx, czz = S * sz2 + d.along_variance * tzz;
    const double cxz = d.along_variance * txz;
    const double determinant = cxx * czz - cxz * cxz;
    d.d2 = (d.ex * d.ex * czz - 2 * d.ex * d.ez * cxz + d.ez * d.ez * cxx) / (determinant * s.excess);
    return d;
}

// The state after a point that fits; `d` is its deviation. What the spacing process explains is taken along
// the contour by MAP (its measured spacing is the generalised least squares estimate of the advance, with the
// noise of the prediction in it); the rest is measuring noise and passes the gains of the regression.
inline void accept(const Model& m, State& s, const Deviation& d, int i) {
    const double S = 1 + d.p11, g1 = d.p11 / S, g2 = d.p12 / S;
    const double length = std::sqrt(s.vx * s.vx + s.vz * s.vz);
    double ex = d.ex, ez = d.ez;
    s.x += d.grown * s.vx, s.z += d.grown * s.vz;
    if (s.age >= kMature && length > 0) {
        const double tx = s.vx / length, tz = s.vz / length;
        const double wx = tx * m.inv_sx2, wz = tz * m.inv_sz2;
        const double information = wx * tx + wz * tz;
        const double sn = std::sqrt(S / information) / i;
        const double measured = length * (d.grown / i) + (wx * ex + wz * ez) / (information * i);
        const double estimate = map_spacing(measured, length, s.drift, std::sqrt(s.variance), sn, i);
        const double growth = std::clamp(estimate / length - 1, -0.5, 0.5) / i;
        const double surprise = growth - s.drift;
        s.variance = std::max((1 - m.average) * s.variance + m.average * surprise * surprise,
                              kMinSpacingSigma * kMinSpacingSigma);
        s.drift = std::clamp((1 - m.average) * s.drift + m.average * growth, -0.1, 0.1);
        const double advance = estimate - length * (d.grown / i);
        s.x += tx * advance * i, s.z += tz * advance * i;
        ex -= tx * advance * i, ez -= tz * advance * i;
        s.vx += tx * (estimate - length), s.vz += tz * (estimate - length);
    }
    s.x += g1 * ex, s.z += g1 * ez;
    s.vx += g2 * ex, s.vz += g2 * ez;
    s.spacing = std::clamp(std::sqrt(s.vx * s.vx + s.vz * s.vz), 0.1 * m.scale.spacing, 10 * m.scale.spacing);
    s.p11 = d.p11 / S, s.p12 = d.p12 / S, s.p22 = d.p22 - d.p12 * g2;
    ++s.age;
    s.excess = std::max(1., s.excess + 0.05 * (0.5 * d.d2 * s.excess - s.excess));
}

// A point that lies within reach of the foot point in any direction: the thesis's test of the spacing alone.
// Used where the direction is unknown: second point of a segment, first point after a sharp edge. Returns the
// ratio to the reach.
inline double reach_ratio(const Model& m, const State& s, double x, double z, int i) {
    const double dx = x - s.x, dz = z - s.z;
    const double reach =
        kSpacingReach * std::max(s.spacing, 0.5 * m.scale.spacing) * i + m.band * 1.5 * m.scale.largest();
    return std::sqrt(dx * dx + dz * dz) / reach;
}

// The state after such a point: direction from the two points, shrunk to what spacing and noise make
// probable.
inline void accept_any_direction(const Model& m, State& s, double x, double z, int i) {
    const double prior = 1.5 * m.scale.spacing, prior2 = prior * prior * i * i;
    const auto weight = [&](double sigma) { return prior2 / (prior2 + 2 * sigma * sigma); };
    const double w = weight(m.scale.largest());
    s.vx = weight(m.scale.sx) * (x - s.x) / i;
    s.vz = weight(m.scale.sz) * (z - s.z) / i;
    s.x = x, s.z = z;
    s.p11 = 1, s.p12 = w / i, s.p22 = 2 * w / (double(i) * i);
    const double length = std::sqrt(s.vx * s.vx + s.vz * s.vz);
    s.spacing = std::clamp(length, 0.3 * m.scale.spacing, 3 * m.scale.spacing);
    s.drift = 0;
    s.variance = m.initial_sigma * m.initial_sigma;
    s.excess = 1;
    s.age = 2;
}

}  // namespace seamwright::contour
