#pragma once
// Checks that every method shares which is fed with robot poses: finite, rigid, in millimetres, enough
// different ones.

#include <string>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

// Two poses closer than this are the same pose (a robot repeats to some hundredths of a millimetre).
inline constexpr double kSamePose_mm = 0.05;
inline constexpr double kSamePose_rad = 1e-3;

// Refuses non-finite and non-rigid poses (see pose_from_matrix). `where` names the list, ids[i] the pose.
Expected<void> check_rigid(const std::vector<Pose>& poses, const std::vector<std::string>& ids,
                           const Text& where);

// Refuses a list whose ids are empty or occur twice, and `exclude` entries that name nobody.
Expected<void> check_ids(const std::vector<std::string>& ids, const std::vector<std::string>& exclude,
                         const Text& where);

// Refuses translations that can only be metres: a flange is never less than 10 mm from the robot's base in
// every pose, so when all |translation| < 10 and they are not all zero the sentence says "look like metres".
Expected<void> check_millimetres(const std::vector<Pose>& poses, const Text& where);

// For each pose the index of the first pose equal to it (its own index when it is the first).
std::vector<int> first_equal_pose(const std::vector<Pose>& poses);

// How the orientations of a set spread. Rotations are taken between the poses and their mean, as rotation
// vectors in the moving (flange) frame; columns of `axes` are the principal directions there, `spread_rad`
// the largest angle of any pose pair about them, largest first. Works for spreads below 180 degrees; more is
// as good as enough.
struct OrientationSpread {
    Eigen::Vector3d spread_rad = Eigen::Vector3d::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};
OrientationSpread orientation_spread(const std::vector<Pose>& poses);
// A smaller spread about an axis is no turn about it.
inline constexpr double kNoSpread_deg = 5;

// "X", "Y", "Z" when `axis` is within so many degrees of that axis, else "(0.71, 0.00, 0.71)".
inline constexpr double kNearAxis_deg = 25;
std::string axis_name(const Eigen::Vector3d& axis);

}  // namespace seamwright
