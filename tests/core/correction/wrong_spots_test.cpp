// Wrong measures: found, named and left out; or said to be untellable.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/correction/correction.h"
#include "core/correction/wrong_spots.h"
#include "tests/core/correction/doors.h"

namespace seamwright {
namespace {

using namespace testing_doors;
using ::testing::HasSubstr;

// Adds an error of `mm` in a random observed direction.
void spoil(SpotObservation& s, Rng& rng, double mm) {
    const double t = uniform(rng, -kPi, kPi);
    s.measured_mm += mm * Eigen::Vector3d(std::cos(t), 0, std::sin(t));
}

struct Tally {
    int exact = 0;   // exactly the wrong spots left out
    int harmed = 0;  // status ok although the displacement is far off what its sigma says
    int refused = 0, kept = 0, trials = 0;
};

Tally play(unsigned seed, int trials, int spots_per_door, int wrong, double mm, double stated_factor = 1) {
    Rng rng(seed);
    Tally tally;
    for (; tally.trials < trials; ++tally.trials) {
        std::vector<SpotObservation> spots = door(rng, spots_per_door);
        const Pose truth = random_displacement(rng, 10, 1, {0, 0, 0});
        measure(spots, truth);
        add_noise(spots, rng, 0.05);
        for (SpotObservation& s : spots) s.sigma_mm = 0.05 / stated_factor;
        std::vector<std::size_t> order(spots.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::shuffle(order.begin(), order.end(), rng);
        std::vector<bool> bad(spots.size());
        for (int k = 0; k < wrong; ++k) {
            const std::size_t which = order[static_cast<std::size_t>(k)];
            bad[which] = true;
            spoil(spots[which], rng, mm);
        }
        const auto solved = solve_region(spots, {});
        if (!solved) continue;
        const RegionCorrection& r = *solved;
        if (r.status != CorrectionStatus::ok) {
            ++tally.refused;
            continue;
        }
        bool exact = true, none = true;
        for (std::size_t n = 0; n < spots.size(); ++n) {
            exact = exact && r.spots[n].used == !bad[n];
            none = none && r.spots[n].used;
            if (!r.spots[n].used) {
                EXPECT_THAT(r.message, HasSubstr(spots[n].id));
            }
        }
        tally.exact += exact;
        tally.kept += none;
        const Pose& d = r.displacement.workobject_from_movedworkobject;
        double worst = 0;
        for (const SpotObservation& s : spots) {
            const Eigen::Vector3d p = s.workobject_from_sensor * s.reference_mm;
            worst = std::max(worst, (d * p - truth * p).norm());
        }
        if (worst > 5 * stated_factor * std::max(0.05, r.sigma_at_spots_mm)) {
            ++tally.harmed;
            EXPECT_TRUE(exact || !r.consistent) << "bent in silence by " << worst << ", " << r.message;
        }
    }
    return tally;
}

TEST(WrongSpots, OneOfEightIsFoundAndLeftOut) {
    for (const double mm : {1.0, 3.0, 20.0, 100.0}) {
        const Tally t = play(static_cast<unsigned>(mm), 400, 8, 1, mm);
        EXPECT_GE(t.exact, 396) << mm << " mm, refused " << t.refused << ", kept all " << t.kept;
        EXPECT_LE(t.harmed, 1);
    }
}

TEST(WrongSpots, OneOfFiveOrSixIsMostlyFoundAndNeverHarms) {
    const Tally five = play(105, 400, 5, 1, 3.0), six = play(106, 400, 6, 1, 3.0);
    EXPECT_GE(five.exact, 280) << "refused " << five.refused << " kept " << five.kept;
    EXPECT_GE(six.exact, 372) << "refused " << six.refused << " kept " << six.kept;
    EXPECT_LE(five.harmed, 8);
    EXPECT_LE(six.harmed, 4);
}

TEST(WrongSpots, TwoOfTwelveAndThreeOfTwentyAreFound) {
    EXPECT_GE(play(212, 200, 12, 2, 3.0).exact, 197);
    EXPECT_GE(play(213, 100, 12, 2, 100.0).exact, 97);
    EXPECT_GE(play(208, 200, 8, 2, 3.0).exact, 120);
    EXPECT_GE(play(320, 20, 20, 3, 3.0).exact, 19);
}

TEST(WrongSpots, ManyOfManyAreFoundByTheGraduatedFit) {
    EXPECT_GE(play(520, 20, 20, 5, 3.0).exact, 18);
    EXPECT_GE(play(1000, 5, 100, 15, 5.0).exact, 4);
}

// Four spots: the contradiction is seen, the culprit cannot be told, nothing is sent.
TEST(WrongSpots, WithoutRedundancyTheRegionIsRefusedAndSaysWhy) {
    Rng rng(4);
    int refused = 0, said = 0;
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 4);
        measure(spots, Pose::Identity());
        add_noise(spots, rng, 0.05);
        const auto clean = solve_region(spots, {});
        if (clean->status != CorrectionStatus::ok) continue;
        spoil(spots[1], rng, 5.0);
        const auto r = solve_region(spots, {});
        for (const SpotResidual& s : r->spots) EXPECT_TRUE(s.used);
        if (r->status == CorrectionStatus::ok) {
            said += !r->consistent && r->message.english().find("contradict") != std::string::npos;
            continue;
        }
        ++refused;
        EXPECT_THAT(r->message, HasSubstr("contradict"));
    }
    EXPECT_GT(refused, 120);
    EXPECT_GT(said + refused, 140);
}

// All residuals beyond the stated sigma (bent part): nothing is thrown away at random, and it is said.
TEST(WrongSpots, ScatterBeyondTheStatedSigmaIsSaidAndSpotsAreKept) {
    Rng rng(5);
    int left_out = 0, said = 0;
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 10);
        measure(spots, random_displacement(rng, 10, 1, {0, 0, 0}));
        add_noise(spots, rng, 0.4);  // stated: 0.05
        const auto r = solve_region(spots, {});
        ASSERT_EQ(r->status, CorrectionStatus::ok) << r->message;
        for (const SpotResidual& s : r->spots) left_out += !s.used;
        said += !r->consistent && r->message.english().find("times") != std::string::npos;
    }
    EXPECT_GE(said, 198);
    EXPECT_LE(left_out, 6);
    // One wrong by far is still told from that scatter.
    const Tally t = play(6, 200, 10, 1, 3.0, 4.0);  // stated sigma a quarter of the noise
    EXPECT_GE(t.exact, 190) << "refused " << t.refused << " kept " << t.kept;
}

TEST(WrongSpots, SwitchedOffNothingIsLeftOut) {
    Rng rng(7);
    std::vector<SpotObservation> spots = door(rng, 8);
    measure(spots, Pose::Identity());
    spoil(spots[3], rng, 3);
    CorrectionOptions options;
    options.reject_outliers = false;
    const auto r = solve_region(spots, options);
    for (const SpotResidual& s : r->spots) EXPECT_TRUE(s.used);
    EXPECT_FALSE(r->consistent);
    EXPECT_GT(r->variance_factor, 10);
}

TEST(WrongSpots, ChiSquareTailsAgreeWithTables) {
    EXPECT_NEAR(correction::chi_square_p(3.841459, 1), 0.05, 1e-6);
    EXPECT_NEAR(correction::chi_square_p(5.991465, 2), 0.05, 1e-6);
    EXPECT_NEAR(correction::chi_square_p(7.814728, 3), 0.05, 1e-6);
    EXPECT_NEAR(correction::chi_square_p(12.591587, 6), 0.05, 1e-6);
    EXPECT_NEAR(correction::chi_square_p(55.758479, 40), 0.05, 1e-6);
    EXPECT_EQ(correction::chi_square_p(0, 4), 1);
}

}  // namespace
}  // namespace seamwright
