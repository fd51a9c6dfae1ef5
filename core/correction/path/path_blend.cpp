#include "core/correction/path/path_blend.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

constexpr double kMostBetweenRegions_deg = 90;
constexpr double kRigid = 1e-6;  // what a rotation's entries may be off
// Of a covariance: what its halves may differ by, and what an eigenvalue may be below 0 (of the largest, of 1 at least).
constexpr double kAsymmetry = 1e-9, kNegative = 1e-9;
constexpr double kSamePoint_mm = 1e-9;

double sigma_at(const PathRegion& region, const Eigen::Vector3d& p) {
    Eigen::Matrix<double, 3, 6> j;
    j << Eigen::Matrix3d::Identity(), -skew(region.displacement.workobject_from_movedworkobject.linear() * p);
    const Eigen::Matrix3d c = j * region.covariance * j.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(c, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

Expected<void> check(std::span<const PathPoint> points, std::span<const PathRegion> regions,
                     std::span<const std::string> names, const PathBlendOptions& options) {
    if (points.size() < 2)
        return input_error(Text("a path of {} points is none", points.size()), "path",
                           "give at least two points");
    if (!(std::isfinite(options.blend_mm) && options.blend_mm > 0))
        return input_error(Text("{} mm is no length of a transition", options.blend_mm), "blend_mm",
                           "give a positive length");
    if (names.size() != regions.size()) return input_error("every region needs its name", "regions");
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const Text where("region {}", names[r]);
        const auto rigid =
            pose_from_matrix(regions[r].displacement.workobject_from_movedworkobject.matrix(), where, kRigid);
        if (!rigid) return tl::unexpected(rigid.error());
        const Matrix6& c = regions[r].covariance;
        if (!c.allFinite()) return input_error("the covariance holds a value that is not finite", where);
        const Eigen::VectorXd values = symmetric_eigen(c).values;
        if (!c.isApprox(c.transpose(), kAsymmetry) || values[0] < -kNegative * std::max(1.0, values[5]))
            return input_error("the covariance is not symmetric and positive", where);
    }
    bool any = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Text where("path point {}", i + 1);
        SEAM_OK(pose_from_matrix(points[i].workobject_from_tool.matrix(), where, kRigid));
        if (points[i].region < -1 || points[i].region >= static_cast<int>(regions.size()))
            return input_error("its region is not known", where);
        any = any || points[i].region >= 0;
    }
    if (!any) return input_error("no point belongs to a region", "path", "name the region of the points");
    return {};
}

struct Stretch {
    std::size_t region = 0;
    double from = 0, to = 0;  // path length of its first and last point
};

struct Transition {
    std::size_t a = 0, b = 0;
    double from = 0, to = 0;
    bool meet = false;  // without points between
};

// Path length at every point; the last entry is the whole.
std::vector<double> lengths(std::span<const PathPoint> points, bool closed) {
    std::vector<double> s(points.size() + 1, 0.0);
    for (std::size_t i = 1; i <= points.size(); ++i) {
        const bool wrap = i == points.size();
        s[i] = s[i - 1] + (wrap && !closed ? 0.0
                                           : distance_mm(points[i - 1].workobject_from_tool,
                                                         points[wrap ? 0 : i].workobject_from_tool));
    }
    return s;
}

std::vector<Stretch> stretches_of(std::span<const PathPoint> points, const std::vector<double>& s,
                                  bool closed) {
    std::vector<Stretch> out;
    int last = -1;  // region of the point before
    for (std::size_t i = 0; i < points.size(); ++i) {
        const int region = points[i].region;
        if (region >= 0 && region == last)
            out.back().to = s[i];
        else if (region >= 0)
            out.push_back({static_cast<std::size_t>(region), s[i], s[i]});
        last = region;
    }
    // The first point of a closed path lies in the middle of a stretch as a rule.
    if (closed && out.size() > 1 && points.front().region >= 0 &&
        points.front().region == points.back().region) {
        out.front().from = out.back().from - s.back();
        out.pop_back();
    }
    return out;
}

std::vector<Transition> transitions_of(std::span<const PathPoint> points, const std::vector<double>& s,
                                       const std::vector<Stretch>& stretches,
                                       const PathBlendOptions& options) {
    std::vector<Transition> out;
    const std::size_t count = stretches.size();
    for (std::size_t k = 0; k < (options.closed ? count : count - 1); ++k) {
        const Stretch &a = stretches[k], &b = stretches[(k + 1) % count];
        if (count == 1) break;
        const double turn = k + 1 == count ? s.back() : 0;
        Transition t{a.region, b.region, a.to, b.from + turn, true};
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points[i].region >= 0) continue;
            const double at = s[i] < a.to ? s[i] + turn : s[i];
            if (at >= t.from && at <= t.to) t.meet = false;
        }
        if (t.meet) {
            const double middle = 0.5 * (t.from + t.to);
            t.from = std::max(middle - 0.5 * options.blend_mm, 0.5 * (a.from + a.to));
            t.to = std::min(middle + 0.5 * options.blend_mm, 0.5 * (b.from + b.to) + turn);
        }
        out.push_back(t);
    }
    return out;
}

// Of the direction at point i, over the mean length of its two segments; 0 where a segment has no length.
double curvature(const Eigen::Vector3d& before, const Eigen::Vector3d& at, const Eigen::Vector3d& after) {
    const Eigen::Vector3d u = at - before, v = after - at;
    const double a = u.norm(), b = v.norm();
    if (!(a > kSamePoint_mm && b > kSamePoint_mm)) return 0;
    return 1000 * std::atan2(u.cross(v).norm(), u.dot(v)) / (0.5 * (a + b));
}

PathStep step_between(const Pose& d, const Pose& next, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    if (d.matrix() == next.matrix()) return {};
    const Eigen::Vector3d m = 0.5 * (p + q);
    return {0, (next * m - d * m).norm(), deg_from_rad(angle_rad(d, next))};
}

void place(std::span<const PathRegion> regions, const std::vector<Stretch>& stretches,
           const std::vector<Transition>& transitions, double whole, PathCorrection& point) {
    const double s = point.length_mm;
    for (const Transition& t : transitions)
        for (const double at : {s, s + whole}) {
            if (!(at >= t.from && at <= t.to)) continue;
            point.region = static_cast<int>(t.a);
            point.next = static_cast<int>(t.b);
            // A transition without length: both ends lie on one place, and the point is its stretch's.
            point.share = t.to > t.from ? blend_pace((at - t.from) / (t.to - t.from)) : 0;
            const Pose &a = regions[t.a].displacement.workobject_from_movedworkobject,
                       &b = regions[t.b].displacement.workobject_from_movedworkobject;
            point.displacement.workobject_from_movedworkobject = point.share <= 0   ? a
                                                                 : point.share >= 1 ? b
                                                                 : a.matrix() == b.matrix()
                                                                     ? a
                                                                     : interpolate(a, b, point.share);
            return;
        }
    // Outside of transitions: the stretch that holds it, else the nearest end of an open path.
    std::size_t best = 0;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < stretches.size(); ++k)
        for (const double at : {s, s - whole}) {
            const double off = std::max({stretches[k].from - at, at - stretches[k].to, 0.0});
            if (off < distance) {
                distance = off;
                best = k;
            }
        }
    point.region = point.next = static_cast<int>(stretches[best].region);
    point.displacement = regions[stretches[best].region].displacement;
}

}  // namespace

double blend_pace(double u) {
    if (!(u > 0)) return 0;
    if (u >= 1) return 1;
    return u * u * u * (10 + u * (6 * u - 15));
}

Expected<CorrectedPath> correct_path(std::span<const PathPoint> points, std::span<const PathRegion> regions,
                                     std::span<const std::string> names, const PathBlendOptions& options) {
    SEAM_OK(check(points, regions, names, options));
    const std::vector<double> s = lengths(points, options.closed);
    const std::vector<Stretch> stretches = stretches_of(points, s, options.closed);
    const std::vector<Transition> transitions = transitions_of(points, s, stretches, options);
    for (const Transition& t : transitions) {
        const double turn =
            deg_from_rad(angle_rad(regions[t.a].displacement.workobject_from_movedworkobject,
                                   regions[t.b].displacement.workobject_from_movedworkobject));
        if (turn > kMostBetweenRegions_deg)
            return input_error(Text("regions {} and {} are turned by {:.1f} degrees against each other",
                                    names[t.a], names[t.b], turn),
                               "path");
    }

    CorrectedPath out;
    out.length_mm = s.back();
    const double whole = options.closed ? s.back() : 0;
    std::vector<Eigen::Vector3d> taught, moved;
    for (std::size_t i = 0; i < points.size(); ++i) {
        PathCorrection p;
        p.length_mm = s[i];
        place(regions, stretches, transitions, whole, p);
        const Pose& w = points[i].workobject_from_tool;
        p.workobject_from_tool = p.displacement.workobject_from_movedworkobject * w;
        const double at_region = sigma_at(regions[static_cast<std::size_t>(p.region)], w.translation());
        const double at_next = sigma_at(regions[static_cast<std::size_t>(p.next)], w.translation());
        p.sigma_mm = (1 - p.share) * at_region + p.share * at_next;
        taught.push_back(w.translation());
        moved.push_back(p.workobject_from_tool.translation());
        out.points.push_back(std::move(p));
    }

    const std::size_t n = points.size(), segments = options.closed ? n : n - 1;
    const auto displacement = [&](std::size_t i) -> const Pose& {
        return out.points[i].displacement.workobject_from_movedworkobject;
    };
    int last = static_cast<int>(stretches.front().region);
    if (options.closed) last = static_cast<int>(stretches.back().region);
    std::vector<std::size_t> at_once(n);
    for (std::size_t i = 0; i < n; ++i) {
        if (points[i].region >= 0) last = points[i].region;
        at_once[i] = static_cast<std::size_t>(last);
    }
    for (std::size_t i = 0; i < segments; ++i) {
        const std::size_t k = (i + 1) % n;
        const PathStep step = step_between(displacement(i), displacement(k), taught[i], taught[k]);
        if (step.mm > out.largest_mm.mm) out.largest_mm = {i, step.mm, step.deg};
        if (step.deg > out.largest_deg.deg) out.largest_deg = {i, step.mm, step.deg};
        const auto region = [&](std::size_t j) -> const Pose& {
            return regions[at_once[j]].displacement.workobject_from_movedworkobject;
        };
        out.unblended_mm =
            std::max(out.unblended_mm, step_between(region(i), region(k), taught[i], taught[k]).mm);
    }
    for (std::size_t i = options.closed ? 0 : 1; i + (options.closed ? 0 : 1) < n; ++i) {
        const std::size_t before = (i + n - 1) % n, after = (i + 1) % n;
        const double was = curvature(taught[before], taught[i], taught[after]);
        const double is = curvature(moved[before], moved[i], moved[after]);
        out.curvature_per_m = std::max(out.curvature_per_m, was);
        if (std::abs(is - was) > out.curvature_change_per_m) {
            out.curvature_change_per_m = std::abs(is - was);
            out.curvature_point = i;
        }
    }
    for (const Transition& t : transitions) {
        if (t.a == t.b) continue;
        const bool holds = std::any_of(s.begin(), s.end() - 1, [&](double at) {
            return (at > t.from && at < t.to) || (at + whole > t.from && at + whole < t.to);
        });
        if (!holds)
            out.remarks.push_back(
                Text("between {} and {} the path has no point within the transition of {:.1f} mm: the "
                     "whole step lies in one segment",
                     names[t.a], names[t.b], t.to - t.from));
    }
    return out;
}

}  // namespace seamwright
