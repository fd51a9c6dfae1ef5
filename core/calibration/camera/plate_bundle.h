#pragma once
// Joint solution of everything that views of one plate say: camera, the plate's true shape, one pose per
// view, and where given the robot's poses (hand-eye) and the laser stripe on the plate (laser plane).
//
// Why the plate's shape is unknown: paper is printed up to 0.5 % too long in one direction or sheared, and
// glued sheets bow by tenths of a millimetre. On real frames that bends f by 3 % and the rotation of the
// hand-eye residual by 0.3 degrees, ten times what the corners' noise does. Shape: in-plane x' = (1 - s/2) x
// + g/2 y, y' = (1 + s/2) y + g/2 x about the middle (the mean pitch is the nominal one: that is the scale),
// height h = bow . (x^2, x y, y^2) / half^2. Determined by tilted views and views turned about the axis; with
// few of them s is confused with fx/fy, therefore one focal length where s is free.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/calibration/camera/camera.h"

namespace seamwright {

struct PlateShape {
    double stretch = 0, shear = 0;                     // s, g (1)
    Eigen::Vector3d bow_mm = Eigen::Vector3d::Zero();  // at the distance half_mm
    Eigen::Vector2d middle_mm = Eigen::Vector2d::Zero();
    double half_mm = 1;
    Eigen::Matrix<double, 5, 1> numbers() const {
        return {stretch, shear, bow_mm.x(), bow_mm.y(), bow_mm.z()};
    }
    Eigen::Vector3d apply(const Eigen::Vector3d& nominal) const {  // nominal point to true point, plate frame
        return bent(numbers().data(), nominal);
    }
    // The same by other numbers than its own (stretch, shear, bow), of any type.
    template <class T>
    T height(const T* shape, const T& x, const T& y) const {
        const T a = (x - middle_mm.x()) / half_mm, b = (y - middle_mm.y()) / half_mm;
        return a * a * shape[2] + a * b * shape[3] + b * b * shape[4];
    }
    template <class T>
    Eigen::Matrix<T, 3, 1> bent(const T* shape, const Eigen::Vector3d& nominal) const {
        const double x = nominal.x() - middle_mm.x(), y = nominal.y() - middle_mm.y();
        return {shape[0] * (-0.5 * x) + shape[1] * (0.5 * y) + nominal.x(),
                shape[0] * (0.5 * y) + shape[1] * (0.5 * x) + nominal.y(),
                height(shape, T(nominal.x()), T(nominal.y())) + nominal.z()};
    }
};

// How much of the shape is free.
enum class ShapeFreedom { rigid, in_plane, bowed };

struct PlateBundle {
    const CameraData* data = nullptr;
    std::vector<char> view_used;                // per view
    std::vector<std::vector<char>> point_used;  // per view and point, or empty
    CameraFreedom freedom;
    ShapeFreedom shape = ShapeFreedom::rigid;
    // What `freedom` does not solve for is held exactly, or within held_intrinsics().
    bool hold_exactly = false;
    double corner_sigma_px = 0.2;

    std::vector<std::optional<Pose>> base_from_flange;  // per view; used when the state has a hand-eye
    double robot_sigma_mm = 0.3, robot_sigma_rad = 5e-4;

    std::vector<std::vector<Eigen::Vector2d>>
        stripe;                     // per view, pixels on the plate; used when the state has a plane
    std::vector<char> stripe_used;  // per view
    bool stripe_on_bow = true;      // the stripe lies on the bowed surface, or on its tangent plane
    double stripe_sigma_mm = 0.2;
    double stripe_between_mm = 0;  // standard deviation of a view's stripe as a whole, on top of its rows'
};

struct LaserPlane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // unit, camera frame
    double offset_mm = 0;                               // normal . p + offset = 0
};

struct PlateBundleState {
    Intrinsics intrinsics = Intrinsics::Zero();
    PlateShape shape;
    std::vector<Pose> camera_from_target;
    std::optional<Pose> flange_from_camera;  // with base_from_target: hand-eye residuals are in force
    std::optional<Pose> base_from_target;
    std::optional<LaserPlane> plane;  // stripe residuals are in force
};

struct PlateBundleFit {
    PlateBundleState state;
    NormalBlocks normal;
    double cost =
        0;  // sum of squares over the stated sigmas, priors included; infinity at an impossible start
    Eigen::MatrixXd covariance;  // of the shared unknowns for the stated sigmas; empty when singular
    // Where the shared unknowns stand: intrinsics basis [0, n), then shape, hand-eye, target, plane; -1 =
    // absent.
    Eigen::Index shape_at = -1, hand_eye_at = -1, target_at = -1, plane_at = -1;
    Eigen::MatrixXd basis;  // of the intrinsics: the free ones, then the held directions
    double corner_rms_px = 0, robot_rms_mm = 0, robot_rms_rad = 0, stripe_rms_mm = 0;
    double corner_cost = 0;  // px^2
    std::size_t corners = 0;
    bool converged = false;
};

PlateBundleFit solve_plate_bundle(const PlateBundle& problem, const PlateBundleState& start);

// Where the ray of a pixel meets the plate, camera frame; nullopt when it runs along the plate or away from
// it.
std::optional<Eigen::Vector3d> meet_plate(const CameraModel& camera, const Eigen::Vector2d& pixel,
                                          const Pose& camera_from_target, const PlateShape& shape,
                                          bool on_bow);

}  // namespace seamwright
