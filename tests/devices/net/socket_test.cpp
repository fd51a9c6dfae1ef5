#include "devices/net/socket.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

namespace seamwright {
namespace {

using std::chrono::milliseconds;

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
    auto bad = TcpConnection::connect("controller", 7000, milliseconds(500));
    ASSERT_FALSE(bad);
    EXPECT_EQ(bad.error().kind, ErrorKind::input);
    auto twice = TcpListener::listen("127.0.0.1", 0);
    ASSERT_TRUE(twice);
    EXPECT_FALSE(TcpListener::listen("127.0.0.1", twice->port()));
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
