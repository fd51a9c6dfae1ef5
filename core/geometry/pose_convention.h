#pragma once
// What the numbers of a written pose mean: which rotation three, four or nine numbers are, in which units, and
// which of the two frames stands in the other. A pose is read by one convention, and can be written back and
// read by another to rounding.
//
// Codes, words joined by commas; what is not said is as in the first of each line:
//     euler-zyx-intrinsic (12 orders, intrinsic | extrinsic; the angles in the order in which they turn),
//     rotvec, quat-wxyz, quat-xyzw, matrix
//     kuka-abc, fanuc-wpr, rpy, zyz, ur-rotvec (axis times angle in radian): the brands' names of some of them
//     deg | rad                                 of angles and rotation vectors
//     mm | m | um | in
//     (as written) | transposed                 the rotation, of matrices and quaternions: of a matrix written by
//                                               columns, of a quaternion that turns the axes
//     (base_from_flange) | inverse              what is written is flange_from_base; undone after all the rest
// for example "euler-xyz-extrinsic,rad,m,inverse".

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/euler.h"

namespace seamwright {

// How many numbers the rotation is written with, which every file shows: angles are Euler angles or a rotation
// vector.
enum class RotationForm { angles, quaternion, matrix };

// As written: no unit.
struct PoseNumbers {
    RotationForm form = RotationForm::angles;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::array<double, 9> rotation{};  // the first 3, the first 4, or 9 row by row
    bool position_in_last_row =
        false;  // of a 4 x 4 matrix: then it is by columns, whatever a convention says
};

enum class RotationReading { euler, rotation_vector, quat_wxyz, quat_xyzw, matrix };
RotationForm form_of(RotationReading reading);

struct PoseConvention {
    RotationReading rotation = RotationReading::euler;
    EulerConvention euler = {};  // of RotationReading::euler
    bool radian = false;
    std::string_view unit = "mm";  // of kLengthUnits
    bool transposed = false;
    bool inverse = false;
    bool operator==(const PoseConvention& other) const;  // what its rotation has no use for does not count
};

std::string code_of(const PoseConvention& convention);
Text words_of(const PoseConvention& convention);
// Error (input): an unknown word, two of a kind, "transposed" of angles.
Expected<PoseConvention> pose_convention_named(std::string_view code, const Text& where);

// nullopt: these numbers are no such pose: another form, a number that is not finite, a quaternion of a length
// off 1 by more than 1e-3, rows that are no rotation (pose_from_matrix), a position beyond 100 m.
std::optional<Pose> read_pose(const PoseNumbers& numbers, const PoseConvention& convention);
// Inverse of read_pose to rounding (of Euler angles and quaternions one of the equal ones).
PoseNumbers write_pose(const Pose& pose, const PoseConvention& convention);

// The conventions in which a list of poses of one form can be meant, `as_given` first. Left out is what the
// numbers themselves rule out: radian where an angle is more than a turn, a unit of length that puts every
// position within 100 mm of its base or one beyond 50 m, transposed of angles.
std::vector<PoseConvention> possible_conventions(std::span<const PoseNumbers> poses,
                                                 const PoseConvention& as_given);

}  // namespace seamwright
