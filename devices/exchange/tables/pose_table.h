#pragma once
// Robot poses as people have them: one table for all frames (CSV by name or by order, FANUC LS, JSON), or a
// text file beside each frame. How three angles or four numbers make a rotation is named or asked, and so are
// units that do not show.
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
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

inline constexpr const char* kPoseConventions[] = {"kuka-abc",  "fanuc-wpr", "rpy", "ur-rotvec",
                                                   "quat-wxyz", "quat-xyzw", "zyz", "matrix"};

struct PoseLayout {
    std::string convention;  // of kPoseConventions; empty: as the header says
    std::string unit;        // of lengths (core/profile/units.h); empty: as the header says
    std::string angle;       // "deg" | "rad"; empty: as the header says
    bool operator==(const PoseLayout&) const = default;
};

struct NamedPose {
    std::string name;  // empty: by order
    Pose pose;
    std::string at;  // "poses.csv, line 4"
};
struct PoseTable {
    std::vector<NamedPose> poses;
    bool names_bind = true;  // false: names are remarks, the order counts where they fit no frame (FANUC LS)
    std::string understood;
};

// Error (input) with the line: no poses, rows of different widths, no number, unknown columns, a convention
// or a unit that must be said, rotations that are none, positions beyond 100 m, joint positions, user frames
// or tools that differ from pose to pose.
Expected<PoseTable> parse_pose_table(std::string_view text, const std::string& where,
                                     const PoseLayout& layout);
Expected<PoseTable> read_pose_table(const std::filesystem::path& path, const PoseLayout& layout);

// /POS of a FANUC program: P[1:"S1"]{ GP1: UF : 0, UT : 1, ... X = 1.0 mm, ... R = 0.0 deg };
Expected<PoseTable> parse_fanuc_ls(std::string_view text, const std::string& where);

// The pose file of one frame: as read_pose_file() (pose_json.h) where its form says all by itself, else a
// text with one pose as above.
Expected<Pose> read_frame_pose(const std::filesystem::path& path, const PoseLayout& layout);

// Which pose belongs to each frame (file name, or its stem, or the number it ends in, equal to the pose's
// name); without names by order, and then there must be as many of both. Error (input): names the frame
// without a pose.
Expected<std::vector<Pose>> poses_of_frames(const PoseTable& table, std::span<const std::string> frames,
                                            const std::string& where);

}  // namespace seamwright
