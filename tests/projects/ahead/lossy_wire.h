#pragma once
// A cable between a robot and its correction that loses packets and answers, and holds some up, by their count.

#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>

#include "devices/net/socket.h"

namespace seamwright {

class LossyWire {
  public:
    // Of every so many: a packet is lost, an answer is lost, an answer comes `late_ms` late.
    LossyWire(std::uint16_t link_port, int lose_packet, int lose_answer, int delay_answer, int late_ms)
        : link_{"127.0.0.1", link_port},
          front_(*UdpSocket::bind("127.0.0.1", 0)),
          back_(*UdpSocket::bind("127.0.0.1", 0)) {
        there_ = std::thread([this, lose_packet] {
            for (int n = 1; !stop_;) {
                Endpoint from;
                const auto size = front_.receive(to_link_, from, std::chrono::milliseconds(20));
                if (!size) continue;
                {
                    const std::lock_guard lock(mutex_);
                    robot_ = from;
                }
                if (n++ % lose_packet == 0) {
                    ++lost;
                    continue;
                }
                (void)back_.send_to(std::span(to_link_).first(*size), link_);
            }
        });
        here_ = std::thread([this, lose_answer, delay_answer, late_ms] {
            for (int n = 1; !stop_;) {
                Endpoint from;
                const auto size = back_.receive(to_robot_, from, std::chrono::milliseconds(20));
                if (!size) continue;
                const int k = n++;
                if (k % lose_answer == 0) {
                    ++lost;
                    continue;
                }
                if (k % delay_answer == 0) std::this_thread::sleep_for(std::chrono::milliseconds(late_ms));
                std::optional<Endpoint> robot;
                {
                    const std::lock_guard lock(mutex_);
                    robot = robot_;
                }
                if (robot) (void)front_.send_to(std::span(to_robot_).first(*size), *robot);
            }
        });
    }
    ~LossyWire() {
        stop_ = true;
        there_.join();
        here_.join();
    }
    std::uint16_t port() const { return front_.port(); }
    std::atomic<int> lost{0};

  private:
    const Endpoint link_;
    UdpSocket front_, back_;
    std::array<std::byte, 8192> to_link_{}, to_robot_{};
    std::mutex mutex_;
    std::optional<Endpoint> robot_;
    std::atomic<bool> stop_{false};
    std::thread there_, here_;
};

}  // namespace seamwright
