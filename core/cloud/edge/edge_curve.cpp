#include "core/cloud/edge/edge_curve.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

using Eigen::Vector3d;

constexpr double kNoDirection = 1e-9;  // length of a direction between two that cancel each other
constexpr double kSameSide = 0.6;      // cos of 53 degrees: the wanted side of an edge

EdgeSample between(const EdgeSample& a, const EdgeSample& b, double u) {
    const double h = b.arc_mm - a.arc_mm, u2 = u * u, u3 = u2 * u;
    EdgeSample out;
    out.arc_mm = a.arc_mm + u * h;
    out.point_mm = (2 * u3 - 3 * u2 + 1) * a.point_mm + (u3 - 2 * u2 + u) * h * a.tangent +
                   (3 * u2 - 2 * u3) * b.point_mm + (u3 - u2) * h * b.tangent;
    out.tangent = ((1 - u) * a.tangent + u * b.tangent).normalized();
    Vector3d outward = (1 - u) * a.outward + u * b.outward;
    outward -= outward.dot(out.tangent) * out.tangent;
    out.outward = outward.norm() > kNoDirection ? Vector3d(outward.normalized()) : a.outward;
    out.normal = out.outward.cross(out.tangent);
    if (out.normal.dot(a.normal) < 0) out.normal = -out.normal;
    return out;
}

}  // namespace

EdgeSample at_arc(const EdgeCurve& curve, double arc_mm) {
    const auto& s = curve.samples;
    if (arc_mm <= 0) return s.front();
    if (arc_mm >= curve.length_mm()) return s.back();
    const auto after = std::upper_bound(s.begin(), s.end(), arc_mm,
                                        [](double arc, const EdgeSample& x) { return arc < x.arc_mm; });
    const EdgeSample &a = *(after - 1), &b = *after;
    return between(a, b, (arc_mm - a.arc_mm) / (b.arc_mm - a.arc_mm));
}

EdgeSearch::EdgeSearch(const EdgeCurve& curve, double most_mm) : curve_(curve), most_(most_mm) {
    Eigen::AlignedBox3d box;
    for (const EdgeSample& s : curve.samples) box.extend(s.point_mm);
    corner_ = box.min() - Vector3d::Constant(most_mm);
    cell_ = std::max(most_mm, box.diagonal().norm() / 60);
    counts_ = ((box.sizes() + Vector3d::Constant(2 * most_mm)) / cell_).array().floor().cast<int>() + 1;
    cells_.resize(static_cast<std::size_t>(counts_.prod()));
    double longest = 0;
    for (std::size_t i = 1; i < curve.samples.size(); ++i)
        longest = std::max(longest, curve.samples[i].arc_mm - curve.samples[i - 1].arc_mm);
    const double reach = most_mm + longest;
    for (std::size_t i = 0; i < curve.samples.size(); ++i) {
        const auto clamp = [&](const Vector3d& p) -> Eigen::Vector3i {
            const Eigen::Vector3i k = ((p - corner_) / cell_).array().floor().cast<int>();
            return k.cwiseMax(0).cwiseMin(counts_ - Eigen::Vector3i::Ones());
        };
        const Eigen::Vector3i from = clamp(curve.samples[i].point_mm - Vector3d::Constant(reach)),
                              to = clamp(curve.samples[i].point_mm + Vector3d::Constant(reach));
        for (int x = from.x(); x <= to.x(); ++x)
            for (int y = from.y(); y <= to.y(); ++y)
                for (int z = from.z(); z <= to.z(); ++z)
                    cells_[static_cast<std::size_t>((x * counts_.y() + y) * counts_.z() + z)].push_back(
                        static_cast<int>(i));
    }
}

const std::vector<int>* EdgeSearch::near(const Vector3d& p) const {
    const Eigen::Vector3d c = (p - corner_) / cell_;
    if (!(c.minCoeff() >= 0) || !((c.array() < counts_.cast<double>().array()).all())) return nullptr;
    const Eigen::Vector3i k = c.array().floor().cast<int>();
    return &cells_[static_cast<std::size_t>((k.x() * counts_.y() + k.y()) * counts_.z() + k.z())];
}

std::optional<BesideEdge> EdgeSearch::beside(const Vector3d& p, const Vector3d* wanted) const {
    const auto* list = near(p);
    if (!list) return std::nullopt;
    int best = -1;
    double least = 0;
    for (const int i : *list) {
        const EdgeSample& s = curve_.samples[static_cast<std::size_t>(i)];
        if (wanted && s.outward.dot(*wanted) < kSameSide) continue;
        const double d = (s.point_mm - p).squaredNorm();
        if (best < 0 || d < least) best = i, least = d;
    }
    if (best < 0) return std::nullopt;
    const EdgeSample& nearest = curve_.samples[static_cast<std::size_t>(best)];
    double arc = nearest.arc_mm + (p - nearest.point_mm).dot(nearest.tangent);
    const double length = curve_.length_mm();
    const auto wrapped = [&](double a) {
        return !curve_.closed ? a : a < 0 ? a + length : a > length ? a - length : a;
    };
    for (int k = 0; k < 3; ++k) {
        const EdgeSample foot = at_arc(curve_, wrapped(arc));
        arc += std::clamp((p - foot.point_mm).dot(foot.tangent), -2 * most_, 2 * most_);
    }
    if (!curve_.closed && (arc < 0 || arc > length)) return std::nullopt;
    BesideEdge out;
    out.foot = at_arc(curve_, wrapped(arc));
    const Vector3d off = p - out.foot.point_mm;
    if (off.norm() > most_) return std::nullopt;
    out.outward_mm = off.dot(out.foot.outward);
    out.normal_mm = off.dot(out.foot.normal);
    return out;
}

}  // namespace seamwright
