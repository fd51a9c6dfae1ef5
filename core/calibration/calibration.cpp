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

void finish_statistics(CalibrationReport& report) {
    for (size_t i = 0; i < report.parameters.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        report.parameters[i].sigma = std::sqrt(std::max(0.0, report.covariance(k, k)));
    }
    report.correlations = strong_correlations(report.parameters, report.covariance);
}

}  // namespace seamwright
