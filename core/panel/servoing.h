#pragma once
// Iterative panel fitting with a learnt sensitivity matrix (thesis 2.5.1): the industrial baseline beside the
// single step of panel_fit.h.
//
// The gripper is moved by known steps in its own frame, one degree of freedom after the other, and the change
// of the sensor values (gaps and flushes, mm) divided by the step is a column of the sensitivity matrix S.
// Then  step = -gain * pinv(S) * (values - set values)  is repeated until the values stand still or are
// reached. Degrees of freedom are scaled by the training steps, so that mm and rad weigh alike.
//
// Noise model: none; the values are taken as they come, which is why a gain below 1 and a stop rule are
// needed.

#include <Eigen/Core>
#include <functional>
#include <string_view>

#include "core/geometry/pose.h"

namespace seamwright {

// A motion in the gripper's own frame: translation (mm), then rotation vector (rad).
Pose own_motion(const Vector6& step);

// Sensor values with the gripper at `motion` (start_from_gripper: the sum of all motions so far).
using ServoValues = std::function<Eigen::VectorXd(const Pose& motion)>;

struct ServoingOptions {
    double step_mm = 2, step_deg = 0.3;  // of the training, to either side
    double gain = 0.8;
    double condition_limit = 1e3;  // of the scaled matrix
    double stop_mm = 0.05;         // rms of the values' deviation: reached
    double settle_mm = 0.01;       // a step that moves the values less than this on average: settled
    double diverged_at = 10;       // times the first deviation: it grows, and nothing moves on
    int max_moves = 20;
};

struct Sensitivity {
    Eigen::MatrixXd matrix;          // [values x 6], per mm and per rad
    Eigen::MatrixXd pseudo_inverse;  // [6 x values]
    double condition = 0;            // of the scaled matrix; infinity when singular
    bool usable = false;             // condition within the limit
    int moves = 0;                   // that the training took
};
// The pseudo-inverse and what it rests on, of a matrix learnt before; `scale` as the training steps, mm and rad.
Sensitivity inverted(const Eigen::MatrixXd& matrix, const ServoingOptions& options);
Sensitivity learn_sensitivity(const ServoValues& values, const ServoingOptions& options);

enum class ServoingStatus {
    reached,         // rms of the deviation within stop_mm
    settled,         // stands still above it: deformation, or noise
    diverged,        // the deviation grew beyond diverged_at times the first one, or is no number
    not_converged,   // max_moves
    ill_conditioned  // the sensitivity cannot be inverted; nothing was moved
};
std::string_view to_string(ServoingStatus status);
struct ServoingResult {
    ServoingStatus status = ServoingStatus::not_converged;
    Pose motion = Pose::Identity();
    int moves = 0;
    double rms_mm = 0;  // of the last values' deviation
};
// Precondition: `set` has as many values as the sensitivity has rows.
ServoingResult servo(const Sensitivity& sensitivity, const ServoValues& values, const Eigen::VectorXd& set,
                     const ServoingOptions& options);

}  // namespace seamwright
