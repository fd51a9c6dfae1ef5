#include "devices/cyclic/link.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "devices/silence.h"

namespace seamwright {
namespace {
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
constexpr std::uint64_t kAcknowledged = 5;  // cycles in which the robot showed the whole correction
constexpr double kSameMm = 1e-6, kSameRad = 1e-8;

// Of "192.168.1.5:59152".
std::string address_of(const std::string& endpoint) {
    return endpoint.substr(0, endpoint.rfind(':'));
}
}  // namespace

SettingTable cyclic_settings(std::uint16_t port, double max_rotation_deg) {
    using namespace entry;
    return {text("listen", "127.0.0.1", "this computer's address in the robot's network"),
            whole("port", port, 0, 65535, "where the controller sends its packets"),
            text("robot_address", "", "the controller's; must be named unless listen is a loopback address"),
            whole("cycle_ms", 4, 1, 1000, "time between two packets"),
            whole("timeout_ms", 1000, 1, 60000, "for a packet"),
            whole("confirm_timeout_ms", 20000, 1, 600000, "for a whole ramp, until the robot shows it"),
            object("frames", {}, "NAME: {\"base_from_frame\": POSE as taught}"),
            pose("base_from_reference", "frame in which the controller tells poses: $BASE, the work object"),
            pose("flange_from_tcp", "tool whose TCP it tells"),
            number("max_translation_mm", 10, 0, 1000, "largest correction"),
            number("max_rotation_deg", max_rotation_deg, 0, 45, "largest correction"),
            number("speed_mm_s", 20, 1e-3, 1000, "of the ramp"),
            number("speed_deg_s", 2, 1e-3, 90, "of the ramp"),
            number("acceleration_mm_s2", 100, 1e-3, 1e5, "of the ramp"),
            number("acceleration_deg_s2", 10, 1e-3, 1e4, "of the ramp"),
            whole("max_late", 10, 1, 1000, "late packets until the correction is withdrawn"),
            whole("session_gap_ms", 500, 20, 60000, "silence after which the robot's session is another one"),
            number("max_path_speed_mm_s", 3000, 1, 1e5, "a position that jumps further is an alarm"),
            number("follow_tolerance_mm", 0.2, 1e-3, 10, "between what was told and what the robot shows"),
            number("follow_tolerance_deg", 0.1, 1e-4, 5, "between what was told and what the robot shows"),
            whole("follow_ms", 500, 10, 10000, "so long it may miss the tolerance"),
            object("measuring",
                   {text("driver", nullptr, "a robot driver"), object("settings", {}, "of that driver")},
                   "how the measuring program is run; without it the link only corrects")};
}

Expected<CyclicLinkSettings> parse_cyclic_settings(const nlohmann::json& settings, const SettingTable& table,
                                                   const std::string& driver) {
    CyclicLinkSettings r;
    r.driver = driver;
    CyclicSettings& s = r.server;
    SettingsReader f(settings, "", table);
    f.text("listen", s.listen);
    f.text("robot_address", s.robot_address);
    if (f.failed()) return tl::unexpected(f.error());
    SEAM_OK(check_robot_address(s.listen, s.robot_address));
    f.whole("port", s.port);
    f.whole("cycle_ms", s.cycle_ms);
    f.whole("timeout_ms", r.timeout_ms);
    f.whole("confirm_timeout_ms", r.confirm_timeout_ms);
    f.number("max_translation_mm", s.max_translation_mm);
    f.number("max_rotation_deg", s.max_rotation_deg);
    f.number("speed_mm_s", s.ramp.speed_mm_s);
    f.number("speed_deg_s", s.ramp.speed_deg_s);
    f.number("acceleration_mm_s2", s.ramp.acceleration_mm_s2);
    f.number("acceleration_deg_s2", s.ramp.acceleration_deg_s2);
    f.whole("max_late", s.max_late);
    f.whole("session_gap_ms", s.session_gap_ms);
    f.number("max_path_speed_mm_s", s.max_path_speed_mm_s);
    f.number("follow_tolerance_mm", s.follow_tolerance_mm);
    f.number("follow_tolerance_deg", s.follow_tolerance_deg);
    f.whole("follow_ms", s.follow_ms);
    f.pose("base_from_reference", r.base_from_reference);
    f.pose("flange_from_tcp", r.flange_from_tcp);
    f.object("frames", [&](SettingsReader& frames) {
        static const SettingTable frame = {entry::pose("base_from_frame", "as taught")};
        for (const auto& [name, value] : frames.json().items()) {
            SettingsReader taught(value, frames.path(name), frame);
            const auto field = json_field(value, "base_from_frame", frames.path(name));
            if (!taught.failed() && !field) taught.keep(tl::make_unexpected(field.error()));
            taught.pose("base_from_frame", r.taught[name]);
            if (taught.failed()) frames.keep(tl::make_unexpected(taught.error()));
        }
    });
    f.object("measuring", [&](SettingsReader& m) {
        const auto name = json_string(m.json(), "driver", "measuring");
        if (!name) return m.keep(tl::make_unexpected(name.error()));
        if (*name == "kuka-rsi" || *name == "abb-egm")
            return m.keep(input_error("a cyclic correction cannot measure", "measuring.driver",
                                      "name the driver that runs the measuring program"));
        r.measuring_driver = *name;
        if (m.has("settings")) r.measuring = m.json().at("settings");
    });
    if (f.failed()) return tl::unexpected(f.error());
    return r;
}

CyclicLink::CyclicLink(const CyclicLinkSettings& settings, std::unique_ptr<CyclicServer> server,
                       std::unique_ptr<RobotLink> measuring)
    : settings_(settings),
      server_(std::move(server)),
      measuring_(std::move(measuring)),
      written_(settings.taught) {}

CyclicLink::~CyclicLink() {
    // A robot that is still asking is led back; one that is not drops the correction by itself.
    server_->withdraw();
    const auto deadline = Clock::now() + milliseconds(settings_.confirm_timeout_ms);
    while (Clock::now() < deadline) {
        const CyclicServer::State state = server_->state();
        if (state.zero || state.age_ns > 100 * 1000000) break;
        std::this_thread::sleep_for(milliseconds(2));
    }
}

Expected<std::unique_ptr<CyclicLink>> CyclicLink::open(const CyclicLinkSettings& settings,
                                                       std::unique_ptr<CyclicProtocol> protocol,
                                                       OpenRobot open_robot, DeviceSession& session) {
    std::unique_ptr<RobotLink> measuring;
    if (!settings.measuring_driver.empty()) {
        if (!open_robot) return usage_error("no measuring link can be opened here", "measuring");
        SEAM_TRY(auto opened, open_robot(settings.measuring_driver, settings.measuring, session));
        measuring = std::move(opened);
    }
    CyclicLinkSettings own = settings;
    own.shifts_along = protocol->shifts_along();
    SEAM_TRY(auto server, CyclicServer::start(settings.server, std::move(protocol)));
    return std::unique_ptr<CyclicLink>(new CyclicLink(own, std::move(server), std::move(measuring)));
}

Expected<void> CyclicLink::no_alarm() {
    if (auto alarm = server_->take_alarm())
        return device_error(*alarm, settings_.driver, "the correction is withdrawn; look at the robot");
    return {};
}

Expected<CyclicServer::State> CyclicLink::fresh_state() {
    const auto deadline = Clock::now() + milliseconds(settings_.timeout_ms);
    const std::int64_t fresh_ns = std::max<std::int64_t>(20LL * settings_.server.cycle_ms, 100) * 1000000;
    while (true) {
        SEAM_OK(no_alarm());
        CyclicServer::State state = server_->state();
        if (state.age_ns >= 0 && state.age_ns < fresh_ns) {
            if (state.packet.problem) return device_error(state.packet.problem, settings_.driver);
            return state;
        }
        if (Clock::now() >= deadline)
            return device_error(
                ErrorCode::silence, Text("{}: no cyclic packet came to port {}", kNoAnswer, server_->port()),
                settings_.driver, "check that the robot's program has switched the correction on");
        std::this_thread::sleep_for(milliseconds(2));
    }
}

Expected<RobotIdentity> CyclicLink::identity() {
    SEAM_OK(no_alarm());
    const std::uint64_t session = server_->state().session;
    RobotIdentity identity{settings_.driver, settings_.brand, "", ""};
    if (measuring_) {
        auto told = measuring_->identity();
        if (!told) return told;
        identity = *told;
    } else if (auto state = fresh_state(); !state) {
        return tl::unexpected(state.error());
    }
    identified_ = Identified{identity, address_of(server_->robot()), session};
    return identity;
}

// Who answers may have changed since identity() was asked: nothing is written before it is known again.
Expected<void> CyclicLink::same_robot() {
    if (!identified_ || server_->state().session == identified_->session) return {};
    const Identified before = *identified_;
    SEAM_TRY(auto now, identity());
    if (now == before.identity && (before.address.empty() || identified_->address == before.address))
        return {};
    identified_ = before;
    return device_error(Text("the robot at {} is another one than at {}", server_->robot(), before.address),
                        settings_.driver, "open the project's robot again");
}

Expected<Permission> CyclicLink::permission() {
    SEAM_OK(no_alarm());
    switch (server_->state().path) {
        case PathPhase::none:
            return Permission::none;
        case PathPhase::waiting:
            return Permission::given;
        case PathPhase::running:
            return Permission::running;
        case PathPhase::over:
            return Permission::taken;
    }
    return Permission::none;
}

Expected<RobotMode> CyclicLink::mode() {
    SEAM_OK(no_alarm());
    if (measuring_) return measuring_->mode();
    SEAM_TRY(auto state, fresh_state());
    return state.packet.mode;
}

Expected<Pose> CyclicLink::base_from_flange() {
    auto state = fresh_state();
    if (!state) {
        // Between its corrections the robot sends nothing here; the measuring link knows.
        if (measuring_ && is_silence(state.error())) return measuring_->base_from_flange();
        return tl::unexpected(state.error());
    }
    const auto& tcp = state->packet.actual ? state->packet.actual : state->packet.programmed;
    if (!tcp)
        return device_error("the cyclic packets carry no position", settings_.driver,
                            "send the Cartesian actual position");
    return settings_.base_from_reference * *tcp * settings_.flange_from_tcp.inverse();
}

Expected<StartSignal> CyclicLink::wait_start(milliseconds timeout) {
    SEAM_OK(no_alarm());
    return measuring_ ? measuring_->wait_start(timeout) : RobotLink::wait_start(timeout);
}

Expected<void> CyclicLink::start_measuring(const std::vector<MeasuringMove>& moves) {
    SEAM_OK(no_alarm());
    if (!measuring_)
        return usage_error("a cyclic correction alone cannot measure", settings_.driver,
                           "name a measuring driver in the settings (\"measuring\")");
    SEAM_OK(back_to_zero());
    return measuring_->start_measuring(moves);
}

Expected<TriggerEvent> CyclicLink::wait_trigger(milliseconds timeout) {
    SEAM_OK(no_alarm());
    if (!measuring_) return usage_error("a cyclic correction alone has no triggers", settings_.driver);
    return measuring_->wait_trigger(timeout);
}

Expected<Pose> CyclicLink::read_frame(const std::string& name) {
    SEAM_OK(no_alarm());
    const auto it = written_.find(name);
    if (it == written_.end())
        return input_error("no frame of this name is in the settings", name, "add it under \"frames\"");
    return it->second;
}

Expected<void> CyclicLink::write_frame(const std::string& name, const Pose& base_from_frame) {
    SEAM_OK(no_alarm());
    SEAM_OK(same_robot());
    const auto taught = settings_.taught.find(name);
    if (taught == settings_.taught.end())
        return input_error("no frame of this name is in the settings", name, "add it under \"frames\"");
    if (!base_from_frame.matrix().allFinite()) return input_error("the frame is not finite", name);
    const Pose b = base_from_frame * taught->second.inverse();
    const double offset = (base_from_frame.translation() - taught->second.translation()).norm();
    const double turn = deg_from_rad(rotation_log(b.linear()).norm());
    const CyclicSettings& s = settings_.server;
    if (offset > s.max_translation_mm)
        return device_error(Text("refused: the correction of {:.3f} mm is beyond the limit of {:.3f} mm",
                                 offset, s.max_translation_mm),
                            name);
    if (turn > s.max_rotation_deg)
        return device_error(Text("refused: the correction of {:.4f} degrees is beyond the limit of {:.4f}",
                                 turn, s.max_rotation_deg),
                            name);
    written_[name] = base_from_frame;
    if (std::exchange(decided_, false)) of_part_.clear();
    of_part_.insert(name);
    return {};
}

// The robot's program comes from its measuring to its path, and begins to ask there. Of a robot without a measuring
// link nothing tells that it will come.
Expected<CyclicServer::State> CyclicLink::on_path(Clock::time_point until) {
    while (true) {
        auto state = fresh_state();
        const bool comes =
            state ? !state->packet.running && !state->packet.problem : is_silence(state.error());
        if (!measuring_ || !comes || Clock::now() >= until) return state;
        std::this_thread::sleep_for(milliseconds(2));
    }
}

Expected<void> CyclicLink::apply() {
    std::optional<Pose> b;
    std::string first;
    for (const std::string& name : of_part_) {
        const Pose frame = written_.at(name);
        const Pose taught = settings_.taught.at(name);
        const Pose of_this = frame * taught.inverse();
        // Compared at the frame, where it matters; far from it a rounded rotation has a long lever.
        if (b && ((*b * taught.translation() - frame.translation()).norm() > kSameMm ||
                  rotation_log(b->linear().transpose() * of_this.linear()).norm() > kSameRad))
            return device_error(Text("frames {} and {} want different corrections", first, name),
                                settings_.driver, "the controller holds one at a time");
        if (!b) {
            b = of_this;
            first = name;
        }
    }
    const auto deadline = Clock::now() + milliseconds(settings_.confirm_timeout_ms);
    auto state = on_path(deadline);
    if (!state) return tl::unexpected(state.error());
    if (state->packet.missing)
        return device_error(Text("the robot's packets carry no {}", state->packet.missing), settings_.driver,
                            "without it nobody knows what the robot does; send it too");
    if (!state->packet.running)
        return device_error("the controller does not take corrections: it is not running", settings_.driver,
                            "start its program");
    SEAM_OK(same_robot());
    const Pose& r = settings_.base_from_reference;
    server_->set_target(b ? Pose(r.inverse() * *b * r) : Pose::Identity());
    while (true) {
        SEAM_OK(no_alarm());
        state = fresh_state();
        if (!state) return tl::unexpected(state.error());
        if (state->steady > kAcknowledged) {
            server_->await_path();
            return {};
        }
        if (Clock::now() >= deadline) {
            if (const char* why = server_->why_not_told())
                return device_error(Text("the correction is not in force: {}", why), settings_.driver);
            return device_error(ErrorCode::silence, Text("{}: the correction is not in force", kNoAnswer),
                                settings_.driver);
        }
        std::this_thread::sleep_for(milliseconds(2));
    }
}

Expected<void> CyclicLink::back_to_zero() {
    server_->withdraw();
    const auto deadline = Clock::now() + milliseconds(settings_.confirm_timeout_ms);
    while (true) {
        const CyclicServer::State state = server_->state();
        // Where nobody asks, nothing is in force; what a robot holds that speaks again is judged then.
        if (state.zero || state.silent) return {};
        SEAM_OK(no_alarm());
        if (Clock::now() >= deadline)
            return device_error(ErrorCode::silence,
                                Text("{}: the correction could not be led back to zero", kNoAnswer),
                                settings_.driver, "stop the robot's program");
        std::this_thread::sleep_for(milliseconds(2));
    }
}

Expected<void> CyclicLink::confirm(PartVerdict verdict, const std::string& text) {
    if (auto ok = no_alarm(); !ok) {
        server_->withdraw();
        return ok;
    }
    decided_ = true;
    if (verdict == PartVerdict::corrected) server_->forget_path();
    auto done = verdict == PartVerdict::corrected ? apply() : back_to_zero();
    if (!done) {
        server_->withdraw();
        if (measuring_) (void)measuring_->confirm(PartVerdict::failed, done.error().what.english());
        return done;
    }
    if (!measuring_) return {};
    auto told = measuring_->confirm(verdict, text);
    if (!told) server_->withdraw();
    return told;
}

Expected<void> CyclicLink::move_to(const Pose& base_from_flange) {
    SEAM_OK(no_alarm());
    return measuring_ ? measuring_->move_to(base_from_flange) : RobotLink::move_to(base_from_flange);
}

std::vector<Text> CyclicLink::take_notices() {
    std::vector<Text> notices;
    if (measuring_) notices = measuring_->take_notices();
    const std::uint64_t strangers = server_->counters().strangers;
    if (strangers > strangers_told_)
        notices.push_back(Text("{} datagrams of an unknown peer were refused, the last of {}",
                               strangers - strangers_told_, server_->last_stranger()));
    strangers_told_ = strangers;
    for (Text& takeover : server_->take_takeovers()) notices.push_back(std::move(takeover));
    return notices;
}

}  // namespace seamwright
