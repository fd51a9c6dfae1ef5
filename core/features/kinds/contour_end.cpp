// Contour end ("tear-off"; methods.md 2): where the surface stops, seen from the left or the right.
//
// The point. Through the last points before the end, up to fit_length_mm, goes a line (fit_line: robust,
// total least squares). Where the contour is rounded there, a parabola over its chord:
//     d(s) = w (b0 + b1 s + b2 s^2),   d across and s along the chord, outwards,
// by least squares on the points within 3.5 robust sigma (median size of the residuals, iterated). With
// T = (b2 / sigma(b2))^2 the curvature counts by w = 1 - 2 / T, and not at all for T < 2 (Akaike's limit: it
// is not worth its noise), when it loses more than a quarter of the line's points, or when it leaves a larger
// median residual than the line. Without it a robust line takes the rounded end, or the flat before it, for
// outliers and says confidently where neither of them is.
// The last return is not the end: the surface ends somewhere between it and the next, missing one. The point
// lies half a pitch p beyond the last point on that curve. p is the median step; on a parabola the sensor's
// steps grow as the surface turns away, so there p is the arc in which the curve advances by the median step
// in x, or comes to its vertical tangent, at most half of fit_length_mm.
//
// Its covariance, along the tangent at the point and across it. Noise model: independent, equal, across the
// contour, its sigma from the fit's residuals, and not below what the profile's noise beside them makes likely.
//     across   v + (w b2 h^2)^2 + e^2,   v = v_line + min(T - 2, 1) (v_parabola - v_line), h = r - p / 2
//     along    r^2 / 12 + (r - p)^2 / 4 + noise^2
// (w b2 h^2)^2: beyond the last point the contour may bend on or go on straight. e, other shape than a
// parabola: the larger of the residuals' cubic part at the point, without what noise makes of it, and the
// distance of the last point when the mean of the last three is more than 2.5 sigma / sqrt(3) off.
// The end is spread evenly over the reach r from the last point on. A plain end: r = p, hence p^2 / 12. Else
// the largest of
//     - the last two steps, when longer than 1.5 p and than noise makes them: returns are missing there;
//     - the fading length I / |dI/ds|, when the last return's intensity I is less than 0.6 of the upper
//       quartile of the fit's points: that far beyond it the light is gone, and any threshold below I ends
//       the returns in between (only where the sensor gives intensities);
// and longer by p for each of the lines beyond the end, up to six, whose return the filter rejected: they do
// not say that the surface has ended; behind a line without return only where they stand within three p of
// the contour's continuation. noise: that in z moves the last point along a sloping contour as well, that in x
// (second differences of x; none on an exact grid) along every one.
//
// What is systematic stays: where light grazes a rounded rim, returns stop before the silhouette, at the
// teaching as at the measuring. On a fold of 1.15 mm radius that is 0.15 mm; it repeats within the
// covariance. An arc of fewer than about eight points is not seen as one.
//
// Which end is meant: choose_end() (end_choice.h). Degenerate: a contour that runs on beyond the window,
// leaves the sensor's field or runs under a higher one has no end there (not_found); a sheet shorter than
// minimum_points is passed over; fewer than 6 points within fit_length_mm, or all of them in one place, know
// no curvature.

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/features/contour/line_fit.h"
#include "core/features/end/end_choice.h"
#include "core/features/kinds/feature_kinds.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kEndGate = 3.5;  // sigma
constexpr double kEndSmallest_mm = 1e-9;
constexpr std::size_t kEndFewestRounded = 6;  // points that know a curvature and their noise
constexpr double kEndAkaike = 2;         // times its variance: a coefficient squared that is worth its noise
constexpr double kEndPointsKept = 0.75;  // of the line's, for a parabola to be better
constexpr std::size_t kEndSteps = 16;    // before the end, for the pitch
constexpr double kEndStraight_rad = 1e-3;  // turned over the fit: less is straight
constexpr double kEndLongestPitch = 0.5;   // of fit_length_mm
constexpr double kEndFaded = 0.6;          // of the intensity before the end
constexpr double kEndLongStep = 1.5;       // pitches
constexpr std::size_t kEndLastPoints = 3;
constexpr int kEndDoubtfulLines = 6;
constexpr double kEndBeside = 3;              // pitches
constexpr double kEndLeastVariance = 1e-300;  // of a curvature: divided by
constexpr double kEndSingular = 1e-9;         // reciprocal condition
constexpr double kEndMisfit = 2.5;            // sigma of the last points' mean
constexpr double kEndFull = 0.75;  // of the intensities' upper quartile: as bright as before the end

// A contour near its end: d = b0 + b1 s + b2 s^2 about `centre`; b2 = 0 for a line.
struct EndCurve {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // of the chord, outwards
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double sigma_mm = 0, rms_mm = 0;
    int used = 0;
    double spread_mm2 = 0;  // sum of squared distances from the centre along the chord
    Eigen::Vector4d cubic_misfit = Eigen::Vector4d::Zero();  // coefficients of 1, s, s^2, s^3
    // Of b, without the noise: (sum r r^T)^-1, r = (1, s, s^2). Line: of b0 and b1 only.
    Eigen::Matrix3d cofactor = Eigen::Matrix3d::Zero();
    double widening = 1;  // of variances, for sigma being estimated from few points

    Eigen::Vector2d normal() const { return {-direction.y(), direction.x()}; }
    double along(const Eigen::Vector2d& p) const { return direction.dot(p - centre); }
    double height(double s) const { return b[0] + s * (b[1] + s * b[2]); }
    double slope(double s) const { return b[1] + 2 * s * b[2]; }
    double residual(const Eigen::Vector2d& p) const { return normal().dot(p - centre) - height(along(p)); }
    double curvature(double s) const { return 2 * b[2] / std::pow(1 + slope(s) * slope(s), 1.5); }
    Eigen::Vector2d tangent(double s) const { return (direction + slope(s) * normal()).normalized(); }
    double variance_at(double s) const {
        const Eigen::Vector3d r(1, s, s * s);
        return widening * sigma_mm * sigma_mm * r.dot(cofactor * r);
    }
};

double end_median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::vector<ParameterInfo> contour_end_parameters() {
    return with_window({
        {"side", "", 0, 1, 0, 0, "The side on which the contour ends.", {"left", "right"}},
        {"segment",
         "",
         0,
         4,
         4,
         0,
         "Which end is meant where several lie in the window: the outermost on that side, that of the "
         "longest, "
         "the highest or the lowest contour, or the only one.",
         {"outermost", "longest", "highest", "lowest", "only"}},
        {"order", "", 1, 20, 1, 0, "Outermost: the how-manyth end from outside."},
        {"minimum_points", "", 3, 10000, 6, 0, "Shorter segments are passed over."},
        {"fit_length_mm", "mm", 0.01, 1000, 1.5, 2,
         "Length of contour before its end that says where the line goes."},
        {"field_x_min_mm", "mm", -1e5, 1e5, -1e5, 3,
         "Left rim of the sensor's field, where profiles come without their empty lines."},
        {"field_x_max_mm", "mm", -1e5, 1e5, 1e5, 3,
         "Right rim of the sensor's field, where profiles come without their empty lines."},
    });
}

class ContourEnd final : public FeatureFinder {
  public:
    ContourEnd(FeatureWindow window, SensorField field, EndRule rule, double fit_length_mm)
        : window_(window), field_(field), rule_(rule), fit_length_(fit_length_mm) {}

    Feature find(const Profile& profile) const override {
        Feature feature;
        sheets_.gather(profile, window_, field_);
        const auto chosen = choose_end(sheets_, rule_, feature);
        if (!chosen) return feature;
        const bool at_last = chosen->at_last;
        take_end(chosen->first, chosen->last, at_last);
        const LineFit line = fit_line(fit_x_, fit_z_, workspace_);
        if (!line.ok) {
            feature.message = "the points before the end do not form a line";
            return feature;
        }
        EndCurve curve = straight(line);
        const bool rounded = fit_parabola(line, curve);
        know_noise(curve);
        const double last_s = curve.along(point(0));
        const double pitch = pitch_at(curve, rounded ? curve.tangent(last_s) : curve.direction, rounded);
        const double forward = 0.5 * pitch * curve.tangent(last_s).dot(curve.direction);
        const double s = last_s + forward;
        const Eigen::Vector2d tangent = curve.tangent(s), normal(-tangent.y(), tangent.x());
        feature.point_mm = curve.centre + s * curve.direction + curve.height(s) * curve.normal();

        // Noise in z moves the last point along a sloping contour as well, noise in x along every one.
        const Eigen::Vector2d chord = curve.direction;
        const double slope = chord.x() != 0 ? std::abs(chord.y() / chord.x()) : 1;
        const double upright =
            rounded ? curve.sigma_mm / std::max(std::abs(chord.x()), 0.5) * std::abs(tangent.y())
                    : curve.sigma_mm * std::min(slope, 1.0);
        const double noise = std::hypot(upright, sideways_noise() * tangent.x());
        const double reach = reach_beyond(profile, at_last, tangent, pitch, noise);
        // Continued to the end of the reach, the contour may bend on or go on straight.
        const double continued = std::max(reach - 0.5 * pitch, 0.5 * pitch);
        const double bend = curve.b[2] * continued * continued;
        const Eigen::Vector4d powers(1, s, s * s, s * s * s);
        const double misfit = std::max(std::abs(curve.cubic_misfit.dot(powers)), end_misfit(curve));
        const double turned = tangent.dot(curve.direction);  // residuals across the chord -> the tangent
        const double across = (curve.variance_at(s) + bend * bend + misfit * misfit) * turned * turned;
        const double along = reach * reach / 12 + (reach - pitch) * (reach - pitch) / 4 + noise * noise;
        feature.covariance_mm2 = across * normal * normal.transpose() + along * tangent * tangent.transpose();
        feature.rms_mm = curve.rms_mm;
        feature.points_used = curve.used;
        feature.status = FeatureStatus::ok;
        return feature;
    }

  private:
    Eigen::Vector2d point(std::size_t i) const { return {fit_x_[i], fit_z_[i]}; }

    // The points within fit_length_ of the end, from the end inwards.
    void take_end(int first, int last, bool at_last) const {
        const int step = at_last ? -1 : 1;
        const int end = at_last ? last : first;
        fit_x_.clear();
        fit_z_.clear();
        for (int i = end; i >= first && i <= last; i += step) {
            const double d = std::hypot(sheets_.x()[i] - sheets_.x()[end], sheets_.z()[i] - sheets_.z()[end]);
            if (d > fit_length_ && fit_x_.size() >= 4) break;
            fit_x_.push_back(sheets_.x()[i]);
            fit_z_.push_back(sheets_.z()[i]);
        }
    }

    EndCurve straight(const LineFit& line) const {
        EndCurve curve;
        curve.centre = line.centre;
        curve.direction = -line.direction;  // the points go from the end inwards
        curve.sigma_mm = line.sigma_mm;
        curve.rms_mm = line.rms_mm;
        curve.used = line.used;
        curve.spread_mm2 = line.spread_mm2;
        curve.widening = line.widening;
        curve.cofactor(0, 0) = 1.0 / line.used;
        curve.cofactor(1, 1) = 1 / line.spread_mm2;
        return curve;
    }

    // Replaces `curve`, the line, where a parabola explains the points better.
    bool fit_parabola(const LineFit& line, EndCurve& curve) const {
        if (fit_x_.size() < kEndFewestRounded) return false;
        const double line_median = median_residual(curve);
        EndCurve trial = curve;
        keep_.assign(fit_x_.size(), 1);
        for (int round = 0; round < 12; ++round) {
            if (!least_squares(trial)) return false;
            const double gate = std::max(kEndGate * kMadToSigma * median_residual(trial), kEndSmallest_mm);
            bool changed = false;
            for (std::size_t i = 0; i < fit_x_.size(); ++i) {
                const std::uint8_t in = std::abs(trial.residual(point(i))) <= gate;
                changed = changed || in != keep_[i];
                keep_[i] = in;
            }
            if (!changed) break;
        }
        if (trial.used < kEndPointsKept * line.used || median_residual(trial) > line_median) return false;
        const double variance = trial.widening * trial.sigma_mm * trial.sigma_mm * trial.cofactor(2, 2);
        const double t2 = trial.b[2] * trial.b[2] / std::max(variance, kEndLeastVariance);
        if (!(t2 > kEndAkaike)) return false;
        trial.cubic_misfit = cubic(trial);
        // The line of the same points is b = 0, for the chord is their line.
        Eigen::Matrix3d line_cofactor = Eigen::Matrix3d::Zero();
        line_cofactor(0, 0) = 1.0 / trial.used;
        line_cofactor(1, 1) = 1 / trial.spread_mm2;
        const Eigen::Matrix3d bow = trial.cofactor - line_cofactor;
        trial.b *= 1 - kEndAkaike / t2;
        trial.cofactor = line_cofactor + std::min(t2 - kEndAkaike, 1.0) * bow;
        curve = trial;
        return true;
    }

    // The cubic part (s^3, free of the parabola's) of the kept points' residuals, without what noise alone
    // makes of it; as coefficients of 1, s, s^2, s^3.
    Eigen::Vector4d cubic(const EndCurve& curve) const {
        const double size = std::sqrt(curve.spread_mm2 / curve.used);
        Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
        Eigen::Vector4d right = Eigen::Vector4d::Zero();
        double rss = 0;
        for (std::size_t i = 0; i < fit_x_.size(); ++i) {
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
        const double variance = widening * std::max(rss - b.dot(right), 0.0) / freedom *
                                solver.solve(Eigen::Vector4d::Unit(3))[3];
        const double excess = b[3] * b[3] - variance;
        if (!(excess > 0)) return Eigen::Vector4d::Zero();
        const Eigen::Vector4d unit(1, 1 / size, 1 / (size * size), 1 / (size * size * size));
        return std::sqrt(excess) / std::abs(b[3]) * unit.asDiagonal() * b;
    }

    // Chord and parabola of the kept points; false when they know none.
    bool least_squares(EndCurve& curve) const {
        Eigen::Vector2d mean = Eigen::Vector2d::Zero();
        int used = 0;
        for (std::size_t i = 0; i < fit_x_.size(); ++i)
            if (keep_[i]) {
                mean += point(i);
                ++used;
            }
        if (used < static_cast<int>(kEndFewestRounded)) return false;
        mean /= used;
        double xx = 0, xz = 0, zz = 0;
        for (std::size_t i = 0; i < fit_x_.size(); ++i)
            if (keep_[i]) {
                const Eigen::Vector2d d = point(i) - mean;
                xx += d.x() * d.x();
                xz += d.x() * d.y();
                zz += d.y() * d.y();
            }
        const double size = std::sqrt((xx + zz) / used);
        if (!(size > kEndSmallest_mm)) return false;
        const double angle = 0.5 * std::atan2(2 * xz, xx - zz);
        curve.centre = mean;
        curve.direction = {std::cos(angle), std::sin(angle)};
        if (curve.direction.dot(point(0) - point(fit_x_.size() - 1)) < 0) curve.direction = -curve.direction;
        // In units of `size`, so that the equations are as well conditioned at every scale.
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < fit_x_.size(); ++i)
            if (keep_[i]) {
                const double s = curve.along(point(i)) / size;
                const Eigen::Vector3d r(1, s, s * s);
                normal += r * r.transpose();
                right += curve.normal().dot(point(i) - mean) * r;
            }
        const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
        if (!(solver.rcond() > kEndSingular)) return false;
        const Eigen::Vector3d unit(1, 1 / size, 1 / (size * size));
        curve.b = unit.asDiagonal() * Eigen::Vector3d(solver.solve(right));
        curve.cofactor = unit.asDiagonal() * Eigen::Matrix3d(solver.solve(Eigen::Matrix3d::Identity())) *
                         unit.asDiagonal();
        double rss = 0;
        for (std::size_t i = 0; i < fit_x_.size(); ++i)
            if (keep_[i]) rss += curve.residual(point(i)) * curve.residual(point(i));
        const int freedom = used - 3;
        curve.used = used;
        curve.spread_mm2 = xx * curve.direction.x() * curve.direction.x() +
                           2 * xz * curve.direction.x() * curve.direction.y() +
                           zz * curve.direction.y() * curve.direction.y();
        curve.rms_mm = std::sqrt(rss / used);
        curve.sigma_mm = std::sqrt(rss / freedom);
        curve.widening = freedom > 4 ? double(freedom) / (freedom - 2) : 2.0;
        return true;
    }

    double median_residual(const EndCurve& curve) const {
        scratch_.clear();
        for (std::size_t i = 0; i < fit_x_.size(); ++i)
            scratch_.push_back(std::abs(curve.residual(point(i))));
        return end_median(scratch_);
    }

    // Median of up to 16 steps, so a missing return does not count.
    double pitch_at(const EndCurve& curve, const Eigen::Vector2d& tangent, bool rounded) const {
        const std::size_t most = std::min(fit_x_.size(), kEndSteps + 1);
        const auto median_step = [&](const Eigen::Vector2d& direction) {
            scratch_.clear();
            for (std::size_t i = 1; i < most; ++i)
                scratch_.push_back(std::abs(direction.dot(point(i) - point(i - 1))));
            return end_median(scratch_);
        };
        const double pitch = median_step(curve.direction);
        if (!rounded) return pitch;
        const double in_x = median_step(Eigen::Vector2d::UnitX()), advance = std::abs(tangent.x());
        // x advances by |t_x| r - k r^2 / 2 along the arc r.
        const double k = curve.curvature(curve.along(point(0))) * tangent.y() * (tangent.x() < 0 ? -1 : 1);
        const double root = advance * advance - 2 * k * in_x;
        const double arc = k > kEndStraight_rad * advance / fit_length_
                               ? (advance - std::sqrt(std::max(root, 0.0))) / k
                               : in_x / std::max(advance, kEndSmallest_mm);
        return std::clamp(arc, pitch, std::max(pitch, kEndLongestPitch * fit_length_));
    }

    // Few points know their own noise badly, and rounded to a sensor's steps they may all lie on the curve: the profile's
    // noise counts beside them as so many points would.
    void know_noise(EndCurve& curve) const {
        constexpr double kAsMany = 4;
        const double own = std::max(curve.used - (curve.b[2] != 0 ? 3 : 2), 1);
        const double pooled = std::sqrt((own * curve.sigma_mm * curve.sigma_mm +
                                         kAsMany * sheets_.point_noise_mm() * sheets_.point_noise_mm()) /
                                        (own + kAsMany));
        curve.sigma_mm = std::max(curve.sigma_mm, pooled);
        curve.widening = std::min(curve.widening, (own + kAsMany) / (own + kAsMany - 2));
    }

    // Noise of x, from second differences: 0 on an exact grid; the median passes over missing returns.
    double sideways_noise() const {
        scratch_.clear();
        for (std::size_t i = 1; i + 1 < fit_x_.size(); ++i)
            scratch_.push_back(std::abs(fit_x_[i - 1] - 2 * fit_x_[i] + fit_x_[i + 1]));
        return scratch_.size() < kEndFewestRounded ? 0 : kMadToSigma * end_median(scratch_) / std::sqrt(6.0);
    }

    // How far the last points lie off the curve where their mean says that it is not by noise, else 0.
    double end_misfit(const EndCurve& curve) const {
        const std::size_t count = std::min(fit_x_.size(), kEndLastPoints);
        double mean = 0;
        for (std::size_t i = 0; i < count; ++i) mean += curve.residual(point(i)) / double(count);
        if (!(std::abs(mean) > kEndMisfit * curve.sigma_mm / std::sqrt(double(count)))) return 0;
        return std::max(std::abs(mean), std::abs(curve.residual(point(0))));
    }

    // How far beyond the last point the surface may end.
    double reach_beyond(const Profile& profile, bool at_last, const Eigen::Vector2d& tangent, double pitch,
                        double noise) const {
        double reach = pitch;
        const double plain = std::max(kEndLongStep * pitch, pitch + 3 * std::sqrt(2.0) * noise);
        for (std::size_t i = 1; i < std::min<std::size_t>(fit_x_.size(), 3); ++i) {
            const double step = std::abs(tangent.dot(point(i) - point(i - 1)));
            if (step > plain) reach = std::max(reach, step);
        }
        // Where the end stands in the profile.
        const auto lines = static_cast<std::ptrdiff_t>(std::min(profile.x_mm.size(), profile.z_mm.size()));
        const std::ptrdiff_t inwards = at_last ? -1 : 1;
        std::ptrdiff_t end = at_last ? lines - 1 : 0;
        const auto within = [&](std::ptrdiff_t i) { return i >= 0 && i < lines; };
        const auto rejected = [&](std::ptrdiff_t i) {
            return profile.filtered() && profile.segment[std::size_t(i)] == kOutlier;
        };
        while (within(end) && (rejected(end) || profile.x_mm[std::size_t(end)] != fit_x_[0] ||
                               profile.z_mm[std::size_t(end)] != fit_z_[0]))
            end += inwards;
        if (!within(end)) return reach;
        reach = std::max(reach, fading_length(profile, end, inwards));
        bool beside = true;
        for (int i = 1; i <= kEndDoubtfulLines; ++i) {
            const std::ptrdiff_t at = end - i * inwards;
            if (!within(at) || !rejected(at)) break;
            if (!std::isfinite(profile.z_mm[std::size_t(at)])) {
                beside = false;
                continue;
            }
            if (beside) {
                reach += pitch;
                continue;
            }
            // Beyond a line without return it speaks for the surface only where that would go on.
            const Eigen::Vector2d d =
                Eigen::Vector2d(profile.x_mm[std::size_t(at)], profile.z_mm[std::size_t(at)]) - point(0);
            const double ahead = tangent.dot(d), off = tangent.x() * d.y() - tangent.y() * d.x();
            if (ahead > 0 && std::abs(off) < kEndBeside * pitch) reach = std::max(reach, ahead + 0.5 * pitch);
        }
        return reach;
    }

    // I / |dI/ds| of the last return, by a straight line through the intensities from it inwards to where
    // they have come up to three quarters of their upper quartile; 0 where they do not fall.
    double fading_length(const Profile& profile, std::ptrdiff_t end, std::ptrdiff_t inwards) const {
        if (profile.intensity.size() != profile.x_mm.size()) return 0;
        // Intensities of the fit's points: what was gathered, in the same order.
        intensity_.clear();
        for (std::ptrdiff_t i = end; intensity_.size() < fit_x_.size(); i += inwards) {
            if (i < 0 || i >= static_cast<std::ptrdiff_t>(profile.x_mm.size())) return 0;
            const auto at = static_cast<std::size_t>(i);
            if (profile.x_mm[at] == fit_x_[intensity_.size()] &&
                profile.z_mm[at] == fit_z_[intensity_.size()])
                intensity_.push_back(double(profile.intensity[at]));
        }
        scratch_.assign(intensity_.begin(), intensity_.end());
        const auto upper = scratch_.begin() + static_cast<std::ptrdiff_t>(scratch_.size() * 3 / 4);
        std::nth_element(scratch_.begin(), upper, scratch_.end());
        const double full = *upper, at_end = intensity_[0];
        if (!(at_end > 0) || !(at_end < kEndFaded * full)) return 0;
        double n = 0, s = 0, ss = 0, v = 0, sv = 0, arc = 0;
        for (std::size_t i = 0; i < intensity_.size(); ++i) {
            if (i > 0) arc += (point(i) - point(i - 1)).norm();
            n += 1;
            s += arc;
            ss += arc * arc;
            v += intensity_[i];
            sv += arc * intensity_[i];
            if (i >= 2 && intensity_[i] > kEndFull * full) break;
        }
        const double rise = (n * sv - s * v) / (n * ss - s * s);
        return rise > 0 && std::isfinite(rise) ? std::min(at_end / rise, fit_length_) : 0;
    }

    FeatureWindow window_;
    SensorField field_;
    EndRule rule_;
    double fit_length_;
    mutable ContourSheets sheets_;
    mutable std::vector<double> fit_x_, fit_z_, intensity_, scratch_;
    mutable std::vector<std::uint8_t> keep_;
    mutable LineWorkspace workspace_;
};

Expected<std::unique_ptr<FeatureFinder>> make_contour_end(const FeatureRecipe& recipe) {
    const auto infos = contour_end_parameters();
    SEAM_TRY(const auto window, FeatureWindow::from(recipe.parameters, infos));
    auto value = [&](const char* name) { return parameter(recipe.parameters, infos, name); };
    const SensorField field{value("field_x_min_mm"), value("field_x_max_mm")};
    if (!(field.x_min < field.x_max))
        return input_error(Text("a field from x = {} to {} mm is empty", field.x_min, field.x_max),
                           "field_x_min_mm", "give a minimum below the maximum");
    const auto whole = [&](const char* name) { return static_cast<int>(std::lround(value(name))); };
    const EndRule rule{static_cast<EndSide>(whole("side")), static_cast<EndOf>(whole("segment")),
                       whole("order"), whole("minimum_points")};
    return std::make_unique<ContourEnd>(window, field, rule, value("fit_length_mm"));
}

}  // namespace

FeatureKind contour_end_kind() {
    return {"contour-end", "Where the surface stops, seen from the left or the right.",
            contour_end_parameters(), &make_contour_end};
}

}  // namespace seamwright
