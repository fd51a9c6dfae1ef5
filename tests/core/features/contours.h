#pragma once
// Contours with known truth: polygons and arcs sampled along x like a profile sensor does, noise, clutter,
// occlusion.

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "core/features/registration/registration.h"
#include "core/geometry/pose.h"
#include "core/profile/profile.h"

namespace seamwright::test {

using Random = std::mt19937_64;

// A contour as a dense polygon (fine compared to any pitch used).
struct Shape {
    std::vector<double> x, z;
    void line_to(double px, double pz, double step = 0.01) {
        if (x.empty()) {
            x.push_back(px);
            z.push_back(pz);
            return;
        }
        const double x0 = x.back(), z0 = z.back();
        const int n = std::max(1, static_cast<int>(std::ceil(std::hypot(px - x0, pz - z0) / step)));
        for (int i = 1; i <= n; ++i) {
            x.push_back(x0 + (px - x0) * i / n);
            z.push_back(z0 + (pz - z0) * i / n);
        }
    }
    void arc(double cx, double cz, double radius, double from_deg, double to_deg) {
        const int n = std::max(2, static_cast<int>(std::abs(to_deg - from_deg) * radius * kPi / 180 / 0.01));
        for (int i = 0; i <= n; ++i) {
            const double a = rad_from_deg(from_deg + (to_deg - from_deg) * i / n);
            line_to(cx + radius * std::cos(a), cz + radius * std::sin(a));
        }
    }
    Shape moved(const PlanarMotion& m) const {
        Shape s;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Eigen::Vector2d p = m * Eigen::Vector2d(x[i], z[i]);
            s.x.push_back(p.x());
            s.z.push_back(p.y());
        }
        return s;
    }
};

// What the sensor sees: at every line x the highest crossing (nearer parts hide what is below), none where
// the shape is not.
inline Profile sample(const Shape& s, double pitch, double phase = 0.5) {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const double x : s.x) {
        lo = std::min(lo, x);
        hi = std::max(hi, x);
    }
    const auto n = static_cast<std::size_t>(std::max(0.0, (hi - lo) / pitch - phase)) + 1;
    std::vector<double> z(n, -std::numeric_limits<double>::infinity());
    for (std::size_t i = 1; i < s.x.size(); ++i) {
        double xa = s.x[i - 1], za = s.z[i - 1], xb = s.x[i], zb = s.z[i];
        if (xa > xb) {
            std::swap(xa, xb);
            std::swap(za, zb);
        }
        const double ka = (xa - lo) / pitch - phase, kb = (xb - lo) / pitch - phase;
        for (double k = std::ceil(ka); k <= kb; k += 1) {
            if (k < 0 || k >= double(n)) continue;
            const double t = kb > ka ? (k - ka) / (kb - ka) : 0.5;
            auto& cell = z[static_cast<std::size_t>(k)];
            cell = std::max(cell, za + t * (zb - za));
        }
    }
    Profile p;
    for (std::size_t k = 0; k < n; ++k)
        if (std::isfinite(z[k])) {
            p.x_mm.push_back(lo + pitch * (double(k) + phase));
            p.z_mm.push_back(z[k]);
        }
    return p;
}

inline void add_noise(Profile& p, double sigma, Random& random) {
    std::normal_distribution<double> noise;
    for (double& z : p.z_mm) z += sigma * noise(random);
}

// A random `share` of points replaced by clutter somewhere in the picture.
inline void add_clutter(Profile& p, double share, Random& random) {
    double lo = 1e9, hi = -1e9;
    for (const double z : p.z_mm) {
        lo = std::min(lo, z);
        hi = std::max(hi, z);
    }
    std::uniform_real_distribution<double> coin(0, 1), height(lo - 5, hi + 5);
    for (double& z : p.z_mm)
        if (coin(random) < share) z = height(random);
}

// A connected `share` of the points removed.
inline void occlude(Profile& p, double share, Random& random) {
    const auto n = p.size();
    const auto gone = static_cast<std::size_t>(share * double(n));
    const auto first = std::uniform_int_distribution<std::size_t>(0, n - gone)(random);
    auto cut = [&](std::vector<double>& v) {
        v.erase(v.begin() + static_cast<std::ptrdiff_t>(first),
                v.begin() + static_cast<std::ptrdiff_t>(first + gone));
    };
    cut(p.x_mm);
    cut(p.z_mm);
}

inline Shape bead(double left, double right, double at, double width, double height) {
    Shape s;
    s.line_to(left, 0);
    const double a = 0.5 * width, r = (a * a + height * height) / (2 * height);
    const double half = deg_from_rad(std::asin(std::min(1.0, a / r)));
    s.line_to(at - a, 0);
    s.arc(at, height - r, r, 90 + half, 90 - half);
    s.line_to(right, 0);
    return s;
}
// All shapes continue alike whatever their ends, so a short one is a template of a long one.
// A sheet folded over: flat, one thickness up, rounded, and down to a lower neighbour.
inline Shape hem(double left, double right) {
    Shape s;
    s.line_to(left, 0.4 + 0.02 * (left + 4));
    s.line_to(-4, 0.4);
    s.line_to(-3.7, 1.2);
    s.line_to(2, 1.5);
    s.arc(2, 0.3, 1.2, 90, 0);
    s.line_to(3.4, -3);
    s.line_to(right, -3 - 0.02 * (right - 3.4));
    return s;
}
inline Shape corner(double left, double right) {
    Shape s;
    s.line_to(left, 3 + 0.25 * left);
    s.line_to(0, 3);
    s.line_to(right, 3 - 0.4 * right);
    return s;
}
inline Shape joggle(double left, double right) {
    Shape s;
    s.line_to(left, 0.3 + 0.01 * (left + 1));
    s.line_to(-1, 0.3);
    s.line_to(1, 2.3);
    s.line_to(right, 2.3 + 0.01 * (right - 1));
    return s;
}
inline Shape step(double left, double right, double height) {
    Shape s;
    s.line_to(left, 0);
    s.line_to(0, 0);
    s.line_to(0, height);
    s.line_to(right, height);
    return s;
}

}  // namespace seamwright::test
