// Contour curvature (5.1) in the residual, and its fit from the reference points of a pass.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/correction/contour_fit.h"
#include "core/correction/correction.h"
#include "tests/core/correction/doors.h"

namespace seamwright {
namespace {

using namespace testing_doors;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kRadius = 350;

// The contour at a spot: a circle of kRadius in the sensor's x-y plane, tangent to Y at the reference,
// bending to +x.
Eigen::Vector3d on_arc(const SpotObservation& s, double angle) {
    return s.reference_mm + kRadius * Eigen::Vector3d(1 - std::cos(angle), std::sin(angle), 0);
}

// Where the displaced arc pierces the sensor plane, by bisection.
Eigen::Vector3d pierce_arc(const SpotObservation& s, const Pose& d) {
    const Pose m = s.workobject_from_sensor.inverse() * d * s.workobject_from_sensor;
    double low = -0.2, high = 0.2;
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        ((m * on_arc(s, middle)).y() < 0 ? low : high) = middle;
    }
    return m * on_arc(s, low);
}

std::vector<TravelPoint> pass_along_arc(const SpotObservation& s, Rng* rng, double sigma) {
    std::vector<TravelPoint> out;
    for (double y = -20; y <= 20; y += 0.5) {
        const Eigen::Vector3d p = on_arc(s, std::asin(y / kRadius));
        out.push_back({y, p.x(), p.z()});
        if (rng) {
            const Eigen::Vector3d e = sigma * gaussian(*rng);
            out.back().x_mm += e.x();
            out.back().z_mm += e.z();
        }
    }
    return out;
}

TEST(ContourCurve, RemovesTheErrorOfTheStraightLine) {
    Rng rng(1);
    std::vector<SpotObservation> spots = door(rng, 10);
    const Pose slide = make_pose(Eigen::Matrix3d::Identity(), {10, 0, 0});
    for (SpotObservation& s : spots) s.measured_mm = pierce_arc(s, slide);
    const auto straight = solve_region(spots, {});
    for (SpotObservation& s : spots) s.curve = *fit_contour_curve(pass_along_arc(s, nullptr, 0));
    const auto curved = solve_region(spots, {});
    ASSERT_EQ(curved->status, CorrectionStatus::ok);
    const auto off = [&](const RegionCorrection& r) {
        double worst = 0;
        for (const SpotObservation& s : spots) {
            const Eigen::Vector3d p = s.workobject_from_sensor * s.reference_mm;
            worst = std::max(worst, (r.displacement.workobject_from_movedworkobject * p - slide * p).norm());
        }
        return worst;
    };
    EXPECT_LT(off(*curved), 0.01);
    CorrectionOptions keep;
    keep.reject_outliers = false;
    for (SpotObservation& s : spots) s.curve.reset();
    EXPECT_GT(off(*solve_region(spots, keep)), 0.03);
    EXPECT_TRUE(curved->consistent);
    EXPECT_LT(curved->rms_mm, 0.002);
}

// One spot that slides by 10 mm along its own contour, alone: the straight line errs by the thesis's figure.
TEST(ContourCurve, StraightLineErrsByTheFigureOfTheThesis) {
    SpotObservation s = spot("A", {0, 0, 0}, {0, 1, 0});
    const Pose slide = make_pose(Eigen::Matrix3d::Identity(), {0, 10, 0});
    s.measured_mm = pierce_arc(s, slide);
    std::vector<SpotObservation> spots{s};
    CorrectionOptions options;
    options.free = {true, false, false, false, false, false};
    // Only x free while the part has slid along Y: what the spot reports as x is the sagitta.
    const double straight =
        solve_region(spots, options)->displacement.workobject_from_movedworkobject.translation().x();
    EXPECT_NEAR(straight, kRadius - std::sqrt(kRadius * kRadius - 100), 1e-9);
    EXPECT_NEAR(straight, 0.143, 0.0005);
}

TEST(ContourCurve, NoisyPassStillServes) {
    Rng rng(2);
    double sum = 0;
    const int trials = 50;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 10);
        const Pose slide = make_pose(Eigen::Matrix3d::Identity(), {7, 7, 0});
        for (SpotObservation& s : spots) {
            s.measured_mm = pierce_arc(s, slide);
            s.curve = *fit_contour_curve(pass_along_arc(s, &rng, 0.03));
        }
        const auto r = solve_region(spots, {});
        ASSERT_EQ(r->status, CorrectionStatus::ok);
        sum += (r->displacement.workobject_from_movedworkobject.translation() - slide.translation()).norm() /
               trials;
    }
    EXPECT_LT(sum, 0.02);
}

// Numeric differentiation of the curve's residual through the covariance would hide a wrong slope;
// convergence would not.
TEST(ContourCurve, ConvergesQuadraticallyWithACurve) {
    Rng rng(3);
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<SpotObservation> spots = door(rng, 8);
        const Pose truth = random_displacement(rng, 10, 1, {0, 0, 0});
        for (SpotObservation& s : spots) {
            s.curve = ContourCurve{{0.05, 1 / 700.0, 1e-5}, {-0.1, -1 / 500.0, 0}, -30, 30};
            // Measured point on the displaced cubic: Newton on its travel.
            const Pose m = s.workobject_from_sensor.inverse() * truth * s.workobject_from_sensor;
            const auto at = [&](double y) {
                return Eigen::Vector3d(
                    m * (s.reference_mm + Eigen::Vector3d(y * (0.05 + y * (1 / 700.0 + y * 1e-5)), y,
                                                          y * (-0.1 - y / 500.0))));
            };
            double y = 0;
            for (int i = 0; i < 50; ++i) y -= at(y).y() / ((at(y + 1e-4).y() - at(y - 1e-4).y()) / 2e-4);
            s.measured_mm = at(y);
        }
        const auto r = solve_region(spots, {});
        ASSERT_EQ(r->status, CorrectionStatus::ok) << r->message;
        EXPECT_LT(distance_mm(r->displacement.workobject_from_movedworkobject, truth), 1e-6);
        EXPECT_LE(r->iterations, 7);
    }
}

TEST(ContourCurve, BeyondItsRangeTheTangentIsFollowedAndItIsSaid) {
    Rng rng(4);
    std::vector<SpotObservation> spots = door(rng, 10);
    const Pose slide = make_pose(Eigen::Matrix3d::Identity(), {12, 0, 0});
    for (SpotObservation& s : spots) {
        s.curve = ContourCurve{{0.1, 0, 0}, {0, 0, 0}, -1, 1};  // a slope: its tangent is the line itself
        SpotObservation sloped = s;
        const Eigen::Vector3d d = Eigen::Vector3d(0.1, 1, 0);
        const Pose m = s.workobject_from_sensor.inverse() * slide * s.workobject_from_sensor;
        const Eigen::Vector3d p = m * s.reference_mm, v = m.linear() * d;
        s.measured_mm = p - v * (p.y() / v.y());
    }
    const auto r = solve_region(spots, {});
    EXPECT_EQ(r->status, CorrectionStatus::ok);
    EXPECT_LT(distance_mm(r->displacement.workobject_from_movedworkobject, slide), 1e-6);
    EXPECT_THAT(r->message, HasSubstr("beyond the taught range"));
}

// A sensor that stands 6 degrees off its edge: where no curve tells the slope, a slide looks like spots that are wrong.
TEST(ContourCurve, WhereNoneWasTakenWhatSlidIsNamedBesideWhatDoesNotFit) {
    Rng rng(4);
    std::vector<SpotObservation> spots = door(rng, 10);
    const Pose slide = make_pose(Eigen::Matrix3d::Identity(), {12, 0, 0});
    const auto measured = [&](double slope) {
        for (SpotObservation& s : spots) {
            const Pose m = s.workobject_from_sensor.inverse() * slide * s.workobject_from_sensor;
            const Eigen::Vector3d p = m * s.reference_mm, v = m.linear() * Eigen::Vector3d(slope, 1, 0);
            s.measured_mm = p - v * (p.y() / v.y());
        }
        const auto r = solve_region(spots, {});
        EXPECT_TRUE(r);
        return r->message;
    };
    EXPECT_THAT(measured(0.1), HasSubstr("where no pass was accepted"));
    EXPECT_THAT(measured(0), Not(HasSubstr("where no pass was accepted")));
    for (SpotObservation& s : spots) s.curve = ContourCurve{{0.1, 0, 0}, {0, 0, 0}, -20, 20};
    EXPECT_THAT(measured(0.1), Not(HasSubstr("where no pass was accepted")));
}

TEST(FitContourCurve, FindsTheLowestOrderThatTheDataAskFor) {
    Rng rng(5);
    const auto pass = [&](double c1, double c2, double c3, double sigma) {
        std::vector<TravelPoint> out;
        for (double y = -20; y <= 20; y += 0.5) {
            const Eigen::Vector3d e = sigma * gaussian(rng);
            out.push_back({y, 3 + y * (c1 + y * (c2 + y * c3)) + e.x(), -2 + e.z()});
        }
        return out;
    };
    int cubic_x = 0, above_line = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const ContourCurve line = *fit_contour_curve(pass(0.1, 0, 0, 0.02));
        EXPECT_NEAR(line.x_coefficients[0], 0.1, 0.003);
        above_line += line.x_coefficients[1] != 0 || line.x_coefficients[2] != 0;
        const ContourCurve cubic = *fit_contour_curve(pass(0.1, 0.001, 3e-5, 0.02));
        cubic_x += cubic.x_coefficients[2] != 0;
        EXPECT_NEAR(cubic.x_coefficients[1], 0.001, 2e-4);
    }
    EXPECT_EQ(cubic_x, 200);
    EXPECT_LE(above_line, 4);  // significance 1e-3 twice
    // Exact data give the exact polynomial.
    const ContourCurve exact = *fit_contour_curve(pass(0.02, -0.003, 1e-4, 0));
    EXPECT_NEAR(exact.x_coefficients[0], 0.02, 1e-12);
    EXPECT_NEAR(exact.x_coefficients[1], -0.003, 1e-13);
    EXPECT_NEAR(exact.x_coefficients[2], 1e-4, 1e-14);
    EXPECT_LT(exact.z_coefficients.norm(), 1e-15);
}

TEST(FitContourCurve, GrossPointsDoNotBendIt) {
    Rng rng(6);
    for (int trial = 0; trial < 50; ++trial) {
        SpotObservation s = spot("A", {0, 0, 0}, {0, 1, 0});
        std::vector<TravelPoint> points = pass_along_arc(s, &rng, 0.02);
        for (int k = 0; k < 12; ++k) points[rng() % points.size()].x_mm += uniform(rng, -8, 8);
        points[3].z_mm = std::nan("");
        const auto c = fit_contour_curve(points);
        ASSERT_TRUE(c.has_value());
        for (const double y : {-10.0, 10.0}) {
            const double x =
                y * (c->x_coefficients[0] + y * (c->x_coefficients[1] + y * c->x_coefficients[2]));
            EXPECT_NEAR(x, kRadius - std::sqrt(kRadius * kRadius - y * y), 0.03);
        }
    }
}

TEST(FitContourCurve, RefusesWhatIsNoPass) {
    EXPECT_FALSE(fit_contour_curve({}).has_value());
    std::vector<TravelPoint> same(30, TravelPoint{1, 2, 3});
    EXPECT_THAT(fit_contour_curve(same).error().sentence(), HasSubstr("travel"));
    std::vector<TravelPoint> nan(30, TravelPoint{std::nan(""), 2, 3});
    EXPECT_THAT(fit_contour_curve(nan).error().sentence(), HasSubstr("usable"));
    std::vector<TravelPoint> two;
    for (int i = 0; i < 20; ++i) two.push_back({i % 2 * 10.0, 1.0, 2.0});
    const auto c = fit_contour_curve(two);  // two different travels carry a line
    ASSERT_TRUE(c.has_value());
    EXPECT_EQ(c->x_coefficients[1], 0);
}

TEST(FTest, AgreesWithTables) {
    EXPECT_NEAR(f_test(4.102821, 2, 10), 0.05, 1e-6);
    EXPECT_NEAR(f_test(4.964603, 1, 10), 0.05, 1e-6);
    EXPECT_NEAR(f_test(14.124, 1, 22), 0.00109, 3e-5);
}

}  // namespace
}  // namespace seamwright
