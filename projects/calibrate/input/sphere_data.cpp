#include "projects/calibrate/input/sphere_data.h"

#include <limits>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"

namespace seamwright {

using nlohmann::json;

constexpr double kLargestSphere_mm = 1000;  // radius

Expected<SphereObservation> parse_sphere_observation(const json& entry, std::size_t index,
                                                     const std::string& where) {
    SphereObservation observation;
    SEAM_TRY(auto id, entry_id(entry, index, where));
    observation.id = id;
    SEAM_TRY(auto pose_field, json_field(entry, "base_from_flange", where));
    SEAM_TRY(auto pose, parse_pose(*pose_field, json_path(where, "base_from_flange")));
    observation.base_from_flange = pose;
    SEAM_TRY(auto profile, json_array(entry, "profile", where));
    const std::string path = json_path(where, "profile");
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < profile->size(); ++i) {
        const json& point = (*profile)[i];
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
    SphereData sphere;
    TcpSphereOptions& options = sphere.options;
    options.exclude = exclude;
    if (!data.contains("radius_mm"))
        return input_error("the sphere's radius is missing", "radius_mm",
                           "give it in millimetres, or null to solve for it");
    if (!data["radius_mm"].is_null()) {
        SEAM_TRY(auto radius, json_number(data, "radius_mm", ""));
        if (radius > kLargestSphere_mm)
            return input_error("the sphere's radius is not between 0.1 and 1000 mm", "radius_mm",
                               "give it in millimetres as its certificate says");
        options.radius_mm = radius;
    }
    if (const auto it = data.find("nominal_flange_from_sensor"); it != data.end() && !it->is_null()) {
        SEAM_TRY(auto nominal, parse_pose(*it, "nominal_flange_from_sensor"));
        options.nominal_flange_from_sensor = nominal;
    }
    SEAM_TRY(const auto robot, repeatability_of(data));
    options.robot = robot;
    SEAM_TRY(auto list, json_array(data, "observations", ""));
    for (std::size_t i = 0; i < list->size(); ++i) {
        SEAM_TRY(auto observation, parse_sphere_observation((*list)[i], i, json_path("observations", i)));
        sphere.observations.push_back(std::move(observation));
    }
    return sphere;
}

}  // namespace seamwright
