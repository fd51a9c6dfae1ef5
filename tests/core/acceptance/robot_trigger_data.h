#pragma once
// Returns and passes as the models of robot_study.h and trigger_study.h say, from the definitions.

#include <random>
#include <string>
#include <vector>

#include "core/acceptance/equipment/robot_study.h"
#include "core/acceptance/equipment/trigger_study.h"
#include "core/geometry/pose.h"

namespace seamwright {

// A sensor turned about the base's Z, then about its own X: a displacement moves the feature the other way along the
// sensor's x and z.
inline Eigen::Matrix<double, 2, 3> looking(double about_z, double about_x) {
    const Eigen::Matrix3d axes = (Eigen::AngleAxisd(about_z, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(about_x, Eigen::Vector3d::UnitX()))
                                     .toRotationMatrix();
    Eigen::Matrix<double, 2, 3> sees;
    sees.row(0) = -axes.col(0).transpose();
    sees.row(1) = -axes.col(2).transpose();
    return sees;
}

inline SpotReturns simulated_returns(const std::string& id, const Eigen::Matrix<double, 2, 3>& sees,
                                     const Eigen::Matrix3d& covariance, double noise_mm, int returns,
                                     int profiles, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    // Any square root will do; this one is of the LDL^T kind by hand, for covariances of less than full rank too.
    Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j) {
            double rest = covariance(i, j);
            for (int k = 0; k < j; ++k) rest -= root(i, k) * root(j, k);
            root(i, j) = i == j ? std::sqrt(std::max(0.0, rest)) : root(j, j) > 0 ? rest / root(j, j) : 0;
        }
    SpotReturns spot{id, sees, true, true, {0, 0}, {}};
    for (int j = 0; j < returns; ++j) {
        Eigen::Vector3d q;
        for (int i = 0; i < 3; ++i) q[i] = normal(random);
        const Eigen::Vector2d at = Eigen::Vector2d(-12, 3) + sees * (root * q);
        auto& taken = spot.returns.emplace_back();
        for (int i = 0; i < profiles; ++i) {
            const double x = normal(random), z = normal(random);
            taken.push_back(at + noise_mm * Eigen::Vector2d(x, z));
        }
    }
    return spot;
}

// `each` passes a speed and direction, and as many stopped ones. Jitter uniform over +-half_ms.
inline std::vector<TriggerPass> simulated_passes(const std::vector<double>& speeds, int each,
                                                 double latency_ms, double half_ms, double standing_mm,
                                                 double reversal_mm, double offset_mm,
                                                 std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<TriggerPass> passes;
    std::vector<double> all = speeds;
    all.push_back(0);
    for (const double speed : all)
        for (int i = 0; i < 2 * each; ++i) {
            const bool backward = i % 2;
            const double v = backward ? -speed : speed;
            const double late_ms = latency_ms + half_ms * uniform(random);
            passes.push_back({speed == 0 ? 0 : v, backward,
                              offset_mm + (backward ? -reversal_mm : reversal_mm) + 1e-3 * v * late_ms +
                                  standing_mm * normal(random)});
        }
    return passes;
}

}  // namespace seamwright
