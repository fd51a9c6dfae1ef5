#pragma once
// Seamwright's end of an RTDE connection. Private to this folder: what a robot is asked is rtde_link.cpp, what goes over the
// wire rtde_connection.cpp.

#include <array>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "devices/backoff.h"
#include "devices/net/socket.h"
#include "devices/robot_link.h"
#include "devices/same_robot.h"
#include "devices/silence.h"
#include "devices/ur/dashboard.h"
#include "devices/ur/module.h"
#include "devices/ur/rtde_message.h"

namespace seamwright {

struct RtdeSettings {
    std::string address;
    int port = 0, dashboard_port = 0, timeout_ms = 0, move_timeout_ms = 0, first_register = 0,
        reconnect_ms = 0, reconnect_most_ms = 0;
    double frequency_hz = 0;
};

class RtdeLink final : public RobotLink {
  public:
    explicit RtdeLink(RtdeSettings settings);

    Expected<RobotIdentity> identity() override;
    Expected<RobotMode> mode() override;
    Expected<Pose> base_from_flange() override;
    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override;
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override;
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override;
    Expected<Pose> read_frame(const std::string& name) override;
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override;
    Expected<void> confirm(PartVerdict verdict, const std::string&) override;
    Expected<Permission> permission() override;
    Expected<void> move_to(const Pose& base_from_flange) override;
    bool can_move() const override { return true; }

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr int kPlaying = 2;  // runtime state of a program that runs

    // One data package of the controller.
    struct State {
        Pose base_from_tcp = Pose::Identity();
        std::optional<Error> bad_pose;
        Pose flange_from_tcp = Pose::Identity();
        std::int32_t robot_mode = 0, safety_mode = 0;
        std::uint32_t runtime = 0;
        std::array<std::int32_t, ur::kOutputs> numbers{};
        std::array<double, 6> pose{};
        Clock::time_point at{};
    };

    Expected<void> drive_to(const Pose& base_from_flange);
    Expected<RobotMode> present_mode();
    Expected<Pose> flange();
    Expected<RobotIdentity> ask_identity();
    Expected<void> same_robot();
    bool measuring_ended(const State& s) const;
    Expected<Pose> named(const std::string& name, Expected<Pose> answer) const;

    void keep(const std::stop_token& stop);
    Expected<void> beat();
    Expected<void> send_request();
    tl::unexpected<Error> fail(Error error);
    Expected<rtde::Package> receive(Clock::time_point until);
    Expected<rtde::Package> request(const rtde::Package& question, Clock::time_point until);
    Expected<bool> accepted(const rtde::Package& question, Clock::time_point until);
    Expected<rtde::Recipe> recipe(const rtde::Package& question, const std::vector<std::string>& names,
                                  bool numbered, Clock::time_point until);
    Expected<void> negotiate(Clock::time_point until);
    Expected<void> connected();
    Expected<void> connect();
    Expected<void> take(const rtde::Package& package);
    Expected<void> next_state(Clock::time_point until);
    Expected<void> take_all();
    Expected<const State*> newest();
    Expected<const State*> coming();
    Expected<Pose> ask(ur::Command command, std::int32_t argument = 0, std::int32_t high = 0,
                       std::int32_t low = 0, const std::array<double, 6>& pose = {},
                       std::optional<Timeout> timeout = {});
    Text heard() const { return said_.empty() ? Text() : Text(", saying: {}", said_); }
    // Silence of the awaited thing is no silence of the controller: the connection stays.
    template <class Ready>
    Expected<void> wait_until(std::chrono::milliseconds timeout, const Ready& ready) {
        const auto until = Clock::now() + timeout;
        auto state = newest();
        if (!state) return tl::unexpected(fell_silent(state.error()));
        while (!ready(*state_)) {
            if (Clock::now() >= until) return device_error(ErrorCode::silence, kNoAnswer, where_);
            if (auto next = next_state(Clock::now() + timeout_); !next)
                return tl::unexpected(fell_silent(next.error()));
        }
        return {};
    }

    std::mutex mutex_;  // all below
    const RtdeSettings settings_;
    const std::string where_;
    const Timeout timeout_;
    ur::Dashboard dashboard_;
    Backoff back_off_;
    std::optional<TcpConnection> connection_;
    std::string stream_, said_;
    int version_ = 2;
    rtde::Recipe outputs_, inputs_;
    std::optional<State> state_;
    std::int32_t number_ = 0;
    std::int32_t session_ = 0, beats_ = 0;
    Clock::time_point next_beat_{};
    std::vector<rtde::Value> last_request_;
    std::optional<Error> lost_;  // between two calls
    std::vector<std::string> spots_;
    std::size_t told_ = 0;
    SameRobot robot_;
    std::int64_t quiet_ns_ = 0;  // when nobody called; 0 = not known
    std::jthread keeper_;        // last: everything above is there while it runs
};

}  // namespace seamwright
