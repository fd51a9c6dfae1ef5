// The stripes on the plate and the laser's plane through them.

#include <algorithm>

#include "core/calibration/numbers.h"
#include "core/calibration/statistics.h"
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

// How far the stripe of a view lies off the plane where its corners and the robot put the plate.
StripeOff StripeCameraSolver::off_plane(std::size_t k, const LaserPlane& plane) const {
    const CameraModel camera = camera_of(state_.intrinsics, data_.width, data_.height);
    const Pose& pose = state_.camera_from_target[k];
    const Eigen::Vector3d m = pose.linear().col(2), across = plane.normal.unitOrthogonal();
    std::vector<Eigen::Vector3d> met;
    for (const auto& pixel : bundle_.stripe[k])
        if (const auto p = meet_plate(camera, pixel, pose, state_.shape, bundle_.stripe_on_bow))
            met.push_back(*p);
    if (met.empty()) return {};
    const auto n = static_cast<double>(met.size());
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& p : met) middle += p / n;
    const Eigen::Vector3d along = plane.normal.cross(m).normalized();
    double spread2 = 0;
    for (const auto& p : met) spread2 += std::pow(along.dot(p - middle), 2) / n;
    StripeOff out;
    Eigen::Matrix<double, 2, 6> by_pose = Eigen::Matrix<double, 2, 6>::Zero();
    for (const auto& p : met) {
        const Eigen::Vector2d share =
            Eigen::Vector2d(1, along.dot(p - middle) / std::sqrt(std::max(spread2, 1e-12))) / n;
        out.off_mm += share * (plane.normal.dot(p) + plane.offset_mm);
        out.by_plane += share * Eigen::RowVector3d(across.dot(p), plane.normal.cross(across).dot(p), 1);
        // The ray stays, the plate moves along its normal there.
        Vector6 moves;
        moves << m, (p - pose.translation()).cross(m);
        by_pose += share * (plane.normal.dot(p) / m.dot(p)) * moves.transpose();
    }
    const double rows_mm2 = bundle_.stripe_sigma_mm * bundle_.stripe_sigma_mm / n;
    out.noise_mm2 = rows_mm2 * Eigen::Matrix2d::Identity() +
                    by_pose * fit_.normal.vv[k].ldlt().solve(by_pose.transpose());
    return out;
}

void StripeCameraSolver::look_for_move() {
    one_laser_.assign(count(), 1);
    StripePoints points(count());
    for (std::size_t k = 0; k < count(); ++k) points[k] = points_of(k, choice_[k], true);
    const auto consensus = consensus_plane(points, kOnPlaneMm);
    if (!consensus) return;
    std::vector<StripeOff> frames;
    std::vector<std::size_t> view;
    for (std::size_t k = 0; k < count(); ++k)
        if (!points[k].empty() && !bundle_.stripe[k].empty())
            frames.push_back(off_plane(k, consensus->plane)), view.push_back(k);
    const auto move = find_move(frames);
    if (!move) return;
    const std::size_t after = view[move->first_after], before = view[move->first_after - 1];
    move_ = Move{observations_[view_frame_[before]].id, observations_[view_frame_[after]].id, move->apart_mm};
    const bool later = frames.size() - move->first_after >= move->first_after;
    for (std::size_t k = 0; k < count(); ++k) one_laser_[k] = later == (k >= after);
}

// As a sigma that is known is as wide as this one has to be.
double StripeCameraSolver::between_stripes_mm(const LaserPlane& plane) const {
    std::vector<StripeOff> frames;
    for (std::size_t k = 0; k < count(); ++k)
        if (bundle_.stripe_used[k] && !bundle_.stripe[k].empty()) frames.push_back(off_plane(k, plane));
    const double freedom = 2.0 * static_cast<double>(frames.size()) - 3;
    const double between = between_frames_mm(frames);
    return between > 0 ? between * student_quantile(kUpper95, freedom) / normal_quantile(kUpper95) : 0;
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
    look_for_move();
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
            for (std::size_t k = 0; k < count(); ++k)
                if (one_laser_[k]) points[k] = points_of(k, choice_[k], on_bow);
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
    bundle_.stripe_used = best_used;
    bundle_.stripe_on_bow = best_on_bow;
    // By the plates' poses as they are known without the stripes: as state_ and fit_ still are.
    bundle_.stripe_between_mm = between_stripes_mm(*best->state.plane);
    fit_ = bundle_.stripe_between_mm > 0 ? solve_plate_bundle(bundle_, best->state) : *best;
    state_ = fit_.state;
    if (state_.plane->normal.z() < 0) {
        state_.plane->normal = -state_.plane->normal;
        state_.plane->offset_mm = -state_.plane->offset_mm;
    }
}

}  // namespace seamwright::detail
