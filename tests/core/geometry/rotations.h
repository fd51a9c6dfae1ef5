#pragma once
// Rotation vectors (rad) at which laws are tested: identity, tiny, ordinary, near 180 degrees and on it.

#include <random>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

inline std::vector<Eigen::Vector3d> testing_rotation_vectors() {
    std::vector<Eigen::Vector3d> w{Eigen::Vector3d::Zero()};
    std::mt19937 rng(7);
    std::normal_distribution<double> n;
    for (double angle :
         {1e-12, 1e-8, 9.9e-5, 1.01e-4, 1e-3, 0.1, 1.0, kPi / 2, 3.0, kPi - 1e-4, kPi - 1e-8, kPi}) {
        for (int axis = 0; axis < 3; ++axis) w.push_back(angle * Eigen::Vector3d::Unit(axis));
        for (int i = 0; i < 20; ++i)
            w.push_back(angle * Eigen::Vector3d(n(rng), n(rng), n(rng)).normalized());
    }
    return w;
}

}  // namespace seamwright
