#pragma once
// How exactly the corners of a plate were read, whatever the camera: per view a homography and on top of it a
// polynomial of fourth order (third below 40 points) in the plate's coordinates, which takes up every lens and
// every bow of the plate. What is left is noise of single corners.

#include <vector>

#include "core/calibration/camera/camera.h"

namespace seamwright::detail {

// Standard deviation of one coordinate, px, pooled over the views of at least 24 points; 0 where there are
// none.
double corner_noise_px(const std::vector<CameraPoints>& views);

}  // namespace seamwright::detail
