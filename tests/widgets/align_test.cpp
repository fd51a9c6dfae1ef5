// What the plot of a pass draws agrees with its verdict.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/alignment/alignment.h"
#include "widgets/align/align_canvas.h"

namespace seamwright {
namespace {

// A groove that stands still, seen with noise; the profile at the trigger lies off by what its own noise happens to be.
std::vector<TravelProfile> pass_off_at_trigger(const Eigen::Vector2d& off_mm, double yaw,
                                               std::mt19937& random) {
    std::normal_distribution<double> noise(0, 0.01);
    std::vector<TravelProfile> pass;
    for (int travel = -15; travel <= 15; ++travel) {
        const Eigen::Vector2d by = travel == 0 ? off_mm : Eigen::Vector2d(yaw * travel, 0);
        TravelProfile one{static_cast<double>(travel), {}};
        for (int i = 0; i < 600; ++i) {
            const double x = -30 + 0.1 * i, z = x < -8  ? 0.3 * x
                                                : x < 6 ? -2.4 - 0.8 * (x + 8)
                                                        : -13.6 + 0.5 * (x - 6);
            one.profile.x_mm.push_back(x + by.x() + noise(random));
            one.profile.z_mm.push_back(z + by.y() + noise(random));
            one.profile.segment.push_back(0);
        }
        pass.push_back(std::move(one));
    }
    return pass;
}

TEST(AlignPlot, PointsLieAboutTheCurveThatTheVerdictRestsOn) {
    std::mt19937 random(11);
    AlignmentOptions options;
    options.reference_mm = Eigen::Vector2d(-8, -2.4);
    for (const double yaw : {0.0, 0.02})
        for (const Eigen::Vector2d& off : {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.03, 0.1)}) {
            const auto pass = pass_off_at_trigger(off, yaw, random);
            const auto result = check_alignment(pass, options);
            ASSERT_TRUE(result);
            OffsetCanvas canvas(nullptr);
            canvas.set_data(*result, options);
            // Points, those not used and the curve of dx, then of dz, then of the turn without a curve.
            ASSERT_GE(canvas.graphCount(), 6);
            for (int row = 0; row < 2; ++row) {
                const auto *points = canvas.graph(3 * row), *curve = canvas.graph(3 * row + 2);
                double sum = 0;
                int n = 0;
                for (const QCPGraphData& p : *points->data()) {
                    if (std::abs(p.key) < 0.5) continue;
                    const auto at = curve->data()->findBegin(p.key);
                    sum += p.value - at->value;
                    ++n;
                }
                ASSERT_GE(n, 25);
                EXPECT_LT(std::abs(sum / n), 0.012)
                    << "yaw " << yaw << ", off " << off.transpose() << ", row " << row;
            }
        }
}

// The constant alone: a known answer.
TEST(AlignPlot, WhatAllOffsetsShareIsTheTriggerProfilesOwn) {
    AlignmentResult result;
    result.status = AlignmentStatus::frozen;
    result.curve.valid_from_mm = -15, result.curve.valid_to_mm = 15;
    for (int travel = -15; travel <= 15; ++travel)
        result.offsets.push_back(
            {static_cast<double>(travel), 0.03, travel == 0 ? 0.0 : -0.1, 0, 0.01, true});
    OffsetCanvas canvas(nullptr);
    canvas.set_data(result, {});
    for (const int row : {0, 1})
        for (const QCPGraphData& p : *canvas.graph(3 * row)->data())
            EXPECT_NEAR(p.key == 0 ? 0 : p.value, 0, 1e-12) << row;
}

}  // namespace
}  // namespace seamwright
