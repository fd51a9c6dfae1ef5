#include "projects/panel/panel_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "devices/host_time.h"
#include "projects/measure/measure.h"
#include "projects/measure/nozzle.h"
#include "projects/station/acquire.h"
#include "projects/station/check.h"

namespace seamwright::panel_running {

std::vector<std::string> sensors_of(const PanelPlace& place) {
    std::vector<std::string> ids{place.sensor_id};
    if (!place.second_sensor_id.empty()) ids.push_back(place.second_sensor_id);
    return ids;
}

Expected<Places> prepare(Station& station, const PanelJob& job) {
    Places out;
    const Text where("panel job {}", job.id);
    out.robot = station.robot(job.robot_id);
    if (!out.robot)
        return usage_error(Text("its robot \"{}\" is not connected", job.robot_id), where, "connect first");
    for (const PanelPlace& place : job.places) {
        if (!place.enabled) continue;
        SEAM_TRY(auto measurer, PanelMeasurer::make(station.project(), job, place));
        for (const std::string& id : sensors_of(place)) {
            ProfileSource* sensor = station.sensor(id);
            if (!sensor)
                return usage_error(Text("sensor \"{}\" is not connected", id), where, "connect first");
            if (!out.sensors.emplace(id, sensor).second)
                return input_error(Text("sensor \"{}\" is used at two places", id), where,
                                   "a sensor sees one place");
        }
        out.measurers.push_back(std::move(measurer));
    }
    if (out.measurers.empty()) return input_error("no place is enabled", where, "add places to the job");
    return out;
}

namespace {
MeasuringMove move_of(const PanelJob& job, const Pose& base_from_gripper) {
    MeasuringMove move;
    move.spot_id = job.id;
    move.entry = move.trigger = move.exit = base_from_gripper;
    move.stop_at_trigger = true;
    return move;
}
}  // namespace

Expected<RunRecord> PanelRun::run() {
    SEAM_OK(begin());
    std::optional<GatePass> pass = measure_and_judge();
    const bool pushing = options_.push && pass;
    if (pushing) run_.status = RunStatus::interrupted;
    SEAM_OK(store_or_tell());
    if (pushing && confirmed(pass))
        move_and_verify(std::move(*pass));
    else
        tell_not_moved();
    return end();
}

Expected<void> PanelRun::begin() {
    SEAM_TRY(const auto setup, RunSetup::of(station_.project()));
    run_.part_id = options_.part_id;
    run_.push = options_.push;
    run_.started_utc = run_.finished_utc = utc_now();
    run_.status = RunStatus::interrupted;
    run_.message = "the program ended while the panel was measured";
    run_.panel.emplace();
    run_.panel->job_id = job_.id;
    run_.panel->push.frame_name = job_.frame_name;
    SEAM_TRY(auto number, station_.file().begin_run(run_, setup));
    run_.number = number;
    if (run_.part_id.empty()) run_.part_id = fmt::format("run {}", run_.number);
    since_ns_ = host_now_ns();
    return {};
}

Expected<void> PanelRun::store_or_tell() {
    if (auto stored = store_judged(); !stored) {
        tell(PartVerdict::failed);
        return tl::unexpected(stored.error());
    }
    return {};
}

void PanelRun::tell_not_moved() {
    tell(run_.status == RunStatus::device || run_.status == RunStatus::cancelled ? PartVerdict::failed
                                                                                 : PartVerdict::refused);
}

Expected<RunRecord> PanelRun::end() {
    SEAM_OK(record_outcome(run_, [&] { return store_outcome(); }));
    station_.file().checkpoint();
    return std::move(run_);
}

void PanelRun::progress(int done, Text text) const {
    if (options_.progress)
        options_.progress({done, static_cast<int>(places_.measurers.size()), std::move(text)});
}

Expected<void> PanelRun::event(EventKind kind, const std::string& subject, const Text& text) {
    EventRecord e{0, utc_now(), 0, kind, subject, text};
    if (judged_) {
        e.run = run_.number;
        SEAM_TRY(auto id, station_.file().append_event(e));
        e.id = id;
    }
    run_.events.push_back(std::move(e));
    return {};
}

Expected<void> PanelRun::measure(const Pose& base_from_gripper, std::vector<PanelMeasurement>& into,
                                 Pose& stands_at) {
    into.clear();
    for (PanelMeasurer& m : places_.measurers) {
        PanelMeasurement& none = into.emplace_back();
        none.place_id = m.place().id;
        none.message = "no frame came";
    }
    StartedSensors started;
    std::map<std::string, TriggeredFrames> frames;
    for (const auto& [id, sensor] : places_.sensors) {
        SEAM_OK(started.start(*sensor));
        frames.try_emplace(id, *sensor, *find_sensor(station_.project(), id));
    }
    SEAM_OK(places_.robot->start_measuring({move_of(job_, base_from_gripper)}));
    ++starts_;
    SEAM_TRY(auto trigger, next_trigger(*places_.robot, options_.limits.trigger_timeout, cancel_));
    if (trigger.spot_id != job_.id)
        return device_error(Text("the robot fired for \"{}\"", trigger.spot_id),
                            Text("panel job {}", job_.id),
                            "compare the program on the controller with the project");
    stands_at = trigger.base_from_flange.value_or(base_from_gripper);
    SEAM_OK(pose_from_matrix(stands_at.matrix(), "pose reported at the trigger"));
    for (std::size_t i = 0; i < places_.measurers.size(); ++i) {
        if (cancelled()) return device_error(kCancelled, Text("panel job {}", job_.id));
        PanelMeasurer& measurer = places_.measurers[i];
        std::vector<FramePtr> got;
        for (const std::string& id : sensors_of(measurer.place())) {
            SEAM_TRY(
                auto frame,
                frames.at(id).at(trigger, options_.limits.frame_timeout, cancel_, [&](const Frame& dropped) {
                    (void)event(EventKind::device, id,
                                Text("frame {} came too early and was dropped", dropped.sequence));
                }));
            got.push_back(std::move(frame));
        }
        keep(measurer, got, trigger.base_from_flange, into[i]);
        progress(static_cast<int>(i) + 1, Text("{} {}", into[i].place_id, to_string(into[i].status)));
    }
    for (auto& [id, f] : frames) SEAM_OK(f.finish());
    return {};
}

void PanelRun::keep(PanelMeasurer& measurer, const std::vector<FramePtr>& frames,
                    const std::optional<Pose>& reported, PanelMeasurement& into) {
    into = measurer.measure(*frames[0], frames.size() > 1 ? frames[1].get() : nullptr, reported);
    into.part_id = run_.part_id;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        (k ? into.second_capture : into.capture) = static_cast<int>(run_.captures.size());
        run_.captures.push_back(measurer.capture(static_cast<int>(k)));
        if (options_.keep_images && !frames[k]->image.empty() && frames[k]->status == FrameStatus::ok)
            run_.captures.back().image = keep_image(frames[k]->image);
    }
    if (into.status != SpotStatus::measured)
        (void)event(EventKind::note, into.place_id,
                    Text("not measured ({}): {}", to_string(into.status), into.message));
}

GateRequest PanelRun::gate_request(RegionCorrection correction,
                                   const std::vector<PanelMeasurement>& measured) {
    GateRequest request;
    Region& region = request.region;
    region.id = job_.id;
    region.limits = job_.limits;
    region.sigma_limit_mm = job_.sigma_limit_mm;
    region.sigma_limit_deg = job_.sigma_limit_deg;
    region.frame_name = job_.frame_name;
    region.base_from_frame = job_.base_from_frame;
    request.correction = std::move(correction);
    request.base_from_workobject = job_.base_from_gripper;
    request.part_id = run_.part_id;
    request.part_since_ns = since_ns_;
    const Project& project = station_.project();
    const auto robot = places_.robot->identity();
    for (const PanelMeasurement& m : measured) {
        const auto measurer =
            std::find_if(places_.measurers.begin(), places_.measurers.end(),
                         [&](const PanelMeasurer& p) { return p.place().id == m.place_id; });
        const PanelPlace& place = measurer->place();
        for (const std::string& sensor_id : sensors_of(place)) {
            GateSpot g;
            g.id = sensor_id == place.sensor_id ? place.id : place.id + " (second head)";
            g.required = place.required;
            g.measured = m.status == SpotStatus::measured;
            g.part_id = m.part_id;
            g.measured_at_ns = m.host_time_ns;
            if (const Calibration* c = calibration_of(project, sensor_id)) {
                if (const auto stands = gripper_from_place(project, place))
                    g.point_workobject_mm = *stands * place.body_reference_mm;
                g.calibration_id = c->id;
                g.calibration_verdict = c->verdict;
                g.calibrated_utc = c->created_utc;
                g.collided_utc = last_collision(project, job_.robot_id);
                g.calibrated_sensor = c->sensor_identity;
                g.calibrated_robot = c->robot_identity;
            }
            g.sensor = places_.sensors.at(sensor_id)->identity();
            if (robot) g.robot = *robot;
            region.spot_ids.push_back(g.id);
            request.spots.push_back(std::move(g));
        }
    }
    const auto mode = places_.robot->mode();
    request.mode = mode ? *mode : RobotMode::fault;
    request.tells_mode = places_.robot->tells_mode();
    if (run_.push) {
        if (auto now = places_.robot->read_frame(job_.frame_name))
            request.base_from_frame_now = *now;
        else
            request.frame_trouble = now.error().text();
    }
    for (const Region& other : project.regions) request.other_frames.push_back(other.frame_name);
    for (const PanelJob& other : project.panel_jobs)
        if (other.id != job_.id) request.other_frames.push_back(other.frame_name);
    request.calibration_age_days = project.requirements.calibration_age_days;
    request.now_utc = utc_now();
    if (const RobotSetup* setup = find_robot(project, job_.robot_id))
        request.required_mode = setup->required_mode;
    request.now_ns = host_now_ns();
    return request;
}

std::optional<GatePass> PanelRun::judge() {
    panel().refusals = panel().fit && panel().fit->status == CorrectionStatus::ok
                           ? beyond_tolerance(job_, *panel().fit)
                           : std::vector<Text>{};
    std::optional<GatePass> pass;
    if (panel().fit) {
        GateVerdict verdict = pass_gate(gate_request(
            motion_as_correction(job_, panel().base_from_gripper, *panel().fit), panel().before));
        for (Text& reason : verdict.reasons) panel().refusals.push_back(std::move(reason));
        if (panel().refusals.empty() && verdict.pass) pass.emplace(std::move(*verdict.pass));
    } else {
        compute_panel(station_.project(), job_, panel());  // says why
    }
    panel().gate_passed = pass.has_value();
    for (const Text& reason : panel().refusals) (void)event(EventKind::refusal, job_.id, reason);
    return pass;
}

std::optional<GatePass> PanelRun::measure_and_judge() {
    panel().base_from_gripper = job_.base_from_gripper;
    auto measured = measure(job_.base_from_gripper, panel().before, panel().base_from_gripper);
    compute_panel(station_.project(), job_, panel());
    std::optional<GatePass> pass;
    if (cancelled()) {
        run_.status = RunStatus::cancelled;
        panel().refusals = {"the run was cancelled"};
        run_.message = "cancelled";
        (void)event(EventKind::note, "run", "cancelled");
    } else if (!measured) {
        run_.status = RunStatus::device;
        run_.message = measured.error().text();
        panel().refusals = {Text("the measuring was not finished: {}", run_.message)};
        (void)event(EventKind::device, "run", run_.message);
    } else {
        if (auto judged = judge()) pass.emplace(std::move(*judged));
        run_.status = pass ? RunStatus::ok : RunStatus::refused;
        run_.message = pass ? Text("the panel would be moved, nothing was pushed (dry run)")
                            : Text("refused: {}", panel().refusals.front());
    }
    return pass;
}

Expected<void> PanelRun::store_judged() {
    run_.finished_utc = utc_now();
    for (const Text& notice : places_.robot->take_notices())
        (void)event(EventKind::device, job_.robot_id, notice);
    auto stored = station_.file().finish_run(run_, stored_);
    judged_ = true;
    stored_.captures = run_.captures.size();
    for (EventRecord& e : run_.events) e.run = run_.number;
    return stored;
}

Expected<void> PanelRun::store_outcome() {
    run_.finished_utc = utc_now();
    if (run_.captures.size() > stored_.captures) SEAM_OK(station_.file().append_measured(run_, stored_));
    return station_.file().update_run(run_);
}

EventSink PanelRun::sink() {
    return [this](EventKind kind, const std::string& subject, const Text& text) {
        return event(kind, subject, text);
    };
}

bool PanelRun::confirmed(std::optional<GatePass>& pass) {
    if (!options_.confirm_push) return true;
    if (auto before = places_.robot->read_frame(job_.frame_name)) panel().push.before = *before;
    const bool yes = options_.confirm_push(run_) && !cancelled();
    panel().push.before.reset();
    if (yes) {
        pass.reset();
        if (auto again = judge()) {
            pass.emplace(std::move(*again));
            return true;
        }
    }
    run_.status = yes ? RunStatus::refused : RunStatus::cancelled;
    run_.message = yes ? Text("refused: {}", panel().refusals.front()) : Text("not pushed: not confirmed");
    (void)event(yes ? EventKind::refusal : EventKind::note, "run", run_.message);
    return false;
}

bool PanelRun::tell(PartVerdict verdict, const Text& text) {
    if (starts_ == 0) return true;
    auto told = places_.robot->confirm(verdict, text.english());
    if (!told)
        (void)event(EventKind::alarm, job_.robot_id,
                    Text("did not acknowledge \"{}\": {}", to_string(verdict), told.error().text()));
    return told.has_value();
}

void PanelRun::take_back_motion(RunStatus status, Text message) {
    run_.status = status;
    run_.message = std::move(message);
    const PartVerdict verdict = status == RunStatus::refused ? PartVerdict::refused : PartVerdict::failed;
    panel().push.release = Release::withdrawn;
    if (starts_ > 1) {  // the second start of measuring took the permission back already
        tell(verdict);
    } else {
        const RobotRelease back = take_back(*places_.robot, verdict, run_.message, true);
        panel().push.release = back.release;
        if (back.release != Release::withdrawn) {
            run_.status = RunStatus::alarm;
            run_.message = joined(run_.message, "; ", back.text);
            (void)event(EventKind::alarm, job_.robot_id, back.text);
        }
    }
    restore_frames(run_, link(), sink(), EventKind::alarm);
    if (panel().push.status == PushStatus::not_restored) run_.status = RunStatus::alarm;
}

bool PanelRun::record_pushed(const char* message) {
    run_.status = RunStatus::pushed;
    run_.message = message;
    panel().push.release = Release::given;
    auto stored = store_outcome();
    if (stored) return true;
    panel().push.release = Release::none;
    run_.status = RunStatus::alarm;
    run_.message = Text("alarm: the push cannot be recorded: {}", stored.error().text());
    return false;
}

void PanelRun::move_and_verify(GatePass pass) {
    cancel_ = {};
    panel().push = push_region(std::move(pass), *places_.robot, sink());
    panel().push.robot_id = job_.robot_id;
    progress(0, Text("{}: {}", job_.frame_name, to_string(panel().push.status)));
    if (panel().push.status != PushStatus::written) {
        run_.status = RunStatus::alarm;
        run_.message = Text("alarm: {}", panel().push.message);
        tell(PartVerdict::failed);
        return;
    }
    if (!record_pushed("the frame is pushed; whether the panel was moved by it is not recorded yet")) {
        restore_frames(run_, link(), sink(), EventKind::alarm);
        tell(PartVerdict::failed);
        return;
    }
    if (!tell(PartVerdict::corrected, "moved, to be measured again"))
        return take_back_motion(RunStatus::alarm, "alarm: the robot did not acknowledge the corrected frame");
    auto measured = measure_moved();
    panel().verdict = judge_panel(job_, panel().after);
    if (!measured)
        return take_back_motion(RunStatus::device,
                                Text("not verified after the motion: {}", measured.error().text()));
    judge_moved_and_release();
}

Expected<void> PanelRun::measure_moved() {
    const Pose target = panel().base_from_moved_gripper;
    Pose stands_at = target;
    SEAM_OK(measure(target, panel().after, stands_at));
    if (distance_mm(stands_at, target) > kArrivedMm ||
        deg_from_rad(angle_rad(stands_at, target)) > kArrivedDeg)
        return device_error(Text("the robot fired {:.2f} mm and {:.3f} degrees off the corrected position",
                                 distance_mm(stands_at, target), deg_from_rad(angle_rad(stands_at, target))),
                            Text("robot {}", job_.robot_id),
                            Text("let its program run in frame {}", job_.frame_name));
    return {};
}

void PanelRun::judge_moved_and_release() {
    if (panel().verdict == PanelVerdict::not_verified)
        return take_back_motion(RunStatus::refused,
                                "not verified: a required place was not measured after the motion");
    if (panel().verdict == PanelVerdict::out_of_tolerance)
        return take_back_motion(RunStatus::refused, Text("out of tolerance after the motion: {}",
                                                         beyond_tolerance(job_, panel().after).front()));
    if (!record_pushed("the panel was moved and lies in tolerance; whether the application began is not "
                       "recorded yet"))
        return take_back_motion(RunStatus::alarm, run_.message);
    const HoldOptions hold{options_.hold, options_.cancel, options_.part_over, [&](const Text& text) {
                               progress(static_cast<int>(places_.measurers.size()), text);
                           }};
    release_run(run_, link(), "the panel was moved and lies in tolerance", hold, sink());
}

}  // namespace seamwright::panel_running
