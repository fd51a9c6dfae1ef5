#include "core/panel/servoing.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/panel/panel_fit.h"

namespace seamwright {
namespace {

// Eight double-sided spots around a panel; straight contours along the sensors' Y.
struct Bench {
    std::vector<PanelSpot> spots;
    Pose panel = Pose::Identity(), body = Pose::Identity();
    double noise_mm = 0;
    std::mt19937_64 engine{1};

    Bench() {
        for (int n = 0; n < 8; ++n) {
            PanelSpot s;
            s.id = "S" + std::to_string(n);
            const double phi = kPi / 4 * n + (n % 2 ? 0.3 : -0.2);
            const Eigen::Matrix3d turn = rotation_exp({0, 0, phi + (n % 3) * 0.3});
            s.gripper_from_sensor = make_pose(turn, {500 * std::cos(phi), 350 * std::sin(phi), 900.0});
            s.body.reference_mm = {4, 0, 0};
            s.sigma_mm = 0.03;
            spots.push_back(s);
        }
    }
    static Eigen::Vector3d cut(const PanelSpot& s, const Eigen::Vector3d& point, const Pose& d) {
        const Pose m = s.gripper_from_sensor.inverse() * d * s.gripper_from_sensor;
        const Eigen::Vector3d a = m * point, along = m.linear().col(1);
        return a - along * (a.y() / along.y());
    }
    double noise() { return noise_mm > 0 ? std::normal_distribution<double>(0, noise_mm)(engine) : 0; }
    // The gripper moved by `motion`: the panel stays in it, the body moves the other way.
    void measure(const Pose& motion) {
        for (PanelSpot& s : spots) {
            s.panel.measured_mm = cut(s, s.panel.reference_mm, panel) + Eigen::Vector3d(noise(), 0, noise());
            s.body.measured_mm =
                cut(s, s.body.reference_mm, motion.inverse() * body) + Eigen::Vector3d(noise(), 0, noise());
        }
    }
    Eigen::VectorXd values(const Pose& motion) {
        measure(motion);
        Eigen::VectorXd v(static_cast<Eigen::Index>(2 * spots.size()));
        for (std::size_t n = 0; n < spots.size(); ++n) {
            const GapFlushValue g =
                gap_and_flush(spots[n], spots[n].panel.measured_mm, spots[n].body.measured_mm);
            v[static_cast<Eigen::Index>(2 * n)] = g.gap_mm;
            v[static_cast<Eigen::Index>(2 * n) + 1] = g.flush_mm;
        }
        return v;
    }
};

TEST(Servoing, LearnsAndReachesTheTaughtRelationInSeveralMovesTheSingleStepInOne) {
    Bench bench;
    const ServoValues values = [&](const Pose& motion) { return bench.values(motion); };
    const Eigen::VectorXd set = bench.values(Pose::Identity());
    const Sensitivity learnt = learn_sensitivity(values, {});
    ASSERT_TRUE(learnt.usable) << learnt.condition;
    EXPECT_EQ(learnt.moves, 12);

    bench.panel = make_pose(rotation_exp({0.004, -0.006, 0.012}), {3, -4, 2});
    bench.body = make_pose(rotation_exp({-0.005, 0.003, -0.008}), {-5, 2, -3});
    const ServoingResult r = servo(learnt, values, set, {});
    EXPECT_EQ(r.status, ServoingStatus::reached);
    EXPECT_GE(r.moves, 3);
    EXPECT_LE(r.rms_mm, 0.05);

    bench.measure(Pose::Identity());
    const auto fit = fit_panel(bench.spots, {});
    ASSERT_TRUE(fit);
    ASSERT_EQ(fit->status, CorrectionStatus::ok) << fit->message;
    // One move: the panel stands in the body as taught.
    const Pose left = (fit->gripper_motion.inverse() * bench.body).inverse() * bench.panel;
    for (const PanelSpot& s : bench.spots) {
        const Eigen::Vector3d p = s.gripper_from_sensor * s.panel.reference_mm;
        EXPECT_LT((left * p - p).norm(), 1e-6);
    }
}

// One move against several, with the sensors' noise in all that is measured, on the same panels.
TEST(Servoing, OneStepIsWithinThreeSigmaWhereServoingNeedsThreeMovesOrMore) {
    constexpr int kSeeds = 500;
    constexpr double kNoise = 0.03;
    int values_judged = 0, within = 0, fewest = 100;
    double worst = 0, servo_squares = 0, step_squares = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        Bench bench;
        bench.engine.seed(static_cast<std::uint64_t>(seed));
        const ServoValues values = [&](const Pose& motion) { return bench.values(motion); };
        const Eigen::VectorXd set = bench.values(Pose::Identity());  // the taught relation
        bench.noise_mm = kNoise;
        const Sensitivity learnt = learn_sensitivity(values, {});
        ASSERT_TRUE(learnt.usable);
        const auto somewhere = [&] {
            std::uniform_real_distribution<double> mm(-10, 10), rad(-0.01, 0.01);
            const Eigen::Vector3d turn(rad(bench.engine), rad(bench.engine), rad(bench.engine));
            const Eigen::Vector3d move(mm(bench.engine), mm(bench.engine), mm(bench.engine));
            return make_pose(rotation_exp(turn), move);
        };
        bench.panel = somewhere();
        bench.body = somewhere();
        bench.measure(Pose::Identity());
        const auto fit = fit_panel(bench.spots, {});
        ASSERT_TRUE(fit);
        ASSERT_EQ(fit->status, CorrectionStatus::ok) << fit->message;
        const ServoingResult r = servo(learnt, values, set, {});
        ASSERT_TRUE(r.status == ServoingStatus::reached || r.status == ServoingStatus::settled);
        fewest = std::min(fewest, r.moves);
        // The truth after the last move: gap and flush without noise.
        bench.noise_mm = 0;
        const Eigen::VectorXd off = bench.values(fit->gripper_motion) - set;
        const Eigen::VectorXd servo_off = bench.values(r.motion) - set;
        for (double v : off) {
            ++values_judged;
            within += std::abs(v) <= 3 * kNoise;
            worst = std::max(worst, std::abs(v));
        }
        step_squares += off.squaredNorm();
        servo_squares += servo_off.squaredNorm();
    }
    EXPECT_GE(fewest, 3);
    // A gap is the difference of two points, each with the sensor's noise.
    EXPECT_LE(worst, 3 * std::sqrt(2.0) * kNoise);
    EXPECT_GE(static_cast<double>(within) / values_judged, 0.99);  // even of a single point's
    // Servoing measures anew before every move and averages over its last ones: both end at the noise.
    for (const double squares : {step_squares, servo_squares})
        EXPECT_LE(std::sqrt(squares / values_judged), 1.1 * kNoise);
}

TEST(Servoing, NoiseAndDeformationLetItSettle) {
    Bench bench;
    const ServoValues values = [&](const Pose& motion) { return bench.values(motion); };
    Eigen::VectorXd set = bench.values(Pose::Identity());
    const Sensitivity learnt = learn_sensitivity(values, {});
    set[0] += 1;  // asks for what no rigid motion gives
    set[8] += 1;
    const ServoingResult r = servo(learnt, values, set, {});
    EXPECT_EQ(r.status, ServoingStatus::settled);
    EXPECT_GT(r.rms_mm, 0.05);
}

TEST(Servoing, RefusesASensitivityThatCannotBeInverted) {
    Bench bench;
    for (PanelSpot& s : bench.spots) s.gripper_from_sensor.linear().setIdentity();
    const ServoValues values = [&](const Pose& motion) { return bench.values(motion); };
    const Sensitivity learnt = learn_sensitivity(values, {});
    EXPECT_FALSE(learnt.usable);
    EXPECT_EQ(servo(learnt, values, bench.values(Pose::Identity()), {}).status,
              ServoingStatus::ill_conditioned);
}

}  // namespace
}  // namespace seamwright
