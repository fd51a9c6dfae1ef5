// A reference is the mean of arrivals of the robot, each from the entry.

#include "projects/station/teach.h"

#include <gtest/gtest.h>

#include "tests/projects/acceptance/device_study_cell.h"

namespace seamwright {
namespace {

TEST(Teach, TheRobotsScatterAveragesOutOfTheReference) {
    StudyTruth truth;
    truth.repeatability_mm = 0.15;
    truth.repeatability_deg = 0;
    StudyCell cell(truth, 21);
    cell.teach_template("T1");
    const Spot draft = *find_spot(cell.project(), "T1");
    constexpr int kTaught = 12, kArrivals = 9;
    const auto variance = [&](int repeats) {
        Eigen::Vector2d sum = Eigen::Vector2d::Zero(), squares = sum;
        for (int i = 0; i < kTaught; ++i) {
            TeachOptions options;
            options.repeats = repeats;
            const auto taught = teach_spot(cell.station(), draft, options);
            EXPECT_TRUE(taught) << taught.error().sentence();
            if (!taught) return 0.0;
            EXPECT_EQ(taught->spot.reference_arrivals, repeats);
            EXPECT_EQ(taught->measurements.size(), static_cast<std::size_t>(repeats * kTaughtAnArrival));
            EXPECT_EQ(taught->mean.size(), taught->spot.reference_profile.size());
            const Eigen::Vector2d p(taught->spot.reference_mm.x(), taught->spot.reference_mm.z());
            sum += p;
            squares += p.cwiseAbs2();
        }
        return ((squares - sum.cwiseAbs2() / kTaught) / (kTaught - 1)).sum();
    };
    const double one = variance(1), many = variance(kArrivals);
    // 22 against 22 degrees of freedom: a ratio of nine is between 4 and 20 in 95 of 100.
    EXPECT_GT(one / many, 3) << one << " " << many;
    EXPECT_LT(one / many, 27);
    EXPECT_NEAR(std::sqrt(one / 2), truth.repeatability_mm, 0.5 * truth.repeatability_mm);
}

TEST(Teach, WithoutAnEntryTheRobotStandsStillWhichIsOneArrival) {
    StudyCell cell({}, 22);
    Spot draft = *find_spot(cell.project(), "T1");
    draft.entry_mm = 0;
    TeachOptions options;
    options.repeats = 4;
    const auto taught = teach_spot(cell.station(), draft, options);
    ASSERT_TRUE(taught) << taught.error().sentence();
    EXPECT_EQ(taught->spot.reference_arrivals, 1);
    EXPECT_EQ(taught->measurements.size(), 8u);
}

TEST(Teach, WhatIsChangedForgetsTheArrivalsWithTheReference) {
    Spot before;
    before.id = "S1";
    before.reference_arrivals = 5;
    Spot after = before;
    after.base_from_flange.translation().x() += 1;
    EXPECT_EQ(with_reference_of(before, after).reference_arrivals, 1);
    EXPECT_EQ(with_reference_of(before, before).reference_arrivals, 5);
}

}  // namespace
}  // namespace seamwright
