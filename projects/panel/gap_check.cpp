#include "projects/panel/gap_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/correction/ahead/pose_history.h"
#include "projects/measure/measure.h"
#include "projects/panel/pass_sections.h"
#include "projects/station/acquire.h"

namespace seamwright {

using passing::Sections;

namespace {

constexpr int kMostSteps = 100000;
constexpr double kStillMm = 0.2;
constexpr double kStepRad = 0.035;  // where the sensor only turns

// The poses of the flange along the spots, and the only sensor and robot that they have.
struct Drive {
    std::string sensor_id, robot_id;
    std::vector<Pose> base_from_flange;
};

// In steps from one stand to the next, as the sensor moves, not the flange: it turns about itself.
Expected<std::vector<Pose>> in_steps(const std::vector<Pose>& stands, const Pose& flange_from_sensor,
                                     double step_mm) {
    std::vector<Pose> out{stands.front()};
    const Pose sensor_from_flange = flange_from_sensor.inverse();
    for (std::size_t k = 1; k < stands.size(); ++k) {
        const Pose start = stands[k - 1] * flange_from_sensor, end = stands[k] * flange_from_sensor;
        const double steps = std::max(std::ceil(distance_mm(start, end) / step_mm - 1e-9),
                                      std::ceil(angle_rad(start, end) / kStepRad - 1e-9));
        if (!(steps + static_cast<double>(out.size()) <= kMostSteps))
            return usage_error(Text("more than {} profiles", kMostSteps), "step", "give a longer step");
        for (int i = 1; i <= static_cast<int>(steps); ++i)
            out.push_back(interpolate(start, end, i / steps) * sensor_from_flange);
    }
    return out;
}

// The poses of a path that the spots do not say.
Expected<Drive> drive_along_stands(const Project& project, const DrivenGapPass& options) {
    if (options.stands.size() < 2) return usage_error("a pass needs two poses or more to go along", "path");
    for (std::size_t k = 0; k < options.stands.size(); ++k)
        if (auto rigid = pose_from_matrix(options.stands[k].matrix(), Text("pose {} of the path", k + 1));
            !rigid)
            return tl::unexpected(rigid.error());
    SEAM_TRY(auto pair, passing::devices_of(project, options.sensor_id, options.robot_id));
    SEAM_TRY(auto poses, in_steps(options.stands, calibration_of(project, pair.sensor_id)->flange_from_sensor,
                                  options.step_mm));
    return Drive{pair.sensor_id, pair.robot_id, std::move(poses)};
}

Expected<Drive> drive_along(const Project& project, const DrivenGapPass& options) {
    if (!(options.step_mm >= 0.05) || !std::isfinite(options.step_mm))
        return usage_error(Text("a step of {} mm", options.step_mm), "step", "give 0.05 mm or more");
    if (!options.stands.empty()) return drive_along_stands(project, options);
    if (options.spot_ids.size() < 2)
        return usage_error("a pass needs two spots or more to go along", "spots");
    std::vector<const Spot*> spots;
    for (const std::string& id : options.spot_ids) {
        const Spot* spot = find_spot(project, id);
        if (!spot) return input_error(Text("there is no spot \"{}\"", id), project.name);
        if (!spots.empty() &&
            (spot->sensor_id != spots[0]->sensor_id || spot->robot_id != spots[0]->robot_id))
            return input_error(Text("spots {} and {} have different sensors or robots", spots[0]->id, id),
                               project.name, "check one sensor's stretch at a time");
        spots.push_back(spot);
    }
    const Calibration* calibration = calibration_of(project, spots[0]->sensor_id);
    if (!calibration)
        return input_error(Text("sensor {} has no calibration", spots[0]->sensor_id), project.name,
                           "calibrate it first");
    std::vector<Pose> stands;
    for (const Spot* spot : spots) stands.push_back(spot->base_from_flange);
    SEAM_TRY(auto poses, in_steps(stands, calibration->flange_from_sensor, options.step_mm));
    return Drive{spots[0]->sensor_id, spots[0]->robot_id, std::move(poses)};
}

}  // namespace

Expected<GapPass> gap_pass(const Project& project, CaptureReader& capture, const RecordedGapPass& options) {
    const CaptureSource* source = capture.find(options.sensor_id, SourceKind::sensor);
    if (!source)
        return input_error(options.sensor_id.empty() ? Text("it does not hold exactly one sensor")
                                                     : Text("it holds no sensor \"{}\"", options.sensor_id),
                           capture.path().string(), "name one that it holds");
    SEAM_TRY(auto sections, Sections::make(project, source->name));

    std::optional<PoseHistory> poses;
    const CaptureSource* robot = capture.find(options.robot_id, SourceKind::robot);
    if (!robot && !options.robot_id.empty())
        return input_error(Text("it holds no robot \"{}\"", options.robot_id), capture.path().string());
    if (robot) {
        SEAM_TRY(auto events, capture.events(robot->id));
        std::stable_sort(events.begin(), events.end(), [](const CaptureEvent& a, const CaptureEvent& b) {
            return a.host_time_ns < b.host_time_ns;
        });
        poses.emplace(events.size());
        for (const CaptureEvent& e : events)
            if (e.base_from_flange) poses->add(e.host_time_ns, *e.base_from_flange);
    }
    GapPass& pass = sections.pass;
    pass.frames = capture.frames(source->id);
    for (std::uint64_t k = 0; k < pass.frames; ++k) {
        SEAM_TRY(auto frame, capture.frame(source->id, k));
        const Capture& c = *frame;
        const auto flange = c.base_from_flange ? c.base_from_flange
                            : poses            ? poses->at(c.host_time_ns, options.most_between_s)
                                               : std::nullopt;
        if (flange)
            sections.add(c, *flange);
        else
            ++pass.without_pose;
    }
    if (pass.damaged + pass.without_profile == pass.sections.size())
        return input_error(Text("none of its {} frames has a pose and a profile", pass.frames),
                           capture.path().string(), "record the robot's poses beside the sensor");
    return std::move(sections.pass);
}

Expected<GapPass> gap_pass(Station& station, const DrivenGapPass& options) {
    SEAM_TRY(auto drive, drive_along(station.project(), options));
    SEAM_TRY(auto sections, Sections::make(station.project(), drive.sensor_id));
    ProfileSource* sensor = station.sensor(drive.sensor_id);
    RobotLink* robot = station.robot(drive.robot_id);
    if (!sensor || !robot)
        return usage_error(Text("sensor {} or robot {} is not connected", drive.sensor_id, drive.robot_id),
                           station.project().name, "connect first");
    if (!robot->can_move())
        return usage_error(Text("robot {} is not moved by this program", drive.robot_id),
                           station.project().name,
                           "let it move by its own program, or by hand, and follow it: scan --follow");
    SEAM_TRY(const auto by_software, SoftwareTriggered::begin(*sensor));
    StartedSensors started;
    SEAM_OK(started.start(*sensor));
    const AcquireLimits limits;
    const int n = static_cast<int>(drive.base_from_flange.size());
    for (int i = 0; i < n; ++i) {
        const std::string name = fmt::format("gap {}", i + 1);
        if (options.cancel.stop_requested()) return device_error(kCancelled, name);
        SEAM_TRY(auto at, stand_at(*robot, name, drive.base_from_flange[static_cast<std::size_t>(i)]));
        SEAM_OK(sensor->trigger(name));
        SEAM_TRY(auto frame, next_frame(*sensor, limits.frame_timeout, options.cancel));
        // Asked again, so that a recording of the pass holds a pose on either side of the frame.
        SEAM_TRY(auto still, robot->base_from_flange());
        if (const double moved = distance_mm(at, still); moved > kStillMm)
            return device_error(Text("the robot moved {:.2f} mm while the sensor exposed", moved), name,
                                "let it stand at every step");
        ++sections.pass.frames;
        sections.add(*frame, at);
        if (options.progress) options.progress({i + 1, n, Text("profile {} of {}", i + 1, n)});
    }
    return std::move(sections.pass);
}

Text GapCheck::where(double path_mm) const {
    constexpr double kAtMm = 1;
    const auto next =
        std::find_if(spots.begin(), spots.end(), [&](const auto& s) { return s.second >= path_mm - kAtMm; });
    if (spots.empty()) return {};
    if (next == spots.end()) return Text("behind {}", spots.back().first);
    if (std::abs(next->second - path_mm) <= kAtMm) return Text("at {}", next->first);
    if (next == spots.begin()) return Text("before {}", next->first);
    return Text("between {} and {}", std::prev(next)->first, next->first);
}

Expected<GapCheck> check_gap(const Project& project, const GapPass& pass, const GapScanOptions& options) {
    SEAM_TRY(auto scan, scan_gap(pass.sections, options));
    GapCheck out;
    out.scan = std::move(scan);
    for (const Spot& spot : project.spots) {
        const Calibration* calibration = calibration_of(project, spot);
        if (!calibration || spot.sensor_id != pass.sensor_id) continue;
        const Pose taught = project.part.base_from_workobject.inverse() * spot.base_from_flange *
                            calibration->flange_from_sensor;
        double nearest = kBySpotMm, path = 0;
        for (const GapPoint& p : out.scan.points) {
            const double d = distance_mm(pass.sections[p.section].frame_from_sensor, taught);
            if (d < nearest) {
                nearest = d;
                path = p.path_mm;
            }
        }
        if (nearest < kBySpotMm) out.spots.emplace_back(spot.id, path);
    }
    std::stable_sort(out.spots.begin(), out.spots.end(),
                     [](const auto& a, const auto& b) { return a.second < b.second; });
    return out;
}

}  // namespace seamwright
