// The end of a run: frames written or taken back, robots told, each durable in the file before the next.

#include <algorithm>

#include "projects/station/run_release.h"
#include "projects/station/station_impl.h"

namespace seamwright {

// Which robot holds the frame of a region: that of its spots.
RobotLink& Station::Impl::robot_of(const Job& job, const Region& region) {
    return *robots.at(find_spot(job.project, region.spot_ids.front())->robot_id);
}

// The run as judged, durable with all its events.
Expected<void> Station::Impl::store_judged(Job& job) {
    if (job.in_file) return {};
    for (auto& [id, robot] : robots)
        for (const Text& notice : robot->take_notices()) job.event(EventKind::device, id, notice);
    SEAM_OK(file.finish_run(job.run, job.stored));
    for (EventRecord& event : job.run.events) event.run = job.run.number;
    job.in_file = true;
    return {};
}

// Durable. The first event of a push takes the judged run with it into the file: one wait for the disk
// while the robot waits, not two.
Expected<void> Station::Impl::record_event(Job& job, EventKind kind, const std::string& subject,
                                           const Text& text) {
    if (!job.in_file) {
        job.event(kind, subject, text);
        return store_judged(job);
    }
    EventRecord event{0, utc_now(), job.run.number, kind, subject, text};
    SEAM_TRY(auto id, file.append_event(event));
    event.id = id;
    job.run.events.push_back(std::move(event));
    return {};
}

// Tells every robot that measured how the part ended. True when all have acknowledged.
bool Station::Impl::confirm_all(Job& job, PartVerdict verdict) {
    bool all = true;
    for (const std::string& id : job.started_robots) {
        auto told = robots.at(id)->confirm(verdict, job.run.message.english());
        if (told) continue;
        all = false;
        if (job.options.untold) job.options.untold(id, verdict);
        // The run's record stands either way; a file that takes no event has its own Error at the next
        // save.
        (void)record_event(job, EventKind::alarm, id,
                           Text("did not acknowledge \"{}\": {}", to_string(verdict), told.error().text()));
    }
    return all;
}

// Asks the person, then the gate again: meanwhile the robot's mode may have changed.
bool Station::Impl::confirmed(Job& job, std::vector<std::optional<GatePass>>& passes) {
    for (std::size_t k = 0; k < passes.size(); ++k) {
        auto before = robot_of(job, job.project.regions[k]).read_frame(job.project.regions[k].frame_name);
        if (before) job.run.regions[k].push.before = *before;
    }
    const bool yes = job.options.confirm_push(job.run) && !job.options.cancel.stop_requested();
    for (RegionRecord& region : job.run.regions) region.push.before.reset();
    if (yes) {
        passes = judge(job);
        if (std::all_of(passes.begin(), passes.end(), [](const auto& p) { return p.has_value(); }))
            return true;
    }
    job.run.status = yes ? RunStatus::refused : RunStatus::cancelled;
    job.run.message = yes ? verdict(job.run) : "not pushed: not confirmed";
    (void)record_event(job, yes ? EventKind::refusal : EventKind::note, "run", job.run.message);
    return false;
}

EventSink Station::Impl::sink(Job& job) {
    return [this, &job](EventKind kind, const std::string& subject, const Text& text) {
        return record_event(job, kind, subject, text);
    };
}

// The outcome of the run so far, durable.
Expected<void> Station::Impl::store_outcome(Job& job) {
    job.run.finished_utc = utc_now();
    SEAM_OK(store_judged(job));
    return file.update_run(job.run);
}

// Writes all frames, or none. False: taken back, the robots are told, the run is an alarm.
bool Station::Impl::write_all(Job& job, std::vector<std::optional<GatePass>>& passes) {
    // From the first write to the last nothing is cancelled: a part is corrected as a whole or not at
    // all.
    bool alarm = false;
    for (std::size_t i = 0; i < passes.size(); ++i) {
        RegionRecord& region = job.run.regions[i];
        if (alarm) {
            region.push.message = "not pushed: the push of another region went wrong";
            continue;
        }
        region.push = push_region(std::move(*passes[i]), robot_of(job, job.project.regions[i]), sink(job));
        region.push.robot_id = find_spot(job.project, job.project.regions[i].spot_ids.front())->robot_id;
        alarm = region.push.status != PushStatus::written;
        if (alarm) job.run.message = Text("alarm: region {}: {}", region.region_id, region.push.message);
        job.progress(Text("region {}: {}", region.region_id, to_string(region.push.status)));
    }
    if (alarm) job.run.status = RunStatus::alarm;
    return !alarm;
}

// Nobody was allowed to run yet.
void Station::Impl::take_frames_back(Job& job) {
    for (RegionRecord& region : job.run.regions) region.push.release = Release::none;
    restore_frames(job.run, links(), sink(job), EventKind::alarm);
    confirm_all(job, PartVerdict::failed);
}

// Spots whose measure the others contradict took no part in the correction: whoever reads the verdict is told.
static Text with_left_out(const RunRecord& run, const Text& verdict) {
    Text spots;
    for (const RegionRecord& region : run.regions) {
        if (!region.correction) continue;
        for (const SpotResidual& spot : region.correction->spots)
            if (!spot.used)
                spots = joined(spots, ", ", Text("{} ({:.2f} mm)", spot.id, spot.residual_mm.norm()));
    }
    return spots.empty() ? verdict : Text("{}; left out, contradicting the others: {}", verdict, spots);
}

void Station::Impl::push_all(Job& job, std::vector<std::optional<GatePass>>& passes) {
    if (!write_all(job, passes)) return take_frames_back(job);
    job.run.status = RunStatus::pushed;
    job.run.message = verdict(job.run);
    for (RegionRecord& region : job.run.regions) region.push.release = Release::given;
    if (auto stored = store_outcome(job); !stored) {
        job.run.status = RunStatus::alarm;
        job.run.message = Text("alarm: the push cannot be recorded: {}", stored.error().text());
        return take_frames_back(job);
    }
    const HoldOptions hold{job.options.hold, job.options.cancel, job.options.part_over,
                           [&](const Text& text) { job.progress(text); }};
    release_run(job.run, links(job.started_robots),
                with_left_out(job.run, Text("regions corrected and pushed: {}", job.run.regions.size())),
                hold, sink(job));
}

Text Station::Impl::verdict(const RunRecord& run) {
    const auto regions = run.regions.size();
    switch (run.status) {
        case RunStatus::ok:
            if (regions == 0) return "measured; there is no region to correct";
            return with_left_out(run, run.push
                                          ? Text("regions corrected and pushed: {}", regions)
                                          : Text("regions corrected, nothing pushed (dry run): {}", regions));
        case RunStatus::pushed:
            return Text(
                "regions corrected and pushed: {}; whether the application began is not "
                "recorded yet",
                regions);
        case RunStatus::refused: {
            Text text;
            for (const RegionRecord& region : run.regions)
                if (!region.gate_passed && !region.refusals.empty())
                    text =
                        joined(text, "; ", Text("region {}: {}", region.region_id, region.refusals.front()));
            return Text("refused: {}", text);
        }
        case RunStatus::cancelled:
            return "cancelled";
        case RunStatus::interrupted:
            return "the program ended before the pushes were done";
        case RunStatus::alarm:
        case RunStatus::not_taken:
        case RunStatus::device:
            return run.message;
    }
    return {};
}

}  // namespace seamwright
