#include "core/calibration/camera/camera_costs.h"

#include <ceres/autodiff_cost_function.h>

#include <cmath>

#include "core/calibration/camera/projection.h"

namespace seamwright::camera_costs {
namespace {

template <class T>
double number(const T& x) {
    if constexpr (std::is_same_v<T, double>)
        return x;
    else
        return x.a;
}

// weight * (projection - pixel); false behind the camera.
template <class K, class T>
bool miss(const K* k, const Vector3<T>& point, const Corner& corner, T* residual) {
    if (!(number(point.z()) > kLeastDepth_mm)) return false;
    const Eigen::Matrix<T, 2, 1> pixel = pixel_of_ray(k, T(point.x() / point.z()), T(point.y() / point.z()));
    residual[0] = (pixel.x() - corner.pixel.x()) * corner.weight;
    residual[1] = (pixel.y() - corner.pixel.y()) * corner.weight;
    return std::isfinite(number(residual[0])) && std::isfinite(number(residual[1]));
}

template <class T>
bool possible(const T* k) {
    constexpr double kLeastFocal_px = 1e-3;  // shorter ones are no camera
    return number(k[0]) > kLeastFocal_px && number(k[1]) > kLeastFocal_px;
}

// Derivatives by hand: automatic ones of 21 numbers made whole camera calibrations three times as long.
class Corners final : public ceres::CostFunction {
  public:
    Corners(std::vector<Corner> view, const PlateShape& place, const Pose& camera_from_frame)
        : view_(std::move(view)), place_(place), camera_from_frame_(camera_from_frame) {
        set_num_residuals(2 * static_cast<int>(view_.size()));
        *mutable_parameter_block_sizes() = {9, 5, 7};
    }
    bool Evaluate(const double* const* at, double* residual, double** jacobian) const override {
        const double *k = at[0], *shape = at[1], *pose = at[2];
        if (!possible(k)) return false;
        const Eigen::Matrix3d turn = turn_of(pose).toRotationMatrix();
        const Eigen::Vector3d shift = shift_of(pose);
        for (std::size_t i = 0; i < view_.size(); ++i) {
            const Eigen::Vector3d turned = turn * place_.bent(shape, view_[i].object_mm);
            const Eigen::Vector3d point = camera_from_frame_ * Eigen::Vector3d(turned + shift);
            if (!miss(k, point, view_[i], residual + 2 * i)) return false;
            if (jacobian) differentiate(k, i, point, turned, turn, pose, jacobian);
        }
        return true;
    }

  private:
    template <int Size>
    using Row = Eigen::Map<Eigen::Matrix<double, 2, Size, Eigen::RowMajor>>;

    void differentiate(const double* k, std::size_t i, const Eigen::Vector3d& point,
                       const Eigen::Vector3d& turned, const Eigen::Matrix3d& turn, const double* pose,
                       double** jacobian) const {
        const double x = point.x() / point.z(), y = point.y() / point.z(), w = view_[i].weight;
        if (jacobian[0]) {
            const double s = x * x + y * y, u = w * k[0], v = w * k[1];
            const double radial = 1 + s * (k[4] + s * (k[5] + s * k[8]));
            Row<9> by_k(jacobian[0] + 18 * i);
            by_k << w * (x * radial + 2 * k[6] * x * y + k[7] * (s + 2 * x * x)), 0, w, 0, u * x * s,
                u * x * s * s, 2 * u * x * y, u * (s + 2 * x * x), u * x * s * s * s,  //
                0, w * (y * radial + k[6] * (s + 2 * y * y) + 2 * k[7] * x * y), 0, w, v * y * s,
                v * y * s * s, v * (s + 2 * y * y), 2 * v * x * y, v * y * s * s * s;
        }
        if (!jacobian[1] && !jacobian[2]) return;
        Eigen::Matrix<double, 2, 3> by_point;
        by_point.leftCols<2>() = w / point.z() * pixel_by_ray(k, x, y);
        by_point.col(2) = -by_point.leftCols<2>() * Eigen::Vector2d(x, y);
        by_point *= camera_from_frame_.linear();
        if (jacobian[1]) {
            const Eigen::Vector3d& p = view_[i].object_mm;
            const Eigen::Vector2d from = p.head<2>() - place_.middle_mm;
            const Eigen::Vector2d far = from / place_.half_mm;
            const Eigen::Matrix<double, 2, 3> by_plate = by_point * turn;
            Row<5> by_shape(jacobian[1] + 10 * i);
            by_shape.col(0) = 0.5 * (by_plate.col(1) * from.y() - by_plate.col(0) * from.x());
            by_shape.col(1) = 0.5 * (by_plate.col(0) * from.y() + by_plate.col(1) * from.x());
            by_shape.rightCols<3>() =
                by_plate.col(2) * Eigen::RowVector3d(far.x() * far.x(), far.x() * far.y(), far.y() * far.y());
        }
        if (jacobian[2]) {
            Row<7> by_pose(jacobian[2] + 14 * i);
            by_pose.leftCols<3>() = by_point;
            by_pose.rightCols<4>() = -by_point * skew(turned) * tangent_by_turn(pose);
        }
    }

    std::vector<Corner> view_;
    PlateShape place_;
    Pose camera_from_frame_;
};

// Where camera and plate say that the flange stood, against what the robot said, in the flange's frame: there a
// robot's place and turn err by themselves, while at the plate a turn has moved it by its lever.
struct Robot {
    Pose base_from_flange;
    double per_mm, per_rad;
    template <class T>
    bool operator()(const T* x, const T* z, const T* c, T* residual) const {
        const Eigen::Quaternion<T> from_base(
            Eigen::Quaterniond(base_from_flange.linear()).conjugate().cast<T>());
        const Vector3<T> in_plate =
            turn_of(c).conjugate() * Vector3<T>(-(turn_of(x).conjugate() * shift_of(x)) - shift_of(c));
        const Vector3<T> mm =
            from_base * Vector3<T>(turn_of(z) * in_plate + shift_of(z) - base_from_flange.translation());
        const Vector3<T> rad = rotation_vector(
            Eigen::Quaternion<T>(from_base * turn_of(z) * turn_of(c).conjugate() * turn_of(x).conjugate()));
        for (int i = 0; i < 3; ++i) {
            residual[i] = mm[i] * per_mm;
            residual[3 + i] = rad[i] * per_rad;
        }
        return true;
    }
};

struct Stripe {
    Eigen::Vector2d pixel;
    PlateShape place;
    bool on_bow;
    int width, height;
    double per_mm;
    template <class T>
    bool operator()(const T* k, const T* shape, const T* plane, const T* pose, T* residual) const {
        if (!possible(k)) return false;
        Intrinsics at;
        PlateShape bent = place;
        Shape five;
        PoseBlock block;
        for (int i = 0; i < 9; ++i) at(i) = number(k[i]);
        for (int i = 0; i < 5; ++i) five(i) = number(shape[i]);
        for (int i = 0; i < 7; ++i) block(i) = number(pose[i]);
        bent.bow_mm = five.tail<3>();
        const auto met = meet_plate(camera_of(at, width, height), pixel, pose_of(block), bent, on_bow);
        if (!met) return false;
        // One Newton step from the ray found, and the plate met once more, carry the derivatives.
        const double x = met->x() / met->z(), y = met->y() / met->z();
        const Eigen::Matrix2d back = pixel_by_ray(at.data(), x, y).inverse();
        const Eigen::Matrix<T, 2, 1> off = pixel_of_ray(k, T(x), T(y)) - pixel;
        const Vector3<T> ray(x - off.x() * back(0, 0) - off.y() * back(0, 1),
                             y - off.x() * back(1, 0) - off.y() * back(1, 1), T(1));
        const Eigen::Matrix<T, 3, 3> turn = turn_of(pose).toRotationMatrix();
        const Vector3<T> normal = turn.col(2), shift = shift_of(pose);
        const T along = normal.dot(ray), base = normal.dot(shift);
        T depth = base / along;
        if (on_bow) {
            depth = T(met->z());
            for (int round = 0; round < 2; ++round) {
                const Vector3<T> q = turn.transpose() * Vector3<T>(ray * depth - shift);
                depth = (base + place.height(shape, q.x(), q.y())) / along;
            }
        }
        const Vector3<T> n(plane[0], plane[1], plane[2]);
        residual[0] = (n.dot(ray) * depth + plane[3]) * per_mm;
        return std::isfinite(number(residual[0]));
    }
};

}  // namespace

ceres::CostFunction* corners(std::vector<Corner> view, const PlateShape& place,
                             const Pose& camera_from_frame) {
    return new Corners(std::move(view), place, camera_from_frame);
}

KnownCamerasFit solve_pose(std::vector<Sights> sights, Pose& world_from_object) {
    PoseBlock pose = block_of(world_from_object);
    Shape flat = Shape::Zero();
    ceres::Problem problem;
    problem.AddParameterBlock(pose.data(), 7, pose_manifold());
    problem.AddParameterBlock(flat.data(), 5);
    problem.SetParameterBlockConstant(flat.data());
    for (Sights& s : sights) {
        if (s.corners.empty()) continue;
        problem.AddParameterBlock(s.camera.data(), 9);
        problem.SetParameterBlockConstant(s.camera.data());
        problem.AddResidualBlock(corners(std::move(s.corners), PlateShape{}, s.camera_from_world), nullptr,
                                 s.camera.data(), flat.data(), pose.data());
    }
    KnownCamerasFit fit;
    constexpr double kCostSettled = 1e-12;  // relative gain that ends it
    fit.cost = solve(problem, {pose.data()}, 100, kCostSettled).cost;
    fit.information = normal_blocks(problem, {}, {pose.data()}).vv.front();
    world_from_object = pose_of(pose);
    return fit;
}

ceres::CostFunction* robot(const Pose& base_from_flange, double sigma_mm, double sigma_rad) {
    return new ceres::AutoDiffCostFunction<Robot, 6, 7, 7, 7>(
        new Robot{base_from_flange, 1 / sigma_mm, 1 / sigma_rad});
}

ceres::CostFunction* stripe(const Eigen::Vector2d& pixel, const PlateShape& place, bool on_bow, int width,
                            int height, double sigma_mm) {
    return new ceres::AutoDiffCostFunction<Stripe, 1, 9, 5, 4, 7>(
        new Stripe{pixel, place, on_bow, width, height, 1 / sigma_mm});
}

}  // namespace seamwright::camera_costs
