#pragma once
// What seamwright_surfaces.so (core/loaded_object.h) hands out, which alone links VTK: triangles as they stand in a file or are cut
// from polygons. Not checked; nobody but mesh_file.cpp calls it. False: none could be read.

#include <string>

#include "devices/simulated/scene/mesh.h"
#include "devices/simulated/scene/polygon_file.h"

namespace seamwright {

inline constexpr const char* kSurfaces = "seamwright_surfaces.so";

extern "C" {
bool seamwright_read_stl(const std::string& path, TriangleMesh& mesh);
bool seamwright_triangulate(const PolygonSurface& surface, TriangleMesh& mesh);
}

}  // namespace seamwright
