#include "core/features/gap/gap_scan.h"
#include "core/median.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

namespace seamwright {
namespace {

constexpr double kPlaceWindows = 6;      // to either side, for the line that the gap's place follows
constexpr std::size_t kMostAbout = 128;  // points that a local line takes: a robot that stands still gives
                                         // thousands at one place

constexpr double kRigid = 1e-6;  // what a rotation's entries may be off
constexpr double kSamePath_mm = 1e-6;
// Sum of squares along the path: middles that hardly travel tell no direction.
constexpr double kLeastTravel_mm2 = 1e-2;

ParameterValues values_of(const GapScanOptions& o) {
    return {{"nozzle_mm", o.nozzle_mm},
            {"clearance_mm", o.clearance_mm},
            {"window_mm", o.window_mm},
            {"hole_mm", o.hole_mm},
            {"aside_mm", o.aside_mm},
            {"surface_mm", o.gauge.surface_mm},
            {"edge_skip_mm", o.gauge.edge_skip_mm},
            {"x_min_mm", o.gauge.window.x_min},
            {"x_max_mm", o.gauge.window.x_max}};
}

Expected<void> check(std::span<const GapSection> sections, const GapScanOptions& o) {
    if (sections.empty()) return input_error("there are no profiles", "gap");
    SEAM_OK(validate(values_of(o), gap_scan_parameters(), "gap"));
    SEAM_OK(check(o.gauge));
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const Text where("profile {}", i + 1);
        SEAM_OK(pose_from_matrix(sections[i].frame_from_sensor.matrix(), where, kRigid));
        if (sections[i].profile.size() > 0 && !sections[i].profile.filtered())
            return input_error("it was not filtered", where);
    }
    return {};
}

// The measured points of a scan, by path.
class Along {
  public:
    struct Measured {
        GapPoint* point;
        double x_mm;  // of the gap's middle, sensor frame
        Eigen::Vector3d direction = Eigen::Vector3d::UnitY();
    };
    std::vector<Measured> all;

    // Within `reach` of path about s: at most kMostAbout, evenly, and at least the neighbours on both sides.
    std::vector<const Measured*> about(double s, double reach) const {
        auto first = std::partition_point(all.begin(), all.end(),
                                          [&](const Measured& m) { return m.point->path_mm < s - reach; });
        auto last = std::partition_point(first, all.end(),
                                         [&](const Measured& m) { return m.point->path_mm <= s + reach; });
        while (last - first < 3 && (first != all.begin() || last != all.end())) {
            if (first != all.begin()) --first;
            if (last != all.end()) ++last;
        }
        std::vector<const Measured*> out;
        const auto n = static_cast<std::size_t>(last - first);
        const std::size_t stride = std::max<std::size_t>(1, n / kMostAbout);
        for (std::size_t k = 0; k < n; k += stride) out.push_back(&*(first + static_cast<std::ptrdiff_t>(k)));
        return out;
    }

    // Where in the profile the gap should be; nothing when too few were measured about there.
    std::optional<double> place(double s, double reach) const {
        const auto near = about(s, reach);
        if (near.size() < 5) return std::nullopt;
        std::vector<double> values;
        const std::size_t half = near.size() / 2;
        for (std::size_t k = 0; k + half < near.size(); ++k) {
            const double ds = near[k + half]->point->path_mm - near[k]->point->path_mm;
            if (ds > kSamePath_mm) values.push_back((near[k + half]->x_mm - near[k]->x_mm) / ds);
        }
        const double slope = values.empty() ? 0 : median(values);
        values.clear();
        for (const Measured* m : near) values.push_back(m->x_mm - slope * (m->point->path_mm - s));
        return median(values);
    }
};

// Scatter of the widths about their straight line; 0 when they are too few to tell.
double scatter_of(const std::vector<const Along::Measured*>& about) {
    if (about.size() < 5) return 0;
    const double n = static_cast<double>(about.size());
    double mean_s = 0, mean = 0;
    for (const auto* m : about) {
        mean_s += m->point->path_mm / n;
        mean += m->point->width_mm / n;
    }
    double ss = 0, sw = 0;
    for (const auto* m : about) {
        ss += (m->point->path_mm - mean_s) * (m->point->path_mm - mean_s);
        sw += (m->point->path_mm - mean_s) * (m->point->width_mm - mean);
    }
    const double slope = ss > 0 ? sw / ss : 0;
    double squares = 0;
    for (const auto* m : about) {
        const double off = m->point->width_mm - mean - slope * (m->point->path_mm - mean_s);
        squares += off * off;
    }
    return std::sqrt(squares / (n - 2));
}

// Unit direction of the middles, in the sense of travel; `fallback` where they are too few.
Eigen::Vector3d direction_of(const std::vector<const Along::Measured*>& about,
                             const Eigen::Vector3d& fallback) {
    if (about.size() < 3) return fallback;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto* m : about) mean += m->point->middle_mm / static_cast<double>(about.size());
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    for (const auto* m : about) c += (m->point->middle_mm - mean) * (m->point->middle_mm - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(c);
    if (!(solver.eigenvalues()[2] > 4 * solver.eigenvalues()[1]) ||
        solver.eigenvalues()[2] < kLeastTravel_mm2)
        return fallback;
    const Eigen::Vector3d t = solver.eigenvectors().col(2);
    return t.dot(about.back()->point->middle_mm - about.front()->point->middle_mm) < 0 ? Eigen::Vector3d(-t)
                                                                                       : t;
}

// The contour is seen on both sides of x, farther than half of what the nozzle needs.
bool seen_around(const Profile& profile, double x, double need) {
    bool left = false, right = false;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (profile.segment[i] == kOutlier) continue;
        left = left || profile.x_mm[i] < x - need / 2;
        right = right || profile.x_mm[i] > x + need / 2;
    }
    return left && right;
}

GapPoint point_of(const GapFlush& f, const Pose& pose) {
    GapPoint p;
    p.middle_mm = pose.translation();
    p.message = f.message;
    if (f.status != GapFlushStatus::ok) return p;
    p.verdict = GapVerdict::doubtful;  // judged when its neighbours are known
    p.cut_mm = p.width_mm = f.gap_mm;
    p.flush_mm = f.flush_mm;
    p.sigma_mm = std::sqrt(std::max(0.0, f.covariance(0, 0)));
    p.tilt_deg = deg_from_rad(std::atan(f.along.y() / f.along.x()));
    p.across = pose.linear() * Eigen::Vector3d(f.along.x(), 0, f.along.y());
    const Eigen::Vector2d middle = 0.5 * (f.reference_edge_mm + f.other_edge_mm);
    p.middle_mm = pose * Eigen::Vector3d(middle.x(), 0, middle.y());
    return p;
}

// Stretches that do not pass: runs of one verdict, over holes that are let pass; and holes that are not.
std::vector<GapStretch> stretches_of(const GapScan& scan, const GapScanOptions& options) {
    std::vector<GapStretch> out;
    bool open = false;        // the last one may go on
    double judged_until = 0;  // path
    std::size_t first_without = 0;
    const auto hole = [&](std::size_t next, double until) {
        if (until - judged_until <= options.hole_mm) return;
        GapStretch s;
        s.verdict = GapVerdict::not_measured;
        s.from_mm = s.at_mm = judged_until;
        s.to_mm = until;
        s.sections = next - first_without;
        const GapPoint& where = scan.points[std::min(first_without, scan.points.size() - 1)];
        s.place_mm = where.middle_mm;
        s.message = s.sections > 0 ? where.message : "no profile was taken there";
        out.push_back(std::move(s));
        open = false;
    };
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const GapPoint& p = scan.points[i];
        if (p.verdict == GapVerdict::not_measured) continue;
        hole(i, p.path_mm);
        judged_until = p.path_mm;
        first_without = i + 1;
        if (p.verdict == GapVerdict::passes) {
            open = false;
            continue;
        }
        const bool closed = p.verdict == GapVerdict::closed;
        const bool goes_on =
            open && (out.back().verdict == GapVerdict::doubtful) == (p.verdict == GapVerdict::doubtful);
        if (!goes_on) {
            GapStretch& s = out.emplace_back();
            s.verdict = p.verdict;
            s.from_mm = p.path_mm;
        }
        GapStretch& s = out.back();
        s.to_mm = p.path_mm;
        const bool worse = closed ? s.verdict != GapVerdict::closed
                                  : s.verdict != GapVerdict::closed && p.width_mm < s.narrowest_mm;
        if (s.sections++ == 0 || worse) {
            s.verdict = p.verdict;
            s.narrowest_mm = p.width_mm;
            s.sigma_mm = p.sigma_mm;
            s.at_mm = p.path_mm;
            s.place_mm = p.middle_mm;
            s.message = p.message;
        }
        open = true;
    }
    hole(scan.points.size(), scan.length_mm);
    return out;
}

}  // namespace

std::string_view to_string(GapVerdict verdict) {
    switch (verdict) {
        case GapVerdict::passes:
            return "passes";
        case GapVerdict::doubtful:
            return "doubtful";
        case GapVerdict::too_narrow:
            return "too_narrow";
        case GapVerdict::closed:
            return "closed";
        case GapVerdict::not_measured:
            return "not_measured";
    }
    return "not_measured";
}

const std::vector<ParameterInfo>& gap_scan_parameters() {
    static const std::vector<ParameterInfo> infos = [] {
        const GapScanOptions o;
        return std::vector<ParameterInfo>{
            {"nozzle_mm", "mm", 0.1, 100, o.nozzle_mm, 2, "Width of the nozzle."},
            {"clearance_mm", "mm", 0, 50, o.clearance_mm, 2, "What must be left on either side of it."},
            {"window_mm", "mm", 0.5, 500, o.window_mm, 1,
             "Half length of path over which the gap's direction and scatter are taken."},
            {"hole_mm", "mm", 0.1, 1000, o.hole_mm, 1, "Path without a measure that is still let pass."},
            {"aside_mm", "mm", 0.2, 100, o.aside_mm, 1,
             "How far beside its course a gap may be found and still be the gap."},
            {"surface_mm", "mm", 0.1, 1000, o.gauge.surface_mm, 2,
             "Length of surface beside each edge that a line takes."},
            {"edge_skip_mm", "mm", 0, 100, o.gauge.edge_skip_mm, 2,
             "Left out of the line beside the edge: the fold's radius."},
            {"x_min_mm", "mm", -1e5, 1e5, o.gauge.window.x_min, 2,
             "Left limit of the profile in which the gap lies."},
            {"x_max_mm", "mm", -1e5, 1e5, o.gauge.window.x_max, 2, "Its right limit."}};
    }();
    return infos;
}

Expected<GapScanOptions> with_values(GapScanOptions options, const ParameterValues& values) {
    SEAM_OK(validate(values, gap_scan_parameters(), "gap"));
    ParameterValues all = values_of(options);
    for (const auto& [name, value] : values) all[name] = value;
    options.nozzle_mm = all["nozzle_mm"];
    options.clearance_mm = all["clearance_mm"];
    options.window_mm = all["window_mm"];
    options.hole_mm = all["hole_mm"];
    options.aside_mm = all["aside_mm"];
    options.gauge.surface_mm = all["surface_mm"];
    options.gauge.edge_skip_mm = all["edge_skip_mm"];
    options.gauge.window.x_min = all["x_min_mm"];
    options.gauge.window.x_max = all["x_max_mm"];
    SEAM_OK(check(options.gauge));
    return options;
}

Expected<GapScan> scan_gap(std::span<const GapSection> sections, const GapScanOptions& options) {
    SEAM_OK(check(sections, options));
    GapScan scan;
    GapFlushGauge gauge(options.gauge);
    Along measured;
    std::vector<bool> unbroken(sections.size(), false);
    scan.points.reserve(sections.size());
    for (std::size_t i = 0; i < sections.size(); ++i) {
        const Pose& pose = sections[i].frame_from_sensor;
        if (i > 0) scan.length_mm += distance_mm(sections[i - 1].frame_from_sensor, pose);
        const GapFlush f = gauge.measure(sections[i].profile);
        GapPoint& p = scan.points.emplace_back(point_of(f, pose));
        p.section = i;
        p.path_mm = scan.length_mm;
        unbroken[i] = f.status == GapFlushStatus::not_found;
        if (f.status == GapFlushStatus::ok)
            measured.all.push_back({&p, (f.reference_edge_mm.x() + f.other_edge_mm.x()) / 2});
    }

    // What lies beside the gap's course is not the gap; where the contour runs on over it there is none.
    const double reach = kPlaceWindows * options.window_mm;
    std::vector<double> aside;
    for (const auto& m : measured.all)
        aside.push_back(m.x_mm - measured.place(m.point->path_mm, reach).value_or(m.x_mm));
    std::size_t kept = 0;
    for (std::size_t k = 0; k < measured.all.size(); ++k) {
        GapPoint& p = *measured.all[k].point;
        if (std::abs(aside[k]) <= options.aside_mm) {
            measured.all[kept++] = measured.all[k];
            continue;
        }
        p.verdict = GapVerdict::not_measured;
        p.message = Text("what was found lies {:.1f} mm beside the gap's course", std::abs(aside[k]));
    }
    measured.all.resize(kept);
    scan.measured = kept;
    for (GapPoint& p : scan.points) {
        if (!unbroken[p.section]) continue;
        const auto place = measured.place(p.path_mm, reach);
        if (place && seen_around(sections[p.section].profile, *place, options.need_mm())) {
            p.verdict = GapVerdict::closed;
            p.message = "the contour runs on without a gap";
            p.middle_mm = sections[p.section].frame_from_sensor * Eigen::Vector3d(*place, 0, 0);
        }
    }

    for (auto& m : measured.all) {
        const Pose& pose = sections[m.point->section].frame_from_sensor;
        m.direction = direction_of(measured.about(m.point->path_mm, options.window_mm), pose.linear().col(1));
    }
    for (const auto& m : measured.all) {
        GapPoint& p = *m.point;
        p.along = m.direction;
        const double slant = p.across.dot(p.along);
        p.width_mm = p.cut_mm * std::sqrt(std::max(0.0, 1 - slant * slant));
        p.across = (p.across - slant * p.along).normalized();
        const Eigen::Vector3d in_sensor =
            sections[p.section].frame_from_sensor.linear().transpose() * p.along;
        // The sense of travel does not count.
        p.yaw_deg = deg_from_rad(
            std::atan2(in_sensor.y() < 0 ? -in_sensor.x() : in_sensor.x(), std::abs(in_sensor.y())));
        scan.largest_yaw_deg = std::max(scan.largest_yaw_deg, std::abs(p.yaw_deg));
    }
    std::vector<double> scatter;
    for (const auto& m : measured.all)
        scatter.push_back(scatter_of(measured.about(m.point->path_mm, options.window_mm)));
    for (std::size_t k = 0; k < kept; ++k) {
        GapPoint& p = *measured.all[k].point;
        p.sigma_mm = std::max(p.sigma_mm, scatter[k]);
        p.verdict = p.width_mm < options.need_mm()                    ? GapVerdict::too_narrow
                    : p.width_mm - 3 * p.sigma_mm < options.need_mm() ? GapVerdict::doubtful
                                                                      : GapVerdict::passes;
        scan.narrowest_mm = k == 0 ? p.width_mm : std::min(scan.narrowest_mm, p.width_mm);
        scan.widest_mm = k == 0 ? p.width_mm : std::max(scan.widest_mm, p.width_mm);
    }
    scan.stretches = stretches_of(scan, options);
    return scan;
}

}  // namespace seamwright
