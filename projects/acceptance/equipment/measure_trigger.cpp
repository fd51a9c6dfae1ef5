#include "projects/acceptance/equipment/measure_trigger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "projects/acceptance/study/stored_values.h"
#include "projects/measure/measure.h"
#include "projects/station/check.h"
#include "projects/station/program.h"
#include "projects/station/teach.h"

namespace seamwright {
namespace {

constexpr double kSlopeStep_mm = 1;
constexpr double kLeastJitter_mm = 0.01, kMostJitter_mm = 100;  // what a spot's field takes

// Ready to be passed.
struct TriggerTask {
    Spot spot;
    Pose flange_from_sensor = Pose::Identity();
    std::vector<double> speeds_mm_s;
};

// How far the feature moves per mm of travel by the curve that was learnt; 0 where none was.
double slope_by_curve(const Spot& spot, double travel_deg) {
    const double a = rad_from_deg(travel_deg);
    Eigen::Vector2d slope(-std::sin(a), 0);
    if (spot.curve)
        slope += std::cos(a) * Eigen::Vector2d(spot.curve->x_coefficients[0], spot.curve->z_coefficients[0]);
    if (!(spot.weights.x() > 0)) slope.x() = 0;
    if (!(spot.weights.z() > 0)) slope.y() = 0;
    return slope.norm();
}

Expected<TriggerTask> task_of(const Project& project, const MeasureTriggerOptions& options) {
    if (!(std::abs(options.travel_deg) <= 90))
        return usage_error(Text("a travel of {} degrees from the sensor's Y", options.travel_deg),
                           "trigger study", "give -90 to 90");
    if (options.passes < 2 || options.passes > 1000)
        return usage_error(Text("{} passes", options.passes), "trigger study", "give 2 to 1000");
    const Spot* spot = options.spot_id.empty() ? nullptr : find_spot(project, options.spot_id);
    if (!options.spot_id.empty() && !spot)
        return input_error(Text("there is no spot \"{}\"", options.spot_id), "spots");
    if (!spot)
        for (const Spot& s : project.spots)
            if (s.enabled && calibration_of(project, s) &&
                (!spot || slope_by_curve(s, options.travel_deg) > slope_by_curve(*spot, options.travel_deg)))
                spot = &s;
    if (!spot)
        return input_error("no enabled spot is calibrated", "trigger study", "teach and calibrate first");
    const Calibration* calibration = calibration_of(project, *spot);
    if (!calibration)
        return input_error("its sensor has no calibration", Text("spot {}", spot->id), "calibrate it");
    TriggerTask task{*spot, calibration->flange_from_sensor, options.speeds_mm_s};
    task.spot.enabled = true;
    if (task.speeds_mm_s.empty())
        task.speeds_mm_s = {spot->speed_mm_s / 4, spot->speed_mm_s / 2, spot->speed_mm_s};
    std::sort(task.speeds_mm_s.begin(), task.speeds_mm_s.end());
    const auto same = std::adjacent_find(task.speeds_mm_s.begin(), task.speeds_mm_s.end());
    if (task.speeds_mm_s.size() < kTriggerSpeeds || same != task.speeds_mm_s.end() ||
        task.speeds_mm_s.size() > 20)
        return usage_error(Text("{} speeds", task.speeds_mm_s.size()), "trigger study",
                           Text("give {} to 20 different ones", kTriggerSpeeds));
    // What a run at that speed would be refused for, but for the latency, which is measured here.
    Project fastest = project;
    for (Spot& s : fastest.spots)
        if (s.id == spot->id) s.enabled = true;
    for (const double speed : {task.speeds_mm_s.front(), task.speeds_mm_s.back()}) {
        for (Spot& s : fastest.spots)
            if (s.id == spot->id) s.speed_mm_s = speed;
        SEAM_OK(none_of_motion(standing_findings(fastest)));
    }
    return task;
}

Text pass_that_would_see(const TravelSight& sight) {
    const Text found(
        "The feature moves by {:.3f} mm per mm of travel, sigma {:.3f}; {:.2f} are needed, known to a "
        "tenth.",
        sight.slope.norm(), sight.slope_sigma, kLeastSlope);
    if (sight.x && std::abs(sight.travel_deg) < 1)
        return Text(
            "{} The contour runs along the travel: pass across it with --travel-deg 45 where the way is "
            "free, or over a spot whose contour lies oblique.",
            found);
    return Text("{} Choose another spot or another --travel-deg.", found);
}

std::map<std::string, double> jitter_by_spot(const Project& project, const Spot& spot,
                                             const TriggerStudy& study) {
    std::map<std::string, double> out;
    for (const Spot& s : project.spots)
        if (s.robot_id == spot.robot_id && s.sensor_id == spot.sensor_id && !s.stop_at_trigger)
            out[s.id] = std::clamp(study.half_width_mm(s.speed_mm_s), kLeastJitter_mm, kMostJitter_mm);
    return out;
}

// From the passes to what is said of them.
Expected<void> judge_passes(MeasuredTrigger& m, const Project& setup, const std::string& file) {
    m.source.file = file;
    m.source.part_name = setup.part.name;
    m.source.runs = static_cast<int>(m.passes.passes.size());
    const Spot* spot = find_spot(setup, m.passes.spot_id);
    if (spot) {
        name_devices(m.source, setup, *spot);
        m.speed_mm_s = spot->speed_mm_s;
    }
    if (!m.unseen.empty()) return {};
    SEAM_TRY(auto study, trigger_study(m.passes.passes, m.passes.slope_sigma / m.passes.slope.norm()));
    m.study = std::move(study);
    if (spot) m.jitter_mm = jitter_by_spot(setup, *spot, *m.study);
    const double cut_mm = 1e-3 * m.study->latency_ms * m.speed_mm_s;
    m.source.remarks.push_back(
        Text("At the spot's {:.0f} mm/s the cut lies {:.3f} mm past the taught pose; a tenth more or less of "
             "override moves it by {:.3f} mm.",
             m.speed_mm_s, cut_mm, std::abs(cut_mm) / 10));
    if (spot && spot->feature.kind == "contour-end")
        m.source.remarks.emplace_back(
            "The end of a contour errs by the pixel that it falls on, differently where the stopped passes "
            "do not "
            "look: the limits may be too narrow. Take a template or a corner.");
    if (m.study->latency_limits_ms.contains(0))
        m.source.remarks.emplace_back("The latency is not told from none.");
    if (!m.study->jitter_seen())
        m.source.remarks.emplace_back(
            "The jitter is not told from the robot's and the sensor's scatter: its upper limit is taken.");
    if (m.passes.not_found > 0)
        m.source.remarks.push_back(
            Text("Passes left out because the feature was not found: {}.", m.passes.not_found));
    return {};
}

// The rounds of passes. Whatever ends them, the robot's application does not run.
class TriggerRounds {
  public:
    TriggerRounds(Station& station, const TriggerTask& task, const TravelSight& sight,
                  const MeasureTriggerOptions& options)
        : station_(station), task_(task), sight_(sight), options_(options) {}

    Expected<void> drive(TriggerPasses& out) {
        SEAM_TRY(auto measurer, SpotMeasurer::make(station_.project(), task_.spot.id));
        ProfileSource& sensor = *station_.sensor(task_.spot.sensor_id);
        RobotLink& robot = *station_.robot(task_.spot.robot_id);
        std::vector<MeasuringMove> moves =
            trigger_moves(task_.spot, task_.flange_from_sensor, options_.travel_deg, task_.speeds_mm_s);
        StartedSensors started;
        SEAM_OK(started.start(sensor, options_.cancel));
        TriggeredFrames frames(sensor, *find_sensor(station_.project(), task_.spot.sensor_id));
        const int total = options_.passes * static_cast<int>(moves.size());
        int done = 0;
        for (int round = 0; round < options_.passes; ++round) {
            if (auto begun = robot.start_measuring(moves); !begun) {
                Error error = begun.error();
                if (error.mend.empty())
                    error.mend = "load the program of the passes: seamwright measure-trigger --program DIR";
                return tl::unexpected(std::move(error));
            }
            for (const MeasuringMove& move : moves) {
                if (auto passed = pass(robot, frames, move, measurer, out); !passed) {
                    (void)robot.confirm(PartVerdict::failed, "trigger study");  // the pass's own Error counts
                    return passed;
                }
                if (options_.progress)
                    options_.progress({++done, total, Text("{}: {} of {}", task_.spot.id, done, total)});
            }
            SEAM_OK(robot.confirm(PartVerdict::refused, "trigger study"));
        }
        return frames.finish();
    }

  private:
    Expected<void> pass(RobotLink& robot, TriggeredFrames& frames, const MeasuringMove& move,
                        SpotMeasurer& measurer, TriggerPasses& out) {
        if (options_.cancel.stop_requested())
            return device_error(ErrorCode::cancelled, "cancelled", Text("spot {}", task_.spot.id));
        SEAM_TRY(auto trigger, next_trigger(robot, options_.limits.trigger_timeout, options_.cancel));
        if (trigger.spot_id != move.spot_id)
            return device_error(
                Text("the robot fired for \"{}\" where \"{}\" was due", trigger.spot_id, move.spot_id),
                Text("robot {}", task_.spot.robot_id),
                "load the program of the passes: seamwright measure-trigger --program DIR");
        SEAM_TRY(auto frame, frames.at(trigger, options_.limits.frame_timeout, options_.cancel, {}));
        const SpotMeasurement& m = measurer.measure(*frame, trigger.base_from_flange);
        double travel = sight_.travel_of(m.feature.point_mm);
        if (const auto& told = measurer.capture().base_from_flange) {
            const double a = rad_from_deg(options_.travel_deg);
            const Pose taught_from_told = (task_.spot.base_from_flange * task_.flange_from_sensor).inverse() *
                                          *told * task_.flange_from_sensor;
            travel -= taught_from_told.translation().dot(Eigen::Vector3d(std::sin(a), std::cos(a), 0));
        }
        if (m.status != SpotStatus::measured || !std::isfinite(travel)) {
            ++out.not_found;
            return {};
        }
        const Eigen::Vector3d way = move.exit.translation() - move.entry.translation();
        const Eigen::Vector3d forward = (task_.spot.base_from_flange * task_.flange_from_sensor).linear() *
                                        Eigen::Vector3d(std::sin(rad_from_deg(options_.travel_deg)),
                                                        std::cos(rad_from_deg(options_.travel_deg)), 0);
        const bool backward = way.dot(forward) < 0;
        out.passes.push_back(
            {move.stop_at_trigger ? 0 : (backward ? -move.speed_mm_s : move.speed_mm_s), backward, travel});
        return {};
    }

    Station& station_;
    const TriggerTask& task_;
    const TravelSight& sight_;
    const MeasureTriggerOptions& options_;
};

RobotSetup* robot_setup(Project& project, const std::string& id) {
    for (RobotSetup& robot : project.robots)
        if (robot.id == id) return &robot;
    return nullptr;
}

void set_trigger(Project& project, const std::string& robot_id, double latency_ms,
                 const std::map<std::string, double>& jitter_mm) {
    if (RobotSetup* robot = robot_setup(project, robot_id)) robot->trigger_latency_ms = latency_ms;
    for (Spot& s : project.spots)
        if (const auto at = jitter_mm.find(s.id); at != jitter_mm.end()) s.jitter_mm = at->second;
}

Expected<void> set_trigger(Station& station, const std::string& robot_id, double latency_ms,
                           const std::map<std::string, double>& jitter_mm) {
    Project project = station.project();
    set_trigger(project, robot_id, latency_ms, jitter_mm);
    return station.edit(project);
}

}  // namespace

std::vector<MeasuringMove> trigger_moves(const Spot& spot, const Pose& flange_from_sensor, double travel_deg,
                                         const std::vector<double>& speeds_mm_s) {
    const double a = rad_from_deg(travel_deg);
    const Eigen::Vector3d along =
        (spot.base_from_flange * flange_from_sensor).linear() * Eigen::Vector3d(std::sin(a), std::cos(a), 0);
    MeasuringMove there = measuring_move(spot, flange_from_sensor);
    there.via.clear();
    there.entry.translation() = there.trigger.translation() - spot.entry_mm * along;
    there.exit.translation() = there.trigger.translation() + spot.exit_mm * along;
    MeasuringMove back = there;
    std::swap(back.entry, back.exit);
    std::vector<MeasuringMove> moves;
    std::vector<double> all{0};
    all.insert(all.end(), speeds_mm_s.begin(), speeds_mm_s.end());
    for (const double speed : all)
        for (const bool backward : {false, true}) {
            MeasuringMove& move = moves.emplace_back(backward ? back : there);
            move.spot_id = fmt::format("{}_{}{:g}", spot.id, backward ? "B" : "F", speed);
            move.stop_at_trigger = speed == 0;
            move.speed_mm_s = speed == 0 ? speeds_mm_s.front() : speed;
        }
    moves.front().via = spot.via;
    return moves;
}

Expected<ProgramRequest> trigger_program(const Project& project, const MeasureTriggerOptions& options) {
    SEAM_TRY(auto task, task_of(project, options));
    auto request = program_request(project, RobotId(task.spot.robot_id));
    if (!request) return request;
    request->frames.clear();
    request->moves = trigger_moves(task.spot, task.flange_from_sensor, options.travel_deg, task.speeds_mm_s);
    return request;
}

Expected<MeasuredTrigger> measure_trigger(Station& station, const MeasureTriggerOptions& options) {
    const Project setup = station.project();
    SEAM_TRY(auto task, task_of(setup, options));
    const Spot& spot = task.spot;
    MeasuredTrigger measured;
    PassOptions slowly;
    slowly.step_mm = kSlopeStep_mm;
    slowly.cancel = options.cancel;
    slowly.progress = options.progress;
    auto pass = record_pass(station, spot, slowly);  // says if it is not connected
    if (!pass) return tl::unexpected(pass.error());
    auto sight =
        travel_sight(pass->references, options.travel_deg, spot.weights.x() > 0, spot.weights.z() > 0);
    if (!sight) {
        Error error = sight.error();
        error.within(Text("spot {}", spot.id));
        return tl::unexpected(error);
    }
    TriggerPasses& passes = measured.passes;
    passes.spot_id = spot.id;
    passes.travel_deg = options.travel_deg;
    passes.slope = sight->slope;
    passes.slope_sigma = sight->slope_sigma;
    passes.replaced_latency_ms = find_robot(setup, spot.robot_id)->trigger_latency_ms;
    for (const Spot& s : setup.spots) passes.replaced_jitter_mm[s.id] = s.jitter_mm;
    if (!sight->sees()) {
        measured.unseen = pass_that_would_see(*sight);
    } else {
        SEAM_OK(TriggerRounds(station, task, *sight, options).drive(passes));
        if (passes.not_found > static_cast<int>(passes.passes.size()))
            return input_error(
                Text("the feature was found in {} of {} measurements ({})", passes.passes.size(),
                     passes.passes.size() + static_cast<std::size_t>(passes.not_found),
                     to_string(SpotStatus::no_feature)),
                Text("spot {}", spot.id), "choose another feature or move the sensor");
    }
    SEAM_OK(judge_passes(measured, setup, station.file().path().filename().string()));
    if (!measured.study || !options.keep) return measured;
    SEAM_OK(station.file().append_evidence({0, {}, 0, passes}, setup));
    measured.utc = utc_now();
    SEAM_OK(set_trigger(station, spot.robot_id, measured.study->latency_ms, measured.jitter_mm));
    return measured;
}

void apply(const MeasuredTrigger& measured, Project& project) {
    const Spot* spot = find_spot(project, measured.passes.spot_id);
    if (!spot || !measured.study) return;
    const std::string robot_id = spot->robot_id;
    set_trigger(project, robot_id, measured.study->latency_ms, measured.jitter_mm);
}

Expected<std::optional<MeasuredTrigger>> stored_trigger_study(const ProjectFile& file,
                                                              const Project* project_now) {
    SEAM_TRY(auto evidence, file.evidence());
    for (auto e = evidence.rbegin(); e != evidence.rend(); ++e) {
        const auto* passes = std::get_if<TriggerPasses>(&e->what);
        if (!passes) continue;
        SEAM_TRY(auto setup, file.load_setup(e->setup));
        MeasuredTrigger measured;
        measured.passes = *passes;
        measured.utc = e->utc;
        SEAM_OK(judge_passes(measured, setup, file.path().filename().string()));
        SEAM_TRY(auto project, project_now ? Expected<Project>(*project_now) : file.load());
        StudySource now;
        if (const Spot* spot = find_spot(project, passes->spot_id)) name_devices(now, project, *spot);
        if (now.robot_serial != measured.source.robot_serial ||
            now.sensor_serial != measured.source.sensor_serial)
            measured.source.remarks.emplace_back("Robot or sensor is another one by now: measure again.");
        return std::optional(std::move(measured));
    }
    return std::nullopt;
}

Expected<void> undo_trigger_study(Station& station) {
    SEAM_TRY(auto stored, stored_trigger_study(station.file()));
    const Spot* spot = stored ? find_spot(station.project(), stored->passes.spot_id) : nullptr;
    if (!spot) return input_error("no study of the trigger is stored", station.file().path().string());
    std::map<std::string, double> before;
    for (const auto& [id, jitter] : stored->jitter_mm)
        if (const auto at = stored->passes.replaced_jitter_mm.find(id);
            at != stored->passes.replaced_jitter_mm.end())
            before.insert(*at);
    return set_trigger(station, spot->robot_id, stored->passes.replaced_latency_ms, before);
}

}  // namespace seamwright
