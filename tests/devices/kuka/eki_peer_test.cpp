// Who may be the robot: a server of ours says so before it listens, and tells whom it refused.

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "devices/controllers/kuka/controller.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/rsi.h"
#include "devices/net/socket.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;

// A TCP client at another address of the loopback network.
class Stranger {
  public:
    Stranger(const char* from, std::uint16_t port) : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        ::inet_pton(AF_INET, from, &address.sin_addr);
        EXPECT_EQ(::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
        ::inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
        address.sin_port = htons(port);
        EXPECT_EQ(::connect(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    }
    ~Stranger() { ::close(fd_); }
    Stranger(const Stranger&) = delete;
    Stranger& operator=(const Stranger&) = delete;

  private:
    int fd_;
};

TEST(EkiPeer, ServerForTheWholeNetworkMustKnowItsRobot) {
    DeviceSession session;
    const auto eki = open_kuka_eki({{"listen", "0.0.0.0"}, {"port", 0}}, session);
    ASSERT_FALSE(eki);
    EXPECT_THAT(eki.error().sentence(), HasSubstr("name the controller's address in \"robot_address\""));
    const auto rsi = open_kuka_rsi({{"listen", "0.0.0.0"}, {"port", 0}}, session, nullptr);
    ASSERT_FALSE(rsi);
    EXPECT_THAT(rsi.error().sentence(), HasSubstr("\"robot_address\""));
    EXPECT_TRUE(open_kuka_eki({{"listen", "0.0.0.0"}, {"port", 0}, {"robot_address", "127.0.0.1"}}, session));
}

TEST(EkiPeer, StrangersAreRefusedAndTold) {
    DeviceSession session;
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    auto link = open_kuka_eki({{"port", port}, {"robot_address", "127.0.0.1"}, {"timeout_ms", 300}}, session);
    ASSERT_TRUE(link) << link.error().sentence();
    EXPECT_THAT((*link)->take_notices(), IsEmpty());
    {
        const Stranger first("127.0.0.9", port), second("127.0.0.9", port);
        const auto nobody = (*link)->identity();
        ASSERT_FALSE(nobody);
        EXPECT_TRUE(is_silence(nobody.error())) << nobody.error().sentence();
    }
    EXPECT_THAT(
        (*link)->take_notices(),
        ElementsAre(testing::ResultOf(
            [](const Text& notice) { return notice.english(); },
            MatchesRegex("2 connections of an unknown peer were refused, the last of 127.0.0.9:.*"))));
    EXPECT_THAT((*link)->take_notices(), IsEmpty()) << "told once";

    auto cell = SimulatedCell::open({{"optics", {{"width", 64}, {"height", 64}}}});
    ASSERT_TRUE(cell);
    auto controller = start_kuka_eki_controller(*cell, {{"port", port}});
    ASSERT_TRUE(controller) << controller.error().sentence();
    Expected<RobotIdentity> robot = (*link)->identity();
    for (int i = 0; i < 20 && !robot; ++i) robot = (*link)->identity();
    ASSERT_TRUE(robot) << robot.error().sentence();
    // A stranger does not take the robot's place.
    const Stranger third("127.0.0.9", port);
    EXPECT_TRUE((*link)->mode());
    EXPECT_THAT((*link)->take_notices(), ElementsAre(HasSubstr("1 connections of an unknown peer")));
}

// Who programs the other side reads why he is not taken for a robot.
TEST(EkiPeer, AFirstTelegramThatIsNoneIsTold) {
    DeviceSession session;
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    auto link = open_kuka_eki({{"port", port}, {"timeout_ms", 300}}, session);
    ASSERT_TRUE(link) << link.error().sentence();
    auto robot = TcpConnection::connect("127.0.0.1", port, Timeout(300));
    ASSERT_TRUE(robot);
    ASSERT_TRUE(robot->send(
        bytes_of("<Robot Kind=\"hello\" Id=\"0\" Name=\"777\" Part=\"KR\" Mode=\"#AUT\" Text=\"-\">"
                 "<Pos X=\"1,5\" Y=\"0\" Z=\"0\" A=\"0\" B=\"0\" C=\"0\"/></Robot>"),
        Timeout(300)));
    const auto nobody = (*link)->identity();
    ASSERT_FALSE(nobody);
    EXPECT_TRUE(is_silence(nobody.error()));
    EXPECT_THAT(nobody.error().sentence(), HasSubstr("127.0.0.1:"));
    EXPECT_THAT(nobody.error().sentence(), HasSubstr("its first telegram has no number Pos/X"));
}

}  // namespace
}  // namespace seamwright
