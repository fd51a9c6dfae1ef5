#pragma once
// One shot for all sensors of a gripper (thesis 4.1): each sensor's own camera sees its plate, the plate's
// place in the world is known, and so is the laser plane in the camera:
//     plate_from_laser = plate_from_camera * camera_from_laser          (4.10), plate_from_camera =
//     camera_from_plate^-1 world_from_laser = world_from_plate * plate_from_laser            (4.18)
// Optionally reference_from_world (for example gripper_from_world) takes all of them into the gripper's
// frame.
//
// Covariances are propagated to first order (covariance_of_product); the links' errors are taken as
// independent within one sensor. Sensors that share a plate or a reference share that part of the error (see
// StaticSensorResult::shares).

#include <optional>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/geometry/pose.h"

namespace seamwright {

// A pose and its covariance (tangent of pose.h); zero = taken as exact.
struct UncertainPose {
    Pose pose = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
};
UncertainPose operator*(const UncertainPose& a_from_b, const UncertainPose& b_from_c);
UncertainPose inverse(const UncertainPose& a_from_b);
// Refuses a pose that is not rigid or not in mm, and a covariance that is none: not finite, not symmetric, not positive.
Expected<void> check_uncertain_pose(const UncertainPose& link, const Text& where);

struct StaticSensor {
    std::string id;
    UncertainPose world_from_plate;
    UncertainPose plate_from_camera;
    std::string camera_field = "plate_from_camera";  // what the data call it
    UncertainPose camera_from_laser;
    Eigen::Vector3d working_point_mm =
        Eigen::Vector3d::Zero();  // in the laser frame: where its sigma is judged
};

struct StaticSensorResult {
    std::string id;
    UncertainPose world_from_laser;  // or reference_from_laser when a reference is given
    double working_sigma_mm = 0;     // largest sigma of the working point
    double shares[4] = {0, 0, 0,
                        0};  // of that variance: reference, plate in world, camera on plate, laser in camera
    Judgement judgement;
};

struct StaticChainResult {
    std::vector<StaticSensorResult> sensors;
    Judgement judgement;  // the worst of them
};

struct StaticChainOptions {
    std::optional<UncertainPose> reference_from_world;
    std::vector<std::string> exclude;
};

// A link without covariance is taken as exact and named, the verdict at most usable; where none has one, sigma and shares
// are zero: unknown.
//
// Error: no sensor, ids missing or twice, poses not rigid, a link shorter than 10 mm (camera_from_laser: 2 mm) and
// not zero (metres), covariances not symmetric or with negative eigenvalues.
Expected<StaticChainResult> calibrate_static(const std::vector<StaticSensor>& sensors,
                                             const StaticChainOptions& options = {});

}  // namespace seamwright
