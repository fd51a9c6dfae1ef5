// The RTDE connection: made, negotiated, kept up, its packages taken, the module asked.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "devices/host_time.h"
#include "devices/ur/rtde_link.h"

namespace seamwright {
namespace {

using rtde::Package;
using rtde::Recipe;
using ur::Command;

constexpr Timeout kStale{100};  // older state is waited for anew
constexpr Timeout kBeat{100};   // module.h
// While an answer is waited for: the module acts on the next beat after a request.
constexpr Timeout kAskingBeat{20};

Timeout left(std::chrono::steady_clock::time_point until) {
    return std::max(Timeout(0), std::chrono::ceil<Timeout>(until - std::chrono::steady_clock::now()));
}

std::vector<std::string> output_names(int first_register, bool with_offset) {
    std::vector<std::string> names = {"actual_TCP_pose", "robot_mode", "safety_mode", "runtime_state"};
    for (int i = 0; i < ur::kOutputs; ++i)
        names.push_back(fmt::format("output_int_register_{}", first_register + i));
    for (int i = 0; i < 6; ++i) names.push_back(fmt::format("output_double_register_{}", first_register + i));
    if (with_offset) names.emplace_back("tcp_offset");
    return names;
}

bool expected_kinds(const Recipe& r) {
    using rtde::Kind;
    std::vector<Kind> kinds = {Kind::vector6, Kind::int32, Kind::int32, Kind::uint32};
    kinds.insert(kinds.end(), ur::kOutputs, Kind::int32);
    kinds.insert(kinds.end(), 6, Kind::real);
    if (r.kinds.size() > kinds.size()) kinds.push_back(Kind::vector6);
    return r.kinds == kinds;
}

}  // namespace

// Between the calls: the module hears that somebody is there, and the controller's packages are taken.
void RtdeLink::keep(const std::stop_token& stop) {
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
Expected<void> RtdeLink::beat() {
    if (last_request_.empty() || Clock::now() < next_beat_) return {};
    return send_request();
}

Expected<void> RtdeLink::send_request() {
    std::vector<rtde::Value> values = last_request_;
    values[ur::kSession] = session_;
    values[ur::kBeat] = ++beats_;
    next_beat_ = Clock::now() + kBeat;
    const std::string bytes = rtde::package_bytes({rtde::Type::data, rtde::data_payload(inputs_, values)});
    if (auto sent = connection_->send(bytes_of(bytes), timeout_); !sent) return fail(sent.error());
    return {};
}

// What was asked is taken out of the registers, or a program that was paused would do it when it goes on.
tl::unexpected<Error> RtdeLink::fail(Error error) {
    if (connection_ && connection_->is_open() && !last_request_.empty()) {
        std::vector<rtde::Value> nothing = last_request_;
        nothing[ur::kCommand] = std::int32_t{0};
        const auto bytes = rtde::package_bytes({rtde::Type::data, rtde::data_payload(inputs_, nothing)});
        (void)connection_->send(bytes_of(bytes), kAskingBeat);
    }
    connection_.reset();
    dashboard_.close();  // of the same controller: who answers is asked there, so anew
    last_request_.clear();
    state_.reset();
    stream_.clear();
    error.where = where_;
    return tl::unexpected(std::move(error));
}

// The next package that is no text; the newest text is kept for those that end in failure.
Expected<Package> RtdeLink::receive(Clock::time_point until) {
    std::array<char, 4096> buffer;
    for (;;) {
        auto package = rtde::take_package(stream_);
        if (!package) return fail(package.error());
        if (*package) {
            if ((*package)->type != rtde::Type::text) return std::move(**package);
            said_ = rtde::text_of((*package)->payload, version_);
            continue;
        }
        const auto got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)), left(until));
        if (!got) return fail(got.error());
        stream_.append(buffer.data(), *got);
    }
}

Expected<Package> RtdeLink::request(const Package& question, Clock::time_point until) {
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

Expected<bool> RtdeLink::accepted(const Package& question, Clock::time_point until) {
    SEAM_TRY(auto answer, request(question, until));
    auto yes = rtde::accepted_of(answer.payload);
    if (!yes) return fail(yes.error());
    return yes;
}

Expected<Recipe> RtdeLink::recipe(const Package& question, const std::vector<std::string>& names,
                                  bool numbered, Clock::time_point until) {
    SEAM_TRY(auto answer, request(question, until));
    return rtde::recipe_of(answer.payload, names, numbered);
}

Expected<void> RtdeLink::negotiate(Clock::time_point until) {
    version_ = 2;
    SEAM_TRY(auto second, accepted({rtde::Type::protocol_version, rtde::version_payload(2)}, until));
    if (!second) {
        version_ = 1;
        SEAM_TRY(auto first, accepted({rtde::Type::protocol_version, rtde::version_payload(1)}, until));
        if (!first) return fail({ErrorKind::device, "the controller accepts neither RTDE 2 nor 1", {}, {}});
    }
    const bool numbered = version_ == 2;
    for (const bool with_offset : {true, false}) {
        const auto names = output_names(settings_.first_register, with_offset);
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
        return fail(
            {ErrorKind::device, "the answer gives the variables other types than the RTDE guide", {}, {}});
    SEAM_TRY(auto started, accepted({rtde::Type::start, {}}, until));
    if (!started)
        return fail({ErrorKind::device, Text("the controller refuses to start RTDE{}", heard()), {}, {}});
    return {};
}

Expected<void> RtdeLink::connected() {
    // Whoever asks next learns that the connection was lost meanwhile, before another is made.
    if (lost_) return tl::unexpected(*std::exchange(lost_, std::nullopt));
    if (connection_ && connection_->is_open()) return {};
    const auto done = back_off_.attempt([this] { return connect(); });
    if (!done)
        return device_error(ErrorCode::disconnected, Text("{}, the next attempt is due soon", kDisconnected),
                            where_, "check that the controller is on");
    if (!*done) return fail(done->error());
    robot_.connected_anew();
    return {};
}

Expected<void> RtdeLink::connect() {
    SEAM_TRY(auto made,
             TcpConnection::connect(settings_.address, static_cast<std::uint16_t>(settings_.port), timeout_));
    connection_.emplace(std::move(made));
    stream_.clear();
    said_.clear();
    // Far from the numbers of a connection that the module may still hold an unanswered request of.
    number_ = static_cast<std::int32_t>(host_now_ns() / 1000 % 1'000'000'000) + 1;
    session_ = number_;
    last_request_.clear();
    return negotiate(Clock::now() + timeout_);
}

Expected<void> RtdeLink::take(const Package& package) {
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

Expected<void> RtdeLink::next_state(Clock::time_point until) {
    SEAM_TRY(auto package, receive(until));
    SEAM_OK(take(package));
    return beat();
}

// What has come already.
Expected<void> RtdeLink::take_all() {
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
Expected<const RtdeLink::State*> RtdeLink::newest() {
    SEAM_OK(connected());
    SEAM_OK(take_all());
    if (!state_ || Clock::now() - state_->at > kStale) SEAM_OK(next_state(Clock::now() + timeout_));
    return &*state_;
}

// The next package from this moment on: how the robot stands now.
Expected<const RtdeLink::State*> RtdeLink::coming() {
    auto state = newest();
    if (!state) return state;
    SEAM_OK(next_state(Clock::now() + timeout_));
    return &*state_;
}

// The pose of the answer, where the command has one.
Expected<Pose> RtdeLink::ask(Command command, std::int32_t argument, std::int32_t high, std::int32_t low,
                             const std::array<double, 6>& pose, std::optional<Timeout> timeout) {
    SEAM_TRY(auto state, newest());
    if (!ur::is_module(state->numbers[ur::kModule]))
        return device_error("the module seamwright.script does not run", where_,
                            "load what `seamwright robot-program --brand ur` writes and start the program");
    if (state->runtime != kPlaying)
        return device_error("the controller's program is stopped or paused", where_,
                            "start its program on the controller");
    const std::int32_t before = state->numbers[ur::kAnswered];
    number_ = number_ >= 2'000'000'000 ? 1 : number_ + 1;
    last_request_ = {number_, static_cast<std::int32_t>(command), argument, high, low, 0, 0};
    for (const double v : pose) last_request_.emplace_back(v);
    const auto until = Clock::now() + timeout.value_or(timeout_);
    SEAM_OK(send_request());
    for (;;) {
        next_beat_ = std::min(next_beat_, Clock::now() + kAskingBeat);
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
            return fail({ErrorKind::device, Text("{} of the module", kNoAnswer), {}, {}, ErrorCode::silence});
    }
    if (const auto why = ur::refusal(state_->numbers[ur::kStatus]); !why.empty())
        return device_error(state_->numbers[ur::kStatus] == static_cast<std::int32_t>(ur::Status::no_frame)
                                ? ErrorCode::no_such_frame
                                : ErrorCode::none,
                            Text("the controller refuses: {}", why), where_);
    if (command != Command::read && command != Command::write && command != Command::trigger)
        return Pose::Identity();
    auto answer = ur::pose_from_ur(state_->pose, where_);
    if (!answer) return fail(answer.error());
    return answer;
}

}  // namespace seamwright
