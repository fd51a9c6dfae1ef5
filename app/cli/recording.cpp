#include "app/cli/recording.h"

#include <fmt/format.h>

namespace seamwright::cli {

using nlohmann::json;

namespace {

json counters_json(const CaptureCounters& c) {
    return {{"frames", c.frames}, {"damaged", c.damaged}, {"lost", c.lost}, {"dropped", c.dropped}};
}

std::string counters_text(const CaptureCounters& c) {
    return fmt::format("{} frames, {} damaged, {} lost before, {} dropped", c.frames, c.damaged, c.lost,
                       c.dropped);
}

}  // namespace

Expected<std::shared_ptr<Recorder>> open_recorder(const std::string& file, const RecorderOptions& options) {
    if (file.empty()) return std::shared_ptr<Recorder>();
    SEAM_TRY(auto recorder, Recorder::create(file, options));
    return std::shared_ptr<Recorder>(std::move(recorder));
}

Expected<void> tell_recording(Recorder* recorder, const std::string& file, Answer& answer) {
    if (!recorder) return {};
    SEAM_TRY(auto status, recorder->finish());
    json sources = json::object();
    for (const auto& [name, counters] : status.sources) {
        sources[name] = counters_json(counters);
        answer.text += fmt::format("{}: {}\n", name, counters_text(counters));
    }
    answer.json["recording"] = {{"file", file}, {"bytes", status.bytes}, {"sources", sources}};
    answer.text += fmt::format("{}: {:.1f} MiB\n", file, static_cast<double>(status.bytes) / (1 << 20));
    return {};
}

Expected<Answer> capture_info(const std::string& file) {
    SEAM_TRY(auto reader, CaptureReader::open(file));
    Answer answer;
    answer.json = {{"status", "ok"},
                   {"kind", "capture"},
                   {"started_utc", reader.started_utc()},
                   {"finished_utc", reader.finished_utc()},
                   {"end", reader.end()},
                   {"duration_s", reader.duration_s()},
                   {"sources", json::array()}};
    answer.text =
        fmt::format("{}: recorded {}, {:.1f} s, {}\n", file, reader.started_utc(), reader.duration_s(),
                    reader.finished_utc().empty() ? "not finished" : reader.end());
    for (const CaptureSource& s : reader.sources()) {
        SEAM_TRY(auto events, reader.events(s.id));
        json counted = json::object(), notes = json::array();
        for (const CaptureEvent& e : events) {
            json& n = counted[std::string(to_string(e.kind))];
            n = n.is_null() ? 1 : n.get<int>() + 1;
            if (e.kind == CaptureEventKind::note) notes.push_back(e.text);
        }
        const bool sensor = s.kind == SourceKind::sensor;
        json source = {{"name", s.name},     {"kind", sensor ? "sensor" : "robot"},
                       {"driver", s.driver}, {"vendor", s.vendor},
                       {"model", s.model},   {"serial", s.serial},
                       {"events", counted},  {"notes", notes}};
        if (sensor) source["counters"] = counters_json(s.counters);
        answer.json["sources"].push_back(source);
        answer.text += fmt::format("  {} {}: {} {} {}; {}\n", sensor ? "sensor" : "robot", s.name, s.driver,
                                   s.model, s.serial, sensor ? counters_text(s.counters) : counted.dump());
        for (const auto& note : notes) answer.text += "    " + note.get<std::string>() + "\n";
    }
    return answer;
}

Expected<Answer> capture_check(const std::string& file) {
    SEAM_TRY(auto reader, CaptureReader::open(file));
    Answer answer;
    json integrity = json::array();
    for (const Error& e : reader.check()) integrity.push_back(e.sentence());
    answer.exit_code = integrity.empty() ? kExitOk : kExitDevice;
    answer.json = {{"status", integrity.empty() ? "ok" : "damaged"}, {"integrity", integrity}};
    answer.text = integrity.empty() ? "integrity ok\n" : "the file is damaged\n";
    for (const auto& s : integrity) answer.text += "  " + s.get<std::string>() + "\n";
    return answer;
}

}  // namespace seamwright::cli
