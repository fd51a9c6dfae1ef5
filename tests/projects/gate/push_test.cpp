// What is written to the robot, read back, recorded and taken back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/gate/push.h"
#include "tests/projects/gate/gate_request.h"
#include "tests/projects/mock_devices.h"

namespace seamwright {
namespace {

using testing::_;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::InSequence;
using testing::Return;

struct Logged {
    EventKind kind;
    std::string subject;
    Text text;
};

class Push : public testing::Test {
  protected:
    PushRecord push() {
        GateVerdict verdict = pass_gate(request);
        return push_region(
            std::move(*verdict.pass), robot,
            [this](EventKind kind, const std::string& subject, const Text& text) -> Expected<void> {
                if (log_broken) return file_error("the disk is full");
                log.push_back({kind, subject, text});
                return {};
            });
    }
    std::vector<EventKind> kinds() const {
        std::vector<EventKind> list;
        for (const Logged& entry : log) list.push_back(entry.kind);
        return list;
    }
    // A controller that stores frames, with a fault switched in by the test.
    void store_frames(std::function<Expected<void>(int write, const Pose&)> on_write) {
        ON_CALL(robot, read_frame(_)).WillByDefault([this](const std::string&) -> Expected<Pose> {
            return frame;
        });
        ON_CALL(robot, write_frame(_, _))
            .WillByDefault([this, on_write](const std::string&, const Pose& pose) {
                ++writes;
                return on_write(writes, pose);
            });
    }
    // The controller holds the last part's frame.
    static GateRequest request_with(const Pose& now) {
        GateRequest request = good_request();
        request.base_from_frame_now = now;
        return request;
    }
    Pose old_frame = some_pose(1) * make_pose(rotation_exp({0.001, 0, 0.002}), {1, -2, 0.5}),
         frame = old_frame;
    GateRequest request = request_with(old_frame);
    Pose target = corrected_frame(request.base_from_workobject, request.correction.displacement,
                                  request.region.base_from_frame);
    testing::NiceMock<MockRobot> robot;
    std::vector<Logged> log;
    bool log_broken = false;
    int writes = 0;
};

Pose shifted(const Pose& pose, double mm, double deg = 0) {
    Vector6 d = Vector6::Zero();
    d[1] = mm;
    d[5] = rad_from_deg(deg);
    return retract(pose, d);
}

TEST_F(Push, WritesReadsBackAndRecords) {
    store_frames([this](int, const Pose& pose) -> Expected<void> {
        frame = shifted(pose, 5e-4, 5e-5);  // the controller's last digit
        return {};
    });
    const PushRecord record = push();
    EXPECT_EQ(record.status, PushStatus::written) << record.message;
    EXPECT_LT(distance_mm(frame, target), 1e-3);
    EXPECT_TRUE(record.before->isApprox(old_frame));
    EXPECT_TRUE(record.read_back.has_value());
    EXPECT_EQ(record.frame_name, "BASE[3]");
    EXPECT_EQ(writes, 1);
    EXPECT_THAT(kinds(), ElementsAre(EventKind::push_attempt, EventKind::push));
}

TEST_F(Push, MismatchIsAnAlarmAndRestores) {
    for (const auto& off : {std::pair(2e-3, 0.0), std::pair(0.0, 2e-4), std::pair(100.0, 0.0)}) {
        frame = old_frame;
        log.clear();
        writes = 0;
        store_frames([this, off](int n, const Pose& pose) -> Expected<void> {
            frame = n == 1 ? shifted(pose, off.first, off.second) : pose;
            return {};
        });
        const PushRecord record = push();
        EXPECT_EQ(record.status, PushStatus::restored);
        EXPECT_TRUE(frame.isApprox(old_frame));
        EXPECT_THAT(record.message, HasSubstr("another frame"));
        EXPECT_THAT(kinds(), ElementsAre(EventKind::push_attempt, EventKind::alarm));
    }
}

TEST_F(Push, ControllerThatIgnoresWritesIsFound) {
    store_frames([](int, const Pose&) -> Expected<void> { return {}; });
    const PushRecord record = push();
    EXPECT_EQ(record.status, PushStatus::restored);
    EXPECT_THAT(kinds(), ElementsAre(EventKind::push_attempt, EventKind::alarm));
}

TEST_F(Push, WriteErrorRestores) {
    store_frames([this](int n, const Pose& pose) -> Expected<void> {
        if (n == 1) {
            frame = shifted(pose, 3);  // half of the frame had arrived
            return device_error("connection reset");
        }
        frame = pose;
        return {};
    });
    const PushRecord record = push();
    EXPECT_EQ(record.status, PushStatus::restored);
    EXPECT_TRUE(frame.isApprox(old_frame));
    EXPECT_THAT(record.message, HasSubstr("connection reset"));
}

TEST_F(Push, RestoreThatFailsIsSaid) {
    store_frames([this](int n, const Pose& pose) -> Expected<void> {
        if (n > 1) return device_error("silent");
        frame = shifted(pose, 1);
        return {};
    });
    PushRecord record = push();
    EXPECT_EQ(record.status, PushStatus::not_restored);
    EXPECT_THAT(record.message, HasSubstr("could not be restored"));
    EXPECT_THAT(kinds(), ElementsAre(EventKind::push_attempt, EventKind::alarm));

    log.clear();
    frame = old_frame;
    writes = 0;
    store_frames([this](int, const Pose& pose) -> Expected<void> {
        frame = shifted(pose, 1);  // always wrong
        return {};
    });
    record = push();
    EXPECT_EQ(record.status, PushStatus::not_restored);
    EXPECT_THAT(record.message, HasSubstr("does not read back"));
}

TEST_F(Push, ReadBackErrorRestores) {
    InSequence in_order;
    EXPECT_CALL(robot, read_frame("BASE[3]")).WillOnce(Return(old_frame));
    EXPECT_CALL(robot, write_frame("BASE[3]", _)).WillOnce(Return(Expected<void>{}));
    EXPECT_CALL(robot, read_frame("BASE[3]")).WillOnce(Return(Expected<Pose>(device_error("silent"))));
    EXPECT_CALL(robot, write_frame("BASE[3]",
                                   testing::Truly([this](const Pose& p) { return p.isApprox(old_frame); })))
        .WillOnce(Return(Expected<void>{}));
    EXPECT_CALL(robot, read_frame("BASE[3]")).WillOnce(Return(old_frame));
    EXPECT_EQ(push().status, PushStatus::restored);
}

TEST_F(Push, NanReadBackIsAMismatch) {
    Pose nan = target;
    nan(0, 3) = kNan;
    EXPECT_CALL(robot, read_frame(_)).WillOnce(Return(old_frame)).WillOnce(Return(nan)).WillOnce(Return(nan));
    EXPECT_CALL(robot, write_frame(_, _)).Times(2).WillRepeatedly(Return(Expected<void>{}));
    EXPECT_EQ(push().status, PushStatus::not_restored);
}

TEST_F(Push, NothingIsSentWithoutTheOldFrame) {
    EXPECT_CALL(robot, write_frame(_, _)).Times(0);
    EXPECT_CALL(robot, read_frame(_)).WillOnce(Return(Expected<Pose>(device_error("silent"))));
    EXPECT_EQ(push().status, PushStatus::failed);
    EXPECT_THAT(kinds(), ElementsAre(EventKind::device));
    Pose nan = old_frame;
    nan(1, 1) = kNan;
    EXPECT_CALL(robot, read_frame(_)).WillOnce(Return(nan));
    EXPECT_EQ(push().status, PushStatus::failed);
}

TEST_F(Push, NothingIsSentUnrecorded) {
    log_broken = true;
    EXPECT_CALL(robot, read_frame(_)).WillRepeatedly(Return(old_frame));
    EXPECT_CALL(robot, write_frame(_, _)).Times(0);
    const PushRecord record = push();
    EXPECT_EQ(record.status, PushStatus::failed);
    EXPECT_THAT(record.message, HasSubstr("disk is full"));
}

// What is not in the log did not happen: the frame goes back, nobody may run in it.
TEST_F(Push, APushThatCannotBeRecordedIsTakenBack) {
    store_frames([this](int, const Pose& pose) -> Expected<void> {
        frame = pose;
        log_broken = true;
        return {};
    });
    const PushRecord record = push();
    EXPECT_EQ(record.status, PushStatus::restored);
    EXPECT_TRUE(frame.isApprox(old_frame));
    EXPECT_THAT(record.message, HasSubstr("the push cannot be recorded"));
}

TEST_F(Push, AFrameThatWasChangedSinceItWasJudgedIsLeft) {
    store_frames([](int, const Pose&) -> Expected<void> { return {}; });
    frame = shifted(old_frame, 0.1);
    EXPECT_THAT(push().message, HasSubstr("somebody changed the frame"));
    EXPECT_EQ(writes, 0);
}

TEST_F(Push, APassOfADryRunWritesNothing) {
    store_frames([](int, const Pose&) -> Expected<void> { return {}; });
    request.base_from_frame_now.reset();
    EXPECT_EQ(push().status, PushStatus::failed);
    EXPECT_EQ(writes, 0);
}

TEST_F(Push, WithdrawPutsTheOldFrameBack) {
    store_frames([this](int, const Pose& pose) -> Expected<void> {
        frame = pose;
        return {};
    });
    PushRecord record = push();
    ASSERT_EQ(record.status, PushStatus::written);
    withdraw_push(record, robot,
                  [this](EventKind kind, const std::string& subject, const Text& text) -> Expected<void> {
                      log.push_back({kind, subject, text});
                      return {};
                  });
    EXPECT_EQ(record.status, PushStatus::restored);
    EXPECT_TRUE(frame.isApprox(old_frame));
    EXPECT_THAT(kinds(), ElementsAre(EventKind::push_attempt, EventKind::push, EventKind::alarm));
}

TEST_F(Push, APassIsGoodForOnePush) {
    store_frames([this](int, const Pose& pose) -> Expected<void> {
        frame = pose;
        return {};
    });
    GateVerdict verdict = pass_gate(request);
    const EventSink sink = [](EventKind, const std::string&, const Text&) -> Expected<void> { return {}; };
    EXPECT_EQ(push_region(std::move(*verdict.pass), robot, sink).status, PushStatus::written);
    EXPECT_TRUE(verdict.pass->spent());
    EXPECT_EQ(push_region(std::move(*verdict.pass), robot, sink).status, PushStatus::failed);
    EXPECT_EQ(writes, 1);
}

}  // namespace
}  // namespace seamwright
