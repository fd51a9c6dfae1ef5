#pragma once
// The mirrored part: a project for the right-hand door from that of the left-hand one.
//
// Let S be the reflection in a plane of the work object frame, S p = R p + 2 d n, R = I - 2 n n^T: a point p
// of the part as taught is S p of its mirror image. S is no pose (its determinant is -1), and neither the
// sensor nor a frame can be built mirrored. Each frame that looks at the part is therefore reflected on both
// sides,
//     W' = S W K,      K = diag(-1, 1, 1) for sensors, K = R for the work object and the robot's frames,
// which is a proper motion again (det = (-1)(-1)): the sensor stands mirrored, and what it sees is mirrored
// in its own x. Travel (+Y) and height (z) keep their sense: the robot runs along the mirrored contour, entry
// still before the trigger. A sensor point p becomes K p: reference, template and reference profiles, search
// windows, contour curves (x(y) -> -x(y)); a contour that ended on the left ends on the right. The work
// object moves by S I R = shift by 2 d n and keeps its axes; a point of it, of a frame, or of the mesh
// becomes R p.
//
// Displacements are conjugated: D' = R D R, in the mirrored work object. With r' = K r and m' = K m the
// residual of correction.h is
//     r' - W'^-1 D'^-1 W' m' = K (r - W^-1 D^-1 W m),
// so weights, sigmas and limits (lengths and angles) carry over, the minimum is D' exactly, and the
// covariance follows: translations turn by R, rotation vectors, being pseudovectors, by -R. Free degrees of
// freedom: in a plane along the axes the KUKA angles of D' are those of D up to their sign, so that a fixed
// one stays fixed. In an oblique plane that holds only when all three translations are alike free or fixed,
// and all three rotations; else the clone is refused. Finders give the mirrored point up to rounding, unless
// two candidates are equally good to the last digit; a template is found again within a hundredth of the
// noise.
//
// Calibrations stay: sensor, holder and robot are the same, only the taught flange poses change,
//     base_from_flange' = base_from_workobject * W' * flange_from_sensor^-1.
// Hence a spot without a calibration cannot be mirrored. Whether the robot reaches the poses is not known
// here. The references are those of the mirrored part as drawn; teach them again where its tolerances count.

#include <Eigen/Core>

#include "projects/model/project.h"

namespace seamwright {

// Unit normal n, and d: distance from the work object's origin along n, mm.
struct MirrorPlane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
    double offset_mm = 0;
};

// "x", "y", "z" (the axis the plane is normal to, i.e. whose sign changes), or a normal "0.1,1,0" of any
// length.
Expected<MirrorPlane> parse_mirror_plane(const std::string& text, double offset_mm = 0);

// S p.
Eigen::Vector3d mirrored_point(const MirrorPlane& plane, const Eigen::Vector3d& workobject_mm);
// R D R, and its covariance in the tangent of pose.h.
Pose mirrored_displacement(const MirrorPlane& plane, const Pose& displacement);
Matrix6 mirrored_covariance(const MirrorPlane& plane, const Matrix6& covariance);

// Mirrored in x, points in reverse order: the sensor's order runs along +x again.
Profile mirrored_profile(const Profile& profile);
// Refuses a kind that is not known here.
Expected<FeatureRecipe> mirrored_recipe(const FeatureRecipe& recipe);

// Refuses (input): a normal without length, a spot without calibration, a region whose free degrees an
// oblique plane mixes, a mesh that cannot be read.
Expected<Project> mirrored_project(const Project& project, const MirrorPlane& plane);

}  // namespace seamwright
