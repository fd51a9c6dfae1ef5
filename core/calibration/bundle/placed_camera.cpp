#include "core/calibration/bundle/placed_camera.h"

#include <cmath>

#include "core/calibration/pose_set.h"
#include "core/geometry/decompositions.h"

namespace seamwright {

Expected<void> check_cameras(const std::vector<PlacedCamera>& cameras) {
    std::vector<std::string> ids;
    for (const PlacedCamera& c : cameras) {
        const Text where("camera '{}'", c.id);
        const Intrinsics k = intrinsics_of(c.camera);
        if (!k.allFinite() || !(c.camera.fx > 0) || !(c.camera.fy > 0) || c.camera.width < 2 ||
            c.camera.height < 2)
            return input_error("the camera has no focal length or no image", where,
                               "give fx, fy, cx, cy, width and height as \"calibrate camera\" writes them");
        SEAM_OK(check_uncertain_pose(c.world_from_camera, where));
        ids.push_back(c.id);
    }
    return check_ids(ids, {}, "cameras");
}

Expected<void> check_pixel(const PlacedCamera& camera, const Eigen::Vector2d& pixel, const Text& where) {
    if (!pixel.allFinite()) return input_error("the pixel is not made of finite numbers", where);
    if (pixel.x() < -0.5 || pixel.y() < -0.5 || pixel.x() > camera.camera.width - 0.5 ||
        pixel.y() > camera.camera.height - 0.5)
        return input_error(Text("the pixel {:.1f}, {:.1f} lies outside the image of camera '{}', {} x {}",
                                pixel.x(), pixel.y(), camera.id, camera.camera.width, camera.camera.height),
                           where, "check which camera saw it");
    return {};
}

double worst_sigma(const Eigen::Matrix3d& covariance) {
    return std::sqrt(std::max(0.0, symmetric_eigen(covariance).values(2)));
}

}  // namespace seamwright
