// Seamwright's end of an RTDE connection.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "devices/backoff.h"
#include "devices/exchange/settings.h"
#include "devices/host_time.h"
#include "devices/net/socket.h"
#include "devices/robot_program.h"
#include "devices/same_robot.h"
#include "devices/silence.h"
#include "devices/ur/dashboard.h"
#include "devices/ur/module.h"
#include "devices/ur/rtde.h"
#include "devices/ur/rtde_message.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using rtde::Package;
using rtde::Recipe;
using ur::Command;

constexpr Timeout kStale{100};  // older state is waited for anew
constexpr Timeout kBeat{100};   // module.h
// What sw_teach() drives at least.
constexpr double kTeach_mm_s = 100, kTeach_deg_s = 10;
constexpr int kPlaying = 2;

struct RtdeSettings {
    std::string address;
    int port = 0, dashboard_port = 0, timeout_ms = 0, move_timeout_ms = 0, first_register = 0,
        reconnect_ms = 0, reconnect_most_ms = 0;
    double frequency_hz = 0;
};

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

class RtdeLink final : public RobotLink {
  public:
    explicit RtdeLink(RtdeSettings settings)
        : settings_(std::move(settings)),
          where_(fmt::format("ur-rtde {}:{}", settings_.address, settings_.port)),
          timeout_(settings_.timeout_ms),
          dashboard_(settings_.address, static_cast<std::uint16_t>(settings_.dashboard_port), timeout_),
          back_off_(Timeout(settings_.reconnect_ms), Timeout(settings_.reconnect_most_ms)),
          keeper_([this](const std::stop_token& stop) { keep(stop); }) {}

    Expected<RobotIdentity> identity() override {
        const std::lock_guard lock(mutex_);
        auto now = ask_identity();
        if (!now) return now;
        return robot_.told(*now);
    }

    Expected<RobotMode> mode() override {
        const std::lock_guard lock(mutex_);
        return present_mode();
    }

    Expected<RobotMode> present_mode() {
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

    Expected<Pose> base_from_flange() override {
        const std::lock_guard lock(mutex_);
        return flange();
    }

    Expected<Pose> flange() {
        SEAM_TRY(auto state, coming());
        if (state->bad_pose) return fail(*state->bad_pose);
        return state->base_from_tcp * state->flange_from_tcp.inverse();
    }

    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override {
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

    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
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

    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override {
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

    Expected<Pose> read_frame(const std::string& name) override {
        const std::lock_guard lock(mutex_);
        return named(name, ask(Command::read, ur::frame_number(name)));
    }

    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        const std::lock_guard lock(mutex_);
        if (!base_from_frame.matrix().allFinite() ||
            base_from_frame.translation().cwiseAbs().maxCoeff() > 1e5)
            return input_error("the frame is not finite or beyond 100 m", name);
        SEAM_OK(same_robot());
        auto written =
            named(name, ask(Command::write, ur::frame_number(name), 0, 0, ur::ur_pose(base_from_frame)));
        if (!written) return tl::unexpected(written.error());
        return {};
    }

    Expected<void> confirm(PartVerdict verdict, const std::string&) override {
        const std::lock_guard lock(mutex_);
        const bool released = verdict == PartVerdict::corrected;
        if (released) SEAM_OK(same_robot());
        SEAM_OK(ask(Command::verdict, released ? 1 : verdict == PartVerdict::refused ? 2 : 3));
        const auto state = ur::state_from(state_->numbers[ur::kState]);
        if (!state || (state->permitted != ur::Permitted::no) != released)
            return device_error("the controller did not keep the verdict", where_);
        return {};
    }

    Expected<Permission> permission() override {
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

    bool can_move() const override { return true; }
    Expected<void> move_to(const Pose& base_from_flange) override {
        const std::lock_guard lock(mutex_);
        if (!base_from_flange.matrix().allFinite()) return input_error("the pose is not finite", where_);
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

  private:
    Expected<RobotIdentity> ask_identity() {
        SEAM_TRY(auto model, dashboard_.ask("get robot model"));
        SEAM_TRY(auto serial, dashboard_.ask("get serial number"));
        return RobotIdentity{"ur-rtde", "Universal Robots", model, serial};
    }
    Expected<void> same_robot() {
        SEAM_OK(connected());
        return robot_.check([this] { return ask_identity(); }, where_);
    }

    static Timeout left(Clock::time_point until) {
        return std::max(Timeout(0), std::chrono::ceil<Timeout>(until - Clock::now()));
    }

    // The program stands or begins anew, or its measuring does: no trigger is to come. A program that is
    // paused goes on.
    bool measuring_ended(const State& s) const {
        constexpr std::uint32_t kStopping = 0, kStopped = 1;
        if (s.runtime == kStopping || s.runtime == kStopped || s.safety_mode >= 3) return true;
        const auto state = ur::state_from(s.numbers[ur::kState]);
        return told_ < spots_.size() && state && state->phase != ur::Phase::measures &&
               s.numbers[ur::kFired] <= static_cast<std::int32_t>(told_);
    }

    // Between the calls: the module hears that somebody is there, and the controller's packages are taken.
    void keep(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            std::this_thread::sleep_for(kBeat / 2);
            const std::unique_lock lock(mutex_, std::try_to_lock);
            if (!lock.owns_lock() || !connection_) continue;
            auto ok = take_all();
            if (ok) ok = beat();
            if (!ok) lost_ = ok.error();
        }
    }

    // The request is sent again as it was, with the next beat: none before the first on a connection.
    Expected<void> beat() {
        if (last_request_.empty() || Clock::now() < next_beat_) return {};
        return send_request();
    }
    Expected<void> send_request() {
        std::vector<rtde::Value> values = last_request_;
        values[ur::kSession] = session_;
        values[ur::kBeat] = ++beats_;
        next_beat_ = Clock::now() + kBeat;
        const std::string bytes =
            rtde::package_bytes({rtde::Type::data, rtde::data_payload(inputs_, values)});
        if (auto sent = connection_->send(bytes_of(bytes), timeout_); !sent) return fail(sent.error());
        return {};
    }

    tl::unexpected<Error> fail(Error error) {
        connection_.reset();
        dashboard_.close();  // of the same controller: who answers is asked there, so anew
        last_request_.clear();
        state_.reset();
        stream_.clear();
        error.where = where_;
        return tl::unexpected(std::move(error));
    }

    Expected<Pose> named(const std::string& name, Expected<Pose> answer) const {
        if (!answer && answer.error().code == ErrorCode::no_such_frame) {
            Error error = answer.error();
            error.what = joined(error.what, ": ", name);
            return tl::unexpected(error);
        }
        return answer;
    }

    // The next package that is no text; the newest text is kept for those that end in failure.
    Expected<Package> receive(Clock::time_point until) {
        std::array<char, 4096> buffer;
        for (;;) {
            auto package = rtde::take_package(stream_);
            if (!package) return fail(package.error());
            if (*package) {
                if ((*package)->type != rtde::Type::text) return std::move(**package);
                said_ = rtde::text_of((*package)->payload, version_);
                continue;
            }
            const auto got =
                connection_->receive_some(std::as_writable_bytes(std::span(buffer)), left(until));
            if (!got) return fail(got.error());
            stream_.append(buffer.data(), *got);
        }
    }

    Expected<Package> request(const Package& question, Clock::time_point until) {
        if (auto sent = connection_->send(bytes_of(rtde::package_bytes(question)), left(until)); !sent)
            return fail(sent.error());
        for (;;) {
            auto answer = receive(until);
            if (!answer || answer->type == question.type) return answer;
            if (answer->type != rtde::Type::data)
                return fail({ErrorKind::device,
                             fmt::format("answer {} came to request {}", static_cast<int>(answer->type),
                                         static_cast<int>(question.type)),
                             where_, "only RTDE of Universal Robots listens there"});
        }
    }

    Expected<bool> accepted(const Package& question, Clock::time_point until) {
        SEAM_TRY(auto answer, request(question, until));
        auto yes = rtde::accepted_of(answer.payload);
        if (!yes) return fail(yes.error());
        return yes;
    }

    Expected<Recipe> recipe(const Package& question, const std::vector<std::string>& names, bool numbered,
                            Clock::time_point until) {
        SEAM_TRY(auto answer, request(question, until));
        return rtde::recipe_of(answer.payload, names, numbered);
    }

    std::vector<std::string> output_names(bool with_offset) const {
        std::vector<std::string> names = {"actual_TCP_pose", "robot_mode", "safety_mode", "runtime_state"};
        for (int i = 0; i < ur::kOutputs; ++i)
            names.push_back(fmt::format("output_int_register_{}", settings_.first_register + i));
        for (int i = 0; i < 6; ++i)
            names.push_back(fmt::format("output_double_register_{}", settings_.first_register + i));
        if (with_offset) names.emplace_back("tcp_offset");
        return names;
    }

    static bool expected_kinds(const Recipe& r) {
        using rtde::Kind;
        std::vector<Kind> kinds = {Kind::vector6, Kind::int32, Kind::int32, Kind::uint32};
        kinds.insert(kinds.end(), ur::kOutputs, Kind::int32);
        kinds.insert(kinds.end(), 6, Kind::real);
        if (r.kinds.size() > kinds.size()) kinds.push_back(Kind::vector6);
        return r.kinds == kinds;
    }

    Expected<void> negotiate(Clock::time_point until) {
        version_ = 2;
        SEAM_TRY(auto second, accepted({rtde::Type::protocol_version, rtde::version_payload(2)}, until));
        if (!second) {
            version_ = 1;
            SEAM_TRY(auto first, accepted({rtde::Type::protocol_version, rtde::version_payload(1)}, until));
            if (!first)
                return fail({ErrorKind::device, "the controller accepts neither RTDE 2 nor 1", {}, {}});
        }
        const bool numbered = version_ == 2;
        for (const bool with_offset : {true, false}) {
            const auto names = output_names(with_offset);
            auto outputs = recipe(
                {rtde::Type::setup_outputs, rtde::outputs_request(names, version_, settings_.frequency_hz)},
                names, numbered, until);
            if (!outputs && with_offset && connection_) continue;
            if (!outputs) return fail(outputs.error());
            outputs_ = std::move(*outputs);
            break;
        }
        std::vector<std::string> names;
        for (int i = 0; i < ur::kInputs; ++i)
            names.push_back(fmt::format("input_int_register_{}", settings_.first_register + i));
        for (int i = 0; i < 6; ++i)
            names.push_back(fmt::format("input_double_register_{}", settings_.first_register + i));
        auto inputs = recipe({rtde::Type::setup_inputs, rtde::inputs_request(names)}, names, true, until);
        if (!inputs) return fail(inputs.error());
        inputs_ = std::move(*inputs);
        std::vector<rtde::Kind> kinds(ur::kInputs, rtde::Kind::int32);
        kinds.insert(kinds.end(), 6, rtde::Kind::real);
        if (!expected_kinds(outputs_) || inputs_.kinds != kinds)
            return fail({ErrorKind::device,
                         "the answer gives the variables other types than the RTDE guide",
                         {},
                         {}});
        SEAM_TRY(auto started, accepted({rtde::Type::start, {}}, until));
        if (!started)
            return fail({ErrorKind::device, Text("the controller refuses to start RTDE{}", heard()), {}, {}});
        return {};
    }

    Text heard() const { return said_.empty() ? Text() : Text(", saying: {}", said_); }

    Expected<void> connected() {
        // Whoever asks next learns that the connection was lost meanwhile, before another is made.
        if (lost_) return tl::unexpected(*std::exchange(lost_, std::nullopt));
        if (connection_ && connection_->is_open()) return {};
        const auto done = back_off_.attempt([this] { return connect(); });
        if (!done)
            return device_error(ErrorCode::disconnected,
                                Text("{}, the next attempt is due soon", kDisconnected), where_,
                                "check that the controller is on");
        if (!*done) return fail(done->error());
        robot_.connected_anew();
        return {};
    }

    Expected<void> connect() {
        SEAM_TRY(auto made, TcpConnection::connect(settings_.address,
                                                   static_cast<std::uint16_t>(settings_.port), timeout_));
        connection_.emplace(std::move(made));
        stream_.clear();
        said_.clear();
        // Far from the numbers of a connection that the module may still hold an unanswered request of.
        number_ = static_cast<std::int32_t>(host_now_ns() / 1000 % 1'000'000'000) + 1;
        session_ = number_;
        last_request_.clear();
        return negotiate(Clock::now() + timeout_);
    }

    Expected<void> take(const Package& package) {
        if (package.type != rtde::Type::data)
            return fail({ErrorKind::device,
                         fmt::format("answer {} came and nothing was asked", static_cast<int>(package.type)),
                         {},
                         {}});
        auto values = rtde::values_of(package.payload, outputs_);
        if (!values) return fail(values.error());
        State s;
        const auto vector = [&](std::size_t i) { return std::get<std::array<double, 6>>((*values)[i]); };
        auto tcp = ur::pose_from_ur(vector(0), where_);
        if (tcp)
            s.base_from_tcp = *tcp;
        else
            s.bad_pose = tcp.error();
        s.robot_mode = std::get<std::int32_t>((*values)[1]);
        s.safety_mode = std::get<std::int32_t>((*values)[2]);
        s.runtime = std::get<std::uint32_t>((*values)[3]);
        for (std::size_t i = 0; i < s.numbers.size(); ++i)
            s.numbers[i] = std::get<std::int32_t>((*values)[4 + i]);
        for (std::size_t i = 0; i < 6; ++i) s.pose[i] = std::get<double>((*values)[4 + s.numbers.size() + i]);
        if (const std::size_t at = 4 + s.numbers.size() + 6; at < values->size()) {
            auto offset = ur::pose_from_ur(vector(at), where_);
            if (offset)
                s.flange_from_tcp = *offset;
            else
                s.bad_pose = offset.error();
        }
        s.at = Clock::now();
        if (s.numbers[ur::kCall] == 0) quiet_ns_ = host_now_ns();
        state_ = s;
        return {};
    }

    Expected<void> next_state(Clock::time_point until) {
        SEAM_TRY(auto package, receive(until));
        SEAM_OK(take(package));
        return beat();
    }

    // What has come already.
    Expected<void> take_all() {
        std::array<char, 4096> buffer;
        for (;;) {
            const auto got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)), Timeout(0));
            if (!got && !is_silence(got.error())) return fail(got.error());
            if (got) stream_.append(buffer.data(), *got);
            for (;;) {
                auto package = rtde::take_package(stream_);
                if (!package) return fail(package.error());
                if (!*package) break;
                if ((*package)->type == rtde::Type::text)
                    said_ = rtde::text_of((*package)->payload, version_);
                else if (auto taken = take(**package); !taken)
                    return taken;
            }
            if (!got) return {};
        }
    }

    // What has come already, and the next package where that is too old.
    Expected<const State*> newest() {
        SEAM_OK(connected());
        SEAM_OK(take_all());
        if (!state_ || Clock::now() - state_->at > kStale) SEAM_OK(next_state(Clock::now() + timeout_));
        return &*state_;
    }

    // The next package from this moment on: how the robot stands now.
    Expected<const State*> coming() {
        auto state = newest();
        if (!state) return state;
        SEAM_OK(next_state(Clock::now() + timeout_));
        return &*state_;
    }

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

    // The pose of the answer, where the command has one.
    Expected<Pose> ask(Command command, std::int32_t argument = 0, std::int32_t high = 0,
                       std::int32_t low = 0, const std::array<double, 6>& pose = {},
                       std::optional<Timeout> timeout = {}) {
        SEAM_TRY(auto state, newest());
        if (!ur::is_module(state->numbers[ur::kModule]))
            return device_error(
                "the module seamwright.script does not run", where_,
                "load what `seamwright robot-program --brand ur` writes and start the program");
        const std::int32_t before = state->numbers[ur::kAnswered];
        number_ = number_ >= 2'000'000'000 ? 1 : number_ + 1;
        last_request_ = {number_, static_cast<std::int32_t>(command), argument, high, low, 0, 0};
        for (const double v : pose) last_request_.emplace_back(v);
        const auto until = Clock::now() + timeout.value_or(timeout_);
        SEAM_OK(send_request());
        for (;;) {
            SEAM_OK(next_state(std::min(until, Clock::now() + timeout_)));
            const std::int32_t answered = state_->numbers[ur::kAnswered];
            if (answered == number_) break;
            if (answered != before)
                return fail({ErrorKind::device,
                             fmt::format("answer {} came to request {}", answered, number_),
                             {},
                             "only one program may use these registers"});
            if (state_->runtime != kPlaying)  // the program stopped while it was at it
                return fail(
                    {ErrorKind::device, "the controller's program was stopped before it answered", {}, {}});
            if (Clock::now() >= until)
                return fail(
                    {ErrorKind::device, Text("{} of the module", kNoAnswer), {}, {}, ErrorCode::silence});
        }
        if (const auto why = ur::refusal(state_->numbers[ur::kStatus]); !why.empty())
            return device_error(
                state_->numbers[ur::kStatus] == static_cast<std::int32_t>(ur::Status::no_frame)
                    ? ErrorCode::no_such_frame
                    : ErrorCode::none,
                Text("the controller refuses: {}", why), where_);
        if (command != Command::read && command != Command::write && command != Command::trigger)
            return Pose::Identity();
        auto answer = ur::pose_from_ur(state_->pose, where_);
        if (!answer) return fail(answer.error());
        return answer;
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
    Recipe outputs_, inputs_;
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

}  // namespace

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
