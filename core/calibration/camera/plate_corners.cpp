#include "core/calibration/camera/plate_corners.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/camera/projection.h"

namespace seamwright {

bool given_flat(const CameraData& data) {
    constexpr double kAtZero_mm = 1e-9;
    return std::all_of(data.views.begin(), data.views.end(), [](const CameraPoints& v) {
        return std::all_of(v.object_mm.begin(), v.object_mm.end(),
                           [](const Eigen::Vector3d& p) { return std::abs(p.z()) <= kAtZero_mm; });
    });
}

Eigen::VectorXd corner_misses(const Intrinsics& k, const Pose& pose, const PlateShape& shape,
                              const ShapeNumbers& bent, const CameraPoints& view) {
    Eigen::VectorXd r(2 * static_cast<Eigen::Index>(view.pixel.size()));
    for (std::size_t i = 0; i < view.pixel.size(); ++i) {
        const Eigen::Vector3d ray = pose * shape.bent(bent.data(), view.object_mm[i]);
        r.segment<2>(2 * static_cast<Eigen::Index>(i)) =
            pixel_of_ray(k.data(), ray.x() / ray.z(), ray.y() / ray.z()) - view.pixel[i];
    }
    return r;
}

PlateShape shape_over(const CameraData& data) {
    Eigen::Vector2d low(1e300, 1e300), high(-1e300, -1e300);
    for (const auto& v : data.views)
        for (const auto& x : v.object_mm) low = low.cwiseMin(x.head<2>()), high = high.cwiseMax(x.head<2>());
    PlateShape shape;
    shape.middle_mm = 0.5 * (low + high);
    shape.half_mm = 0.5 * (high - low).maxCoeff();
    return shape;
}

Eigen::MatrixXd by_pose_and_shape(const Intrinsics& intrinsics, const Pose& pose, const PlateShape& shape,
                                  const CameraPoints& view) {
    const ShapeNumbers bent = shape.numbers();
    Eigen::MatrixXd j(2 * static_cast<Eigen::Index>(view.pixel.size()), kPoseNumbers + kShapeNumbers);
    for (Eigen::Index k = 0; k < j.cols(); ++k) {
        Vector6 by = Vector6::Zero();
        ShapeNumbers up = bent, down = bent;
        double step = 1e-3;  // mm, of shift and bow
        if (k < kPoseNumbers) {
            if (k > 2) step = 1e-6;
            by(k) = step;
        } else {
            if (k < kPoseNumbers + 2) step = 1e-6;  // stretch, shear
            up(k - kPoseNumbers) += step, down(k - kPoseNumbers) -= step;
        }
        j.col(k) = (corner_misses(intrinsics, retract(pose, by), shape, up, view) -
                    corner_misses(intrinsics, retract(pose, -by), shape, down, view)) /
                   (2 * step);
    }
    return j;
}

}  // namespace seamwright
