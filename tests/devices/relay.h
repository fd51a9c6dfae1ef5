#pragma once
// A network that breaks and joins: passes bytes on between two ends, in pieces of `piece` bytes both ways.

#include <algorithm>
#include <array>
#include <thread>

#include "devices/net/socket.h"

namespace seamwright {

class Relay {
  public:
    // Whoever connects to port() talks to 127.0.0.1:`to`.
    Relay(std::uint16_t to, std::size_t piece) : listener_(TcpListener::listen("127.0.0.1", 0).value()) {
        thread_ = std::jthread([this, to, piece](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                auto client = listener_.accept(Timeout(2));
                if (!client) continue;
                auto server = TcpConnection::connect("127.0.0.1", to, Timeout(1000));
                if (!server) continue;
                while (!stop.stop_requested() && pass(*client, *server, piece) &&
                       pass(*server, *client, piece)) {
                }
            }
        });
    }
    std::uint16_t port() const { return listener_.port(); }

  private:
    static bool pass(TcpConnection& from, TcpConnection& to, std::size_t piece) {
        std::array<std::byte, 4096> buffer;
        const auto got = from.receive_some(buffer, Timeout(1));
        if (!got) return is_silence(got.error());
        for (std::size_t at = 0; at < *got; at += piece)
            if (!to.send(std::span(buffer).subspan(at, std::min(piece, *got - at)), Timeout(500)))
                return false;
        return true;
    }
    TcpListener listener_;
    std::jthread thread_;
};

}  // namespace seamwright
