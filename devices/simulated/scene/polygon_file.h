#pragma once
// The surfaces in PLY and OBJ files. Read here: VTK's readers follow a face's corners without asking whether they are there.

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace seamwright {

struct PolygonSurface {
    std::vector<Eigen::Vector3d> points;
    std::vector<std::vector<std::int32_t>> faces;  // indices of points, each of at least three
};

// Ascii or binary, of either order of bytes; elements and properties that are neither x, y, z nor vertex_indices
// (vertex_index) are passed over. Error (file): no PLY, cut short, a count that the file cannot hold, a face with a corner that
// is no point.
Expected<PolygonSurface> parse_ply(std::string_view bytes, const std::string& where);

// Its `v` and `f`; textures, normals, groups and curves are passed over. A corner counts from 1 on, or backwards from the newest.
// Error (file): a vertex that is none, a face with a corner that is no vertex.
Expected<PolygonSurface> parse_obj(std::string_view text, const std::string& where);

}  // namespace seamwright
