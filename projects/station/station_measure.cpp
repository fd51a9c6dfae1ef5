// The measuring of a run: every robot through its spots, every spot with its frame.

#include <algorithm>

#include "devices/host_time.h"
#include "projects/station/station_impl.h"

namespace seamwright {

Expected<FramePtr> Station::Impl::frame_of(Job& job, const Spot& spot, const TriggerEvent& trigger) {
    return job.frames.at(spot.sensor_id)
        .at(trigger, job.options.limits.frame_timeout, job.options.cancel, [&](const Frame& dropped) {
            job.event(EventKind::device, spot.sensor_id,
                      Text("frame {} of spot {} came at spot {} and was dropped", dropped.sequence,
                           dropped.spot_id, spot.id));
        });
}

// One more exposure of a spot at which the robot stands; none where it may have gone on. Our own robot goes on
// when it is asked to.
Expected<FramePtr> Station::Impl::taken_again(Job& job, const Spot& spot, const TriggerEvent& trigger) {
    const auto stands = [&] {
        const RobotSetup* robot = find_robot(job.project, spot.robot_id);
        return (robot && is_own_device(robot->driver)) ||
               1e-9 * static_cast<double>(host_now_ns() - trigger.host_time_ns) < standing_time_s(spot);
    };
    if (!stands()) return FramePtr();
    SEAM_TRY(auto frame, frame_of(job, spot, trigger));
    return stands() ? frame : FramePtr();
}

Expected<void> Station::Impl::measure_spot(Job& job, const Spot& spot, const TriggerEvent& trigger) {
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
        SEAM_TRY(result,
                 light.measure(
                     spot, frame, trigger.base_from_flange, measurer,
                     [&] { return taken_again(job, spot, trigger); }, further_exposures(spot) > 0 && !wired));
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
Expected<void> Station::Impl::measure_robot(Job& job, const std::string& robot_id) {
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
    if (job.options.robot_goes) job.options.robot_goes(robot_id);
    std::set<std::string> open;
    for (const Spot* spot : spots) open.insert(spot->id);
    while (!open.empty()) {
        if (job.options.cancel.stop_requested()) return {};
        SEAM_TRY(auto trigger, next_trigger(robot, job.options.limits.trigger_timeout, job.options.cancel));
        const auto spot =
            std::find_if(spots.begin(), spots.end(), [&](const Spot* s) { return s->id == trigger.spot_id; });
        if (spot == spots.end() || !open.count(trigger.spot_id))
            return device_error(
                Text("the robot fired for spot \"{}\", which is {}", trigger.spot_id,
                     spot == spots.end() ? "not in the measuring program" : "measured already"),
                Text("robot {}", robot_id), "compare the program on the controller with the project");
        SEAM_OK(fired_near(trigger, **spot));
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

Expected<void> Station::Impl::measure_all(Job& job) {
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
    const auto measured = [&]() -> Expected<void> {
        for (const std::string& id : robot_ids) {
            if (job.options.cancel.stop_requested()) return {};
            SEAM_OK(measure_robot(job, id));
        }
        if (job.options.cancel.stop_requested()) return {};
        for (auto& [id, frames] : job.frames) SEAM_OK(frames.finish());
        return {};
    }();
    // What may be another spot's frame is no measurement of this one, for nobody who reads the run later.
    if (!measured)
        for (const Spot& spot : job.project.spots) {
            const auto frames = job.frames.find(spot.sensor_id);
            if (!spot.enabled || frames == job.frames.end() || !frames->second.in_doubt()) continue;
            SpotMeasurement& m = job.measurement(spot.id);
            if (m.status != SpotStatus::measured) continue;
            m.status = SpotStatus::not_measured;
            m.message = "frames and triggers of this run may belong together otherwise";
        }
    return measured;
}

}  // namespace seamwright
