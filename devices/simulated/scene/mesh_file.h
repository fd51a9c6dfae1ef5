#pragma once
// Triangle meshes from STL, PLY and OBJ files.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "devices/simulated/scene/mesh.h"

namespace seamwright {

// `unit` is "mm" or "m" (scaled to mm); "" means mm, but a box whose longest side is below 10 is then refused
// as "metres suspected", since no part measured here is that small. Polygons are triangulated, degenerate
// triangles left out. Triangles that turn against their neighbours are turned: of what hangs together over sides of two
// triangles, outwards where it is closed, else as most of its area turns; what turns alike stays as it is. Error (file):
// missing, unknown extension, unreadable, cut short, no triangle, not finite.
Expected<TriangleMesh> load_mesh(const std::filesystem::path& path, const std::string& unit);

// A PLY held in memory (PartSetup::mesh_ply), millimetres. `where` is for the Error (file), as above.
Expected<TriangleMesh> mesh_from_ply(std::span<const std::byte> ply, const std::string& where);

// Binary PLY: float vertices (mm), triangles.
std::vector<std::byte> ply_bytes(const TriangleMesh& mesh);

}  // namespace seamwright
