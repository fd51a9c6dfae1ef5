#include "devices/replay/capture_replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace seamwright {
namespace {

std::int64_t to_ns(CaptureReplay::Clock::time_point t) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count();
}

// Recorded times are bytes of a file: a difference of two may exceed what an integer holds.
double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
    return std::clamp((static_cast<double>(to_ns) - static_cast<double>(from_ns)) * 1e-9, -1e7, 1e7);
}

// A camera's frame without its image: the strongest candidate of each line.
void strongest(const ProfileCandidates& candidates, Profile& profile) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (int line = 0; line < candidates.lines; ++line) {
        const bool found = candidates.count[static_cast<std::size_t>(line)] > 0;
        const auto at = static_cast<std::size_t>(candidates.index(line, 0));
        profile.x_mm.push_back(found ? candidates.x_mm[at] : nan);
        profile.z_mm.push_back(found ? candidates.z_mm[at] : nan);
        profile.intensity.push_back(found ? candidates.intensity[at] : 0.0f);
    }
}

}  // namespace

CaptureReplay::CaptureReplay(CaptureReader reader, double speed, bool loop)
    : where_(reader.path().string()), speed_(speed), loop_(loop), reader_(std::move(reader)) {}

Expected<CaptureSource> CaptureReplay::source(const std::string& name, SourceKind kind) const {
    const std::lock_guard lock(mutex_);
    if (const CaptureSource* found = reader_.find(name, kind)) return *found;
    std::string known;
    for (const CaptureSource& s : reader_.sources())
        if (s.kind == kind) known += (known.empty() ? "" : ", ") + s.name;
    const char* what = kind == SourceKind::sensor ? "sensor" : "robot";
    if (known.empty()) return input_error(Text("the capture has no {}", what), where_);
    if (name.empty())
        return input_error(Text("the capture has several {}s", what), where_,
                           Text("name one in settings.source: {}", known));
    return input_error(Text("the capture has no {} \"{}\"", what, name), where_, Text("known are {}", known));
}

Expected<void> CaptureReplay::open_sensor(const CaptureSource& source, std::uint64_t from, bool step) {
    const std::lock_guard lock(mutex_);
    if (const auto it = players_.find(source.id); it != players_.end() && !it->second.open) {
        it->second.open = true;
        it->second.step = step;
        return {};
    }
    if (players_.contains(source.id))
        return input_error(Text("two sensors play the same source \"{}\"", source.name), where_,
                           "give each a source of its own");
    Player player;
    player.count = reader_.frames(source.id);
    if (from > 0 && from >= player.count)
        return input_error(Text("the source \"{}\" has {} frames only", source.name, player.count),
                           "settings.from");
    player.cursor = from;
    player.step = step;
    SEAM_TRY(const auto spots, reader_.spots(source.id));
    for (const auto& [number, spot] : spots)
        if (number >= from) player.of_spot[spot].push_back(number);
    players_[source.id] = std::move(player);
    return {};
}

void CaptureReplay::close_sensor(std::int64_t source) {
    const std::lock_guard lock(mutex_);
    players_.at(source).open = false;
}

void CaptureReplay::close_robot() {
    const std::lock_guard lock(mutex_);
    robot_open_ = false;
}

Expected<void> CaptureReplay::open_robot(const CaptureSource& source) {
    const std::lock_guard lock(mutex_);
    if (robot_open_) return input_error("two robots play one capture", where_);
    SEAM_TRY(auto events, reader_.events(source.id));
    robot_open_ = true;
    if (!triggers_.empty() || !poses_.empty() || !modes_.empty()) return {};  // opened before
    for (CaptureEvent& e : events) {
        if (e.base_from_flange) poses_.push_back(e);
        if (e.kind == CaptureEventKind::trigger) triggers_.push_back(e);
        if (e.kind == CaptureEventKind::mode) modes_.push_back(e);
    }
    return {};
}

Expected<void> CaptureReplay::start_clock() {
    if (started_) return {};
    first_ns_ = std::numeric_limits<std::int64_t>::max();
    bool from_later = false;
    for (auto& [id, player] : players_) {
        if (player.cursor >= player.count) continue;
        SEAM_TRY(const auto first, reader_.frame(id, player.cursor));
        first_ns_ = std::min(first_ns_, first->host_time_ns);
        from_later = from_later || player.cursor > 0;
    }
    if (from_later)
        while (next_trigger_ < triggers_.size() && triggers_[next_trigger_].host_time_ns < first_ns_)
            ++next_trigger_;
    else if (!triggers_.empty())
        first_ns_ = std::min(first_ns_, triggers_.front().host_time_ns);
    if (first_ns_ == std::numeric_limits<std::int64_t>::max())
        first_ns_ = poses_.empty() ? 0 : poses_.front().host_time_ns;
    newest_ns_ = first_ns_;
    started_ = Clock::now();
    return {};
}

CaptureReplay::Clock::time_point CaptureReplay::when(std::int64_t host_time_ns, int loops) const {
    if (speed_ == 0) return *started_;
    const double seconds = std::clamp(
        seconds_between(first_ns_, host_time_ns) + loops * (reader_.duration_s() + 1e-3), -1e7, 1e7);
    return *started_ + std::chrono::duration_cast<Clock::duration>(
                           std::chrono::duration<double>(std::clamp(seconds / speed_, -1e8, 1e8)));
}

std::int64_t CaptureReplay::position_ns() const {
    if (speed_ == 0 || !started_) return newest_ns_;
    const double elapsed = std::chrono::duration<double>(Clock::now() - *started_).count() * speed_;
    const double position = static_cast<double>(first_ns_) + elapsed * 1e9;
    return position < 9e18 ? static_cast<std::int64_t>(position) : std::numeric_limits<std::int64_t>::max();
}

Expected<std::uint64_t> CaptureReplay::take(Player& player, const std::string& spot_id) {
    if (spot_id.empty()) {
        if (player.cursor >= player.count) {
            if (!loop_ || player.count == 0)
                return device_error(ErrorCode::end_of_recording, kEndOfRecording, where_);
            player.cursor = 0;
            ++player.loops;
        }
        return player.cursor++;
    }
    const auto it = player.of_spot.find(spot_id);
    if (it == player.of_spot.end())
        return device_error(Text("the recording has no spot \"{}\"", spot_id), where_);
    std::size_t& played = player.played[spot_id];
    if (played == it->second.size()) {
        if (!loop_) return device_error(ErrorCode::end_of_recording, kEndOfRecording, where_);
        played = 0;
    }
    return it->second[played++];
}

Expected<void> CaptureReplay::trigger(std::int64_t source, const std::string& spot_id) {
    const std::lock_guard lock(mutex_);
    SEAM_OK(start_clock());
    Player& player = players_.at(source);
    if (!spot_id.empty()) {
        // The robot's trigger for the same spot, not yet served, is the same exposure.
        const auto it = player.of_spot.find(spot_id);
        for (const std::uint64_t number : player.due)
            if (it != player.of_spot.end() &&
                std::binary_search(it->second.begin(), it->second.end(), number))
                return {};
    }
    SEAM_TRY(const auto number, take(player, spot_id));
    player.driven = true;
    player.due.push_back(number);
    return {};
}

Expected<void> CaptureReplay::deliver(std::int64_t source, std::uint64_t number, Frame& frame) {
    SEAM_TRY(const auto recorded, reader_.frame(source, number));
    const Capture& c = *recorded;
    frame.status = c.status;
    frame.sequence = c.sequence;
    frame.device_time_ns = c.device_time_ns;
    frame.host_time_ns = c.host_time_ns;
    frame.base_from_flange = c.base_from_flange;
    frame.spot_id = c.spot_id;
    frame.profile = c.profile;
    if (c.image) {
        frame.pixels.assign(c.image->pixels.begin(), c.image->pixels.end());
        frame.image = c.image->view();
        frame.image.pixels = frame.pixels.data();
    } else if (c.profile.size() == 0 && c.candidates.lines > 0) {
        strongest(c.candidates, frame.profile);
    }
    newest_ns_ = std::max(newest_ns_, c.host_time_ns);
    return {};
}

Expected<std::optional<CaptureReplay::Clock::time_point>> CaptureReplay::next(std::int64_t source,
                                                                              Frame& frame) {
    const std::lock_guard lock(mutex_);
    SEAM_OK(start_clock());
    Player& player = players_.at(source);
    if (!player.due.empty()) {
        const std::uint64_t number = player.due.front();
        player.due.pop_front();
        SEAM_OK(deliver(source, number, frame));
        return std::nullopt;
    }
    if (player.driven || player.step) return Clock::time_point::max();
    const std::uint64_t cursor = player.cursor;
    const int loops = player.loops;
    SEAM_TRY(const auto number, take(player, ""));
    SEAM_TRY(const auto recorded,
             reader_.frame(source, number));  // passed over: the next call goes on behind it
    if (const auto due = when(recorded->host_time_ns, player.loops); due > Clock::now()) {
        player.cursor = cursor;
        player.loops = loops;
        return due;
    }
    SEAM_OK(deliver(source, number, frame));
    return std::nullopt;
}

Expected<void> CaptureReplay::start_moves(const std::vector<std::string>& spot_ids) {
    const std::lock_guard lock(mutex_);
    SEAM_OK(start_clock());
    std::map<std::string, std::size_t> wanted;
    for (const std::string& id : spot_ids) {
        if (id.empty()) return input_error("a measuring move names no spot");
        ++wanted[id];
    }
    for (const auto& [id, times] : wanted) {
        bool known = false, enough = false;
        for (auto& [source, player] : players_) {
            const auto it = player.of_spot.find(id);
            if (it == player.of_spot.end()) continue;
            known = true;
            enough = enough || loop_ || player.played[id] + times <= it->second.size();
        }
        if (!known) return device_error(Text("the recording has no spot \"{}\"", id), where_);
        if (!enough) return device_error(ErrorCode::end_of_recording, kEndOfRecording, where_);
    }
    for (auto& [source, player] : players_) {
        player.driven = true;
        player.due.clear();
    }
    measuring_ = true;
    moves_.assign(spot_ids.begin(), spot_ids.end());
    return {};
}

Expected<std::optional<CaptureReplay::Clock::time_point>> CaptureReplay::next_trigger(TriggerEvent& trigger) {
    const std::lock_guard lock(mutex_);
    SEAM_OK(start_clock());
    const auto hand_out = [&](const CaptureEvent& e) {
        trigger = {e.spot_id, to_ns(Clock::now()), e.base_from_flange};
        newest_ns_ = std::max(newest_ns_, e.host_time_ns);
    };
    if (!measuring_) {
        if (next_trigger_ == triggers_.size())
            return device_error(ErrorCode::end_of_recording, kEndOfRecording, where_);
        const CaptureEvent& e = triggers_[next_trigger_];
        if (const auto due = when(e.host_time_ns, 0); due > Clock::now()) return due;
        ++next_trigger_;
        hand_out(e);
        return std::nullopt;
    }
    if (moves_.empty()) return device_error("the measuring program has ended", where_);
    const std::string spot = moves_.front();
    moves_.pop_front();
    CaptureEvent event;
    event.spot_id = spot;
    event.host_time_ns = newest_ns_;
    std::size_t skip = fired_[spot]++, seen = 0;
    for (const CaptureEvent& e : triggers_)
        if (e.spot_id == spot && seen++ <= skip) event = e;  // the k-th, or the last there is
    for (auto& [source, player] : players_) {
        if (!player.of_spot.contains(spot)) continue;
        SEAM_TRY(const auto number, take(player, spot));
        player.due.push_back(number);
        SEAM_TRY(const auto recorded, reader_.frame(source, number));
        if (recorded->base_from_flange) event.base_from_flange = recorded->base_from_flange;
    }
    hand_out(event);
    return std::nullopt;
}

std::optional<Pose> CaptureReplay::pose() {
    const std::lock_guard lock(mutex_);
    if (!start_clock() || poses_.empty()) return std::nullopt;
    const std::int64_t now = position_ns();
    const auto after =
        std::upper_bound(poses_.begin(), poses_.end(), now,
                         [](std::int64_t t, const CaptureEvent& e) { return t < e.host_time_ns; });
    if (after == poses_.begin()) return std::nullopt;
    return std::prev(after)->base_from_flange;
}

RobotMode CaptureReplay::mode() {
    const std::lock_guard lock(mutex_);
    if (!start_clock() || modes_.empty()) return RobotMode::unknown;
    const std::int64_t now = position_ns();
    const auto after =
        std::upper_bound(modes_.begin(), modes_.end(), now,
                         [](std::int64_t t, const CaptureEvent& e) { return t < e.host_time_ns; });
    // Before the first that was recorded the mode was the same: it is asked for when a recording begins.
    const CaptureEvent& event = after == modes_.begin() ? modes_.front() : *std::prev(after);
    return robot_mode_from_string(event.text).value_or(RobotMode::unknown);
}

}  // namespace seamwright
