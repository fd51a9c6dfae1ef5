#pragma once
// Where a plate stands in the world, from points known on it and measured there (thesis 4.1.4; Arun, Huang
// and Blostein 1987).
//
// world_i = R plate_i + t + noise. R by the singular value decomposition of the centred sets with the
// determinant guard (4.15), which keeps a mirrored solution out when the points are planar or noisy; t =
// mean(world) - R mean(plate). The thesis writes (4.11)-(4.17) for world to plate; here they give
// world_from_plate.
//
// Noise model: isotropic, equal, independent errors of the world points, standard deviation estimated from
// the residuals (3 n - 6 degrees of freedom) unless given; a given one that they contradict counts no more
// (contradicts_stated()), and the verdict is poor. Covariance sigma^2 (J^T J)^-1 with Student's
// factor when estimated. Degenerate: fewer than three points, coinciding points (Error); points on one line
// (status undetermined, the turn about it is free). With four points or more, one wrong point is found by
// leaving each out, named and left out.

#include <optional>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/geometry/pose.h"

namespace seamwright {

// Least-squares rigid transform to_from with to_i ~ to_from * from_i over the indices with use[i] (all when
// empty). Needs three points that are not on one line to be unique; otherwise one of the solutions.
Pose fit_rigid(const std::vector<Eigen::Vector3d>& to, const std::vector<Eigen::Vector3d>& from,
               const std::vector<bool>& use = {});

struct PlatePoint {
    std::string id;
    Eigen::Vector3d plate = Eigen::Vector3d::Zero();  // mm, plate frame
    Eigen::Vector3d world = Eigen::Vector3d::Zero();  // mm
};

struct PlateOptions {
    std::vector<std::string> exclude;
    std::optional<double> sigma_mm;  // of a world point an axis, when the measuring system states it
};

enum class PlateStatus { ok, undetermined };
std::string_view name_of(PlateStatus status);

struct PlateResult {
    PlateStatus status = PlateStatus::undetermined;
    Pose world_from_plate = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
    double rms_mm = 0;    // |world - world_from_plate * plate| over the points used
    double sigma_mm = 0;  // of a point an axis: estimated, or the given one where the residuals let it stand
    bool contradicted = false;  // the points scatter more than the given sigma allows
    double scale = 1;           // of world over plate distances; off 1 means units or a wrong plate
    bool mirrored = false;      // the points fit a mirrored plate better: an axis of one set is flipped
    std::vector<Text> notices;
    CalibrationReport report;  // parameters x y z [mm] rx ry rz [deg]; poses = points
};

Expected<PlateResult> calibrate_plate(const std::vector<PlatePoint>& points,
                                      const PlateOptions& options = {});

}  // namespace seamwright
