#include "core/calibration/calibration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace seamwright {
namespace {

TEST(Calibration, NamesStrongCorrelationsStrongestFirstAndSkipsFixedParameters) {
    CalibrationReport report;
    report.parameters = {{"x", 1, "mm", 0}, {"y", 2, "mm", 0}, {"z", 3, "mm", 0}, {"radius", 4, "mm", 0}};
    report.covariance = Eigen::MatrixXd::Zero(4, 4);
    const double sx = 0.1, sy = 2.0, sz = 5.0;
    report.covariance.diagonal() << sx * sx, sy * sy, sz * sz, 0;
    report.covariance(0, 1) = report.covariance(1, 0) = 0.85 * sx * sy;
    report.covariance(1, 2) = report.covariance(2, 1) = -0.95 * sy * sz;
    report.covariance(0, 2) = report.covariance(2, 0) = 0.79 * sx * sz;
    finish_statistics(report);
    ASSERT_EQ(report.correlations.size(), 2u);
    EXPECT_EQ(report.correlations[0].first, "y");
    EXPECT_EQ(report.correlations[0].second, "z");
    EXPECT_NEAR(report.correlations[0].correlation, -0.95, 1e-12);
    EXPECT_NEAR(report.correlations[1].correlation, 0.85, 1e-12);
    EXPECT_NEAR(report.parameters[1].sigma, sy, 1e-12);
    EXPECT_EQ(report.parameters[3].sigma, 0);
}

TEST(Calibration, VerdictNamesAreTheContract) {
    EXPECT_EQ(name_of(Verdict::good), "good");
    EXPECT_EQ(name_of(Verdict::usable), "usable");
    EXPECT_EQ(name_of(Verdict::poor), "poor");
    EXPECT_EQ(name_of(Verdict::undetermined), "undetermined");
}

}  // namespace
}  // namespace seamwright
