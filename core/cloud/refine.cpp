#include "core/cloud/refine.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kGateStands = 1.02;  // of the wanted gate: near enough to be called so
constexpr double kGateFalls = 0.75;   // in a step, at most to
// Steps that move no more than this, and this of the median residual, are calm.
constexpr double kCalm_mm = 1e-4, kCalmShare = 1e-3;

// Where a point looks from, in the part's frame; nothing is asked of a point without a known side.
const Eigen::Vector3d* side_of(const Cloud& cloud, std::size_t i, const Eigen::Matrix3d& part_from_base,
                               bool facing, Eigen::Vector3d& side) {
    if (!facing) return nullptr;
    if (cloud.has_towards())
        side = part_from_base * cloud.towards[i].cast<double>();
    else if (cloud.has_normals())
        side = part_from_base * cloud.normals[i].cast<double>();
    else
        return nullptr;
    return side.squaredNorm() > 0.5 ? &side : nullptr;
}

struct Match {
    Eigen::Vector3d place, normal;
    double residual = 0;
};

FitSystem linearize(const Cloud& cloud, const Surface& surface, const Pose& base_from_part, double gate_mm,
                    bool facing) {
    const Pose part_from_base = base_from_part.inverse();
    std::vector<Match> matches;
    matches.reserve(cloud.size());
    FitSystem s;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        Eigen::Vector3d side;
        const auto near = surface.nearest(part_from_base * cloud.points[i], gate_mm,
                                          side_of(cloud, i, part_from_base.linear(), facing, side));
        if (!near || near->at_border) continue;
        matches.push_back(
            {base_from_part * near->point, base_from_part.linear() * near->normal, near->signed_mm});
        s.middle += matches.back().place;
    }
    s.matched = matches.size();
    if (matches.empty()) return s;
    s.middle /= static_cast<double>(matches.size());
    double spread = 0;
    std::vector<double> sizes;
    sizes.reserve(matches.size());
    for (const Match& m : matches) {
        spread += (m.place - s.middle).squaredNorm();
        sizes.push_back(std::abs(m.residual));
    }
    s.spread_mm = std::max(kLeastSpread_mm, std::sqrt(spread / static_cast<double>(matches.size())));
    s.median_mm = median(sizes);
    for (const Match& m : matches) {
        const double share = m.residual / gate_mm, in = 1 - share * share;
        if (in <= 0) continue;
        Vector6 row;
        row << m.normal, (m.place - s.middle).cross(m.normal) / s.spread_mm;
        const double weight = in * in;
        s.information += weight * row * row.transpose();
        s.gradient += weight * m.residual * row;
        s.weight += weight;
    }
    return s;
}

}  // namespace

Matrix6 tangent_of_motion(const Pose& base_from_part, const Eigen::Vector3d& middle, double spread_mm) {
    Matrix6 m = Matrix6::Identity();
    m.topRightCorner<3, 3>() = -skew(base_from_part.translation() - middle) / spread_mm;
    m.bottomRightCorner<3, 3>() /= spread_mm;
    return m;
}

Refined refine(const Cloud& cloud, const Surface& surface, const Pose& start, const RefineOptions& options) {
    Refined out;
    out.base_from_part = start;
    out.gate_mm = options.gate_mm;
    int calm = 0;
    for (int k = 0; k < options.iterations && calm < 2; ++k) {
        out.system = linearize(cloud, surface, out.base_from_part, out.gate_mm, options.facing);
        if (out.system.matched < 6) return out;
        const SymmetricEigen e = symmetric_eigen(out.system.information / out.system.weight);
        if (!e.converged) return out;
        Vector6 motion = Vector6::Zero();
        for (int d = 0; d < 6; ++d)
            if (e.values[d] > kOpenShare / 3)
                motion += e.vectors.col(d) *
                          (e.vectors.col(d).dot(out.system.gradient) / out.system.weight / e.values[d]);
        const double longest = motion.norm(), most = std::max(out.gate_mm, options.floor_mm);
        if (longest > 2 * most) motion *= 2 * most / longest;
        const Matrix6 to_tangent =
            tangent_of_motion(out.base_from_part, out.system.middle, out.system.spread_mm);
        out.base_from_part = retract(out.base_from_part, to_tangent * motion);
        const double wanted = std::max(options.floor_mm, kGateSigmas * kMadToSigma * out.system.median_mm);
        const bool gate_stands = out.gate_mm <= kGateStands * wanted;
        out.gate_mm = std::max(std::min(out.gate_mm, wanted), kGateFalls * out.gate_mm);
        calm = gate_stands && longest < kCalm_mm + kCalmShare * out.system.median_mm ? calm + 1 : 0;
    }
    out.settled = calm >= 2;
    out.system = linearize(cloud, surface, out.base_from_part, out.gate_mm, options.facing);
    return out;
}

std::vector<double> distances(const Cloud& cloud, const Surface& surface, const Pose& base_from_part,
                              double most_mm, bool facing) {
    const Pose part_from_base = base_from_part.inverse();
    std::vector<double> out(cloud.size(), most_mm);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        Eigen::Vector3d side;
        if (const auto near = surface.nearest(part_from_base * cloud.points[i], most_mm,
                                              side_of(cloud, i, part_from_base.linear(), facing, side)))
            out[i] = near->distance_mm;
    }
    return out;
}

}  // namespace seamwright
