#include "core/geometry/pose_convention.h"

#include <gtest/gtest.h>

#include <random>

#include "core/geometry/notation.h"

namespace seamwright {
namespace {

Pose any_pose(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
    return make_pose(q.toRotationMatrix(),
                     {900 * normal(random), 900 * normal(random), 900 * normal(random)});
}

// A turn by the angle about an axis, written out.
Eigen::Matrix3d about(char axis, double rad) {
    const double c = std::cos(rad), s = std::sin(rad);
    Eigen::Matrix3d m;
    if (axis == 'x') m << 1, 0, 0, 0, c, -s, 0, s, c;
    if (axis == 'y') m << c, 0, s, 0, 1, 0, -s, 0, c;
    if (axis == 'z') m << c, -s, 0, s, c, 0, 0, 0, 1;
    return m;
}

TEST(Euler, EveryOrderTurnsAboutItsAxesOneAfterTheOther) {
    for (const EulerConvention& e : euler_conventions()) {
        const std::string_view axes = name_of(e.order);
        const Eigen::Vector3d a(0.3, 0.7, -1.1);
        Eigen::Matrix3d expected = Eigen::Matrix3d::Identity();
        for (int n = 0; n < 3; ++n) {
            const Eigen::Matrix3d turn = about(axes[static_cast<std::size_t>(n)], a[n]);
            expected = e.turns == EulerTurns::intrinsic ? Eigen::Matrix3d(expected * turn)
                                                        : Eigen::Matrix3d(turn * expected);
        }
        EXPECT_TRUE(rotation_from_euler(e, a).isApprox(expected, 1e-14)) << axes << " " << name_of(e.turns);
    }
}

TEST(Euler, AnglesAndRotationAreInverseAlsoAtGimbalLock) {
    std::mt19937 random(7);
    for (const EulerConvention& e : euler_conventions()) {
        for (int i = 0; i < 50; ++i) {
            const Eigen::Matrix3d r = any_pose(random).linear();
            EXPECT_TRUE(rotation_from_euler(e, euler_from_rotation(e, r)).isApprox(r, 1e-12));
        }
        for (const double middle : {0.0, kPi / 2, -kPi / 2, kPi}) {
            const Eigen::Matrix3d r = rotation_from_euler(e, {0.4, middle, -0.9});
            EXPECT_TRUE(rotation_from_euler(e, euler_from_rotation(e, r)).isApprox(r, 1e-8))
                << name_of(e.order) << " " << name_of(e.turns) << " " << middle;
        }
    }
}

TEST(Euler, TheBrandsAreThreeOfThem) {
    const Eigen::Vector3d deg(20, -35, 110), rad = deg * (kPi / 180);
    const auto of = [&](EulerOrder order, EulerTurns turns) {
        return rotation_from_euler({order, turns}, rad);
    };
    EXPECT_EQ(rotation_from_kuka({20, -35, 110}), of(EulerOrder::zyx, EulerTurns::intrinsic));
    EXPECT_TRUE(
        rotation_from_fanuc({20, -35, 110}).isApprox(of(EulerOrder::xyz, EulerTurns::extrinsic), 1e-15));
    EXPECT_EQ(rotation_from_zyz({20, -35, 110}), of(EulerOrder::zyz, EulerTurns::intrinsic));
}

PoseNumbers numbers_of(const Pose& pose, RotationReading reading) {
    return write_pose(pose, {.rotation = reading});
}

TEST(PoseConvention, WhatIsWrittenReadsBackInEveryConvention) {
    std::mt19937 random(11);
    int conventions = 0;
    for (const RotationReading reading : {RotationReading::euler, RotationReading::rotation_vector,
                                          RotationReading::quat_wxyz, RotationReading::matrix}) {
        const Pose pose = any_pose(random);
        PoseNumbers small = numbers_of(pose, reading);
        small.position /= 100;  // so that every unit of length is possible
        if (form_of(reading) == RotationForm::angles) small.rotation = {1, 0.5, -2};
        for (const PoseConvention& c : possible_conventions({&small, 1}, {.rotation = reading})) {
            ++conventions;
            const auto back = read_pose(write_pose(pose, c), c);
            ASSERT_TRUE(back) << code_of(c);
            EXPECT_LT((back->matrix() - pose.matrix()).cwiseAbs().maxCoeff(), 1e-9) << code_of(c);
            const auto named = pose_convention_named(code_of(c), "");
            ASSERT_TRUE(named) << code_of(c);
            EXPECT_EQ(*named, c) << code_of(c);
        }
    }
    EXPECT_GT(conventions, 300);
}

TEST(PoseConvention, TheNumbersRuleOutWhatTheyCannotBe) {
    PoseNumbers n;
    n.position = {900, 100, 700};
    n.rotation = {90, 10, -120};
    for (const PoseConvention& c : possible_conventions({&n, 1}, {})) {
        EXPECT_FALSE(c.radian) << code_of(c);
        EXPECT_TRUE(c.unit == "mm" || c.unit == "in") << code_of(c);
    }
    n.rotation = {1.5, 0.2, -3};
    n.position /= 1000;
    bool radian = false;
    for (const PoseConvention& c : possible_conventions({&n, 1}, {})) {
        radian = radian || c.radian;
        EXPECT_TRUE(c.unit == "m" || c.unit == "in" || c == PoseConvention{}) << code_of(c);
    }
    EXPECT_TRUE(radian);
}

TEST(PoseConvention, MatrixByColumnsIsReadTransposedOnly) {
    std::mt19937 random(3);
    const Pose pose = any_pose(random);
    PoseNumbers n = write_pose(pose, {.rotation = RotationReading::matrix, .transposed = true});
    n.position_in_last_row = true;
    EXPECT_FALSE(read_pose(n, {.rotation = RotationReading::matrix}));
    const auto read = read_pose(n, {.rotation = RotationReading::matrix, .transposed = true});
    ASSERT_TRUE(read);
    EXPECT_LT((read->matrix() - pose.matrix()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(PoseConvention, HostileNumbersAreNoPose) {
    PoseNumbers n;
    n.rotation = {std::nan(""), 0, 0};
    EXPECT_FALSE(read_pose(n, {}));
    n.rotation = {};
    n.position.x() = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(read_pose(n, {}));
    n.position = {1e7, 0, 0};
    EXPECT_FALSE(read_pose(n, {}));
    n.position.setZero();
    n.form = RotationForm::quaternion;
    EXPECT_FALSE(read_pose(n, {.rotation = RotationReading::quat_wxyz}));  // length 0
    EXPECT_FALSE(read_pose(n, {}));                                        // four numbers are no angles
    n.form = RotationForm::matrix;
    EXPECT_FALSE(read_pose(n, {.rotation = RotationReading::matrix}));
}

TEST(PoseConvention, CodesAreRefusedWithTheirWord) {
    for (const char* code : {"", "euler", "euler-zzy-intrinsic", "euler-zyx", "euler-zyx-both", "deg,mm",
                             "kuka-abc,cm", "kuka-abc,zyz", "kuka-abc,deg,rad", "kuka-abc,transposed",
                             "quat-wxyz,rad", "matrix,inverse,inverse", "matrix,"})
        EXPECT_FALSE(pose_convention_named(code, "")) << code;
    EXPECT_EQ(code_of(*pose_convention_named("m,inverse,fanuc-wpr", "")),
              "euler-xyz-extrinsic,deg,m,inverse");
    EXPECT_EQ(code_of(*pose_convention_named("ur-rotvec", "")), "rotvec,rad,mm");
    EXPECT_EQ(code_of(*pose_convention_named("quat-xyzw,transposed", "")), "quat-xyzw,mm,transposed");
}

}  // namespace
}  // namespace seamwright
