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
    if (!(number(point.z()) > 1e-6)) return false;
    const Eigen::Matrix<T, 2, 1> pixel = pixel_of_ray(k, T(point.x() / point.z()), T(point.y() / point.z()));
    residual[0] = (pixel.x() - corner.pixel.x()) * corner.weight;
    residual[1] = (pixel.y() - corner.pixel.y()) * corner.weight;
    return std::isfinite(number(residual[0])) && std::isfinite(number(residual[1]));
}

template <class T>
bool possible(const T* k) {
    return number(k[0]) > 1e-3 && number(k[1]) > 1e-3;
}

struct Corners {
    std::vector<Corner> view;
    PlateShape place;
    template <class T>
    bool operator()(const T* k, const T* shape, const T* pose, T* residual) const {
        if (!possible(k)) return false;
        const Eigen::Matrix<T, 3, 3> turn = turn_of(pose).toRotationMatrix();
        for (const Corner& corner : view) {
            const Vector3<T> point = turn * place.bent(shape, corner.object_mm) + shift_of(pose);
            if (!miss(k, point, corner, residual)) return false;
            residual += 2;
        }
        return true;
    }
};

struct KnownCamera {
    std::vector<Corner> view;
    Intrinsics k;
    Pose camera_from_world;
    template <class T>
    bool operator()(const T* pose, T* residual) const {
        const Eigen::Matrix<T, 3, 3> turn = camera_from_world.linear() * turn_of(pose).toRotationMatrix();
        const Vector3<T> shift =
            camera_from_world.linear() * shift_of(pose) + camera_from_world.translation();
        for (const Corner& corner : view) {
            if (!miss(k.data(), Vector3<T>(turn * corner.object_mm + shift), corner, residual)) return false;
            residual += 2;
        }
        return true;
    }
};

struct Robot {
    Pose base_from_flange;
    double per_mm, per_rad;
    template <class T>
    bool operator()(const T* x, const T* z, const T* c, T* residual) const {
        const Vector3<T> in_flange = turn_of(x) * shift_of(c) + shift_of(x);
        const Vector3<T> mm =
            base_from_flange.linear() * in_flange + base_from_flange.translation() - shift_of(z);
        const Vector3<T> rad =
            rotation_vector(Eigen::Quaternion<T>(Eigen::Quaterniond(base_from_flange.linear()).cast<T>() *
                                                 turn_of(x) * turn_of(c) * turn_of(z).conjugate()));
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

int rows(const std::vector<Corner>& view) {
    return 2 * static_cast<int>(view.size());
}

}  // namespace

ceres::CostFunction* corners(std::vector<Corner> view, const PlateShape& place) {
    const int count = rows(view);
    return new ceres::AutoDiffCostFunction<Corners, ceres::DYNAMIC, 9, 5, 7>(
        new Corners{std::move(view), place}, count);
}

ceres::CostFunction* known_camera(std::vector<Corner> view, const Intrinsics& camera,
                                  const Pose& camera_from_world) {
    const int count = rows(view);
    return new ceres::AutoDiffCostFunction<KnownCamera, ceres::DYNAMIC, 7>(
        new KnownCamera{std::move(view), camera, camera_from_world}, count);
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
