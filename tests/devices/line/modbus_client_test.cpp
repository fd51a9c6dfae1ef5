// The Modbus client before a PLC that is written here from the specification (Modbus Application Protocol V1.1b3), on
// sockets alone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <map>
#include <mutex>

#include "devices/line/line_link.h"
#include "devices/net/socket.h"
#include "tests/devices/line/wait.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

enum class Mood { sound, silent, half_answers, exceptions, nonsense };

class Plc {
  public:
    // `start`: held from the first look on.
    explicit Plc(std::uint16_t port = 0, bool start = false)
        : listener_(TcpListener::listen("127.0.0.1", port).value()) {
        if (start) words_[11] = 1;
        thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
    }
    std::uint16_t port() const { return listener_.port(); }
    std::uint16_t word(int address) {
        const std::lock_guard lock(mutex_);
        return words_[address];
    }
    void set(int address, std::uint16_t value) {
        const std::lock_guard lock(mutex_);
        words_[address] = value;
    }
    std::atomic<Mood> mood{Mood::sound};
    std::atomic<int> end = 65536;  // of its memory
    // Whether `done` (at 1004 of the test's table) was ever written before the region's words that belong to it.
    std::atomic<bool> too_early{false};

  private:
    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            auto c = listener_.accept(20ms);
            if (!c) continue;
            while (!stop.stop_requested() && one(*c)) {
            }
        }
    }
    static int at(const std::vector<std::uint8_t>& b, std::size_t i) { return b[i] << 8 | b[i + 1]; }

    bool one(TcpConnection& c) {
        std::vector<std::uint8_t> head(7);
        for (;;) {
            const auto n = c.receive_some(std::as_writable_bytes(std::span(head.data(), 1)), 20ms);
            if (n) break;
            if (!is_silence(n.error())) return false;
            if (thread_.get_stop_token().stop_requested()) return false;
        }
        if (!c.receive_exactly(std::as_writable_bytes(std::span(head).subspan(1)), 1s)) return false;
        std::vector<std::uint8_t> pdu(static_cast<std::size_t>(at(head, 4)) - 1);
        if (!c.receive_exactly(std::as_writable_bytes(std::span(pdu)), 1s)) return false;
        std::vector<std::uint8_t> answer = answer_to(pdu);
        std::vector<std::uint8_t> frame(head.begin(), head.begin() + 4);
        frame.push_back(0);
        frame.push_back(static_cast<std::uint8_t>(answer.size() + 1));
        frame.push_back(head[6]);
        frame.insert(frame.end(), answer.begin(), answer.end());
        switch (mood.load()) {
            case Mood::silent:
                return true;
            case Mood::half_answers:
                frame.resize(frame.size() / 2);
                break;
            case Mood::nonsense:
                for (auto& b : frame) b = static_cast<std::uint8_t>(b ^ 0x5a);
                break;
            default:
                break;
        }
        return c.send(std::as_bytes(std::span(frame)), 1s).has_value();
    }

    std::vector<std::uint8_t> answer_to(const std::vector<std::uint8_t>& pdu) {
        const auto refuse = [&](int code) {
            return std::vector<std::uint8_t>{static_cast<std::uint8_t>(pdu[0] | 0x80),
                                             static_cast<std::uint8_t>(code)};
        };
        if (mood == Mood::exceptions) return refuse(4);
        const std::lock_guard lock(mutex_);
        const int address = at(pdu, 1), count = at(pdu, 3);
        if (pdu[0] == 3) {
            std::vector<std::uint8_t> answer{3, static_cast<std::uint8_t>(2 * count)};
            for (int i = 0; i < count; ++i) {
                answer.push_back(static_cast<std::uint8_t>(words_[address + i] >> 8));
                answer.push_back(static_cast<std::uint8_t>(words_[address + i]));
            }
            return answer;
        }
        if (pdu[0] != 16) return refuse(1);
        if (address + count > end) return refuse(2);
        if (count > 123 || pdu.size() != 6u + 2u * static_cast<unsigned>(count)) return refuse(3);
        for (int i = 0; i < count; ++i)
            words_[address + i] = static_cast<std::uint16_t>(at(pdu, 6 + 2 * static_cast<std::size_t>(i)));
        // Of part n the run's number is n and the region's shift n * 1000.
        if (words_[1004] == 1 && words_[1011] * 1000 != (words_[1022] << 16 | words_[1023])) too_early = true;
        return {16, pdu[1], pdu[2], pdu[3], pdu[4]};
    }

    TcpListener listener_;
    std::mutex mutex_;
    std::map<int, std::uint16_t> words_;
    std::jthread thread_;
};

class ModbusClient : public testing::Test {
  protected:
    void poll(nlohmann::json more = nlohmann::json::object()) {
        nlohmann::json settings = {{"address", "127.0.0.1"}, {"port", plc->port()},     {"poll_ms", 10},
                                   {"read_address", 10},     {"write_address", 1000},   {"timeout_ms", 100},
                                   {"reconnect_ms", 20},     {"reconnect_most_ms", 40}, {"start", "line"}};
        settings.update(more);
        auto opened = open_line("modbus-client", settings, "door");
        ASSERT_TRUE(opened) << opened.error().sentence();
        link = std::move(*opened);
        LineState state;
        state.ready = true;
        state.alarm = LineAlarm::none;
        link->publish(state);
    }
    static LineState part(std::uint32_t n) {
        LineState state = told_part(n);
        state.regions[0].xyz_mm.x() = n;
        return state;
    }
    std::string notices() {
        std::string all;
        for (const Text& t : link->take_notices()) all += t.english() + "\n";
        return all;
    }

    std::optional<Plc> plc{std::in_place};
    std::unique_ptr<LineLink> link;
};

TEST_F(ModbusClient, LeadsPartsThroughAPlcsMemory) {
    poll();
    for (std::uint32_t n = 1; n <= 5; ++n) {
        EXPECT_TRUE(soon([&] { return plc->word(1002) == 1; })) << "ready";
        plc->set(12, 2);
        plc->set(15, static_cast<std::uint16_t>(800 + n));
        plc->set(11, 1);
        std::optional<LineCall> call;
        ASSERT_TRUE(soon([&] { return (call = link->take_call()).has_value(); }));
        EXPECT_EQ(call->part.type, 2);
        EXPECT_EQ(call->part.id(), std::to_string(800 + n));
        EXPECT_TRUE(soon([&] { return plc->word(1003) == 1; })) << "busy";
        link->publish(part(n));
        EXPECT_TRUE(soon([&] { return plc->word(1004) == 1; })) << "done";
        EXPECT_EQ(plc->word(1005), 1);
        EXPECT_EQ(plc->word(1011), n);
        EXPECT_EQ(plc->word(1022) << 16 | plc->word(1023), static_cast<int>(n) * 1000);
        plc->set(11, 0);
        EXPECT_TRUE(soon([&] { return plc->word(1004) == 0; }));
    }
    EXPECT_FALSE(plc->too_early) << "done came before what it stands for";
    EXPECT_EQ(notices(), "");
}

// Below those that Linux gives by itself: a client that tries one of these again and again, while nobody listens, may
// reach itself.
std::uint16_t port_of_our_own() {
    auto port = static_cast<std::uint16_t>(20000 + getpid() % 9000);
    while (!TcpListener::listen("127.0.0.1", port)) ++port;
    return port;
}

TEST_F(ModbusClient, ComesBackAfterThePlc) {
    plc.emplace(port_of_our_own());
    poll();
    ASSERT_TRUE(soon([&] { return link->connected(); }));
    const std::uint16_t port = plc->port();
    plc->set(11, 1);
    std::optional<LineCall> call;
    ASSERT_TRUE(soon([&] { return (call = link->take_call()).has_value(); }));
    plc.reset();
    ASSERT_TRUE(soon([&] { return !link->connected(); }));
    EXPECT_FALSE(link->given_up());
    link->publish(part(1));
    plc.emplace(port, true);
    EXPECT_TRUE(soon([&] { return plc->word(1004) == 1 && plc->word(1011) == 1; }))
        << "the result waits for it";
    EXPECT_EQ(plc->word(1023), 1000);
    EXPECT_TRUE(soon([&] { return link->connected(); })) << "the words are there a moment before it says so";
    const std::string said = notices();
    EXPECT_THAT(said, HasSubstr("does not answer"));
    EXPECT_THAT(said, HasSubstr("answers again"));
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
    EXPECT_FALSE(link->take_call()) << "the same start is no new call";
    EXPECT_FALSE(plc->too_early);
}

TEST_F(ModbusClient, SurvivesWhateverAPlcAnswers) {
    poll();
    for (const Mood mood : {Mood::silent, Mood::half_answers, Mood::exceptions, Mood::nonsense}) {
        ASSERT_TRUE(soon([&] { return link->connected(); }));
        plc->mood = mood;
        EXPECT_TRUE(soon([&] { return !link->connected(); }));
        auto longest = 0ns;
        for (std::uint32_t i = 1; i < 50; ++i) {
            const auto begun = std::chrono::steady_clock::now();
            link->publish(part(i));
            EXPECT_FALSE(link->take_call());
            longest = std::max<std::chrono::nanoseconds>(longest, std::chrono::steady_clock::now() - begun);
            std::this_thread::sleep_for(2ms);
        }
        EXPECT_LT(longest, 90ms) << "the station waited for the PLC";
        plc->mood = Mood::sound;
    }
    EXPECT_TRUE(soon([&] { return link->connected(); }));
}

// What an earlier station left is no region of this one.
TEST_F(ModbusClient, RegionsOfAnEarlierStationGo) {
    for (const bool small : {false, true}) {
        link.reset();
        plc.emplace();
        plc->end = small ? 1020 + 2 * 32 : 65536;
        plc->set(1020, 1);
        plc->set(1052, 2);
        poll();
        EXPECT_TRUE(soon([&] { return plc->word(1002) == 1; })) << "ready";
        EXPECT_EQ(plc->word(1020), 0);
        EXPECT_EQ(plc->word(1052), 0);
        EXPECT_EQ(notices(), "");
    }
}

TEST_F(ModbusClient, AnExceptionIsAnAnswer) {
    plc->mood = Mood::exceptions;
    poll();
    std::string said;
    EXPECT_TRUE(soon([&] { return !(said += notices()).empty(); }));
    EXPECT_THAT(said, HasSubstr("refuses the words at read_address or write_address"));
}

TEST_F(ModbusClient, GoesAtOnceWhileThePlcIsAway) {
    plc->mood = Mood::silent;
    poll({{"timeout_ms", 300}, {"reconnect_most_ms", 600000}});
    std::this_thread::sleep_for(50ms);
    const auto begun = std::chrono::steady_clock::now();
    link.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 5s);
}

}  // namespace
}  // namespace seamwright
