#include "projects/panel/panel_station.h"

#include <algorithm>

#include "projects/panel/panel_run.h"
#include "projects/station/acquire.h"
#include "projects/station/check.h"

namespace seamwright {

Expected<PanelJob> teach_panel(Station& station, const PanelJob& draft, const TeachOptions& options) {
    const Text where("panel job {}", draft.id);
    if (options.repeats < 1 || options.repeats > 1000)
        return usage_error(Text("{} repeats", options.repeats), where, "give 1 to 1000");
    SEAM_TRY(auto places, panel_running::prepare(station, draft));
    std::vector<SoftwareTriggered> by_software;
    StartedSensors started;
    for (const auto& [id, sensor] : places.sensors) {
        SEAM_TRY(auto software, SoftwareTriggered::begin(*sensor));
        by_software.push_back(std::move(software));
        SEAM_OK(started.start(*sensor));
    }
    struct Sum {
        Eigen::Vector3d panel = Eigen::Vector3d::Zero(), body = Eigen::Vector3d::Zero();
        double gap = 0, flush = 0, surface = 0;
        int count = 0;
        Profile profile;
        Text reason;
    };
    std::vector<Sum> sums(places.measurers.size());
    PanelJob taught = draft;
    const AcquireLimits limits;
    for (int round = 0; round < options.repeats; ++round) {
        SEAM_TRY(auto at, stand_at(*places.robot, draft.id, draft.base_from_gripper));
        taught.base_from_gripper = at;
        for (std::size_t i = 0; i < sums.size(); ++i) {
            if (options.cancel.stop_requested()) return device_error(kCancelled, where);
            PanelMeasurer& measurer = places.measurers[i];
            std::vector<FramePtr> frames;
            for (const std::string& id : panel_running::sensors_of(measurer.place())) {
                ProfileSource& sensor = *places.sensors.at(id);
                SEAM_OK(sensor.trigger(draft.id));
                SEAM_TRY(auto frame, next_frame(sensor, limits.frame_timeout, options.cancel));
                frames.push_back(std::move(frame));
            }
            const PanelMeasurement m =
                measurer.measure(*frames[0], frames.size() > 1 ? frames[1].get() : nullptr, at);
            Sum& sum = sums[i];
            if (m.status != SpotStatus::measured) {
                sum.reason = m.message;
                continue;
            }
            sum.panel += m.panel_mm;
            sum.body += m.body_mm;
            sum.gap += m.gap_mm;
            sum.flush += m.flush_mm;
            sum.surface += measurer.surface_deg();
            if (sum.count++ == 0) sum.profile = measurer.profile();
        }
        if (options.progress)
            options.progress(
                {round + 1, options.repeats, Text("{}: {} of {}", draft.id, round + 1, options.repeats)});
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const Sum& sum = sums[i];
        const std::string& id = places.measurers[i].place().id;
        if (2 * sum.count < options.repeats || sum.count == 0)
            return input_error(Text("panel and body were measured in {} of {} repeats ({})", sum.count,
                                    options.repeats, sum.reason),
                               Text("{}, place {}", where, id), "choose another window or move the sensor");
        auto& place = *std::find_if(taught.places.begin(), taught.places.end(),
                                    [&](const PanelPlace& p) { return p.id == id; });
        place.panel_reference_mm = sum.panel / sum.count;
        place.body_reference_mm = sum.body / sum.count;
        place.gap_mm = sum.gap / sum.count;
        place.flush_mm = sum.flush / sum.count;
        place.surface_deg = sum.surface / sum.count;
        place.reference_profile = sum.profile;
    }
    return taught;
}

bool is_taught(const PanelJob& job) {
    return std::all_of(job.places.begin(), job.places.end(), [](const PanelPlace& p) {
        return !p.enabled || p.panel_reference_mm != p.body_reference_mm;
    });
}

Expected<RunRecord> run_panel(Station& station, const std::string& job_id, const RunOptions& options) {
    const std::string path = station.file().path().string();
    if (!station.connected())
        return usage_error("the station is not connected to its devices", path, "connect first");
    const PanelJob* found = find_panel_job(station.project(), job_id);
    if (!found) return input_error(Text("there is no panel job \"{}\"", job_id), path);
    const PanelJob job = *found;
    SEAM_OK(none_of_motion(motion_findings(station.project(), job, options.push)));
    SEAM_TRY(auto places, panel_running::prepare(station, job));
    return panel_running::PanelRun(station, job, places, options).run();
}

}  // namespace seamwright
