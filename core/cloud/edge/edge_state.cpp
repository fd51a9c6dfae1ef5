#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/cloud/edge/edge_fitter.h"
#include "core/correction/region_system.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright::edge_fitting {

using Eigen::Vector3d;

namespace {

// Of the edges' length. With 40 % of one seen and a form of 0.1 mm, 28 of 39 truths alone were within the stated 95 %.
constexpr double kLeastSeen = 0.5;
constexpr double kAsMany = 0.85;  // of the best's ends: a rival with fewer is told apart
constexpr double kLeastNoise_mm2 = 1e-8;

}  // namespace

bool EdgeFitter::open(const Eigen::MatrixXd& motions) {
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

bool EdgeFitter::closed() {
    const SymmetricEigen e = symmetric_eigen(system_.information / system_.weight);
    Eigen::Index loose = 0;
    while (loose < 6 && e.values[loose] < kOpenShare) ++loose;
    return loose == 0 || open(e.vectors.leftCols(loose));
}

double EdgeFitter::scatter_mm2(bool outward) const {
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

double EdgeFitter::seen_share(std::size_t ends) const {
    std::map<int, double> lengths;
    for (const EdgeCurve& e : edges_) lengths[e.edge] = e.length_mm();
    double length = 0;
    for (const auto& [edge, l] : lengths) length += l;
    const double cell = std::max(radius_ / 2, length / static_cast<double>(kMostCells));
    return std::min(1.0, static_cast<double>(ends) * cell / std::max(kLeastLength_mm, length));
}

bool EdgeFitter::state() {
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
            node.row << node.normal, (node.place_mm - system_.middle).cross(node.normal) / system_.spread_mm;
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
    while (vague < 6 && 3 * std::sqrt(std::max(0.0, e.values[5 - vague])) > options_.sigma_limit_mm) ++vague;
    if (vague > 0) return open(e.vectors.rightCols(vague));
    fit.status = FitStatus::ok;
    return true;
}

void EdgeFitter::look_elsewhere() {
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

void EdgeFitter::describe() {
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

}  // namespace seamwright::edge_fitting
