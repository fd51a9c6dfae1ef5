#pragma once
// Where a laser-stripe sensor sits on the robot's flange, from profiles of one fixed sphere (thesis 2.4.3).
//
// Unknown: flange_from_sensor (R, t), the sphere's centre c in the robot's base, and its radius r when it is
// not given. Observation i: base_from_flange B_i and profile points p = (x, 0, z) in the sensor frame. With
// the centre in the sensor frame, s_i = R^T (B_i^-1 c - t), the residual of a point is
//     e = |p - s_i| - r  =  |B_i (R p + t) - c| - r        [mm]
// and sum e^2 over all points of the sphere is minimised. This is the objective that the thesis announces as
// (2.34) and does not print (corrected); (2.28)-(2.33) are its linear sphere fit, which needs R and t
// beforehand.
//
// Start, with no guess from the user: each profile is a circle (a, b, rho) in the laser plane, so s_i lies at
// (a, +-sqrt(r^2 - rho^2), b). In the two directions within the laser plane the chain is free of that sign:
// for an assumed direction of the sensor's Y axis it is linear in the turn about it, in t and in c.
// Ninety-six directions over the whole sphere give starts; from each the exact problem is solved on the
// profiles' sufficient statistics (three numbers a profile, the sign resolved by s_y^2), the best is kept,
// and a second, different minimum that fits equally well makes the answer undetermined.
//
// Noise model: independent radial noise of the points, its size estimated, which may vary over the arc
// (heteroscedastic sandwich covariance). When the profiles disagree with one another by more than their own
// noise explains (robot errors; F test at 99 %), an isotropic error of each s_i of the size that explains it
// is propagated too, times Student's factor of the numbers that tell its size (two of a profile count rather than three,
// TcpSphereResult::sigma_freedom), so that value +- 1.96 sigma keeps holding 95 %. Where these are few the verdict goes by
// the upper end of what the sigma can be, and no pose is left out that those left could not convict. Where the robot's
// repeatability is stated, such an error of that size is always propagated, whether the profiles are many enough to show it
// or not, and what they show counts only where it is beyond chance against the stated.
//
// Points (x, 0, z) never leave y = 0, so the sensor's Y axis enters through R's handedness alone: a profile
// with x (or z) mirrored is fitted exactly as well by a sensor turned half about its Z (or X) axis. No
// residual can tell them apart. What can: the visible cap of the sphere must face the sensor (+z unless the
// sensor says otherwise), the order of the points, and a nominal mounting when one is given.
// TcpSphereResult::mirrored says which.
//
// Degenerate: one orientation only (t and c exchange), rotations about one axis only (their component along
// it exchanges), the sphere always at one place or on one line in the sensor frame (R turns about it). All
// give status undetermined, named in words, with the next pose to take.

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/calibration/field_scale.h"
#include "core/calibration/robot_repeatability.h"
#include "core/geometry/pose.h"
#include "core/profile/profile.h"

namespace seamwright {

struct SphereObservation {
    std::string id;
    Pose base_from_flange = Pose::Identity();
    Profile profile;  // raw; points of post, table and background may be in it
};

struct TcpSphereOptions {
    std::optional<double> radius_mm;   // absent: solved for
    std::vector<std::string> exclude;  // ids left out of the solution; their residual is still given
    // Where the sensor should sit, when known: only used to recognise mirrored axes, never as a start.
    std::optional<Pose> nominal_flange_from_sensor;
    RobotRepeatability robot;  // not stated: estimated where it shows
    // false: many times quicker and for comparing many sets of poses: wrong poses are left out only where they show
    // without searching small subsets, and nothing is held out or proposed.
    bool thorough = true;
};

inline constexpr int kTcpSphereFewestPoses = 6;  // distinct ones; nine or more are better

enum class TcpSphereStatus {
    ok,
    undetermined,   // the poses cannot determine the answer, or two answers fit equally: see judgement
    not_converged,  // no sphere common to the profiles was found
};
std::string_view name_of(TcpSphereStatus status);

// none: nothing points at a mirrored axis. x, z: that axis of the profile is mirrored (why stands in
// notices).
enum class MirroredAxis { none, x, z };
std::string_view name_of(MirroredAxis axis);

// A pose that would help most, in words and as a pose of the flange. The sphere stays in view there as far as
// the data know where it is; from an undetermined set the orientation counts, and the sphere is jogged into
// the view.
struct PoseProposal {
    Text words;  // "turn the sensor about its X axis by 25 degrees with the sphere in view"
    Pose base_from_flange = Pose::Identity();
    double sigma_mm = 0;  // largest sigma of the weakest direction after adding it (see weakest_sigma_mm)
};

struct TcpSphereResult {
    TcpSphereStatus status = TcpSphereStatus::undetermined;
    Pose flange_from_sensor = Pose::Identity();
    Eigen::Vector3d centre_base_mm = Eigen::Vector3d::Zero();
    double radius_mm = 0;
    double rms_mm = 0;    // of e over the points used
    double noise_mm = 0;  // of a point about its own profile's circle
    // By what the profiles used contradict one another, known also of an undetermined answer: mean square (mm^2,
    // noise_mm^2 where nothing but the points' noise is at work) of `poses_freedom` degrees, 3 profiles - unknowns.
    double poses_variance_mm2 = 0, poses_freedom = 0;
    // The profiles fit one sphere of this radius as they should; how well the poses determine the answer is apart.
    bool fits = false;
    Matrix6 covariance = Matrix6::Zero();  // of flange_from_sensor, tangent of pose.h
    Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Zero();
    double radius_sigma_mm = 0;  // 0 when the radius was given
    // Of the numbers that the covariance rests on where it is told by the poses' scatter; infinite: it is not.
    double sigma_freedom = std::numeric_limits<double>::infinity();
    Eigen::Vector3d working_point_mm = Eigen::Vector3d::Zero();  // mean of s_i: the working distance
    double working_sigma_mm = 0;  // largest sigma of the working point in the flange frame
    // Of the sensor's own millimetres, as the cuts show them; zero: they do not, or the radius was not given.
    FieldScale scale;
    double weakest_sigma_mm = 0;  // largest sigma of any direction, rotations on a lever of 100 mm
    MirroredAxis mirrored = MirroredAxis::none;
    std::vector<Text> notices;            // plain words, worth a look
    std::vector<Text> degenerate;         // plain words, what the poses do not determine and what to do
    std::vector<PoseProposal> proposals;  // best first; each assumes the ones before it were taken
    CalibrationReport report;  // parameters x y z [mm] rx ry rz [deg, rotation vector] centre_* radius
};

// Bad input (fewer than six distinct poses, metres, unknown id to exclude, NaN pose, radius not positive ...)
// is an Error. Deterministic: equal input gives equal output. Some milliseconds for nine profiles of a few
// hundred points.
Expected<TcpSphereResult> calibrate_tcp_sphere(const std::vector<SphereObservation>& observations,
                                               const TcpSphereOptions& options = {});

}  // namespace seamwright
