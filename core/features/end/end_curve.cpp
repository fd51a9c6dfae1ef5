#include "core/features/end/end_curve.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kEndGate = 3.5;  // sigma
constexpr double kEndSmallest_mm = 1e-9;
constexpr std::size_t kEndFewestRounded = 6;  // points that know a curvature and their noise
constexpr std::size_t kEndFewestOnArc = 3;    // points behind its beginning
constexpr int kEndGateRounds = 6;
constexpr double kEndPointsKept = 0.75;  // of the robust line's, for other curves to be better
constexpr double kEndBent = 1.5;         // sigma of the curvature expected, over the points' extent
// Of the points' extent: the arc's part, the whole first.
constexpr double kEndArcs[] = {1, 0.82, 0.66, 0.52, 0.4, 0.3, 0.22, 0.15};
constexpr double kEndOnTheLine = 1e-6;  // of a length: points of an even grid stand at such places
constexpr double kEndStraightPrior = 0.7;
constexpr double kEndSingular = 1e-9;       // reciprocal condition
constexpr double kEndMostTurned_rad = 1.5;  // over one sigma of the points' spread
constexpr double kEndShortestStep = 0.01;   // of Gauss and Newton's
constexpr double kEndSettled = 1e-9;        // of the points' spread: a change of the bow
constexpr double kEndLeastWeight = 1e-4;    // of the likeliest: less is not carried on

EndCurve straight(const LineFit& line) {
    EndCurve curve;
    curve.centre = line.centre;
    curve.direction = curve.chord = -line.direction;  // the points go from the end inwards
    curve.sigma_mm = line.sigma_mm;
    curve.rms_mm = line.rms_mm;
    curve.used = line.used;
    curve.spread_mm2 = line.spread_mm2;
    curve.widening = line.widening;
    curve.alike = line.alike;
    curve.cofactor(0, 0) = 1.0 / line.used;
    curve.cofactor(1, 1) = 1 / line.spread_mm2;
    return curve;
}

}  // namespace

std::span<const EndCurve> EndFit::fit(std::span<const double> x, std::span<const double> z,
                                      const ProfileNoise& noise, bool covered) {
    x_ = x;
    z_ = z;
    covered_ = covered;
    workspace_.noise = noise;
    curves_.clear();
    const LineFit line = fit_line(x, z, workspace_);
    if (!line.ok) return {};
    if (x_.size() < kEndFewestRounded || !try_curves(static_cast<int>(kEndPointsKept * line.used)))
        curves_.assign(1, straight(line));
    return curves_;
}

// All curves through the points that belong to the likeliest; false: they know no arc.
bool EndFit::try_curves(int fewest_used) {
    keep_.assign(x_.size(), 1);
    const double length = (point(0) - point(x_.size() - 1)).norm();
    const double noise = std::max(workspace_.noise.point_mm, workspace_.noise.alone_mm);
    const double curvature_weight = 4 * std::pow(noise * length / kEndBent, 2);
    for (int round = 0; round < kEndGateRounds; ++round) {
        curves_.clear();
        EndCurve line;
        if (!line_of_kept(line)) return false;
        curves_.push_back(line);
        std::size_t on_arc = x_.size() + 1;
        for (const double share : kEndArcs) {
            EndCurve curve = line;
            curve.straight_before = share < 1;
            const double reach = share * (1 + kEndOnTheLine) * length;
            const auto first = [&] {  // of the points before the arc
                std::size_t i = 0;
                while (i < x_.size() && (point(i) - point(0)).norm() <= reach) ++i;
                return i;
            };
            const std::size_t count = share < 1 ? first() : x_.size();
            if (count == on_arc) continue;
            on_arc = count;
            if (count < kEndFewestOnArc) break;
            if (share < 1) {
                const Eigen::Vector2d from = 0.5 * (point(count - 1) + point(std::min(count, x_.size() - 1)));
                curve.centre += curve.direction * curve.direction.dot(from - curve.centre);
            }
            if (!least_squares(curve, curvature_weight)) continue;
            const bool turns_up = curve.curvature * curve.normal().y() > 0;
            if (!covered_ || !turns_up) curves_.push_back(curve);
        }
        if (curves_.size() < 2) return false;
        weigh();
        const EndCurve& best = curves_.front();
        if (best.used < fewest_used) return false;
        const double sigma = std::max(kMadToSigma * median_residual(best), workspace_.noise.point_mm);
        const double gate = std::max(kEndGate * sigma, kEndSmallest_mm);
        bool changed = false;
        for (std::size_t i = 0; i < x_.size(); ++i) {
            const std::uint8_t in = std::abs(best.residual(point(i))) <= gate;
            changed = changed || in != keep_[i];
            keep_[i] = in;
        }
        if (!changed) break;
    }
    for (EndCurve& curve : curves_) curve.cubic_misfit = cubic(curve);
    return true;
}

// Weights by evidence, with one sigma for all: what the points scatter about the best of them.
void EndFit::weigh() {
    const double length = (point(0) - point(x_.size() - 1)).norm();
    const EndCurve* closest = &curves_.front();
    for (const EndCurve& curve : curves_)
        if (curve.sigma_mm < closest->sigma_mm) closest = &curve;
    const double interpolated = std::max(1.0, 1.5 * workspace_.noise.measured_apart);
    const double sigma = std::max(closest->sigma_mm, kEndSmallest_mm);
    const double variance = sigma * sigma * closest->widening * std::max(alike(*closest), interpolated);
    const double arcs = double(curves_.size() - 1), bend = kEndBent / length;
    evidence_.clear();
    double most = -1e300;
    for (const EndCurve& curve : curves_) {
        // |cofactor| relative to the line's cancels the units of offset and turn.
        const bool line = curve.curvature == 0 && !(curve.cofactor(2, 2) > 0);
        const double determinant = line ? curve.cofactor(0, 0) * curve.cofactor(1, 1)
                                        : curve.cofactor.determinant() * variance * 4 / (bend * bend);
        const double prior = line ? kEndStraightPrior : (1 - kEndStraightPrior) / arcs;
        const double chi2 = (squares(curve)) / variance + (line ? 0 : std::pow(curve.curvature / bend, 2));
        evidence_.push_back(std::log(prior) + 0.5 * std::log(std::max(determinant, 1e-300)) - 0.5 * chi2);
        most = std::max(most, evidence_.back());
    }
    for (std::size_t j = 0; j < curves_.size(); ++j) curves_[j].weight = std::exp(evidence_[j] - most);
    std::erase_if(curves_, [](const EndCurve& curve) { return curve.weight < kEndLeastWeight; });
    double sum = 0;
    for (const EndCurve& curve : curves_) sum += curve.weight;
    for (EndCurve& curve : curves_) curve.weight /= sum;
    std::sort(curves_.begin(), curves_.end(),
              [](const EndCurve& a, const EndCurve& b) { return a.weight > b.weight; });
    for (EndCurve& curve : curves_) curve.alike = alike(curve);
}

// The cubic part (s^3, free of the arc's) of the kept points' residuals, without what noise alone
// makes of it; as coefficients of powers().
Eigen::Vector4d EndFit::cubic(const EndCurve& curve) const {
    if (curve.curvature == 0) return Eigen::Vector4d::Zero();
    const double size = std::sqrt(curve.spread_mm2 / curve.used);
    const Eigen::Vector4d unit(1, 1 / size, 1 / (size * size), 1 / (size * size * size));
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double rss = 0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
        if (!keep_[i]) continue;
        const double e = curve.residual(point(i));
        const Eigen::Vector4d r = unit.asDiagonal() * curve.powers(curve.along(point(i)));
        normal += r * r.transpose();
        right += e * r;
        rss += e * e;
    }
    const int freedom = curve.used - 4;
    const Eigen::LDLT<Eigen::Matrix4d> solver(normal);
    if (freedom < 2 || !(solver.rcond() > kEndSingular)) return Eigen::Vector4d::Zero();
    const Eigen::Vector4d b = solver.solve(right);
    const double widening = freedom > 4 ? double(freedom) / (freedom - 2) : 2.0;
    const double variance = widening * curve.alike * std::max(rss - b.dot(right), 0.0) / freedom *
                            solver.solve(Eigen::Vector4d::Unit(3))[3];
    const double excess = b[3] * b[3] - variance;
    if (!(excess > 0)) return Eigen::Vector4d::Zero();
    return std::sqrt(excess) / std::abs(b[3]) * unit.asDiagonal() * b;
}

// Total least squares through the kept points.
bool EndFit::line_of_kept(EndCurve& curve) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    int used = 0;
    for (std::size_t i = 0; i < x_.size(); ++i)
        if (keep_[i]) {
            mean += point(i);
            ++used;
        }
    if (used < static_cast<int>(kEndFewestRounded)) return false;
    mean /= used;
    double xx = 0, xz = 0, zz = 0;
    for (std::size_t i = 0; i < x_.size(); ++i)
        if (keep_[i]) {
            const Eigen::Vector2d d = point(i) - mean;
            xx += d.x() * d.x();
            xz += d.x() * d.y();
            zz += d.y() * d.y();
        }
    if (!(std::sqrt((xx + zz) / used) > kEndSmallest_mm)) return false;
    const double angle = 0.5 * std::atan2(2 * xz, xx - zz);
    curve.centre = mean;
    curve.direction = {std::cos(angle), std::sin(angle)};
    if (curve.direction.dot(point(0) - point(x_.size() - 1)) < 0) curve.direction = -curve.direction;
    curve.chord = curve.direction;
    curve.used = used;
    curve.spread_mm2 = xx * curve.chord.x() * curve.chord.x() + 2 * xz * curve.chord.x() * curve.chord.y() +
                       zz * curve.chord.y() * curve.chord.y();
    curve.cofactor(0, 0) = 1.0 / used;
    curve.cofactor(1, 1) = 1 / curve.spread_mm2;
    const double rss = squares(curve);
    curve.rms_mm = std::sqrt(rss / used);
    const PooledSigma pooled = pooled_sigma(std::sqrt(rss / (used - 2)), used - 2, workspace_.noise);
    curve.sigma_mm = pooled.sigma_mm;
    curve.widening = pooled.widening;
    return true;
}

// From the line through the kept points, its centre where the arc begins. `curvature_weight`: by which squares of half the
// curvature count beside those of the residuals. False: they know none.
bool EndFit::least_squares(EndCurve& curve, double curvature_weight) const {
    const double size = std::sqrt(curve.spread_mm2 / curve.used);
    const auto cost = [&] {
        return squares(curve) + 0.25 * curvature_weight * curve.curvature * curve.curvature;
    };
    double least = cost();
    // Gauss-Newton, in units of `size`, so that the equations are as well conditioned at every scale.
    const Eigen::Vector3d unit(1, 1 / size, 1 / (size * size));
    for (int round = 0; round < 8; ++round) {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < x_.size(); ++i)
            if (keep_[i]) {
                const Eigen::Vector3d r = unit.asDiagonal() * curve.powers(curve.along(point(i))).head<3>();
                normal += r * r.transpose();
                right += curve.residual(point(i)) * r;
            }
        normal(2, 2) += curvature_weight * unit[2] * unit[2];
        right[2] -= curvature_weight * unit[2] * 0.5 * curve.curvature;
        const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
        if (!(solver.rcond() > kEndSingular)) return false;
        const Eigen::Vector3d b = unit.asDiagonal() * Eigen::Vector3d(solver.solve(right));
        // A step that leaves the points is too long.
        const EndCurve before = curve;
        double share = 1;
        for (; share > kEndShortestStep; share /= 2) {
            curve = before;
            curve.move(share * b[0], share * b[1], share * 2 * b[2]);
            const double now = cost();
            if (now > least) continue;
            least = now;
            break;
        }
        curve.cofactor = unit.asDiagonal() * Eigen::Matrix3d(solver.solve(Eigen::Matrix3d::Identity())) *
                         unit.asDiagonal();
        if (!(std::abs(curve.curvature) * size < kEndMostTurned_rad)) return false;
        if (share <= kEndShortestStep || std::abs(b[2]) * size * size < kEndSettled * size) break;
    }
    const int freedom = curve.used - 3;
    const double rss = squares(curve);
    curve.rms_mm = std::sqrt(rss / curve.used);
    const PooledSigma pooled = pooled_sigma(std::sqrt(rss / freedom), freedom, workspace_.noise);
    curve.sigma_mm = pooled.sigma_mm;
    curve.widening = pooled.widening;
    return true;
}

double EndFit::squares(const EndCurve& curve) const {
    double rss = 0;
    for (std::size_t i = 0; i < x_.size(); ++i)
        if (keep_[i]) rss += curve.residual(point(i)) * curve.residual(point(i));
    return rss;
}

double EndFit::alike(const EndCurve& curve) {
    scratch_.clear();
    for (std::size_t i = 0; i < x_.size(); ++i)
        if (keep_[i]) scratch_.push_back(curve.residual(point(i)));
    return alike_widening(scratch_, curve.curvature == 0 ? 2 : 3, workspace_.noise);
}

double EndFit::median_residual(const EndCurve& curve) {
    scratch_.clear();
    for (std::size_t i = 0; i < x_.size(); ++i) scratch_.push_back(std::abs(curve.residual(point(i))));
    return median(scratch_);
}

}  // namespace seamwright
