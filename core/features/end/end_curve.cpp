#include "core/features/end/end_curve.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kEndGate = 3.5;  // sigma
constexpr double kEndSmallest_mm = 1e-9;
constexpr std::size_t kEndFewestRounded = 6;  // points that know a curvature and their noise
constexpr double kEndAkaike = 2;         // times its variance: a coefficient squared that is worth its noise
constexpr double kEndPointsKept = 0.75;  // of the line's, for an arc to be better
constexpr double kEndLeastVariance = 1e-300;  // of a curvature: divided by
constexpr double kEndSingular = 1e-9;         // reciprocal condition
constexpr double kEndMostTurned_rad = 1.5;    // over one sigma of the points' spread
constexpr double kEndShortestStep = 0.01;     // of Gauss and Newton's
constexpr double kEndSettled = 1e-9;          // of the points' spread: a change of the bow

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

// Between the chord of the kept points (share 0) and the arc through them.
void shrink(double share, EndCurve& curve) {
    const double turn =
        std::atan2(curve.chord.x() * curve.direction.y() - curve.chord.y() * curve.direction.x(),
                   curve.chord.dot(curve.direction));
    curve.centre = curve.mean + share * (curve.centre - curve.mean);
    curve.direction = curve.chord;
    curve.move(0, share * turn, 0);
    curve.curvature *= share;
}

}  // namespace

EndFit::Result EndFit::fit(std::span<const double> x, std::span<const double> z, const ProfileNoise& noise) {
    x_ = x;
    z_ = z;
    workspace_.noise = noise;
    Result result;
    const LineFit line = fit_line(x, z, workspace_);
    if (!line.ok) return result;
    result.ok = true;
    result.curve = straight(line);
    result.rounded = fit_arc(line, result.curve);
    return result;
}

// Replaces `curve`, the line, where an arc explains the points better.
bool EndFit::fit_arc(const LineFit& line, EndCurve& curve) {
    if (x_.size() < kEndFewestRounded) return false;
    const double line_median = median_residual(curve);
    EndCurve trial = curve;
    keep_.assign(x_.size(), 1);
    for (int round = 0; round < 12; ++round) {
        if (!least_squares(trial)) return false;
        const double sigma = std::max(kMadToSigma * median_residual(trial), workspace_.noise.point_mm);
        const double gate = std::max(kEndGate * sigma, kEndSmallest_mm);
        bool changed = false;
        for (std::size_t i = 0; i < x_.size(); ++i) {
            const std::uint8_t in = std::abs(trial.residual(point(i))) <= gate;
            changed = changed || in != keep_[i];
            keep_[i] = in;
        }
        if (!changed) break;
    }
    if (trial.used < kEndPointsKept * line.used || median_residual(trial) > line_median) return false;
    trial.alike = alike(trial);
    const double variance = trial.widening * trial.sigma_mm * trial.sigma_mm * trial.cofactor(2, 2);
    const double t2 = 0.25 * trial.curvature * trial.curvature / std::max(variance, kEndLeastVariance);
    if (!(t2 > kEndAkaike)) return false;
    trial.cubic_misfit = cubic(trial);
    // Towards the line of the same points, their chord.
    Eigen::Matrix3d line_cofactor = Eigen::Matrix3d::Zero();
    line_cofactor(0, 0) = 1.0 / trial.used;
    line_cofactor(1, 1) = 1 / trial.spread_mm2;
    const Eigen::Matrix3d bow = trial.cofactor - line_cofactor;
    shrink(1 - kEndAkaike / t2, trial);
    trial.cofactor = line_cofactor + std::min(t2 - kEndAkaike, 1.0) * bow;
    curve = trial;
    return true;
}

// The cubic part (s^3, free of the arc's) of the kept points' residuals, without what noise alone
// makes of it; as coefficients of 1, s, s^2, s^3.
Eigen::Vector4d EndFit::cubic(const EndCurve& curve) const {
    const double size = std::sqrt(curve.spread_mm2 / curve.used);
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double rss = 0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
        if (!keep_[i]) continue;
        const double s = curve.along(point(i)) / size, e = curve.residual(point(i));
        const Eigen::Vector4d r(1, s, s * s, s * s * s);
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
    const Eigen::Vector4d unit(1, 1 / size, 1 / (size * size), 1 / (size * size * size));
    return std::sqrt(excess) / std::abs(b[3]) * unit.asDiagonal() * b;
}

// Chord and arc of the kept points; false when they know none.
bool EndFit::least_squares(EndCurve& curve) const {
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
    const double size = std::sqrt((xx + zz) / used);
    if (!(size > kEndSmallest_mm)) return false;
    const double angle = 0.5 * std::atan2(2 * xz, xx - zz);
    curve.centre = curve.mean = mean;
    curve.direction = {std::cos(angle), std::sin(angle)};
    if (curve.direction.dot(point(0) - point(x_.size() - 1)) < 0) curve.direction = -curve.direction;
    curve.chord = curve.direction;
    curve.curvature = 0;
    double rss = squares(curve);
    // Gauss-Newton, in units of `size`, so that the equations are as well conditioned at every scale.
    const Eigen::Vector3d unit(1, 1 / size, 1 / (size * size));
    for (int round = 0; round < 8; ++round) {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < x_.size(); ++i)
            if (keep_[i]) {
                const double s = curve.along(point(i)) / size;
                const Eigen::Vector3d r(1, s, s * s);
                normal += r * r.transpose();
                right += curve.residual(point(i)) * r;
            }
        const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
        if (!(solver.rcond() > kEndSingular)) return false;
        const Eigen::Vector3d b = unit.asDiagonal() * Eigen::Vector3d(solver.solve(right));
        // A step that leaves the points is too long.
        const EndCurve before = curve;
        double share = 1;
        for (; share > kEndShortestStep; share /= 2) {
            curve = before;
            curve.move(share * b[0], share * b[1], share * 2 * b[2]);
            const double now = squares(curve);
            if (now > rss) continue;
            rss = now;
            break;
        }
        curve.cofactor = unit.asDiagonal() * Eigen::Matrix3d(solver.solve(Eigen::Matrix3d::Identity())) *
                         unit.asDiagonal();
        if (!(std::abs(curve.curvature) * size < kEndMostTurned_rad)) return false;
        if (share <= kEndShortestStep || std::abs(b[2]) * size * size < kEndSettled * size) break;
    }
    const int freedom = used - 3;
    curve.used = used;
    curve.spread_mm2 = xx * curve.chord.x() * curve.chord.x() + 2 * xz * curve.chord.x() * curve.chord.y() +
                       zz * curve.chord.y() * curve.chord.y();
    curve.rms_mm = std::sqrt(rss / used);
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
    return alike_widening(scratch_, 3, workspace_.noise);
}

double EndFit::median_residual(const EndCurve& curve) {
    scratch_.clear();
    for (std::size_t i = 0; i < x_.size(); ++i) scratch_.push_back(std::abs(curve.residual(point(i))));
    return median(scratch_);
}

}  // namespace seamwright
