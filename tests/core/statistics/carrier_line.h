#pragma once
// A line of carriers with locators, for the tests of what has moved. Shares no code with the estimator: parts are put against
// moved locators with finite rotations (Newton on the contact of planes and points), then shaken, then measured with noise.

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

namespace seamwright::carrier_line {

// A locator touches the part with a plane across n at p; the part's own point q lies on it.
struct Locator {
    Eigen::Vector3d p, n;
};

// 3-2-1 on a door of 1000 x 800 mm.
inline std::vector<Locator> door_locators() {
    return {{{100, 50, 0}, {0, 0, 1}}, {{900, 60, 0}, {0, 0, 1}}, {{480, 760, 0}, {0, 0, 1}},
            {{150, 0, 40}, {0, 1, 0}}, {{850, 0, 35}, {0, 1, 0}}, {{0, 420, 50}, {1, 0, 0}}};
}

struct Motion {
    Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
    Eigen::Vector3d t = Eigen::Vector3d::Zero();
};

inline Eigen::Matrix3d turned(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    if (angle < 1e-300) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

// Where the part stands when locator i gave way by give[i] along its direction: n . (R p + t - p) = give for each.
inline Motion seated(const std::vector<Locator>& locators, const std::vector<double>& give) {
    Motion m;
    for (int round = 0; round < 30; ++round) {
        Eigen::Matrix<double, 6, 6> jacobian;
        Eigen::Matrix<double, 6, 1> rest;
        for (int i = 0; i < 6; ++i) {
            const auto& l = locators[static_cast<std::size_t>(i)];
            const auto rest_at = [&](const Motion& x) {
                return l.n.dot(x.r * l.p + x.t - l.p) - give[static_cast<std::size_t>(i)];
            };
            rest(i) = rest_at(m);
            for (int k = 0; k < 6; ++k) {  // central differences
                const double h = k < 3 ? 1e-4 : 1e-7;
                Motion up = m, down = m;
                if (k < 3) {
                    up.t(k) += h, down.t(k) -= h;
                } else {
                    const Eigen::Vector3d w = h * Eigen::Vector3d::Unit(k - 3);
                    up.r = turned(w) * m.r, down.r = turned(-w) * m.r;
                }
                jacobian(i, k) = (rest_at(up) - rest_at(down)) / (2 * h);
            }
        }
        const Eigen::Matrix<double, 6, 1> step = jacobian.fullPivLu().solve(-rest);
        m.t += step.head<3>();
        m.r = turned(step.tail<3>()) * m.r;
        if (step.norm() < 1e-13) break;
    }
    return m;
}

// `first` and then `second`, both in the same axes.
inline Motion after(const Motion& first, const Motion& second) {
    return {second.r * first.r, second.r * first.t + second.t};
}

inline Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& r) {
    const Eigen::AngleAxisd a(r);
    return a.angle() * a.axis();
}

}  // namespace seamwright::carrier_line
