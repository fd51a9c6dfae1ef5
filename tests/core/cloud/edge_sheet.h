#pragma once
// A sheet whose one side runs along a curve, and its scan, by formula; shares nothing with what is tried.

#include <cmath>
#include <functional>
#include <random>

#include "core/cloud/edge/edge_curve.h"
#include "tests/core/cloud/test_parts.h"

namespace seamwright::test_parts {

// The sheet is y < side(x) at height(x, y), for x from 0 to kSheetX; below it, `kSheetThick` deeper, another one goes on.
constexpr double kSheetX = 700, kSheetDeep = 45, kSheetThick = 1.2;
inline double sheet_side(double x) {
    return 300 + 45 * std::sin(x / 110) + 30 * std::cos(x / 260) - 2e-4 * x * x;
}
// Where the sensor's field of view ends on the sheet: it follows the side about as a robot does.
inline double seen_from(double x) {
    return sheet_side(x) - kSheetDeep + 6 * std::sin(x / 37);
}
inline double sheet_height(double x, double y) {
    return 18 * std::sin(x / 150) + 0.04 * (y - 300) + 2e-4 * (x - 350) * (x - 350);
}

struct ScanOfSheet {
    double line_mm = 1.5, point_mm = 0.15;  // between profiles, between points of one
    double noise_mm = 0.03, along_mm = 0;   // of a point along its normal, along its profile
    double from = 0, to = 1;                // of the length
    bool one_phase = false;                 // the profiles' points lie alike, not as they come
    bool at_random = false;                 // points anywhere instead of in profiles
    double lost = 0.02;                     // of the points, no return
    bool beneath = true;                    // the sheet below is seen where the upper one has ended
};

inline Cloud sheet_scan(std::mt19937_64& random, const ScanOfSheet& s, const Displacement& form = none()) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(0, 1);
    Cloud c;
    const auto add = [&](double x, double y) {
        const bool upper = y < sheet_side(x);
        if ((!upper && !s.beneath) || uniform(random) < s.lost) return;
        const double h = 1e-3;
        const Vector3d n = Vector3d(-(sheet_height(x + h, y) - sheet_height(x - h, y)) / (2 * h),
                                    -(sheet_height(x, y + h) - sheet_height(x, y - h)) / (2 * h), 1)
                               .normalized();
        const Vector3d p(x, y, sheet_height(x, y));
        c.points.push_back(p + form(p) + (s.noise_mm * normal(random) - (upper ? 0 : kSheetThick)) * n +
                           s.along_mm * normal(random) * Vector3d::UnitY());
        c.towards.push_back(Vector3d(0.1 * normal(random), 0.1, 1).normalized().cast<float>());
    };
    const double first = s.from * kSheetX, last = s.to * kSheetX;
    if (s.at_random) {
        const double area = (last - first) * 60;
        for (double k = 0; k < area / (s.line_mm * s.point_mm); ++k) {
            const double x = first + (last - first) * uniform(random);
            add(x, seen_from(x) + 60 * uniform(random));
        }
        return c;
    }
    for (double x = first; x < last; x += s.line_mm) {
        const double middle = s.one_phase ? 300 : sheet_side(x) + 3 * uniform(random);
        const double low = seen_from(x), phase = s.one_phase ? 0.31 * s.point_mm : 0;
        const double begin = middle + phase + s.point_mm * std::floor((low - middle) / s.point_mm);
        for (double y = begin; y < low + 60; y += s.point_mm) add(x, y);
    }
    return c;
}

inline EdgeCurve sheet_edge() {
    const auto place = [](double x) { return Vector3d(x, sheet_side(x), sheet_height(x, sheet_side(x))); };
    EdgeCurve curve;
    curve.name = "side";
    for (double x = 0; x <= kSheetX; x += 1.5) {
        EdgeSample s;
        s.point_mm = place(x);
        s.tangent = (place(x + 1e-3) - place(x - 1e-3)).normalized();
        const double h = 1e-3, y = sheet_side(x);
        s.normal = Vector3d(-(sheet_height(x + h, y) - sheet_height(x - h, y)) / (2 * h),
                            -(sheet_height(x, y + h) - sheet_height(x, y - h)) / (2 * h), 1)
                       .normalized();
        s.outward = s.tangent.cross(s.normal);
        if (s.outward.y() < 0) s.outward = -s.outward;
        if (!curve.samples.empty())
            s.arc_mm = curve.samples.back().arc_mm +
                       (s.point_mm - curve.samples.back().point_mm).norm() * (1 + 1e-9);
        curve.samples.push_back(s);
    }
    return curve;
}

inline TriangleMesh sheet_mesh() {
    TriangleMesh m;
    const auto p = [](double x, double v) {
        const double y = sheet_side(x) - v;
        return Vector3d(x, y, sheet_height(x, y));
    };
    for (double x = 0; x < kSheetX; x += 10)
        for (double v = 0; v < 300; v += 20) quad(m, p(x, v + 20), p(x + 10, v + 20), p(x + 10, v), p(x, v));
    return m;
}

}  // namespace seamwright::test_parts
