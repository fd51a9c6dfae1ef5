#include "projects/line/line_control.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/geometry/notation.h"

namespace seamwright {

LineResult line_result(const RunRecord& run) {
    switch (run.status) {
        case RunStatus::ok:
            return run.push ? LineResult::corrected : LineResult::measured;
        case RunStatus::refused:
            return LineResult::refused;
        case RunStatus::not_taken:
            return LineResult::not_taken;
        case RunStatus::device:
            return LineResult::device;
        case RunStatus::cancelled:
            return LineResult::cancelled;
        case RunStatus::interrupted:
        case RunStatus::pushed:  // what became of it is not recorded
        case RunStatus::alarm:
            return LineResult::alarm;
    }
    return LineResult::alarm;
}

LineAlarm line_alarm(LineResult result) {
    switch (result) {
        case LineResult::none:
        case LineResult::corrected:
        case LineResult::measured:
            return LineAlarm::none;
        case LineResult::refused:
            return LineAlarm::refused;
        case LineResult::not_taken:
            return LineAlarm::not_taken;
        case LineResult::alarm:
            return LineAlarm::push_failed;
        case LineResult::device:
            return LineAlarm::device_failed;
        case LineResult::cancelled:
            return LineAlarm::cancelled;
        case LineResult::not_measured:
            return LineAlarm::call_not_followed;
    }
    return LineAlarm::push_failed;
}

LineAlarm line_alarm(ErrorCode lost) {
    switch (lost) {
        case ErrorCode::silence:
            return LineAlarm::device_silent;
        case ErrorCode::disconnected:
            return LineAlarm::device_disconnected;
        case ErrorCode::in_use:
            return LineAlarm::device_in_use;
        default:
            return LineAlarm::device_lost;
    }
}

LineRegion line_region(const RegionRecord& r) {
    LineRegion region;
    region.id = r.region_id;
    region.passed = r.gate_passed;
    if (!r.refusals.empty()) region.refusal = r.refusals.front().english();
    if (!r.correction || (r.correction->status != CorrectionStatus::ok &&
                          r.correction->status != CorrectionStatus::over_limit))
        return region;
    region.solved = true;
    const Pose& moved = r.correction->displacement.workobject_from_movedworkobject;
    const KukaAbc abc = kuka_from_rotation(moved.linear());
    region.xyz_mm = moved.translation();
    region.abc_deg = {abc.a_deg, abc.b_deg, abc.c_deg};
    region.sigma_xyz_mm = r.correction->sigma_xyz_mm;
    region.sigma_abc_deg = r.correction->sigma_abc_deg;
    return region;
}

Expected<LineControl> LineControl::open(const Project& project) {
    LineControl control;
    for (const LineSetup& setup : project.line) {
        if (!setup.enabled) continue;
        auto link = open_line(setup.protocol, setup.settings, project.name.empty() ? setup.id : project.name);
        if (!link) {
            Error error = link.error();
            error.within(Text("line {}", setup.id));
            return tl::unexpected(std::move(error));
        }
        const Link* other = control.caller();
        if (other && (*link)->starts_parts())
            return input_error(Text("\"{}\" starts the parts, and so does \"{}\"", other->setup.id, setup.id),
                               "line", "let one of them, and give the other \"start\": \"robot\"");
        control.links_.push_back({setup, std::move(*link)});
    }
    control.publish();
    return control;
}

LineControl::Link* LineControl::caller() {
    for (Link& l : links_)
        if (l.link->starts_parts()) return &l;
    return nullptr;
}

WatchLine LineControl::watch_line() {
    WatchLine line;
    if (links_.empty()) return line;
    line.starts = caller() != nullptr;
    line.call = [this]() -> std::optional<StartSignal> {
        auto call = caller()->link->take_call();
        if (!call) return std::nullopt;
        called_ = call->part;
        return StartSignal{call->part.id(), call->host_time_ns};
    };
    line.given_up = [this] { return caller()->link->given_up(); };
    line.named = [this](const std::string& part_id) { return named(part_id); };
    line.notices = [this] {
        std::vector<Text> all = std::exchange(notices_, {});
        for (const Link& l : links_)
            for (Text& notice : l.link->take_notices())
                all.push_back(Text("{}: {}", l.setup.id, std::move(notice)));
        return all;
    };
    return line;
}

// The robot's name for the part stays; the line's is taken where it has none.
Expected<NamedPart> LineControl::named(const std::string& part_id) {
    const Link* starter = caller();
    // Of several links the first one that says anything.
    const Link* speaker = starter;
    LinePart part = starter ? called_ : LinePart{};
    for (const Link& l : links_) {
        if (starter) break;
        const LinePart announced = l.link->take_announced();  // of all: what is said now is of no later part
        if (speaker == nullptr || part == LinePart{}) {
            speaker = &l;
            part = announced;
        }
    }
    // A plant whose robot and line have once called a part the same gives a part one name: another name is another part.
    if (const std::string by_line = part.id(); !starter && !part_id.empty() && !by_line.empty()) {
        same_names_ = same_names_ || by_line == part_id;
        if (same_names_ && by_line != part_id) {
            notices_.push_back(Text("part {}: the line speaks of part {}, nothing of that is taken for it",
                                    part_id, by_line));
            part = {};
        }
    }
    state_.part = part;
    state_.part_id = part_id.empty() ? part.id() : part_id;
    const auto& types = speaker->setup.part_types;
    if (!types.empty() && std::find(types.begin(), types.end(), int{part.type}) == types.end()) {
        refused_ = LineAlarm::part_type_unknown;
        return input_error(Text("its type {} is none that is measured here", part.type),
                           Text("line {}", speaker->setup.id), "name it in the link's part_types");
    }
    return NamedPart{state_.part_id, part.type, part.paint};
}

void LineControl::take(const WatchEvent& e) {
    if (links_.empty() || std::holds_alternative<watched::LineNotice>(e.happening)) return;
    state_.utc = e.utc;
    state_.text = e.text.english();
    state_.ready = e.state == WatchState::waiting;
    state_.busy = e.state == WatchState::measuring;
    state_.parts = e.counts.parts;
    const auto ended = [&](LineResult result, LineAlarm alarm) {
        ++state_.results;
        state_.result = result;
        state_.alarm = alarm;
    };
    if (const auto* lost = std::get_if<watched::Lost>(&e.happening)) {
        state_.alarm = lost_ = line_alarm(lost->code);
    } else if (std::holds_alternative<watched::Connected>(e.happening) ||
               std::holds_alternative<watched::Back>(e.happening)) {
        state_.alarm = lost_ = LineAlarm::none;
    } else if (std::holds_alternative<watched::Start>(e.happening)) {
        state_.alarm = LineAlarm::none;
        state_.result = LineResult::none;
        state_.regions.clear();
        state_.run = 0;
        state_.seconds = 0;
    } else if (const auto* missed = std::get_if<watched::Missed>(&e.happening)) {
        state_.regions.clear();
        state_.run = 0;
        state_.seconds = 0;
        LineAlarm why = std::exchange(refused_, LineAlarm::none);
        if (missed->part_type) why = LineAlarm::part_type_unknown;
        if (why == LineAlarm::none) {
            state_.part_id = missed->part_id;
            state_.part = caller() ? called_ : LinePart{};
        }
        ended(LineResult::not_measured, why == LineAlarm::none ? LineAlarm::call_too_old : why);
    } else if (const auto* done = std::get_if<watched::RunDone>(&e.happening)) {
        state_.part_id = done->record->part_id;
        state_.run = done->record->number;
        state_.seconds = done->seconds;
        state_.regions.clear();
        for (const RegionRecord& region : done->record->regions)
            state_.regions.push_back(line_region(region));
        const LineResult result = line_result(*done->record);
        ended(result, line_alarm(result));
    } else if (std::holds_alternative<watched::SpotDone>(e.happening)) {
        return;  // nothing of it is told
    }
    publish();
}

void LineControl::alive() {
    const auto now = std::chrono::steady_clock::now();
    if (now - told_alive_ < std::chrono::milliseconds(100)) return;
    told_alive_ = now;
    for (const Link& l : links_) l.link->alive();
}

void LineControl::publish() {
    for (const Link& l : links_) l.link->publish(state_);
}

std::vector<std::string> LineControl::described() const {
    std::vector<std::string> list;
    for (const Link& l : links_)
        list.push_back(l.link->port()
                           ? fmt::format("line {}: {}, port {}", l.setup.id, l.setup.protocol, l.link->port())
                           : fmt::format("line {}: {}", l.setup.id, l.setup.protocol));
    return list;
}

}  // namespace seamwright
