#include "core/calibration/camera/plate_bundle.h"

#include <ceres/normal_prior.h>

#include <cmath>

#include "core/calibration/camera/camera_costs.h"
#include "core/calibration/problem.h"
#include "core/numbers.h"

namespace seamwright {

std::optional<Eigen::Vector3d> meet_plate(const CameraModel& camera, const Eigen::Vector2d& pixel,
                                          const Pose& camera_from_target, const PlateShape& shape,
                                          bool on_bow) {
    const Eigen::Vector3d ray = camera.undistort(pixel).homogeneous();
    if (!ray.allFinite()) return std::nullopt;
    const Eigen::Vector3d normal = camera_from_target.linear().col(2);
    const double along = normal.dot(ray);
    constexpr double kAlongPlate = 1e-3;  // sine between ray and plate, below which they do not meet
    if (std::abs(along) < kAlongPlate * ray.norm()) return std::nullopt;
    const double base = normal.dot(camera_from_target.translation());
    double s = base / along;
    const auto bent = shape.numbers();
    if (on_bow && !shape.bow_mm.isZero())
        for (int i = 0; i < 8; ++i) {
            const Eigen::Vector3d q = camera_from_target.inverse() * (s * ray);
            s = (base + shape.height(bent.data(), q.x(), q.y())) / along;
        }
    if (!(s > 0) || !std::isfinite(s)) return std::nullopt;
    return s * ray;
}

namespace {

constexpr double kRobustSigmas = 3;  // a reflection must not pull the plane

// The unknowns as blocks, and the problem of what was seen of them.
class Bundle {
  public:
    Bundle(const PlateBundle& seen, const PlateBundleState& start, PlateBundleFit& fit)
        : seen_(seen),
          data_(*seen.data),
          state_(start),
          robot_(start.flange_from_camera && start.base_from_target) {
        k_ = start.intrinsics;
        shape_ = start.shape.numbers();
        if (seen.shape == ShapeFreedom::rigid) shape_.head<2>().setZero();
        if (seen.shape != ShapeFreedom::bowed) shape_.tail<3>().setZero();
        for (const Pose& pose : start.camera_from_target) poses_.push_back(block_of(pose));
        for (PoseBlock& pose : poses_) views_.push_back(pose.data());
        add_camera(fit);
        add_shape(fit);
        if (robot_) {
            hand_eye_ = block_of(*start.flange_from_camera);
            target_ = block_of(*start.base_from_target);
            fit.hand_eye_at = add(hand_eye_.data(), 7, pose_manifold(), 6);
            fit.target_at = add(target_.data(), 7, pose_manifold(), 6);
        }
        if (start.plane) {
            plane_ << start.plane->normal, start.plane->offset_mm;
            fit.plane_at = add(plane_.data(), 4, plane_manifold(), 3);
        }
        for (std::size_t i = 0; i < data_.views.size(); ++i)
            if (seen.view_used.empty() || seen.view_used[i]) add_view(i);
    }

    void solve(PlateBundleFit& fit) {
        constexpr double kGainSettled = 1e-10;  // relative gain in cost that ends it
        const Solved solved = seamwright::solve(problem_, views_, 100, kGainSettled);
        fit.converged = solved.converged;
        fit.cost = solved.cost;
        fit.normal = normal_blocks(problem_, shared_, views_);
        state_.intrinsics = k_;
        state_.shape.stretch = shape_(0);
        state_.shape.shear = shape_(1);
        state_.shape.bow_mm = shape_.tail<3>();
        for (std::size_t i = 0; i < poses_.size(); ++i)
            if (problem_.HasParameterBlock(views_[i])) state_.camera_from_target[i] = pose_of(poses_[i]);
        if (robot_) {
            state_.flange_from_camera = pose_of(hand_eye_);
            state_.base_from_target = pose_of(target_);
        }
        if (state_.plane) state_.plane = LaserPlane{plane_.head<3>(), plane_(3)};
        fit.state = state_;
        measure(fit);
    }

  private:
    Eigen::Index add(double* block, int size, ceres::Manifold* manifold, Eigen::Index moves) {
        problem_.AddParameterBlock(block, size, manifold);
        shared_.push_back(block);
        const Eigen::Index at = next_;
        next_ += moves;
        return at;
    }

    void add_camera(PlateBundleFit& fit) {
        const Intrinsics held_at = conform(k_, seen_.freedom, data_.width, data_.height);
        fit.basis = freedom_basis(seen_.freedom);
        HeldIntrinsics held;
        if (seen_.hold_exactly) {
            k_ = held_at;
        } else {
            held = held_intrinsics(seen_.freedom, 0.5 * (held_at(0) + held_at(1)), data_.width);
            fit.basis.conservativeResize(9, fit.basis.cols() + held.sigma.size());
            fit.basis.rightCols(held.sigma.size()) = held.directions;
        }
        add(k_.data(), 9, linear_manifold(fit.basis), fit.basis.cols());
        if (held.sigma.size() == 0) return;
        const Eigen::VectorXd per_sigma =
            (held.directions.colwise().squaredNorm().transpose().cwiseProduct(held.sigma)).cwiseInverse();
        problem_.AddResidualBlock(
            new ceres::NormalPrior(per_sigma.asDiagonal() * held.directions.transpose(), held_at), nullptr,
            k_.data());
    }

    void add_shape(PlateBundleFit& fit) {
        if (seen_.shape == ShapeFreedom::rigid) {
            problem_.AddParameterBlock(shape_.data(), 5);
            problem_.SetParameterBlockConstant(shape_.data());
        } else if (seen_.shape == ShapeFreedom::in_plane) {
            fit.shape_at = add(shape_.data(), 5, new ceres::SubsetManifold(5, {2, 3, 4}), 2);
        } else {
            fit.shape_at = add(shape_.data(), 5, nullptr, 5);
        }
    }

    void add_view(std::size_t i) {
        double* pose = views_[i];
        problem_.AddParameterBlock(pose, 7, pose_manifold());
        const CameraPoints view = used_of(i);
        std::vector<camera_costs::Corner> corners;
        for (std::size_t k = 0; k < view.pixel.size(); ++k)
            corners.push_back({view.object_mm[k], view.pixel[k], 1 / seen_.corner_sigma_px});
        if (!corners.empty())
            problem_.AddResidualBlock(camera_costs::corners(std::move(corners), state_.shape), nullptr,
                                      k_.data(), shape_.data(), pose);
        if (robot_ && seen_.base_from_flange[i])
            problem_.AddResidualBlock(
                camera_costs::robot(*seen_.base_from_flange[i], seen_.robot_sigma_mm, seen_.robot_sigma_rad),
                nullptr, hand_eye_.data(), target_.data(), pose);
        if (!has_stripe(i)) return;
        // Rows that err alike count as few as tell their mean as badly.
        const double alike = 1 + std::pow(seen_.stripe_between_mm / seen_.stripe_sigma_mm, 2) *
                                     static_cast<double>(seen_.stripe[i].size());
        for (const auto& pixel : seen_.stripe[i])
            problem_.AddResidualBlock(
                camera_costs::stripe(pixel, state_.shape, seen_.stripe_on_bow, data_.width, data_.height,
                                     seen_.stripe_sigma_mm),
                new ceres::ScaledLoss(new ceres::HuberLoss(kRobustSigmas), 1 / alike, ceres::TAKE_OWNERSHIP),
                k_.data(), shape_.data(), plane_.data(), pose);
    }

    CameraPoints used_of(std::size_t view) const {
        return chosen(data_.views[view],
                      seen_.point_used.empty() ? std::vector<char>{} : seen_.point_used[view]);
    }
    bool has_stripe(std::size_t view) const {
        return state_.plane && view < seen_.stripe.size() && seen_.stripe_used[view];
    }

    // What remains, each in its own unit.
    void measure(PlateBundleFit& fit) const {
        const CameraModel camera = camera_of(k_, data_.width, data_.height);
        double robot_mm2 = 0, robot_rad2 = 0, stripe_mm2 = 0;
        std::size_t robot_views = 0, rows = 0;
        for (std::size_t i = 0; i < data_.views.size(); ++i) {
            if (!problem_.HasParameterBlock(views_[i])) continue;
            const Pose& pose = state_.camera_from_target[i];
            CameraPoints bent = used_of(i);
            for (auto& point : bent.object_mm) point = state_.shape.apply(point);
            fit.corners += bent.pixel.size();
            fit.corner_cost += squares_px2(k_, pose, bent);
            if (robot_ && seen_.base_from_flange[i]) {
                const Pose found =
                    *state_.base_from_target * pose.inverse() * state_.flange_from_camera->inverse();
                robot_mm2 += std::pow(distance_mm(found, *seen_.base_from_flange[i]), 2);
                robot_rad2 += std::pow(angle_rad(found, *seen_.base_from_flange[i]), 2);
                ++robot_views;
            }
            if (!has_stripe(i)) continue;
            for (const auto& pixel : seen_.stripe[i])
                if (const auto met = meet_plate(camera, pixel, pose, state_.shape, seen_.stripe_on_bow)) {
                    stripe_mm2 += std::pow(plane_.head<3>().dot(*met) + plane_(3), 2);
                    ++rows;
                }
        }
        const auto rms = [](double sum, std::size_t n) {
            return n ? std::sqrt(sum / static_cast<double>(n)) : 0;
        };
        fit.corner_rms_px = rms(fit.corner_cost, fit.corners);
        fit.robot_rms_mm = rms(robot_mm2, robot_views);
        fit.robot_rms_rad = rms(robot_rad2, robot_views);
        fit.stripe_rms_mm = rms(stripe_mm2, rows);
    }

    const PlateBundle& seen_;
    const CameraData& data_;
    PlateBundleState state_;
    bool robot_;
    Intrinsics k_;
    camera_costs::Shape shape_;
    PoseBlock hand_eye_, target_;
    Eigen::Vector4d plane_;
    std::vector<PoseBlock> poses_;
    std::vector<double*> shared_, views_;
    Eigen::Index next_ = 0;
    ceres::Problem problem_;
};

}  // namespace

PlateBundleFit solve_plate_bundle(const PlateBundle& problem, const PlateBundleState& start) {
    PlateBundleFit fit;
    Bundle(problem, start, fit).solve(fit);
    fit.covariance = shared_covariance(fit.normal);
    return fit;
}

CameraSolution refine_camera(const CameraData& data, const std::vector<std::vector<char>>& used,
                             const CameraFreedom& freedom, const CameraSolution& start,
                             std::optional<double> corner_sigma_px) {
    PlateBundle rigid;
    rigid.data = &data;
    rigid.point_used = used;
    rigid.freedom = freedom;
    rigid.hold_exactly = !corner_sigma_px;
    rigid.corner_sigma_px = corner_sigma_px.value_or(1);
    PlateBundleState state;
    state.intrinsics = start.intrinsics;
    state.camera_from_target = start.camera_from_target;
    PlateBundleFit fit = solve_plate_bundle(rigid, state);
    return {fit.state.intrinsics,
            std::move(fit.state.camera_from_target),
            std::move(fit.normal),
            std::move(fit.basis),
            std::isfinite(fit.cost) ? fit.corner_cost : fit.cost,
            fit.corners,
            fit.converged};
}

}  // namespace seamwright
