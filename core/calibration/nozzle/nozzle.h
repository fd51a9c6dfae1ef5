#pragma once
// Where the nozzle's tip is on the flange, from touches of one known target: flange_from_nozzle, of which the three
// numbers of the tip are found; its orientation is the programmed tool's.
//
// The target is a sphere that the calibrated sensor has measured (the tip touches it anywhere), or a sharp point whose
// place in the robot's base is known (the tip is brought onto it). With F_i = base_from_flange of touch i, t the tip
// [mm, flange], c the target's place [mm, base], rho the distance of tip and centre:
//     sphere   e_i = |F_i t - c| - rho      one equation a touch     rho = radius (+ radius of a ball at the tip)
//     point    e_i = F_i t - c              three equations a touch
// The tip is a point or a ball: a measuring pin in the nozzle, not the rim of its bore. With one orientation the flange's
// places lie on a sphere about c - R t, which is the sphere fit of (2.29) of the thesis; with several it is the fit of a
// tool on a fixed reference (ISO 9283's TCP, "pivot calibration") with the centre known.
//
// Noise model. Random, of each touch anew: the hand, sigma_mm along the normal (of a point in each axis), as stated or
// estimated from the scatter; and the robot's repeatability, position and turn about the flange's origin. Common to all
// touches: c ~ N(c0, S), as the sensor measured it, and rho ~ N(rho0, s^2), which holds what a hand always presses or
// leaves open. Both are unknowns with these priors (generalised least squares), so the covariance holds them and the
// touches correct them as far as they can: c and t part only by turning the flange. Of touches that all have one
// orientation c's error goes into the tip whole, R^T S R; they determine it all the same, and a notice says so.
//
// rho is tested besides: where the touches with a free rho fit better than chance allows (F test, 5 in a thousand), and
// where no sigma of it is stated by more than the assumed one, the verdict is poor and names what rho comes out as.
//
// An estimated sigma makes chi squared of the touches as large as its expectation, n - tr(J C J^T W) (GUM, Satterthwaite's
// degrees of freedom), and the random part of the covariance is stretched so that 1.96 sigma hold 95 % (Student).
//
// Wrong touches (slipped): the one whose absence explains the misfit is left out and named where chance makes so large a
// drop once in a thousand (Bonferroni over the touches); where two touches explain it as well, neither is left out, both
// are named and the verdict is poor.
//
// c is tested besides, where the flange was turned: the verdict is poor and names where the target stands when the touches
// with a free c fit better than chance allows (F of three, 5 in a thousand), and when a free c that leaves out fewer
// touches explains them as well as leaving out does. A target that was knocked looks like slipped touches otherwise.
//
// Degenerate, named with the next touch that closes it, never regularised: fewer than four touches of a sphere, touches
// in a plane through which the tip can be mirrored (a second place fits as well), a direction of the tip known worse
// than 2 mm.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/calibration/robot_repeatability.h"
#include "core/geometry/pose.h"

namespace seamwright {

// One sigma of the distance of tip and centre, of itself, where none is stated.
inline constexpr double kUnstatedRadius = 0.005;

struct NozzleTouch {
    std::string id;
    Pose base_from_flange = Pose::Identity();
};

// radius_mm absent: a sharp point.
struct NozzleTarget {
    Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();        // c0, base
    Eigen::Matrix3d covariance_mm2 = Eigen::Matrix3d::Zero();  // S, base; common to all touches
    std::optional<double> radius_mm;
    // Of radius and tip's ball together, common to all touches; absent: kUnstatedRadius of them.
    std::optional<double> radius_sigma_mm;
};

struct NozzleOptions {
    std::vector<std::string> exclude;
    std::optional<double> sigma_mm;  // of a touch; absent: estimated from the scatter
    double tip_radius_mm = 0;        // of a ball at the tip; with a sphere only
    RobotRepeatability robot;
    bool thorough = true;  // without: no touch is found wrong, none held out; for ranking conventions
    std::optional<Pose> programmed;  // flange_from_tool as the controller has it
};

enum class NozzleStatus { ok, undetermined };
std::string_view name_of(NozzleStatus status);

// Of the found tip against the programmed one, flange.
struct NozzleDeviation {
    Eigen::Vector3d mm = Eigen::Vector3d::Zero();
    double chi_squared = 0, limit = 0;  // of "the programmed tool is right", three degrees of freedom, 99 %
    bool beyond_chance = false;
};

struct NozzleResult {
    NozzleStatus status = NozzleStatus::undetermined;
    Pose flange_from_nozzle = Pose::Identity();
    // Of the tip, mm^2, flange: part by the touches, part by the target's place; and their sum.
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero(), covariance_random = Eigen::Matrix3d::Zero(),
                    covariance_systematic = Eigen::Matrix3d::Zero();
    double worst_sigma_mm = 0;                 // along the direction known worst
    double rms_mm = 0;                         // of e_i over the touches used
    double sigma_mm = 0;                       // of a touch: stated or estimated
    double freedom = 0;                        // degrees of freedom that are left to judge the touches by
    std::optional<NozzleDeviation> deviation;  // absent: no programmed tool was given
    std::vector<Text> notices;
    std::vector<Text> open;    // what is not determined
    std::vector<Text> advice;  // the touch that would help most; empty when good
    CalibrationReport report;  // parameters x, y, z [mm]; poses = touches
};

// Error (input): values that are none, ids, metres, a covariance that is none, sigmas that are not above zero.
Expected<NozzleResult> calibrate_nozzle(const std::vector<NozzleTouch>& touches, const NozzleTarget& target,
                                        const NozzleOptions& options = {});

}  // namespace seamwright
