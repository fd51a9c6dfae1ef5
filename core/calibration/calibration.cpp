#include "core/calibration/calibration.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace seamwright {

std::vector<CorrelatedPair> strong_correlations(const std::vector<CalibratedParameter>& parameters,
                                                const Eigen::MatrixXd& covariance, double limit) {
    std::vector<CorrelatedPair> pairs;
    const auto n = static_cast<Eigen::Index>(parameters.size());
    assert(covariance.rows() == n && covariance.cols() == n);
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = i + 1; j < n; ++j) {
            const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
            const double correlation = covariance(i, j) / scale;
            if (!(scale > 0) || !std::isfinite(correlation) || std::abs(correlation) <= limit) continue;
            pairs.push_back({parameters[static_cast<size_t>(i)].name, parameters[static_cast<size_t>(j)].name,
                             std::clamp(correlation, -1.0, 1.0)});
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const CorrelatedPair& a, const CorrelatedPair& b) {
        return std::abs(a.correlation) > std::abs(b.correlation);
    });
    return pairs;
}

void add_pose(CalibrationReport& report, const Pose& pose, const std::string& prefix) {
    static constexpr const char* names[] = {"x", "y", "z", "rx", "ry", "rz"};
    const Eigen::Vector3d w = rotation_log(pose.linear());
    for (int i = 0; i < 6; ++i)
        report.parameters.push_back({prefix + names[i],
                                     i < 3 ? pose.translation()(i) : deg_from_rad(w(i - 3)),
                                     i < 3 ? "mm" : "deg", 0});
}

void state_covariance(CalibrationReport& report, const Eigen::MatrixXd& solved) {
    Eigen::VectorXd unit = Eigen::VectorXd::Ones(solved.rows());
    for (std::size_t i = 0; i < report.parameters.size(); ++i)
        if (report.parameters[i].unit == "deg") unit(static_cast<Eigen::Index>(i)) = deg_from_rad(1);
    report.covariance = unit.asDiagonal() * solved * unit.asDiagonal();
    finish_statistics(report);
}

std::string left_out(const std::vector<PoseResidual>& poses) {
    std::string ids;
    for (const PoseResidual& p : poses)
        if (!p.used && !p.excluded) ids += (ids.empty() ? "" : ", ") + p.id;
    return ids;
}

void finish_statistics(CalibrationReport& report) {
    for (size_t i = 0; i < report.parameters.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        report.parameters[i].sigma = std::sqrt(std::max(0.0, report.covariance(k, k)));
    }
    report.correlations = strong_correlations(report.parameters, report.covariance);
}

}  // namespace seamwright
