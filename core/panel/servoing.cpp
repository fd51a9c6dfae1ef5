#include "core/panel/servoing.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

double rms(const Eigen::VectorXd& v) {
    return v.size() > 0 ? std::sqrt(v.squaredNorm() / static_cast<double>(v.size())) : 0;
}

Vector6 scale_of(const ServoingOptions& options) {
    Vector6 scale;
    scale << Eigen::Vector3d::Constant(options.step_mm),
        Eigen::Vector3d::Constant(rad_from_deg(options.step_deg));
    return scale;
}

}  // namespace

Pose own_motion(const Vector6& step) {
    return make_pose(rotation_exp(step.tail<3>()), step.head<3>());
}

Sensitivity inverted(const Eigen::MatrixXd& matrix, const ServoingOptions& options) {
    Sensitivity out;
    out.matrix = matrix;
    const Vector6 scale = scale_of(options);
    if (matrix.rows() < 6 || matrix.cols() != 6 || !matrix.allFinite()) {
        out.condition = std::numeric_limits<double>::infinity();
        return out;
    }
    const SingularValues svd = singular_values(out.matrix * scale.asDiagonal());
    const Eigen::VectorXd& s = svd.values;
    out.condition = s.size() == 6 && s[5] > 0 ? s[0] / s[5] : std::numeric_limits<double>::infinity();
    out.usable = out.condition <= options.condition_limit;
    if (out.usable)
        out.pseudo_inverse = scale.asDiagonal() * svd.v * s.cwiseInverse().asDiagonal() * svd.u.transpose();
    return out;
}

Sensitivity learn_sensitivity(const ServoValues& values, const ServoingOptions& options) {
    Eigen::MatrixXd matrix;
    int moves = 0;
    const Vector6 scale = scale_of(options);
    for (int i = 0; i < 6; ++i) {
        const Vector6 step = scale[i] * Vector6::Unit(i);
        const Eigen::VectorXd change = values(own_motion(step)) - values(own_motion(-step));
        matrix.conservativeResize(change.size(), 6);
        matrix.col(i) = change / (2 * scale[i]);
        moves += 2;
    }
    Sensitivity out = inverted(matrix, options);
    out.moves = moves;
    return out;
}

std::string_view to_string(ServoingStatus status) {
    switch (status) {
        case ServoingStatus::reached:
            return "reached";
        case ServoingStatus::settled:
            return "settled";
        case ServoingStatus::diverged:
            return "diverged";
        case ServoingStatus::not_converged:
            return "not_converged";
        case ServoingStatus::ill_conditioned:
            return "ill_conditioned";
    }
    return "";
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
        if (!(out.rms_mm <= options.diverged_at * first)) {
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
