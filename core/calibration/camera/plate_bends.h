#pragma once
// Whether the plate bends from view to view: held, leant or lifted otherwise, a thin plate has another shape each time, and
// the camera that is solved for errs by that far beyond the corners' noise. Private to core/calibration/camera.
//
// Each view's shape (stretch, shear, bow: PlateShape) by linear least squares beside its pose; its covariance from the
// corners of that view as they scatter (noise may grow to the border). A variance per number on top of that, by moments,
// where the views' shapes differ by more than chance (F). What it does to the camera is carried through the normal
// equations, each view by itself.

#include <Eigen/Core>

#include "core/calibration/camera/plate_bundle.h"

namespace seamwright {

struct PlateBends {
    bool tells = false;
    double bow_mm = 0;  // rms of the largest of the bow's three numbers, at half the plate's length
    Eigen::Matrix<double, 9, 9> covariance =
        Eigen::Matrix<double, 9, 9>::Zero();  // of the intrinsics, by it alone
};

// `unit`: covariance of the intrinsics' basis for a corner noise of one pixel. None of fewer than five views, or of targets
// not given as flat in z = 0.
PlateBends bends_of_plate(const CameraData& data, const std::vector<std::vector<char>>& used,
                          const CameraSolution& solution, const Eigen::MatrixXd& unit);

}  // namespace seamwright
