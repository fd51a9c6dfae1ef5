#pragma once
// Runs of production made by hand: what a region's correction found, without any device.

#include <fmt/format.h>

#include "core/geometry/notation.h"
#include "projects/statistics/production.h"
#include "tests/projects/sample_project.h"

namespace seamwright {

inline Project production_project() {
    Project p = sample_project();
    p.name = "door";
    p.regions.front().limits = {5, 2};
    p.regions.front().free = {true, true, true, false, true, true};
    // Every run keeps the setup that it was made with: a small one is stored fast.
    for (Spot& spot : p.spots) spot.reference_profile = {}, spot.feature.template_profile = {};
    for (PanelPlace& place : p.panel_jobs.front().places) place.reference_profile = {};
    p.panel_jobs.front().gap_tolerance_mm = 0.7;
    return p;
}

// A part every minute from `start_s` on, 9.5 s each.
inline RunRecord production_run(int minute, const Eigen::Vector3d& shift_mm, double c_deg = 0,
                                std::int64_t start_s = 1'714'564'800) {
    RunRecord run;
    run.part_id = fmt::format("car {}", minute);
    run.started_utc = utc_text(start_s + 60 * minute);
    run.finished_utc = utc_text(start_s + 60 * minute + 9);
    run.finished_utc.replace(20, 3, "500");
    run.push = true;
    run.status = RunStatus::ok;
    RegionRecord region;
    region.region_id = "edge";
    region.gate_passed = true;
    region.correction.emplace();
    region.correction->status = CorrectionStatus::ok;
    region.correction->displacement.workobject_from_movedworkobject =
        make_pose(rotation_from_kuka({0, 0, c_deg}), shift_mm);
    run.regions.push_back(region);
    return run;
}

inline RunRecord refused_run(int minute, Text why,
                             CorrectionStatus status = CorrectionStatus::under_determined,
                             const Eigen::Vector3d& shift_mm = Eigen::Vector3d::Zero()) {
    RunRecord run = production_run(minute, shift_mm);
    run.status = RunStatus::refused;
    run.regions.front().gate_passed = false;
    run.regions.front().correction->status = status;
    run.regions.front().refusals = {std::move(why)};
    return run;
}

}  // namespace seamwright
