// The camera's side of GigE Vision, spoken to byte by byte as the standard has it.

#include "devices/served/gige_server.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "devices/genicam/gvcp.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using namespace std::chrono_literals;
using Octets = std::vector<std::uint8_t>;

class PlainMemory final : public GigeMemory {
  public:
    bool read(std::uint32_t address, std::span<std::byte> to) override {
        const std::lock_guard lock(mutex_);
        if (address + to.size() > bytes_.size()) return false;
        std::memcpy(to.data(), bytes_.data() + address, to.size());
        return true;
    }
    bool write(std::uint32_t address, std::span<const std::byte> from) override {
        const std::lock_guard lock(mutex_);
        if (address + from.size() > bytes_.size()) return false;
        std::memcpy(bytes_.data() + address, from.data(), from.size());
        return true;
    }
    void set(std::uint32_t address, std::uint32_t value) {
        const std::array<std::byte, 4> raw = {
            static_cast<std::byte>(value >> 24), static_cast<std::byte>(value >> 16 & 255),
            static_cast<std::byte>(value >> 8 & 255), static_cast<std::byte>(value & 255)};
        write(address, raw);
    }

  private:
    std::mutex mutex_;
    std::vector<std::byte> bytes_ = std::vector<std::byte>(0x1000);
};

class Peer {
  public:
    explicit Peer(std::string camera) : camera_(std::move(camera)) {}
    std::uint16_t port() const { return socket_.port(); }
    Octets receive() {
        std::array<std::byte, 4096> buffer;
        Endpoint from;
        const auto size = socket_.receive(buffer, from, Timeout(300));
        if (!size) return {};
        Octets got(*size);
        std::memcpy(got.data(), buffer.data(), *size);
        return got;
    }
    void send(const Octets& bytes) {
        EXPECT_TRUE(socket_.send_to(std::as_bytes(std::span(bytes)), {camera_, kGvcpPort}));
    }
    Octets ask(const Octets& bytes) {
        send(bytes);
        return receive();
    }

  private:
    std::string camera_;
    UdpSocket socket_ = *UdpSocket::bind("127.0.0.1", 0);
};

class GigeWire : public testing::Test {
  protected:
    void SetUp() override {
        memory.set(0x938, 200);  // heartbeat, ms
        for (int i = 1; i < 250 && !server; ++i) {
            address = "127.201.7." + std::to_string(i);
            if (auto opened = GigeServer::open(address, memory)) server = std::move(*opened);
        }
        ASSERT_TRUE(server);
    }
    PlainMemory memory;
    std::string address;
    std::unique_ptr<GigeServer> server;
    const Octets take = {0x42, 1, 0, 0x82, 0, 8, 0, 7, 0, 0, 0x0A, 0, 0, 0, 0, 2};
    const Octets taken = {0, 0, 0, 0x83, 0, 4, 0, 7, 0, 0, 0, 1};
    const Octets denied = {0x80, 6, 0, 0x83, 0, 0, 0, 7};
};

TEST_F(GigeWire, RegistersAndMemoryAreReadAndWritten) {
    Peer peer(address);
    const Octets write = {0x42, 1, 0, 0x82, 0, 8, 0, 7, 0, 0, 1, 0, 1, 2, 3, 4};
    EXPECT_EQ(peer.ask(write), denied) << "without control";
    EXPECT_EQ(peer.ask(take), taken);
    EXPECT_EQ(peer.ask({0x42, 1, 0, 0x82, 0, 16, 0, 1, 0, 0, 1, 0, 1, 2, 3, 4, 0, 0, 1, 4, 5, 6, 7, 8}),
              (Octets{0, 0, 0, 0x83, 0, 4, 0, 1, 0, 0, 0, 2}));
    EXPECT_EQ(peer.ask({0x42, 1, 0, 0x80, 0, 8, 0, 2, 0, 0, 1, 4, 0, 0, 1, 0}),
              (Octets{0, 0, 0, 0x81, 0, 8, 0, 2, 5, 6, 7, 8, 1, 2, 3, 4}));
    EXPECT_EQ(peer.ask({0x42, 1, 0, 0x84, 0, 8, 0, 3, 0, 0, 1, 0, 0, 0, 0, 8}),
              (Octets{0, 0, 0, 0x85, 0, 12, 0, 3, 0, 0, 1, 0, 1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(peer.ask({0x42, 1, 0, 0x86, 0, 8, 0, 4, 0, 0, 1, 0, 9, 9, 9, 9}),
              (Octets{0, 0, 0, 0x87, 0, 4, 0, 4, 0, 0, 0, 4}));
    EXPECT_EQ(peer.ask({0x42, 1, 0, 2, 0, 0, 0, 5}).size(), 8U + 0xF8);
}

TEST_F(GigeWire, WhatItDoesNotHaveItRefuses) {
    Peer peer(address);
    EXPECT_EQ(peer.ask({0x42, 1, 0, 0x40, 0, 0, 0, 1}), (Octets{0x80, 1, 0, 0x41, 0, 0, 0, 1}));
    EXPECT_EQ(peer.ask({0x42, 1, 0, 0x80, 0, 4, 0, 2, 0xFF, 0, 0, 0}),
              (Octets{0x80, 3, 0, 0x81, 0, 0, 0, 2}));
    EXPECT_EQ(peer.ask({0x42, 1, 0, 0x80, 0, 3, 0, 3, 0, 0, 0}), (Octets{0x80, 2, 0, 0x81, 0, 0, 0, 3}));
    EXPECT_EQ(peer.ask({0x42, 1, 0, 0x84, 0, 8, 0, 4, 0, 0, 0, 0, 0, 0, 0xFF, 0xFC}),
              (Octets{0x80, 2, 0, 0x85, 0, 0, 0, 4}));
    // No command at all, and one that says that it is longer than it is: no answer, and it goes on.
    EXPECT_TRUE(peer.ask({1, 2, 3}).empty());
    EXPECT_TRUE(peer.ask({0x42, 1, 0, 0x80, 0, 8, 0, 5, 0, 0, 1, 0}).empty());
    EXPECT_FALSE(peer.ask({0x42, 1, 0, 2, 0, 0, 0, 5}).empty());
}

TEST_F(GigeWire, OneIsInControlUntilItFallsSilent) {
    Peer first(address), second(address);
    EXPECT_EQ(first.ask(take), taken);
    EXPECT_EQ(second.ask(take), denied);
    // Whatever it says keeps it in control, whatever others say does not.
    for (int i = 0; i < 5; ++i) {
        std::this_thread::sleep_for(60ms);
        EXPECT_FALSE(first.ask({0x42, 1, 0, 0x80, 0, 4, 0, 2, 0, 0, 0x0A, 0}).empty());
        EXPECT_EQ(second.ask(take), denied);
    }
    Octets answer;
    for (int i = 0; i < 100 && answer != taken; ++i) {
        std::this_thread::sleep_for(20ms);
        answer = second.ask(take);
    }
    EXPECT_EQ(answer, taken) << "the first one has been silent for its heartbeat time-out";
    EXPECT_EQ(first.ask(take), denied);
    // Given back.
    EXPECT_EQ(second.ask({0x42, 1, 0, 0x82, 0, 8, 0, 7, 0, 0, 0x0A, 0, 0, 0, 0, 0}), taken);
    EXPECT_EQ(first.ask(take), taken);
}

TEST_F(GigeWire, AFrameLeavesAsLeaderDataAndTrailer) {
    Peer peer(address);
    memory.set(0xD18, 0x7F000001);
    memory.set(0xD00, peer.port());
    memory.set(0xD04, 36 + 4);  // four bytes a packet
    const std::array<std::byte, 6> payload = {std::byte{1}, std::byte{2}, std::byte{3},
                                              std::byte{4}, std::byte{5}, std::byte{6}};
    server->send({.id = 7,
                  .device_ns = 0x1122334455667788,
                  .pixel_format = 0x01080001,
                  .width = 3,
                  .height = 2,
                  .x = 16,
                  .y = 8,
                  .payload = payload},
                 [] { return false; });
    EXPECT_EQ(peer.receive(), (Octets{0,    0,    0,    7,    1,    0,  0, 0, 0, 0, 0, 1, 0x11, 0x22, 0x33,
                                      0x44, 0x55, 0x66, 0x77, 0x88, 1,  8, 0, 1, 0, 0, 0, 3,    0,    0,
                                      0,    2,    0,    0,    0,    16, 0, 0, 0, 8, 0, 0, 0,    0}));
    EXPECT_EQ(peer.receive(), (Octets{0, 0, 0, 7, 3, 0, 0, 1, 1, 2, 3, 4}));
    EXPECT_EQ(peer.receive(), (Octets{0, 0, 0, 7, 3, 0, 0, 2, 5, 6}));
    EXPECT_EQ(peer.receive(), (Octets{0, 0, 0, 7, 2, 0, 0, 3, 0, 0, 0, 1, 0, 0, 0, 2}));
    int packet = 0;
    server->send({.id = 8, .payload = payload}, [&] { return packet++ != 3; });
    EXPECT_EQ(peer.receive(), (Octets{0, 0, 0, 8, 2, 0, 0, 3, 0, 0, 0, 1, 0, 0, 0, 0}))
        << "all but one are lost";
}

}  // namespace
}  // namespace seamwright
