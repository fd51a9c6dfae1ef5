#include "projects/calibrate/session/answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "devices/capture/capture.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

using nlohmann::json;

tl::unexpected<Error> needs_base(const CalibrationMethod& method, const char* what) {
    return input_error(Text("{} is not known", what), method.id, "calibrate camera and laser plane first");
}

void put_on_flange(const UncertainPose& flange_from_sensor, Calibration& c) {
    c.flange_from_sensor = flange_from_sensor.pose;
    c.covariance = flange_from_sensor.covariance;
}

UncertainPose laser_on_flange(const UncertainPose& flange_from_camera, const Pose& camera_from_laser) {
    return {flange_from_camera.pose * camera_from_laser,
            covariance_of_product(flange_from_camera.pose, flange_from_camera.covariance, camera_from_laser,
                                  Matrix6::Zero())};
}

// Puts what was found into a calibration that holds what was known before.
struct Take {
    const CalibrationMethod& method;
    const CalibrationSolution& solution;
    const Calibration* base;
    Calibration& c;

    Expected<void> operator()(std::monostate) const { return {}; }
    Expected<void> operator()(const PlateInWorld&) const { return {}; }
    Expected<void> operator()(const NozzleOnFlange&) const { return {}; }
    Expected<void> operator()(const SensorOnFlange& found) const {
        put_on_flange(found.flange_from_sensor, c);
        return {};
    }
    Expected<void> operator()(const CameraOnFlange& found) const {
        if (!base || !base->model) return needs_base(method, "the laser plane in the camera");
        put_on_flange(laser_on_flange(found.flange_from_camera, base->model->camera_from_laser), c);
        return {};
    }
    Expected<void> operator()(const CameraBesideRobot&) const {
        return input_error("the camera does not ride on the flange", method.id,
                           "a sensor beside the robot is kept as a record");
    }
    Expected<void> operator()(const CameraAndLaser& found) const {
        if (!found.camera_from_laser)
            return input_error("the frames give no laser plane", method.id, solution.report.judgement.cure);
        if (found.flange_from_camera)
            put_on_flange(laser_on_flange(*found.flange_from_camera, *found.camera_from_laser), c);
        else if (base && base->model)
            c.flange_from_sensor = base->flange_from_sensor * base->model->camera_from_laser.inverse() *
                                   *found.camera_from_laser;
        c.model = SensorModel{found.camera, *found.camera_from_laser, std::nullopt};
        return {};
    }
    Expected<void> operator()(const PixelTable& found) const {
        if (!c.model) c.model.emplace();
        c.model->table = found.table;
        return {};
    }
    Expected<void> operator()(const SensorChains& found) const {
        if (found.chains.size() != 1) return {};  // a record of all
        if (!found.chains.front().reference_from_laser)
            return input_error("the chain ends in the world, not on the flange", method.id,
                               "give reference_from_world with the flange as reference");
        put_on_flange(*found.chains.front().reference_from_laser, c);
        return {};
    }
};

}  // namespace

Expected<Calibration> calibration_of_solution(const CalibrationMethod& method, const json& data,
                                              const ExcludedIds& exclude, const CalibrationSolution& solution,
                                              const Calibration* base) {
    const Judgement& judgement = solution.report.judgement;
    if (judgement.verdict == Verdict::undetermined && method.use == AnswerUse::sensor)
        return input_error(Text("the solution is undetermined: {}", judgement.reason), method.id,
                           judgement.cure);
    Calibration c;
    if (base) {
        c.model = base->model;
        c.flange_from_sensor = base->flange_from_sensor;
        c.covariance = base->covariance;
        c.scale_sigma = base->scale_sigma;
        c.shear_sigma = base->shear_sigma;
    }
    if (solution.scale) {
        // Where the sensor sits says something of its millimetres; a new camera or table says all.
        const bool same_millimetres = base && std::holds_alternative<SensorOnFlange>(solution.found);
        const FieldScale scale =
            same_millimetres ? better_known({base->scale_sigma, base->shear_sigma, false}, *solution.scale)
                             : *solution.scale;
        c.scale_sigma = scale.scale_sigma;
        c.shear_sigma = scale.shear_sigma;
    }
    c.method = method.id;
    c.verdict = judgement.verdict;
    c.raw = {{"data", data}, {"exclude", exclude}};
    c.result = solution.document;
    if (const auto* nozzle = std::get_if<NozzleOnFlange>(&solution.found))
        c.nozzle = NozzleTip{nozzle->flange_from_nozzle.pose,
                             nozzle->flange_from_nozzle.covariance.topLeftCorner<3, 3>(), nozzle->degrees,
                             nozzle->off_programmed_mm};
    if (method.use == AnswerUse::sensor) SEAM_OK(std::visit(Take{method, solution, base, c}, solution.found));
    return c;
}

namespace {

// What one sensor's calibration is made of.
struct SensorAnswer {
    std::string sensor_id;
    json data;
    CalibrationSolution solution;
    ExcludedIds exclude;
};

// One a sensor, each complete in itself.
Expected<std::vector<SensorAnswer>> answers_of_chains(const CalibrationSession& session,
                                                      const Project& project, const SensorChains& found,
                                                      const json& document) {
    std::vector<SensorAnswer> answers;
    std::string unknown;
    for (std::size_t i = 0; i < found.chains.size(); ++i)
        for (const SessionCapture& capture : session.state().captures) {
            const SensorChains::Chain& chain = found.chains[i];
            if (capture.taken->id != chain.id) continue;
            SensorAnswer one{sensor_of_chain(*capture.taken), session.state().settings, {}, {}};
            one.data[session.method().entries] = json::array({capture.taken->entry});
            one.solution.found = SensorChains{{chain}};
            one.solution.report.judgement = chain.judgement;
            one.solution.document = document;
            one.solution.document["sensors"] = json::array({document.at("sensors").at(i)});
            put_judgement(chain.judgement, one.solution.document);
            if (!find_sensor(project, one.sensor_id))
                unknown += (unknown.empty() ? "" : ", ") + one.sensor_id;
            answers.push_back(std::move(one));
        }
    if (!unknown.empty())
        return input_error(Text("the project does not know the sensors of these chains: {}", unknown),
                           session.method().id,
                           "take their ticks away, or name the sensors in the data as in the project");
    return answers;
}

// An answer is that of the devices it was captured with. One that was exchanged since has another serial number.
Expected<void> check_same_devices(const CalibrationSession& session, const Project& project) {
    const auto same = [&](const SessionCapture& c, const std::string& then, const std::string& now,
                          const Text& device) -> Expected<void> {
        if (then.empty() || now.empty() || then == now) return {};
        return input_error(Text("{} was captured with serial number {}, {} is number {} now", c.taken->id,
                                then, device, now),
                           session.method().id, "leave such captures out, or begin anew");
    };
    for (const SessionCapture& c : session.state().captures) {
        if (c.left_out) continue;
        const bool chains = session.method().capture == CaptureKind::board_chain;
        const std::string id = chains && find_sensor(project, sensor_of_chain(*c.taken))
                                   ? sensor_of_chain(*c.taken)
                                   : session.sensor_id();
        if (const SensorSetup* sensor = find_sensor(project, id))
            SEAM_OK(same(c, c.taken->sensor_serial, sensor->identity.serial, Text("sensor {}", id)));
        const RobotSetup* robot = find_robot(project, session.robot_id());
        if (robot && session.method().robot)
            SEAM_OK(
                same(c, c.taken->robot_serial, robot->identity.serial, Text("robot {}", session.robot_id())));
    }
    return {};
}

Expected<Calibration> calibration_of_answer(const CalibrationSession& session, const Project& project,
                                            const SensorAnswer& answer) {
    const SensorSetup* sensor = find_sensor(project, answer.sensor_id);
    if (!sensor) return input_error("the project has no such sensor", answer.sensor_id);
    auto c = calibration_of_solution(session.method(), answer.data, answer.exclude, answer.solution,
                                     calibration_of(project, sensor->id));
    if (!c) return c;
    c->sensor_id = sensor->id;
    c->sensor_identity = sensor->identity;
    if (const RobotSetup* robot = find_robot(project, session.robot_id())) {
        c->robot_id = robot->id;
        c->robot_identity = robot->identity;
    }
    return c;
}

}  // namespace

Expected<std::vector<Calibration>> calibrations_of_session(const CalibrationSession& session,
                                                           const Project& project) {
    const CalibrationSolution* solution = session.solution();
    if (!solution) return input_error("there is no solution yet", session.method().id, "solve first");
    SEAM_OK(check_same_devices(session, project));
    std::vector<SensorAnswer> answers;
    if (const auto* found = std::get_if<SensorChains>(&solution->found)) {
        SEAM_TRY(auto chains, answers_of_chains(session, project, *found, solution->document));
        answers = std::move(chains);
    } else {
        answers.push_back({session.sensor_id(), session.data(), *solution, session.exclude()});
    }
    const Verification v = session.verification();
    const std::string now = utc_now();
    std::size_t number = project.calibrations.size();
    std::vector<Calibration> made;
    for (const SensorAnswer& answer : answers) {
        SEAM_TRY(auto c, calibration_of_answer(session, project, answer));
        c.created_utc = now;
        do {
            c.id = fmt::format("{}-{}", session.method().id, ++number);
        } while (std::any_of(project.calibrations.begin(), project.calibrations.end(),
                             [&](const Calibration& other) { return other.id == c.id; }));
        c.source = answers.size() > 1
                       ? Text("one shot of {} sensors", answers.size())
                       : Text("{} captures, {} for verification", session.solving_captures(), v.poses);
        if (v.poses > 0 && session.method().keeps_back) c.result["verification"] = verification_json(v);
        made.push_back(std::move(c));
    }
    return made;
}

json verification_json(const Verification& v) {
    return {{"poses", v.poses},
            {"repeats", v.repeats},
            {"confirmed", v.confirmed},
            {"worst_mm", number_json(v.worst_mm)},
            {"limit_mm", number_json(v.limit_mm)},
            {"worst_deg", number_json(v.worst_deg)},
            {"limit_deg", number_json(v.limit_deg)},
            {"worst_px", number_json(v.worst_px)},
            {"limit_px", number_json(v.limit_px)}};
}

CalibrationDifference difference(const Calibration& now, const Calibration& before) {
    CalibrationDifference d;
    d.turn_deg = deg_from_rad(angle_rad(now.flange_from_sensor, before.flange_from_sensor));
    d.shift_mm = distance_mm(now.flange_from_sensor, before.flange_from_sensor);
    const auto count = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        const double apart = (now.flange_from_sensor * Eigen::Vector3d(a.x(), 0, a.y()) -
                              before.flange_from_sensor * Eigen::Vector3d(b.x(), 0, b.y()))
                                 .norm();
        d.largest_mm = std::max(d.largest_mm, apart);
        d.mean_mm += apart;
        ++d.points;
    };
    if (now.model && before.model) {
        const int width = std::max(now.model->camera.width, before.model->camera.width);
        const int height = std::max(now.model->camera.height, before.model->camera.height);
        for (int i = 1; i < 12; ++i)
            for (int k = 1; k < 12; ++k) {
                const Eigen::Vector2d pixel(width * i / 12.0, height * k / 12.0);
                const auto a = now.model->to_laser(pixel), b = before.model->to_laser(pixel);
                if (a && b) count(*a, *b);
            }
    } else {
        for (const double x : {-50.0, 0.0, 50.0})
            for (const double z : {-50.0, 0.0, 50.0}) count({x, z}, {x, z});
    }
    if (d.points > 0) d.mean_mm /= d.points;
    return d;
}

}  // namespace seamwright
