#include "app/cli/answers/run_text.h"

#include <fmt/format.h>

#include <cmath>

#include "app/cli/answers/result_json.h"
#include "devices/exchange/pose_json.h"
#include "projects/panel/panel_measure.h"

namespace seamwright::cli {

using nlohmann::json;

namespace {

json push_json(const PushRecord& p) {
    json push = {{"status", to_string(p.status)},
                 {"frame", p.frame_name},
                 {"robot", p.robot_id},
                 {"release", to_string(p.release)},
                 {"message", p.message}};
    if (p.before) push["before"] = pose_json(*p.before);
    if (p.read_back) push["read_back"] = pose_json(*p.read_back);
    return push;
}

json places_json(const std::vector<PanelMeasurement>& places) {
    json list = json::array();
    for (const PanelMeasurement& m : places)
        list.push_back({{"id", m.place_id},
                        {"status", to_string(m.status)},
                        {"message", m.message},
                        {"gap_mm", m.gap_mm},
                        {"flush_mm", m.flush_mm},
                        {"panel_mm", vector_json(m.panel_mm)},
                        {"body_mm", vector_json(m.body_mm)},
                        {"sigma_mm", m.sigma_mm},
                        {"head_disagreement_mm", m.head_disagreement_mm},
                        {"head_offset_mm", m.head_offset_mm},
                        {"head_overlap_mm", m.head_overlap_mm}});
    return list;
}

json number_json(double v) {
    return std::isfinite(v) ? json(v) : json();
}

// The moves, and the single step from the same measurement beside them.
json servo_json(const PanelRecord& p) {
    json moves = json::array();
    for (const PanelServoMove& m : p.servo->moves)
        moves.push_back({{"motion", pose_json(m.motion)}, {"rms_mm", m.rms_mm}});
    const ServoComparison c = compare_servo(p);
    json out = {{"status", to_string(p.servo->status)},
                {"moves", moves},
                {"moves_made", c.moves},
                {"before_rms_mm", number_json(c.before_rms_mm)},
                {"after_rms_mm", number_json(c.after_rms_mm)},
                {"motion", pose_json(p.servo->motion)},
                {"single_step", json()}};
    if (p.fit)
        out["single_step"] = {{"motion", pose_json(p.fit->gripper_motion)},
                              {"moves_made", 1},
                              {"foreseen_rms_mm", number_json(c.single_rms_mm)},
                              {"apart_mm", c.apart_mm},
                              {"apart_deg", c.apart_deg}};
    return out;
}

json panel_json(const PanelRecord& p) {
    json out = {{"job", p.job_id},
                {"verdict", to_string(p.verdict)},
                {"before", places_json(p.before)},
                {"after", places_json(p.after)},
                {"fit", p.fit ? panel_fit_json(*p.fit) : json()},
                {"base_from_gripper", pose_json(p.base_from_gripper)},
                {"base_from_moved_gripper", pose_json(p.base_from_moved_gripper)},
                {"base_from_frame", pose_json(p.base_from_frame)},
                {"gate_passed", p.gate_passed},
                {"refusals", p.refusals},
                {"push", push_json(p.push)}};
    if (p.servo) out["servo"] = servo_json(p);
    return out;
}

std::string panel_text(const RunRecord& run) {
    const PanelRecord& p = *run.panel;
    std::string text;
    for (const auto& [when, places] : {std::pair{"before", &p.before}, {"after", &p.after}})
        for (const PanelMeasurement& m : *places) {
            text += fmt::format("  {:<6} place {:<6} ", when, m.place_id);
            text += m.status == SpotStatus::measured
                        ? fmt::format("gap {:8.3f}   flush {:+8.3f} mm\n", m.gap_mm, m.flush_mm)
                        : fmt::format("{}: {}\n", to_string(m.status), m.message);
        }
    if (p.servo) {
        for (std::size_t i = 0; i < p.servo->moves.size(); ++i)
            text +=
                fmt::format("  move {:<2} gap and flush {:.4f} mm rms off\n", i, p.servo->moves[i].rms_mm);
        const ServoComparison c = compare_servo(p);
        text += fmt::format("servo: {}\n  S    {}\n", to_string(p.servo->status), pose_text(p.servo->motion));
        if (c.moves > 0)
            text +=
                fmt::format("servoing: {} moves, gap and flush from {:.4f} to {:.4f} mm rms as measured\n",
                            c.moves, c.before_rms_mm, c.after_rms_mm);
        if (p.fit)
            text += fmt::format(
                "the single step beside it: 1 move, to {:.4f} mm rms as foreseen, {:.4f} mm and {:.4f} deg "
                "apart:\n",
                c.single_rms_mm, c.apart_mm, c.apart_deg);
    }
    if (p.fit) text += panel_fit_text(*p.fit);
    for (const Text& reason : p.refusals) text += "  refused: " + reason.english() + "\n";
    if (run.push)
        text += fmt::format("  push of {}: {}{}{}\n", p.push.frame_name, to_string(p.push.status),
                            p.push.message.empty() ? "" : ": ", p.push.message);
    return text + fmt::format("panel job {}: {}\n", p.job_id, to_string(p.verdict));
}

}  // namespace

namespace {
// By robot, in the order of its first frame.
std::vector<std::pair<std::string, Release>> releases_of(const RunRecord& run) {
    std::vector<std::pair<std::string, Release>> list;
    const auto add = [&](const PushRecord& push) {
        if (push.robot_id.empty()) return;
        for (const auto& [id, release] : list)
            if (id == push.robot_id) return;
        list.emplace_back(push.robot_id, push.release);
    };
    for (const RegionRecord& region : run.regions) add(region.push);
    if (run.panel) add(run.panel->push);
    return list;
}
}  // namespace

int run_exit_code(const RunRecord& run) {
    switch (run.status) {
        case RunStatus::ok:
            return kExitOk;
        case RunStatus::device:
        case RunStatus::alarm:
            return kExitDevice;
        default:
            return kExitVerdict;
    }
}

std::optional<Answer> refuse_unsafe(Station& station, const std::vector<Error>& findings) {
    if (findings.empty()) return std::nullopt;
    Answer answer;
    answer.exit_code = kExitVerdict;
    json sentences = json::array();
    std::string all;
    for (const Error& finding : findings) {
        sentences.push_back(finding.sentence());
        all += (all.empty() ? "" : "; ") + finding.sentence();
        answer.text += "refused: " + finding.sentence() + "\n";
    }
    answer.json = {{"status", to_string(RunStatus::refused)},
                   {"message", "refused before anything moved: " + all},
                   {"findings", sentences}};
    // The answer stands without the log.
    (void)station.file().append_event({0, utc_now(), 0, EventKind::refusal, "run", all});
    return answer;
}

json run_json(const RunRecord& run) {
    json spots = json::array(), regions = json::array(), events = json::array();
    for (const SpotMeasurement& s : run.spots) {
        spots.push_back({{"id", s.spot_id},
                         {"status", to_string(s.status)},
                         {"message", s.message},
                         {"feature", feature_json(s.feature)},
                         {"measured_mm", vector_json(s.measured_mm)},
                         {"sigma_mm", s.sigma_mm}});
        if (s.light) spots.back()["light"] = light_json(*s.light);
    }
    for (const RegionRecord& r : run.regions) {
        regions.push_back({{"id", r.region_id},
                           {"correction", r.correction ? correction_json(*r.correction) : json()},
                           {"base_from_frame", pose_json(r.base_from_frame)},
                           {"gate_passed", r.gate_passed},
                           {"refusals", r.refusals},
                           {"push", push_json(r.push)}});
        if (r.offset)
            regions.back()["offset"] = {{"version", r.offset->version},
                                        {"offset_mm", vector_json(r.offset->offset_mm)}};
        if (r.modes)
            regions.back()["modes"] = {{"acted", r.modes->acted},
                                       {"why", r.modes->why},
                                       {"text", said_of(*r.modes)},
                                       {"amplitudes_mm", r.modes->amplitudes_mm},
                                       {"sigma_mm", r.modes->sigma_mm},
                                       {"largest_added_mm", r.modes->largest_added_mm},
                                       {"probability", r.modes->probability}};
        if (r.drift)
            regions.back()["drift"] = {
                {"verdict", to_string(r.drift->verdict)}, {"text", r.drift->text},
                {"compensated", r.drift->compensated},    {"shift_mm", vector_json(r.drift->shift_mm)},
                {"device", r.drift->device_id},           {"why", r.drift->why}};
    }
    for (const EventRecord& e : run.events)
        events.push_back(
            {{"utc", e.utc}, {"kind", to_string(e.kind)}, {"subject", e.subject}, {"text", e.text}});
    json out = {{"status", to_string(run.status)},
                {"message", run.message},
                {"run", run.number},
                {"part", run.part_id},
                {"started_utc", run.started_utc},
                {"finished_utc", run.finished_utc},
                {"push", run.push},
                {"spots", spots},
                {"regions", regions},
                {"events", events}};
    if (!run.type_id.empty()) out["type"] = run.type_id;
    if (run.panel) out["panel"] = panel_json(*run.panel);
    if (run.push) {
        out["release"] = json::object();
        for (const auto& [robot, release] : releases_of(run)) out["release"][robot] = to_string(release);
    }
    return out;
}

std::string run_text(const RunRecord& run) {
    std::string text =
        fmt::format("run {}  part {}{}  {}: {}\n", run.number, run.part_id,
                    run.type_id.empty() ? "" : " of type " + run.type_id, to_string(run.status), run.message);
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
            text += "  D  " + pose_text(r.correction->displacement.workobject_from_movedworkobject) + "\n" +
                    correction_sigma_text(*r.correction);
        if (r.offset) text += "  " + said_of(*r.offset).english() + "\n";
        if (r.modes) text += "  " + said_of(*r.modes).english() + "\n";
        if (r.drift) text += "  " + said_of(*r.drift).english() + "\n";
        for (const Text& reason : r.refusals) text += "  refused: " + reason.english() + "\n";
        if (run.push)
            text += fmt::format("  push of {}: {}{}{}\n", r.push.frame_name, to_string(r.push.status),
                                r.push.message.empty() ? "" : ": ", r.push.message);
    }
    if (run.panel) text += panel_text(run);
    for (const auto& [robot, release] : releases_of(run))
        if (release != Release::none)
            text += fmt::format("robot {}: {}\n", robot,
                                release == Release::taken ? "the application runs in the frames"
                                : release == Release::given
                                    ? "ALARM: it is not known whether the application may run"
                                    : "nothing is released, the permission is taken back");
    for (const EventRecord& event : run.events)
        if (event.kind == EventKind::alarm) text += fmt::format("ALARM {}: {}\n", event.subject, event.text);
    return text;
}

}  // namespace seamwright::cli
