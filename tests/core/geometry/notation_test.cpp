#include "core/geometry/notation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/geometry/rotations.h"

namespace seamwright {
namespace {

std::vector<Eigen::Matrix3d> rotations() {
    std::vector<Eigen::Matrix3d> r;
    for (const auto& w : testing_rotation_vectors()) r.push_back(rotation_exp(w));
    for (double a : {-170.0, 0.0, 33.0})
        for (double b : {90.0, -90.0, 90.0 - 1e-7, -90.0 + 1e-5})
            for (double c : {-20.0, 0.0, 180.0}) r.push_back(rotation_from_kuka({a, b, c}));
    for (double y : {0.0, 180.0, 1e-7}) r.push_back(rotation_from_zyz({12.0, y, 34.0}));
    return r;
}

double apart(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    return (a - b).cwiseAbs().maxCoeff();
}

TEST(Notation, EveryBrandRoundTripsAtEveryRotation) {
    for (const Eigen::Matrix3d& r : rotations()) {
        EXPECT_LT(apart(rotation_from_kuka(kuka_from_rotation(r)), r), 1e-8);
        EXPECT_LT(apart(rotation_from_fanuc(fanuc_from_rotation(r)), r), 1e-8);
        EXPECT_LT(apart(*rotation_from_abb(abb_from_rotation(r), ""), r), 1e-12);
        EXPECT_LT(apart(rotation_from_ur(ur_from_rotation(r)), r), 1e-12);
        EXPECT_LT(apart(rotation_from_zyz(zyz_from_rotation(r)), r), 1e-8);
    }
}

// Known values, worked out by hand from the brands' manuals.
TEST(Notation, KnownValues) {
    // KUKA A=90: X of the frame points along Y of the base.
    EXPECT_LT((rotation_from_kuka({90, 0, 0}).col(0) - Eigen::Vector3d::UnitY()).norm(), 1e-15);
    // B=90: X points along -Z. C=90: Y points along Z.
    EXPECT_LT((rotation_from_kuka({0, 90, 0}).col(0) + Eigen::Vector3d::UnitZ()).norm(), 1e-15);
    EXPECT_LT((rotation_from_kuka({0, 0, 90}).col(1) - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
    // FANUC R is KUKA A, W is KUKA C.
    EXPECT_LT(apart(rotation_from_fanuc({10, 20, 30}), rotation_from_kuka({30, 20, 10})), 1e-15);
    // ABB: 180 degrees about X.
    const Eigen::Matrix3d half = *rotation_from_abb({0, 1, 0, 0}, "");
    EXPECT_LT(apart(half, Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()), 1e-15);
}

TEST(Notation, AbbRefusesWhatIsNoUnitQuaternion) {
    for (const AbbQuaternion& q :
         {AbbQuaternion{0, 0, 0, 0}, AbbQuaternion{2, 0, 0, 0}, AbbQuaternion{std::nan(""), 0, 0, 1}})
        EXPECT_FALSE(rotation_from_abb(q, "pose").has_value());
}

TEST(Notation, KukaJacobianAgreesWithNumericDifferentiation) {
    for (const KukaAbc& abc : {KukaAbc{0, 0, 0}, KukaAbc{30, -40, 110}, KukaAbc{-170, 70, 5}}) {
        const Eigen::Matrix3d r = rotation_from_kuka(abc), j = kuka_jacobian(r);
        for (int k = 0; k < 3; ++k) {
            const double h = 1e-6;
            const KukaAbc plus = kuka_from_rotation(rotation_exp(h * Eigen::Vector3d::Unit(k)) * r);
            const KukaAbc minus = kuka_from_rotation(rotation_exp(-h * Eigen::Vector3d::Unit(k)) * r);
            const Eigen::Vector3d numeric = Eigen::Vector3d(rad_from_deg(plus.a_deg - minus.a_deg),
                                                            rad_from_deg(plus.b_deg - minus.b_deg),
                                                            rad_from_deg(plus.c_deg - minus.c_deg)) /
                                            (2 * h);
            EXPECT_LT((j.col(k) - numeric).norm(), 1e-7);
        }
    }
}

}  // namespace
}  // namespace seamwright
