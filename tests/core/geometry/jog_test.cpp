// Motions by hand: what stays where it is, and that back undoes ahead.

#include "core/geometry/jog.h"

#include <gtest/gtest.h>

namespace seamwright {
namespace {

const Pose kAt = make_pose(rotation_exp({0.4, -1.1, 2.0}), {812, -340, 955});
const Pose kMount = make_pose(rotation_exp({-0.2, 0.9, 0.3}), {35, -12, 140});

TEST(Jog, AStepAlongMovesByItsLengthAlongTheFramesAxis) {
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d step = 2.5 * Eigen::Vector3d::Unit(axis);
        const auto moved = [&](JogFrame frame) {
            const Pose after = jogged(kAt, kMount, frame, step, Eigen::Vector3d::Zero());
            EXPECT_LT(angle_rad(after, kAt), 1e-12);
            return Eigen::Vector3d(after.translation() - kAt.translation());
        };
        EXPECT_LT((moved(JogFrame::base) - step).norm(), 1e-9);
        EXPECT_LT((moved(JogFrame::flange) - kAt.linear() * step).norm(), 1e-9);
        EXPECT_LT((moved(JogFrame::sensor) - kAt.linear() * kMount.linear() * step).norm(), 1e-9);
    }
}

TEST(Jog, ATurnKeepsItsPointAndItsAxis) {
    const Eigen::Vector3d turn(0.02, -0.05, 0.03);
    for (const JogFrame frame : {JogFrame::base, JogFrame::flange, JogFrame::sensor}) {
        const Pose after = jogged(kAt, kMount, frame, Eigen::Vector3d::Zero(), turn);
        EXPECT_NEAR(angle_rad(after, kAt), turn.norm(), 1e-12);
        const Pose before_point = frame == JogFrame::flange ? kAt : kAt * kMount;
        const Pose after_point = frame == JogFrame::flange ? after : after * kMount;
        EXPECT_LT((after_point.translation() - before_point.translation()).norm(), 1e-9);
        const Eigen::Vector3d axis_in_base = frame == JogFrame::base ? turn
                                             : frame == JogFrame::flange
                                                 ? Eigen::Vector3d(kAt.linear() * turn)
                                                 : Eigen::Vector3d(before_point.linear() * turn);
        EXPECT_LT((rotation_log(after.linear() * kAt.linear().transpose()) - axis_in_base).norm(), 1e-9);
    }
}

TEST(Jog, BackUndoesAhead) {
    const Eigen::Vector3d shift(1, -2, 0.5), turn(0.01, 0.02, -0.03), none = Eigen::Vector3d::Zero();
    for (const JogFrame frame : {JogFrame::base, JogFrame::flange, JogFrame::sensor}) {
        for (const auto& [s, t] : {std::pair(shift, none), std::pair(none, turn)}) {
            const Pose there = jogged(kAt, kMount, frame, s, t);
            const Pose back = jogged(there, kMount, frame, -s, -t);
            EXPECT_LT(distance_mm(back, kAt), 1e-9);
            EXPECT_LT(angle_rad(back, kAt), 1e-9);
        }
    }
}

TEST(Jog, WithoutACalibrationTheSensorsAxesAreTheFlanges) {
    const Eigen::Vector3d shift(1, 2, 3), turn(0.1, 0, 0.2);
    const Pose sensor = jogged(kAt, Pose::Identity(), JogFrame::sensor, shift, turn);
    const Pose flange = jogged(kAt, Pose::Identity(), JogFrame::flange, shift, turn);
    EXPECT_LT(distance_mm(sensor, flange), 1e-12);
    EXPECT_LT(angle_rad(sensor, flange), 1e-9);
}

}  // namespace
}  // namespace seamwright
