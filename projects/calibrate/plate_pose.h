#pragma once
// Where a plate stands before a camera, from one image of it (thesis 2.2, 4.1.4): the board is found
// (core/calibration/board/board.h) and placed on the rays of its points (core/calibration/bundle/bundle.h, one camera as
// the world).
//
// One image of a plate says its tilt in a second order only, and which way it tilts by its perspective alone. Where a
// second place, the one mirrored about the line of sight, explains the points about as well, nothing is answered but
// both places; a start decides between them. The camera is taken as exact: what its own calibration errs by is not in
// the covariance.

#include <optional>

#include "core/calibration/board/board.h"
#include "core/calibration/bundle/bundle.h"

namespace seamwright {

struct PlatePose {
    FoundBoard board;
    // world = camera: world_from_object is camera_from_plate, sights are the board's points in their order, their features
    // its indices. Not determined: `rival` or the judgement's reason say why.
    BundleResult pose;
    double tilt_deg = 0;  // of the plate's normal against the line of sight to its middle
};

// Error (input): no such board in the image, an image of another size than the camera's, a camera or board that is none.
Expected<PlatePose> plate_pose(const StripeImage& image, const BoardSpec& spec, const CameraModel& camera,
                               const std::optional<Pose>& start = std::nullopt);

}  // namespace seamwright
