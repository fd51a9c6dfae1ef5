// What is taken for the calibration sphere: every honest view of it, and no rounding of a sheet.

#include "projects/calibrate/session/sphere_sight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "devices/simulated/cell.h"
#include "projects/calibrate/methods/example/target_views.h"
#include "projects/calibrate/session/capture.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

std::optional<Profile> profile_seen(SimulatedCell& cell, const Pose& base_from_flange, std::uint64_t seed) {
    Frame frame;
    cell.render(base_from_flange, seed, frame);
    StripePeaks peaks;
    Capture capture;
    Text why;
    Profile profile;
    if (capture_frame(frame, {}, &cell.sensor_model(), peaks, capture, why) != SpotStatus::measured ||
        !track_capture(capture, {}, profile))
        return std::nullopt;
    return profile;
}

class SphereSight : public testing::TestWithParam<double> {};

// Anywhere in the field and half out of it, cut anywhere, turned to all sides, with noise and stray light as they come.
TEST_P(SphereSight, IsSeenWhereverItIs) {
    CellSettings settings = default_cell_settings();
    settings.scene = Scene::sphere;
    settings.sphere_radius_mm = GetParam();
    const auto cell = SimulatedCell::open(settings).value();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    int seen = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
        const Eigen::Vector3d turn(25 * any(random), 25 * any(random), 180 * any(random));
        const Eigen::Vector3d centre(35 * any(random), 0.9 * GetParam() * any(random),
                                     -GetParam() + 25 * any(random));
        const TargetPlace place{turn, -(rotation_exp(turn * (kPi / 180)) * centre)};
        const Pose at =
            settings.base_from_target * target_from_sensor(place) * cell->flange_from_sensor().inverse();
        const auto profile = profile_seen(*cell, at, 1000 + i);
        if (!profile) continue;
        const auto at_it = [&](const CircleSection& c) {
            return std::hypot(c.x_mm - centre.x(), c.z_mm - centre.z()) < 1.5;
        };
        const auto circle = sphere_in_profile(*profile, GetParam(), false, "view");
        seen += circle.has_value();
        if (circle) {
            EXPECT_TRUE(at_it(*circle)) << "at " << circle->x_mm << ", " << circle->z_mm;
        }
        // A stray reflection may hide it altogether.
        if (const auto any_circle = find_circle_section(*profile, limits_of_sphere(GetParam()));
            any_circle && at_it(*any_circle)) {
            EXPECT_TRUE(circle) << "at " << centre.transpose() << " turned by " << turn.transpose();
        }
    }
    EXPECT_GT(seen, 50);
}

// Fold, hem, embossings and the ramp of the door, at every place of its edge.
TEST_P(SphereSight, IsNotSeenOnADoor) {
    const auto cell = SimulatedCell::open(default_cell_settings()).value();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    int circles = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
        const DoorEdge e = door_edge(door_edge_length_mm() * (0.5 + 0.5 * any(random)));
        Eigen::Matrix3d axes;
        axes.col(0) = e.inboard;
        axes.col(1) = e.up.cross(e.inboard);
        axes.col(2) = e.up;
        const Pose over = make_pose(
            axes, e.point_mm + e.inboard * (15 + 25 * any(random)) + e.up * (1.5 + 15 * any(random)));
        const Eigen::Vector3d turn = i % 2 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                           : Eigen::Vector3d(20 * any(random), 20 * any(random), 0);
        const Pose at = over * make_pose(rotation_exp(turn * (kPi / 180)), {0, 0, 0});
        const auto profile = profile_seen(*cell, cell->flange_for(at), 5000 + i);
        if (!profile) continue;
        circles += find_circle_section(*profile, limits_of_sphere(GetParam())).has_value();
        EXPECT_FALSE(sphere_in_profile(*profile, GetParam(), false, "door"));
    }
    EXPECT_GT(circles, 20) << "a circle alone tells little";
}
INSTANTIATE_TEST_SUITE_P(Radius, SphereSight, testing::Values(8.0, 15.0, 25.0, 40.0));

// The contour of a spot, as the sensor stands before any target is set up.
TEST(SphereSightCapture, AContourIsNotCaptured) {
    const auto cell = SimulatedCell::open(default_cell_settings()).value();
    Calibration base;
    base.model = cell->sensor_model();
    SensorSetup sensor;
    sensor.id = "A";
    const CalibrationMethod& method = *find_method("tcp-sphere");
    for (const DoorSpot& spot : default_door_spots()) {
        const Pose at = cell->flange_for(spot.workobject_from_sensor);
        Frame frame;
        cell->render(at, 77, frame);
        const auto taken = capture_shot(method, default_settings(method), sensor, &base, frame, nullptr, at);
        EXPECT_FALSE(taken) << spot.id;
    }
}

// Profiles by formula, 0.1 mm apart, each with its own noise.
struct Drawn {
    Profile profile;
    std::mt19937 random{11};
    void to(double x, double z) {
        std::normal_distribution<double> noise(0, 0.02);
        profile.x_mm.push_back(x);
        profile.z_mm.push_back(z + noise(random));
    }
    void line(double x0, double z0, double x1, double z1) {
        const int n = static_cast<int>(std::hypot(x1 - x0, z1 - z0) / 0.1);
        for (int i = 0; i < n; ++i) to(x0 + (x1 - x0) * i / n, z0 + (z1 - z0) * i / n);
    }
    // About (x, z), from the left to the right, angles from the upright; hollow: below the centre.
    void arc(double x, double z, double r, double from_deg, double to_deg, bool hollow = false) {
        const int n = static_cast<int>(r * rad_from_deg(to_deg - from_deg) / 0.1);
        for (int i = 0; i <= n; ++i) {
            const double a = rad_from_deg(from_deg + (to_deg - from_deg) * i / n);
            to(x + r * std::sin(a), hollow ? z - r * std::cos(a) : z + r * std::cos(a));
        }
    }
    Expected<CircleSection> seen(double radius_mm = 25, bool either = false) const {
        return sphere_in_profile(profile, radius_mm, either, "drawn");
    }
};

TEST(SphereSightDrawn, BesideItsStandAndAClamp) {
    for (const double base :
         {-60.0, -30.0, -12.0, -5.0}) {  // of the plate that it stands in, under its middle
        Drawn d;
        d.line(-70, base, -20, base);
        d.arc(0, 0, 20, -75, 75);
        d.line(23, base, 40, base);
        d.line(40, 12, 55, 12);  // a clamp
        d.line(55, base, 70, base);
        const auto circle = d.seen();
        ASSERT_TRUE(circle) << base << ": " << circle.error().sentence();
        EXPECT_NEAR(circle->radius_mm, 20, 0.2);
    }
}

TEST(SphereSightDrawn, HalfOutOfThePictureAndBehindSomething) {
    Drawn left, right, hidden;
    left.arc(0, 0, 20, -75, -5);
    right.arc(0, 0, 20, 10, 75);
    right.line(30, -40, 60, -40);
    hidden.line(-60, 25, -8, 25);  // nearer to the sensor, over the left half
    hidden.arc(0, 0, 20, -20, 75);
    for (const Drawn* d : {&left, &right, &hidden}) {
        const auto circle = d->seen();
        EXPECT_TRUE(circle) << (circle ? "" : circle.error().sentence());
    }
}

// A rounding of the sheet lies before it, and holds more points.
TEST(SphereSightDrawn, BesideARoundingOfTheSheet) {
    Drawn d;
    d.line(-110, -20, -70, -20);
    d.arc(-70, -44, 24, 0, 60);
    d.line(-70 + 24 * std::sin(kPi / 3), -32, -25, -70);
    d.arc(0, 0, 12, -75, 75);
    const auto circle = d.seen(25);
    ASSERT_TRUE(circle) << circle.error().sentence();
    EXPECT_NEAR(circle->radius_mm, 12, 0.2);
}

TEST(SphereSightDrawn, ARoundingRunsOn) {
    for (const double turn_deg : {40.0, 60.0, 80.0})
        for (const bool both : {false, true}) {
            const double end = rad_from_deg(turn_deg), r = 20;
            Drawn d;
            if (both) d.line(-60, r, 0, r);
            d.arc(0, 0, r, 0, turn_deg);
            d.line(r * std::sin(end), r * std::cos(end), r * std::sin(end) + 40 * std::cos(end),
                   r * std::cos(end) - 40 * std::sin(end));
            EXPECT_FALSE(d.seen()) << turn_deg << (both ? ", both flanks" : ", one flank");
            EXPECT_FALSE(d.seen(0)) << "nor of a radius that nobody knows";
        }
}

TEST(SphereSightDrawn, ABowlIsNone) {
    Drawn bowl;
    bowl.line(-60, 10, -22, 10);
    bowl.arc(0, 10, 20, -70, 70, true);
    bowl.line(22, 10, 60, 10);
    const auto refused = bowl.seen();
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("hollow"));
    // A device that counts away from itself shows a sphere so.
    Drawn away;
    away.arc(0, 10, 20, -70, 70, true);
    EXPECT_FALSE(away.seen());
    EXPECT_TRUE(away.seen(25, true));
}

}  // namespace
}  // namespace seamwright
