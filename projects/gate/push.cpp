#include "projects/gate/push.h"

#include <cassert>
#include <limits>
#include <utility>

namespace seamwright {
namespace {

constexpr double kRigid = 1e-6;  // a rotation's, off an orthonormal one

struct FrameDistance {
    double mm, deg;
    bool equal() const { return mm <= kReadBackToleranceMm && deg <= kReadBackToleranceDeg; }
};
FrameDistance distance(const Pose& a, const Pose& b) {
    if (!a.matrix().allFinite() || !b.matrix().allFinite()) {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        return {nan, nan};
    }
    return {distance_mm(a, b), deg_from_rad(angle_rad(a, b))};
}

Text text_of(const Pose& pose) {
    const Eigen::Vector3d t = pose.translation(), w = rotation_log(pose.linear());
    return Text("({:.4f}, {:.4f}, {:.4f}) mm, turned {:.5f} degrees", t.x(), t.y(), t.z(),
                deg_from_rad(w.norm()));
}

// Writes the frame of before and makes sure that it stands there.
std::pair<PushStatus, Text> put_back(const Pose& before, const std::string& name, RobotLink& robot) {
    if (auto written = robot.write_frame(name, before); !written)
        return {PushStatus::not_restored,
                Text("the old frame could not be restored: {}", written.error().text())};
    const Expected<Pose> back = robot.read_frame(name);
    if (!back)
        return {PushStatus::not_restored,
                Text("the old frame was written but cannot be read back: {}", back.error().text())};
    if (!distance(*back, before).equal())
        return {PushStatus::not_restored, "the old frame was written but does not read back"};
    return {PushStatus::restored, "the old frame is restored"};
}

}  // namespace

PushRecord push_region(GatePass&& given, RobotLink& robot, const EventSink& record) {
    const GatePass pass(std::move(given));  // spends the caller's
    PushRecord push;
    push.frame_name = pass.frame_name();
    const Pose& target = pass.base_from_frame();
    const auto give_up = [&](PushStatus status, EventKind kind, Text message) {
        push.status = status;
        push.message = std::move(message);
        // The outcome is in the returned record in any case; the log is the second place.
        if (auto logged = record(kind, pass.frame_name(), push.message); !logged)
            push.message =
                Text("{}; the event could not be recorded: {}", push.message, logged.error().text());
        return push;
    };
    if (pass.spent())
        return give_up(PushStatus::failed, EventKind::refusal, "this pass of the gate was used before");

    const Expected<Pose> before = robot.read_frame(pass.frame_name());
    if (!before)
        return give_up(PushStatus::failed, EventKind::device,
                       Text("the old frame cannot be read: {}", before.error().text()));
    if (!pose_from_matrix(before->matrix(), "", kRigid))
        return give_up(PushStatus::failed, EventKind::device,
                       "the robot answered an old frame that is no rigid pose");
    push.before = *before;
    if (!pass.base_from_frame_now())
        return give_up(PushStatus::failed, EventKind::refusal,
                       "the pass was given without the frame that the controller holds");
    if (const FrameDistance moved = distance(*before, *pass.base_from_frame_now()); !moved.equal())
        return give_up(PushStatus::failed, EventKind::refusal,
                       Text("somebody changed the frame on the controller by {:.4f} mm and {:.5f} "
                            "degrees since it was judged",
                            moved.mm, moved.deg));
    if (auto logged =
            record(EventKind::push_attempt, pass.frame_name(),
                   Text("region {}: from {} to {}", pass.region_id(), text_of(*before), text_of(target)));
        !logged) {
        push.status = PushStatus::failed;
        push.message = Text("the attempt cannot be recorded, so nothing was sent: {}", logged.error().text());
        return push;
    }

    Text trouble;
    if (auto written = robot.write_frame(pass.frame_name(), target); !written) {
        trouble = Text("writing failed: {}", written.error().text());
    } else if (const Expected<Pose> back = robot.read_frame(pass.frame_name()); !back) {
        trouble = Text("reading back failed: {}", back.error().text());
    } else {
        push.read_back = *back;
        const FrameDistance off = distance(*back, target);
        if (!off.equal()) {
            trouble =
                Text("the robot holds another frame than was written (off by {:.4f} mm, {:.5f} degrees)",
                     off.mm, off.deg);
        } else {
            push.message = Text("region {}: frame written and read back", pass.region_id());
            auto logged = record(EventKind::push, pass.frame_name(), push.message);
            if (logged) {
                push.status = PushStatus::written;
                return push;
            }
            trouble = Text("the push cannot be recorded: {}", logged.error().text());
        }
    }

    // What the controller holds is not known any more: the old frame goes back.
    const auto [status, outcome] = put_back(*before, pass.frame_name(), robot);
    return give_up(status, EventKind::alarm, joined(trouble, "; ", outcome));
}

FrameLook look_at_frame(const PushRecord& push, RobotLink& robot) {
    assert(push.status == PushStatus::written && push.read_back);
    const Expected<Pose> now = robot.read_frame(push.frame_name);
    if (!now)
        return {FrameStands::unread,
                Text("frame {} cannot be read: {}", push.frame_name, now.error().text())};
    const FrameDistance off = distance(*now, *push.read_back);
    if (off.equal()) return {FrameStands::yes, {}};
    return {
        FrameStands::differs,
        Text("frame {} on the controller is not the one that was written (off by {:.4f} mm, {:.5f} degrees)",
             push.frame_name, off.mm, off.deg)};
}

void withdraw_push(PushRecord& push, RobotLink& robot, const EventSink& record, EventKind kind) {
    assert(push.status == PushStatus::written && push.before);
    const auto [status, outcome] = put_back(*push.before, push.frame_name, robot);
    push.status = status;
    push.message = Text("withdrawn: {}", outcome);
    if (status == PushStatus::not_restored) kind = EventKind::alarm;
    if (auto logged = record(kind, push.frame_name, push.message); !logged)
        push.message = Text("{}; the event could not be recorded: {}", push.message, logged.error().text());
}

}  // namespace seamwright
