#include "core/cloud/edge/edge_equations.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/median.h"

namespace seamwright::edge_fitting {

Equations equations(const std::vector<Row>& rows, double gate_mm, std::size_t asked) {
    Equations e;
    FitSystem& s = e.system;
    std::vector<double> sizes;
    for (const Row& r : rows) s.middle += r.place / static_cast<double>(rows.size());
    double spread = 0;
    for (const Row& r : rows) spread += (r.place - s.middle).squaredNorm();
    s.spread_mm =
        std::max(kLeastSpread_mm, std::sqrt(spread / std::max<double>(1, static_cast<double>(rows.size()))));
    double sum = static_cast<double>(asked) - static_cast<double>(rows.size()) / 2;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Row& r = rows[k];
        if (k % 2 == 0) {
            sizes.push_back(r.gate_by_mm);
            sum += std::min(1.0, std::pow(r.gate_by_mm / gate_mm, 2));
            e.inside += r.gate_by_mm < gate_mm;
        }
        const double share = r.gate_by_mm / gate_mm, in = 1 - share * share;
        if (in <= 0) continue;
        Vector6 row;
        row << r.direction, (r.place - s.middle).cross(r.direction) / s.spread_mm;
        s.information += in * in * row * row.transpose();
        s.gradient += in * in * r.value_mm * row;
        s.weight += in * in / 2;
    }
    s.matched = rows.size() / 2;
    s.median_mm = sizes.empty() ? 0 : median(sizes);
    e.badness = sum / static_cast<double>(std::max<std::size_t>(1, asked));
    return e;
}

Vector6 step_of(const FitSystem& s, double least) {
    Vector6 motion = Vector6::Zero();
    if (!(s.weight > 0)) return motion;
    const SymmetricEigen e = symmetric_eigen(s.information / s.weight);
    for (int d = 0; d < 6; ++d)
        if (e.values[d] > least)
            motion += e.vectors.col(d) * (e.vectors.col(d).dot(s.gradient) / s.weight / e.values[d]);
    return motion;
}

Pose moved(const Pose& pose, const FitSystem& s, const Vector6& motion) {
    return retract(pose, tangent_of_motion(pose, s.middle, s.spread_mm) * motion);
}

}  // namespace seamwright::edge_fitting
