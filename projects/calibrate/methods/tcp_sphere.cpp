#include <limits>

#include "core/calibration/sphere/tcp_sphere.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/pose_lists.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/methods/sphere_profile_json.h"
#include "projects/file/stored_text.h"

namespace seamwright {

using nlohmann::json;

Expected<SphereObservation> parse_sphere_observation(const json& entry, std::size_t index,
                                                     const std::string& where) {
    SphereObservation observation;
    auto id = entry_id(entry, index, where);
    if (!id) return tl::unexpected(id.error());
    observation.id = *id;
    auto pose_field = json_field(entry, "base_from_flange", where);
    if (!pose_field) return tl::unexpected(pose_field.error());
    auto pose = parse_pose(**pose_field, json_path(where, "base_from_flange"));
    if (!pose) return tl::unexpected(pose.error());
    observation.base_from_flange = *pose;
    auto profile = json_array(entry, "profile", where);
    if (!profile) return tl::unexpected(profile.error());
    const std::string path = json_path(where, "profile");
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < (*profile)->size(); ++i) {
        const json& point = (**profile)[i];
        double x = none, z = none;
        if (!point.is_null()) {
            if (!point.is_array() || point.size() != 2)
                return input_error("a point is not [x, z]", json_path(path, i),
                                   "write two numbers, null for no return");
            if (!(point[0].is_number() || point[0].is_null()) ||
                !(point[1].is_number() || point[1].is_null()))
                return input_error("a coordinate is no number", json_path(path, i),
                                   "write two numbers, null for no return");
            if (point[0].is_number()) x = point[0].get<double>();
            if (point[1].is_number()) z = point[1].get<double>();
        }
        observation.profile.x_mm.push_back(x);
        observation.profile.z_mm.push_back(z);
    }
    return observation;
}

Expected<SphereData> parse_sphere_data(const json& data, const std::vector<std::string>& exclude) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate tcp-sphere --help");
    SphereData sphere;
    TcpSphereOptions& options = sphere.options;
    options.exclude = exclude;
    if (!data.contains("radius_mm"))
        return input_error("the sphere's radius is missing", "radius_mm",
                           "give it in millimetres, or null to solve for it");
    if (!data["radius_mm"].is_null()) {
        auto radius = json_number(data, "radius_mm", "");
        if (!radius) return tl::unexpected(radius.error());
        options.radius_mm = *radius;
    }
    if (const auto it = data.find("nominal_flange_from_sensor"); it != data.end() && !it->is_null()) {
        auto nominal = parse_pose(*it, "nominal_flange_from_sensor");
        if (!nominal) return tl::unexpected(nominal.error());
        options.nominal_flange_from_sensor = *nominal;
    }
    auto list = json_array(data, "observations", "");
    if (!list) return tl::unexpected(list.error());
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        auto observation = parse_sphere_observation((**list)[i], i, json_path("observations", i));
        if (!observation) return tl::unexpected(observation.error());
        sphere.observations.push_back(std::move(*observation));
    }
    return sphere;
}

Expected<CalibrateOutcome> calibrate_tcp_sphere_json(const json& data,
                                                     const std::vector<std::string>& exclude) {
    auto meant = with_usual_poses("tcp-sphere", data);
    if (!meant) return tl::unexpected(meant.error());
    auto sphere = parse_sphere_data(meant->data(), exclude);
    if (!sphere) return tl::unexpected(sphere.error());
    auto solved = calibrate_tcp_sphere(sphere->observations, sphere->options);
    if (!solved) return tl::unexpected(solved.error());

    CalibrateOutcome outcome;
    json& result = outcome.result;
    const bool ok = solved->status == TcpSphereStatus::ok;
    result["method"] = "tcp-sphere";
    result["status"] = std::string(name_of(solved->status));
    result["flange_from_sensor"] = ok ? pose_json(solved->flange_from_sensor) : json(nullptr);
    result["centre_base_mm"] = ok ? vector_json(solved->centre_base_mm) : json(nullptr);
    result["radius_mm"] = ok ? json(solved->radius_mm) : json(nullptr);
    result["rms_mm"] = ok ? number_json(solved->rms_mm) : json(nullptr);
    result["noise_mm"] = ok ? number_json(solved->noise_mm) : json(nullptr);
    if (ok) {
        json sigma = pose_sigma_json(solved->flange_from_sensor, solved->covariance);
        const Eigen::Vector3d centre = solved->centre_covariance.diagonal().cwiseMax(0).cwiseSqrt();
        sigma["centre_mm"] = vector_json(centre);
        sigma["radius_mm"] = solved->radius_sigma_mm;
        sigma["working_mm"] = solved->working_sigma_mm;
        result["sigma"] = std::move(sigma);
        result["covariance_pose"] = matrix_json(solved->covariance);
        result["working_point_mm"] = vector_json(solved->working_point_mm);
    } else {
        result["sigma"] = nullptr;
    }
    result["mirrored"] = std::string(name_of(solved->mirrored));
    put_texts(result, "notices", solved->notices);
    put_texts(result, "degenerate", solved->degenerate);
    json proposals = json::array();
    for (const auto& p : solved->proposals)
        proposals.push_back({{"words", p.words},
                             {"base_from_flange", pose_json(p.base_from_flange)},
                             {"sigma_mm", number_json(p.sigma_mm)}});
    result["proposals"] = std::move(proposals);
    add_report(solved->report, result);
    meant->put(result);
    outcome.exit_code = exit_code_for(solved->report.judgement.verdict);
    return outcome;
}

}  // namespace seamwright
