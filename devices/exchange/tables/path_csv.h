#pragma once
// An application path as CSV in the robot's own notation: one point a row, in the order of the path.
//
//   kuka   x_mm,y_mm,z_mm,a_deg,b_deg,c_deg        A, B, C (C.18)
//   abb    x_mm,y_mm,z_mm,q1,q2,q3,q4              unit quaternion, w first (norm within 1e-3 of 1)
//   ur     x_m,y_m,z_m,rx_rad,ry_rad,rz_rad        metre and rotation vector
//
// and, where wanted, `region`: the id of the region that the point belongs to, empty = of none. Other columns
// are ignored, in any order. Text rules and refusals are those of profile_csv.h; besides, every number of a
// pose must be there and finite, within 100 m.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/geometry/pose.h"

namespace seamwright {

enum class PathNotation { kuka, abb, ur };
inline constexpr std::string_view kPathNotations[] = {"kuka", "abb", "ur"};  // as the robots' brands
Expected<PathNotation> path_notation_from(std::string_view brand);
std::string_view to_string(PathNotation notation);

struct ApplicationPoint {
    Pose frame_from_tool = Pose::Identity();
    std::string region_id;
};
struct ApplicationPath {
    bool regions_named = false;  // there is a column for them
    std::vector<ApplicationPoint> points;
};

inline constexpr std::size_t kPathPointLimit = 1'000'000;

Expected<ApplicationPath> parse_path_csv(std::string_view text, PathNotation notation,
                                         const std::string& where);
Expected<ApplicationPath> read_path_csv(const std::filesystem::path& path, PathNotation notation);
// Numbers to the last bit that they are read with.
std::string path_csv(const ApplicationPath& path, PathNotation notation);

}  // namespace seamwright
