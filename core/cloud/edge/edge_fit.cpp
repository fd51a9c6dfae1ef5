#include "core/cloud/edge/edge_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "core/cloud/coarse.h"
#include "core/cloud/edge/cell_ends.h"
#include "core/cloud/edge/sheet_ends.h"
#include "core/cloud/fit_steps.h"
#include "core/correction/region_system.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLeastEnds = 12;
// Of the edges' length. With 40 % of one seen and a form of 0.1 mm, 28 of 39 truths alone were within the stated 95 %.
constexpr double kLeastSeen = 0.5;
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
constexpr double kAsMany = 0.85;     // of the best's ends: a rival with fewer is told apart
constexpr double kLeastLength_mm = 1e-9, kLeastNoise_mm2 = 1e-8;
constexpr std::size_t kMostCells = 110;  // two nodes each: form_model.h is cubic in them

// One residual: the place moves against `direction`.
struct Row {
    Vector3d place, direction;  // base
    double value_mm = 0, gate_by_mm = 0;
};

struct Equations {
    FitSystem system;
    std::size_t inside = 0;
    double badness = 1;  // mean squared distance over the gate's, at most 1 each
};

// fit.h's system of rows in pairs (outward, normal): both count by the distance of the pair.
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

// The step that lowers the residuals; directions that the ends leave open are not moved.
Vector6 step_of(const FitSystem& s, double least = kOpenShare / 3) {
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

class EdgeFitter {
  public:
    EdgeFitter(const Cloud& cloud, std::span<const EdgeCurve> edges, const Surface& surface,
               const FitOptions& options)
        : cloud_(cloud), edges_(edges), surface_(surface), options_(options) {}

    Expected<EdgeFit> run() {
        if (!options_.pairs_part.empty()) {
            SEAM_TRY(const auto pose, pose_of_pairs(options_.pairs_part, options_.pairs_base));
            options_.start = pose;
        }
        out_.fit.from_start = true;
        const SheetEnds found = sheet_ends(cloud_, options_.cancelled);
        if (stopped()) {
            refuse(FitStatus::cancelled, "cancelled");
            return out_;
        }
        radius_ = out_.radius_mm = found.radius_mm;
        noise_ = options_.noise_mm > 0 ? options_.noise_mm : found.noise_mm;
        if (found.ends.size() < kLeastEnds) {
            refuse(FitStatus::no_fit, "no sheet ends in the scan");
            return out_;
        }
        if (place_roughly(found) && place_exactly() && closed() && state()) look_elsewhere();
        if (out_.fit.status == FitStatus::ok || out_.fit.status == FitStatus::ambiguous ||
            out_.fit.status == FitStatus::under_determined)
            describe();
        return out_;
    }

  private:
    bool stopped() const { return options_.cancelled && options_.cancelled(); }
    bool refuse(FitStatus status, Text reason) {
        out_.fit.status = status;
        out_.fit.reason = std::move(reason);
        return false;
    }

    // Residuals of the rough ends with a pose.
    std::vector<Row> rough_rows(const std::vector<SheetEnd>& ends, const std::vector<EdgeSearch>& searches,
                                const Pose& pose) const {
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

    struct Rough {
        Pose pose = Pose::Identity();
        Equations end;
    };
    // The gate stays until the ends within it have settled, then falls by itself and not by the residuals: the scan's own
    // border may show as many ends as the part.
    Rough settle(const std::vector<SheetEnd>& ends, const std::vector<EdgeSearch>& searches, Pose pose,
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

    bool place_roughly(const SheetEnds& found) {
        // Drawn, not every n-th: along a profile its two ends take turns.
        std::vector<SheetEnd> ends;
        std::mt19937_64 random(options_.seed);
        std::sample(found.ends.begin(), found.ends.end(), std::back_inserter(ends), 400, random);
        const double capture = std::max(4 * radius_, options_.start_mm),
                     near = std::min(capture, 4 * radius_);
        std::vector<EdgeSearch> wide, narrow;
        for (const EdgeCurve& edge : edges_)
            wide.emplace_back(edge, capture), narrow.emplace_back(edge, near);
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
        const int steps =
            static_cast<int>(std::min(kMostBeside, std::ceil(options_.start_mm / (2 * radius_))));
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

    // The cells' ends with a pose; of an edge's two sides the one that shows more of them.
    std::vector<CellEnd> ends_at(const Pose& pose, double window) const {
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

    static std::vector<Row> rows_of(const std::vector<CellEnd>& ends, const Pose& pose) {
        std::vector<Row> rows;
        for (const CellEnd& e : ends) {
            const double d = std::hypot(e.outward_mm, e.normal_mm);
            const Vector3d at = pose * e.foot.point_mm;
            rows.push_back({at, pose.linear() * e.foot.outward, e.outward_mm, d});
            rows.push_back({at, pose.linear() * e.foot.normal, e.normal_mm, d});
        }
        return rows;
    }

    struct Exact {
        Pose pose = Pose::Identity();
        std::vector<CellEnd> ends;
        FitSystem system;
        double gate_mm = 0;
        std::size_t inside(double gate) const {
            return static_cast<std::size_t>(std::count_if(ends.begin(), ends.end(), [&](const CellEnd& e) {
                return std::hypot(e.outward_mm, e.normal_mm) < gate;
            }));
        }
    };
    // From a rough pose. Fewer ends than kLeastEnds: it came to nothing.
    Exact exact(const Pose& rough) const {
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

    // The largest distance across the edges between two poses of them.
    double across_mm(const Pose& a, const Pose& b) const {
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

    bool place_exactly() {
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
            if (x.ends.size() >= kLeastEnds &&
                x.inside(x.gate_mm) >= kShowsMost * static_cast<double>(shown) &&
                (gate <= 0 || x.gate_mm < gate))
                gate = x.gate_mm;
        for (const Exact& x : exact_)
            if (const std::size_t n = x.inside(gate > 0 ? gate : x.gate_mm); n > most) most = n, best = x;
        if (best.ends.size() < kLeastEnds)
            return refuse(FitStatus::no_fit,
                          Text("the scan shows where the sheet ends in {} places of the edge, too few",
                               best.ends.size()));
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
            return refuse(FitStatus::no_fit,
                          Text("the fit left its start by more than {:g} mm or {:g} degrees",
                               options_.start_mm, options_.start_deg));
        const double limit =
            options_.form_limit_mm > 0 ? options_.form_limit_mm : fitting::kFormLimit * surface_.size_mm();
        if (!(system_.median_mm <= limit))
            return refuse(
                FitStatus::no_fit,
                Text("half of the sheet's ends lie more than {:.2f} mm off the edge", system_.median_mm));
        if (fit.points_used < kLeastEnds || fit.share_on_part < options_.share_needed)
            return refuse(FitStatus::no_fit,
                          Text("only {:.0f} % of the sheet's ends lie on the edge", 100 * fit.share_on_part));
        return true;
    }
    // The residuals of the same ends with another pose, to first order in the frame of their cells.
    static void shift_ends(std::vector<CellEnd>& ends, const Pose& from, const Pose& to) {
        const Pose change = to.inverse() * from;
        for (CellEnd& e : ends) {
            const Vector3d p = change * Vector3d(e.foot.point_mm + e.outward_mm * e.foot.outward +
                                                 e.normal_mm * e.foot.normal) -
                               e.foot.point_mm;
            e.outward_mm = p.dot(e.foot.outward);
            e.normal_mm = p.dot(e.foot.normal);
        }
    }

    bool open(const Eigen::MatrixXd& motions) {
        SurfaceFit& fit = out_.fit;
        Eigen::MatrixXd in_part(6, motions.cols());
        const Eigen::Matrix3d part_from_base = fit.base_from_part.linear().transpose();
        in_part.topRows(3) = part_from_base * motions.topRows(3);
        in_part.bottomRows(3) = part_from_base * motions.bottomRows(3);
        fit.unobservable = correction::name_directions(in_part, fit.base_from_part.inverse() * system_.middle,
                                                       system_.spread_mm);
        Text list;
        for (const Text& word : fit.unobservable) list = joined(list, ", ", word);
        return refuse(FitStatus::under_determined, Text("the edge that was seen leaves open: {}", list));
    }

    bool closed() {
        const SymmetricEigen e = symmetric_eigen(system_.information / system_.weight);
        Eigen::Index loose = 0;
        while (loose < 6 && e.values[loose] < kOpenShare) ++loose;
        return loose == 0 || open(e.vectors.leftCols(loose));
    }

    // Variance of one cell beside its neighbours, by second differences along each edge: what bends slowly is form.
    double scatter_mm2(bool outward) const {
        std::vector<double> off;
        for (std::size_t k = 2; k < ends_.size(); ++k) {
            if (!counts_[k] || !counts_[k - 1] || !counts_[k - 2]) continue;
            const CellEnd &a = ends_[k - 2], &b = ends_[k - 1], &c = ends_[k];
            if (a.curve != c.curve) continue;
            off.push_back(std::abs(outward ? a.outward_mm - 2 * b.outward_mm + c.outward_mm
                                           : a.normal_mm - 2 * b.normal_mm + c.normal_mm));
        }
        if (off.size() < 5) return std::numeric_limits<double>::quiet_NaN();
        return std::pow(kMadToSigma * median(off), 2) / 6;
    }

    double seen_share(std::size_t ends) const {
        std::map<int, double> lengths;
        for (const EdgeCurve& e : edges_) lengths[e.edge] = e.length_mm();
        double length = 0;
        for (const auto& [edge, l] : lengths) length += l;
        const double cell = std::max(radius_ / 2, length / static_cast<double>(kMostCells));
        return std::min(1.0, static_cast<double>(ends) * cell / std::max(kLeastLength_mm, length));
    }

    bool state() {
        SurfaceFit& fit = out_.fit;
        if (seen_share(fit.points_used) < kLeastSeen)
            return refuse(FitStatus::under_determined,
                          "less than half of the edge was seen: its form is not told from its place");
        const double outward = scatter_mm2(true), normal = scatter_mm2(false);
        if (!std::isfinite(outward + normal))
            return refuse(FitStatus::no_fit, "the scan covers too few places of the edge");
        std::vector<FormNode> nodes;
        std::vector<int> edge_of;  // of outward nodes; -1
        Matrix6 information = Matrix6::Zero(), plain = Matrix6::Zero();
        for (std::size_t k = 0; k < ends_.size(); ++k) {
            if (!counts_[k]) continue;
            const CellEnd& e = ends_[k];
            for (const bool out : {true, false}) {
                FormNode node;
                node.place_mm = fit.base_from_part * e.foot.point_mm;
                node.normal = fit.base_from_part.linear() * (out ? e.foot.outward : e.foot.normal);
                node.row << node.normal,
                    (node.place_mm - system_.middle).cross(node.normal) / system_.spread_mm;
                node.residual_mm = out ? e.outward_mm : e.normal_mm;
                node.noise_mm2 = std::max(out ? outward : normal, kLeastNoise_mm2);
                information += node.row * node.row.transpose() / node.noise_mm2;
                plain += node.row * node.row.transpose();
                nodes.push_back(node);
                edge_of.push_back(out ? edges_[static_cast<std::size_t>(e.curve)].edge : -1);
            }
        }
        const FormSolution s = solve_with_form(nodes, fitting::plate_axes(surface_, fit.base_from_part),
                                               system_.middle, system_.spread_mm);
        if (!s.solved) return refuse(FitStatus::no_fit, "the scan covers too few places of the edge");
        // What all ends of an edge err by in common: an edge's answer to 1 mm outward.
        Matrix6 common = Matrix6::Zero();
        std::map<int, std::vector<double>> phases;
        std::vector<double> spacings;
        for (const CellEnd& e : ends_) {
            phases[edges_[static_cast<std::size_t>(e.curve)].edge].push_back(e.phase_mm2);
            spacings.push_back(e.spacing_mm);
        }
        for (auto& [edge, variances] : phases) {
            const double left = std::max(0.0, median(variances) - outward);
            Vector6 right = Vector6::Zero();
            for (std::size_t k = 0; k < nodes.size(); ++k)
                if (edge_of[k] == edge) right += nodes[k].row;
            const Vector6 answer = solve_symmetric(plain, right).col(0);
            common += left * answer * answer.transpose();
        }
        out_.spacing_mm = median(spacings);
        const Matrix6 to_tangent = tangent_of_motion(fit.base_from_part, system_.middle, system_.spread_mm);
        motion_covariance_ = s.covariance + common;
        fit.covariance = to_tangent * motion_covariance_ * to_tangent.transpose();
        fit.covariance_noise = to_tangent * (inverse_matrix(information) + common) * to_tangent.transpose();
        fit.noise_mm = std::sqrt(outward);
        fit.form_mm = s.form_mm;
        fit.form_length_mm = s.length_mm;
        const Pose to = retract(fit.base_from_part, to_tangent * s.motion);
        shift_ends(ends_, fit.base_from_part, to);
        fit.base_from_part = to;
        const SymmetricEigen e = symmetric_eigen(motion_covariance_);
        Eigen::Index vague = 0;
        while (vague < 6 && 3 * std::sqrt(std::max(0.0, e.values[5 - vague])) > options_.sigma_limit_mm)
            ++vague;
        if (vague > 0) return open(e.vectors.rightCols(vague));
        fit.status = FitStatus::ok;
        return true;
    }

    // Another place within the start's tolerance where as many ends lie on the edge as narrowly.
    void look_elsewhere() {
        SurfaceFit& fit = out_.fit;
        for (const Exact& x : exact_) {
            if (x.ends.size() < kLeastEnds ||
                fitting::corner_distance_mm(surface_, x.pose, fit.base_from_part) < 2 * radius_ ||
                !fitting::within_start(x.pose, surface_, options_))
                continue;
            const Vector6 d = difference(x.pose, fit.base_from_part);
            if (d.dot(solve_symmetric(fit.covariance, d).col(0)) <= fitting::kNoOtherPlace) continue;
            FitRival rival;
            rival.base_from_part = x.pose;
            rival.for_best = fit.points_used;
            rival.for_rival = x.inside(fit.gate_mm);
            rival.told_apart =
                static_cast<double>(rival.for_rival) < kAsMany * static_cast<double>(rival.for_best);
            const bool known = std::any_of(fit.rivals.begin(), fit.rivals.end(), [&](const FitRival& r) {
                return fitting::corner_distance_mm(surface_, x.pose, r.base_from_part) < 2 * radius_;
            });
            if (!known && fit.rivals.size() < 5) fit.rivals.push_back(rival);
        }
        std::stable_sort(fit.rivals.begin(), fit.rivals.end(),
                         [](const FitRival& a, const FitRival& b) { return a.for_rival > b.for_rival; });
        if (fit.rivals.empty() || fit.rivals.front().told_apart) return;
        const FitRival& r = fit.rivals.front();
        refuse(FitStatus::ambiguous,
               Text("the edge lies as well {:.1f} mm and {:.1f} degrees away: {} ends lie on it in the one "
                    "place, {} in the other",
                    fitting::corner_distance_mm(surface_, r.base_from_part, fit.base_from_part),
                    deg_from_rad(angle_rad(r.base_from_part, fit.base_from_part)), r.for_best, r.for_rival));
    }

    void describe() {
        DeviationMap& map = out_.deviation;
        const Pose& pose = out_.fit.base_from_part;
        double sum = 0, squares = 0, normals = 0, n = 0;
        std::map<int, double> lengths;
        for (const EdgeCurve& e : edges_) lengths[e.edge] = e.length_mm();
        double length = 0;
        for (const auto& [edge, l] : lengths) length += l;
        for (std::size_t k = 0; k < ends_.size(); ++k) {
            const CellEnd& e = ends_[k];
            const Vector3d at = e.foot.point_mm + e.outward_mm * e.foot.outward + e.normal_mm * e.foot.normal;
            out_.ends.points.push_back(pose * at);
            map.signed_mm.push_back(counts_[k] ? static_cast<float>(e.outward_mm)
                                               : std::numeric_limits<float>::quiet_NaN());
            if (!counts_[k]) continue;
            ++map.counted;
            n += 1, sum += e.outward_mm, squares += e.outward_mm * e.outward_mm;
            normals += e.normal_mm * e.normal_mm;
            // Of three neighbouring cells: one alone is noise.
            double mean = e.outward_mm, beside = 1;
            for (const std::size_t j : {k - 1, k + 1})
                if (j < ends_.size() && counts_[j] && ends_[j].curve == e.curve)
                    mean += ends_[j].outward_mm, beside += 1;
            if (beside < 3 || std::abs(mean / beside) <= std::abs(map.worst_mm)) continue;
            map.worst_mm = mean / beside;
            map.worst_part_mm = e.foot.point_mm;
            map.worst_base_mm = pose * e.foot.point_mm;
        }
        if (n < 1) return;
        map.mean_mm = sum / n;
        map.rms_mm = std::sqrt(squares / n);
        map.three_sigma_mm = 3 * std::sqrt(std::max(0.0, squares / n - map.mean_mm * map.mean_mm));
        out_.normal_rms_mm = std::sqrt(normals / n);
        const double cell = std::max(radius_ / 2, length / static_cast<double>(kMostCells));
        map.share_seen = std::min(1.0, n * cell / std::max(kLeastLength_mm, length));
        make_histogram(map, 21);
    }

    const Cloud& cloud_;
    std::span<const EdgeCurve> edges_;
    const Surface& surface_;
    FitOptions options_;
    double radius_ = 0, noise_ = 0;
    std::vector<Rough> rough_;
    std::vector<Exact> exact_;
    std::vector<CellEnd> ends_;
    std::vector<char> counts_;
    FitSystem system_;
    Matrix6 motion_covariance_ = Matrix6::Zero();
    EdgeFit out_;
};

}  // namespace

Expected<EdgeFit> fit_edges(const Cloud& cloud, std::span<const EdgeCurve> edges, const Surface& surface,
                            const FitOptions& options) {
    SEAM_OK(check_fit_input(cloud, surface, options));
    if (!options.start && options.pairs_part.empty())
        return input_error("an edge alone is found from a start only", {},
                           "give where the part stands roughly, or three pairs of points");
    if (edges.empty()) return input_error("no edge is given");
    for (const EdgeCurve& e : edges)
        if (e.samples.size() < 2 || !(e.length_mm() > 0))
            return input_error("the edge has no length", Text(e.name));
    return EdgeFitter(cloud, edges, surface, options).run();
}

}  // namespace seamwright
