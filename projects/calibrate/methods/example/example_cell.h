#pragma once
// The cell that the methods' examples are measured in: a camera 250 mm above the work, the laser plane at 30 degrees to
// its sight, noise of the camera, the profiles and the robot. Always the same numbers.

#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/geometry/pose.h"
#include "core/profile/sensor_model.h"
#include "projects/calibrate/methods/example/target_views.h"

namespace seamwright::example {

// Normal numbers, the same on every machine.
class Dither {
  public:
    double operator()(double sigma);
    double uniform();

  private:
    std::uint64_t state_ = 2024;
};

inline constexpr int kWidth = 1280, kHeight = 1024, kBoardColumns = 7, kBoardRows = 6;
inline constexpr double kPitch_mm = 10, kRadius_mm = 25, kPixelNoise = 0.03;

CameraModel camera();
Pose camera_from_laser();
Pose flange_from_sensor();
Pose base_from_target();
Pose shaken(const Pose& pose, Dither& dither, double mm, double rad);
Eigen::Vector3d board_corner(int index);
Pose camera_from_board(const TargetPlace& view);
Pose base_from_flange(const TargetPlace& view, Dither& dither);  // as the robot says it

nlohmann::json pair_json(double a, double b);
nlohmann::json vector3_json(const Eigen::Vector3d& v);
nlohmann::json laser_pairs();          // places of an apex all over the field, and the pixels that show it
nlohmann::json sphere_observations();  // of tcp-sphere and drift

}  // namespace seamwright::example
