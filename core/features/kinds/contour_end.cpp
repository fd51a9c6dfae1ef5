// Contour end ("tear-off"; methods.md 2): where the surface stops, seen from the left or the right.
//
// The point. Through the last points before the end, up to fit_length_mm, goes a line, or an arc of a circle where the
// contour is rounded there, as far as the points say so: several curves, each by its weight (end_curve.h); through those of 0.65 or
// 0.42 of that length where more is none of them and they say better where the last point is.
// The last return is not the end: the surface ends somewhere between it and the next, missing one. The point
// lies half a pitch p beyond the last point on that curve. p is the median step; on an arc the sensor's
// steps grow as the surface turns away, so there p is the arc in which the curve advances by the median step
// in x, or comes to its vertical tangent, at most half of fit_length_mm. Two things put it farther out, in the middle of
// what may hold the end, q long instead of p:
//     - points that stand in a step behind the end and on neither sheet: as far as the farthest of them stands ahead;
//     - an even grid of x whose noise runs from point to point: a sensor measured points f pitches apart and laid them on
//       the grid (ContourNoise), so that the surface ends up to f p beyond what was measured last.
// And where a share q of the lines within the sheet has no return (q beyond 0.01), so may the last ones: their mean number is
// m = q / (1 - q), and the point lies m p farther out.
//
// Its covariance, along the tangent at the point and across it, of the likeliest curve, and beside it how far the curves end
// apart. Noise model: independent, equal, across the
// contour, its sigma from the fit's residuals, and not below what the profile's noise beside them makes likely; of
// interpolated points 1.5 f times the variance, or what the residuals' likeness says (contour_noise.h).
//     across   v + (k h^2 / 2)^2 + e^2 + d^2 + u n_z^2,   v the curves' mean there, h = r - q / 2, k the curvature
//     along    (r^2 - 2 f p^2) / 12 + (r - q)^2 / 4 + noise^2 + s l^2 + g^2 / 36 + (w p n_x^2)^2 + m (1 + m) p^2
// k h^2 / 2: beyond the last point the contour may bend on or go on straight. e, other shape than an
// arc: the larger of the residuals' cubic part at the point, without what noise makes of it, and the
// distance of the last point when the mean of the last three is more than 2.5 sigma / sqrt(3) off. d: a sensor that gives
// means of neighbours (ProfileNoise::apart()), of w points on either side, has at the end only such of points inwards, which
// draws the curve that way where the contour slopes; and on a bend every one lies k (w p)^2 / 6 on the inner side. Where more than
// four lines share their noise the contour seems half as steep there (d as for twice that slope), and the last point is drawn
// along it, w p n_x^2; of fewer that term is 0, light on a rough surface is shared as far. u: of the rounding of z
// (contour_noise.h) what the residuals do not show, for on a level sheet all points are rounded alike; n the normal.
// The end is spread evenly over the reach r from the last point on. A plain end: r = q = p, hence p^2 / 12; an interpolated
// one is spread over p and over f p, narrower than evenly over both. Else the largest of
//     - the last two steps, when longer than 1.5 p and than noise makes them: returns are missing there;
//     - the fading length I / |dI/ds|, when the last return's intensity I is less than 0.6 of the upper
//       quartile of the fit's points: that far beyond it the light is gone, and any threshold below I ends
//       the returns in between (only where the sensor gives intensities);
// and longer by p for each of the lines beyond the end, up to six, whose return the filter rejected: they do
// not say that the surface has ended; behind a line without return or with another sheet's only where they stand within
// three p of the contour's continuation. noise: that in z moves the last point along a sloping contour as well, that in x
// (second differences of x; none on an even grid) along every one.
//
// s, 0 at 65 degrees and 1 at 73: an arc that turns away until the light grazes it. l = 2.5 degrees of it: the angle at which
// there is too little light for a return scatters with the surface. g: an even grid may have been interpolated from points up to
// 0.9 of its own steps apart without showing it, and the contour may have gone on so much farther; as if one in six had been.
//
// What is systematic stays: where light grazes a rounded rim, returns stop before the silhouette, at the
// teaching as at the measuring. On a fold of 1.15 mm radius that is 0.15 mm; it repeats within the
// covariance. An arc of fewer than about six points is seen by chance. An interpolation from points that are
// closer than the grid's is not seen: there the end lies up to half a pitch farther out than found, in the mean.
//
// Which end is meant: choose_end() (end_choice.h). Degenerate: a contour that runs on beyond the window,
// leaves the sensor's field or runs under a higher one has no end there (not_found); a sheet shorter than
// minimum_points is passed over; fewer than 6 points within fit_length_mm, or all of them in one place, know
// no curvature.

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/features/end/end_choice.h"
#include "core/features/end/end_curve.h"
#include "core/features/kinds/feature_kinds.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kEndSmallest_mm = 1e-9;
constexpr std::size_t kEndFewestSteps = 6;  // that know the noise of x
constexpr std::size_t kEndSteps = 16;       // before the end, for the pitch
constexpr double kEndStraight_rad = 1e-3;   // turned over the fit: less is straight
constexpr double kEndLongestPitch = 0.5;    // of fit_length_mm
constexpr double kEndFaded = 0.6;           // of the intensity before the end
constexpr double kEndLongStep = 1.5;        // pitches
constexpr std::size_t kEndLastPoints = 3;
constexpr int kEndDoubtfulLines = 6;
constexpr double kEndBeside = 3;  // pitches
// Interpolated between points that were measured f pitches apart, n of them are worth n / (1.5 f).
constexpr double kEndDependent = 1.5;
constexpr double kEndShared = 3.8;                // lines: fewer share their noise by light
constexpr double kEndAlone = 0.25;                // points on either side: less is no mean
constexpr double kEndMisfit = 2.5;                // sigma of the last points' mean
constexpr double kEndShares[] = {1, 0.65, 0.42};  // of fit_length_mm, where more is no arc
constexpr double kEndFewestShort = 6;             // points of such a part that do not share their noise
// Of a contour against the line of the sensor: from where on the light grazes it, where it does for certain; how much the
// angle scatters (sigma) at which the returns stop.
constexpr double kEndGrazed_rad = 1.13, kEndGrazing_rad = 1.27, kEndLight_rad = 0.044;
constexpr double kEndEven = 1e-4;  // steps: less is rounding
// Pitches of an interpolation that its noise does not show; of the square of that: one even grid in six is such a one.
constexpr double kEndUnseenApart = 0.9, kEndUnseenVariance = 1.0 / 36;
constexpr double kEndSeldomLost = 0.01, kEndMostLost = 0.5;  // share of lines
constexpr double kEndFull = 0.75;  // of the intensities' upper quartile: as bright as before the end

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
        {"every_line",
         "",
         0,
         1,
         0,
         0,
         "Whether profiles list every line of the field, also those without a return: then the first and the "
         "last line are its "
         "rims, where nothing ends.",
         {"unknown", "yes"}},
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
        fit_end(*chosen);
        if (curves_.empty()) {
            feature.message = "the points before the end do not form a line";
            return feature;
        }
        const double apart = sheets_.noise().measured_apart;
        const double interpolated = std::max(1.0, kEndDependent * apart);
        for (EndCurve& curve : curves_) {
            curve.sigma_mm *= std::sqrt(interpolated);
            curve.alike = std::max(1.0, curve.alike / interpolated);
        }
        const EndCurve& curve = curves_.front();
        const double mixed_ahead = step_ahead(profile, chosen->mixed, curve.tangent(curve.along(point(0))));
        // The mean over the curves, and how far they differ.
        double v = 0, unseen = 0;
        feature.point_mm.setZero();
        for (const EndCurve& each : curves_) {
            const Beyond beyond = beyond_last(each, mixed_ahead, apart);
            feature.point_mm += each.weight * each.at(beyond.s);
            v += each.weight * each.variance_at(beyond.s);
            unseen += each.weight * beyond.unseen * beyond.unseen;
        }
        Eigen::Matrix2d differ = Eigen::Matrix2d::Zero();
        for (const EndCurve& each : curves_) {
            const Eigen::Vector2d d = each.at(beyond_last(each, mixed_ahead, apart).s) - feature.point_mm;
            differ += each.weight * d * d.transpose();
        }
        const bool rounded = curve.curvature != 0;
        const auto [s, step, pitch, measured, unseen_of_best] = beyond_last(curve, mixed_ahead, apart);
        const double last_s = curve.along(point(0));
        const Eigen::Vector2d tangent = curve.tangent(s), normal(-tangent.y(), tangent.x());

        // Noise in z moves the last point along a sloping contour as well, noise in x along every one.
        const Eigen::Vector2d chord = curve.chord;
        const double slope = chord.x() != 0 ? std::abs(chord.y() / chord.x()) : 1;
        const double upright =
            rounded ? curve.sigma_mm / std::max(std::abs(chord.x()), 0.5) * std::abs(tangent.y())
                    : curve.sigma_mm * std::min(slope, 1.0);
        const double noise = std::hypot(upright, sideways_noise() * tangent.x());
        const double reach = std::max(reach_beyond(profile, at_last, tangent, pitch, noise), step);
        // Continued to the end of the reach, the contour may bend on or go on straight.
        const double continued = std::max(reach - 0.5 * step, 0.5 * step);
        const double bend = 0.5 * curve.curvature * continued * continued;
        const double misfit = std::max(std::abs(curve.cubic_misfit.dot(curve.powers(s))), end_misfit(curve));
        const double skew = drawn_off(curve, pitch, s);
        const double across = v + bend * bend + misfit * misfit + skew * skew +
                              sheets_.noise().shared_rounding_mm2(curve.rms_mm) * normal.y() * normal.y();
        const double grazing = rounded ? grazing_variance(curve, curve.tangent(last_s), pitch) : 0;
        const double along = (reach * reach - 2 * pitch * measured) / 12 +
                             (reach - step) * (reach - step) / 4 + noise * noise + grazing +
                             lost_lines() * (1 + lost_lines()) * pitch * pitch + kEndUnseenVariance * unseen +
                             drawn_along(pitch, tangent);
        feature.covariance_mm2 =
            across * normal * normal.transpose() + along * tangent * tangent.transpose() + differ;
        feature.rms_mm = curve.rms_mm;
        feature.points_used = curve.used;
        feature.status = FeatureStatus::ok;
        return feature;
    }

  private:
    Eigen::Vector2d point(std::size_t i) const { return {fit_x_[i], fit_z_[i]}; }

    // Through the points within fit_length_ of the end; through fewer where those are other than a line or an arc (a hem and
    // the flat before it) and these say better where the last point is. An arc is not given up for a line.
    void fit_end(const ChosenEnd& end) const {
        const double fewest = kEndFewestShort * sheets_.noise().apart();
        double best_length = fit_length_, least = 0, tried = fit_length_;
        curves_.clear();
        for (const double share : kEndShares) {
            const double length = share * fit_length_;
            take_end(end, length);
            if (share < 1 && double(fit_x_.size()) < fewest) break;
            tried = length;
            const std::span<const EndCurve> fit = fit_.fit(fit_x_, fit_z_, sheets_.noise(), end.covered);
            if (fit.empty()) break;
            const EndCurve& curve = fit.front();
            const double s = curve.along(point(0));
            const double misfit =
                std::max(std::abs(curve.cubic_misfit.dot(curve.powers(s))), end_misfit(curve));
            const double doubt = curve.variance_at(s) + misfit * misfit;
            if (curves_.empty() ||
                (doubt < least && (curve.curvature != 0 || curves_.front().curvature == 0))) {
                curves_.assign(fit.begin(), fit.end());
                best_length = length;
                least = doubt;
            }
            if (!(misfit * misfit > curve.variance_at(s))) break;
        }
        if (best_length != tried || double(fit_x_.size()) < fewest) take_end(end, best_length);
    }

    // Where the curve ends, s: half a `step` beyond the last point, all along it; `measured` of the step for an interpolation
    // that is seen; `unseen`, how much farther it may have gone for one that is not.
    struct Beyond {
        double s, step, pitch, measured, unseen;
    };
    // Where a share of the lines has no return, so may the last ones of the surface: their mean number, and its variance.
    double lost_lines() const {
        const double q = std::clamp(sheets_.lost_share() - kEndSeldomLost, 0.0, kEndMostLost);
        return q / (1 - q);
    }
    Beyond beyond_last(const EndCurve& curve, double mixed_ahead, double apart) const {
        const double last = curve.along(point(0));
        const double pitch = pitch_at(curve, curve.tangent(last));
        const double measured = apart * pitch, step = pitch + mixed_ahead + measured;
        const double unseen = unseen_beyond(curve, curve.tangent(last), pitch, apart);
        return {last + 0.5 * step + lost_lines() * pitch, step, pitch, measured, unseen};
    }

    // The points within `length` of the end, from the end inwards.
    void take_end(const ChosenEnd& chosen, double length) const {
        const int step = chosen.at_last ? -1 : 1;
        const int end = chosen.at_last ? chosen.last : chosen.first;
        fit_x_.clear();
        fit_z_.clear();
        for (int i = end; i >= chosen.first && i <= chosen.last; i += step) {
            const double d = std::hypot(sheets_.x()[i] - sheets_.x()[end], sheets_.z()[i] - sheets_.z()[end]);
            if (d > length && fit_x_.size() >= 4) break;
            fit_x_.push_back(sheets_.x()[i]);
            fit_z_.push_back(sheets_.z()[i]);
        }
    }

    // Median of up to 16 steps, so a missing return does not count.
    double pitch_at(const EndCurve& curve, const Eigen::Vector2d& tangent) const {
        const std::size_t most = std::min(fit_x_.size(), kEndSteps + 1);
        const auto median_step = [&](const Eigen::Vector2d& direction) {
            scratch_.clear();
            for (std::size_t i = 1; i < most; ++i)
                scratch_.push_back(std::abs(direction.dot(point(i) - point(i - 1))));
            return median(scratch_);
        };
        const double pitch = median_step(curve.direction);
        if (curve.curvature == 0) return pitch;
        return std::clamp(arc_over(median_step(Eigen::Vector2d::UnitX()), curve, tangent), pitch,
                          std::max(pitch, kEndLongestPitch * fit_length_));
    }

    // How fast the arc turns away from the sensor beyond `tangent`, 1/mm; negative: it turns back.
    static double turning_away(const EndCurve& curve, const Eigen::Vector2d& tangent) {
        return std::copysign(std::abs(curve.curvature),
                             curve.curvature * tangent.y() * (tangent.x() < 0 ? -1 : 1));
    }
    // The arc beyond `tangent` over which it advances by `in_x`, or comes to its vertical tangent. The advance along an arc a
    // that turns away by c: (sin(steep + c a) - sin(steep)) / c.
    double arc_over(double in_x, const EndCurve& curve, const Eigen::Vector2d& tangent) const {
        const double advance = std::abs(tangent.x()), steep = std::acos(std::min(advance, 1.0));
        const double turning = turning_away(curve, tangent);
        return turning > kEndStraight_rad * advance / fit_length_
                   ? (std::asin(std::min(std::sin(steep) + turning * in_x, 1.0)) - steep) / turning
                   : in_x / std::max(advance, kEndSmallest_mm);
    }

    // Noise of x, from second differences: 0 on an exact grid; the median passes over missing returns.
    double sideways_noise() const {
        scratch_.clear();
        for (std::size_t i = 1; i + 1 < fit_x_.size(); ++i)
            scratch_.push_back(std::abs(fit_x_[i - 1] - 2 * fit_x_[i] + fit_x_[i + 1]));
        return scratch_.size() < kEndFewestSteps ? 0 : kMadToSigma * median(scratch_) / std::sqrt(6.0);
    }

    // Where an arc turns away to a steep end: the angle at which there is too little light for a return scatters with the
    // surface.
    double grazing_variance(const EndCurve& curve, const Eigen::Vector2d& tangent, double pitch) const {
        const double turning = turning_away(curve, tangent);
        const double steep = std::acos(std::min(std::abs(tangent.x()), 1.0)) + turning * pitch;
        const double share =
            std::clamp((steep - kEndGrazed_rad) / (kEndGrazing_rad - kEndGrazed_rad), 0.0, 1.0);
        if (!(turning > 0) || !(share > 0)) return 0;
        const double light = std::min(kEndLight_rad / turning, kEndLongestPitch * fit_length_);
        return share * light * light;
    }

    // How much farther the curve may have gone on: an even grid may have been laid over points that are nearly as far apart
    // as its own, without the noise showing it.
    double unseen_beyond(const EndCurve& curve, const Eigen::Vector2d& tangent, double pitch,
                         double apart) const {
        if (!(sideways_noise() < kEndEven * pitch) || !(apart < kEndUnseenApart)) return 0;
        scratch_.clear();
        for (std::size_t i = 1; i < std::min(fit_x_.size(), kEndSteps + 1); ++i)
            scratch_.push_back(std::abs(fit_x_[i] - fit_x_[i - 1]));
        const double in_x = median(scratch_);
        return std::min(arc_over((1 + kEndUnseenApart) * in_x, curve, tangent) -
                            arc_over((1 + apart) * in_x, curve, tangent),
                        kEndLongestPitch * fit_length_);
    }

    // How far across the curve the point at s is drawn off by means of neighbours: those at the end are of points inwards
    // alone, and on a bend every one lies on the inner side.
    double drawn_off(const EndCurve& curve, double pitch, double s) const {
        const double half = 0.5 * (sheets_.noise().apart() - 1);  // points on either side that a mean is of
        if (!(half > kEndAlone)) return 0;
        const Eigen::Vector3d weights = curve.cofactor * curve.powers(s).head<3>();
        const double drawn = 0.5 + 0.5 * mean_for_certain();
        double off = 0;
        for (std::size_t i = 0; double(i) < half && i < fit_x_.size(); ++i) {
            const double at = curve.along(point(i)), inwards = drawn * (half - double(i)) * pitch;
            const Eigen::Vector2d tangent = curve.tangent(at);
            off += weights.dot(curve.powers(at).head<3>()) * inwards * std::abs(tangent.x() * tangent.y());
        }
        return std::hypot(off, curve.curvature * half * half * pitch * pitch / 6);
    }

    // 0 to 1. Light on a rough surface is shared by three or four lines as well, and draws nothing off.
    double mean_for_certain() const { return std::clamp(sheets_.noise().apart() - kEndShared, 0.0, 1.0); }

    // The square of how far the last point is drawn along the contour: by neighbours inwards alone.
    double drawn_along(double pitch, const Eigen::Vector2d& tangent) const {
        const double half = 0.5 * (sheets_.noise().apart() - 1);
        if (!(half > kEndAlone)) return 0;
        const double inwards = mean_for_certain() * half * pitch * tangent.y() * tangent.y();
        return inwards * inwards;
    }

    // Where points stand in the step behind the end, it may be anywhere up to the farthest of them: how far that stands ahead.
    double step_ahead(const Profile& profile, int mixed, const Eigen::Vector2d& tangent) const {
        if (mixed < 0) return 0;
        const auto line = static_cast<std::size_t>(mixed);
        const double ahead = tangent.dot(Eigen::Vector2d(profile.x_mm[line], profile.z_mm[line]) - point(0));
        return ahead > 0 && ahead < fit_length_ ? ahead : 0;
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
            if (!within(at)) break;
            if (!rejected(at) || !std::isfinite(profile.z_mm[std::size_t(at)])) {
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
    mutable EndFit fit_;
    mutable std::vector<EndCurve> curves_;
};

Expected<std::unique_ptr<FeatureFinder>> make_contour_end(const FeatureRecipe& recipe) {
    const auto infos = contour_end_parameters();
    SEAM_TRY(const auto window, FeatureWindow::from(recipe.parameters, infos));
    auto value = [&](const char* name) { return parameter(recipe.parameters, infos, name); };
    const SensorField field{value("field_x_min_mm"), value("field_x_max_mm"), value("every_line") > 0.5};
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
