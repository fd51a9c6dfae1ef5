#include "projects/calibrate/methods/cameras/several_cameras.h"

#include <cmath>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/solution/camera_json.h"

namespace seamwright {

using nlohmann::json;

Expected<UncertainPose> parse_link(const json& value, const std::string& where) {
    UncertainPose link;
    if (!value.is_object() || !value.contains("pose")) {
        SEAM_TRY(auto pose, parse_pose(value, where));
        link.pose = pose;
        return link;
    }
    SEAM_OK(only_fields(value, {"pose", "covariance", "sigma_mm", "sigma_deg"}, where));
    SEAM_TRY(auto pose, parse_pose(value["pose"], json_path(where, "pose")));
    link.pose = pose;
    if (value.contains("covariance")) {
        if (value.contains("sigma_mm") || value.contains("sigma_deg"))
            return input_error("covariance and sigma are both given", where, "give one of them");
        SEAM_TRY(auto rows, json_array(value, "covariance", where));
        const std::string path = json_path(where, "covariance");
        if (rows->size() != 6) return input_error("the covariance has not six rows", path);
        for (std::size_t i = 0; i < 6; ++i) {
            SEAM_TRY(auto row, as_numbers((*rows)[i], 6, json_path(path, i)));
            for (std::size_t k = 0; k < 6; ++k)
                link.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = row[k];
        }
        SEAM_OK(check_variances(link.covariance.diagonal(), path));
        return link;
    }
    SEAM_TRY(auto mm, json_sigma_or_exact(value, "sigma_mm", 0, where));
    SEAM_TRY(auto deg, json_sigma_or_exact(value, "sigma_deg", 0, where));
    link.covariance.diagonal().head<3>().setConstant(mm * mm);
    link.covariance.diagonal().tail<3>().setConstant(std::pow(rad_from_deg(deg), 2));
    return link;
}

Expected<PlacedCamera> parse_placed_camera(const json& entry, std::size_t index, const std::string& where) {
    PlacedCamera camera;
    SEAM_TRY(auto id, entry_id(entry, index, where));
    camera.id = id;
    SEAM_TRY(auto lens, json_field(entry, "camera", where));
    SEAM_TRY(auto model, parse_camera(*lens, json_path(where, "camera")));
    camera.camera = model;
    SEAM_TRY(auto place, json_field(entry, "world_from_camera", where));
    SEAM_TRY(auto link, parse_link(*place, json_path(where, "world_from_camera")));
    camera.world_from_camera = link;
    return camera;
}

}  // namespace seamwright
