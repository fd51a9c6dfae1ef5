#include "core/geometry/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/core/geometry/rotations.h"

namespace seamwright {
namespace {

Pose random_pose(std::mt19937& rng) {
    std::normal_distribution<double> n;
    return make_pose(rotation_exp(Eigen::Vector3d(n(rng), n(rng), n(rng))),
                     300.0 * Eigen::Vector3d(n(rng), n(rng), n(rng)));
}

TEST(Rotation, ExpIsARotationAndLogInvertsItFromZeroToPi) {
    for (const Eigen::Vector3d& w : testing_rotation_vectors()) {
        const Eigen::Matrix3d r = rotation_exp(w);
        EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_NEAR(r.determinant(), 1.0, 1e-14);
        EXPECT_LT((rotation_exp(rotation_log(r)) - r).cwiseAbs().maxCoeff(), 1e-14) << w.transpose();
        if (w.norm() < kPi - 1e-6) {
            EXPECT_LT((rotation_log(r) - w).norm(), 1e-12 + 1e-8 * w.norm()) << w.transpose();
        }
    }
}

TEST(Rotation, ExpAgreesWithAngleAxis) {
    for (const Eigen::Vector3d& w : testing_rotation_vectors()) {
        if (w.norm() < 1e-300) continue;
        const Eigen::Matrix3d oracle = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
        EXPECT_LT((rotation_exp(w) - oracle).cwiseAbs().maxCoeff(), 1e-14);
    }
}

TEST(Rotation, BetweenTwoDirectionsIsTheSmallest) {
    std::mt19937 rng(3);
    std::normal_distribution<double> n;
    for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d a = Eigen::Vector3d(n(rng), n(rng), n(rng)).normalized();
        Eigen::Vector3d b = Eigen::Vector3d(n(rng), n(rng), n(rng)).normalized();
        if (i % 4 == 0) b = (-a + std::pow(10.0, -i / 10) * b).normalized();
        if (i % 4 == 1) b = i % 8 == 1 ? a : Eigen::Vector3d(-a);
        const Eigen::Matrix3d r = rotation_between(3 * a, 0.2 * b);
        EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_NEAR(r.determinant(), 1, 1e-14);
        EXPECT_LT((r * a - b).norm(), 1e-12);
        EXPECT_NEAR(rotation_log(r).norm(), 2 * std::atan2((b - a).norm(), (b + a).norm()), 1e-12);
    }
}

TEST(Tangent, RetractAndDifferenceAreInverse) {
    std::mt19937 rng(1);
    for (int i = 0; i < 200; ++i) {
        const Pose a = random_pose(rng), b = random_pose(rng);
        EXPECT_TRUE(retract(a, difference(b, a)).isApprox(b, 1e-12));
        EXPECT_LT(difference(retract(a, Vector6::Zero()), a).norm(), 1e-12);
    }
}

// Both propagations against numeric differentiation of the tangent.
TEST(Tangent, CovariancesPropagateLikeNumericJacobians) {
    std::mt19937 rng(2);
    std::normal_distribution<double> n;
    for (int trial = 0; trial < 50; ++trial) {
        const Pose a = random_pose(rng), b = random_pose(rng);
        Matrix6 half_a, half_b;
        for (int i = 0; i < 36; ++i) half_a(i) = n(rng), half_b(i) = n(rng);
        const Matrix6 ca = half_a * half_a.transpose(), cb = half_b * half_b.transpose();
        Matrix6 inverse, left, right;
        const double h = 1e-6;
        for (int k = 0; k < 6; ++k) {
            const Vector6 d = h * Vector6::Unit(k);
            inverse.col(k) = difference(retract(a, d).inverse(), retract(a, -d).inverse()) / (2 * h);
            left.col(k) = difference(retract(a, d) * b, retract(a, -d) * b) / (2 * h);
            right.col(k) = difference(a * retract(b, d), a * retract(b, -d)) / (2 * h);
        }
        const Matrix6 want_inverse = inverse * ca * inverse.transpose();
        const Matrix6 want_product = left * ca * left.transpose() + right * cb * right.transpose();
        EXPECT_LT((covariance_of_inverse(a, ca) - want_inverse).norm(), 1e-6 * want_inverse.norm());
        EXPECT_LT((covariance_of_product(a, ca, b, cb) - want_product).norm(), 1e-6 * want_product.norm());
    }
}

TEST(Interpolation, MeetsBothEndsAndIsAScrew) {
    std::mt19937 rng(3);
    for (int i = 0; i < 100; ++i) {
        const Pose a = random_pose(rng), b = random_pose(rng);
        EXPECT_TRUE(interpolate(a, b, 0).isApprox(a, 1e-12));
        EXPECT_TRUE(interpolate(a, b, 1).isApprox(b, 1e-9));
        // A screw is invariant under its own motion: equal steps are equal relative poses.
        const Pose step1 = a.inverse() * interpolate(a, b, 0.25);
        const Pose step2 = interpolate(a, b, 0.5).inverse() * interpolate(a, b, 0.75);
        EXPECT_TRUE(step1.isApprox(step2, 1e-9));
        // Independent of the frame that the poses are given in.
        const Pose frame = random_pose(rng);
        EXPECT_TRUE(interpolate(frame * a, frame * b, 0.3).isApprox(frame * interpolate(a, b, 0.3), 1e-9));
    }
}

TEST(PoseFromMatrix, RefusesWhatIsNoPoseAndSaysWhy) {
    Eigen::Matrix4d good = Eigen::Matrix4d::Identity();
    good.col(3).head<3>() << 1, 2, 3;
    EXPECT_TRUE(pose_from_matrix(good, "p").has_value());

    auto reason = [](const Eigen::Matrix4d& m) {
        auto p = pose_from_matrix(m, "spots[3]");
        return p ? std::string("accepted") : p.error().sentence();
    };
    Eigen::Matrix4d m = good;
    m(1, 1) = std::nan("");
    EXPECT_NE(reason(m).find("finite"), std::string::npos);
    EXPECT_NE(reason(m).find("spots[3]"), std::string::npos);
    m = good;
    m.topLeftCorner<3, 3>() *= 1.01;
    EXPECT_NE(reason(m).find("orthonormal"), std::string::npos);
    m = good;
    m(0, 0) = -1;
    EXPECT_NE(reason(m).find("mirrored"), std::string::npos);
    EXPECT_NE(reason(good.transpose()).find("transposed"), std::string::npos);
    m = good;
    m(0, 3) = 1e9;
    EXPECT_NE(reason(m).find("100 m"), std::string::npos);
}

}  // namespace
}  // namespace seamwright
