#pragma once
// Edges that do not run along the travel, where no pass told their course: what that does to a displacement.

#include <Eigen/Core>
#include <span>

#include "core/correction/wrong_spots.h"

namespace seamwright::correction {

// A spot without a curve takes its edge for straight along Y. One that runs off by the slopes (a, b) moves its measure by slide
// times (a, b) once the part has slid along the travel. Nobody knows a and b, but the residuals do when many are off: with
// independent slopes of variance t^2, the sum of squares exceeds its degrees by t^2 times sum tr(R_n S_n / sigma^2), R_n the share
// of the spot's own noise that its residual keeps and S_n = slide^2 I, along the axes observed.
struct UnseenCourse {
    double slope = 0;                 // t, rad; at most 3.5 degrees, as of edges anywhere within 6
    Matrix6 added = Matrix6::Zero();  // to the covariance of the displacement, in xi
    explicit operator bool() const { return slope > 0; }
};
inline constexpr double kNoticedSlide_mm = 1;
// Nothing where the residuals are as usual (beyond 1 %), and where weights are other than 0 and 1. `slide_mm` of every spot: 0 where the course is known. `spread` and `all`: of the
// fit with the used spots.
UnseenCourse unseen_course(const RegionSystem& system, const RegionSystem::Fit& fit, const Spread& spread,
                           std::span<const double> factor, std::span<const double> slide_mm,
                           const Agreement& all);

}  // namespace seamwright::correction
