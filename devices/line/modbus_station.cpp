#include "devices/line/modbus_station.h"

namespace seamwright {

SettingTable modbus_settings(const SettingTable& own) {
    const SettingTable common = {
        entry::choice(
            "start", {"robot", "line"},
            "who starts a part; robot: its call does, and the line's type, number and name go with it"),
        entry::whole("call_timeout_ms", 5000, 100, 600000,
                     "a start that the station cannot follow by then is answered"),
        entry::whole("drop_timeout_ms", 10000, 0, 600000,
                     "for start to go after done, then an alarm; 0: no alarm"),
        entry::whole("heartbeat_timeout_ms", 0, 0, 600000,
                     "an alarm, and no start, where line_heartbeat stands still so long; 0: not watched"),
    };
    return entry::joined(own, common);
}

HandshakeOptions read_handshake(SettingsReader& r) {
    HandshakeOptions options;
    std::string start;
    r.text("start", start);
    options.line_starts = start == "line";
    r.duration("call_timeout_ms", options.call_timeout);
    r.duration("drop_timeout_ms", options.drop_timeout);
    r.duration("heartbeat_timeout_ms", options.heartbeat_timeout);
    return options;
}

void LineNotices::add(Text text) {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < 8) waiting_.push_back(std::move(text));
}

std::vector<Text> LineNotices::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(waiting_, {});
}

void ModbusStation::publish(const LineState& state) {
    const std::lock_guard lock(mutex_);
    state_ = state;
    alive_ = Clock::now();
}

void ModbusStation::alive() {
    const std::lock_guard lock(mutex_);
    alive_ = Clock::now();
}

std::optional<LineCall> ModbusStation::take_call() {
    const std::lock_guard lock(mutex_);
    return handshake_.take(state_, Clock::now());
}

bool ModbusStation::given_up() const {
    const std::lock_guard lock(mutex_);
    return handshake_.given_up();
}

LinePart ModbusStation::announced() const {
    const std::lock_guard lock(mutex_);
    return handshake_.part();
}

void ModbusStation::hear(std::span<const std::uint16_t> line_words) {
    const LineWords words = read_line_words(line_words);
    const std::lock_guard lock(mutex_);
    handshake_.hear(words, Clock::now());
}

void ModbusStation::lost() {
    const std::lock_guard lock(mutex_);
    handshake_.lost();
}

void ModbusStation::write(AllWords& words) {
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    if (now - alive_ < kLineAlive) {
        constexpr std::chrono::milliseconds kBeat{250};
        const auto beats = (now - beat_) / kBeat;
        heartbeat_ = static_cast<std::uint16_t>(heartbeat_ + beats);
        beat_ += beats * kBeat;
    } else {
        beat_ = now;
    }
    write_station_words({state_, handshake_.bits(state_, now), heartbeat_}, words);
}

}  // namespace seamwright
