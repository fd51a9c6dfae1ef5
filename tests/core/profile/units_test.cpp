// Units that a profile's grid gives away.
#include "core/profile/units.h"

#include <gtest/gtest.h>

#include <cmath>

namespace seamwright {
namespace {

Profile grid(int points, double pitch, double round_to) {
    Profile profile;
    for (int i = 0; i < points; ++i) {
        const double x = -0.5 * (points - 1) * pitch + i * pitch;
        profile.x_mm.push_back(std::round(x / round_to) * round_to);
        profile.z_mm.push_back(std::round(3 * std::sin(0.2 * i * pitch) / round_to) * round_to);
    }
    return profile;
}

TEST(Units, AGridThatWasRoundInMillimetresIsInches) {
    for (const double pitch_mm : {0.08, 0.1, 0.125, 0.2, 0.25, 0.318})
        for (const int points : {320, 640, 1280, 2048})
            for (const double round_to : {1e-7, 1e-12}) {
                const Profile inch = grid(points, pitch_mm / 25.4, round_to);
                EXPECT_NE(profile_scale(inch).suspected, "") << pitch_mm << " " << points << " " << round_to;
                EXPECT_EQ(profile_scale(grid(points, pitch_mm, round_to)).suspected, "") << pitch_mm;
            }
}

// Whole millimetres over one step less than the points: what profilers and numpy.linspace deliver. One in seventy is within
// 1e-5 of a round number of inches.
TEST(Units, AWidthOverTheNumberOfStepsIsNoInch) {
    int wrong = 0, tried = 0;
    for (int width = 20; width <= 120; width += 2)
        for (const int points : {320, 400, 512, 640, 800, 1024, 1280, 2048}) {
            ++tried;
            wrong +=
                profile_scale(grid(points, static_cast<double>(width) / (points - 1), 1e-12)).suspected ==
                "inches";
        }
    EXPECT_LE(wrong, 1) << "of " << tried;
    EXPECT_EQ(profile_scale(grid(640, 80.0 / 639, 1e-9)).suspected, "");
}

}  // namespace
}  // namespace seamwright
