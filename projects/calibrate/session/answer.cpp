#include "projects/calibrate/session/answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/calibration/table/lookup_table_calibration.h"
#include "devices/capture/capture.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/camera_json.h"
#include "projects/file/stored_text.h"
#include "projects/station/measure.h"

namespace seamwright {
namespace {

using nlohmann::json;

Matrix6 parse_covariance(const json& holder, const char* key) {
    Matrix6 m = Matrix6::Zero();
    const auto it = holder.find(key);
    if (it == holder.end() || !it->is_array() || it->size() != 6) return m;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < 6; ++k)
            if ((*it)[i].is_array() && (*it)[i].size() == 6 && (*it)[i][k].is_number())
                m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = (*it)[i][k].get<double>();
    return m;
}

Expected<Pose> pose_at(const json& result, const char* key) {
    auto field = json_field(result, key, "result");
    if (!field) return tl::unexpected(field.error());
    return parse_pose(**field, key);
}

tl::unexpected<Error> needs_base(const CalibrationMethod& method, const char* what) {
    return input_error(Text("{} is not known", what), method.id, "calibrate camera and laser plane first");
}

// The table itself is not in the result (it may hold millions of nodes): the data give it again, bit for bit.
Expected<LookupTable> table_of(const json& data, const std::vector<std::string>& exclude) {
    std::vector<LaserPair> pairs;
    for (const json& entry : data.at("pairs")) {
        auto id = entry_id(entry, pairs.size(), "pairs");
        auto pixel = json_vector2(entry, "pixel", "pairs");
        auto laser = json_vector2(entry, "laser", "pairs");
        if (!id) return tl::unexpected(id.error());
        if (!pixel) return tl::unexpected(pixel.error());
        if (!laser) return tl::unexpected(laser.error());
        pairs.push_back({*id, *pixel, *laser});
    }
    LookupTableOptions options;
    options.exclude = exclude;
    if (data.contains("step_px")) options.step_px = data["step_px"].get<double>();
    auto solved =
        calibrate_lookup_table(data.at("size")[0].get<int>(), data.at("size")[1].get<int>(), pairs, options);
    if (!solved) return tl::unexpected(solved.error());
    return std::move(solved->table);
}

}  // namespace

Expected<Calibration> calibration_of_result(const CalibrationMethod& method, const json& data,
                                            const std::vector<std::string>& exclude, const json& result,
                                            const Calibration* base) {
    const Verdict verdict = verdict_of(result);
    if (verdict == Verdict::undetermined && method.use == AnswerUse::sensor)
        return input_error(Text("the solution is undetermined: {}", text_in(result, "reason")), method.id,
                           text_in(result, "cure"));
    Calibration c;
    if (base) {
        c.model = base->model;
        c.flange_from_sensor = base->flange_from_sensor;
        c.covariance = base->covariance;
    }
    c.method = method.id;
    c.verdict = verdict;
    c.raw = {{"data", data}, {"exclude", exclude}};
    c.result = result;
    if (method.id == "tcp-sphere") {
        auto pose = pose_at(result, "flange_from_sensor");
        if (!pose) return tl::unexpected(pose.error());
        c.flange_from_sensor = *pose;
        c.covariance = parse_covariance(result, "covariance_pose");
    } else if (method.id == "stripe-camera") {
        if (!result["camera_from_laser"].is_object())
            return input_error("the frames give no laser plane", method.id, text_in(result, "cure"));
        auto camera = parse_camera(result["camera"], "camera");
        if (!camera) return tl::unexpected(camera.error());
        auto laser = pose_at(result, "camera_from_laser");
        if (!laser) return tl::unexpected(laser.error());
        c.model = SensorModel{*camera, *laser, std::nullopt};
        if (result["hand_eye"].is_object()) {
            auto flange = pose_at(result["hand_eye"], "flange_from_camera");
            if (!flange) return tl::unexpected(flange.error());
            c.flange_from_sensor = *flange * *laser;
            c.covariance = covariance_of_product(
                *flange, parse_covariance(result["hand_eye"], "covariance_pose"), *laser, Matrix6::Zero());
        }
    } else if (method.id == "laser-plane") {
        auto camera = parse_camera(data.value("camera", json()), "camera");
        if (!camera) return tl::unexpected(camera.error());
        auto laser = pose_at(result, "camera_from_laser");
        if (!laser) return tl::unexpected(laser.error());
        // The camera stays where it sits on the flange; the laser plane is what is new.
        if (base && base->model)
            c.flange_from_sensor =
                base->flange_from_sensor * base->model->camera_from_laser.inverse() * *laser;
        c.model = SensorModel{*camera, *laser, std::nullopt};
    } else if (method.id == "lut") {
        auto table = table_of(data, exclude);
        if (!table) return tl::unexpected(table.error());
        if (!c.model) c.model.emplace();
        c.model->table = std::move(*table);
    } else if (method.id == "hand-eye") {
        if (!base || !base->model) return needs_base(method, "the laser plane in the camera");
        if (!result.contains("flange_from_camera"))
            return input_error("the camera does not ride on the flange", method.id,
                               "a sensor beside the robot is kept as a record");
        auto flange = pose_at(result, "flange_from_camera");
        if (!flange) return tl::unexpected(flange.error());
        c.flange_from_sensor = *flange * base->model->camera_from_laser;
        c.covariance = covariance_of_product(*flange, parse_covariance(result, "covariance_pose"),
                                             base->model->camera_from_laser, Matrix6::Zero());
    }
    return c;
}

namespace {

// What one sensor's calibration is made of.
struct SensorAnswer {
    std::string sensor_id;
    json data, result;
    std::vector<std::string> exclude;
};

// One a sensor, each complete in itself.
Expected<std::vector<SensorAnswer>> answers_of_chains(const CalibrationSession& session,
                                                      const Project& project, const json& result) {
    const std::string& entries = session.method().entries;
    std::vector<SensorAnswer> answers;
    std::string unknown;
    for (const json& chain : result.at("sensors"))
        for (const SessionCapture& c : session.state().captures) {
            if (c.taken->id != chain.value("id", "")) continue;
            SensorAnswer one{sensor_of_chain(*c.taken), session.state().settings, result, {}};
            one.data[entries] = json::array({c.taken->entry});
            one.result["sensors"] = json::array({chain});
            one.result["verdict"] = chain.value("verdict", "");
            for (const char* word : {"reason", "cure"}) put_text(one.result, word, text_in(chain, word));
            if (!find_sensor(project, one.sensor_id))
                unknown += (unknown.empty() ? "" : ", ") + one.sensor_id;
            answers.push_back(std::move(one));
        }
    if (!unknown.empty())
        return input_error(Text("the project does not know the sensors of these chains: {}", unknown),
                           "static",
                           "take their ticks away, or name the sensors in the data as in the project");
    return answers;
}

Expected<Calibration> calibration_of_answer(const CalibrationSession& session, const Project& project,
                                            const SensorAnswer& answer) {
    const SensorSetup* sensor = find_sensor(project, answer.sensor_id);
    if (!sensor) return input_error("the project has no such sensor", answer.sensor_id);
    auto c = calibration_of_result(session.method(), answer.data, answer.exclude, answer.result,
                                   calibration_of(project, sensor->id));
    if (!c) return c;
    if (session.method().capture == CaptureKind::board_chain) {
        const json& chain = answer.result.at("sensors").at(0);
        if (!chain.contains("reference_from_laser"))
            return input_error("the chain ends in the world, not on the flange", "static",
                               "give reference_from_world with the flange as reference");
        auto pose = pose_at(chain, "reference_from_laser");
        if (!pose) return tl::unexpected(pose.error());
        c->flange_from_sensor = *pose;
        c->covariance = parse_covariance(chain, "covariance");
    }
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
    const json* result = session.result();
    if (!result) return input_error("there is no solution yet", session.method().id, "solve first");
    std::vector<SensorAnswer> answers;
    if (session.method().capture == CaptureKind::board_chain) {
        auto chains = answers_of_chains(session, project, *result);
        if (!chains) return tl::unexpected(chains.error());
        answers = std::move(*chains);
    } else {
        answers.push_back({session.sensor_id(), session.data(), *result, session.exclude()});
    }
    const Verification v = session.verification();
    const std::string now = utc_now();
    std::size_t number = project.calibrations.size();
    std::vector<Calibration> made;
    for (const SensorAnswer& answer : answers) {
        auto c = calibration_of_answer(session, project, answer);
        if (!c) return tl::unexpected(c.error());
        c->created_utc = now;
        do {
            c->id = fmt::format("{}-{}", session.method().id, ++number);
        } while (std::any_of(project.calibrations.begin(), project.calibrations.end(),
                             [&](const Calibration& other) { return other.id == c->id; }));
        c->source = answers.size() > 1
                        ? Text("one shot of {} sensors", answers.size())
                        : Text("{} captures, {} for verification", session.solving_captures(), v.poses);
        if (v.poses > 0 && session.method().capture != CaptureKind::board_chain)
            c->result["verification"] = {{"poses", v.poses},
                                         {"confirmed", v.confirmed},
                                         {"worst_mm", number_json(v.worst_mm)},
                                         {"limit_mm", number_json(v.limit_mm)},
                                         {"worst_deg", number_json(v.worst_deg)},
                                         {"limit_deg", number_json(v.limit_deg)},
                                         {"worst_px", number_json(v.worst_px)},
                                         {"limit_px", number_json(v.limit_px)}};
        made.push_back(std::move(*c));
    }
    return made;
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
