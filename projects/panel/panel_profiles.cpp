#include "projects/panel/panel_profiles.h"

#include <algorithm>

#include "projects/measure/measure.h"
#include "projects/panel/panel_measure.h"

namespace seamwright {
namespace {

// Both laser planes are one (double_head.h): y is dropped.
Profile placed(const Pose& place_from_head, Profile profile) {
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const Eigen::Vector3d p = place_from_head * Eigen::Vector3d(profile.x_mm[i], 0, profile.z_mm[i]);
        profile.x_mm[i] = p.x();
        profile.z_mm[i] = p.z();
    }
    return profile;
}

}  // namespace

Expected<std::vector<PlaceProfiles>> place_profiles(const Project& project, const PanelJob& job,
                                                    const RunRecord& run,
                                                    std::span<const PanelMeasurement> measured) {
    std::vector<PlaceProfiles> all;
    const auto capture = [&](int index) {
        return index >= 0 && index < static_cast<int>(run.captures.size())
                   ? &run.captures[static_cast<std::size_t>(index)]
                   : nullptr;
    };
    for (const PanelMeasurement& m : measured) {
        const auto place = std::find_if(job.places.begin(), job.places.end(),
                                        [&](const PanelPlace& p) { return p.id == m.place_id; });
        if (place == job.places.end()) continue;
        SEAM_TRY(auto measurer, PanelMeasurer::make(project, job, *place));
        PlaceProfiles& out = all.emplace_back();
        out.place_id = m.place_id;
        out.sensor_ids = {place->sensor_id};
        if (measurer.heads() == 2) out.sensor_ids.push_back(place->second_sensor_id);
        const bool seen = m.status == SpotStatus::measured;
        const Eigen::Vector3d middle =
            0.5 * (seen ? m.panel_mm + m.body_mm : place->panel_reference_mm + place->body_reference_mm);
        out.middle_mm = {middle.x(), middle.z()};
        const Capture* first = capture(m.capture);
        if (!first) continue;
        (void)measurer.measure(*first, capture(m.second_capture));
        const Pose place_from_gripper = gripper_from_place(project, *place)->inverse();
        for (int k = 0; k < measurer.heads(); ++k) {
            const Calibration* c = calibration_of(project, out.sensor_ids[static_cast<std::size_t>(k)]);
            out.heads.push_back(placed(place_from_gripper * c->flange_from_sensor, measurer.head_profile(k)));
        }
        out.merged = measurer.profile();
    }
    return all;
}

Expected<MeasuredPanel> with_profiles(const Project& project, RunRecord run) {
    MeasuredPanel out;
    const PanelJob* job = run.panel ? find_panel_job(project, run.panel->job_id) : nullptr;
    if (!job) return input_error("the run is none of a panel job of the project", Text("run {}", run.number));
    out.job = *job;
    SEAM_TRY(out.before, place_profiles(project, out.job, run, run.panel->before));
    SEAM_TRY(out.after, place_profiles(project, out.job, run, run.panel->after));
    run.captures.clear();
    out.run = std::move(run);
    return out;
}

}  // namespace seamwright
