#include "app/cli/run_text.h"

#include <fmt/format.h>

#include "app/cli/result_json.h"
#include "devices/exchange/pose_json.h"

namespace seamwright::cli {

using nlohmann::json;

json run_json(const RunRecord& run) {
    json spots = json::array(), regions = json::array(), events = json::array();
    for (const SpotMeasurement& s : run.spots)
        spots.push_back({{"id", s.spot_id},
                         {"status", to_string(s.status)},
                         {"message", s.message},
                         {"feature", feature_json(s.feature)},
                         {"measured_mm", vector_json(s.measured_mm)},
                         {"sigma_mm", s.sigma_mm}});
    for (const RegionRecord& r : run.regions) {
        json push = {
            {"status", to_string(r.push.status)}, {"frame", r.push.frame_name}, {"message", r.push.message}};
        if (r.push.before) push["before"] = pose_json(*r.push.before);
        if (r.push.read_back) push["read_back"] = pose_json(*r.push.read_back);
        regions.push_back({{"id", r.region_id},
                           {"correction", r.correction ? correction_json(*r.correction) : json()},
                           {"base_from_frame", pose_json(r.base_from_frame)},
                           {"gate_passed", r.gate_passed},
                           {"refusals", r.refusals},
                           {"push", push}});
    }
    for (const EventRecord& e : run.events)
        events.push_back(
            {{"utc", e.utc}, {"kind", to_string(e.kind)}, {"subject", e.subject}, {"text", e.text}});
    return {{"status", to_string(run.status)},
            {"message", run.message},
            {"run", run.number},
            {"part", run.part_id},
            {"started_utc", run.started_utc},
            {"finished_utc", run.finished_utc},
            {"push", run.push},
            {"spots", spots},
            {"regions", regions},
            {"events", events}};
}

std::string run_text(const RunRecord& run) {
    std::string text =
        fmt::format("run {}  part {}  {}: {}\n", run.number, run.part_id, to_string(run.status), run.message);
    for (const SpotMeasurement& s : run.spots) {
        if (s.status == SpotStatus::measured)
            text += fmt::format("  spot {:<8} x {:9.3f}  z {:9.3f} mm  ± {:.3f}\n", s.spot_id,
                                s.measured_mm.x(), s.measured_mm.z(), s.sigma_mm);
        else
            text += fmt::format("  spot {:<8} {}: {}\n", s.spot_id, to_string(s.status), s.message);
    }
    for (const RegionRecord& r : run.regions) {
        text += fmt::format("region {}: {}\n", r.region_id,
                            r.correction ? std::string(to_string(r.correction->status)) : "no correction");
        if (r.correction && r.correction->status != CorrectionStatus::under_determined)
            text += "  D  " + pose_text(r.correction->displacement.workobject_from_movedworkobject) + "\n";
        for (const std::string& reason : r.refusals) text += "  refused: " + reason + "\n";
        if (run.push)
            text += fmt::format("  push of {}: {}{}{}\n", r.push.frame_name, to_string(r.push.status),
                                r.push.message.empty() ? "" : ": ", r.push.message);
    }
    return text;
}

}  // namespace seamwright::cli
