#pragma once
// Robot poses as people have them: one table for all frames (CSV by name or by order, JSON, the points of a robot
// program: program_poses.h), or a text file beside each frame. How three angles or four numbers make a rotation is named or asked, and so are
// units that do not show.
//
// What the file's notation says itself (JSON by its keys, a robot program) the person may repeat and not change: an option that
// could not act is refused by name.
//
// A table in text is a row a pose: [name] x y z and a rotation, by header or by order; or 4x4 (or 3x4)
// matrices, row by row, one a row or stacked. A header names the convention where it is a brand's own: a, b,
// c (KUKA); w, p, r (FANUC); roll, pitch, yaw; q1..q4, qw, qx, qy, qz; else `convention` says it:
//     kuka-abc    Rz(A) Ry(B) Rx(C)              fanuc-wpr, rpy   Rz(R) Ry(P) Rx(W)
//     ur-rotvec   axis times angle, radian       quat-wxyz, quat-xyzw
//     zyz         Rz Ry' Rz''                    matrix
// Units: a header's ("x [m]", "a_rad") or the person's. Else millimetres and degrees (ur-rotvec: radian),
// unless the numbers speak against it (all positions within 100, all angles within 2 pi): then they are asked
// for.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

inline constexpr const char* kPoseConventions[] = {"kuka-abc",  "fanuc-wpr", "rpy", "ur-rotvec",
                                                   "quat-wxyz", "quat-xyzw", "zyz", "matrix"};

inline constexpr double kFarthestPose_mm = 1e5;
inline constexpr std::size_t kPoseLimit = 1'000'000;  // in one table

struct PoseLayout {
    std::string convention;  // of kPoseConventions; empty: as the header says
    std::string unit;        // of lengths (core/profile/units.h); empty: as the header says
    std::string angle;       // "deg" | "rad"; empty: as the header says
    // Of what the poses are, where not of the flange, and in what, where not in the robot's base: pose P is the flange's
    // base_from_user_frame * P * flange_from_tool^-1.
    std::optional<Pose> flange_from_tool{}, base_from_user_frame{};
};

struct TablePose {
    Pose pose;
    std::string at;  // "poses.csv, line 4"
};
// What may name the poses (pose_names.h): every column of a table that holds none of a pose's numbers.
struct PoseNames {
    // By its title or its form it names the poses; it may; or these are remarks, and the order counts where they
    // fit no frame (FANUC LS).
    enum class Says { names, nothing, remarks };
    Says says = Says::nothing;
    std::string title;               // as the header writes it; empty: a form without titles
    std::vector<std::string> cells;  // one a pose; empty: nothing stands there
};
// What a file's own notation says, whatever the person does. Empty: nothing.
inline constexpr const char* kNoAngles = "none";
struct WrittenNotation {
    std::string convention;  // of kPoseConventions
    std::string unit;        // of lengths
    std::string angle;       // "deg" | "rad" | kNoAngles
};
struct PoseTable {
    std::vector<TablePose> poses;  // of the flange in the robot's base
    std::vector<PoseNames> names;
    std::string understood;
    WrittenNotation says;        // of a robot program
    bool of_own_frames = false;  // a program's, whose tool or frame is not zero, or not known
};

// Error (input) with the line: no poses, rows of different widths, no number, unknown columns, a convention
// or a unit that must be said, rotations that are none, positions beyond 100 m, joint positions, user frames
// or tools that differ from pose to pose.
Expected<PoseTable> parse_pose_table(std::string_view text, const std::string& where,
                                     const PoseLayout& layout);
Expected<PoseTable> read_pose_table(const std::filesystem::path& path, const PoseLayout& layout);

// The pose files of frames, one each: JSON (json_poses.h), whose units are judged together; .txt and .yaml as
// read_pose_file() (pose_json.h) where their form says all by itself; else a text with one pose as above. Of the flange in the
// robot's base.
Expected<std::vector<Pose>> read_frame_poses(std::span<const std::filesystem::path> files,
                                             const PoseLayout& layout);

}  // namespace seamwright
