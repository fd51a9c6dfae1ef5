#pragma once
// What every calibration of the house answers besides its own result: which numbers were found and how sure
// they are, how well each pose fits, what poses not used say about it, and one verdict with its reason and
// its cure.

#include <Eigen/Core>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/calibration/verdict.h"
#include "core/geometry/pose.h"
#include "core/text.h"

namespace seamwright {

// `reason` and `cure` are one sentence each, in the words of the person at the robot. `cure` is empty when
// good.
struct Judgement {
    Verdict verdict = Verdict::undetermined;
    Text reason;
    Text cure;
};

// One solved number. Value and sigma in `unit`, which is one of "mm", "deg", "px", "px/mm", "1" ...
struct CalibratedParameter {
    std::string name;
    double value = 0;
    std::string unit;
    double sigma = 0;
};

// Two parameters that the data can hardly tell apart: |correlation| above the limit.
struct CorrelatedPair {
    std::string first;
    std::string second;
    double correlation = 0;
};

// How one pose (observation, image, point) fits. Parts that a method does not have are NaN. A pose with used
// == false took no part in the solution (excluded by the user or found wrong); its residual is still given.
struct PoseResidual {
    std::string id;
    double rms_mm = std::numeric_limits<double>::quiet_NaN();
    double deg = std::numeric_limits<double>::quiet_NaN();
    double rms_px = std::numeric_limits<double>::quiet_NaN();
    bool used = true;
    bool excluded = false;     // by the user; then not used
    bool contradicts = false;  // used, but for a part that was found wrong (the note says which)
    Text note;                 // why it is not used, or what is odd about it; empty when nothing is
};

// Leave-k-out verification: the data are split into folds, each fold is predicted by the solution of the
// others. folds == 0: too few poses to leave any out.
struct HoldOut {
    int folds = 0;
    int left_out = 0;  // poses left out in each fold (at most)
    double rms_mm = std::numeric_limits<double>::quiet_NaN();
    double max_mm = std::numeric_limits<double>::quiet_NaN();
    double rms_deg = std::numeric_limits<double>::quiet_NaN();
    double rms_px = std::numeric_limits<double>::quiet_NaN();
};

struct CalibrationReport {
    std::vector<CalibratedParameter> parameters;
    Eigen::MatrixXd covariance;                // order and units of `parameters`; empty when undetermined
    std::vector<CorrelatedPair> correlations;  // strongest first, |correlation| > 0.8
    std::vector<PoseResidual> poses;           // order of the input
    HoldOut hold_out;
    Judgement judgement;
};

// The pairs of `covariance` (row i belongs to parameters[i]) with |correlation| > limit, strongest first.
// Rows of zero or non-finite variance (fixed parameters) pair with nothing.
std::vector<CorrelatedPair> strong_correlations(const std::vector<CalibratedParameter>& parameters,
                                                const Eigen::MatrixXd& covariance, double limit = 0.8);

// Adds x, y, z (mm) and rx, ry, rz (deg, rotation vector) of a pose, each name after `prefix`.
void add_pose(CalibrationReport& report, const Pose& pose, const std::string& prefix = "");

// The covariance of the parameters as it was solved, in mm and rad: kept in their units, sigmas and correlations with
// it.
void state_covariance(CalibrationReport& report, const Eigen::MatrixXd& solved);

// Ids of those that the method left out, "a, b"; not those that the user excluded.
std::string left_out(const std::vector<PoseResidual>& poses);

// Sets each sigma from the diagonal of report.covariance and fills report.correlations.
void finish_statistics(CalibrationReport& report);

}  // namespace seamwright
