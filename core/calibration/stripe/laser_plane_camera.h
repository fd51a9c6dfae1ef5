#pragma once
// Whether pairs of pixel and laser point speak against the camera that they were given. Private to core/calibration/stripe.
//
// The pose takes up most of what a wrong camera does to the points of one plane; what it leaves has a form of its own.
// Beside the pose are freed: both focal lengths by one factor, the centre and k1, held within what a camera may differ
// from its data sheet by (5 %, 3 % of the width, 0.3). The sums of squares with and without them are compared by F.

#include "core/calibration/camera/camera.h"

namespace seamwright {

struct CameraDoubt {
    bool tells = false;  // chance below kNoAccident (of a camera without distortion 0.5 %), and no rounding
    double pattern_px = 0;            // rms over the pairs of what the freed camera takes away, per point
    Vector6 moves = Vector6::Zero();  // of the pose when it is freed, tangent of pose.h
};

// `pose`: solved under `camera`; `squares_px2`: what it leaves.
CameraDoubt doubt_of_camera(const CameraModel& camera, const Pose& pose, const CameraPoints& view,
                            double squares_px2);

// The pairs read as [v, u] fit so much better that it is no accident: what they then fit to, px per point. Infinity: they do
// not fit otherwise.
std::optional<double> fits_swapped(const CameraModel& camera, const CameraPoints& view, double squares_px2);

}  // namespace seamwright
