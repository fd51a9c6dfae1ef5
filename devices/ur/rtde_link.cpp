#include "devices/ur/rtde_link.h"

#include <fmt/format.h>

#include <algorithm>

#include "devices/exchange/settings.h"
#include "devices/host_time.h"
#include "devices/robot_program.h"
#include "devices/ur/rtde.h"

namespace seamwright {
namespace {

using ur::Command;

// What sw_teach() drives at least.
constexpr double kTeach_mm_s = 100, kTeach_deg_s = 10;

}  // namespace

RtdeLink::RtdeLink(RtdeSettings settings)
    : settings_(std::move(settings)),
      where_(fmt::format("ur-rtde {}:{}", settings_.address, settings_.port)),
      timeout_(settings_.timeout_ms),
      dashboard_(settings_.address, static_cast<std::uint16_t>(settings_.dashboard_port), timeout_),
      back_off_(Timeout(settings_.reconnect_ms), Timeout(settings_.reconnect_most_ms)),
      keeper_([this](const std::stop_token& stop) { keep(stop); }) {}

Expected<RobotIdentity> RtdeLink::identity() {
    const std::lock_guard lock(mutex_);
    auto now = ask_identity();
    if (!now) return now;
    return robot_.told(*now);
}

Expected<RobotMode> RtdeLink::mode() {
    const std::lock_guard lock(mutex_);
    return present_mode();
}

Expected<RobotMode> RtdeLink::present_mode() {
    SEAM_TRY(auto state, coming());
    constexpr int kRobotRunning = 7;
    switch (state->safety_mode) {
        case 1:  // normal
        case 2:
            break;  // reduced
        case 3:     // protective stop
        case 4:     // recovery
        case 5:
            return RobotMode::stopped;  // safeguard stop
        case 6:
        case 7:
        case 8:
        case 9:
            return RobotMode::fault;  // emergency stops, violation, fault
        default:
            return RobotMode::unknown;
    }
    if (state->robot_mode != kRobotRunning || state->runtime != kPlaying) return RobotMode::stopped;
    auto remote = dashboard_.ask("is in remote control");  // CB3 does not know the question
    if (!remote) return tl::unexpected(remote.error());
    if (remote->starts_with("true")) return RobotMode::external;
    SEAM_TRY(auto operational, dashboard_.ask("get operational mode"));
    return operational.starts_with("MANUAL") ? RobotMode::manual_reduced : RobotMode::automatic;
}

Expected<Pose> RtdeLink::base_from_flange() {
    const std::lock_guard lock(mutex_);
    return flange();
}

Expected<Pose> RtdeLink::flange() {
    SEAM_TRY(auto state, coming());
    if (state->bad_pose) return fail(*state->bad_pose);
    return state->base_from_tcp * state->flange_from_tcp.inverse();
}

Expected<StartSignal> RtdeLink::wait_start(std::chrono::milliseconds timeout) {
    const std::lock_guard lock(mutex_);
    SEAM_OK(wait_until(timeout, [](const State& s) { return s.numbers[ur::kCall] != 0; }));
    const std::int64_t not_before = quiet_ns_;
    const std::int32_t call = state_->numbers[ur::kCall];
    std::array<std::int32_t, 4> part{};
    std::copy_n(state_->numbers.begin() + ur::kPart, 4, part.begin());
    std::array<std::int32_t, 4> type{};
    if (state_->numbers[ur::kModule] == ur::kModuleVersion)
        std::copy_n(state_->numbers.begin() + ur::kType, 4, type.begin());
    SEAM_OK(ask(Command::taken, call));
    return StartSignal{ur::part_from_registers(part), host_now_ns(), not_before,
                       ur::part_from_registers(type)};
}

Expected<void> RtdeLink::start_measuring(const std::vector<MeasuringMove>& moves) {
    const std::lock_guard lock(mutex_);
    SEAM_TRY(auto now, present_mode());
    if (now == RobotMode::stopped || now == RobotMode::fault)
        return device_error("the robot is stopped", where_, "start its program on the controller");
    spots_.clear();
    told_ = 0;
    for (const MeasuringMove& move : moves) spots_.push_back(move.spot_id);
    const auto [high, low] = ur::signature_numbers(program_signature(moves));
    // The robot program may be on its way to sw_measure(); the module refuses where it is elsewhere.
    (void)wait_until(timeout_, [](const State& s) {
        const auto state = ur::state_from(s.numbers[ur::kState]);
        return s.runtime != kPlaying || !state || state->phase != ur::Phase::elsewhere;
    });
    SEAM_OK(ask(Command::measure, 0, high, low));
    return {};
}

Expected<TriggerEvent> RtdeLink::wait_trigger(std::chrono::milliseconds timeout) {
    const std::lock_guard lock(mutex_);
    SEAM_OK(wait_until(timeout, [this](const State& s) {
        return s.numbers[ur::kFired] != static_cast<std::int32_t>(told_) || measuring_ended(s);
    }));
    const std::int64_t heard_ns = host_now_ns();
    const std::int32_t count = state_->numbers[ur::kFired];
    if (count == static_cast<std::int32_t>(told_) || measuring_ended(*state_))
        return device_error("the controller's program was stopped while it measured", where_,
                            "start it on the controller and measure the part again");
    if (count < static_cast<std::int32_t>(told_) || count > static_cast<std::int32_t>(spots_.size()))
        return fail({ErrorKind::device,
                     fmt::format("the controller counts {} triggers after {}", count, told_), where_,
                     "measure the part again"});
    // The module keeps all of a part, so none is lost between two packages.
    SEAM_TRY(auto answer, ask(Command::trigger, static_cast<std::int32_t>(told_ + 1)));
    return TriggerEvent{spots_[told_++], heard_ns, answer};
}

Expected<Pose> RtdeLink::read_frame(const std::string& name) {
    const std::lock_guard lock(mutex_);
    return named(name, ask(Command::read, ur::frame_number(name)));
}

Expected<void> RtdeLink::write_frame(const std::string& name, const Pose& base_from_frame) {
    const std::lock_guard lock(mutex_);
    if (!base_from_frame.matrix().allFinite() || base_from_frame.translation().cwiseAbs().maxCoeff() > 1e5)
        return input_error("the frame is not finite or beyond 100 m", name);
    SEAM_OK(same_robot());
    auto written =
        named(name, ask(Command::write, ur::frame_number(name), 0, 0, ur::ur_pose(base_from_frame)));
    if (!written) return tl::unexpected(written.error());
    return {};
}

Expected<void> RtdeLink::confirm(PartVerdict verdict, const std::string&) {
    const std::lock_guard lock(mutex_);
    const bool released = verdict == PartVerdict::corrected;
    if (released) SEAM_OK(same_robot());
    SEAM_OK(ask(Command::verdict, released ? 1 : verdict == PartVerdict::refused ? 2 : 3));
    const auto state = ur::state_from(state_->numbers[ur::kState]);
    if (!state || (state->permitted != ur::Permitted::no) != released)
        return device_error("the controller did not keep the verdict", where_);
    return {};
}

Expected<Permission> RtdeLink::permission() {
    const std::lock_guard lock(mutex_);
    SEAM_TRY(auto now, coming());
    const State& s = *now;
    if (!ur::is_module(s.numbers[ur::kModule]) || s.runtime != kPlaying) return Permission::none;
    const auto state = ur::state_from(s.numbers[ur::kState]);
    if (!state)
        return fail({ErrorKind::device,
                     fmt::format("{} is no state of the module", s.numbers[ur::kState]),
                     {},
                     "only one program may use these registers"});
    switch (state->permitted) {
        case ur::Permitted::no:
            return Permission::none;
        case ur::Permitted::given:
            return Permission::given;
        case ur::Permitted::taken:
        case ur::Permitted::used_up:
            return Permission::taken;
    }
    return Permission::none;
}

Expected<void> RtdeLink::move_to(const Pose& base_from_flange) {
    if (!base_from_flange.matrix().allFinite()) return input_error("the pose is not finite", where_);
    SEAM_OK(drive_to(base_from_flange));
    SEAM_OK(standing_at(base_from_flange));
    return {};
}

Expected<void> RtdeLink::drive_to(const Pose& base_from_flange) {
    const std::lock_guard lock(mutex_);
    SEAM_OK(same_robot());
    SEAM_TRY(auto at, flange());
    // Twice what the way takes at the programmed speed; a slider may have slowed the robot down.
    const double way_s = distance_mm(at, base_from_flange) / kTeach_mm_s +
                         deg_from_rad(angle_rad(at, base_from_flange)) / kTeach_deg_s;
    Timeout timeout = timeout_ + Timeout(3000 + static_cast<std::int64_t>(2000 * way_s));
    if (settings_.move_timeout_ms > 0) timeout = Timeout(settings_.move_timeout_ms);
    SEAM_OK(ask(Command::move, 0, 0, 0, ur::ur_pose(base_from_flange), timeout));
    return {};
}

Expected<RobotIdentity> RtdeLink::ask_identity() {
    // PolyScope before 3.12 and 5.6 knows neither question.
    SEAM_TRY(const auto model, dashboard_.ask_if_known("get robot model"));
    SEAM_TRY(const auto serial, dashboard_.ask_if_known("get serial number"));
    return RobotIdentity{"ur-rtde", "Universal Robots", model.value_or(""), serial.value_or("")};
}

Expected<void> RtdeLink::same_robot() {
    SEAM_OK(connected());
    return robot_.check([this] { return ask_identity(); }, where_);
}

// The program stands or begins anew, or its measuring does: no trigger is to come. A program that is
// paused goes on.
bool RtdeLink::measuring_ended(const State& s) const {
    constexpr std::uint32_t kStopping = 0, kStopped = 1;
    if (s.runtime == kStopping || s.runtime == kStopped || s.safety_mode >= 3) return true;
    const auto state = ur::state_from(s.numbers[ur::kState]);
    return told_ < spots_.size() && state && state->phase != ur::Phase::measures &&
           s.numbers[ur::kFired] <= static_cast<std::int32_t>(told_);
}

Expected<Pose> RtdeLink::named(const std::string& name, Expected<Pose> answer) const {
    if (!answer && answer.error().code == ErrorCode::no_such_frame) {
        Error error = answer.error();
        error.what = joined(error.what, ": ", name);
        return tl::unexpected(error);
    }
    return answer;
}

const SettingTable& ur_rtde_settings() {
    static const SettingTable table = entry::joined(
        {entry::text("address", "127.0.0.1", "the controller's"),
         entry::whole("port", 30004, 1, 65535, "of RTDE"),
         entry::whole("dashboard_port", 29999, 1, 65535, "of the dashboard server"),
         entry::whole("timeout_ms", 1000, 10, 60000, "for a connection and for every answer"),
         entry::whole("move_timeout_ms", 0, 0, 3600000, "for a move; 0: from its way and speed"),
         entry::number("frequency_hz", 125, 1, 500, "of the controller's state"),
         entry::whole("first_register", ur::kFirstRegister, 0, ur::kLastRegister + 1 - ur::kOutputs,
                      "first of the registers that the module uses, the same as in its program"),
         entry::whole("trigger_output", 0, 0, 7, "digital output that fires the sensor, for the program")},
        entry::reconnect(1, 100, 500, "retry_ms", "retry_most_ms"));
    return table;
}

Expected<std::unique_ptr<RobotLink>> open_ur_rtde(const nlohmann::json& settings, DeviceSession&) {
    RtdeSettings s;
    SettingsReader f(settings, "settings", ur_rtde_settings());
    f.text("address", s.address);
    f.whole("port", s.port);
    f.whole("dashboard_port", s.dashboard_port);
    f.whole("timeout_ms", s.timeout_ms);
    f.whole("move_timeout_ms", s.move_timeout_ms);
    f.number("frequency_hz", s.frequency_hz);
    f.whole("first_register", s.first_register);
    f.whole("reconnect_ms", s.reconnect_ms);
    f.whole("reconnect_most_ms", s.reconnect_most_ms);
    if (f.failed()) return tl::unexpected(f.error());
    return std::make_unique<RtdeLink>(s);
}

}  // namespace seamwright
