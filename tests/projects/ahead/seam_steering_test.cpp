// The steering alone, cycle by cycle, against a seam that is known in closed form: an arc, moved by the frame and bent
// besides. Oracles: radius and angle of the tool in the moved arc's own plane.

#include "projects/ahead/seam_steering.h"

#include <gtest/gtest.h>

#include <cmath>

namespace seamwright {
namespace {

constexpr double kRadius = 120, kToolRadius = 130;  // of the contour, and of the tool's path around it

Eigen::Vector3d on_arc(double radius, double angle) {
    return {radius * std::cos(angle), radius * std::sin(angle), 0};
}
// What the frame has not found: the contour lies that much farther out, and higher.
double bent_out(double angle) {
    return 0.8 * std::sin(3 * angle);
}
double bent_up(double angle) {
    return 0.5 * std::cos(2 * angle);
}

struct Arc {
    Pose base_from_moved;
    double worst_mm = 0, farthest_told_mm = 0;
    std::optional<Text> alarm;
    int cycles = 0;

    // The tool along the whole arc; `controller_shifts_along`: what the robot makes of what it is told,
    // `told_of_it`: what the steering takes it to make.
    Arc(const Pose& moved, bool controller_shifts_along, bool told_of_it, double ahead_mm = 40)
        : base_from_moved(moved) {
        std::vector<GuidePoint> guide;
        for (double angle = 0; angle < 2.2; angle += 0.01)
            guide.push_back({on_arc(kRadius, angle), Eigen::Vector3d::UnitZ()});
        SteeringSetup setup;
        setup.base_from_moved = moved;
        setup.shifts_along = told_of_it;
        setup.behind_s = 1e9;
        setup.sigma_limit_mm = 1;
        SeamSteering steering(GuideCurve::make(guide).value(), setup);
        double measured = 0;  // angle until which the sensor has come
        for (double angle = 0.2; angle < 1.8 && !alarm; angle += 0.001) {
            for (; measured < angle + ahead_mm / kRadius; measured += 0.01) {
                Eigen::Vector3d seen = on_arc(kRadius + bent_out(measured), measured);
                seen.z() += bent_up(measured);
                steering.add(moved * seen, 1e-6 * Eigen::Matrix3d::Identity());
            }
            CyclicPacket packet;
            packet.programmed = make_pose(Eigen::Matrix3d::Identity(), on_arc(kToolRadius, angle));
            const auto wanted = steering.wanted(packet, Eigen::Vector3d::Zero());
            alarm = wanted.alarm;
            if (alarm || angle < 0.4) continue;
            ++cycles;
            const Eigen::Vector3d p = packet.programmed->translation();
            Eigen::Vector3d shift = moved * p - p + wanted.offset_mm;
            const Eigen::Vector3d travel(-std::sin(angle), std::cos(angle), 0);
            if (!controller_shifts_along) shift -= travel.dot(shift) * travel;
            const Eigen::Vector3d tool = moved.inverse() * (p + shift);
            const double at = std::atan2(tool.y(), tool.x());
            const double out = std::hypot(tool.x(), tool.y()) - kToolRadius - bent_out(at);
            worst_mm = std::max(worst_mm, std::hypot(out, tool.z() - bent_up(at)));
            farthest_told_mm = std::max(farthest_told_mm, wanted.offset_mm.norm());
        }
    }
};

Pose moved_about(double turn_rad, const Eigen::Vector3d& shift) {
    return make_pose(rotation_exp({0.3 * turn_rad, -0.2 * turn_rad, turn_rad}), shift);
}

// The tool keeps off the bent contour what it was taught to keep, wherever the frame has moved it: at most the smoothing of the delay line over
// its window is left.
TEST(SeamSteering, AControllerThatMakesNoShiftAlongTheTravelIsBroughtOntoTheMovedSeamAllTheSame) {
    for (const double turn : {0.0, 0.005, -0.005})
        for (const Eigen::Vector3d& shift :
             {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(9, 0, 1), Eigen::Vector3d(-9, 0, 1),
              Eigen::Vector3d(4, -8, -2), Eigen::Vector3d(-6, 6, 0)}) {
            const Pose moved = moved_about(turn, shift);
            const Arc rsi(moved, true, true), egm(moved, false, false);
            ASSERT_FALSE(rsi.alarm) << rsi.alarm->english();
            ASSERT_FALSE(egm.alarm) << egm.alarm->english();
            EXPECT_GT(egm.cycles, 1300);
            EXPECT_LT(rsi.worst_mm, 0.02) << shift.transpose();
            EXPECT_LT(egm.worst_mm, 0.02) << shift.transpose() << " turned by " << turn;
            EXPECT_LT(egm.farthest_told_mm, 2) << "the shift itself is the frame's, not the steering's";
        }
}

// What it is for: the same controller, taken for one that makes the whole shift, is off by shift^2 / 2R and by the
// slope of the bend over the shift.
TEST(SeamSteering, TakenForOneThatMakesTheWholeShiftItIsOffByTheCurve) {
    const Arc mistaken(moved_about(0, {-9, 0, 0}), false, true);
    EXPECT_GT(mistaken.worst_mm, 0.9 * 9 * 9 / (2 * kToolRadius));
}

// A part that lies back by the shift needs the measures nearer to the sensor: one that is not so far ahead is an alarm.
TEST(SeamSteering, AShiftBeyondTheSensorsLeadIsAnAlarmNotAGuess) {
    // Towards the begin at angles around 90 degrees: the travel is -x there, so +x lies back.
    const Arc near(moved_about(0, {9, 0, 0}), false, false, 5);
    ASSERT_TRUE(near.alarm);
    EXPECT_NE(near.alarm->english().find("behind the newest measure"), std::string::npos)
        << near.alarm->english();
    const Arc far(moved_about(0, {9, 0, 0}), false, false, 15);
    EXPECT_FALSE(far.alarm);
}

}  // namespace
}  // namespace seamwright
