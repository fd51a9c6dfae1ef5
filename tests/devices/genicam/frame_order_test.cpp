#include "devices/genicam/frame_order.h"

#include <gtest/gtest.h>

namespace seamwright {
namespace {

using Verdict = TriggerPairing::Verdict;
constexpr std::int64_t kMs = 1'000'000;

TEST(FrameCounter, WrapsAndRestarts) {
    FrameCounter c;
    EXPECT_EQ(c.sequence(65533), 0U);
    EXPECT_EQ(c.sequence(65534), 1U);
    EXPECT_EQ(c.sequence(1), 3U);      // 65535 got lost; 0 is no number
    EXPECT_EQ(c.sequence(65535), 2U);  // late
    EXPECT_EQ(c.sequence(2), 4U);
    c.restart();
    EXPECT_EQ(c.sequence(1), 5U);
    EXPECT_EQ(c.sequence(70000), 5U + 69999);  // 64-bit numbers do not wrap
    EXPECT_EQ(c.sequence(70001), 5U + 70000);
    EXPECT_EQ(c.sequence(69999), 5U + 69998);
    FrameCounter zero;
    zero.sequence(65535);
    EXPECT_EQ(zero.sequence(0), 1U);
    EXPECT_EQ(zero.sequence(1), 2U);
}

TEST(FrameCounter, TheFirstNumberShowsWhatWasLostBeforeIt) {
    FrameCounter c;
    c.restart(true);
    EXPECT_EQ(c.sequence(3), 2U);
    EXPECT_EQ(c.lost_at_start(), 2U);
    EXPECT_EQ(c.sequence(4), 3U);
    c.restart(true);
    EXPECT_EQ(c.unnumbered(), 4U);
    EXPECT_EQ(c.sequence(1), 4U);
    EXPECT_EQ(c.lost_at_start(), 0U);
    c.restart(true);
    EXPECT_EQ(c.sequence(2), 6U) << "it has begun at 1 before: it does not count on";
    EXPECT_EQ(c.lost_at_start(), 1U);
    FrameCounter on;  // counts on from stream to stream
    on.restart(true);
    EXPECT_EQ(on.sequence(5000), 0U) << "long on its way";
    on.restart(true);
    EXPECT_EQ(on.sequence(5001), 1U);
    FrameCounter usb;
    usb.restart(false);
    EXPECT_EQ(usb.sequence(3), 0U);
    EXPECT_EQ(usb.lost_at_start(), 0U);
}

struct Camera {
    TriggerPairing pairing;
    std::int64_t time = 0;
    void trigger(const std::string& spot) {
        time += 10 * kMs;
        pairing.begin(spot, time);
        pairing.sent(time + kMs / 10);
    }
    // The device's clock is 5 s ahead; the frame was exposed with the trigger at `at`.
    TriggerPairing::Answer frame(std::uint64_t sequence, std::int64_t at) {
        return pairing.arrived(sequence, at + 5000 * kMs, time + kMs);
    }
};

TEST(TriggerPairing, AGapTakesItsTriggerAlong) {
    Camera c;
    c.trigger("a");
    EXPECT_FALSE(c.pairing.ready());  // nothing is known of the camera's numbers yet
    EXPECT_EQ(c.frame(0, 10 * kMs).spot_id, "a");
    EXPECT_TRUE(c.pairing.ready());
    c.trigger("b");
    c.trigger("c");
    c.trigger("d");
    EXPECT_EQ(c.frame(2, 30 * kMs).spot_id, "c");  // b's frame is lost
    EXPECT_EQ(c.frame(3, 40 * kMs).spot_id, "d");
    EXPECT_EQ(c.pairing.unanswered(), 1U);
    EXPECT_EQ(c.frame(1, 20 * kMs).verdict, Verdict::late);  // it comes after all: too late
}

TEST(TriggerPairing, ATriggerThatTheCameraIgnoredIsNotGivenTheNextFrame) {
    Camera c;
    c.trigger("a");
    c.frame(0, 10 * kMs);
    c.trigger("b");  // ignored by the camera: too soon
    c.trigger("c");
    // Number 1 would be b's by order, but its time is c's.
    const auto answer = c.frame(1, 30 * kMs);
    EXPECT_EQ(answer.verdict, Verdict::late);
    EXPECT_TRUE(answer.spot_id.empty());
    EXPECT_TRUE(c.pairing.lost_track());
    c.pairing.restart();
    c.trigger("d");
    EXPECT_EQ(c.frame(2, 40 * kMs).spot_id, "d");
}

TEST(TriggerPairing, AfterATimeOutNothingIsPairedUntilTheRestart) {
    Camera c;
    c.trigger("a");
    c.frame(0, 10 * kMs);
    c.trigger("b");
    EXPECT_TRUE(c.pairing.expire(20 * kMs).empty());
    EXPECT_EQ(c.pairing.expire(21 * kMs), std::vector<std::string>{"b"});
    EXPECT_FALSE(c.pairing.ready());
    EXPECT_EQ(c.frame(1, 20 * kMs).verdict, Verdict::late);
    c.pairing.restart();
    EXPECT_TRUE(c.pairing.ready());
    c.trigger("c");
    EXPECT_EQ(c.frame(0, 30 * kMs).spot_id, "c");
    // Frames that nobody triggered here are nobody's.
    EXPECT_EQ(c.frame(1, 35 * kMs).verdict, Verdict::unprompted);
    // More frames lost than triggers known.
    c.trigger("d");
    EXPECT_EQ(c.frame(5, 40 * kMs).verdict, Verdict::late);
}

TEST(TriggerPairing, DamagedFramesPairByNumberOnly) {
    Camera c;
    c.trigger("a");
    EXPECT_EQ(c.pairing.arrived(0, 0, c.time).spot_id, "a");
    c.trigger("b");
    EXPECT_EQ(c.pairing.arrived(1, 0, c.time).spot_id, "b");
    c.pairing.begin("refused", c.time);
    c.pairing.cancel();
    EXPECT_EQ(c.pairing.outstanding(), 0U);
}

}  // namespace
}  // namespace seamwright
