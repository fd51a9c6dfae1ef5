// The stated intervals of a hand-eye calibration, where the camera knows distance and tilt far worse than the
// place across, as cameras do. Poses and errors are made here, by Eigen alone.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/calibration/pose/hand_eye.h"

namespace seamwright {
namespace {

using Isometry = Eigen::Isometry3d;

Isometry screw(const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
    Isometry m = Isometry::Identity();
    if (turn.norm() > 0) m.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).matrix();
    m.translation() = shift;
    return m;
}

// Share of the six parameters' true values within 1.96 sigma.
double coverage(Mount mount, int pairs, double tilt_rad, double depth_mm, unsigned seed, int trials) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> n;
    std::uniform_real_distribution<double> u(-1, 1);
    const auto noise = [&](double x, double y, double z) {
        return Eigen::Vector3d(x * n(engine), y * n(engine), z * n(engine));
    };
    const auto box = [&](double x, double y, double z) {
        return Eigen::Vector3d(x * u(engine), y * u(engine), z * u(engine));
    };
    int inside = 0, asked = 0;
    const bool fixed = mount == Mount::eye_to_hand;
    for (int trial = 0; trial < trials; ++trial) {
        const Isometry camera = screw(
            box(0.8, 0.8, 0.8), fixed ? Eigen::Vector3d(1500, 200, 900) : Eigen::Vector3d(80, -30, 150));
        const Isometry target =
            screw(box(0.8, 0.8, 0.8), fixed ? Eigen::Vector3d(20, 40, 110) : Eigen::Vector3d(1200, 100, 300));
        std::vector<HandEyePair> list;
        for (int i = 0; i < pairs; ++i) {
            const Isometry seen =
                screw(box(0.6, 0.6, 0.6), fixed ? Eigen::Vector3d(0, 0, 1100) + box(250, 200, 150)
                                                : Eigen::Vector3d(0, 0, 500) + box(60, 60, 60));
            const Isometry a = target * (camera * seen).inverse();
            const Isometry robot =
                (fixed ? a.inverse() : a) * screw(noise(2e-4, 2e-4, 2e-4), noise(0.06, 0.06, 0.06));
            Isometry found = screw(noise(tilt_rad, tilt_rad, 2e-4), Eigen::Vector3d::Zero());
            found.linear() = (found.linear() * seen.linear()).eval();
            found.translation() = seen.translation() + noise(0.04, 0.04, depth_mm);
            list.push_back({"p" + std::to_string(i), Pose(robot.matrix()), Pose(found.matrix())});
        }
        const auto r = calibrate_hand_eye(mount, list);
        if (!r || r->status != HandEyeStatus::ok) continue;
        const Eigen::AngleAxisd turn(Eigen::Matrix3d(r->x.linear() * camera.linear().transpose()));
        Vector6 off;
        off << r->x.translation() - camera.translation(), turn.angle() * turn.axis();
        for (int k = 0; k < 6; ++k) {
            inside += std::abs(off[k]) < 1.96 * std::sqrt(r->covariance_x(k, k));
            ++asked;
        }
    }
    EXPECT_GE(asked, 5 * trials);
    return static_cast<double>(inside) / asked;
}

TEST(HandEyeInterval, HoldsWhatItStatesForACameraThatSeesDistanceAndTiltWorse) {
    // 360 values, six of a trial together: the share itself is known to two hundredths.
    for (const int pairs : {8, 15}) {
        SCOPED_TRACE(pairs);
        for (const double tilt : {2e-4, 1e-3, 2e-3}) {
            EXPECT_GE(coverage(Mount::eye_to_hand, pairs, tilt, 400 * tilt, 5, 60), 0.86) << tilt;
            EXPECT_GE(coverage(Mount::eye_in_hand, pairs, tilt, 400 * tilt, 6, 60), 0.92) << tilt;
        }
        EXPECT_LE(coverage(Mount::eye_to_hand, pairs, 2e-4, 0.08, 7, 60), 0.99) << "and not all";
    }
}

}  // namespace
}  // namespace seamwright
