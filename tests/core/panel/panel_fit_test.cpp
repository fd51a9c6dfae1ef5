#include "core/panel/panel_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

struct Dice {
    std::mt19937_64 engine;
    explicit Dice(std::uint64_t seed) : engine(seed) {}
    double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine); }
    double normal(double sigma) { return sigma * std::normal_distribution<double>()(engine); }
    Eigen::Vector3d box(double h) { return {uniform(-h, h), uniform(-h, h), uniform(-h, h)}; }
    Pose displacement() { return make_pose(rotation_exp(box(0.02)), box(10)); }
};

// Spots around the rim of a panel: edges run along the rim (sensor Y), height along the gripper's Z.
std::vector<PanelSpot> rim(Dice& dice, int count, double gap_mm = 4) {
    std::vector<PanelSpot> spots;
    for (int n = 0; n < count; ++n) {
        const double phi = 2 * kPi * n / count + dice.uniform(-0.2, 0.2);
        Eigen::Matrix3d axes;
        axes.col(0) = Eigen::Vector3d(std::cos(phi), std::sin(phi), 0);
        axes.col(2) = Eigen::Vector3d::UnitZ();
        axes.col(1) = axes.col(2).cross(axes.col(0));
        PanelSpot s;
        s.id = "S" + std::to_string(n + 1);
        const Eigen::Matrix3d tilt = rotation_exp(dice.box(0.4));
        s.gripper_from_sensor = make_pose(
            tilt * axes, Eigen::Vector3d(500 * std::cos(phi), 350 * std::sin(phi), 900) + dice.box(20));
        s.panel.reference_mm = {dice.uniform(-4, 4), 0, dice.uniform(-3, 3)};
        s.body.reference_mm = s.panel.reference_mm + Eigen::Vector3d(gap_mm, 0, dice.uniform(-1, 1));
        spots.push_back(s);
    }
    return spots;
}

Eigen::Vector3d displaced(const PanelSpot& s, const Eigen::Vector3d& point, const Pose& d) {
    return s.gripper_from_sensor.inverse() * (d * (s.gripper_from_sensor * point));
}
// Where the displaced contour, straight along Y, meets the laser plane y = 0.
Eigen::Vector3d cut(const PanelSpot& s, const Eigen::Vector3d& point, const Pose& d) {
    const Eigen::Vector3d a = displaced(s, point, d);
    const Eigen::Vector3d b = displaced(s, point + Eigen::Vector3d::UnitY(), d);
    return a - (b - a) * (a.y() / (b - a).y());
}
void measure(std::vector<PanelSpot>& spots, const Pose& p, const Pose& b, bool by_cut) {
    for (PanelSpot& s : spots) {
        s.panel.measured_mm =
            by_cut ? cut(s, s.panel.reference_mm, p) : displaced(s, s.panel.reference_mm, p);
        s.body.measured_mm = by_cut ? cut(s, s.body.reference_mm, b) : displaced(s, s.body.reference_mm, b);
    }
}

TEST(PanelFit, ExactWithoutNoiseWhetherContoursAreCutOrPointsDisplaced) {
    for (const bool by_cut : {true, false})
        for (int job = 0; job < 200; ++job) {
            Dice dice(static_cast<std::uint64_t>(job) + 1);
            auto spots = rim(dice, 6 + job % 7);
            const Pose p = dice.displacement(), b = dice.displacement();
            measure(spots, p, b, by_cut);
            const auto fit = fit_panel(spots, {});
            ASSERT_TRUE(fit) << fit.error().sentence();
            ASSERT_EQ(fit->status, CorrectionStatus::ok) << fit->message;
            const Pose truth = b * p.inverse();
            EXPECT_LT(distance_mm(fit->gripper_motion, truth), 1e-6);
            EXPECT_LT(900 * angle_rad(fit->gripper_motion, truth), 1e-6);
            EXPECT_LT(distance_mm(fit->single_step, truth), 1e-6);
            EXPECT_LT(fit->rms_mm, 1e-7);
        }
}

TEST(PanelFit, StatedSigmaHoldsForEveryDegreeOfFreedom) {
    Dice dice(7);
    auto clean = rim(dice, 8);
    for (std::size_t n = 0; n < clean.size(); ++n) clean[n].sigma_mm = n % 2 ? 0.08 : 0.03;
    const Pose p = dice.displacement(), b = dice.displacement();
    measure(clean, p, b, true);
    const Pose truth = b * p.inverse();
    constexpr int kTrials = 4000;
    Vector6 inside = Vector6::Zero();
    double nees = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        auto spots = clean;
        for (PanelSpot& s : spots)
            for (int i : {0, 2}) {
                s.panel.measured_mm[i] += dice.normal(s.sigma_mm);
                s.body.measured_mm[i] += dice.normal(s.sigma_mm);
            }
        const auto fit = fit_panel(spots, {});
        ASSERT_TRUE(fit);
        ASSERT_EQ(fit->status, CorrectionStatus::ok);
        const Vector6 off = difference(fit->gripper_motion, truth);
        for (int i = 0; i < 6; ++i)
            inside[i] += std::abs(off[i]) <= 1.959964 * std::sqrt(fit->covariance(i, i));
        nees += off.dot(Vector6(solve_symmetric(fit->covariance, off)));
    }
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(inside[i] / kTrials, 0.95, 0.02) << "dof " << i;
    // Mean of kTrials chi-square values with six degrees: sigma sqrt(12 / kTrials).
    EXPECT_NEAR(nees / kTrials, 6.0, 4 * std::sqrt(12.0 / kTrials));
}

// Six of the 2 N coordinates' variances are left at the spots, of panel and body both, wherever they stand.
TEST(PanelFit, SpreadAtTheSpotsIsSixOfTwoNAtAnyDisplacement) {
    constexpr double kSigma = 0.03;
    constexpr int kTrials = 1500;
    for (const double reach : {0.0, 0.01, 1.0}) {
        Dice dice(9);
        auto clean = rim(dice, 8);
        for (PanelSpot& s : clean) s.sigma_mm = kSigma;
        const auto shorter = [&](const Pose& m) {
            return make_pose(rotation_exp(reach * rotation_log(m.linear())), reach * m.translation());
        };
        double squares = 0;
        for (int trial = 0; trial < kTrials; ++trial) {
            const Pose p = shorter(dice.displacement()), b = shorter(dice.displacement());
            auto spots = clean;
            measure(spots, p, b, true);
            for (PanelSpot& s : spots)
                for (int i : {0, 2}) {
                    s.panel.measured_mm[i] += dice.normal(kSigma);
                    s.body.measured_mm[i] += dice.normal(kSigma);
                }
            const auto fit = fit_panel(spots, {});
            ASSERT_TRUE(fit);
            ASSERT_EQ(fit->status, CorrectionStatus::ok) << fit->message;
            const Pose left = b.inverse() * fit->gripper_motion * p;
            for (const PanelSpot& s : spots) {
                const Eigen::Vector3d at = s.gripper_from_sensor * s.panel.reference_mm;
                const Eigen::Vector3d off = s.gripper_from_sensor.linear().transpose() * (left * at - at);
                squares += off.x() * off.x() + off.z() * off.z();
            }
        }
        const double mean = squares / (16.0 * kTrials) / (2 * kSigma * kSigma);
        EXPECT_NEAR(mean, 6.0 / 16, 0.03) << "reach " << reach;
    }
}

TEST(PanelFit, ResidualIsTheDeformationThatNoMotionRemoves) {
    Dice dice(11);
    auto spots = rim(dice, 8);
    const Pose p = dice.displacement(), b = dice.displacement();
    // Deformation of the panel, in its own spots' axes, far below the contour's slide in size.
    std::vector<Eigen::Vector3d> deformation;
    auto shaped = spots;
    for (PanelSpot& s : shaped) {
        deformation.push_back({dice.uniform(-0.3, 0.3), 0, dice.uniform(-0.3, 0.3)});
        s.panel.reference_mm += deformation.back();
    }
    measure(shaped, p, b, true);
    for (std::size_t n = 0; n < spots.size(); ++n) {
        spots[n].panel.measured_mm = shaped[n].panel.measured_mm;
        spots[n].body.measured_mm = shaped[n].body.measured_mm;
    }
    const auto fit = fit_panel(spots, {});
    ASSERT_TRUE(fit);
    ASSERT_EQ(fit->status, CorrectionStatus::ok) << fit->message;
    // The rigid part of the deformation by plain linear least squares, independent of the solver.
    const Eigen::Index rows = static_cast<Eigen::Index>(2 * spots.size());
    Eigen::MatrixXd j(rows, 6);
    Eigen::VectorXd d(rows);
    for (std::size_t n = 0; n < spots.size(); ++n)
        for (int k = 0; k < 2; ++k) {
            const Eigen::Index row = static_cast<Eigen::Index>(2 * n) + k;
            const Eigen::Vector3d axis = spots[n].gripper_from_sensor.linear().col(2 * k);
            const Eigen::Vector3d at = spots[n].gripper_from_sensor * spots[n].panel.reference_mm;
            j.row(row) << axis.transpose(), at.cross(axis).transpose();
            d[row] = deformation[n][2 * k];
        }
    const Eigen::VectorXd left = d - j * least_squares(j, d).x;
    for (std::size_t n = 0; n < spots.size(); ++n) {
        EXPECT_NEAR(fit->spots[n].residual_mm.x(), left[static_cast<Eigen::Index>(2 * n)], 0.01);
        EXPECT_NEAR(fit->spots[n].residual_mm.z(), left[static_cast<Eigen::Index>(2 * n) + 1], 0.01);
        EXPECT_NEAR(fit->spots[n].remaining.gap_mm, -fit->spots[n].residual_mm.x(), 1e-9);
        EXPECT_NEAR(fit->spots[n].remaining.flush_mm, fit->spots[n].residual_mm.z(), 1e-9);
    }
    EXPECT_GT(left.norm(), 0.1);
}

TEST(PanelFit, SameDeformationOnBothSidesIsNoDeviation) {
    Dice dice(13);
    auto spots = rim(dice, 8);
    auto shaped = spots;
    for (PanelSpot& s : shaped) {
        const Eigen::Vector3d d(dice.uniform(-0.3, 0.3), 0, dice.uniform(-0.3, 0.3));
        s.panel.reference_mm += d;
        s.body.reference_mm += d;
    }
    const Pose nothing = Pose::Identity();
    measure(shaped, nothing, nothing, true);
    for (std::size_t n = 0; n < spots.size(); ++n) {
        spots[n].panel.measured_mm = shaped[n].panel.measured_mm;
        spots[n].body.measured_mm = shaped[n].body.measured_mm;
    }
    const auto fit = fit_panel(spots, {});
    ASSERT_TRUE(fit);
    // Gap and flush are as taught everywhere: the gripper stays, to the panel's own rotation seen in the
    // body's frame.
    for (const PanelSpotResult& s : fit->spots) EXPECT_LT(s.residual_mm.norm(), 0.005);
}

TEST(PanelFit, SignsOfGapAndFlush) {
    PanelSpot s;
    s.panel.reference_mm = {-2, 0, 0.5};
    s.body.reference_mm = {2, 0, 0};
    EXPECT_DOUBLE_EQ(gap_and_flush(s, s.panel.reference_mm, s.body.reference_mm).gap_mm, 4);
    EXPECT_DOUBLE_EQ(gap_and_flush(s, s.panel.reference_mm, s.body.reference_mm).flush_mm, 0.5);
    s.panel.reference_mm.x() = 6;  // the panel lies on the other side
    EXPECT_DOUBLE_EQ(gap_and_flush(s, s.panel.reference_mm, s.body.reference_mm).gap_mm, 4);
    EXPECT_DOUBLE_EQ(gap_and_flush(s, {1, 0, 0}, s.body.reference_mm).gap_mm, -1);  // overlaps
    s.weights = {0, 0, 1};
    EXPECT_TRUE(std::isnan(gap_and_flush(s, s.panel.reference_mm, s.body.reference_mm).gap_mm));
}

TEST(PanelFit, RefusesWhatItCannotTell) {
    Dice dice(17);
    auto spots = rim(dice, 3);
    for (PanelSpot& s : spots) s.gripper_from_sensor.linear() = Eigen::Matrix3d::Identity();
    measure(spots, Pose::Identity(), Pose::Identity(), true);
    const auto fit = fit_panel(spots, {});
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->status, CorrectionStatus::under_determined);
    EXPECT_THAT(fit->unobservable, testing::Contains(testing::HasSubstr("translation along Y")));
    EXPECT_TRUE(fit->gripper_motion.isApprox(Pose::Identity()));
    spots[1].sigma_mm = -1;
    EXPECT_FALSE(fit_panel(spots, {}));
}

TEST(PanelFit, FindsTheWrongSpotOnEitherSideAndKeepsTheMotion) {
    Dice dice(19);
    auto spots = rim(dice, 9);
    const Pose p = dice.displacement(), b = dice.displacement();
    measure(spots, p, b, true);
    spots[2].panel.measured_mm.x() += 3;
    spots[6].body.measured_mm.z() -= 3;
    PanelOptions options;
    options.deviation = PanelDeviation::leave_out;
    const auto fit = fit_panel(spots, options);
    ASSERT_TRUE(fit);
    ASSERT_EQ(fit->status, CorrectionStatus::ok);
    EXPECT_FALSE(fit->spots[2].panel_used);
    EXPECT_FALSE(fit->spots[6].body_used);
    EXPECT_TRUE(fit->spots[6].panel_used);
    EXPECT_LT(distance_mm(fit->gripper_motion, b * p.inverse()), 1e-6);
    EXPECT_THAT(fit->message, testing::HasSubstr("S3"));
}

// A bent corner: the best fit uses every spot, spreads the deviation and says where the shape is off.
TEST(PanelFit, SharesTheDeviationOfABentCornerByDefaultAndNamesIt) {
    Dice dice(29);
    auto spots = rim(dice, 9);
    const Pose p = dice.displacement(), b = dice.displacement();
    measure(spots, p, b, true);
    spots[4].panel.measured_mm.z() += 0.9;
    const auto fit = fit_panel(spots, {});
    ASSERT_TRUE(fit);
    ASSERT_EQ(fit->status, CorrectionStatus::ok) << fit->message;
    double most = 0;
    for (const PanelSpotResult& s : fit->spots) {
        EXPECT_TRUE(s.panel_used && s.body_used) << s.id;
        most = std::max(most, s.residual_mm.norm());
    }
    EXPECT_LT(most, 0.8) << "part of it is carried by the others";
    EXPECT_THAT(fit->message, testing::HasSubstr("panel deviates from its taught shape at S5"));
    PanelOptions alone;
    alone.deviation = PanelDeviation::leave_out;
    const auto other = fit_panel(spots, alone);
    ASSERT_TRUE(other);
    EXPECT_FALSE(other->spots[4].panel_used);
    EXPECT_NEAR(other->spots[4].residual_mm.norm(), 0.9, 0.01);
    EXPECT_GT(distance_mm(fit->gripper_motion, other->gripper_motion), 0.05);
}

TEST(PanelFit, SaysWhenTheMotionIsBeyondTheLimits) {
    Dice dice(23);
    auto spots = rim(dice, 6);
    measure(spots, make_pose(Eigen::Matrix3d::Identity(), {5, 0, 0}), Pose::Identity(), true);
    PanelOptions options;
    options.limits = {2.0, 1.0};
    const auto fit = fit_panel(spots, options);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->status, CorrectionStatus::over_limit);
    EXPECT_NEAR(fit->gripper_motion.translation().x(), -5, 1e-6);
}

}  // namespace
}  // namespace seamwright
