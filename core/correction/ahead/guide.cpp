#include "core/correction/ahead/guide.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace seamwright {

std::vector<GuidePoint> smoothed_guide(const std::vector<GuidePoint>& points, double half_width_mm,
                                       double step_mm) {
    std::vector<GuidePoint> kept;
    std::vector<double> s;
    for (const GuidePoint& p : points) {
        const double step = kept.empty() ? 0 : (p.point_mm - kept.back().point_mm).norm();
        if (!kept.empty() && step < step_mm / 2) continue;
        s.push_back(kept.empty() ? 0 : s.back() + step);
        kept.push_back(p);
    }
    if (kept.size() < 3) return kept;
    std::vector<GuidePoint> out;
    const auto n = static_cast<int>(std::floor(s.back() / step_mm));
    for (int k = 0; k <= n; ++k) {
        const double at = n > 0 ? s.back() * k / n : 0;
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Matrix<double, 3, 6> right = Eigen::Matrix<double, 3, 6>::Zero();
        int used = 0;
        std::size_t nearest = 0;
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const double d = (s[i] - at) / half_width_mm, a = std::abs(d);
            if (std::abs(s[i] - at) < std::abs(s[nearest] - at)) nearest = i;
            if (!(a < 1)) continue;
            const double weight = std::pow(1 - a * a * a, 3);
            const Eigen::Vector3d basis(1, d, d * d);
            Eigen::Matrix<double, 6, 1> value;
            value << kept[i].point_mm, kept[i].up.normalized();
            normal += weight * basis * basis.transpose();
            right += weight * basis * value.transpose();
            ++used;
        }
        if (used < 3) {
            out.push_back(kept[nearest]);
            continue;
        }
        const Eigen::Matrix<double, 3, 6> fit = normal.ldlt().solve(right);
        out.push_back({fit.row(0).head<3>().transpose(), fit.row(0).tail<3>().transpose()});
    }
    return out;
}

Expected<GuideCurve> GuideCurve::make(const std::vector<GuidePoint>& points) {
    constexpr double kNoDirection = 1e-9;
    constexpr double kUpwardAlong = 0.1;  // sine of 6 degrees
    const Text where = "guide";
    if (points.size() < 2) return input_error("a guide needs two points or more", where);
    GuideCurve g;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const GuidePoint& p = points[i];
        if (!p.point_mm.allFinite() || !p.up.allFinite() || !(p.up.norm() > kNoDirection))
            return input_error(Text("point {} of the guide holds a number that is none", i + 1), where);
        Place place{p.point_mm, Eigen::Vector3d::Zero(), p.up.normalized(), 0};
        if (i > 0) {
            const double step = (p.point_mm - points[i - 1].point_mm).norm();
            if (!(step >= kNearestMm))
                return input_error(Text("points {} and {} of the guide are the same", i, i + 1), where);
            place.s_mm = g.places_.back().s_mm + step;
        }
        g.places_.push_back(place);
    }
    const std::size_t n = points.size();
    const auto chord = [&](std::size_t i) {
        return (points[i + 1].point_mm - points[i].point_mm).normalized().eval();
    };
    for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector3d before = chord(i > 0 ? i - 1 : 0), after = chord(std::min(i, n - 2));
        if (before.dot(after) < std::cos(rad_from_deg(kSharpestDeg)))
            return input_error(
                Text("the guide turns by more than {:.0f} degrees at point {}", kSharpestDeg, i + 1), where,
                "end it at the corner, or give it closer points");
        Place& place = g.places_[i];
        place.along = (before + after).normalized();
        if (place.along.cross(place.up).norm() < kUpwardAlong)
            return input_error(Text("the upward direction of point {} of the guide runs along it", i + 1),
                               where);
    }
    return g;
}

GuideCurve::Within GuideCurve::within(double s_mm) const {
    const double s = std::clamp(s_mm, 0.0, length_mm());
    const auto above = std::upper_bound(places_.begin() + 1, places_.end() - 1, s,
                                        [](double v, const Place& p) { return v < p.s_mm; });
    const auto i = static_cast<std::size_t>(above - places_.begin()) - 1;
    return {i, (s - places_[i].s_mm) / (places_[i + 1].s_mm - places_[i].s_mm)};
}

Eigen::Vector3d GuideCurve::at(double s_mm) const {
    const auto [i, u] = within(s_mm);
    return places_[i].point + u * (places_[i + 1].point - places_[i].point);
}

Eigen::Matrix3d GuideCurve::directions(double s_mm) const {
    const auto [i, u] = within(s_mm);
    const Eigen::Vector3d along = ((1 - u) * places_[i].along + u * places_[i + 1].along).normalized();
    const Eigen::Vector3d up = (1 - u) * places_[i].up + u * places_[i + 1].up;
    Eigen::Matrix3d d;
    d.col(0) = along;
    d.col(1) = along.cross(up).normalized();
    d.col(2) = d.col(1).cross(along);
    return d;
}

GuideCurve::Foot GuideCurve::foot_at(const Eigen::Vector3d& p, double s_mm) const {
    const Eigen::Vector3d off = directions(s_mm).transpose() * (p - at(s_mm));
    return {s_mm, {off.y(), off.z()}, false};
}

GuideCurve::Foot GuideCurve::foot(const Eigen::Vector3d& p, double near_mm, double reach_mm) const {
    constexpr double kLinear = 1e-12;  // of the linear term: the square one is none
    const std::size_t first = within(near_mm - reach_mm).i, last = within(near_mm + reach_mm).i;
    Foot best;
    double least = -1;
    for (std::size_t i = first; i <= last; ++i) {
        const Place &a = places_[i], &b = places_[i + 1];
        if (!(ahead_of(p, i) >= 0 && ahead_of(p, i + 1) <= 0)) continue;
        // (q - d u) . (t + e u) = 0 with one root in 0 .. 1.
        const Eigen::Vector3d q = p - a.point, d = b.point - a.point, e = b.along - a.along;
        const double c0 = q.dot(a.along), c1 = q.dot(e) - d.dot(a.along), c2 = -d.dot(e);
        double u = 0;
        if (std::abs(c2) < kLinear * std::abs(c1)) {
            u = c1 != 0 ? -c0 / c1 : 0;
        } else {
            const double root = std::sqrt(std::max(0.0, c1 * c1 - 4 * c2 * c0));
            const double half = -0.5 * (c1 + (c1 < 0 ? -root : root));
            const double u1 = half / c2, u2 = half != 0 ? c0 / half : u1;
            const auto outside = [](double v) { return std::max({0.0, -v, v - 1}); };
            u = outside(u1) < outside(u2) ? u1 : u2;
        }
        const Foot found = foot_at(p, a.s_mm + std::clamp(u, 0.0, 1.0) * (b.s_mm - a.s_mm));
        if (least >= 0 && found.off_mm.norm() >= least) continue;
        least = found.off_mm.norm();
        best = found;
    }
    if (least >= 0) return best;
    Foot end = foot_at(p, ahead_of(p, first) < 0 ? places_[first].s_mm : places_[last + 1].s_mm);
    end.beyond = true;
    return end;
}

GuideCurve::Foot GuideCurve::foot(const Eigen::Vector3d& p) const {
    return foot(p, 0, length_mm());
}

}  // namespace seamwright
