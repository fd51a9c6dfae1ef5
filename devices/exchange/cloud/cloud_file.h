#pragma once
// Clouds as files: PLY, PCD and text.

#include <filesystem>
#include <string>
#include <string_view>

#include "core/cloud/cloud.h"
#include "core/error.h"

namespace seamwright {

inline constexpr std::size_t kMostCloudPoints = 50'000'000;

// By content, as point_table.h reads: PLY and PCD (ascii or binary), NumPy, or text whose columns are x, y, z, named
// or the first three. Used besides, where they are named so: nx ny nz or normal_x.. (normals), towards_x.. (to the
// sensor), sigma_mm. Points without a number are left out. `unit` "mm" or "m"; "" means mm, but a cloud whose longest
// side is below 10 is refused as metres. Error (file, input): unreadable, not three columns, no point.
Expected<Cloud> read_cloud(const std::filesystem::path& path, const std::string& unit = {});
Expected<Cloud> parse_cloud(std::string_view bytes, const std::string& where, const std::string& unit = {});

// By the name's ending: .ply, .pcd (binary, float) or .csv (x_mm,y_mm,z_mm,..). `frame` stands in the head of PLY and
// PCD: kInBaseMark of point_table.h, or another frame in words.
Expected<void> write_cloud(const std::filesystem::path& path, const Cloud& cloud, std::string_view frame);
std::string cloud_ply(const Cloud& cloud, std::string_view frame);
std::string cloud_pcd(const Cloud& cloud, std::string_view frame);
std::string cloud_csv(const Cloud& cloud);

}  // namespace seamwright
