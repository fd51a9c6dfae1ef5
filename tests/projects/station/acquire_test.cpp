// Which frame belongs to which trigger.

#include "projects/station/acquire.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "devices/silence.h"
#include "projects/measure/measure.h"
#include "tests/projects/mock_devices.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using testing::NiceMock;
using testing::Return;
constexpr std::chrono::milliseconds kSoon{300};

std::int64_t now_ns() {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

class WiredSensor : public testing::Test {
  protected:
    void SetUp() override {
        setup.id = "A";
        setup.settings = {{"hardware_trigger", true}};
        ON_CALL(sensor, wait_next).WillByDefault([this](std::chrono::milliseconds) -> Expected<FramePtr> {
            if (frames.empty()) return device_error(ErrorCode::silence, kNoAnswer);
            FramePtr frame = frames.front();
            frames.pop_front();
            return frame;
        });
        EXPECT_CALL(sensor, trigger).Times(0);
    }
    void arrives(std::uint64_t sequence, double late_s = 0, FrameStatus status = FrameStatus::ok) {
        auto frame = std::make_shared<Frame>();
        frame->sequence = sequence;
        frame->status = status;
        frame->host_time_ns = now_ns() + static_cast<std::int64_t>(late_s * 1e9);
        frames.push_back(frame);
    }
    Expected<FramePtr> at(const std::string& spot) {
        return paired.at({spot, now_ns(), std::nullopt}, kSoon, {}, nullptr);
    }
    NiceMock<MockSensor> sensor;
    SensorSetup setup;
    std::deque<FramePtr> frames;
    TriggeredFrames paired{sensor, setup};
};

TEST_F(WiredSensor, TheKthTriggerHasTheKthFrame) {
    for (std::uint64_t k = 7; k < 10; ++k) arrives(k);
    for (std::uint64_t k = 7; k < 10; ++k) EXPECT_EQ((*at("S"))->sequence, k);
    EXPECT_TRUE(paired.finish());
}

TEST_F(WiredSensor, ALostFrameLeavesItsOwnSpotWithoutMeasurement) {
    for (std::uint64_t k : {1u, 4u, 5u}) arrives(k);
    EXPECT_EQ((*at("S1"))->status, FrameStatus::ok);
    EXPECT_EQ((*at("S2"))->status, FrameStatus::incomplete);
    EXPECT_EQ((*at("S3"))->status, FrameStatus::incomplete);
    for (std::uint64_t k : {4u, 5u}) {
        auto frame = at("S");
        EXPECT_EQ((*frame)->status, FrameStatus::ok);
        EXPECT_EQ((*frame)->sequence, k);
    }
    EXPECT_TRUE(paired.finish());
}

TEST_F(WiredSensor, ADamagedFrameKeepsItsPlace) {
    arrives(1);
    arrives(2, 0, FrameStatus::incomplete);
    arrives(3);
    EXPECT_EQ((*at("S1"))->status, FrameStatus::ok);
    EXPECT_EQ((*at("S2"))->status, FrameStatus::incomplete);
    EXPECT_EQ((*at("S3"))->sequence, 3u);
}

TEST_F(WiredSensor, AFrameAfterItsTurnIsPassedOver) {
    for (std::uint64_t k : {1u, 3u}) arrives(k);
    arrives(2, 0, FrameStatus::late);
    arrives(4);
    arrives(3, 0, FrameStatus::incomplete);
    EXPECT_EQ((*at("S1"))->sequence, 1u);
    EXPECT_EQ((*at("S2"))->status, FrameStatus::incomplete);
    EXPECT_EQ((*at("S3"))->sequence, 3u);
    EXPECT_EQ((*at("S4"))->sequence, 4u);
    EXPECT_TRUE(paired.finish()) << "a late frame is no further exposure";
}

TEST_F(WiredSensor, ATriggerWithoutExposureFailsTheRun) {
    arrives(1);
    arrives(2);
    EXPECT_TRUE(at("S1"));
    EXPECT_TRUE(at("S2"));  // the frame of S3, as nobody can tell
    const auto third = at("S3");
    ASSERT_FALSE(third);
    EXPECT_TRUE(is_silence(third.error()));
}

TEST_F(WiredSensor, AnExposureWithoutTriggerFailsTheRun) {
    for (std::uint64_t k = 1; k < 4; ++k) arrives(k);
    EXPECT_TRUE(at("S1"));
    EXPECT_TRUE(at("S2"));
    const auto complete = paired.finish();
    ASSERT_FALSE(complete);
    EXPECT_THAT(complete.error().sentence(), HasSubstr("more often than the robot fired"));
}

TEST_F(WiredSensor, AFrameFarFromItsTriggerFailsTheRun) {
    for (double late_s : {-2.0, 2.0}) {
        TriggeredFrames fresh(sensor, setup);
        arrives(1, late_s);
        const auto frame = fresh.at({"S1", now_ns(), std::nullopt}, kSoon, {}, nullptr);
        ASSERT_FALSE(frame);
        EXPECT_THAT(frame.error().sentence(),
                    HasSubstr(late_s < 0 ? "before the trigger" : "after the trigger"));
    }
}

TEST_F(WiredSensor, ASensorThatCountsBackwardsFailsTheRun) {
    arrives(5);
    arrives(1);
    EXPECT_TRUE(at("S1"));
    const auto frame = at("S2");
    ASSERT_FALSE(frame);
    EXPECT_THAT(frame.error().sentence(), HasSubstr("frame 1 came where frame 6 was due"));
}

TEST(Waiting, IsCancelledWithinASlice) {
    NiceMock<MockSensor> sensor;
    ON_CALL(sensor, wait_next).WillByDefault([](std::chrono::milliseconds slice) -> Expected<FramePtr> {
        EXPECT_LE(slice, kCancelSlice);
        return device_error(ErrorCode::silence, kNoAnswer);
    });
    std::stop_source stop;
    int waits = 0;
    ON_CALL(sensor, wait_next).WillByDefault([&](std::chrono::milliseconds) -> Expected<FramePtr> {
        if (++waits == 3) stop.request_stop();
        return device_error(ErrorCode::silence, kNoAnswer);
    });
    const auto frame = next_frame(sensor, std::chrono::hours(1), stop.get_token());
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().what, kCancelled);
    EXPECT_EQ(waits, 3);
}

TEST(Waiting, FailureIsNotWaitedOut) {
    NiceMock<MockRobot> robot;
    EXPECT_CALL(robot, wait_trigger).WillOnce([](std::chrono::milliseconds) -> Expected<TriggerEvent> {
        return device_error(ErrorCode::disconnected, kDisconnected);
    });
    const auto trigger = next_trigger(robot, std::chrono::hours(1), {});
    ASSERT_FALSE(trigger);
    EXPECT_TRUE(is_disconnect(trigger.error()));
}

TEST(MeasuringProgram, ViaPointsOfTheProjectGoBeforeTheEntry) {
    const Project project = sample_project();
    const auto moves = measuring_program(project, "R1");
    ASSERT_FALSE(moves.empty());
    int vias = 0;
    for (const MeasuringMove& move : moves) {
        const Spot& spot = *find_spot(project, move.spot_id);
        ASSERT_EQ(move.via.size(), spot.via.size());
        for (std::size_t i = 0; i < move.via.size(); ++i, ++vias)
            EXPECT_EQ(move.via[i].matrix(), spot.via[i].matrix());
    }
    EXPECT_GT(vias, 0);
}

}  // namespace
}  // namespace seamwright
