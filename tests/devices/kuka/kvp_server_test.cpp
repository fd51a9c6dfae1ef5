// KUKAVARPROXY as its published server and simple ones behave, written from the message table: one request a receive, an
// empty value with a 1 for what is not known, answers that take their time.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "devices/kuka/kvp.h"
#include "devices/net/socket.h"
#include "devices/robot_program.h"

namespace seamwright {
namespace {

using namespace std::string_literals;
using namespace std::chrono_literals;

class PublishedServer {
  public:
    explicit PublishedServer(std::map<std::string, std::string> variables,
                             std::chrono::milliseconds delay = 0ms)
        : variables_(std::move(variables)), delay_(delay), listener_(*TcpListener::listen("127.0.0.1", 0)) {
        port = listener_.port();
        thread_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                auto client = listener_.accept(Timeout(5));
                if (client) serve(*client, stop);
            }
        });
    }
    std::uint16_t port = 0;
    std::atomic<int> asked = 0;
    std::string value(const std::string& name) {
        const std::lock_guard lock(mutex_);
        return variables_[name];
    }

  private:
    static std::string word(std::size_t n) {
        return {static_cast<char>(n >> 8 & 0xff), static_cast<char>(n & 0xff)};
    }
    static std::size_t number(const std::string& bytes, std::size_t at) {
        return static_cast<std::size_t>(static_cast<unsigned char>(bytes[at])) << 8 |
               static_cast<unsigned char>(bytes[at + 1]);
    }
    void serve(TcpConnection& client, const std::stop_token& stop) {
        std::string buffer(1024, '\0');
        while (!stop.stop_requested()) {
            auto got = client.receive_some(std::as_writable_bytes(std::span(buffer)), Timeout(5));
            if (!got && !is_silence(got.error())) return;
            if (!got) continue;
            // What came is one message, whatever stands behind it.
            const std::string message = buffer.substr(0, *got);
            const std::lock_guard lock(mutex_);
            const std::size_t length = number(message, 5);
            const std::string name = message.substr(7, length);
            std::string value;
            char ok = 1;
            if (message[4] == 0) {
                if (const auto known = variables_.find(name); known != variables_.end())
                    value = known->second;
            } else {
                value = message.substr(9 + length, number(message, 7 + length));
                if (variables_.count(name) == 0)
                    ok = 0;
                else
                    variables_[name] = value;
            }
            ++asked;
            std::this_thread::sleep_for(delay_);
            const std::string body = message.substr(4, 1) + word(value.size()) + value + word(1) + ok;
            (void)client.send(bytes_of(message.substr(0, 2) + word(body.size()) + body), Timeout(100));
        }
    }

    std::mutex mutex_;
    std::map<std::string, std::string> variables_;
    const std::chrono::milliseconds delay_;
    TcpListener listener_;
    std::jthread thread_;
};

std::unique_ptr<RobotLink> link_to(const PublishedServer& server, int timeout_ms = 300) {
    DeviceSession session;
    auto link = open_kuka_kvp({{"port", server.port}, {"timeout_ms", timeout_ms}}, session);
    EXPECT_TRUE(link) << link.error().sentence();
    return std::move(*link);
}

const std::string kNowhere = "{FRAME: X 0.0, Y 0.0, Z 0.0, A 0.0, B 0.0, C 0.0}";

TEST(KvpServer, AnswersOneRequestAReceive) {
    PublishedServer server({{"$KR_SERIALNO", "777"}, {"$TRAFONAME[]", "\"#KR210\""}});
    const auto robot = link_to(server)->identity();
    ASSERT_TRUE(robot) << robot.error().sentence();
    EXPECT_EQ(robot->serial, "777");
    EXPECT_EQ(robot->model, "#KR210");
    EXPECT_EQ(server.asked, 2);
}

TEST(KvpServer, EveryAnswerHasTheWholeTimeOut) {
    PublishedServer server({{"$KR_SERIALNO", "777"}, {"$TRAFONAME[]", "\"#KR210\""}}, 200ms);
    EXPECT_TRUE(link_to(server)->identity());
    EXPECT_FALSE(link_to(server, 50)->identity());
}

// The controller has no module: its frame is its own variable, and what it does not know it does not tell.
TEST(KvpServer, AnEmptyValueIsAnUnknownVariable) {
    PublishedServer server({{"$BASE", kNowhere},
                            {"$TOOL", kNowhere},
                            {"$POS_ACT", "{E6POS: X 100.0, Y 0.0, Z 7.0, A 0.0, B 0.0, C 0.0, S 2, T 35}"},
                            {"BASE_DATA[5]", "{FRAME: X 900.5, Y 0.0, Z 0.0, A 0.0, B 0.0, C 0.0}"}});
    const auto link = link_to(server);
    const auto frame = link->read_frame("BASE_DATA[5]");
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_DOUBLE_EQ(frame->translation().x(), 900.5);
    const auto flange = link->base_from_flange();  // no $BASE_C: that of the advance run
    ASSERT_TRUE(flange) << flange.error().sentence();
    EXPECT_DOUBLE_EQ(flange->translation().z(), 7.0);
    const auto unknown = link->read_frame("BASE_DATA[6]");
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().sentence(), testing::HasSubstr("refuses to read BASE_DATA[6]"));
}

// The start signal follows the count of the triggers: a controller that does not take the one is not given the other.
TEST(KvpServer, NothingIsSetOffBehindARefusedWrite) {
    const std::map<std::string, std::string> waiting = {
        {"$STOPMESS", "FALSE"},
        {"SW_RELEASED", "FALSE"},
        {"SW_WAITS", "TRUE"},
        {"SW_BUSY", "FALSE"},
        {"SW_TAKEN", "FALSE"},
        {"SW_TAKING", "FALSE"},
        {"SW_VERDICT", "0"},
        {"SW_GO", "FALSE"},
        {"SW_SIGNATURE[]", '"' + program_signature({}) + '"'}};
    PublishedServer server(waiting);  // without SW_FIRED
    const auto started = link_to(server)->start_measuring({});
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().sentence(), testing::HasSubstr("refuses to write SW_FIRED"));
    EXPECT_EQ(server.value("SW_GO"), "FALSE");
}

}  // namespace
}  // namespace seamwright
