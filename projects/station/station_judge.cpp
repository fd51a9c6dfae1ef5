// The judging of a run: what the drift watch says of it, what its regions are corrected by, what the gate says of that.

#include <algorithm>

#include "devices/host_time.h"
#include "projects/measure/nozzle.h"
#include "projects/station/station_impl.h"

namespace seamwright {

// `answered`: who the robots said that they are; a question may be a round trip.
GateSpot Station::Impl::gate_spot(const Job& job, const Spot& spot,
                                  std::map<std::string, RobotIdentity>& answered) {
    GateSpot g;
    g.id = spot.id;
    g.required = spot.required;
    g.reference = spot.reference_state;
    for (const SpotMeasurement& m : job.run.spots)
        if (m.spot_id == spot.id && m.status == SpotStatus::measured) {
            g.measured = true;
            g.part_id = m.part_id;
            g.measured_at_ns = m.host_time_ns;
        }
    if (const Calibration* calibration = calibration_of(job.project, spot)) {
        g.point_workobject_mm = job.project.part.base_from_workobject.inverse() * spot.base_from_flange *
                                calibration->flange_from_sensor * spot.reference_mm;
        g.calibration_id = calibration->id;
        g.calibration_verdict = calibration->verdict;
        g.calibrated_utc = calibration->created_utc;
        g.collided_utc = last_collision(job.project, spot.robot_id);
        g.calibrated_sensor = calibration->sensor_identity;
        g.calibrated_robot = calibration->robot_identity;
    }
    // Asked anew: a cable may have been put on another sensor since the start.
    if (const auto it = sensors.find(spot.sensor_id); it != sensors.end()) g.sensor = it->second->identity();
    if (const auto it = robots.find(spot.robot_id); it != robots.end()) {
        const auto [asked, first] = answered.try_emplace(spot.robot_id);
        if (first)
            if (auto identity = it->second->identity()) asked->second = *identity;
        g.robot = asked->second;
    }
    return g;
}

// The robot that holds the region's frame: its mode, what stands in the frame, its nozzle.
void Station::Impl::ask_robot(const Job& job, const std::string& robot_id, GateRequest& request) {
    request.mode = RobotMode::fault;  // a robot that does not answer is not ready
    if (const auto it = robots.find(robot_id); it != robots.end()) {
        if (auto mode = it->second->mode()) request.mode = *mode;
        request.tells_mode = it->second->tells_mode();
        if (job.run.push) {
            if (auto now = it->second->read_frame(request.region.frame_name))
                request.base_from_frame_now = *now;
            else
                request.frame_trouble = now.error().text();
        }
    }
    if (const RobotSetup* robot = find_robot(job.project, robot_id))
        request.required_mode = robot->required_mode;
    if (const Calibration* nozzle = nozzle_of(job.project, robot_id)) {
        request.nozzle_sigma_mm = nozzle_sigma_mm(*nozzle);
        request.nozzle_trouble = nozzle_trouble(job.project, robot_id);
    }
}

// A limit, a calibration or a collision that somebody has entered meanwhile counts for this part, too.
Text Station::Impl::project_trouble() const {
    const auto edits = measuring_edits(file);
    if (!edits) return edits.error().text();
    return edits->empty() ? Text() : Text("{}: measure again", said_of(edits->front()));
}

GateRequest Station::Impl::gate_request(const Job& job, const Region& region, const RegionRecord& record) {
    GateRequest request;
    request.region = region;
    request.correction = *record.correction;
    request.base_from_workobject = job.project.part.base_from_workobject;
    request.part_id = job.run.part_id;
    request.part_since_ns = job.part_since_ns;
    std::string robot_id;
    std::map<std::string, RobotIdentity> answered;
    for (const std::string& id : region.spot_ids) {
        const Spot* spot = find_spot(job.project, id);
        if (!spot) continue;  // the gate misses it
        if (robot_id.empty()) robot_id = spot->robot_id;
        request.spots.push_back(gate_spot(job, *spot, answered));
    }
    ask_robot(job, robot_id, request);
    for (const Region& other : job.project.regions)
        if (&other != &region) request.other_frames.push_back(other.frame_name);
    for (const Region& other : project.regions) {
        const Spot* first = other.spot_ids.empty() ? nullptr : find_spot(project, other.spot_ids.front());
        if (other.type_id != region.type_id && same_frame(other.frame_name, region.frame_name) && first &&
            first->robot_id == robot_id)
            request.frame_of_other_types.push_back(other);
    }
    for (const PanelJob& other : job.project.panel_jobs) request.other_frames.push_back(other.frame_name);
    if (job.drift) request.drift_trouble = job.drift->trouble;
    request.project_trouble = project_trouble();
    request.calibration_age_days = job.project.requirements.calibration_age_days;
    request.now_utc = utc_now();
    request.now_ns = host_now_ns();
    return request;
}

// What the drift watch says of what was measured, before any of it is judged.
Expected<void> Station::Impl::watch_drift(Job& job) {
    SEAM_TRY(DriftTaken taken, drift.take(file, project, job.run));
    standing = taken.standing;
    if (!standing.watched) return {};
    const DriftPoint* point = taken.point ? &*taken.point : nullptr;
    if (taken.stopped_now)
        job.event(EventKind::alarm, "drift watch", point->text);
    else if (point && taken.worse)
        job.event(EventKind::note, "drift watch", point->text);
    if (standing.acting.compensated || !standing.acting.why.empty())
        job.event(EventKind::note, "drift watch", said_of(standing.acting));
    job.drift = std::move(taken.standing);
    return {};
}

// Judges all regions before the first is pushed.
std::vector<std::optional<GatePass>> Station::Impl::judge(Job& job) {
    std::vector<std::optional<GatePass>> passes;
    for (std::size_t i = 0; i < job.run.regions.size(); ++i) {
        RegionRecord& record = job.run.regions[i];
        const Region& region = job.project.regions[i];
        passes.emplace_back();
        if (record.correction) {
            record.base_from_frame = corrected_frame(job.project.part.base_from_workobject,
                                                     record.correction->displacement, region.base_from_frame);
            GateVerdict verdict = pass_gate(gate_request(job, region, record));
            record.refusals = std::move(verdict.reasons);
            if (verdict.pass) passes.back().emplace(std::move(*verdict.pass));
        }
        record.gate_passed = passes.back().has_value();
        for (const Text& reason : record.refusals) job.event(EventKind::refusal, record.region_id, reason);
    }
    return passes;
}

}  // namespace seamwright
