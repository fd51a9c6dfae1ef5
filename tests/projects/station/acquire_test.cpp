// Which frame belongs to which trigger.

#include "projects/station/acquire.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <random>

#include "devices/robot_program.h"
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

// One pulse too many, noticed by nobody before: the last trigger's own frame comes when the pass is over.
TEST_F(WiredSensor, AFrameStillOnItsWayAtTheEndIsWaitedFor) {
    constexpr int kLatencyMs = 60;
    for (std::uint64_t k = 1; k < 4; ++k) arrives(k, 1e-3 * kLatencyMs);
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(at("S"));
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_CALL(sensor, wait_next).WillOnce([&](std::chrono::milliseconds most) -> Expected<FramePtr> {
        EXPECT_LE(most, std::chrono::milliseconds(kLatencyMs + 150)) << "of every part's time";
        if (most < std::chrono::milliseconds(kLatencyMs)) return device_error(ErrorCode::silence, kNoAnswer);
        arrives(4);
        return frames.back();
    });
    EXPECT_FALSE(paired.finish());
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(1));
}

// Twelve spots, the robot's word up to 60 ms late, the sensor's clock of another beginning, its frames up to `late_ms`
// late on the way. Answers the spot at which the run fails, 0 for none.
class WiredPass : public WiredSensor {
  protected:
    int fails_at(std::mt19937& random, double late_ms, int extra_before, bool scaled_clock = false) {
        TriggeredFrames fresh(sensor, setup);
        frames.clear();
        std::uniform_real_distribution<double> word(0, 60), way(20, 20 + late_ms), travel(500, 1500);
        std::vector<double> triggers;
        for (double t = 0; triggers.size() < 12; t += travel(random)) triggers.push_back(t);
        std::vector<double> exposed = triggers;
        if (extra_before > 0)
            exposed.insert(exposed.begin() + extra_before,
                           triggers[static_cast<std::size_t>(extra_before) - 1] + 30);
        const std::int64_t begin = now_ns();
        const auto ns = [](double ms) { return static_cast<std::int64_t>(1e6 * ms); };
        for (std::size_t k = 0; k < triggers.size(); ++k) {
            auto frame = std::make_shared<Frame>();
            frame->sequence = k;
            frame->host_time_ns = begin + ns(exposed[k] + way(random));
            frame->device_time_ns = ns(5e6 + exposed[k]) / (scaled_clock ? 8 : 1);
            frames.push_back(frame);
            const TriggerEvent event{"S", begin + ns(triggers[k] + word(random)), std::nullopt};
            if (!fresh.at(event, kSoon, {}, nullptr)) return static_cast<int>(k) + 1;
        }
        return 0;
    }
};

TEST_F(WiredPass, AnExtraPulseShowsInTheTimes) {
    std::mt19937 random(7);
    int seen = 0;
    for (int run = 0; run < 200; ++run) seen += fails_at(random, 30, 1 + run % 9) > 0;
    EXPECT_GE(seen, 198);
}

// As many frames as triggers: one pulse was missed, another came twice. Spots 0.3 s apart, three to twelve of them.
TEST_F(WiredPass, AMissedAndADoubledPulseShowInTheTimes) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> word(0, 40), way(20, 50), travel(250, 400), stall(0, 1);
    const auto ns = [](double ms) { return static_cast<std::int64_t>(1e6 * ms); };
    int seen = 0, honest_failed = 0;
    for (int run = 0; run < 600; ++run) {
        const int n = 3 + run % 10, missed = run % n, doubled = (missed + 1 + run / 10 % (n - 1)) % n;
        const bool honest = run >= 300, stalls = honest && run % 2 == 0;
        std::vector<double> triggers, exposed;
        double t = 0;
        for (int k = 0; k < n; ++k, t += travel(random)) triggers.push_back(t);
        for (int k = 0; k < n; ++k) {
            if (!honest && k == missed) continue;
            exposed.push_back(triggers[static_cast<std::size_t>(k)]);
            if (!honest && k == doubled) exposed.push_back(exposed.back() + 20);
        }
        const double stalls_from = stall(random) * t, held_up = 300;
        TriggeredFrames fresh(sensor, setup);
        frames.clear();
        const std::int64_t begin = now_ns() - ns(t + 1000);
        bool failed = false;
        for (std::size_t k = 0; k < triggers.size(); ++k) {
            auto frame = std::make_shared<Frame>();
            frame->sequence = k;
            frame->host_time_ns = begin + ns(exposed[k] + way(random));
            frame->device_time_ns = ns(5e6 + exposed[k]);
            frames.push_back(frame);
            double heard = triggers[k] + word(random);
            if (stalls && triggers[k] > stalls_from && heard < stalls_from + held_up)
                heard = stalls_from + held_up;
            failed = failed || !fresh.at({"S", begin + ns(heard), std::nullopt}, kSoon, {}, nullptr);
        }
        failed = failed || !fresh.finish();
        (honest ? honest_failed : seen) += failed;
    }
    EXPECT_GE(seen, 285) << "of 300";
    EXPECT_LE(honest_failed, 3) << "of 300, half of them with a robot's words held up";
}

TEST_F(WiredPass, HonestTimesFailNoRun) {
    std::mt19937 random(8);
    int failed = 0;
    for (int run = 0; run < 200; ++run)
        failed += (fails_at(random, 30, 0) > 0) + (fails_at(random, 900, 0) > 0) +  // a busy machine
                  (fails_at(random, 30, 0, true) > 0);                              // ticks that are no ns
    EXPECT_EQ(failed, 0);
}

TEST(FiredNear, APoseThatCannotBeTheSpotFailsTheRun) {
    const Spot spot = sample_project().spots.at(0);
    const auto fired = [&](const Pose& base_from_flange) {
        return fired_near({spot.id, 1, base_from_flange}, spot);
    };
    const auto moved = [&](double mm, double deg) {
        Pose p = spot.base_from_flange;
        p.translation().y() += mm;
        p.rotate(Eigen::AngleAxisd(rad_from_deg(deg), Eigen::Vector3d::UnitX()));
        return p;
    };
    EXPECT_TRUE(fired_near({spot.id, 1, std::nullopt}, spot));
    EXPECT_TRUE(fired(moved(0, 0)));
    EXPECT_TRUE(fired(moved(-299, 29)));
    EXPECT_FALSE(fired(moved(301, 0)));
    EXPECT_FALSE(fired(moved(0, -31)));
    const auto zero = fired(moved(1000, 0));
    ASSERT_FALSE(zero);
    EXPECT_THAT(zero.error().sentence(), HasSubstr("robot " + spot.robot_id));
    EXPECT_THAT(zero.error().sentence(), HasSubstr("1000 mm"));
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

// A robot whose answer is not that of its own move stands elsewhere.
TEST(StandAt, BelievesNoAnswerThatTheFlangeContradicts) {
    struct Mover : NiceMock<MockRobot> {
        Expected<void> move_to(const Pose&) override { return moved; }
        Expected<void> moved;
    };
    const Pose sent = make_pose(rotation_exp({0.3, 0.1, 2}), {800, 100, 600});
    const auto off = [&](double mm, double deg) {
        Pose p = sent;
        p.translation().z() += mm;
        p.rotate(Eigen::AngleAxisd(rad_from_deg(deg), Eigen::Vector3d::UnitX()));
        return p;
    };
    const auto stands = [&](const std::vector<Pose>& reads, Expected<void> moved = {}) {
        Mover robot;
        robot.moved = std::move(moved);
        std::size_t n = 0;
        ON_CALL(robot, base_from_flange).WillByDefault([&]() -> Expected<Pose> {
            return reads[std::min(n++, reads.size() - 1)];
        });
        return stand_at(robot, "S1", sent);
    };
    EXPECT_TRUE(stands({off(0, 0)}));
    EXPECT_TRUE(stands({off(0.4, 0.08)}));
    EXPECT_TRUE(stands({off(3, 0), off(0.01, 0)})) << "it was settling";
    for (const Pose& elsewhere : {off(0.6, 0), off(0, 0.2), off(200, 0)}) {
        const auto at = stands({elsewhere});
        ASSERT_FALSE(at);
        EXPECT_THAT(at.error().sentence(), HasSubstr("off the pose that it was sent to"));
        EXPECT_THAT(at.error().sentence(), HasSubstr("spot S1"));
    }
    const auto by_hand = stands({off(5, 0)}, device_error("this robot cannot be moved from the program"));
    ASSERT_FALSE(by_hand);
    EXPECT_THAT(by_hand.error().sentence(), HasSubstr("5.00 mm"));
    EXPECT_THAT(by_hand.error().sentence(), HasSubstr("cannot be moved from the program"));
    EXPECT_THAT(by_hand.error().sentence(), HasSubstr("jog it there"));
}

TEST(MeasuringProgram, DisabledSpotsShiftNoNumberOfARegion) {
    Project p;
    for (const char* id : {"S1", "S2", "S3", "S4"}) {
        Spot spot;
        spot.id = id;
        spot.robot_id = id == std::string("S2") ? "R2" : "R1";
        p.spots.push_back(spot);
        Region region;
        region.id = std::string("of ") + id;
        region.frame_name = std::string("BASE_") + id;
        region.spot_ids = {id};
        p.regions.push_back(region);
    }
    const auto frames = [&] {
        std::vector<NumberedFrame> all;
        for (const MeasuringMove& move : measuring_program(p, "R1"))
            all.insert(all.end(), move.frames.begin(), move.frames.end());
        return all;
    };
    EXPECT_EQ(frames(), (std::vector<NumberedFrame>{{1, "BASE_S1"}, {2, "BASE_S3"}, {3, "BASE_S4"}}));
    EXPECT_EQ(region_number(p, "of S2", "R2"), 1);
    EXPECT_EQ(region_number(p, "of S2", "R1"), 0);
    p.spots[0].enabled = false;
    EXPECT_EQ(frames(), (std::vector<NumberedFrame>{{2, "BASE_S3"}, {3, "BASE_S4"}}));
    const std::string signature = program_signature(measuring_program(p, "R1"));
    std::swap(p.regions[2], p.regions[3]);
    EXPECT_NE(program_signature(measuring_program(p, "R1")), signature) << "other numbers";
    std::swap(p.regions[2], p.regions[3]);
    EXPECT_EQ(program_signature(measuring_program(p, "R1")), signature);
    p.regions.erase(p.regions.begin());
    EXPECT_NE(program_signature(measuring_program(p, "R1")), signature) << "removed";
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
