// The evaluation's laws: what grows, what stays, what the straight line misses, what the bound allows.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "projects/evaluate/online_report.h"
#include "projects/evaluate/report.h"

namespace seamwright::evaluation {
namespace {

EvaluationSettings settings(int experiment = 0, int trials = 150) {
    EvaluationSettings s;
    s.experiment = experiment;
    s.trials = trials;
    s.jobs = 2;
    return s;
}

Expected<EvaluationResult> run(const EvaluationSettings& s) {
    return evaluate(s, [](const std::string&) {});
}

TEST(Evaluation, StraightContoursReachTheBoundAndStateTheTruth) {
    std::atomic<std::size_t> profiles{0};
    const auto r = straight_trials(settings(0, 300), profiles);
    ASSERT_TRUE(r) << r.error().sentence();
    // 300 trials of 6 degrees: the efficiency scatters by 0.033.
    EXPECT_GT(r->efficiency, 0.86);
    EXPECT_LT(r->efficiency, 1.1);
    EXPECT_GT(r->landmark_efficiency, 0.86);
    EXPECT_LT(r->landmark_efficiency, 1.06);
    // Same trials, so the difference scatters less: the correlation of x and z is worth a tenth at least.
    EXPECT_LT(r->efficiency_one_sigma, r->efficiency - 0.1);
    // 99.9 % of a mean of 300 chi-squares with 6 degrees: +-0.66.
    EXPECT_NEAR(r->nees_still, 6, 0.66);
    EXPECT_NEAR(r->nees_in_motion, 6, 0.66);
    EXPECT_EQ(r->refused, 0);
}

TEST(Evaluation, BoundIsProportionalToTheNoise) {
    std::atomic<std::size_t> profiles{0};
    EvaluationSettings s = settings(0, 12);
    const auto one = straight_trials(s, profiles);
    s.noise_mm *= 1.5;
    const auto more = straight_trials(s, profiles);
    ASSERT_TRUE(one && more);
    // Which points the template covers depends a little on the noise.
    EXPECT_NEAR(more->bound_mm / one->bound_mm, 1.5, 0.06);
}

TEST(Evaluation, LearntCurveTakesTheBiasOfTheStraightLineAway) {
    std::atomic<std::size_t> profiles{0};
    for (const double radius : {350.0, 2000.0}) {
        const auto r = curved_contour(settings(0, 300), radius, profiles);
        ASSERT_TRUE(r) << r.error().sentence();
        ASSERT_EQ(r->radius_mm, radius);
        int at_ten = 0;
        for (const CurveStep& s : r->steps) {
            const double e = s.displacement_mm;
            EXPECT_NEAR(s.expected_mm, radius - std::sqrt(radius * radius - e * e), 1e-12);
            EXPECT_NEAR(s.straight_mm, s.expected_mm, 0.01) << radius << " " << e;
            EXPECT_LT(std::abs(s.learnt_mm), 0.01) << radius << " " << e;
            // The region of contours that all bend the same way is carried off as a whole.
            EXPECT_NEAR(s.region_straight_mm, s.expected_mm, 0.012) << radius << " " << e;
            EXPECT_LT(s.region_learnt_mm, 0.018);
            at_ten += std::abs(e) == 10;
        }
        EXPECT_EQ(at_ten, 2);
    }
}

TEST(Evaluation, SameForASeedWhateverTheNumberOfThreads) {
    std::atomic<std::size_t> profiles{0};
    EvaluationSettings s = settings();
    s.jobs = 1;
    const auto one = curved_contour(s, 500, profiles);
    s.jobs = 3;
    const auto three = curved_contour(s, 500, profiles);
    s.seed = 2;
    const auto other = curved_contour(s, 500, profiles);
    ASSERT_TRUE(one && three && other);
    for (std::size_t i = 0; i < one->steps.size(); ++i) {
        EXPECT_EQ(one->steps[i].learnt_mm, three->steps[i].learnt_mm);
        EXPECT_EQ(one->steps[i].region_straight_mm, three->steps[i].region_straight_mm);
        EXPECT_NE(one->steps[i].learnt_mm, other->steps[i].learnt_mm);
    }
}

TEST(Evaluation, MisalignedSensorsErrInProportionAndAreFlaggedBeforehand) {
    for (const int number : {4, 5}) {
        const auto r = run(settings(number));
        ASSERT_TRUE(r) << r.error().sentence();
        const ExperimentResult& e = r->experiments.at(0);
        EXPECT_EQ(e.flagged, e.spots);
        EXPECT_NEAR(e.worst_yaw_deg, 5, 0.6);
        EXPECT_TRUE(e.growth.grows()) << e.growth.slope_mm_per_mm;
        EXPECT_TRUE(e.growth.linear()) << e.growth.linear_share << " " << e.growth.bend_share;
        // Half of the spots slide by d and see tan(5 degrees) of it; no more than that comes through.
        EXPECT_LT(e.growth.slope_mm_per_mm, std::tan(rad_from_deg(5.5)));
        EXPECT_GT(e.summary[0].three_sigma, 0.3);
        EXPECT_GT(e.nees, 20);
        for (const EvaluationCheck& c : evaluation_checks(*r))
            EXPECT_TRUE(c.kept) << c.promise << ": " << c.found;
    }
    // Twice the angle, twice the slope.
    EvaluationSettings s = settings(5);
    const auto once = run(s);
    s.misalignment_deg *= 2;
    const auto twice = run(s);
    ASSERT_TRUE(once && twice);
    EXPECT_NEAR(twice->experiments[0].growth.slope_mm_per_mm / once->experiments[0].growth.slope_mm_per_mm, 2,
                0.25);
}

TEST(Evaluation, MatchingIsFourTimesBetterThanTheContoursEndAndKeepsItsPromises) {
    const auto standard = run(settings(1)), matched = run(settings(3));
    ASSERT_TRUE(standard && matched);
    const ExperimentResult &a = standard->experiments.at(0), &b = matched->experiments.at(0);
    EXPECT_EQ(a.flagged + b.flagged, 0);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_LE(b.summary[c].three_sigma, 0.05);
        EXPECT_GE(a.summary[c].three_sigma, 4 * b.summary[c].three_sigma);
        EXPECT_EQ(b.refused[c], 0);
    }
    EXPECT_FALSE(b.growth.grows());
    ASSERT_EQ(matched->budget.size(), 7u);
    double squares = 0;
    for (std::size_t i = 0; i + 1 < matched->budget.size(); ++i) {
        EXPECT_GT(matched->budget[i].adds_mm, 0) << matched->budget[i].name;
        squares += std::pow(matched->budget[i].adds_mm, 2);
    }
    EXPECT_NEAR(matched->budget.back().adds_mm, std::sqrt(squares), 1e-12);
    // Sources of the experiment itself make up what it found: curvature, noise, robot, jitter.
    double own = 0;
    for (std::size_t i = 0; i < 4; ++i) own += std::pow(matched->budget[i].adds_mm, 2);
    EXPECT_NEAR(std::sqrt(own), b.summary[2].three_sigma, 0.2 * b.summary[2].three_sigma);

    const nlohmann::json j = evaluation_json(*matched);
    EXPECT_EQ(j["budget"].size(), 7u);
    EXPECT_EQ(j["curved"].size(), std::size(kCurveRadiiMm));
    EXPECT_EQ(j["experiments"][0]["columns"]["both"]["three_sigma_mm"], b.summary[2].three_sigma);
    const std::string html = evaluation_html(*matched), text = evaluation_text(*matched);
    for (const char* part : {"not measured on a machine", "calibration error", "Cramer-Rao", "NEES"}) {
        EXPECT_THAT(html, testing::HasSubstr(part));
        EXPECT_THAT(text, testing::HasSubstr(part));
    }
    EXPECT_THAT(html, testing::HasSubstr("<svg"));
}

// A bent part breaks the model; the report says so and names the reason.
TEST(Evaluation, BentPartIsSaidToBreakTheModel) {
    EvaluationSettings s = settings(2);
    s.bend_mm = 0.5;
    const auto r = run(s);
    ASSERT_TRUE(r);
    EXPECT_FALSE(evaluation_json(*r)["experiments"][0]["model_holds"].get<bool>());
    EXPECT_THAT(evaluation_text(*r), testing::HasSubstr("not rigid"));
}

TEST(EvaluationReport, BrokenPromisesAreNotKept) {
    EvaluationResult r;
    r.straight.trials = 2000;
    r.straight.efficiency = 0.85;
    r.straight.nees_still = 6.0;
    r.straight.nees_in_motion = 6.3;
    r.curved.push_back({350, {{-10, 0.1429, 0.143, 0.012}, {10, 0.1429, 0.143, 0.001}}});
    const auto checks = evaluation_checks(r);
    ASSERT_EQ(checks.size(), 4u);
    EXPECT_FALSE(checks[0].kept);
    EXPECT_TRUE(checks[1].kept);
    EXPECT_FALSE(checks[2].kept);
    EXPECT_FALSE(checks[3].kept);
    r.straight.efficiency = 0.95;
    r.straight.nees_in_motion = 5.9;
    r.curved[0].steps[0].learnt_mm = -0.004;
    for (const EvaluationCheck& c : evaluation_checks(r)) EXPECT_TRUE(c.kept) << c.promise;
}

TEST(Evaluation, OnlineFollowsWhatOfflineCannotAndFallsBehindWithoutLookAhead) {
    std::atomic<std::size_t> profiles{0};
    const auto r = online_experiment(settings(kOnline), profiles);
    ASSERT_TRUE(r) << r.error().sentence();
    const auto way = [&](bool online, bool bent, double speed = 100,
                         double delay = 60) -> const OnlineResult& {
        for (const OnlineResult& o : r->results)
            if (o.way.online == online && o.bent == bent &&
                (!online || (o.way.speed_mm_s == speed && o.way.delay_ms == delay)))
                return o;
        ADD_FAILURE() << "no such way";
        return r->results.front();
    };
    // Noise alone is left where the measures are known in time, at any delay, bent or not.
    for (const double delay : {20.0, 60.0, 150.0}) {
        const OnlineResult& o = way(true, false, 100, delay);
        EXPECT_TRUE(o.way.in_time());
        EXPECT_EQ(o.alarms, 0);
        EXPECT_GT(o.error.three_sigma, 0.8 * 3 * o.sigma_mm);
        EXPECT_LT(o.error.three_sigma, 1.4 * 3 * o.sigma_mm);
        EXPECT_LT(std::abs(o.error.mean), 0.01);
    }
    EXPECT_NEAR(way(true, true).error.three_sigma, way(true, false).error.three_sigma, 0.01);
    EXPECT_LT(way(true, true).error.three_sigma, 0.8 * way(false, true).error.three_sigma);
    EXPECT_GT(way(false, true).error.three_sigma, 1.15 * way(false, false).error.three_sigma);
    // Not known in time: the following error is that of the path run since.
    EXPECT_FALSE(way(true, false, 200, 150).way.in_time());
    EXPECT_GT(way(true, false, 200, 150).error.three_sigma, 3 * way(true, false, 200, 60).error.three_sigma);
    // Known in time but held back by the ramp.
    EXPECT_TRUE(way(true, false, 400, 20).way.in_time());
    EXPECT_GT(way(true, false, 400, 20).behind_share, way(true, false, 100, 20).behind_share);
    EXPECT_GT(way(true, false, 400, 20).error.three_sigma, 1.5 * way(true, false, 200, 20).error.three_sigma);
    // Said in words, with the ways by name: no alarm tells.
    const std::string verdict = online_verdict(*r);
    const auto blind = verdict.substr(0, verdict.find("Known in time"));
    EXPECT_THAT(blind, testing::HasSubstr("400 mm/s with 150 ms"));
    EXPECT_THAT(blind, testing::HasSubstr("200 mm/s with 150 ms"));
    EXPECT_THAT(blind, testing::Not(testing::HasSubstr("100 mm/s with")));
    EXPECT_THAT(verdict.substr(blind.size()), testing::HasSubstr("400 mm/s with 20 ms"));
}

}  // namespace
}  // namespace seamwright::evaluation
