#include "projects/calibrate/input/stripe_line_points.h"

#include "core/calibration/lens/bent_line.h"
#include "core/profile/filter.h"

namespace seamwright {

Expected<std::vector<Eigen::Vector2d>> stripe_points(const StripeImage& image, StripePeaks& peaks) {
    SEAM_OK(find_peaks(image, {}, peaks));
    ProfileCandidates candidates;
    candidates.lines = peaks.lines;
    candidates.per_line = peaks.per_line;
    candidates.count = peaks.count;
    candidates.intensity = peaks.intensity;
    candidates.z_mm.assign(peaks.position_px.begin(),
                           peaks.position_px.end());  // the model has no unit: 1 px stands for 1 mm
    candidates.x_mm.resize(candidates.z_mm.size());
    for (int line = 0; line < peaks.lines; ++line)
        for (int k = 0; k < peaks.per_line; ++k)
            candidates.x_mm[static_cast<std::size_t>(peaks.index(line, k))] = line;
    Profile stripe;
    SEAM_OK(track_stripe(candidates, {}, stripe));
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < stripe.size(); ++i)
        if (stripe.segment[i] != kOutlier) points.emplace_back(stripe.x_mm[i], stripe.z_mm[i]);
    return points;
}

std::vector<Eigen::Vector2d> on_the_plate(std::vector<Eigen::Vector2d> points) {
    const std::vector<char> on = on_bent_line(points);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (on[i]) points[kept++] = points[i];
    points.resize(kept);
    return points;
}

}  // namespace seamwright
