#include "projects/station/station.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "devices/host_time.h"
#include "devices/registry.h"
#include "projects/drift/drift_keeper.h"
#include "projects/file/file_use.h"
#include "projects/gate/safety_gate.h"
#include "projects/measure/measure.h"
#include "projects/measure/nozzle.h"
#include "projects/model/part_types.h"
#include "projects/station/acquire.h"
#include "projects/station/check.h"
#include "projects/station/run_release.h"
#include "projects/station/spot_light.h"

namespace seamwright {
struct Station::Impl {
    ProjectFile file;
    Project project;
    bool connected = false;
    DeviceSession session;
    std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
    std::map<std::string, std::unique_ptr<RobotLink>> robots;
    std::optional<FileUse> use;  // while real devices are connected

    std::shared_ptr<Recorder> recorder;
    std::map<std::string, std::int64_t> recorded;  // sources of the recording, kept across reconnects

    template <class Add>
    Expected<std::int64_t> recorded_as(const std::string& name, const Add& add) {
        if (const auto known = recorded.find(name); known != recorded.end()) return known->second;
        auto source = add();
        if (source) recorded[name] = *source;
        return source;
    }

    bool writable = true;
    DriftKeeper drift;
    DriftStanding standing;
    PaintFactors paint_factors;  // of the parts before

    Impl(ProjectFile f, Project p) : file(std::move(f)), project(std::move(p)) {}

    // One run in the making.
    struct Job {
        const RunOptions& options;
        Project project;  // of the part's type
        RunRecord run{};
        std::map<std::string, SpotMeasurer> measurers{};
        std::map<std::string, TriggeredFrames> frames{};  // by sensor
        std::vector<std::string> started_robots{};   // and the one that called: they wait for the verdict
        StartedSensors started_sensors{};            // stopped when the robots have it
        std::map<std::string, SensorLight> light{};  // by sensor; set back before they stop
        std::int64_t part_since_ns = 0;
        int done = 0, total = 0;
        StoredMeasurements stored{};
        std::optional<DriftStanding> drift{};  // of a project with a watch
        bool in_file = false;                  // the judged run

        void event(EventKind kind, const std::string& subject, const Text& text) {
            run.events.push_back({0, utc_now(), 0, kind, subject, text});
        }
        void progress(Text text) const {
            if (options.progress) options.progress({done, total, std::move(text)});
        }
        SpotMeasurement& measurement(const std::string& spot_id) {
            return *std::find_if(run.spots.begin(), run.spots.end(),
                                 [&](const SpotMeasurement& m) { return m.spot_id == spot_id; });
        }
    };

    void disconnect() {
        for (auto& [id, sensor] : sensors) sensor->stop();
        sensors.clear();
        robots.clear();
        session = DeviceSession();
        use.reset();
        if (connected) file.keep_write_ahead(false);
        connected = false;
    }

    // Who answers, into the project. A robot that does not tell its name keeps the old one out of the way:
    // none.
    void take_identities() {
        for (SensorSetup& setup : project.sensors)
            if (const auto it = sensors.find(setup.id); it != sensors.end())
                setup.identity = it->second->identity();
        for (RobotSetup& setup : project.robots)
            if (const auto it = robots.find(setup.id); it != robots.end()) {
                auto identity = it->second->identity();
                setup.identity = identity ? *identity : RobotIdentity{};
            }
    }

    Expected<FramePtr> frame_of(Job& job, const Spot& spot, const TriggerEvent& trigger) {
        return job.frames.at(spot.sensor_id)
            .at(trigger, job.options.limits.frame_timeout, job.options.cancel, [&](const Frame& dropped) {
                job.event(EventKind::device, spot.sensor_id,
                          Text("frame {} of spot {} came at spot {} and was dropped", dropped.sequence,
                               dropped.spot_id, spot.id));
            });
    }

    // One more exposure of a spot at which the robot stands; none where it may have gone on. Our own robot goes on
    // when it is asked to.
    Expected<FramePtr> taken_again(Job& job, const Spot& spot, const TriggerEvent& trigger) {
        const auto stands = [&] {
            const RobotSetup* robot = find_robot(job.project, spot.robot_id);
            return (robot && is_own_device(robot->driver)) ||
                   1e-9 * static_cast<double>(host_now_ns() - trigger.host_time_ns) < standing_time_s(spot);
        };
        if (!stands()) return FramePtr();
        SEAM_TRY(auto frame, frame_of(job, spot, trigger));
        return stands() ? frame : FramePtr();
    }

    Expected<void> measure_spot(Job& job, const Spot& spot, const TriggerEvent& trigger) {
        SensorLight& light = job.light.at(spot.sensor_id);
        const bool wired = hardware_triggered(*find_sensor(job.project, spot.sensor_id));
        const bool exposed_as_meant = light.is_ready_for(spot);
        if (!exposed_as_meant && !wired) SEAM_OK(light.ready(spot));
        SEAM_TRY(auto frame, frame_of(job, spot, trigger));
        SpotMeasurer& measurer = job.measurers.at(spot.id);
        SpotMeasurement& result = job.measurement(spot.id);
        if (!exposed_as_meant && wired) {
            Frame other;
            other.status = FrameStatus::incomplete;
            result = measurer.measure(other, trigger.base_from_flange);
            result.status = SpotStatus::not_measured;
            result.message = "the robot fired out of order: it was exposed with another spot's settings";
        } else {
            SEAM_TRY(result, light.measure(
                                 spot, frame, trigger.base_from_flange, measurer,
                                 [&] { return taken_again(job, spot, trigger); },
                                 further_exposures(spot) > 0 && !wired));
        }
        result.part_id = job.run.part_id;
        result.capture = static_cast<int>(job.run.captures.size());
        job.run.captures.push_back(measurer.capture());
        // Of one exposure: from several the stripe cannot be found again in one image.
        if (job.options.keep_images && !frame->image.empty() && frame->status == FrameStatus::ok &&
            (!result.light || result.light->exposures == 1))
            job.run.captures.back().image = keep_image(frame->image);
        if (result.status != SpotStatus::measured)
            job.event(EventKind::note, spot.id,
                      Text("not measured ({}): {}", to_string(result.status), result.message));
        return {};
    }

    // All spots of one robot, in the project's order.
    Expected<void> measure_robot(Job& job, const std::string& robot_id) {
        std::vector<const Spot*> spots;
        for (const Spot& spot : job.project.spots)
            if (spot.enabled && spot.robot_id == robot_id) spots.push_back(&spot);
        RobotLink& robot = *robots.at(robot_id);
        // A sensor stands as its next spot wants it before the robot comes there.
        const auto next_of = [&](const std::string& sensor_id, auto from) -> Expected<void> {
            const auto next =
                std::find_if(from, spots.end(), [&](const Spot* s) { return s->sensor_id == sensor_id; });
            return next == spots.end() ? Expected<void>() : job.light.at(sensor_id).ready(**next);
        };
        for (auto& [id, light] : job.light) SEAM_OK(next_of(id, spots.begin()));
        SEAM_OK(robot.start_measuring(measuring_program(job.project, robot_id)));
        if (robot_id != job.options.caller) job.started_robots.push_back(robot_id);
        std::set<std::string> open;
        for (const Spot* spot : spots) open.insert(spot->id);
        while (!open.empty()) {
            if (job.options.cancel.stop_requested()) return {};
            SEAM_TRY(auto trigger,
                     next_trigger(robot, job.options.limits.trigger_timeout, job.options.cancel));
            const auto spot = std::find_if(spots.begin(), spots.end(),
                                           [&](const Spot* s) { return s->id == trigger.spot_id; });
            if (spot == spots.end() || !open.count(trigger.spot_id))
                return device_error(
                    Text("the robot fired for spot \"{}\", which is {}", trigger.spot_id,
                         spot == spots.end() ? "not in the measuring program" : "measured already"),
                    Text("robot {}", robot_id), "compare the program on the controller with the project");
            SEAM_OK(measure_spot(job, **spot, trigger));
            SEAM_OK(next_of((*spot)->sensor_id, std::next(spot)));
            open.erase(trigger.spot_id);
            ++job.done;
            job.progress(Text("{} {}", (*spot)->id, to_string(job.measurement((*spot)->id).status)));
            if (!open.empty())  // while the robot travels; the last ones go with the judged run
                SEAM_OK(file.append_measured(job.run, job.stored));
        }
        return {};
    }

    Expected<void> measure_all(Job& job) {
        std::vector<std::string> robot_ids, sensor_ids;
        for (const Spot& spot : job.project.spots) {
            if (!spot.enabled) continue;
            if (std::find(robot_ids.begin(), robot_ids.end(), spot.robot_id) == robot_ids.end())
                robot_ids.push_back(spot.robot_id);
            if (std::find(sensor_ids.begin(), sensor_ids.end(), spot.sensor_id) == sensor_ids.end())
                sensor_ids.push_back(spot.sensor_id);
        }
        for (const std::string& id : sensor_ids) {
            SEAM_OK(job.started_sensors.start(*sensors.at(id), job.options.cancel));
            const SensorSetup& setup = *find_sensor(job.project, id);
            job.frames.try_emplace(id, *sensors.at(id), setup);
            std::vector<Spot> enabled;
            std::copy_if(job.project.spots.begin(), job.project.spots.end(), std::back_inserter(enabled),
                         [](const Spot& s) { return s.enabled; });
            SEAM_TRY(auto light,
                     SensorLight::begin(*sensors.at(id), setup, enabled, SensorLight::Look::where_asked,
                                        job.options.paint, &paint_factors));
            job.light.emplace(id, std::move(light));
        }
        for (const std::string& id : robot_ids) {
            if (job.options.cancel.stop_requested()) return {};
            SEAM_OK(measure_robot(job, id));
        }
        if (job.options.cancel.stop_requested()) return {};
        for (auto& [id, frames] : job.frames) SEAM_OK(frames.finish());
        return {};
    }

    GateRequest gate_request(const Job& job, const Region& region, const RegionRecord& record) {
        GateRequest request;
        request.region = region;
        request.correction = *record.correction;
        request.base_from_workobject = job.project.part.base_from_workobject;
        request.part_id = job.run.part_id;
        request.part_since_ns = job.part_since_ns;
        std::string robot_id;
        std::map<std::string, RobotIdentity> answered;  // by robot; a question may be a round trip
        for (const std::string& id : region.spot_ids) {
            const Spot* spot = find_spot(job.project, id);
            if (!spot) continue;  // the gate misses it
            GateSpot g;
            g.id = id;
            g.required = spot->required;
            g.reference = spot->reference_state;
            for (const SpotMeasurement& m : job.run.spots)
                if (m.spot_id == id && m.status == SpotStatus::measured) {
                    g.measured = true;
                    g.part_id = m.part_id;
                    g.measured_at_ns = m.host_time_ns;
                }
            if (const Calibration* calibration = calibration_of(job.project, *spot)) {
                g.point_workobject_mm = job.project.part.base_from_workobject.inverse() *
                                        spot->base_from_flange * calibration->flange_from_sensor *
                                        spot->reference_mm;
                g.calibration_id = calibration->id;
                g.calibration_verdict = calibration->verdict;
                g.calibrated_utc = calibration->created_utc;
                g.collided_utc = last_collision(job.project, spot->robot_id);
                g.calibrated_sensor = calibration->sensor_identity;
                g.calibrated_robot = calibration->robot_identity;
            }
            // Asked anew: a cable may have been put on another sensor since the start.
            if (const auto it = sensors.find(spot->sensor_id); it != sensors.end())
                g.sensor = it->second->identity();
            if (const auto it = robots.find(spot->robot_id); it != robots.end()) {
                const auto [asked, first] = answered.try_emplace(spot->robot_id);
                if (first)
                    if (auto identity = it->second->identity()) asked->second = *identity;
                g.robot = asked->second;
            }
            if (robot_id.empty()) robot_id = spot->robot_id;
            request.spots.push_back(std::move(g));
        }
        request.mode = RobotMode::fault;  // a robot that does not answer is not ready
        if (const auto it = robots.find(robot_id); it != robots.end()) {
            if (auto mode = it->second->mode()) request.mode = *mode;
            request.tells_mode = it->second->tells_mode();
            if (job.run.push) {
                if (auto now = it->second->read_frame(region.frame_name))
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
        request.calibration_age_days = job.project.requirements.calibration_age_days;
        request.now_utc = utc_now();
        request.now_ns = host_now_ns();
        return request;
    }

    // What the drift watch says of what was measured, before any of it is judged.
    Expected<void> watch_drift(Job& job) {
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
    std::vector<std::optional<GatePass>> judge(Job& job) {
        std::vector<std::optional<GatePass>> passes;
        for (std::size_t i = 0; i < job.run.regions.size(); ++i) {
            RegionRecord& record = job.run.regions[i];
            const Region& region = job.project.regions[i];
            passes.emplace_back();
            if (record.correction) {
                record.base_from_frame =
                    corrected_frame(job.project.part.base_from_workobject, record.correction->displacement,
                                    region.base_from_frame);
                GateVerdict verdict = pass_gate(gate_request(job, region, record));
                record.refusals = std::move(verdict.reasons);
                if (verdict.pass) passes.back().emplace(std::move(*verdict.pass));
            }
            record.gate_passed = passes.back().has_value();
            for (const Text& reason : record.refusals)
                job.event(EventKind::refusal, record.region_id, reason);
        }
        return passes;
    }

    // Which robot holds the frame of a region: that of its spots.
    RobotLink& robot_of(const Job& job, const Region& region) {
        return *robots.at(find_spot(job.project, region.spot_ids.front())->robot_id);
    }

    // The run as judged, durable with all its events.
    Expected<void> store_judged(Job& job) {
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
    Expected<void> record_event(Job& job, EventKind kind, const std::string& subject, const Text& text) {
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
    bool confirm_all(Job& job, PartVerdict verdict) {
        bool all = true;
        for (const std::string& id : job.started_robots) {
            auto told = robots.at(id)->confirm(verdict, job.run.message.english());
            if (told) continue;
            all = false;
            // The run's record stands either way; a file that takes no event has its own Error at the next
            // save.
            (void)record_event(
                job, EventKind::alarm, id,
                Text("did not acknowledge \"{}\": {}", to_string(verdict), told.error().text()));
        }
        return all;
    }

    // Asks the person, then the gate again: meanwhile the robot's mode may have changed.
    bool confirmed(Job& job, std::vector<std::optional<GatePass>>& passes) {
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

    EventSink sink(Job& job) {
        return [this, &job](EventKind kind, const std::string& subject, const Text& text) {
            return record_event(job, kind, subject, text);
        };
    }

    // The outcome of the run so far, durable.
    Expected<void> store_outcome(Job& job) {
        job.run.finished_utc = utc_now();
        SEAM_OK(store_judged(job));
        return file.update_run(job.run);
    }

    // Writes all frames, or none. False: taken back, the robots are told, the run is an alarm.
    bool write_all(Job& job, std::vector<std::optional<GatePass>>& passes) {
        // From the first write to the last nothing is cancelled: a part is corrected as a whole or not at
        // all.
        bool alarm = false;
        for (std::size_t i = 0; i < passes.size(); ++i) {
            RegionRecord& region = job.run.regions[i];
            if (alarm) {
                region.push.message = "not pushed: the push of another region went wrong";
                continue;
            }
            region.push =
                push_region(std::move(*passes[i]), robot_of(job, job.project.regions[i]), sink(job));
            region.push.robot_id = find_spot(job.project, job.project.regions[i].spot_ids.front())->robot_id;
            alarm = region.push.status != PushStatus::written;
            if (alarm) job.run.message = Text("alarm: region {}: {}", region.region_id, region.push.message);
            job.progress(Text("region {}: {}", region.region_id, to_string(region.push.status)));
        }
        if (alarm) job.run.status = RunStatus::alarm;
        return !alarm;
    }

    // Nobody was allowed to run yet.
    void take_frames_back(Job& job) {
        for (RegionRecord& region : job.run.regions) region.push.release = Release::none;
        restore_frames(job.run, links(), sink(job), EventKind::alarm);
        confirm_all(job, PartVerdict::failed);
    }

    // By id: all of the project, or those that measured and wait for the verdict.
    std::map<std::string, RobotLink*> links() const {
        std::map<std::string, RobotLink*> all;
        for (const auto& [id, robot] : robots) all[id] = robot.get();
        return all;
    }
    std::map<std::string, RobotLink*> links(const std::vector<std::string>& ids) const {
        std::map<std::string, RobotLink*> some;
        for (const std::string& id : ids) some[id] = robots.at(id).get();
        return some;
    }

    void push_all(Job& job, std::vector<std::optional<GatePass>>& passes) {
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
                    Text("regions corrected and pushed: {}", job.run.regions.size()), hold, sink(job));
    }

    static Text verdict(const RunRecord& run) {
        const auto regions = run.regions.size();
        switch (run.status) {
            case RunStatus::ok:
                if (regions == 0) return "measured; there is no region to correct";
                return run.push ? Text("regions corrected and pushed: {}", regions)
                                : Text("regions corrected, nothing pushed (dry run): {}", regions);
            case RunStatus::pushed:
                return Text(
                    "regions corrected and pushed: {}; whether the application began is not "
                    "recorded yet",
                    regions);
            case RunStatus::refused: {
                Text text;
                for (const RegionRecord& region : run.regions)
                    if (!region.gate_passed && !region.refusals.empty())
                        text = joined(text, "; ",
                                      Text("region {}: {}", region.region_id, region.refusals.front()));
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
};

Station::Station(ProjectFile file, Project project)
    : impl_(std::make_unique<Impl>(std::move(file), std::move(project))) {}
Station::Station(Station&&) noexcept = default;
Station& Station::operator=(Station&&) noexcept = default;
Station::~Station() {
    if (impl_) impl_->disconnect();
}

Expected<Station> Station::open(const std::filesystem::path& path, FileAccess access) {
    SEAM_TRY(auto file, ProjectFile::open(path, access));
    SEAM_TRY(auto project, file.load());
    Station station(std::move(file), std::move(project));
    station.impl_->writable = access == FileAccess::read_write;
    return station;
}

const Project& Station::project() const {
    return impl_->project;
}
ProjectFile& Station::file() {
    return impl_->file;
}
void Station::record_to(std::shared_ptr<Recorder> recorder) {
    impl_->recorder = std::move(recorder);
    impl_->recorded.clear();
}

bool Station::connected() const {
    return impl_->connected;
}
void Station::disconnect() {
    impl_->disconnect();
}

ProfileSource* Station::sensor(const std::string& id) {
    const auto it = impl_->sensors.find(id);
    return it == impl_->sensors.end() ? nullptr : it->second.get();
}

RobotLink* Station::robot(const std::string& id) {
    const auto it = impl_->robots.find(id);
    return it == impl_->robots.end() ? nullptr : it->second.get();
}

Expected<void> Station::edit(const Project& project) {
    SEAM_OK(impl_->file.save(project));
    impl_->project = project;
    return {};
}

void Station::use(const Project& project) {
    impl_->project = project;
}

Expected<void> Station::connect(const Patience& patience) {
    Impl& i = *impl_;
    i.disconnect();
    const auto alone = [](const auto& setups) {
        return std::any_of(setups.begin(), setups.end(),
                           [](const auto& setup) { return !is_own_device(setup.driver); });
    };
    if (alone(i.project.sensors) || alone(i.project.robots)) {
        SEAM_TRY(auto use, FileUse::take(i.file.path(), FileUse::For::devices));
        i.use = std::move(use);
    }
    const auto give_up = [&](Error error, const Text& where) {
        i.disconnect();
        error.within(where);
        return tl::unexpected(std::move(error));
    };
    for (const SensorSetup& setup : i.project.sensors) {
        auto sensor = open_sensor(setup.driver, setup.settings, i.session, patience);
        if (!sensor) return give_up(sensor.error(), Text("sensor {}", setup.id));
        if (i.recorder) {
            auto source = i.recorded_as("sensor " + setup.id, [&] {
                return i.recorder->add_sensor(setup.id, (*sensor)->identity());
            });
            if (!source) return give_up(source.error(), Text("sensor {}", setup.id));
            *sensor = record_sensor(std::move(*sensor), i.recorder, *source);
        }
        i.sensors[setup.id] = std::move(*sensor);
    }
    for (const RobotSetup& setup : i.project.robots) {
        auto robot = open_robot(setup.driver, setup.settings, i.session);
        if (!robot) return give_up(robot.error(), Text("robot {}", setup.id));
        auto identity = (*robot)->identity();
        if (!identity) return give_up(identity.error(), Text("robot {}", setup.id));
        if (i.recorder) {
            auto source = i.recorded_as("robot " + setup.id,
                                        [&] { return i.recorder->add_robot(setup.id, *identity); });
            if (!source) return give_up(source.error(), Text("robot {}", setup.id));
            *robot = record_robot(std::move(*robot), i.recorder, *source);
        }
        i.robots[setup.id] = std::move(*robot);
    }
    i.connected = true;
    i.file.keep_write_ahead(true);
    i.take_identities();
    if (i.writable) resolve_release(i.file, i.links());
    return {};
}

void Station::connect(std::map<std::string, std::unique_ptr<ProfileSource>> sensors,
                      std::map<std::string, std::unique_ptr<RobotLink>> robots) {
    impl_->disconnect();
    impl_->sensors = std::move(sensors);
    impl_->robots = std::move(robots);
    impl_->connected = true;
    impl_->file.keep_write_ahead(true);
    impl_->take_identities();
    if (impl_->writable) resolve_release(impl_->file, impl_->links());
}

const DriftStanding& Station::drift() const {
    return impl_->standing;
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
    for (const Spot& spot : job.project.spots) {
        if (!spot.enabled) continue;
        SEAM_TRY(auto measurer, SpotMeasurer::make(job.project, spot.id));
        if (!i.sensors.count(spot.sensor_id) || !i.robots.count(spot.robot_id))
            return input_error("its sensor or robot is not connected", Text("spot {}", spot.id));
        job.measurers.insert_or_assign(spot.id, std::move(measurer));
        SpotMeasurement m;
        m.spot_id = spot.id;
        m.message = "no frame came";
        run.spots.push_back(std::move(m));
    }
    if (run.spots.empty() && !type.empty())
        return input_error(Text("no spot of part type {} is enabled", type), i.file.path().string(),
                           "teach a spot of it first");
    if (run.spots.empty())
        return input_error("no spot is enabled", i.file.path().string(),
                           i.project.panel_jobs.empty()
                               ? "teach a spot first"
                               : "teach a spot, or run its panel job (seamwright panel)");

    SEAM_TRY(const auto setup, RunSetup::of(job.project));

    run.part_id = options.part_id;
    run.type_id = type;
    run.push = options.push && !job.project.regions.empty();  // a reference is measured alone
    run.started_utc = run.finished_utc = utc_now();
    run.status = RunStatus::interrupted;
    run.message = "the program ended while the part was measured";
    // Begun before the robot moves: a file that cannot be written stops the run here.
    SEAM_TRY(auto number, i.file.begin_run(run, setup));
    run.number = number;
    if (run.part_id.empty()) run.part_id = fmt::format("run {}", run.number);
    run.status = RunStatus::ok;
    job.part_since_ns = host_now_ns();
    job.total = static_cast<int>(run.spots.size());
    if (!options.paint.empty())
        job.event(EventKind::note, "run",
                  knows_paint(job.project, options.paint)
                      ? Text("the paint is {}", options.paint)
                      : Text("the paint is {}, which no spot knows: measured with the spots' own settings",
                             options.paint));

    if (i.robots.count(options.caller)) job.started_robots.push_back(options.caller);
    auto measured = i.measure_all(job);
    const bool cancelled = options.cancel.stop_requested();
    if (measured && !cancelled)
        if (auto watched = i.watch_drift(job); !watched) {
            i.confirm_all(job, PartVerdict::failed);
            return tl::unexpected(watched.error());
        }
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
        passes = i.judge(job);
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

    // The judged run is in the file before the first frame goes to a robot. If one region is refused none is
    // pushed: half a part corrected is worse than a stopped line.
    bool pushing = options.push && run.status == RunStatus::ok && !passes.empty();
    if (pushing) run.status = RunStatus::interrupted;
    run.message = Impl::verdict(run);
    run.finished_utc = utc_now();
    // A push that nobody is asked about stores it with its first attempt.
    if (!pushing || options.confirm_push)
        if (auto judged = i.store_judged(job); !judged) {
            i.confirm_all(job, PartVerdict::failed);
            return tl::unexpected(judged.error());
        }
    if (pushing && options.confirm_push && !i.confirmed(job, passes)) {
        pushing = false;
        if (auto updated = i.file.update_run(run); !updated) {
            i.confirm_all(job, PartVerdict::failed);
            return tl::unexpected(updated.error());
        }
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
