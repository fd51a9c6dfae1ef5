// The stripes on the plate and the laser's plane through them.

#include <algorithm>

#include "core/calibration/stripe/stripe_camera_solver.h"
#include "core/calibration/stripe/stripe_plane.h"

namespace seamwright::detail {

// Stripes of the plate: on every frame the line that agrees with the plane of the others, else the
// longest one.
void StripeCameraSolver::locate_stripes() {
    const CameraModel camera = camera_of(state_.intrinsics, data_.width, data_.height);
    const double f = 0.5 * (camera.fx + camera.fy);
    // Of the straight line that a stripe's points lie on; points of a second line that takes the first one's place.
    constexpr double kStripeWithin_px = 6;
    constexpr std::size_t kFewestOnOther = 100;
    lines_.assign(count(), {});
    for (std::size_t k = 0; k < count(); ++k) {
        const auto& o = observations_[view_frame_[k]];
        std::vector<Eigen::Vector2d> straight;
        std::vector<int> line;
        for (const auto& p : o.stripe) {
            straight.push_back(f * camera.undistort(p));
            line.push_back(static_cast<int>(std::lround(o.scan == ScanLines::rows ? p.y() : p.x())));
        }
        lines_[k] = stripe_lines(straight, line, kStripeWithin_px, 2);
    }
    choice_.assign(count(), 0);
    StripePoints points(count());
    for (std::size_t k = 0; k < count(); ++k) points[k] = points_of(k, 0, true);
    const auto consensus = consensus_plane(points, kOnPlaneMm);
    if (!consensus) return;
    for (std::size_t k = 0; k < count(); ++k)
        if (!consensus->frames[k] && lines_[k].size() > 1) {
            const auto other = points_of(k, 1, true);
            if (lines_[k][1].on.size() > kFewestOnOther &&
                median_off_plane(consensus->plane, other) < kOnPlaneMm)
                choice_[k] = 1;
        }
}

std::vector<Eigen::Vector3d> StripeCameraSolver::points_of(std::size_t k, std::size_t choice,
                                                           bool on_bow) const {
    std::vector<Eigen::Vector3d> out;
    if (choice >= lines_[k].size()) return out;
    const CameraModel camera = camera_of(state_.intrinsics, data_.width, data_.height);
    for (const auto i : lines_[k][choice].on)
        if (const auto p = meet_plate(camera, observations_[view_frame_[k]].stripe[i],
                                      state_.camera_from_target[k], state_.shape, on_bow))
            out.push_back(*p);
    return out;
}

// Joint solution with the stripes, on the bowed surface and on its tangent plane; the better one stays.
void StripeCameraSolver::refine_with_stripe() {
    bundle_.stripe.assign(count(), {});
    for (std::size_t k = 0; k < count(); ++k)
        if (choice_[k] < lines_[k].size()) {
            const auto& on = lines_[k][choice_[k]].on;
            const std::size_t step = std::max<std::size_t>(1, on.size() / 40);
            for (std::size_t i = step / 2; i < on.size(); i += step)
                bundle_.stripe[k].push_back(observations_[view_frame_[k]].stripe[on[i]]);
        }
    const PlateBundleState before = state_;
    std::optional<PlateBundleFit> best;
    std::vector<char> best_used;
    bool best_on_bow = false;
    for (const bool on_bow : {false, true}) {
        if (on_bow && model_.shape != ShapeFreedom::bowed) continue;
        state_ = before;
        bundle_.stripe_on_bow = on_bow;
        std::optional<PlateBundleFit> fit;
        std::vector<char> last;
        for (int round = 0; round < 4; ++round) {
            StripePoints points(count());
            for (std::size_t k = 0; k < count(); ++k) points[k] = points_of(k, choice_[k], on_bow);
            const auto consensus = consensus_plane(points, kOnPlaneMm);
            if (!consensus) break;
            if (round > 0 && consensus->frames == last) break;
            last = consensus->frames;
            if (std::count(last.begin(), last.end(), 1) < 2) break;
            state_.plane = consensus->plane;
            bundle_.stripe_used = last;
            fit = solve_plate_bundle(bundle_, state_);
            state_ = fit->state;
        }
        if (!fit) continue;
        const auto frames = std::count(bundle_.stripe_used.begin(), bundle_.stripe_used.end(), 1);
        const auto best_frames = best ? std::count(best_used.begin(), best_used.end(), 1) : 0;
        if (!best || frames > best_frames || (frames == best_frames && fit->cost < best->cost)) {
            best = fit;
            best_used = bundle_.stripe_used;
            best_on_bow = on_bow;
        }
    }
    state_ = before;
    if (!best) return;
    fit_ = *best;
    state_ = fit_.state;
    bundle_.stripe_used = best_used;
    bundle_.stripe_on_bow = best_on_bow;
    if (state_.plane->normal.z() < 0) {
        state_.plane->normal = -state_.plane->normal;
        state_.plane->offset_mm = -state_.plane->offset_mm;
    }
}

}  // namespace seamwright::detail
