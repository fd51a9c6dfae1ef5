// A Gocator: commands on the control connection, exposures from the data connection.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>

#include "devices/backoff.h"
#include "devices/exchange/settings.h"
#include "devices/gocator/ascii_result.h"
#include "devices/gocator/gdp_message.h"
#include "devices/gocator/gocator.h"
#include "devices/gocator/gocator_group.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPingPeriod{1};
constexpr const char* kLookAtSensor = "check power, cable and address of the sensor";

struct Settings {
    std::string address, output, serial;
    std::uint16_t control_port = 0, data_port = 0;
    int source = 0;
    std::vector<std::pair<int, int>> points{{0, 1}};
    gocator::AsciiFormat format;
    bool hardware_trigger = false;
    Timeout timeout{}, start_timeout{}, reconnect{}, reconnect_most{};
    std::size_t buffers = 0;
    bool ascii() const { return output == "ascii"; }
};

Expected<std::vector<std::pair<int, int>>> points_from(const nlohmann::json& json, const std::string& where) {
    std::vector<std::pair<int, int>> points;
    const auto is_id = [](const nlohmann::json& j) {
        return j.is_number_integer() && j.get<std::int64_t>() >= 0 && j.get<std::int64_t>() < 100000;
    };
    if (json.is_array())
        for (const auto& pair : json) {
            if (!pair.is_array() || pair.size() != 2 || !is_id(pair[0]) || !is_id(pair[1])) {
                points.clear();
                break;
            }
            points.emplace_back(pair[0].get<int>(), pair[1].get<int>());
        }
    if (points.empty() || points.size() > 1000)
        return input_error("must be pairs of the ids of measurements, X and Z", where, "as in [[0, 1]]");
    return points;
}

Expected<Settings> settings_from(const nlohmann::json& json) {
    Settings s;
    SettingsReader read(json, "settings", gocator_settings());
    read.text("address", s.address);
    read.text("output", s.output);
    read.text("serial", s.serial);
    read.whole("control_port", s.control_port);
    read.whole("data_port", s.data_port);
    read.whole("source", s.source);
    read.text("format", s.format.pattern);
    read.text("delimiter", s.format.delimiter);
    read.text("terminator", s.format.terminator);
    read.text("invalid", s.format.invalid);
    read.truth("hardware_trigger", s.hardware_trigger);
    read.duration("timeout_ms", s.timeout);
    read.duration("start_timeout_ms", s.start_timeout);
    read.duration("reconnect_ms", s.reconnect);
    read.duration("reconnect_most_ms", s.reconnect_most);
    read.whole("buffers", s.buffers);
    if (read.failed()) return tl::unexpected(read.error());
    if (s.address.empty())
        return input_error("the address of the sensor is missing", "settings.address",
                           "as in \"192.168.1.10\"");
    if (json.contains("points")) {
        SEAM_TRY(auto points, points_from(json.at("points"), "settings.points"));
        s.points = std::move(points);
    }
    SEAM_OK(gocator::check_format(s.format));
    if (s.data_port == 0) s.data_port = s.ascii() ? gocator::kAsciiPort : gdp::kDataPort;
    s.start_timeout = std::max(s.timeout, s.start_timeout);
    return s;
}

class GocatorSource final : public ProfileSource {
  public:
    explicit GocatorSource(Settings settings) : s_(std::move(settings)), pool_(s_.buffers) {}
    ~GocatorSource() override { end(); }

    Expected<void> connect() {
        const std::lock_guard control(control_mutex_);
        auto connection = TcpConnection::connect(s_.address, s_.control_port, s_.timeout);
        if (!connection) return of_sensor(connection.error(), s_.control_port);
        control_.emplace(std::move(*connection));
        control_stream_.clear();
        late_answers_.clear();
        gdp::Command command = gdp::Command::system_info;
        auto answer = ask(command);
        if (answer && answer->status != gdp::kDone) answer = ask(command = gdp::Command::system_info_v1);
        if (!answer) return tl::unexpected(answer.error());
        if (answer->status != gdp::kDone) return refused("tell its serial number", answer->status);
        SEAM_TRY(auto info, gdp::parse_system_info(command, answer->answer));
        if (info.state < 0)
            return device_error("the sensor misses its buddy", where(),
                                "connect the second sensor, or remove it on the sensor's own page");
        const std::string& wanted = identity_.serial.empty() ? s_.serial : identity_.serial;
        if (!wanted.empty() && wanted != info.serial)
            return device_error(
                Text("the sensor with the serial number {} answers, not {}", info.serial, wanted), where(),
                "check address and cabling");
        const std::lock_guard lock(mutex_);
        identity_ = {"gocator", "LMI Technologies", info.model, info.serial};
        return {};
    }

    SensorIdentity identity() const override {
        const std::lock_guard lock(mutex_);
        return identity_;
    }

    Expected<void> start() override {
        end();
        const std::lock_guard stream(stream_mutex_);
        auto started = connected() ? Expected<void>() : connect();
        if (started) started = begin();
        if (!started) lost();
        running_ = started.has_value();
        return started;
    }

    void stop() override {
        given_up_ = true;  // a reconnection under way
        end();
        given_up_ = false;
    }

    void give_up() override { given_up_ = true; }

    Expected<void> trigger(const std::string& spot_id) override {
        if (!running_) return device_error("the sensor is not started", where());
        if (s_.hardware_trigger)
            return usage_error("the sensor is fired by its digital input", where(),
                               "switch hardware_trigger off to fire it from here");
        {
            const std::lock_guard lock(mutex_);
            waiting_spots_.push_back(spot_id);  // the frame may come before the answer
        }
        auto answer = ask(gdp::Command::trigger);
        if (answer && answer->status == gdp::kDone) return {};
        {
            const std::lock_guard lock(mutex_);
            if (!waiting_spots_.empty()) waiting_spots_.pop_back();
        }
        if (!answer) return tl::unexpected(answer.error());
        return refused("be triggered: is its job set to software triggers?", answer->status);
    }

    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
        const std::lock_guard stream(stream_mutex_);
        if (!running_) return device_error("the sensor is not started", where());
        const auto until = Clock::now() + timeout;
        if (!data_) SEAM_OK(reconnect());
        for (;;) {
            auto frame = next_in_stream();
            if (!frame) {
                lost();
                return tl::unexpected(frame.error());
            }
            if (*frame) return *frame;
            const auto left = std::chrono::duration_cast<Timeout>(until - Clock::now());
            if (left.count() <= 0) break;
            std::array<std::byte, 65536> buffer;
            const auto got = data_->receive_some(buffer, left);
            if (!got && is_silence(got.error())) break;
            if (!got) {
                lost();
                return device_error(ErrorCode::disconnected, kDisconnected, where(), kLookAtSensor);
            }
            stream_.append(reinterpret_cast<const char*>(buffer.data()), *got);
        }
        if (Clock::now() >= next_ping_) {
            next_ping_ = Clock::now() + kPingPeriod;
            if (auto pong = ping(); !pong) {
                lost();
                return tl::unexpected(pong.error());
            }
        }
        return device_error(
            ErrorCode::silence, Text("{}: no frame within {} ms", kNoAnswer, timeout.count()), where(),
            passed_over_ ? "its job sends no profile of this source: tick it on its Output page"
                         : "let the robot measure or trigger the sensor");
    }

    FramePtr latest() const override {
        const std::lock_guard lock(mutex_);
        return latest_;
    }
    SourceCounters counters() const override {
        const std::lock_guard lock(mutex_);
        return counters_;
    }
    Expected<void> answers() override {
        auto pong = ping();
        if (!pong) lost();
        return pong;
    }
    std::vector<ParameterInfo> parameters() const override { return {}; }
    Expected<double> get(const std::string& parameter) const override { return no_parameter(parameter); }
    Expected<void> set(const std::string& parameter, double) override { return no_parameter(parameter); }

  private:
    Expected<void> ping() {
        if (ask(gdp::Command::ping, std::string(8, '\0'))) return {};
        return device_error(ErrorCode::disconnected, Text("{}: it does not answer", kDisconnected), where(),
                            kLookAtSensor);
    }
    void end() {
        const std::lock_guard stream(stream_mutex_);  // wait_next() comes to its end first
        // Nothing waits for the job's end but the next start, which asks for it again.
        if (running_ && connected()) (void)ask(gdp::Command::stop);
        running_ = false;
        data_.reset();
        ready_.clear();
        const std::lock_guard lock(mutex_);
        waiting_spots_.clear();
    }

    Text where() const { return Text("Gocator {}:{}", s_.address, s_.control_port); }
    tl::unexpected<Error> no_parameter(const std::string& name) const {
        return usage_error(Text("there is no parameter \"{}\"", name), where(),
                           "set it on the sensor's own page");
    }
    tl::unexpected<Error> refused(const Text& what, std::int32_t status) const {
        return device_error(Text("the sensor refuses to {} (status {})", what, status), where());
    }

    bool connected() {
        const std::lock_guard control(control_mutex_);
        return control_.has_value();
    }

    // The transport speaks of whoever is on the other side.
    tl::unexpected<Error> of_sensor(Error error, std::uint16_t port) const {
        error.where = fmt::format("Gocator {}:{}", s_.address, port);
        error.mend = kLookAtSensor;
        return tl::unexpected(std::move(error));
    }

    Expected<gdp::Reply> ask(gdp::Command command, std::string_view arguments = {}) {
        return ask(command, arguments, s_.timeout, false);
    }
    Expected<gdp::Reply> ask(gdp::Command command, std::string_view arguments, Timeout timeout,
                             bool until_given_up) {
        constexpr Timeout kSlice{50};
        const std::lock_guard control(control_mutex_);
        if (!control_) return device_error(ErrorCode::disconnected, kDisconnected, where(), kLookAtSensor);
        if (auto sent = control_->send(bytes_of(gdp::command_bytes(command, arguments)), s_.timeout); !sent)
            return of_sensor(sent.error(), s_.control_port);
        const auto until = Clock::now() + timeout;
        for (;;) {
            SEAM_TRY(auto reply, gdp::take_reply(control_stream_));
            if (reply) {
                auto& late = late_answers_[reply->command];
                if (late > 0)
                    --late;  // to a command given up
                else if (reply->command == static_cast<std::uint16_t>(command))
                    return *reply;
                continue;
            }
            const auto left = std::chrono::duration_cast<Timeout>(until - Clock::now());
            if (left.count() <= 0 || (until_given_up && given_up_)) {
                ++late_answers_[static_cast<std::uint16_t>(command)];
                if (left.count() > 0) return device_error("given up before the sensor answered", where());
                return device_error(ErrorCode::silence, kNoAnswer, where(), kLookAtSensor);
            }
            std::array<std::byte, 4096> buffer;
            const auto got = control_->receive_some(buffer, std::min(left, kSlice));
            if (!got && is_silence(got.error())) continue;
            if (!got) return of_sensor(got.error(), s_.control_port);
            control_stream_.append(reinterpret_cast<const char*>(buffer.data()), *got);
        }
    }

    // Starts or stops the job, for which a sensor takes its time.
    Expected<gdp::Reply> ask_job(gdp::Command command) {
        auto answer = ask(command, {}, s_.start_timeout, true);
        if (!answer && is_silence(answer.error()))
            return device_error(ErrorCode::silence,
                                Text("{}: the sensor did not {} its job within {:g} s", kNoAnswer,
                                     command == gdp::Command::start ? "start" : "stop",
                                     static_cast<double>(s_.start_timeout.count()) / 1000),
                                where(),
                                "look on the sensor's own page; start_timeout_ms is how long to wait");
        return answer;
    }

    // Stopped first, so that its frames count from zero, and the data connection made in between, so that
    // nothing of before comes.
    Expected<void> begin() {
        SEAM_OK(ask_job(gdp::Command::stop));
        auto data = TcpConnection::connect(s_.address, s_.data_port, s_.timeout);
        if (!data) return of_sensor(data.error(), s_.data_port);
        data_.emplace(std::move(*data));
        stream_.clear();
        group_ = {};
        offset_ = next_;
        passed_over_ = false;
        next_ping_ = Clock::now() + kPingPeriod;
        SEAM_TRY(auto started, ask_job(gdp::Command::start));
        if (started.status != gdp::kDone) return refused("start its job", started.status);
        return {};
    }

    void lost() {
        data_.reset();
        {
            const std::lock_guard control(control_mutex_);
            control_.reset();
        }
        const std::lock_guard lock(mutex_);
        waiting_spots_.clear();
    }

    Expected<void> reconnect() {
        const auto made = back_off_.attempt([this]() -> Expected<void> {
            SEAM_OK(connect());
            return begin();
        });
        if (!made) return device_error(ErrorCode::disconnected, kDisconnected, where(), kLookAtSensor);
        if (!*made) {
            lost();
            if (is_disconnect(made->error()) || is_silence(made->error()))
                return device_error(ErrorCode::disconnected, kDisconnected, where(), kLookAtSensor);
            return *made;
        }
        const std::lock_guard lock(mutex_);
        ++counters_.reconnects;
        return {};
    }

    // The next frame that is whole in the stream; nullptr: more bytes are needed.
    Expected<FramePtr> next_in_stream() {
        for (;;) {
            if (!ready_.empty()) {
                FramePtr frame = std::move(ready_.front());
                ready_.pop_front();
                return frame;
            }
            if (s_.ascii()) {
                SEAM_TRY(auto line, gocator::take_line(stream_, s_.format));
                if (!line) return FramePtr();
                take_line(*line);
                continue;
            }
            SEAM_TRY(auto message, gdp::take_message(stream_));
            if (!message) return FramePtr();
            SEAM_OK(take_message(*message));
        }
    }

    // What comes on the data port is of the sensor that answered on the control port.
    Expected<void> check_serial(const gdp::Stamp& stamp) const {
        const bool buddy = s_.source != 0;
        if (stamp.serial == 0 || buddy || std::strtoul(identity_.serial.c_str(), nullptr, 10) == stamp.serial)
            return {};
        return device_error(
            Text("the data are of sensor {}, connected is {}", stamp.serial, identity_.serial), where(),
            "check address and data port of the sensor");
    }

    Expected<void> take_message(const gdp::Message& message) {
        group_.take(message, s_.source);
        if (!message.last) return {};
        GocatorGroup group = std::move(group_);
        group_ = {};
        for (const gdp::Stamp& stamp : group.stamps) SEAM_OK(check_serial(stamp));
        if (group.unclear()) {
            const auto number = group.stamps.empty() ? next_ : offset_ + group.stamps.front().frame;
            deliver(number, 0, FrameStatus::corrupt, nullptr);
            return {};
        }
        if (group.profiles.empty()) {
            passed_over_ = true;
            return {};
        }
        for (std::size_t i = 0; i < group.profiles.size(); ++i) {
            Profile& profile = group.profiles[i];
            if (i < group.intensities.size() && group.intensities[i].size() == profile.size())
                profile.intensity = std::move(group.intensities[i]);
            const gdp::Stamp& stamp = group.stamps[i];
            deliver(offset_ + stamp.frame, static_cast<std::int64_t>(stamp.timestamp_us) * 1000,
                    FrameStatus::ok, &profile);
        }
        return {};
    }

    void take_line(const std::string& line) {
        if (line == "OK" || line.starts_with("OK" + s_.format.delimiter) || line.starts_with("ERROR"))
            return;  // answers to somebody's commands on the same port
        auto result = gocator::parse_result(line, s_.format);
        if (!result) return deliver(next_, 0, FrameStatus::corrupt, nullptr);
        Profile profile;
        for (const auto& [x_id, z_id] : s_.points) {
            const auto x = result->value_mm.find(x_id), z = result->value_mm.find(z_id);
            const bool seen = x != result->value_mm.end() && z != result->value_mm.end();
            profile.x_mm.push_back(seen ? x->second : std::nan(""));
            profile.z_mm.push_back(seen ? z->second : std::nan(""));
        }
        const auto number = result->frame && *result->frame >= 0
                                ? offset_ + static_cast<std::uint64_t>(*result->frame)
                                : next_;
        deliver(number, result->time_us.value_or(0) * 1000, FrameStatus::ok, &profile);
    }

    void deliver(std::uint64_t number, std::int64_t device_ns, FrameStatus status, Profile* profile) {
        // A number out of line is the sensor's restart by somebody else, not a million lost frames.
        constexpr std::uint64_t kMostLost = 1000;
        if (number < next_ || number - next_ > kMostLost) {
            offset_ += next_ - number;  // unsigned: also backwards
            number = next_;
        }
        const std::uint64_t gap = number - next_;
        next_ = number + 1;
        FramePtr frame = pool_.acquire();
        const std::lock_guard lock(mutex_);
        for (std::uint64_t i = 0; i < gap && !waiting_spots_.empty(); ++i) waiting_spots_.pop_front();
        std::string spot;
        if (!waiting_spots_.empty()) {
            spot = std::move(waiting_spots_.front());
            waiting_spots_.pop_front();
        }
        counters_.lost += gap;
        if (!frame) {
            ++counters_.underrun;
            return;
        }
        ++(status == FrameStatus::ok ? counters_.completed : counters_.damaged);
        frame->status = status;
        frame->sequence = number;
        frame->device_time_ns = device_ns;
        frame->host_time_ns =
            std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
        frame->base_from_flange.reset();
        frame->spot_id = std::move(spot);
        frame->image = {};
        frame->profile.clear();
        if (profile) frame->profile = std::move(*profile);
        latest_ = frame;
        ready_.push_back(std::move(frame));
    }

    const Settings s_;
    FramePool pool_;
    std::mutex stream_mutex_;             // data connection and what is made of it; taken first
    std::recursive_mutex control_mutex_;  // control connection: commands come from two threads
    std::optional<TcpConnection> control_, data_;
    std::string control_stream_, stream_;
    std::map<std::uint16_t, int> late_answers_;  // of commands that were not waited for to the end
    std::atomic<bool> running_ = false, given_up_ = false;
    bool passed_over_ = false;
    GocatorGroup group_;
    std::deque<FramePtr> ready_;
    std::uint64_t next_ = 0, offset_ = 0;  // sequence of the next frame; of the sensor's frame 0
    Clock::time_point next_ping_{};
    Backoff back_off_{s_.reconnect, s_.reconnect_most};
    mutable std::mutex mutex_;               // what follows
    std::deque<std::string> waiting_spots_;  // of software triggers whose frames have not come
    SensorIdentity identity_;
    SourceCounters counters_;
    FramePtr latest_;
};

}  // namespace

const SettingTable& gocator_settings() {
    const gocator::AsciiFormat ascii;
    static const SettingTable table = entry::joined(
        {entry::text("address", nullptr, "of the sensor, must be given"),
         entry::choice(
             "output", {"profiles", "ascii"},
             "whole profiles (tick them on the sensor's Output page), or what the sensor's own tools "
             "measured, as a profile of a few points"),
         entry::yes_no("hardware_trigger", false, "the robot fires the sensor's digital input"),
         entry::whole("control_port", gdp::kControlPort, 1, 65535, "of the sensor's commands"),
         entry::whole("data_port", nullptr, 1, 65535, "3196 of profiles, 8190 of ascii"),
         entry::whole("source", 0, 0, 3, "of profiles: 0 top, 1 bottom, 2 top left, 3 top right"),
         entry::list(
             "points", nlohmann::json{{0, 1}},
             "of ascii: ids of the measurements X and Z of each point; feature kind sensor-point takes "
             "one of them"),
         entry::text("format", ascii.pattern, "of ascii, as set on the sensor"),
         entry::text("delimiter", ascii.delimiter, "of ascii, as set on the sensor"),
         entry::text("terminator", ascii.terminator, "of ascii, as set on the sensor"),
         entry::text("invalid", ascii.invalid, "of ascii, as set on the sensor"),
         entry::text("serial", "", "another sensor is refused"),
         entry::whole("timeout_ms", 1000, 50, 60000, "for an answer"),
         entry::whole("start_timeout_ms", 15000, 50, 120000, "for the answers to start and stop"),
         entry::whole("buffers", 8, 2, 1000, "frames that may be handed out")},
        entry::reconnect(10, 100, 5000));
    return table;
}

Expected<std::unique_ptr<ProfileSource>> open_gocator_sensor(const nlohmann::json& settings, DeviceSession&) {
    SEAM_TRY(auto read, settings_from(settings));
    auto source = std::make_unique<GocatorSource>(std::move(read));
    SEAM_OK(source->connect());
    return source;
}

}  // namespace seamwright
