#include "core/panel/servoing.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

// A motion in the gripper's own frame: translation, then rotation vector.
Pose own_motion(const Vector6& step) {
    return make_pose(rotation_exp(step.tail<3>()), step.head<3>());
}

double rms(const Eigen::VectorXd& v) {
    return v.size() > 0 ? std::sqrt(v.squaredNorm() / static_cast<double>(v.size())) : 0;
}

}  // namespace

Sensitivity learn_sensitivity(const ServoValues& values, const ServoingOptions& options) {
    Sensitivity out;
    Vector6 scale;
    scale << Eigen::Vector3d::Constant(options.step_mm),
        Eigen::Vector3d::Constant(rad_from_deg(options.step_deg));
    for (int i = 0; i < 6; ++i) {
        const Vector6 step = scale[i] * Vector6::Unit(i);
        const Eigen::VectorXd change = values(own_motion(step)) - values(own_motion(-step));
        out.matrix.conservativeResize(change.size(), 6);
        out.matrix.col(i) = change / (2 * scale[i]);
        out.moves += 2;
    }
    const SingularValues svd = singular_values(out.matrix * scale.asDiagonal());
    const Eigen::VectorXd& s = svd.values;
    out.condition = s.size() == 6 && s[5] > 0 ? s[0] / s[5] : std::numeric_limits<double>::infinity();
    out.usable = out.condition <= options.condition_limit;
    if (out.usable)
        out.pseudo_inverse = scale.asDiagonal() * svd.v * s.cwiseInverse().asDiagonal() * svd.u.transpose();
    return out;
}

ServoingResult servo(const Sensitivity& sensitivity, const ServoValues& values, const Eigen::VectorXd& set,
                     const ServoingOptions& options) {
    assert(sensitivity.matrix.rows() == set.size());
    ServoingResult out;
    if (!sensitivity.usable) {
        out.status = ServoingStatus::ill_conditioned;
        return out;
    }
    double first = -1;
    for (;;) {
        const Eigen::VectorXd off = values(out.motion) - set;
        out.rms_mm = rms(off);
        if (first < 0) first = out.rms_mm;
        if (out.rms_mm <= options.stop_mm) {
            out.status = ServoingStatus::reached;
            return out;
        }
        if (!(out.rms_mm <= 10 * first)) {
            out.status = ServoingStatus::diverged;
            return out;
        }
        const Vector6 step = -options.gain * sensitivity.pseudo_inverse * off;
        if (rms(sensitivity.matrix * step) < options.settle_mm) {
            out.status = ServoingStatus::settled;
            return out;
        }
        if (out.moves >= options.max_moves) return out;
        out.motion = out.motion * own_motion(step);
        ++out.moves;
    }
}

}  // namespace seamwright
