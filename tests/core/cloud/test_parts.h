#pragma once
// Parts and their scans by formula, sharing nothing with what is tried.

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "core/cloud/cloud.h"
#include "core/geometry/triangle_mesh.h"

namespace seamwright::test_parts {

using Eigen::Vector3d;

// A pressed panel of 600 x 400 mm: a recess with sloping walls, a bead across, a dome, and a hem of 12 mm bent down along
// three sides. Smooth; no symmetry.
inline double panel_height(double x, double y) {
    const auto step = [](double t) { return 0.5 * (1 + std::tanh(t)); };
    const double recess =
        step((x - 120) / 12) * step((470 - x) / 14) * step((y - 80) / 12) * step((330 - y) / 16);
    const double bead = std::exp(-std::pow((x + 0.35 * y - 330) / 14, 2));
    const double dome = std::exp(-(std::pow(x - 520, 2) + std::pow(y - 90, 2)) / 900);
    return -14 * recess + 5 * bead + 7 * dome + 2e-5 * (x - 300) * (x - 300);
}
inline Vector3d panel_normal(double x, double y) {
    const double h = 1e-3;
    return Vector3d(-(panel_height(x + h, y) - panel_height(x - h, y)) / (2 * h),
                    -(panel_height(x, y + h) - panel_height(x, y - h)) / (2 * h), 1)
        .normalized();
}
constexpr double kPanelX = 600, kPanelY = 400, kHem = 12;

inline void quad(TriangleMesh& m, const Vector3d& a, const Vector3d& b, const Vector3d& c,
                 const Vector3d& d) {
    const int n = static_cast<int>(m.vertices.size());
    for (const auto& v : {a, b, c, d}) m.vertices.push_back(v);
    m.triangles.emplace_back(n, n + 1, n + 2);
    m.triangles.emplace_back(n, n + 2, n + 3);
}

inline TriangleMesh panel(double step = 4) {
    TriangleMesh m;
    const auto p = [](double x, double y) { return Vector3d(x, y, panel_height(x, y)); };
    const Vector3d down(0, 0, -kHem);
    for (double x = 0; x < kPanelX; x += step)
        for (double y = 0; y < kPanelY; y += step)
            quad(m, p(x, y), p(x + step, y), p(x + step, y + step), p(x, y + step));
    for (double x = 0; x < kPanelX; x += step)
        quad(m, p(x, 0) + down, p(x + step, 0) + down, p(x + step, 0), p(x, 0));
    for (double y = 0; y < kPanelY; y += step) {
        quad(m, p(0, y + step) + down, p(0, y) + down, p(0, y), p(0, y + step));
        quad(m, p(kPanelX, y) + down, p(kPanelX, y + step) + down, p(kPanelX, y + step), p(kPanelX, y));
    }
    return m;
}

// A field of displacements: cosines of random direction and wavelength between the limits.
class FormField {
  public:
    FormField(std::mt19937_64& random, double sigma_mm, double shortest_mm, double longest_mm,
              int waves = 24) {
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> uniform(0, 1);
        for (int k = 0; k < waves; ++k) {
            const Vector3d direction = Vector3d(normal(random), normal(random), normal(random)).normalized();
            const double length = shortest_mm * std::pow(longest_mm / shortest_mm, uniform(random));
            waves_.push_back(
                {direction * (2 * M_PI / length),
                 sigma_mm * std::sqrt(2.0 / waves) * Vector3d(normal(random), normal(random), normal(random)),
                 2 * M_PI * uniform(random)});
        }
    }
    Vector3d at(const Vector3d& p) const {
        Vector3d d = Vector3d::Zero();
        for (const Wave& w : waves_) d += w.amplitude * std::cos(w.k.dot(p) + w.phase);
        return d;
    }

  private:
    struct Wave {
        Vector3d k, amplitude;
        double phase;
    };
    std::vector<Wave> waves_;
};

using Displacement = std::function<Vector3d(const Vector3d&)>;
inline Displacement none() {
    return [](const Vector3d&) { return Vector3d::Zero().eval(); };
}

// Points of the panel in the part's frame, seen from above (hem: from its side), `share` of its length seen.
inline Cloud panel_scan(std::mt19937_64& random, std::size_t count, double noise_mm, double share = 1,
                        const Displacement& form = none()) {
    std::normal_distribution<double> noise(0, std::max(noise_mm, 1e-12));
    std::uniform_real_distribution<double> uniform(0, 1);
    Cloud c;
    while (c.size() < count) {
        Vector3d p, n;
        if (uniform(random) < 0.1) {
            const double along = uniform(random), deep = -kHem * uniform(random);
            const double which = uniform(random);
            if (which < 0.43) {
                p = {along * kPanelX, 0, 0}, n = -Vector3d::UnitY();
            } else if (which < 0.72) {
                p = {0, along * kPanelY, 0}, n = -Vector3d::UnitX();
            } else {
                p = {kPanelX, along * kPanelY, 0}, n = Vector3d::UnitX();
            }
            p.z() = panel_height(p.x(), p.y()) + deep;
        } else {
            p = {kPanelX * uniform(random), kPanelY * uniform(random), 0};
            p.z() = panel_height(p.x(), p.y());
            n = panel_normal(p.x(), p.y());
        }
        if (p.x() > share * kPanelX) continue;
        c.points.push_back(p + form(p) + noise(random) * n);
        c.towards.push_back(n.cast<float>());
    }
    return c;
}

// Six faces about the origin.
inline TriangleMesh box(const Vector3d& size) {
    TriangleMesh m;
    for (int axis = 0; axis < 3; ++axis)
        for (int side : {-1, 1}) {
            const Vector3d n = side * Vector3d::Unit(axis), u = Vector3d::Unit((axis + 1) % 3),
                           v = n.cross(u);
            const Vector3d a = n.cwiseProduct(size) / 2, b = u.cwiseProduct(size) / 2,
                           c = v.cwiseProduct(size) / 2;
            quad(m, a - b - c, a + b - c, a + b + c, a - b + c);
        }
    return m;
}
// Points on those of its faces whose side is in `faces` (bit 2 * axis + (negative side)).
inline Cloud box_scan(std::mt19937_64& random, const Vector3d& size, std::size_t count, double noise_mm,
                      unsigned faces = 63) {
    std::normal_distribution<double> noise(0, std::max(noise_mm, 1e-12));
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    Cloud c;
    while (c.size() < count) {
        const unsigned face = static_cast<unsigned>(random() % 6);
        if ((faces >> face & 1U) == 0) continue;
        const int axis = static_cast<int>(face / 2);
        const Vector3d n = (face % 2 != 0 ? -1 : 1) * Vector3d::Unit(axis);
        Vector3d p = Vector3d(uniform(random), uniform(random), uniform(random)).cwiseProduct(size);
        p[axis] = n[axis] * size[axis] / 2;
        c.points.push_back(p + noise(random) * n);
        c.towards.push_back(n.cast<float>());
    }
    return c;
}

// About Z, without its ends.
inline TriangleMesh cylinder(double radius, double height, int facets) {
    TriangleMesh m;
    const auto at = [&](int k, double z) {
        const double a = 2 * M_PI * k / facets;
        return Vector3d(radius * std::cos(a), radius * std::sin(a), z);
    };
    for (int k = 0; k < facets; ++k) quad(m, at(k, 0), at(k + 1, 0), at(k + 1, height), at(k, height));
    return m;
}

// An angle of sheet: an extruded L with a third leg at one end, so that nothing is alike when turned.
inline TriangleMesh bracket() {
    TriangleMesh m;
    const auto add = [&](const Vector3d& size, const Vector3d& middle) {
        TriangleMesh b = box(size);
        const int n = static_cast<int>(m.vertices.size());
        for (auto& v : b.vertices) m.vertices.push_back(v + middle);
        for (auto& t : b.triangles) m.triangles.push_back(t + Eigen::Vector3i::Constant(n));
    };
    add({200, 80, 8}, {0, 0, 0});
    add({8, 80, 60}, {-96, 0, 34});
    add({40, 8, 30}, {60, 36, 19});
    return m;
}

inline Pose random_pose(std::mt19937_64& random, double angle_rad, double shift_mm) {
    std::normal_distribution<double> normal;
    const Vector3d axis = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Vector3d shift = Vector3d(normal(random), normal(random), normal(random)).normalized();
    std::uniform_real_distribution<double> uniform(0, 1);
    return make_pose(rotation_exp(angle_rad * uniform(random) * axis), shift_mm * uniform(random) * shift);
}

}  // namespace seamwright::test_parts
