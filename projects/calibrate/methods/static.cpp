#include <cmath>

#include "core/calibration/pose/static_chain.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/file/stored_text.h"

namespace seamwright {
namespace {

using nlohmann::json;

Expected<UncertainPose> parse_link(const json& value, const std::string& where) {
    UncertainPose link;
    if (!value.is_object() || !value.contains("pose")) {
        auto pose = parse_pose(value, where);
        if (!pose) return tl::unexpected(pose.error());
        link.pose = *pose;
        return link;
    }
    if (auto ok = only_fields(value, {"pose", "covariance", "sigma_mm", "sigma_deg"}, where); !ok)
        return tl::unexpected(ok.error());
    auto pose = parse_pose(value["pose"], json_path(where, "pose"));
    if (!pose) return tl::unexpected(pose.error());
    link.pose = *pose;
    if (value.contains("covariance")) {
        if (value.contains("sigma_mm") || value.contains("sigma_deg"))
            return input_error("covariance and sigma are both given", where, "give one of them");
        auto rows = json_array(value, "covariance", where);
        if (!rows) return tl::unexpected(rows.error());
        const std::string path = json_path(where, "covariance");
        if ((*rows)->size() != 6) return input_error("the covariance has not six rows", path);
        for (std::size_t i = 0; i < 6; ++i) {
            auto row = as_numbers((**rows)[i], 6, json_path(path, i));
            if (!row) return tl::unexpected(row.error());
            for (std::size_t k = 0; k < 6; ++k)
                link.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = (*row)[k];
        }
        return link;
    }
    auto mm = json_number_or(value, "sigma_mm", 0, where);
    if (!mm) return tl::unexpected(mm.error());
    auto deg = json_number_or(value, "sigma_deg", 0, where);
    if (!deg) return tl::unexpected(deg.error());
    if (*mm < 0 || *deg < 0) return input_error("a sigma is negative", where);
    link.covariance.diagonal().head<3>().setConstant(*mm * *mm);
    link.covariance.diagonal().tail<3>().setConstant(std::pow(rad_from_deg(*deg), 2));
    return link;
}

Expected<UncertainPose> link_field(const json& entry, const std::string& key, const std::string& where) {
    auto field = json_field(entry, key, where);
    if (!field) return tl::unexpected(field.error());
    return parse_link(**field, json_path(where, key));
}

Expected<StaticSensor> parse_sensor(const json& entry, std::size_t index, const std::string& where) {
    StaticSensor sensor;
    auto id = entry_id(entry, index, where);
    if (!id) return tl::unexpected(id.error());
    sensor.id = *id;
    auto plate = link_field(entry, "world_from_plate", where);
    if (!plate) return tl::unexpected(plate.error());
    sensor.world_from_plate = *plate;
    const bool inverted = entry.contains("camera_from_plate");
    if (inverted && entry.contains("plate_from_camera"))
        return input_error("plate_from_camera and camera_from_plate are both given", where,
                           "give one of them");
    auto camera = link_field(entry, inverted ? "camera_from_plate" : "plate_from_camera", where);
    if (!camera) return tl::unexpected(camera.error());
    sensor.plate_from_camera = inverted ? inverse(*camera) : *camera;
    auto laser = link_field(entry, "camera_from_laser", where);
    if (!laser) return tl::unexpected(laser.error());
    sensor.camera_from_laser = *laser;
    if (entry.contains("working_point")) {
        auto point = json_vector3(entry, "working_point", where);
        if (!point) return tl::unexpected(point.error());
        sensor.working_point_mm = *point;
    }
    return sensor;
}

}  // namespace

Expected<CalibrateOutcome> calibrate_static_json(const json& data, const std::vector<std::string>& exclude) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate static --help");
    std::vector<StaticSensor> sensors;
    if (data.contains("sensors")) {
        auto list = json_array(data, "sensors", "");
        if (!list) return tl::unexpected(list.error());
        for (std::size_t i = 0; i < (*list)->size(); ++i) {
            auto sensor = parse_sensor((**list)[i], i, json_path("sensors", i));
            if (!sensor) return tl::unexpected(sensor.error());
            sensors.push_back(std::move(*sensor));
        }
    } else {
        auto sensor = parse_sensor(data, 0, "");
        if (!sensor) return tl::unexpected(sensor.error());
        sensors.push_back(std::move(*sensor));
    }
    StaticChainOptions options;
    options.exclude = exclude;
    if (data.contains("reference_from_world")) {
        auto reference = link_field(data, "reference_from_world", "");
        if (!reference) return tl::unexpected(reference.error());
        options.reference_from_world = *reference;
    }
    auto solved = calibrate_static(sensors, options);
    if (!solved) return tl::unexpected(solved.error());

    CalibrateOutcome outcome;
    json& result = outcome.result;
    const char* frame = options.reference_from_world ? "reference_from_laser" : "world_from_laser";
    result["method"] = "static";
    result["status"] = "ok";
    result["verdict"] = std::string(name_of(solved->judgement.verdict));
    put_text(result, "reason", solved->judgement.reason);
    put_text(result, "cure", solved->judgement.cure);
    json list = json::array();
    for (const auto& s : solved->sensors) {
        json one;
        one["id"] = s.id;
        one[frame] = pose_json(s.world_from_laser.pose);
        one["sigma"] = pose_sigma_json(s.world_from_laser.pose, s.world_from_laser.covariance);
        one["covariance"] = matrix_json(s.world_from_laser.covariance);
        one["working_sigma_mm"] = number_json(s.working_sigma_mm);
        one["shares"] = {{"reference_from_world", s.shares[0]},
                         {"world_from_plate", s.shares[1]},
                         {"plate_from_camera", s.shares[2]},
                         {"camera_from_laser", s.shares[3]}};
        one["verdict"] = std::string(name_of(s.judgement.verdict));
        put_text(one, "reason", s.judgement.reason);
        put_text(one, "cure", s.judgement.cure);
        list.push_back(std::move(one));
    }
    if (!data.contains("sensors")) result[frame] = list[0][frame];
    result["sensors"] = std::move(list);
    outcome.exit_code = exit_code_for(solved->judgement.verdict);
    return outcome;
}

}  // namespace seamwright
