#include "projects/calibrate/plate_pose.h"

#include <algorithm>
#include <string>

namespace seamwright {

Expected<PlatePose> plate_pose(const StripeImage& image, const BoardSpec& spec, const CameraModel& camera,
                               const std::optional<Pose>& start) {
    SEAM_OK(validate(spec));
    if (image.width != camera.width || image.height != camera.height)
        return input_error(Text("the image has {} x {} pixels, the camera {} x {}", image.width, image.height,
                                camera.width, camera.height),
                           "image", "give an image of this camera at the same resolution");
    BoardSearch search = find_board(image, spec);
    if (!search.board) return input_error(why_missed(spec, search.miss), "image", cure_of(search.miss));
    PlatePose found;
    found.board = std::move(*search.board);
    std::vector<BundleSight> sights(found.board.pixel.size());
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < sights.size(); ++i) {
        sights[i].feature = std::to_string(found.board.index[i]);
        sights[i].object_mm = found.board.object_mm[i];
        sights[i].pixel = found.board.pixel[i];
        middle += found.board.object_mm[i] / static_cast<double>(sights.size());
    }
    BundleOptions options;
    options.start = start;
    SEAM_TRY(found.pose, locate_object({{"camera", camera, {}}}, sights, options));
    if (found.pose.determined) {
        const Pose& p = found.pose.world_from_object;
        const double along = p.linear().col(2).dot((p * middle).normalized());
        found.tilt_deg = deg_from_rad(std::acos(std::clamp(std::abs(along), 0.0, 1.0)));
    }
    return found;
}

}  // namespace seamwright
