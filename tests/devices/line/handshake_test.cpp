// Start, busy, done: every way that a PLC goes, with a clock of the test's own.

#include "devices/line/handshake.h"

#include <gtest/gtest.h>

namespace seamwright {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class Line : public testing::Test {
  protected:
    Line() { restart({.line_starts = true}); }
    void restart(const HandshakeOptions& options) {
        handshake.emplace(options);
        state.ready = true;
        state.alarm = LineAlarm::none;
    }
    void start(bool on, std::uint32_t number = 815) { handshake->hear({++beat, on, {1, number, ""}}, now); }
    void ends(LineResult result) {
        ++state.results;
        state.result = result;
    }
    bool taken() { return handshake->take(state, now).has_value(); }
    // "rbd": ready, busy, done
    std::string bits() {
        const HandshakeBits b = handshake->bits(state, now);
        return std::string(b.ready ? "r" : "-") + (b.busy ? "b" : "-") + (b.done ? "d" : "-");
    }
    LineAlarm alarm() { return handshake->bits(state, now).alarm; }

    std::optional<Handshake> handshake;
    LineState state;
    std::uint16_t beat = 0;
    Handshake::Time now{};
};

TEST_F(Line, OnePartAfterAnother) {
    start(false);
    for (int part = 0; part < 3; ++part) {
        EXPECT_EQ(bits(), "r--");
        EXPECT_FALSE(taken());
        start(true, 100 + static_cast<std::uint32_t>(part));
        const auto call = handshake->take(state, now);
        ASSERT_TRUE(call);
        EXPECT_EQ(call->part.number, 100u + static_cast<std::uint32_t>(part));
        EXPECT_EQ(bits(), "-b-");
        start(true);
        EXPECT_FALSE(taken()) << "one edge, one part";
        ends(LineResult::corrected);
        EXPECT_EQ(bits(), "--d");
        start(true);
        EXPECT_FALSE(taken());
        start(false);
    }
}

// A program that was killed in a part comes back while the PLC still holds its start.
TEST_F(Line, AStartThatWasThereBeforeStartsNothing) {
    start(true);
    EXPECT_FALSE(taken());
    EXPECT_EQ(bits(), "---");
    start(false);
    EXPECT_EQ(bits(), "r--");
    start(true);
    EXPECT_TRUE(taken());
    restart({.line_starts = true});
    start(false);
    handshake->lost();
    EXPECT_EQ(bits(), "---");
    start(true);
    EXPECT_FALSE(taken()) << "nobody knows when it rose";
}

TEST_F(Line, ACallIsWithdrawnBeforeItIsTaken) {
    start(false);
    start(true);
    start(false);
    EXPECT_FALSE(taken());
    EXPECT_EQ(bits(), "r--");
    start(true);
    handshake->lost();
    EXPECT_FALSE(taken());
}

TEST_F(Line, AStartThatGoesEarlyGivesThePartUpAndItsResultStays) {
    start(false);
    start(true);
    ASSERT_TRUE(taken());
    EXPECT_FALSE(handshake->given_up());
    handshake->lost();
    EXPECT_FALSE(handshake->given_up()) << "an outage gives nothing up";
    start(false);
    EXPECT_TRUE(handshake->given_up());
    EXPECT_EQ(bits(), "-b-");
    ends(LineResult::not_taken);
    EXPECT_EQ(bits(), "r-d") << "a line that waits for ready comes to it";
    start(false);
    EXPECT_EQ(bits(), "r-d") << "the line had no chance to see it";
    start(true);
    EXPECT_TRUE(taken());
    EXPECT_FALSE(handshake->given_up());
    EXPECT_EQ(bits(), "-b-");
}

TEST_F(Line, APartThatEndsInAnOutageIsAnsweredAfterIt) {
    for (const bool dropped : {false, true}) {
        restart({.line_starts = true});
        start(false);
        start(true);
        ASSERT_TRUE(taken());
        handshake->lost();
        ends(LineResult::corrected);
        EXPECT_EQ(bits(), "--d");
        start(!dropped);
        EXPECT_EQ(bits(), dropped ? "r-d" : "--d");
        if (!dropped) {
            start(false);
            EXPECT_EQ(bits(), "r--");
        }
        start(true);
        EXPECT_TRUE(taken());
    }
}

// The answer had been seen: start 0 is the last step, whenever it is heard.
TEST_F(Line, AStartThatGoesInAnOutageAfterDoneEndsThePart) {
    start(false);
    start(true);
    ASSERT_TRUE(taken());
    ends(LineResult::corrected);
    EXPECT_EQ(bits(), "--d");
    handshake->lost();
    start(false);
    EXPECT_EQ(bits(), "r--");
}

// The PLC has gone on to the next part in the outage: what is done is not that one.
TEST_F(Line, ACallForAnotherPartInAnOutageIsNotAnsweredByTheFormersResult) {
    const auto refused = [&] {
        const HandshakeBits b = handshake->bits(state, now);
        return b.done && b.result == LineResult::not_measured && b.alarm == LineAlarm::call_not_followed;
    };
    for (const bool ends_in_outage : {true, false}) {
        for (const bool told_before : {false, true}) {
            restart({.line_starts = true});
            start(false);
            start(true, 815);
            ASSERT_TRUE(taken());
            if (told_before) {
                ends(LineResult::corrected);
                EXPECT_EQ(bits(), "--d");
            }
            handshake->lost();
            if (!told_before && ends_in_outage) {
                ends(LineResult::corrected);
                (void)bits();
            }
            start(true, 816);
            EXPECT_FALSE(taken()) << "nobody knows when it rose";
            if (!told_before && !ends_in_outage) {
                EXPECT_EQ(bits(), "-b-");
                EXPECT_TRUE(handshake->given_up()) << "nobody waits for 815";
                ends(LineResult::corrected);
            }
            EXPECT_TRUE(refused()) << ends_in_outage << told_before;
            start(false);
            EXPECT_EQ(bits(), "r--");
            start(true, 816);
            EXPECT_TRUE(taken());
        }
    }
    // The same part is still the one that was called for.
    ends(LineResult::corrected);
    handshake->lost();
    start(true, 816);
    EXPECT_EQ(bits(), "--d");
    EXPECT_EQ(handshake->bits(state, now).result, LineResult::corrected);
}

TEST_F(Line, ACallThatNobodyFollowsIsAnswered) {
    state.ready = false;
    start(false);
    start(true);
    now += seconds(5);
    EXPECT_EQ(bits(), "---");
    now += milliseconds(1);
    EXPECT_EQ(bits(), "--d");
    const HandshakeBits b = handshake->bits(state, now);
    EXPECT_EQ(b.result, LineResult::not_measured);
    EXPECT_EQ(b.alarm, LineAlarm::call_not_followed);
    EXPECT_FALSE(taken()) << "too late";
    start(false);
    EXPECT_EQ(bits(), "---");
    EXPECT_EQ(alarm(), LineAlarm::none);
}

TEST_F(Line, AStartThatStaysIsAnAlarmAndStartsNothing) {
    start(false);
    start(true);
    ASSERT_TRUE(taken());
    ends(LineResult::corrected);
    EXPECT_EQ(bits(), "--d");
    now += seconds(11);
    start(true);
    EXPECT_EQ(alarm(), LineAlarm::start_not_dropped);
    EXPECT_EQ(handshake->bits(state, now).result, LineResult::corrected) << "the result is none the worse";
    EXPECT_FALSE(taken());
    start(false);
    EXPECT_EQ(alarm(), LineAlarm::none);
}

TEST_F(Line, ALineThatStandsStillStartsNothing) {
    restart({.line_starts = true, .heartbeat_timeout = seconds(1)});
    start(false);
    start(true);
    now += milliseconds(1001);
    EXPECT_EQ(alarm(), LineAlarm::line_silent);
    EXPECT_FALSE(taken()) << "the call of a PLC that stands";
    --beat;  // the same beat again
    start(true);
    EXPECT_EQ(alarm(), LineAlarm::line_silent);
    start(true);
    EXPECT_EQ(alarm(), LineAlarm::none);
    EXPECT_FALSE(taken()) << "start has to be seen at 0";
    start(false);
    start(true);
    EXPECT_TRUE(taken());
}

TEST_F(Line, WhereTheRobotStartsBusyAndDoneFollowTheStation) {
    restart({.line_starts = false});
    start(true);
    EXPECT_FALSE(taken());
    EXPECT_EQ(bits(), "r--");
    state.busy = true;
    state.ready = false;
    EXPECT_EQ(bits(), "-b-");
    state.busy = false;
    state.ready = true;
    ends(LineResult::refused);
    EXPECT_EQ(bits(), "r-d");
    EXPECT_EQ(handshake->part().number, 815u);
}

}  // namespace
}  // namespace seamwright
