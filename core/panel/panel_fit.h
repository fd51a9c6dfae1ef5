#pragma once
// Fitting a panel in a single step (methods.md 6; thesis 4.2): sensors on the gripper see, at each spot, the
// panel in the gripper and the body that it goes into.
//
// Frames. Everything stands in the gripper frame at the moment of measuring; S_n = gripper_from_sensor. The
// panel has slipped in the gripper by P (a point taught at p now stands at P p), the body stands off by B.
// The gripper motion G is expressed in the gripper's own frame and multiplies from the right:
//     base_from_gripper_new = base_from_gripper_old * G.
// After it the panel stands at G P p in the old gripper frame; it is where the body wants it when G P = B:
//     single step:  G = B P^-1.
//
// Joint form (4.29), which is what is returned. With the residuals of correction.h in the sensor frame as
// taught, e_P = r_P - S^-1 P^-1 S m_P and e_B alike, the relation that stays off after the motion is
//     delta_n = diag(w_n > 0) (e_B,n - e_P,n)      = s(T_corr) - s_set of (4.20),
// panel relative to body, now minus taught. B follows from the body alone (it says how far the contours have
// turned; G depends on it in second order only); then P, and with it G, minimises sum |w_n delta_n|^2 /
// sigma_n^2. Without deformation both forms are the same; with it the joint one shares the deviation of panel
// and body out over the spots, which is the "best fit". Travel along the contour (weight 0) drops out of
// both, so a contour that slid under the laser plane changes nothing: exact for displaced straight contours
// and for displaced points.
//
// Noise model: as in correction.h on both sides, independent: every observed coordinate of panel and body has
// standard deviation sigma_n. The covariance of G is the first-order propagation of both.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/correction/correction.h"
#include "core/text.h"

namespace seamwright {

struct PanelSide {
    Eigen::Vector3d reference_mm = Eigen::Vector3d::Zero();  // taught, sensor frame
    Eigen::Vector3d measured_mm = Eigen::Vector3d::Zero();
};

struct PanelSpot {
    std::string id;
    Pose gripper_from_sensor = Pose::Identity();
    PanelSide panel, body;
    Eigen::Vector3d weights = {1, 0, 1};  // sensor axes; 0 = not observed
    double sigma_mm = 0.05;               // of an observed coordinate, on either side
    // Direction of the body's surface in the profile, from +x towards +z: what gap and flush refer to.
    double surface_rad = 0;
};

// What becomes of a spot that contradicts the others: a bent panel, or a wrong measure.
enum class PanelDeviation {
    share,     // best fit: every spot counts, the deviation is shared out and stays as residual
    leave_out  // the spot is left out where it can be told (correction.h), and the others fit as if undeformed
};

struct PanelOptions {
    CorrectionLimits limits;  // of G: translation of the gripper's origin, angle
    // Largest predicted sigma of G at the spots, as in correction.h.
    double sigma_limit_mm = 1.0, sigma_limit_deg = 0.5;
    PanelDeviation deviation = PanelDeviation::share;
    double outlier_significance = 1e-3;  // of the spots that are left out, or named when shared
};

// Gap and flush, body = reference side. u = (cos, sin)(surface) along the surface, n across it, (x, z).
//     gap = +-u . (body - panel), the sign taken so that the taught one is positive (when both references
//           have the same place along u: +); larger = wider, negative = overlapping.
//     flush = n . (panel - body): positive = the panel stands proud of the body.
// NaN where the weights do not observe it.
struct GapFlushValue {
    double gap_mm = 0, flush_mm = 0;
};

struct PanelSpotResult {
    std::string id;
    GapFlushValue taught;     // by the references
    GapFlushValue before;     // deviation from taught as measured, in the sensor frame, before the motion
    GapFlushValue remaining;  // deviation from taught that is left after the motion
    Eigen::Vector3d residual_mm =
        Eigen::Vector3d::Zero();  // delta_n: panel relative to body, now - taught; unobserved axes 0
    bool panel_used = true, body_used = true;  // false: left out (PanelDeviation)
};

struct PanelFit {
    // ok | under_determined (motion is identity) | over_limit (motion holds the solution) | not_converged.
    CorrectionStatus status = CorrectionStatus::not_converged;
    Pose gripper_motion = Pose::Identity();  // G, joint form
    Pose single_step = Pose::Identity();     // B P^-1 of the two separate fits
    Matrix6 covariance = Matrix6::Zero();    // of G, tangent of pose.h
    Eigen::Vector3d sigma_xyz_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d sigma_abc_deg = Eigen::Vector3d::Zero();
    double sigma_at_spots_mm = 0;        // weakest direction
    double rms_mm = 0;                   // of the residuals' observed axes, used spots
    RegionCorrection panel, body;        // P and B each by itself, gripper frame
    std::vector<PanelSpotResult> spots;  // in the order given
    std::vector<Text> unobservable;
    Text message;
};

// Which of the two the weights observe, with the surface turned by that.
struct GapFlushObserved {
    bool gap = false, flush = false;
};
GapFlushObserved observed_gap_flush(const Eigen::Vector3d& weights, double surface_rad);

// Refuses (Error) what solve_region refuses, naming panel or body.
Expected<PanelFit> fit_panel(std::span<const PanelSpot> spots, const PanelOptions& options);

// Gap and flush of points given in the sensor frame.
GapFlushValue gap_and_flush(const PanelSpot& spot, const Eigen::Vector3d& panel_mm,
                            const Eigen::Vector3d& body_mm);

}  // namespace seamwright
