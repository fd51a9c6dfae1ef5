// A run from its first look at the project to its record, step by step.

#include <fmt/format.h>

#include <algorithm>

#include "devices/host_time.h"
#include "projects/model/part_types.h"
#include "projects/station/check.h"
#include "projects/station/run_release.h"
#include "projects/station/station_impl.h"

namespace seamwright {

// Spots made ready to be measured, and a record of each as not measured.
Expected<void> Station::Impl::prepare(Job& job) {
    RunRecord& run = job.run;
    for (const Spot& spot : job.project.spots) {
        if (!spot.enabled) continue;
        SEAM_TRY(auto measurer, SpotMeasurer::make(job.project, spot.id));
        if (!sensors.count(spot.sensor_id) || !robots.count(spot.robot_id))
            return input_error("its sensor or robot is not connected", Text("spot {}", spot.id));
        job.measurers.insert_or_assign(spot.id, std::move(measurer));
        SpotMeasurement m;
        m.spot_id = spot.id;
        run.spots.push_back(std::move(m));
    }
    if (run.spots.empty() && !run.type_id.empty())
        return input_error(Text("no spot of part type {} is enabled", run.type_id), file.path().string(),
                           "teach a spot of it first");
    if (run.spots.empty())
        return input_error("no spot is enabled", file.path().string(),
                           project.panel_jobs.empty()
                               ? "teach a spot first"
                               : "teach a spot, or run its panel job (seamwright panel)");
    return {};
}

// Before the robot moves: a file that cannot be written stops the run here.
Expected<void> Station::Impl::begin(Job& job) {
    SEAM_TRY(const auto setup, RunSetup::of(job.project));
    RunRecord& run = job.run;
    run.part_id = job.options.part_id;
    run.push = job.options.push && !job.project.regions.empty();  // a reference is measured alone
    run.started_utc = run.finished_utc = utc_now();
    run.status = RunStatus::interrupted;
    run.message = "the program ended while the part was measured";
    SEAM_TRY(auto number, file.begin_run(run, setup));
    run.number = number;
    if (run.part_id.empty()) run.part_id = fmt::format("run {}", run.number);
    run.status = RunStatus::ok;
    job.part_since_ns = host_now_ns();
    job.total = static_cast<int>(run.spots.size());
    const std::string& paint = job.options.paint;
    if (!paint.empty())
        job.event(
            EventKind::note, "run",
            knows_paint(job.project, paint)
                ? Text("the paint is {}", paint)
                : Text("the paint is {}, which no spot knows: measured with the spots' own settings", paint));
    if (robots.count(job.options.caller)) job.started_robots.push_back(job.options.caller);
    return {};
}

// What the measurements say of the regions, and what the gate says of that. A pass for each region, or where nothing is
// judged none at all.
std::vector<std::optional<GatePass>> Station::Impl::conclude(Job& job, const Expected<void>& measured,
                                                             bool cancelled) {
    RunRecord& run = job.run;
    run.regions = correct_regions(job.project, run.spots, job.drift ? &job.drift->acting : nullptr);
    for (const RegionRecord& region : run.regions)
        if (region.offset) job.event(EventKind::note, region.region_id, said_of(*region.offset));
    std::vector<std::optional<GatePass>> passes;
    if (!measured && !cancelled) {
        run.status = RunStatus::device;
        run.message = measured.error().text();
        job.event(EventKind::device, "run", run.message);
        for (RegionRecord& region : run.regions)
            region.refusals.push_back(Text("the measuring was not finished: {}", run.message));
    } else if (cancelled) {
        run.status = RunStatus::cancelled;
        job.event(EventKind::note, "run", "cancelled");
        for (RegionRecord& region : run.regions) region.refusals.push_back("the run was cancelled");
    } else {
        passes = judge(job);
        const bool all = !passes.empty() && std::all_of(passes.begin(), passes.end(),
                                                        [](const auto& p) { return p.has_value(); });
        run.status = all ? RunStatus::ok : RunStatus::refused;
        if (run.regions.empty()) run.status = RunStatus::ok;  // only measured
    }
    for (std::size_t k = 0; k < run.regions.size(); ++k)
        if (run.regions[k].correction)
            run.regions[k].base_from_frame = corrected_frame(job.project.part.base_from_workobject,
                                                             run.regions[k].correction->displacement,
                                                             job.project.regions[k].base_from_frame);
    return passes;
}

// A file that fails before anything is pushed.
tl::unexpected<Error> Station::Impl::failed(Job& job, const Error& error) {
    confirm_all(job, PartVerdict::failed);
    return tl::unexpected(error);
}

Expected<RunRecord> Station::run(const RunOptions& options) {
    Impl& i = *impl_;
    if (!i.connected)
        return usage_error("the station is not connected to its devices", i.file.path().string(),
                           "connect first");
    SEAM_OK(check_part_types(i.project));
    SEAM_TRY(const auto type, called_type(i.project, options.part_type));
    Impl::Job job{.options = options, .project = of_type(i.project, type)};
    SEAM_OK(none_of_motion(motion_findings(job.project, options.push)));
    RunRecord& run = job.run;
    run.type_id = type;
    SEAM_OK(i.prepare(job));
    SEAM_OK(i.begin(job));

    const auto measured = i.measure_all(job);
    const bool cancelled = options.cancel.stop_requested();
    for (SpotMeasurement& m : run.spots)
        if (m.status == SpotStatus::not_measured && m.message.empty())
            m.message = cancelled ? Text("the run was cancelled before a frame came") : Text("no frame came");
    if (measured && !cancelled)
        if (auto watched = i.watch_drift(job); !watched) return i.failed(job, watched.error());
    auto passes = i.conclude(job, measured, cancelled);

    // The judged run is in the file before the first frame goes to a robot. If one region is refused none is
    // pushed: half a part corrected is worse than a stopped line.
    bool pushing = options.push && run.status == RunStatus::ok && !passes.empty();
    if (pushing) run.status = RunStatus::interrupted;
    run.message = Impl::verdict(run);
    run.finished_utc = utc_now();
    // A push that nobody is asked about stores it with its first attempt.
    if (!pushing || options.confirm_push)
        if (auto judged = i.store_judged(job); !judged) return i.failed(job, judged.error());
    if (pushing && options.confirm_push && !i.confirmed(job, passes)) {
        pushing = false;
        if (auto updated = i.file.update_run(run); !updated) return i.failed(job, updated.error());
    }
    if (pushing) {
        i.push_all(job, passes);
        SEAM_OK(record_outcome(run, [&] { return i.store_outcome(job); }));
    } else {
        i.confirm_all(job, run.status == RunStatus::device || run.status == RunStatus::cancelled
                               ? PartVerdict::failed
                               : PartVerdict::refused);
    }
    i.file.checkpoint();
    return run;
}

}  // namespace seamwright
