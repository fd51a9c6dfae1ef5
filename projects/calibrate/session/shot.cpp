#include "projects/calibrate/session/shot.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "core/profile/stripe/stripe_light.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/cell.h"
#include "projects/calibrate/session/capture.h"
#include "projects/calibrate/session/capture_file.h"
#include "projects/measure/measure.h"
#include "projects/station/acquire.h"

namespace seamwright {
namespace {

constexpr double kSameShotMm = 0.05, kSameShotDeg = 0.01;
constexpr std::chrono::milliseconds kShotFrame{5000};
constexpr double kBright = 0.98;  // of the pixels are darker than the bright end of a board's picture, which
constexpr double kBrightShare = 0.6;  // should lie at so much of full scale
constexpr int kExposures = 4;

Expected<FramePtr> snap(ProfileSource& sensor, const std::stop_token& cancel) {
    SEAM_OK(sensor.trigger(""));
    return next_frame(sensor, kShotFrame, cancel);
}

const ParameterInfo* named(const std::vector<ParameterInfo>& list, const std::string& name) {
    const auto it = std::find_if(list.begin(), list.end(), [&](const auto& p) { return p.name == name; });
    return it == list.end() ? nullptr : &*it;
}

// Laser off and exposed for the surroundings; laser and exposure are as before when this returns. nullptr:
// the sensor cannot switch its laser.
Expected<FramePtr> board_picture(ProfileSource& sensor, const std::stop_token& cancel) {
    const auto parameters = sensor.parameters();
    const ParameterInfo* exposure = named(parameters, "exposure_us");
    if (!named(parameters, "laser")) return FramePtr();
    const auto laser_before = sensor.get("laser");
    const auto exposure_before = exposure ? sensor.get("exposure_us") : Expected<double>(0);
    if (!laser_before) return tl::unexpected(laser_before.error());
    if (!exposure_before) return tl::unexpected(exposure_before.error());
    Expected<FramePtr> picture = FramePtr();
    SEAM_OK(sensor.set("laser", 0));
    double time_us = *exposure_before;
    for (int k = 0; k < kExposures; ++k) {
        picture = snap(sensor, cancel);
        if (!picture || !exposure || (*picture)->image.empty()) break;
        const double bright = grey_level((*picture)->image, kBright);
        if (bright > 0.5 * kBrightShare && bright < 0.95) break;
        time_us = std::clamp(time_us * std::clamp(kBrightShare / std::max(bright, 0.02), 0.1, 8.0),
                             std::max(1.0, exposure->minimum), exposure->maximum);
        if (!sensor.set("exposure_us", time_us)) break;
    }
    auto restored = sensor.set("laser", *laser_before);
    if (exposure && restored) restored = sensor.set("exposure_us", *exposure_before);
    if (!restored) return tl::unexpected(restored.error());
    return picture;
}

}  // namespace

Expected<CalibrationShot> take_shot(Station& station, const SensorId& sensor_id, const RobotId& robot_id,
                                    bool board, const std::stop_token& cancel) {
    CalibrationShot shot;
    shot.sensor_id = sensor_id.text();
    shot.robot_id = robot_id.text();
    ProfileSource* sensor = station.sensor(sensor_id.text());
    if (!sensor)
        return device_error("the sensor is not connected", Text("sensor {}", sensor_id.text()), "connect it");
    RobotLink* robot = robot_id.empty() ? nullptr : station.robot(robot_id.text());
    if (!robot_id.empty() && !robot)
        return device_error("the robot is not connected", Text("robot {}", robot_id.text()), "connect it");
    if (robot) {
        SEAM_TRY(auto at, robot->base_from_flange());
        shot.base_from_flange = at;
    }
    SEAM_TRY(const auto by_software, SoftwareTriggered::begin(*sensor));
    StartedSensors started;
    SEAM_OK(started.start(*sensor));
    if (board) {
        SEAM_TRY(auto picture, board_picture(*sensor, cancel));
        shot.board = std::move(picture);
    }
    SEAM_TRY(auto stripe, snap(*sensor, cancel));
    shot.stripe = std::move(stripe);
    if (robot) {
        SEAM_TRY(auto after, robot->base_from_flange());
        if (distance_mm(after, *shot.base_from_flange) > kSameShotMm ||
            angle_rad(after, *shot.base_from_flange) > rad_from_deg(kSameShotDeg))
            return device_error("the robot moved while the picture was taken",
                                Text("robot {}", robot_id.text()), "let it stand still and capture again");
    }
    return shot;
}

namespace {

// Whether chains of other sensors than these are in the session.
bool stays_beside(const SessionState& state, const std::vector<std::string>& sensor_ids) {
    return std::any_of(state.captures.begin(), state.captures.end(), [&](const SessionCapture& c) {
        return std::find(sensor_ids.begin(), sensor_ids.end(), sensor_of_chain(*c.taken)) == sensor_ids.end();
    });
}

}  // namespace

std::vector<std::string> shot_sensors(const CalibrationSession& session, const Project& project,
                                      const std::vector<std::string>& connected) {
    std::vector<std::string> ids{session.sensor_id()};
    if (!of_all_sensors(session.method().capture)) return ids;
    for (const std::string& id : connected) {
        const Calibration* c = calibration_of(project, id);
        if (id != session.sensor_id() && c && c->model && c->robot_id == session.robot_id())
            ids.push_back(id);
    }
    return ids;
}

Expected<nlohmann::json> capture_settings(const CalibrationSession& session, const Project& project,
                                          const std::vector<std::string>& sensor_ids) {
    auto settings = prepared_settings(session.method(), session.state().settings,
                                      calibration_of(project, session.sensor_id()), project.calibrations,
                                      find_robot(project, session.robot_id()));
    // What captures are measured from goes with them.
    if (settings && session.state().captures.empty()) settings->erase("anchor");
    if (settings && session.method().capture == CaptureKind::board_chain &&
        !stays_beside(session.state(), sensor_ids))
        settings->erase("reference_from_world");
    return settings;
}

ShotCaptures captures_of_shots(const CalibrationSession& session, const Project& project,
                               nlohmann::json settings, const CalibrationShots& shots,
                               const std::stop_token& cancel) {
    ShotCaptures taken;
    taken.settings = std::move(settings);
    for (const auto& shot : shots) {
        if (cancel.stop_requested()) break;
        if (!shot) {
            taken.refusals.push_back(shot.error());
            continue;
        }
        const SensorSetup* sensor = find_sensor(project, shot->sensor_id);
        if (!sensor) {  // removed or renamed while its picture was taken
            taken.refusals.push_back(input_error("the project has no such sensor",
                                                 Text("sensor {}", shot->sensor_id),
                                                 "undo its removal, or go back and choose another")
                                         .value());
            continue;
        }
        auto one =
            capture_shot(session.method(), taken.settings, *sensor, calibration_of(project, sensor->id),
                         *shot->stripe, shot->board.get(), shot->base_from_flange);
        if (!one) {
            taken.refusals.push_back(one.error());
            continue;
        }
        // The picture is for people: without it the capture is as good.
        const StripeImage& image = shot->board ? shot->board->image : shot->stripe->image;
        const auto file = session.free_picture_path(one->capture.id);
        std::error_code code;
        std::filesystem::create_directories(file.parent_path(), code);
        if (!image.empty() && write_image_file(file, image))
            one->capture.picture = std::filesystem::relative(file, session.folder(), code).string();
        one->capture.sensor_serial = sensor->identity.serial;
        if (const RobotSetup* robot = find_robot(project, shot->robot_id))
            one->capture.robot_serial = robot->identity.serial;
        taken.settings = std::move(one->settings);
        taken.captures.push_back(std::move(one->capture));
    }
    return taken;
}

Expected<void> add_captures(CalibrationSession& session, std::vector<CalibrationCapture> captures,
                            nlohmann::json settings, bool verification) {
    if (session.method().capture == CaptureKind::board_chain) {
        // The chains of a session end in one frame.
        std::vector<std::string> ids;
        for (const CalibrationCapture& c : captures) {
            const std::string& sensor = sensor_of_chain(c);
            ids.push_back(sensor.empty() ? session.sensor_id() : sensor);
        }
        const char* key = "reference_from_world";
        if (stays_beside(session.state(), ids) &&
            session.state().settings.value(key, nlohmann::json()) != settings.value(key, nlohmann::json()))
            return input_error("the chains before end in another reference", session.method().id,
                               "begin anew, or remove them");
    }
    // A chain takes the place of its like; anything else would count twice.
    const std::size_t all = captures.size();
    std::size_t known = 0;
    if (session.method().capture != CaptureKind::board_chain) {
        NewCaptures fresh = without_known(session.state(), std::move(captures));
        captures = std::move(fresh.captures);
        known = fresh.known;
    }
    if (!captures.empty()) SEAM_OK(session.set_settings(std::move(settings)));
    for (CalibrationCapture& capture : captures) SEAM_OK(session.add(std::move(capture), verification));
    if (known > 0)
        return input_error(Text("{} of {} captures are in the list already", known, all), session.method().id,
                           "they are not taken a second time");
    return {};
}

std::optional<Pose> known_mounting(const CalibrationSession& session, const Project& project) {
    if (const auto& settings = session.state().settings; settings.contains("nominal_flange_from_sensor"))
        if (auto pose = parse_pose(settings["nominal_flange_from_sensor"], "nominal_flange_from_sensor"))
            return *pose;
    if (const Calibration* c = calibration_of(project, session.sensor_id());
        c && !c->flange_from_sensor.isApprox(Pose::Identity()))
        return c->flange_from_sensor;
    const SensorSetup* sensor = find_sensor(project, session.sensor_id());
    if (sensor && is_simulated_cell(sensor->driver))
        if (auto cell = parse_cell_settings(sensor->settings)) return cell->flange_from_sensor;
    return std::nullopt;
}

}  // namespace seamwright
