#pragma once
// Contours that two heads see from either side, as one merged profile. Parallel rays of each head. Shares nothing with the
// estimators nor with the other generators.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "core/geometry/pose.h"
#include "core/panel/double_head.h"
#include "core/profile/filter.h"

namespace seamwright {

using Parts = std::vector<std::vector<Eigen::Vector2d>>;

struct Dicing {
    std::mt19937_64 engine;
    double uniform(double a, double b) {
        return a + (b - a) * std::uniform_real_distribution<double>(0, 1)(engine);
    }
    double normal() { return std::normal_distribution<double>()(engine); }
};

struct EyeOfHead {
    double pitch_mm, noise_mm, tilt_rad;
};

// Nothing returns that the rays meet at less than ten degrees.
inline DoubleHeadProfile merged_view(const Parts& parts, const EyeOfHead (&eyes)[2], Dicing& dice) {
    constexpr double kHalfField = 15, kLeastSine = 0.17;
    Profile profiles[2];
    Pose poses[2];
    for (const int h : {0, 1}) {
        const EyeOfHead& eye = eyes[h];
        poses[h] = make_pose(rotation_exp({0, eye.tilt_rad, 0}), {0, 0, 0});
        Parts seen = parts;
        for (auto& part : seen)
            for (Eigen::Vector2d& p : part) {
                const Eigen::Vector3d q = poses[h].inverse() * Eigen::Vector3d(p.x(), 0, p.y());
                p = {q.x(), q.z()};
            }
        for (double x = -kHalfField + eye.pitch_mm * dice.uniform(0, 1); x < kHalfField; x += eye.pitch_mm) {
            double highest = -1e9;
            bool grazed = false;
            for (const auto& part : seen)
                for (std::size_t i = 1; i < part.size(); ++i) {
                    const Eigen::Vector2d a = part[i - 1], e = part[i] - a;
                    const double t = (x - a.x()) / e.x(), z = a.y() + t * e.y();
                    if (!(t >= 0 && t <= 1) || z <= highest) continue;
                    highest = z;
                    grazed = std::abs(e.x()) < kLeastSine * e.norm();
                }
            const double noise = eye.noise_mm * dice.normal();
            profiles[h].x_mm.push_back(x);
            profiles[h].z_mm.push_back(highest > -1e8 && !grazed ? highest + noise : std::nan(""));
        }
        EXPECT_TRUE(filter_profile(profiles[h], {}));
    }
    DoubleHeadOptions options;
    options.disagreement_limit_mm = 0.3;
    return merge_heads(profiles[0], {poses[0], eyes[0].noise_mm}, profiles[1], {poses[1], eyes[1].noise_mm},
                       options)
        .value();
}

}  // namespace seamwright
