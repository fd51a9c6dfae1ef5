#include "projects/status/status_board.h"

#include <fmt/format.h>

#include <cmath>

#include "devices/capture/capture.h"
#include "projects/report/metrics.h"

namespace seamwright {
namespace {

StatusPart part_of(const watched::RunDone& done, const std::string& utc) {
    const RunRecord& run = *done.record;
    StatusPart part{
        utc,          run.part_id, std::string(to_string(run.status)), run.message.english(), run.number,
        done.seconds, {}};
    for (const RegionRecord& r : run.regions) {
        StatusRegion region{r.region_id, r.gate_passed, {}, {}, {}};
        if (!r.refusals.empty()) region.refusal = r.refusals.front().english();
        if (r.correction && (r.correction->status == CorrectionStatus::ok ||
                             r.correction->status == CorrectionStatus::over_limit)) {
            region.xyz_mm = r.correction->displacement.workobject_from_movedworkobject.translation();
            region.sigma_mm = r.correction->sigma_xyz_mm;
        }
        part.regions.push_back(std::move(region));
    }
    return part;
}

nlohmann::json vector_json(const std::optional<Eigen::Vector3d>& v) {
    nlohmann::json list = nlohmann::json::array();
    if (!v) return nullptr;
    for (int k = 0; k < 3; ++k)
        list.push_back(std::isfinite((*v)[k]) ? nlohmann::json((*v)[k]) : nlohmann::json());
    return list;
}

}  // namespace

StatusBoard::StatusBoard(std::string project, std::string program, bool push) {
    view_.project = std::move(project);
    view_.program = std::move(program);
    view_.push = push;
    view_.started_utc = utc_now();
    view_.state = to_string(WatchState::connecting);
}

void StatusBoard::take(const WatchEvent& e) {
    const std::lock_guard lock(mutex_);
    view_.state = to_string(e.state);
    view_.text = e.text.english();
    view_.event_utc = e.utc;
    view_.counts = e.counts;
    if (const auto* start = std::get_if<watched::Start>(&e.happening)) {
        view_.part = start->part_id;
        view_.spots_done = view_.spots = 0;
    } else if (const auto* spot = std::get_if<watched::SpotDone>(&e.happening)) {
        view_.spots_done = spot->done;
        view_.spots = spot->total;
    } else if (const auto* done = std::get_if<watched::RunDone>(&e.happening)) {
        view_.parts.push_back(part_of(*done, e.utc));
        if (view_.parts.size() > kStatusParts) view_.parts.pop_front();
        view_.measuring_seconds += done->seconds;
        view_.drift = done->drift;
        ++view_.runs_by_status[view_.parts.back().status];
        view_.part.clear();
    }
    if (e.level != WatchLevel::info) {
        view_.alarms.push_back({e.utc, std::string(to_string(e.level)), view_.text});
        if (view_.alarms.size() > kStatusAlarms) view_.alarms.pop_front();
    }
}

StatusView StatusBoard::view() const {
    StatusView copy;
    {
        const std::lock_guard lock(mutex_);
        copy = view_;
    }
    copy.now_utc = utc_now();
    return copy;
}

nlohmann::json status_json(const StatusView& v) {
    const WatchCounts& c = v.counts;
    nlohmann::json drift;
    if (v.drift.watched)
        drift = {{"verdict", to_string(v.drift.verdict)},
                 {"text", v.drift.text.english()},
                 {"stopped", v.drift.stopped},
                 {"due", v.drift.due},
                 {"points", v.drift.points},
                 {"last_utc", v.drift.last_utc},
                 {"level_mm", v.drift.level_mm},
                 {"level_sigma_mm", v.drift.level_sigma_mm},
                 {"compensated", v.drift.acting.compensated},
                 {"shift_mm", vector_json(v.drift.acting.shift_mm)}};
    return {{"drift", drift},
            {"project", v.project},
            {"program", v.program},
            {"started_utc", v.started_utc},
            {"now_utc", v.now_utc},
            {"push", v.push},
            {"state", v.state},
            {"text", v.text},
            {"event_utc", v.event_utc},
            {"part", v.part},
            {"spots", {{"done", v.spots_done}, {"total", v.spots}}},
            {"counts",
             {{"parts", c.parts},
              {"corrected", c.corrected},
              {"refused", c.refused},
              {"failed", c.failed},
              {"alarms", c.alarms},
              {"outages", c.lost},
              {"missed", c.missed}}}};
}

nlohmann::json status_parts_json(const StatusView& v) {
    nlohmann::json list = nlohmann::json::array();
    for (auto p = v.parts.rbegin(); p != v.parts.rend(); ++p) {
        nlohmann::json regions = nlohmann::json::array();
        for (const StatusRegion& r : p->regions)
            regions.push_back({{"id", r.id},
                               {"passed", r.passed},
                               {"xyz_mm", vector_json(r.xyz_mm)},
                               {"sigma_mm", vector_json(r.sigma_mm)},
                               {"refusal", r.refusal}});
        list.push_back({{"utc", p->utc},
                        {"part", p->part},
                        {"run", p->run},
                        {"status", p->status},
                        {"seconds", p->seconds},
                        {"text", p->text},
                        {"regions", std::move(regions)}});
    }
    return list;
}

nlohmann::json status_alarms_json(const StatusView& v) {
    nlohmann::json list = nlohmann::json::array();
    for (auto a = v.alarms.rbegin(); a != v.alarms.rend(); ++a)
        list.push_back({{"utc", a->utc}, {"level", a->level}, {"text", a->text}});
    return list;
}

std::string status_metrics(const StatusView& v) {
    report::Metrics m;
    const auto label = [](const std::string& text) { return report::Metrics::label(text); };
    const WatchCounts& c = v.counts;
    m.head("seamwright_parts_total", "counter", "Parts that were started.");
    m.value("seamwright_parts_total", static_cast<double>(c.parts));
    m.head("seamwright_runs_total", "counter", "Finished runs by their status.");
    for (const auto& [status, count] : v.runs_by_status)
        m.value(fmt::format("seamwright_runs_total{{status=\"{}\"}}", label(status)),
                static_cast<double>(count));
    m.head("seamwright_outages_total", "counter", "Devices that were lost.");
    m.value("seamwright_outages_total", static_cast<double>(c.lost));
    m.head("seamwright_missed_total", "counter", "Calls that were not measured.");
    m.value("seamwright_missed_total", static_cast<double>(c.missed));
    m.head("seamwright_measuring_seconds_total", "counter", "Duration of all finished runs.");
    m.value("seamwright_measuring_seconds_total", v.measuring_seconds);
    m.head("seamwright_state", "gauge", "1 for the state that the station is in.");
    for (const WatchState s : {WatchState::connecting, WatchState::waiting, WatchState::measuring,
                               WatchState::lost, WatchState::stopped})
        m.value(fmt::format("seamwright_state{{state=\"{}\"}}", to_string(s)), v.state == to_string(s));
    if (v.drift.watched) {
        m.head("seamwright_drift", "gauge", "1 for the verdict of the drift watch.");
        for (const DriftVerdict d : {DriftVerdict::learning, DriftVerdict::fine, DriftVerdict::watch,
                                     DriftVerdict::recalibrate, DriftVerdict::step})
            m.value(fmt::format("seamwright_drift{{verdict=\"{}\"}}", to_string(d)), v.drift.verdict == d);
        m.head("seamwright_drift_stopped", "gauge", "1 while a step is not acknowledged.");
        m.value("seamwright_drift_stopped", v.drift.stopped);
        m.head("seamwright_drift_due", "gauge", "1 while the reference should be measured.");
        m.value("seamwright_drift_due", v.drift.due);
        m.head("seamwright_drift_compensated_mm", "gauge", "What compensation takes off; 0: nothing.");
        m.value("seamwright_drift_compensated_mm",
                v.drift.acting.compensated ? v.drift.acting.shift_mm.norm() : 0);
        m.head("seamwright_drift_level_mm", "gauge", "Off the learnt place, by direction of the watch.");
        for (std::size_t d = 0; d < v.drift.level_mm.size(); ++d)
            m.value(fmt::format("seamwright_drift_level_mm{{direction=\"{}\"}}", d), v.drift.level_mm[d]);
    }
    if (v.parts.empty()) return m.text();
    m.head("seamwright_last_displacement_mm", "gauge", "Displacement of the last part that was solved.");
    for (const StatusRegion& r : v.parts.back().regions)
        for (int k = 0; r.xyz_mm && k < 3; ++k)
            m.value(fmt::format("seamwright_last_displacement_mm{{region=\"{}\",axis=\"{}\"}}", label(r.id),
                                "xyz"[k]),
                    (*r.xyz_mm)[k]);
    m.head("seamwright_last_sigma_mm", "gauge", "Its standard deviation.");
    for (const StatusRegion& r : v.parts.back().regions)
        for (int k = 0; r.sigma_mm && k < 3; ++k)
            m.value(
                fmt::format("seamwright_last_sigma_mm{{region=\"{}\",axis=\"{}\"}}", label(r.id), "xyz"[k]),
                (*r.sigma_mm)[k]);
    return m.text();
}

}  // namespace seamwright
