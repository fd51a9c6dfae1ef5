// Contour end ("tear-off"; methods.md 2): where the surface stops, seen from the left or the right.
//
// The last return is not the end: the surface ends somewhere between it and the next, missing one. With no
// more known than that, the end is spread evenly over one pitch p, so the estimate is half a pitch beyond the
// last point with variance p^2 / 12 along the contour. Across the contour the point is that of a line fitted
// to the last points (Huber weights), continued to the end: variance of the fit at its end plus nothing for
// the continuation, which assumes that the contour stays straight over half a pitch. Noise across is
// estimated from the fit's residuals.
//
// Degenerate: a contour that runs on beyond the window has no end there (not_found); a segment shorter than
// minimum_points is passed over.

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/features/feature_kinds.h"
#include "core/features/feature_points.h"
#include "core/features/line_fit.h"

namespace seamwright {
namespace {

enum class Side { left, right };
enum class Segment { outermost, longest, highest };

std::vector<ParameterInfo> parameters() {
    return with_window({
        {"side", "", 0, 1, 0, 0, "The side on which the contour ends.", {"left", "right"}},
        {"segment",
         "",
         0,
         2,
         0,
         0,
         "Of several segments in the window: the outermost on that side, the longest, or the highest.",
         {"outermost", "longest", "highest"}},
        {"minimum_points", "", 3, 10000, 6, 0, "Shorter segments are passed over."},
        {"fit_length_mm", "mm", 0.01, 1000, 1.5, 2,
         "Length of contour before its end that says where the line goes."},
    });
}

class ContourEnd final : public FeatureFinder {
  public:
    ContourEnd(FeatureWindow window, Side side, Segment segment, int minimum_points, double fit_length_mm)
        : window_(window),
          side_(side),
          segment_(segment),
          minimum_points_(minimum_points),
          fit_length_(fit_length_mm) {}

    Feature find(const Profile& profile) const override {
        Feature feature;
        points_.gather(profile, window_);
        const double outward = side_ == Side::right ? 1 : -1;
        const FeaturePoints::Piece* chosen = nullptr;
        double best = -std::numeric_limits<double>::infinity();
        for (const auto& piece : points_.pieces) {
            if (piece.count < minimum_points_) continue;
            const int last = piece.first + piece.count - 1;
            double value = 0;
            switch (segment_) {
                case Segment::outermost:
                    value = std::max(outward * points_.x[piece.first], outward * points_.x[last]);
                    break;
                case Segment::longest:
                    value = piece.count;
                    break;
                case Segment::highest:
                    for (int i = piece.first; i <= last; ++i) value += points_.z[i] / piece.count;
                    break;
            }
            if (value > best) {
                best = value;
                chosen = &piece;
            }
        }
        if (!chosen) {
            feature.status = FeatureStatus::no_points;
            feature.message = fmt::format("no segment with {} points in the window", minimum_points_);
            return feature;
        }
        const int first = chosen->first, last = first + chosen->count - 1;
        const bool at_last = outward * points_.x[last] >= outward * points_.x[first];
        if (at_last ? chosen->cut_after : chosen->cut_before) {
            feature.message = "the contour runs on beyond the window on that side";
            return feature;
        }
        // From the end inwards.
        const int step = at_last ? -1 : 1;
        const int end = at_last ? last : first;
        fit_x_.clear();
        fit_z_.clear();
        for (int i = end; i >= first && i <= last; i += step) {
            const double d = std::hypot(points_.x[i] - points_.x[end], points_.z[i] - points_.z[end]);
            if (d > fit_length_ && fit_x_.size() >= 4) break;
            fit_x_.push_back(points_.x[i]);
            fit_z_.push_back(points_.z[i]);
        }
        const LineFit line = fit_line(fit_x_, fit_z_, workspace_);
        if (!line.ok) {
            feature.message = "the points before the end do not form a line";
            return feature;
        }
        // Pitch along the line just before the end: the median of up to 16 steps, so a missing return does
        // not count.
        steps_.clear();
        const auto along = [&](std::size_t i) {
            return line.direction.dot(Eigen::Vector2d(fit_x_[i], fit_z_[i]));
        };
        const std::size_t most = std::min<std::size_t>(fit_x_.size(), 17);
        for (std::size_t i = 1; i < most; ++i) steps_.push_back(std::abs(along(i) - along(i - 1)));
        const auto middle = steps_.begin() + static_cast<std::ptrdiff_t>(steps_.size() / 2);
        std::nth_element(steps_.begin(), middle, steps_.end());
        const double pitch = *middle;
        const double inner = along(fit_x_.size() - 1), outer = along(0);
        const double towards = outer >= inner ? 1 : -1;
        const double s = outer + towards * 0.5 * pitch - line.direction.dot(line.centre);
        feature.point_mm = line.centre + s * line.direction;
        const Eigen::Vector2d normal(-line.direction.y(), line.direction.x());
        // A sensor's noise is in z: on a slope it moves the last point along the line as well.
        const double slope = line.direction.x() != 0 ? std::abs(line.direction.y() / line.direction.x()) : 1;
        const double noise_along = line.sigma_mm * std::min(slope, 1.0);
        feature.covariance_mm2 =
            line.variance_at(s) * normal * normal.transpose() +
            (pitch * pitch / 12 + noise_along * noise_along) * line.direction * line.direction.transpose();
        feature.rms_mm = line.rms_mm;
        feature.points_used = line.used;
        feature.status = FeatureStatus::ok;
        return feature;
    }

  private:
    FeatureWindow window_;
    Side side_;
    Segment segment_;
    int minimum_points_;
    double fit_length_;
    mutable FeaturePoints points_;
    mutable std::vector<double> fit_x_, fit_z_, steps_;
    mutable LineWorkspace workspace_;
};

Expected<std::unique_ptr<FeatureFinder>> make(const FeatureRecipe& recipe) {
    const auto infos = parameters();
    const auto window = FeatureWindow::from(recipe.parameters, infos);
    if (!window) return tl::unexpected(window.error());
    auto value = [&](const char* name) { return parameter(recipe.parameters, infos, name); };
    return std::make_unique<ContourEnd>(*window, static_cast<Side>(std::lround(value("side"))),
                                        static_cast<Segment>(std::lround(value("segment"))),
                                        static_cast<int>(std::lround(value("minimum_points"))),
                                        value("fit_length_mm"));
}

}  // namespace

FeatureKind contour_end_kind() {
    return {"contour-end", "Where the surface stops, seen from the left or the right.", parameters(), &make};
}

}  // namespace seamwright
