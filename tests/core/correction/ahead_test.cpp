// The delay line by path length. What is true comes from formulas of its own: circles, lines and waves, never from
// the guide under test.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/correction/ahead/delay_line.h"
#include "core/correction/ahead/guide.h"
#include "core/correction/ahead/pose_history.h"

namespace seamwright {
namespace {

constexpr double kRadiusMm = 400, kStepMm = 2;

// A quarter of a circle about the origin, anticlockwise: across (along x up) points outward.
std::vector<GuidePoint> quarter() {
    std::vector<GuidePoint> points;
    const double quarter_rad = std::acos(-1.0) / 2;
    const int n = static_cast<int>(kRadiusMm * quarter_rad / kStepMm);
    for (int i = 0; i <= n; ++i) {
        const double a = quarter_rad * i / n;
        points.push_back({{kRadiusMm * std::cos(a), kRadiusMm * std::sin(a), 0}, Eigen::Vector3d::UnitZ()});
    }
    return points;
}

GuideCurve curve(const std::vector<GuidePoint>& points) {
    auto made = GuideCurve::make(points);
    EXPECT_TRUE(made) << made.error().sentence();
    return *made;
}

TEST(Guide, WhatIsNotDisplacedIsNotOff) {
    const GuideCurve g = curve(quarter());
    for (const GuidePoint& p : quarter()) {
        const auto foot = g.foot(p.point_mm);
        EXPECT_LT(foot.off_mm.norm(), 1e-12);
        EXPECT_LT((g.at(foot.s_mm) - p.point_mm).norm(), 1e-9);
        EXPECT_FALSE(foot.beyond);
    }
}

TEST(Guide, AShiftAcrossThePathComesOutAtTheSamePathLength) {
    const GuideCurve g = curve(quarter());
    for (double s = 5; s < g.length_mm() - 5; s += 7.3)
        for (const double across : {-6.0, -0.4, 3.0})
            for (const double height : {-2.0, 0.0, 5.0}) {
                const Eigen::Matrix3d d = g.directions(s);
                const auto foot = g.foot(g.at(s) + across * d.col(1) + height * d.col(2), s + 3, 15);
                EXPECT_NEAR(foot.s_mm, s, 1e-9);
                EXPECT_NEAR(foot.off_mm.x(), across, 1e-9);
                EXPECT_NEAR(foot.off_mm.y(), height, 1e-9);
            }
}

TEST(Guide, ACircleIsMeasuredAsOne) {
    const GuideCurve g = curve(quarter());
    const double sagitta = kStepMm * kStepMm / (8 * kRadiusMm);
    for (const double outward : {-5.0, 0.0, 4.0})
        for (double a = 0.05; a < 1.5; a += 0.011) {
            const double r = kRadiusMm + outward;
            const auto foot = g.foot({r * std::cos(a), r * std::sin(a), 1.5});
            EXPECT_NEAR(foot.s_mm, kRadiusMm * a, 1e-2);
            EXPECT_NEAR(foot.off_mm.x(), outward, 1.01 * sagitta);
            EXPECT_NEAR(foot.off_mm.y(), 1.5, 1e-9);
        }
}

TEST(Guide, DoesNotJumpWhileAPointGoesBy) {
    const GuideCurve g = curve(quarter());
    double before = -1;
    for (double a = 0.1; a < 1.4; a += 1e-4) {
        const auto foot = g.foot({(kRadiusMm - 20) * std::cos(a), (kRadiusMm - 20) * std::sin(a), 0});
        if (before >= 0) {
            EXPECT_NEAR(foot.s_mm - before, kRadiusMm * 1e-4, 4e-3);
        }
        before = foot.s_mm;
    }
}

TEST(Guide, KnowsItsEnds) {
    const GuideCurve g = curve(quarter());
    EXPECT_TRUE(g.foot({kRadiusMm, -3, 0}).beyond);
    EXPECT_EQ(g.foot({kRadiusMm, -3, 0}).s_mm, 0);
    EXPECT_TRUE(g.foot({-3, kRadiusMm, 0}).beyond);
    EXPECT_NEAR(g.foot({-3, kRadiusMm, 0}).s_mm, g.length_mm(), 1e-9);
}

TEST(Guide, RefusesWhatIsNone) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const double nan = std::nan("");
    EXPECT_FALSE(GuideCurve::make({}));
    EXPECT_FALSE(GuideCurve::make({{{0, 0, 0}, up}}));
    EXPECT_FALSE(GuideCurve::make({{{0, 0, 0}, up}, {{0, 0, 0}, up}}));
    EXPECT_FALSE(GuideCurve::make({{{0, 0, 0}, up}, {{nan, 0, 0}, up}}));
    EXPECT_FALSE(GuideCurve::make({{{0, 0, 0}, up}, {{1, 0, 0}, {0, 0, 0}}}));
    EXPECT_FALSE(GuideCurve::make({{{0, 0, 0}, up}, {{0, 0, 5}, up}})) << "up along the travel";
    EXPECT_FALSE(GuideCurve::make({{{0, 0, 0}, up}, {{5, 0, 0}, up}, {{5, 5, 0}, up}})) << "a corner";
}

Eigen::Matrix2d noise_of(double sigma) {
    return sigma * sigma * Eigen::Matrix2d::Identity();
}

TEST(DelayLine, GivesALineBackWhateverTheDistances) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> step(0.1, 6);
    DelayLine line({});
    const auto true_at = [](double s) { return Eigen::Vector2d(0.4 - 0.004 * s, -1 + 0.01 * s); };
    double s = 0;
    while (s < 200) {
        ASSERT_TRUE(line.add({s, true_at(s), noise_of(0.03)}));
        s += step(random);
    }
    for (double q = line.first_mm(); q < line.newest_mm(); q += 0.37) {
        const AheadOffset o = line.at(q);
        EXPECT_EQ(o.state, AheadState::known);
        EXPECT_LT((o.off_mm - true_at(q)).norm(), 1e-9);
        EXPECT_LT((o.slope - Eigen::Vector2d(-0.004, 0.01)).norm(), 1e-9);
    }
}

TEST(DelayLine, NothingMeasuredIsNothingTold) {
    const DelayLine line({});
    EXPECT_EQ(line.at(10).state, AheadState::nothing);
    EXPECT_TRUE(line.at(10).off_mm.isZero(0));
    DelayLine zero({});
    for (double s = 0; s < 100; s += 1.7) ASSERT_TRUE(zero.add({s, Eigen::Vector2d::Zero(), noise_of(0.03)}));
    for (double q = -5; q < 120; q += 0.9) EXPECT_TRUE(zero.at(q).off_mm.isZero(0));
}

TEST(DelayLine, TheOrderOfTheMeasuresDoesNotMatter) {
    std::vector<AheadMeasure> measures;
    for (int i = 0; i < 60; ++i)
        measures.push_back({1.5 * i, {0.3 * std::sin(0.05 * i), 0.01 * i}, noise_of(0.02)});
    DelayLine forward({}), backward({});
    for (const AheadMeasure& m : measures) ASSERT_TRUE(forward.add(m));
    for (auto m = measures.rbegin(); m != measures.rend(); ++m) ASSERT_TRUE(backward.add(*m));
    for (double q = 0; q < 88; q += 0.6)
        EXPECT_LT((forward.at(q).off_mm - backward.at(q).off_mm).norm(), 1e-3);
}

TEST(DelayLine, StatesTheSigmaThatItHas) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    Eigen::Matrix2d covariance;
    covariance << 0.0016, 0.0004, 0.0004, 0.0009;
    const Eigen::Matrix2d root = covariance.llt().matrixL();
    double nees = 0;
    constexpr int kTrials = 2000;
    double stated = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        DelayLine line({});
        for (double s = 0; s < 40; s += 1)
            line.add({s, root * Eigen::Vector2d(normal(random), normal(random)), covariance});
        const AheadOffset o = line.at(20.4);
        nees += o.off_mm.dot(o.covariance_mm2.inverse() * o.off_mm);
        stated += o.sigma_mm() / kTrials;
    }
    // Mean of 2000 chi squares of two degrees: 2 +- 3.3 * 2 / sqrt(2000); what the gate refused is missing.
    EXPECT_NEAR(nees / kTrials, 2, 0.15);
    // Tricube keeps somewhat less than the mean over the window would.
    EXPECT_LT(stated, 1.5 * DelayLineOptions{}.wanted_sigma_mm);
}

TEST(DelayLine, SmoothsAsMuchAsSigmaAsksFor) {
    const DelayLineOptions o;
    EXPECT_DOUBLE_EQ(matched_half_width_mm(0.04, 1, o), 2);
    EXPECT_DOUBLE_EQ(matched_half_width_mm(0.06, 1, o), 4.5);
    EXPECT_DOUBLE_EQ(matched_half_width_mm(1, 1, o), o.longest_mm);
    EXPECT_DOUBLE_EQ(matched_half_width_mm(0, 1, o), o.shortest_mm);
}

TEST(DelayLine, HasNoStepsBetweenItsAnswers) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0, 0.03);
    DelayLine line({});
    for (double s = 0; s < 120; s += 1.3) line.add({s, {normal(random), normal(random)}, noise_of(0.03)});
    Eigen::Vector2d before = line.at(5).off_mm;
    for (double q = 5.001; q < 110; q += 0.001) {
        const Eigen::Vector2d now = line.at(q).off_mm;
        ASSERT_LT((now - before).norm(), 2e-3) << q;
        before = now;
    }
}

TEST(DelayLine, TellsALostStretchAndWhatIsBehindIt) {
    DelayLineOptions o;
    DelayLine line(o);
    for (double s = 0; s <= 50; s += 2) ASSERT_TRUE(line.add({s, {0.2, 0}, noise_of(0.03)}));
    EXPECT_EQ(line.at(-4).state, AheadState::before);
    EXPECT_EQ(line.at(49).state, AheadState::known);
    EXPECT_EQ(line.at(50 + o.shortest_mm + 0.1).state, AheadState::behind);
    EXPECT_NEAR(line.at(80).off_mm.x(), 0.2, 1e-9) << "the newest holds";
    ASSERT_TRUE(line.add({50 + o.most_gap_mm - 1, {0.2, 0}, noise_of(0.03)}));
    EXPECT_EQ(line.at(55).state, AheadState::known) << "bridged";
    ASSERT_TRUE(line.add({90, {0.2, 0}, noise_of(0.03)}));
    EXPECT_EQ(line.at(80).state, AheadState::lost);
    line.forget_before(80);
    EXPECT_EQ(line.at(80).state, AheadState::lost) << "what is needed about the place stays";
}

TEST(DelayLine, AStrayFeatureIsNoContour) {
    DelayLine line({});
    for (double s = 0; s <= 40; s += 1) ASSERT_TRUE(line.add({s, {0, 0}, noise_of(0.03)}));
    EXPECT_FALSE(line.add({41, {0.8, 0}, noise_of(0.03)}));
    EXPECT_FALSE(line.add({41, {0, std::nan("")}, noise_of(0.03)}));
    EXPECT_TRUE(line.add({42, {0.05, -0.05}, noise_of(0.03)}));
    EXPECT_LT(line.at(41).off_mm.norm(), 0.05);
}

// A sensor 60 mm ahead looks at a wave; the robot slows down, stops and hurries. The profiles are stamped late.
struct Wave {
    double off(double x) const { return 0.5 * std::sin(x / 25); }
};

double place_at(double t) {  // mm, of the tool: 50 mm/s, a stop from 1 s to 2 s, then 80 mm/s
    return t < 1 ? 50 * t : t < 2 ? 50 : 50 + 80 * (t - 2);
}

// The sensor turns by up to 2 degrees on its way, so that a wrong time is a wrong place in space too.
Pose sensor_at(double t) {
    const double x = place_at(t) + 60;
    const double turned = -std::acos(-1.0) / 2 + 0.035 * std::sin(x / 40);  // its Y along the travel
    return make_pose(rotation_exp({0, 0, turned}), {x, 15, 40});
}

double worst_error(double believed_latency_s) {
    constexpr double kLatency = 0.012;
    std::vector<GuidePoint> straight;
    for (double x = 0; x <= 400; x += 5) straight.push_back({{x, 0, 0}, Eigen::Vector3d::UnitZ()});
    const GuideCurve guide = curve(straight);
    PoseHistory history(512);
    DelayLine line({});
    const Wave wave;
    double worst = 0;
    double next_profile = 0;
    for (double t = 0; t < 5; t += 0.004) {
        history.add(std::llround(1e9 * t), sensor_at(t));
        if (t >= next_profile && t > 0.05) {
            next_profile += 0.02;
            // The laser plane (sensor y = 0) cuts the wave at the true instant.
            const double exposed = t - kLatency;
            const Pose sensor = sensor_at(exposed);
            double x = sensor.translation().x();
            for (int i = 0; i < 20; ++i) {
                const Eigen::Vector3d in = sensor.inverse() * Eigen::Vector3d(x, -wave.off(x), 0);
                x -= in.y();
            }
            const Eigen::Vector3d seen = sensor.inverse() * Eigen::Vector3d(x, -wave.off(x), 0);
            const auto pose = history.at(std::llround(1e9 * (t - believed_latency_s)), 0.1);
            if (pose) {
                const auto foot = guide.foot(*pose * seen);
                line.add({foot.s_mm, foot.off_mm, noise_of(0.005)});
            }
        }
        const double s = place_at(t);
        if (s < 70) continue;
        const AheadOffset o = line.at(s);
        EXPECT_EQ(o.state, AheadState::known) << t;
        worst = std::max(worst, std::abs(o.off_mm.x() - wave.off(s)));
    }
    return worst;
}

TEST(DelayLine, OverrideAndStopsDoNotMatterAndLatencyIsTakenOff) {
    EXPECT_LT(worst_error(0.012), 5e-3);
    EXPECT_GT(worst_error(0), 4 * worst_error(0.012));
}

TEST(PoseHistory, TellsWhatLiesBetweenAndNothingElse) {
    PoseHistory h(4);
    EXPECT_FALSE(h.at(0, 1));
    for (int i = 0; i < 6; ++i)
        h.add(1000000 * i, make_pose(rotation_exp({0, 0, 0.1 * i}), {10.0 * i, 0, 0}));
    EXPECT_EQ(h.size(), 4u);
    EXPECT_FALSE(h.at(1000000, 1)) << "gone";
    EXPECT_FALSE(h.at(5000001, 1)) << "not known yet";
    EXPECT_FALSE(h.at(4500000, 1e-4)) << "too far apart";
    ASSERT_TRUE(h.at(4500000, 1));
    EXPECT_NEAR(rotation_log(h.at(4500000, 1)->linear()).z(), 0.45, 1e-12);
    h.add(4999999, Pose::Identity());
    EXPECT_NEAR(h.at(5000000, 1)->translation().x(), 50, 1e-12) << "an older time is not kept";
}

}  // namespace
}  // namespace seamwright
