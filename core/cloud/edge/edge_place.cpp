#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <random>

#include "core/cloud/edge/edge_fitter.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright::edge_fitting {

using Eigen::Vector3d;

namespace {

constexpr double kSameFacing = 0.85;  // cos of 32 degrees: an end's sheet and the edge's
constexpr double kWellKnown = 0.02;   // mean squared row of a direction that rough ends may move
// Of the radius that surrounds a point: a step that counts as none while the gate is wider, and at the end.
constexpr double kCalmWide = 0.1, kCalm = 1e-3;
constexpr double kGateNarrows = 0.8;  // from one gate to the next
// Starts beside the given one: so many to either side, and out of the sheet farther apart by this.
constexpr double kMostBeside = 10, kUpSteps = 1.5;
// In which an end is looked for: into the sheet; beyond the drawing's edge, in radii.
constexpr double kLeastWindow_mm = 3, kMostWindow_mm = 15;
constexpr double kBeyondRadii = 1.5, kLeastBeyond_mm = 3, kMostBeyond_mm = 40;
constexpr double kLeastGate_mm = 0.02;
// Steps that are the last: with the same ends, and with new ones.
constexpr double kStep_mm = 1e-4, kSettled_mm = 0.02;
constexpr double kShowsMost = 0.75;  // of the most ends that a place shows: it is one of those that show most

}  // namespace

std::vector<Row> EdgeFitter::rough_rows(const std::vector<SheetEnd>& ends,
                                        const std::vector<EdgeSearch>& searches, const Pose& pose) const {
    std::vector<Row> rows;
    const Pose back = pose.inverse();
    for (const SheetEnd& end : ends) {
        const Vector3d p = back * end.place_mm, wanted = back.linear() * end.outward,
                       normal = back.linear() * end.normal;
        std::optional<BesideEdge> best;
        double least = 0;
        for (const EdgeSearch& search : searches) {
            const auto near = search.beside(p, &wanted);
            if (!near || std::abs(near->foot.normal.dot(normal)) < kSameFacing) continue;
            const double d = std::hypot(near->outward_mm, near->normal_mm);
            if (!best || d < least) best = near, least = d;
        }
        if (!best) continue;
        rows.push_back(
            {pose * best->foot.point_mm, pose.linear() * best->foot.outward, best->outward_mm, least});
        rows.push_back(
            {pose * best->foot.point_mm, pose.linear() * best->foot.normal, best->normal_mm, least});
    }
    return rows;
}

EdgeFitter::Rough EdgeFitter::settle(const std::vector<SheetEnd>& ends,
                                     const std::vector<EdgeSearch>& searches, Pose pose,
                                     double capture) const {
    double gate = capture;
    Rough r;
    for (int k = 0; k < 80; ++k) {
        r.end = equations(rough_rows(ends, searches, pose), gate, ends.size());
        if (r.end.system.matched < 6) break;
        // Where ends of others count too, in well known directions alone: the others are left to the exact ends.
        Vector6 motion = step_of(r.end.system, kWellKnown);
        if (const double longest = motion.norm(); longest > gate) motion *= gate / longest;
        pose = moved(pose, r.end.system, motion);
        const bool calm = motion.norm() < (gate > radius_ ? kCalmWide : kCalm) * radius_;
        if (gate <= radius_ && calm) break;
        if (calm || k >= 20) gate = std::max(radius_, kGateNarrows * gate);
    }
    r.pose = pose;
    r.end = equations(rough_rows(ends, searches, pose), radius_, ends.size());
    return r;
}

bool EdgeFitter::place_roughly(const SheetEnds& found) {
    // Drawn, not every n-th: along a profile its two ends take turns.
    std::vector<SheetEnd> ends;
    std::mt19937_64 random(options_.seed);
    std::sample(found.ends.begin(), found.ends.end(), std::back_inserter(ends), 400, random);
    const double capture = std::max(4 * radius_, options_.start_mm), near = std::min(capture, 4 * radius_);
    std::vector<EdgeSearch> wide, narrow;
    for (const EdgeCurve& edge : edges_) wide.emplace_back(edge, capture), narrow.emplace_back(edge, near);
    const auto look = [&](const Pose& start, double gate) {
        const Rough r = settle(ends, gate > near ? wide : narrow, start, gate);
        if (r.end.inside >= kLeastEnds && fitting::within_start(r.pose, surface_, options_))
            rough_.push_back(r);
    };
    look(*options_.start, capture);
    // Ends of something else beside the edge draw a wide gate between the two: narrow ones from side to side.
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const EdgeCurve& edge : edges_)
        for (const EdgeSample& s : edge.samples) spread += s.outward * s.outward.transpose();
    const Eigen::Matrix3d axes = options_.start->linear() * symmetric_eigen(spread).vectors;
    Vector3d normals = Vector3d::Zero();
    for (const EdgeCurve& edge : edges_)
        for (const EdgeSample& s : edge.samples) normals += s.normal;
    const Vector3d out = axes.col(2), up = (options_.start->linear() * normals).normalized();
    const int steps = static_cast<int>(std::min(kMostBeside, std::ceil(options_.start_mm / (2 * radius_))));
    for (int k = -steps; k <= steps; ++k) {
        if (stopped()) return refuse(FitStatus::cancelled, "cancelled");
        for (const int j : {0, -1, 1}) {
            Pose start = *options_.start;
            start.translation() += 2 * radius_ * (k * out + kUpSteps * j * up);
            look(start, near);
        }
    }
    for (const Pose& start : fitting::rival_starts(surface_, *options_.start, options_)) {
        if (stopped()) return refuse(FitStatus::cancelled, "cancelled");
        look(start, near);
    }
    if (rough_.empty())
        return refuse(FitStatus::no_fit, "from its start no sheet's end of the scan lies on the edge");
    std::stable_sort(rough_.begin(), rough_.end(),
                     [](const Rough& a, const Rough& b) { return a.end.badness < b.end.badness; });
    out_.fit.base_from_part = rough_.front().pose;
    return true;
}

std::vector<CellEnd> EdgeFitter::ends_at(const Pose& pose, double window) const {
    double length = 0;
    std::map<int, double> lengths;
    for (const EdgeCurve& e : edges_) lengths[e.edge] = e.length_mm();
    for (const auto& [edge, l] : lengths) length += l;
    CellOptions o;
    o.window_mm = std::clamp(3 * radius_, kLeastWindow_mm, kMostWindow_mm);
    o.beyond_mm = window;
    o.cell_mm = std::max(radius_ / 2, length / static_cast<double>(kMostCells));
    o.noise_mm = noise_;
    std::map<int, std::vector<CellEnd>> best;
    for (std::size_t i = 0; i < edges_.size(); ++i) {
        auto ends = cell_ends(cloud_, edges_[i], static_cast<int>(i), pose, o);
        auto& kept = best[edges_[i].edge];
        if (ends.size() > kept.size()) kept = std::move(ends);
    }
    std::vector<CellEnd> all;
    for (const auto& [edge, ends] : best) all.insert(all.end(), ends.begin(), ends.end());
    return all;
}

std::vector<Row> EdgeFitter::rows_of(const std::vector<CellEnd>& ends, const Pose& pose) {
    std::vector<Row> rows;
    for (const CellEnd& e : ends) {
        const double d = std::hypot(e.outward_mm, e.normal_mm);
        const Vector3d at = pose * e.foot.point_mm;
        rows.push_back({at, pose.linear() * e.foot.outward, e.outward_mm, d});
        rows.push_back({at, pose.linear() * e.foot.normal, e.normal_mm, d});
    }
    return rows;
}

EdgeFitter::Exact EdgeFitter::exact(const Pose& rough) const {
    Exact x;
    x.pose = rough;
    double window = std::clamp(kBeyondRadii * radius_, kLeastBeyond_mm, kMostBeyond_mm);
    for (int round = 0; round < 8; ++round) {
        x.ends = ends_at(x.pose, window);
        if (x.ends.size() < kLeastEnds || stopped()) return x;
        double gate = window, moved_mm = 0;
        for (int k = 0; k < 25; ++k) {
            x.system = equations(rows_of(x.ends, x.pose), gate, x.ends.size()).system;
            const Vector6 motion = step_of(x.system);
            moved_mm = std::max(moved_mm, motion.norm());
            gate = std::clamp(kGateSigmas * kMadToSigma * x.system.median_mm, kLeastGate_mm, gate);
            const Pose to = moved(x.pose, x.system, motion);
            shift_ends(x.ends, x.pose, to);
            x.pose = to;
            if (motion.norm() < kStep_mm) break;
        }
        x.gate_mm = gate;
        if (round > 0 && moved_mm < kSettled_mm) break;
    }
    x.ends = ends_at(x.pose, window);
    x.system = equations(rows_of(x.ends, x.pose), x.gate_mm, x.ends.size()).system;
    return x;
}

double EdgeFitter::across_mm(const Pose& a, const Pose& b) const {
    double most = 0;
    for (const EdgeCurve& edge : edges_)
        for (std::size_t i = 0; i < edge.samples.size();
             i += std::max<std::size_t>(1, edge.samples.size() / 20)) {
            const EdgeSample& s = edge.samples[i];
            const Vector3d off = a * s.point_mm - b * s.point_mm, along = a.linear() * s.tangent;
            most = std::max(most, (off - off.dot(along) * along).norm());
        }
    return most;
}

bool EdgeFitter::place_exactly() {
    Exact best;
    std::size_t most = 0;
    std::vector<Pose> tried;
    for (const Rough& r : rough_) {
        if (stopped()) return refuse(FitStatus::cancelled, "cancelled");
        const auto same = [&](const Pose& pose) { return across_mm(pose, r.pose) < radius_; };
        if (exact_.size() == 8 || std::any_of(tried.begin(), tried.end(), same)) continue;
        tried.push_back(r.pose);
        exact_.push_back(exact(r.pose));
    }
    // Where the most ends lie on the edge as narrowly as in the narrowest of the places that show most of them.
    double gate = 0;
    std::size_t shown = 0;
    for (const Exact& x : exact_) shown = std::max(shown, x.inside(x.gate_mm));
    for (const Exact& x : exact_)
        if (x.ends.size() >= kLeastEnds && x.inside(x.gate_mm) >= kShowsMost * static_cast<double>(shown) &&
            (gate <= 0 || x.gate_mm < gate))
            gate = x.gate_mm;
    for (const Exact& x : exact_)
        if (const std::size_t n = x.inside(gate > 0 ? gate : x.gate_mm); n > most) most = n, best = x;
    if (best.ends.size() < kLeastEnds)
        return refuse(
            FitStatus::no_fit,
            Text("the scan shows where the sheet ends in {} places of the edge, too few", best.ends.size()));
    ends_ = best.ends;
    system_ = best.system;
    out_.fit.gate_mm = best.gate_mm;
    const Pose& pose = out_.fit.base_from_part = best.pose;
    for (const CellEnd& e : ends_)
        counts_.push_back(std::hypot(e.outward_mm, e.normal_mm) < out_.fit.gate_mm);
    SurfaceFit& fit = out_.fit;
    fit.points = ends_.size();
    fit.points_used = static_cast<std::size_t>(std::count(counts_.begin(), counts_.end(), true));
    fit.share_on_part =
        static_cast<double>(fit.points_used) / static_cast<double>(std::max<std::size_t>(1, fit.points));
    if (!fitting::within_start(pose, surface_, options_))
        return refuse(FitStatus::no_fit, Text("the fit left its start by more than {:g} mm or {:g} degrees",
                                              options_.start_mm, options_.start_deg));
    const double limit =
        options_.form_limit_mm > 0 ? options_.form_limit_mm : fitting::kFormLimit * surface_.size_mm();
    if (!(system_.median_mm <= limit))
        return refuse(FitStatus::no_fit, Text("half of the sheet's ends lie more than {:.2f} mm off the edge",
                                              system_.median_mm));
    if (fit.points_used < kLeastEnds || fit.share_on_part < options_.share_needed)
        return refuse(FitStatus::no_fit,
                      Text("only {:.0f} % of the sheet's ends lie on the edge", 100 * fit.share_on_part));
    return true;
}

void EdgeFitter::shift_ends(std::vector<CellEnd>& ends, const Pose& from, const Pose& to) {
    const Pose change = to.inverse() * from;
    for (CellEnd& e : ends) {
        const Vector3d p =
            change * Vector3d(e.foot.point_mm + e.outward_mm * e.foot.outward + e.normal_mm * e.foot.normal) -
            e.foot.point_mm;
        e.outward_mm = p.dot(e.foot.outward);
        e.normal_mm = p.dot(e.foot.normal);
    }
}

}  // namespace seamwright::edge_fitting
