#pragma once
// Profiles with known truth for the tests and benchmarks of the filter. Made from geometry, not from the
// filter's model: pieces of straight line, arc and wave joined by sharp edges and jumps, sampled as sensors
// sample, with noise, missing returns and bursts of outliers put on afterwards.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/profile/profile.h"

namespace seamwright::synthetic {

struct Recipe {
    int points = 1000;
    double spacing = 0.1;  // mm, see arc_spacing
    double noise = 0.02;   // mm
    double max_slope_deg = 70;
    double outlier_share = 0.05;
    double outlier_min = 0.3, outlier_max = 10;  // mm along z
    int outlier_sign = 0;                        // 0: either, +1/-1: one side only
    bool arc_spacing = false;                    // points equally spaced along the contour instead of along x
    bool isotropic = false;                      // noise in x too, else along z only
    double jitter = 0;      // share of the spacing by which points slide along the contour
    bool curved = true;     // arcs and waves beside straight pieces
    double min_radius = 8;  // mm
    double jumps_per_1000 = 6, edges_per_1000 = 10;
    double jump_min = 0.5, jump_max = 20;  // mm
    double missing_share = 0.01;           // single missing returns
    int min_piece = 12;                    // points
    bool clear = true;                     // only what can be decided: see make()
};

struct Truth {
    Profile profile;
    std::vector<char> outlier;  // 1: put off the contour
    std::vector<int> jump;      // rows at which a new contour begins
};

class Maker {
  public:
    explicit Maker(std::uint64_t seed) : random_(seed) {}
    double uniform(double a, double b) { return std::uniform_real_distribution<>(a, b)(random_); }
    double normal() { return std::normal_distribution<>()(random_); }
    int whole(int a, int b) { return std::uniform_int_distribution<>(a, b)(random_); }
    bool chance(double p) { return uniform(0, 1) < p; }

    // `clear`: outliers stay seven sigma off the contour across it, jumps ten sigma and four spacings.
    Truth make(const Recipe& r) {
        Truth t;
        const double nan = std::numeric_limits<double>::quiet_NaN();
        const double top = r.max_slope_deg * std::numbers::pi / 180;
        double x = uniform(-50, 50), z = uniform(-50, 50);
        double slope = uniform(-top, top);
        std::vector<double> angle;
        const double density = (r.jumps_per_1000 + r.edges_per_1000) / 1000;
        while (int(t.profile.size()) < r.points) {
            // One piece.
            int length =
                density > 0 ? std::max(r.min_piece, int(-std::log(uniform(1e-9, 1)) / density)) : r.points;
            if (int(t.profile.size()) + length + kMostMissing + r.min_piece > r.points) length = r.points;
            const int kind = r.curved ? whole(0, 2) : 0;
            double curvature = 0, wave = 0, wave_length = 1;
            const double turn = chance(0.5) ? 1 : -1;
            if (kind == 1) curvature = turn / (r.min_radius * std::exp(uniform(0, 3)));
            if (kind == 2) {
                wave_length = r.spacing * uniform(60, 400);
                wave = turn * std::min(0.3, wave_length / (2 * std::numbers::pi * r.min_radius));
            }
            const double base = slope;
            double run = 0;
            for (int k = 0; k < length && int(t.profile.size()) < r.points; ++k) {
                double here =
                    kind == 2 ? base + wave * std::sin(2 * std::numbers::pi * run / wave_length) : slope;
                here = std::clamp(here, -top, top);
                if (k > 0 || t.profile.size() == 0) {
                    const double ds = r.arc_spacing ? r.spacing : r.spacing / std::cos(here);
                    x += ds * std::cos(here), z += ds * std::sin(here), run += ds;
                    slope = std::clamp(here + curvature * ds, -top, top);
                }
                push(t, x, z);
                angle.push_back(here);
            }
            if (int(t.profile.size()) >= r.points) break;
            const double here = slope;
            if (chance(r.jumps_per_1000 / (r.jumps_per_1000 + r.edges_per_1000))) {
                slope = chance(0.5) ? here : uniform(-top, top);
                const double ds = r.arc_spacing
                                      ? r.spacing
                                      : r.spacing / std::cos(std::max(std::abs(here), std::abs(slope)));
                const double least =
                    r.clear ? std::max({r.jump_min, 10 * r.noise / 0.34, 5 * ds / 0.34}) : r.jump_min;
                const double size =
                    std::max(least, r.jump_min * std::pow(r.jump_max / r.jump_min, uniform(0, 1)));
                const int missing = chance(0.4) ? whole(1, kMostMissing) : 0;
                for (int k = 0; k < missing && int(t.profile.size()) < r.points; ++k)
                    push(t, nan, nan), angle.push_back(0);
                x += r.spacing * (missing + 1);
                z += r.spacing * (missing + 1) * std::tan(here);
                if (missing == 0 && chance(0.3))
                    x += std::max(size, (r.clear ? 8 * ds : 0.));  // a gap of lines not delivered
                else {
                    // A step that the two slopes explain as a sharp edge inside the missing lines is none to
                    // see.
                    const double bend = r.spacing * (missing + 1) * (std::tan(slope) - std::tan(here));
                    const bool hidden = r.clear && size < 2 * std::abs(bend);
                    z += (hidden ? -std::copysign(1., bend) : chance(0.5) ? 1 : -1) * size;
                }
                if (int(t.profile.size()) < r.points) t.jump.push_back(int(t.profile.size()));
            } else {
                // Off the end of the old piece, in a new direction.
                for (int k = 0; k < 20; ++k) {
                    slope = uniform(-top, top);
                    if (std::abs(slope - here) > 0.15) break;
                }
                const double ds = r.arc_spacing ? r.spacing : r.spacing / std::cos(slope);
                x += ds * std::cos(slope), z += ds * std::sin(slope);
            }
        }
        spoil(t, r, angle);
        return t;
    }

  private:
    static constexpr int kMostMissing = 40;

    static void push(Truth& t, double x, double z) {
        t.profile.x_mm.push_back(x), t.profile.z_mm.push_back(z);
    }

    void spoil(Truth& t, const Recipe& r, const std::vector<double>& angle) {
        const int n = int(t.profile.size());
        t.outlier.assign(std::size_t(n), 0);
        const double nan = std::numeric_limits<double>::quiet_NaN();
        for (int k = 0; k < n; ++k) {
            const double a = angle[std::size_t(k)];
            auto &x = t.profile.x_mm[std::size_t(k)], &z = t.profile.z_mm[std::size_t(k)];
            const double slide =
                r.jitter * uniform(-0.5, 0.5) * (r.arc_spacing ? r.spacing : r.spacing / std::cos(a));
            x += slide * std::cos(a), z += slide * std::sin(a);
            if (r.isotropic) x += r.noise * normal();
            z += r.noise * normal();
        }
        const double start = r.outlier_share / 2;
        for (int k = 0; k < n; ++k) {
            if (!chance(start)) continue;
            const int length = whole(1, 3);
            const bool shared = chance(0.5);
            double offset = 0;
            for (int b = 0; b < length && k < n; ++b, ++k) {
                const double a = angle[std::size_t(k)];
                const double across = r.isotropic ? 1 / std::cos(a) : 1;
                double least = r.outlier_min;
                if (r.clear) least = std::max(least, 7 * r.noise * across);
                if (b == 0 || !shared) {
                    const double sign = r.outlier_sign ? r.outlier_sign : (chance(0.5) ? 1 : -1);
                    offset = sign * std::max(least, uniform(r.outlier_min, r.outlier_max));
                }
                t.profile.z_mm[std::size_t(k)] += std::copysign(std::max(std::abs(offset), least), offset);
                t.outlier[std::size_t(k)] = 1;
            }
            --k;  // the next burst may follow at once
        }
        for (int k = 0; k < n; ++k)
            if (chance(r.missing_share))
                t.profile.x_mm[std::size_t(k)] = t.profile.z_mm[std::size_t(k)] = nan;
    }

    std::mt19937_64 random_;
};

// Counts over any number of profiles.
struct Score {
    int true_positive = 0, false_positive = 0, false_negative = 0;
    int jumps = 0, jumps_found = 0, jumps_invented = 0;
    double f1() const {
        const int denominator = 2 * true_positive + false_positive + false_negative;
        return denominator > 0 ? 2. * true_positive / denominator : 1;
    }
    // A jump is found when the segment changes at a row within one point of it; rows that are outliers or
    // missing at the jump belong to neither side. Changes elsewhere are invented.
    void add(const Truth& t, const std::vector<std::int32_t>& segment) {
        const int n = int(t.profile.size());
        const auto there = [&](int k) { return std::isfinite(t.profile.z_mm[std::size_t(k)]); };
        for (int k = 0; k < n; ++k) {
            if (!there(k)) continue;
            const bool marked = segment[std::size_t(k)] < 0, wrong = t.outlier[std::size_t(k)];
            true_positive += marked && wrong, false_positive += marked && !wrong,
                false_negative += !marked && wrong;
        }
        // Truth as intervals of rows: from the last good point before to the first good point after the jump.
        struct Span {
            int from, to;
            bool found;
        };
        std::vector<Span> spans;
        for (const int j : t.jump) {
            int a = j - 1, b = j;
            while (a >= 0 && (!there(a) || t.outlier[std::size_t(a)])) --a;
            while (b < n && (!there(b) || t.outlier[std::size_t(b)])) ++b;
            if (a >= 0 && b < n) spans.push_back({a, b, false});
        }
        int last = -1;
        for (int k = 0; k < n; ++k) {
            if (segment[std::size_t(k)] < 0) continue;
            if (last >= 0 && segment[std::size_t(k)] != segment[std::size_t(last)]) {
                bool known = false;
                for (Span& s : spans)
                    if (k >= s.from && k <= s.to + 1) {
                        known = true;
                        if (std::abs(k - s.to) <= 1) s.found = true;
                    }
                jumps_invented += !known;
            }
            last = k;
        }
        for (const Span& s : spans) ++jumps, jumps_found += s.found;
    }
};

}  // namespace seamwright::synthetic
