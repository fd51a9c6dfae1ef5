// Prediction against what solving finds, and advice that is put to the proof.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/correction/correction.h"
#include "tests/core/correction/doors.h"
#include "tests/core/english.h"

namespace seamwright {
namespace {

using namespace testing_doors;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(PlanRegion, PredictsWhatSolvingStatesAtRest) {
    Rng rng(1);
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 3 + trial % 10, {500, 0, 900});
        const RegionPlan plan = *plan_region(spots, {});
        measure(spots, Pose::Identity());
        const RegionCorrection solved = *solve_region(spots, {});
        EXPECT_EQ(plan.status, solved.status);
        EXPECT_EQ(plan.unobservable, solved.unobservable);
        EXPECT_EQ(plan.redundancy, solved.redundancy);
        EXPECT_NEAR(plan.sigma_at_spots_mm / solved.sigma_at_spots_mm, 1, 1e-3);
        EXPECT_LT((plan.covariance - solved.covariance).norm(), 1e-6 * solved.covariance.norm());
        EXPECT_NEAR(plan.weakest_direction.norm(), 1, 1e-12);
        EXPECT_FALSE(plan.weakest.empty());
    }
}

TEST(PlanRegion, IgnoresMeasures) {
    Rng rng(2);
    std::vector<SpotObservation> spots = door(rng, 6);
    const RegionPlan before = *plan_region(spots, {});
    for (SpotObservation& s : spots) s.measured_mm.setConstant(std::nan(""));
    EXPECT_EQ(plan_region(spots, {})->covariance, before.covariance);
}

// Parallel edges: the advice names an edge across, and following it makes the region observable.
TEST(PlanRegion, AdviceCuresParallelEdges) {
    std::vector<SpotObservation> spots{spot("A", {0, 0, 0}, {0, 1, 0}), spot("B", {700, 100, 30}, {0, 1, 0}),
                                       spot("C", {300, 500, 120}, {0, 1, 0})};
    const RegionPlan plan = *plan_region(spots, {});
    EXPECT_EQ(plan.status, CorrectionStatus::under_determined);
    EXPECT_THAT(english(plan.unobservable), ElementsAre("translation along Y"));
    EXPECT_EQ(plan.weakest, "translation along Y");
    EXPECT_THAT(plan.uncontrolled, ElementsAre("A", "B", "C"));
    EXPECT_THAT(plan.advice, HasSubstr("add a spot"));
    EXPECT_TRUE(plan.advice.english().find("edge along X") != std::string::npos ||
                plan.advice.english().find("edge along Z") != std::string::npos)
        << plan.advice;
    // "... at (x, y, z) mm of the work object with its edge along X ..."
    double x, y, z;
    char axis;
    const std::string tail = plan.advice.english().substr(plan.advice.english().find("at ("));
    ASSERT_EQ(std::sscanf(tail.c_str(), "at (%lf, %lf, %lf) mm of the work object with its edge along %c", &x,
                          &y, &z, &axis),
              4)
        << tail;
    spots.push_back(spot("D", {x, y, z}, Eigen::Vector3d::Unit(axis - 'X')));
    const RegionPlan after = *plan_region(spots, {});
    EXPECT_EQ(after.status, CorrectionStatus::ok);
    double promised = 0;
    const std::string gain = plan.advice.english().substr(
        plan.advice.english().find(" to ", plan.advice.english().find("goes from")));
    ASSERT_EQ(std::sscanf(gain.c_str(), " to %lf mm", &promised), 1) << gain;
    EXPECT_NEAR(after.sigma_at_spots_mm, promised, 0.01 * promised);
}

TEST(PlanRegion, OneSpotNeedsSeveralMore) {
    const RegionPlan plan = *plan_region(std::vector<SpotObservation>{spot("A", {100, 0, 0}, {0, 1, 0})}, {});
    EXPECT_EQ(plan.status, CorrectionStatus::under_determined);
    EXPECT_TRUE(std::isinf(plan.sigma_at_spots_mm));
    EXPECT_THAT(plan.advice, HasSubstr("spots"));
    EXPECT_THAT(plan.advice, HasSubstr("; and "));
}

TEST(PlanRegion, AStrongRegionNeedsNothing) {
    Rng rng(3);
    const RegionPlan plan = *plan_region(door(rng, 16), {});
    EXPECT_EQ(plan.status, CorrectionStatus::ok);
    EXPECT_TRUE(plan.uncontrolled.empty());
    EXPECT_THAT(plan.advice, HasSubstr("no further spot is needed"));
}

// The word is kept: a spot not called uncontrolled is found when it is 3 mm wrong, one of those called so
// often is not.
TEST(PlanRegion, UncontrolledMeansWhatItSays) {
    Rng rng(4);
    int controlled = 0, controlled_found = 0, uncontrolled = 0, uncontrolled_found = 0;
    for (int trial = 0; trial < 300; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 4 + trial % 5);
        const RegionPlan plan = *plan_region(spots, {});
        if (plan.status != CorrectionStatus::ok) continue;
        measure(spots, random_displacement(rng, 5, 0.5, {0, 0, 0}));
        add_noise(spots, rng, 0.05);
        const std::size_t n = rng() % spots.size();
        const double t = uniform(rng, -kPi, kPi);
        spots[n].measured_mm += kFindableErrorMm * Eigen::Vector3d(std::cos(t), 0, std::sin(t));
        const RegionCorrection r = *solve_region(spots, {});
        bool found = r.status == CorrectionStatus::ok;
        for (std::size_t k = 0; k < spots.size(); ++k) found = found && r.spots[k].used == (k != n);
        const bool named = std::find(plan.uncontrolled.begin(), plan.uncontrolled.end(), spots[n].id) !=
                           plan.uncontrolled.end();
        (named ? uncontrolled : controlled) += 1;
        (named ? uncontrolled_found : controlled_found) += found;
    }
    EXPECT_GT(controlled, 80);
    EXPECT_GT(uncontrolled, 40);
    EXPECT_GE(controlled_found, 0.97 * controlled) << controlled_found << " of " << controlled;
    EXPECT_LE(uncontrolled_found, 0.6 * uncontrolled) << uncontrolled_found << " of " << uncontrolled;
}

TEST(PlanRegion, RefusesHostileInput) {
    EXPECT_FALSE(plan_region({}, {}).has_value());
    Rng rng(5);
    std::vector<SpotObservation> spots = door(rng, 4);
    spots[2].reference_mm.x() = std::nan("");
    EXPECT_FALSE(plan_region(spots, {}).has_value());
    // Many spots: seconds, not hours.
    const std::vector<SpotObservation> many = door(rng, 200);
    EXPECT_EQ(plan_region(many, {})->status, CorrectionStatus::ok);
}

}  // namespace
}  // namespace seamwright
