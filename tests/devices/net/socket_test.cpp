#include "devices/net/socket.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

namespace seamwright {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

struct Pair {
    TcpConnection client, server;
};

Pair connected_pair() {
    auto listener = TcpListener::listen("127.0.0.1", 0);
    EXPECT_TRUE(listener);
    auto client = TcpConnection::connect("127.0.0.1", listener->port(), milliseconds(1000));
    EXPECT_TRUE(client);
    auto server = listener->accept(milliseconds(1000));
    EXPECT_TRUE(server);
    return {std::move(*client), std::move(*server)};
}

TEST(Tcp, BytesArriveWholeWhateverTheSegments) {
    Pair p = connected_pair();
    std::vector<std::byte> sent(3'000'000), received(sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = static_cast<std::byte>(i * 7 >> 3);
    std::jthread sender([&] {
        for (std::size_t at = 0, size = 1; at < sent.size(); at += size, size = size * 3 % 70001 + 1) {
            size = std::min(size, sent.size() - at);
            ASSERT_TRUE(p.server.send({sent.data() + at, size}, milliseconds(5000)));
        }
    });
    ASSERT_TRUE(p.client.receive_exactly(received, milliseconds(10000)));
    EXPECT_EQ(sent, received);
}

TEST(Tcp, SilenceIsAnErrorAfterTheTimeoutAndTheConnectionLivesOn) {
    Pair p = connected_pair();
    std::array<std::byte, 4> buffer;
    const auto start = std::chrono::steady_clock::now();
    auto got = p.client.receive_some(buffer, milliseconds(120));
    ASSERT_FALSE(got);
    EXPECT_TRUE(is_silence(got.error())) << got.error().sentence();
    EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(120));
    ASSERT_TRUE(p.server.send(bytes_of("late"), milliseconds(1000)));
    ASSERT_TRUE(p.client.receive_exactly(buffer, milliseconds(1000)));
    EXPECT_EQ(buffer[0], std::byte{'l'});
}

TEST(Tcp, ADisconnectIsNamed) {
    Pair p = connected_pair();
    { TcpConnection gone = std::move(p.server); }
    std::array<std::byte, 4> buffer;
    auto got = p.client.receive_some(buffer, milliseconds(1000));
    ASSERT_FALSE(got);
    EXPECT_TRUE(is_disconnect(got.error())) << got.error().sentence();
    EXPECT_NE(got.error().where.english().find("127.0.0.1:"), std::string::npos);
}

TEST(Tcp, CloseFromAnotherThreadEndsAWaitingCall) {
    Pair p = connected_pair();
    std::array<std::byte, 4> buffer;
    std::jthread closer([&] {
        std::this_thread::sleep_for(milliseconds(60));
        p.client.close();
    });
    auto got = p.client.receive_some(buffer, milliseconds(20000));
    ASSERT_FALSE(got);
    EXPECT_NE(got.error().what.english().find("closed"), std::string::npos);
    EXPECT_FALSE(p.client.is_open());
}

TEST(Tcp, RefusedPortAndBadAddressAreClearErrors) {
    std::uint16_t free_port;
    {
        auto listener = TcpListener::listen("127.0.0.1", 0);
        ASSERT_TRUE(listener);
        free_port = listener->port();
    }
    auto refused = TcpConnection::connect("127.0.0.1", free_port, milliseconds(500));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::device);
    EXPECT_EQ(refused.error().what, "Connection refused");
    EXPECT_EQ(refused.error().what.in(Language::german), "Verbindung abgelehnt");
    auto bad = TcpConnection::connect("192.168.1", 7000, milliseconds(500));
    ASSERT_FALSE(bad);
    EXPECT_EQ(bad.error().kind, ErrorKind::input);
    auto twice = TcpListener::listen("127.0.0.1", 0);
    ASSERT_TRUE(twice);
    EXPECT_FALSE(TcpListener::listen("127.0.0.1", twice->port()));
}

// A simulator in a container is known by its name alone. "localhost" is ::1 first where there is one.
TEST(Tcp, APeerMayBeNamed) {
    auto listener = TcpListener::listen("127.0.0.1", 0);
    ASSERT_TRUE(listener);
    const auto made = TcpConnection::connect("localhost", listener->port(), Timeout(2000));
    ASSERT_TRUE(made) << made.error().sentence();
    EXPECT_EQ(made->peer(), fmt::format("localhost:{}", listener->port()));
    EXPECT_TRUE(listener->accept(Timeout(1000)));

    const auto nobody = TcpConnection::connect("no-such-robot.invalid", 7000, Timeout(2000));
    ASSERT_FALSE(nobody);
    EXPECT_EQ(nobody.error().kind, ErrorKind::device);
    EXPECT_THAT(nobody.error().sentence(), HasSubstr("the name \"no-such-robot.invalid\" is not found"));
}

// What a lookup would take for another address than it looks like, and what is neither address nor name.
TEST(Tcp, WhatIsNeitherAddressNorNameIsRefused) {
    for (const char* host :
         {"", " 127.0.0.1", "127.0.0.1 ", "127.1", "0177.0.0.1", "0x7f.1", "2130706433", "300.1.1.1", "[::1]",
          "robot:7000", "http://robot", "a..b", ".robot", "-robot", "robot 1"}) {
        const auto made = TcpConnection::connect(host, 7000, Timeout(200));
        ASSERT_FALSE(made) << host;
        EXPECT_EQ(made.error().kind, ErrorKind::input) << host << made.error().sentence();
    }
}

TEST(Udp, DatagramsKeepTheirBoundsAndLongOnesAreRefused) {
    auto a = UdpSocket::bind("127.0.0.1", 0), b = UdpSocket::bind("127.0.0.1", 0);
    ASSERT_TRUE(a && b);
    const Endpoint to_b{"127.0.0.1", b->port()};
    ASSERT_TRUE(a->send_to(bytes_of("first"), to_b));
    ASSERT_TRUE(a->send_to(bytes_of("second, longer than the buffer"), to_b));
    ASSERT_TRUE(a->send_to(bytes_of("third"), to_b));
    std::array<std::byte, 16> buffer;
    Endpoint from;
    auto n = b->receive(buffer, from, milliseconds(1000));
    ASSERT_TRUE(n);
    EXPECT_EQ(*n, 5u);
    EXPECT_EQ(from, (Endpoint{"127.0.0.1", a->port()}));
    EXPECT_FALSE(b->receive(buffer, from, milliseconds(1000)));
    n = b->receive(buffer, from, milliseconds(1000));
    ASSERT_TRUE(n);
    EXPECT_EQ(*n, 5u);
    auto silent = b->receive(buffer, from, milliseconds(60));
    ASSERT_FALSE(silent);
    EXPECT_TRUE(is_silence(silent.error()));
}

}  // namespace
}  // namespace seamwright
