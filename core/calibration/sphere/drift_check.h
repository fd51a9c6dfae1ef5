#pragma once
// Does a stored calibration still hold? Two or three spheres, or plate points, measured again in a minute.
//
// Each target has a place known from the calibration (its centre in the robot's base or world, with a
// covariance) and is measured again through the stored calibration, from one or several poses. If nothing has
// changed all differences are noise. Otherwise a rigid change of the sensor on its flange
// (flange_new_from_old) is looked for.
//
// For measurement i: flange pose B_i, measured place m_i (sensor frame -> flange by the stored calibration)
// and known place k_i:  e_i = B_i^-1 k_i - m_i  [flange frame, mm]. Without change e_i ~ N(0, S_i), S_i its
// full covariance (a profile knows a sphere's centre well within the laser plane and badly across it). The
// change D = (R, t) with m_i' = R m_i + t is fitted as far as the measurements determine it: one place gives
// its shift, two the turn across their line, three not on a line all six. Directions not determined stay zero
// and are named.
//
// The stored calibration errs too: what its mounting and the known centre are off shows in every e_i alike. Where their
// covariance C is given, the e_i together have blocks S_i plus J C J^T (J: by_stored of each), and a change counts against
// both; without it they are taken as exact, and what they err is taken for a change.
//
// Significance: sum e^T S^-1 e against chi-squared at 99 %; the change's own sigma beside it. Where the measurements scatter
// about the fitted change by more than their S_i make likely, each S_i is widened by an equal variance on every axis until chi
// squared is what is expected (the robot's repeatability was not stated, or is worse), and the change counts by F. `holds` is
// a statement too: only when every direction is determined to half its limit and the change lies within. What is neither a
// significant change nor known to be within the limits is undetermined.

#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/calibration/sphere/tcp_sphere.h"
#include "core/geometry/pose.h"

namespace seamwright {

// Of the stored calibration: mounting (tangent of pose.h), the sphere's centre in the base, its radius; mm and rad.
using StoredCovariance = Eigen::Matrix<double, 10, 10>;

struct DriftMeasurement {
    std::string id;
    Pose base_from_flange = Pose::Identity();
    Eigen::Vector3d measured_flange_mm = Eigen::Vector3d::Zero();  // through the stored flange_from_sensor
    Eigen::Vector3d known_base_mm = Eigen::Vector3d::Zero();
    // Of e_i in the flange frame: sensor, robot repeatability and the known place together.
    Eigen::Matrix3d covariance = 0.0025 * Eigen::Matrix3d::Identity();
    // How e_i goes with the stored numbers; their order as in StoredCovariance.
    Eigen::Matrix<double, 3, 10> by_stored = Eigen::Matrix<double, 3, 10>::Zero();
};

// By the mounting alone: of a place that was measured through it.
Eigen::Matrix<double, 3, 6> drift_by_mounting(const Pose& stored_flange_from_sensor,
                                              const Eigen::Vector3d& measured_flange_mm);

// The measurement that one profile of a sphere gives through the stored calibration: the circle in the laser
// plane, and the centre's distance from that plane by sqrt(r^2 - rho^2) with the sign that the stored
// calibration expects. `other_sigma_mm` (robot repeatability, known centre) is added on each axis. Error: no
// circle of this sphere in the profile.
Expected<DriftMeasurement> drift_measurement(const SphereObservation& observation, double radius_mm,
                                             const Pose& stored_flange_from_sensor,
                                             const Eigen::Vector3d& known_centre_base_mm,
                                             double other_sigma_mm);

// A turn of 0.3 degrees costs 0.08 mm on a part that stands 15 mm off (0 where it stands as taught), and is what
// one sphere in kDriftViews views, near and far, left and right, can tell beside a good calibration's own sigma
// of 0.1 degree; fewer views mostly leave it open.
struct DriftLimits {
    double translation_mm = 0.1;
    double rotation_deg = 0.3;
};
inline constexpr int kDriftViews = 9;

enum class DriftStatus { holds, drifted, undetermined };
std::string_view name_of(DriftStatus status);

struct DriftResult {
    DriftStatus status = DriftStatus::undetermined;
    Pose change = Pose::Identity();                 // new sensor pose = change * stored flange_from_sensor
    Matrix6 covariance = Matrix6::Zero();           // of the determined directions
    double change_mm = 0;                           // largest shift of a measured place by `change`
    double change_deg = 0;                          // angle of `change`
    double sigma_mm = 0, sigma_deg = 0;             // of the two
    double chi_squared = 0, chi_squared_limit = 0;  // of "nothing has changed", by the S_i as they are given
    double rms_before_mm = 0, rms_after_mm = 0;     // of e_i, with and without the change
    std::vector<Text> not_determined;               // "turn about Z of the flange"
    CalibrationReport report;                       // poses: per-measurement |e_i|; judgement
};

// `stored`: zero where the stored calibration is taken as exact. Error: no measurement, a covariance that is none, NaN,
// metres.
Expected<DriftResult> check_drift(const std::vector<DriftMeasurement>& measurements,
                                  const DriftLimits& limits = {},
                                  const StoredCovariance& stored = StoredCovariance::Zero());

}  // namespace seamwright
