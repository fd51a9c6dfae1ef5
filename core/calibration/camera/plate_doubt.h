#pragma once
// Whether the views of a plate contradict its stated shape. Private to core/calibration/camera.
//
// Freed beside camera and poses: stretch, shear and bow (PlateShape), the same in all views. What that takes off the sum of
// squares is compared by F with what remains, and, where that is more, with what shapes of each view's own would take off:
// corners that err alike within a view (blur, light, a lens that is not quite the model's) do so by the view, a plate does
// in all. A shape that is not chance bends the camera beyond its sigmas, which know of the corners' noise alone.

#include "core/calibration/camera/plate_bundle.h"

namespace seamwright {

struct PlateDoubt {
    bool tells = false;
    PlateShape shape;                       // that the views speak for
    double fall = 0;                        // of the sum of squares, 0 .. 1
    Intrinsics moves = Intrinsics::Zero();  // of the camera when the shape is freed
};

// None of fewer than five views, or of targets not given as flat in z = 0. `exactly`: what `freedom` does not solve for is
// held exactly, else within held_intrinsics().
PlateDoubt doubt_of_plate(const CameraData& data, const std::vector<std::vector<char>>& used,
                          const CameraFreedom& freedom, bool exactly, double corner_sigma_px,
                          const CameraSolution& solution);

}  // namespace seamwright
