#include "devices/simulated/scene/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <tuple>

#include "core/geometry/welded.h"
#include "core/loaded_object.h"
#include "devices/exchange/files.h"
#include "devices/simulated/scene/polygon_file.h"
#include "devices/simulated/scene/surfaces_object.h"

namespace seamwright {
namespace {

constexpr std::size_t kLongestFile = std::size_t{4} << 30;  // bytes, of text or binary

// Two triangles that turn alike run along their common side in opposite directions.
void turn_alike(TriangleMesh& mesh) {
    struct Side {
        int low = 0, high = 0, triangle = 0;
        bool rising = false;
        bool joins(const Side& other) const { return low == other.low && high == other.high; }
    };
    const std::vector<int> one = welded(mesh);
    std::vector<Side> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = one[static_cast<std::size_t>(mesh.triangles[t][k])],
                      b = one[static_cast<std::size_t>(mesh.triangles[t][(k + 1) % 3])];
            if (a != b) sides.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
        return std::tie(x.low, x.high, x.triangle) < std::tie(y.low, y.high, y.triangle);
    });
    struct Joint {
        std::size_t a = 0, b = 0;
        bool against = false;
    };
    std::vector<Joint> joints;
    for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
        for (next = i + 1; next < sides.size() && sides[next].joins(sides[i]);) ++next;
        if (next - i == 2)  // else a border, or sheets that meet
            joints.push_back({static_cast<std::size_t>(sides[i].triangle),
                              static_cast<std::size_t>(sides[i + 1].triangle),
                              sides[i].rising == sides[i + 1].rising});
    }
    if (std::none_of(joints.begin(), joints.end(), [](const Joint& j) { return j.against; })) return;
    struct Neighbour {
        std::size_t triangle = 0;
        bool against = false;
    };
    std::vector<std::vector<Neighbour>> beside(mesh.triangles.size());
    for (const Joint& j : joints) {
        beside[j.a].push_back({j.b, j.against});
        beside[j.b].push_back({j.a, j.against});
    }
    const Eigen::Vector3d middle = mesh.box().center();
    std::vector<char> known(mesh.triangles.size(), 0), turned(mesh.triangles.size(), 0);
    for (std::size_t first = 0; first < mesh.triangles.size(); ++first) {
        if (known[first]) continue;
        std::vector<std::size_t> body{first};
        known[first] = 1;
        double area_as_it_is = 0, area_turned = 0, volume = 0;
        bool closed = true;
        for (std::size_t i = 0; i < body.size(); ++i) {
            const std::size_t t = body[i];
            Eigen::Vector3d c[3];
            for (int k = 0; k < 3; ++k)
                c[k] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])] - middle;
            (turned[t] ? area_turned : area_as_it_is) += (c[1] - c[0]).cross(c[2] - c[0]).norm();
            volume += (turned[t] ? -1 : 1) * c[0].dot(c[1].cross(c[2]));
            closed = closed && beside[t].size() == 3;
            for (const Neighbour& n : beside[t]) {
                if (known[n.triangle]) continue;
                known[n.triangle] = 1;
                turned[n.triangle] = (turned[t] != 0) != n.against;
                body.push_back(n.triangle);
            }
        }
        if (area_turned == 0) continue;
        const bool first_is_right = closed ? volume > 0 : area_turned <= area_as_it_is;
        for (const std::size_t t : body)
            if ((turned[t] != 0) == first_is_right) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
}

// Without the triangles that have no area; turned as load_mesh() says.
Expected<TriangleMesh> cleaned(TriangleMesh mesh, const std::string& where) {
    const auto& v = mesh.vertices;
    if (!std::all_of(v.begin(), v.end(), [](const Eigen::Vector3d& p) { return p.allFinite(); }))
        return file_error("holds a vertex that is not finite", where);
    std::erase_if(mesh.triangles, [&](const Eigen::Vector3i& t) {
        const auto at = [&](int k) { return v[static_cast<std::size_t>(t[k])]; };
        return !((at(1) - at(0)).cross(at(2) - at(0)).norm() > 0);
    });
    if (mesh.triangles.empty()) return file_error("holds only degenerate triangles", where);
    turn_alike(mesh);
    return mesh;
}

// A text's last solid ends by "endsolid".
Expected<void> check_stl_text_is_whole(std::ifstream& file, const std::string& where) {
    constexpr std::streamoff kEnd = 4096;
    file.clear();
    file.seekg(0, std::ios::end);
    const std::streamoff size = file.tellg();
    file.seekg(std::max<std::streamoff>(0, size - kEnd));
    std::string end((std::istreambuf_iterator<char>(file)), {});
    std::transform(end.begin(), end.end(), end.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const auto ended = end.rfind("endsolid"), facet = end.rfind("facet normal");
    if (ended == std::string::npos || (facet != std::string::npos && facet > ended))
        return file_error("is cut short: it ends before its \"endsolid\"", where, "copy it again");
    return {};
}

// Of a binary STL: a header of 80 bytes, the number of triangles, 50 bytes each. VTK reads what is there and counts
// nothing; only a text holds no zero byte.
Expected<void> check_stl_is_whole(const std::filesystem::path& path) {
    constexpr std::size_t kHeader = 80, kBegins = kHeader + 4, kTriangle = 50;
    std::array<char, 512> begin{};
    std::ifstream file(path, std::ios::binary);
    file.read(begin.data(), begin.size());
    const auto held = static_cast<std::size_t>(file.gcount());
    if (std::find(begin.begin(), begin.begin() + held, '\0') == begin.begin() + held) {
        std::string_view text(begin.data(), held);
        text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
        const bool solid =
            text.size() >= 5 && std::equal(text.begin(), text.begin() + 5, "solid", [](char c, char s) {
                return std::tolower(static_cast<unsigned char>(c)) == s;
            });
        if (!solid) return {};
        return check_stl_text_is_whole(file, path.string());
    }
    std::uint32_t stated = 0;
    std::error_code problem;
    const std::uintmax_t size = std::filesystem::file_size(path, problem);
    if (held >= kBegins) std::memcpy(&stated, begin.data() + kHeader, sizeof stated);
    if (problem || size < kBegins + kTriangle * std::uintmax_t{stated})
        return file_error(Text("is cut short: it states {} triangles and holds {}", stated,
                               size < kBegins ? 0 : (size - kBegins) / kTriangle),
                          path.string(), "copy it again");
    return {};
}

Expected<TriangleMesh> read_stl(const std::filesystem::path& path) {
    SEAM_OK(check_stl_is_whole(path));
    SEAM_TRY(const auto read,
             loaded_function<decltype(seamwright_read_stl)>(kSurfaces, "seamwright_read_stl"));
    TriangleMesh mesh;
    if (!read(path.string(), mesh)) return file_error("holds no readable triangles", path.string());
    return cleaned(std::move(mesh), path.string());
}

Expected<TriangleMesh> mesh_of(const PolygonSurface& surface, const std::string& where) {
    TriangleMesh mesh;
    const auto is_triangle = [](const std::vector<std::int32_t>& face) { return face.size() == 3; };
    if (std::all_of(surface.faces.begin(), surface.faces.end(), is_triangle)) {
        if (surface.faces.empty()) return file_error("holds no readable triangles", where);
        mesh.vertices = surface.points;
        for (const auto& face : surface.faces) mesh.triangles.emplace_back(face[0], face[1], face[2]);
    } else {
        SEAM_TRY(const auto triangulate,
                 loaded_function<decltype(seamwright_triangulate)>(kSurfaces, "seamwright_triangulate"));
        if (!triangulate(surface, mesh)) return file_error("holds no readable triangles", where);
    }
    return cleaned(std::move(mesh), where);
}

}  // namespace

Expected<TriangleMesh> load_mesh(const std::filesystem::path& path, const std::string& unit) {
    if (!unit.empty() && unit != "mm" && unit != "m") {
        return input_error(Text("\"{}\" is no unit of a mesh", unit), path.string(), "give \"mm\" or \"m\"");
    }
    std::error_code problem;
    if (!std::filesystem::is_regular_file(path, problem)) return file_error("is no file", path.string());
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    Expected<TriangleMesh> mesh = file_error("is neither .stl, .ply nor .obj", path.string());
    try {
        if (extension == ".stl") {
            mesh = read_stl(path);
        } else if (extension == ".ply" || extension == ".obj") {
            SEAM_TRY(const std::string text, read_text_file(path, kLongestFile));
            SEAM_TRY(const PolygonSurface surface,
                     extension == ".ply" ? parse_ply(text, path.string()) : parse_obj(text, path.string()));
            mesh = mesh_of(surface, path.string());
        }
    } catch (const std::exception& e) {
        return file_error(Text("cannot be read ({})", e.what()), path.string());
    }
    if (!mesh) return mesh;
    const double longest = mesh->box().sizes().maxCoeff();
    if (unit == "m") {
        for (auto& v : mesh->vertices) v *= 1000;
    } else if (unit.empty() && longest < 10) {
        return input_error(Text("the part is only {:.4g} long: metres suspected", longest), path.string(),
                           "say the unit: \"mm\" or \"m\"");
    }
    return mesh;
}

Expected<TriangleMesh> mesh_from_ply(std::span<const std::byte> ply, const std::string& where) {
    const std::string_view text(reinterpret_cast<const char*>(ply.data()), ply.size());
    try {
        SEAM_TRY(const PolygonSurface surface, parse_ply(text, where));
        return mesh_of(surface, where);
    } catch (const std::exception& e) {
        return file_error(Text("cannot be read ({})", e.what()), where);
    }
}

std::vector<std::byte> ply_bytes(const TriangleMesh& mesh) {
    const std::string head = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment millimetres, work object frame\n"
        "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices.size(), mesh.triangles.size());
    std::vector<std::byte> bytes(head.size() + mesh.vertices.size() * 12 + mesh.triangles.size() * 13);
    std::byte* at = bytes.data();
    const auto put = [&](const void* data, std::size_t size) {
        std::memcpy(at, data, size);
        at += size;
    };
    put(head.data(), head.size());
    for (const Eigen::Vector3d& v : mesh.vertices) {
        const Eigen::Vector3f f = v.cast<float>();
        put(f.data(), 12);
    }
    for (const Eigen::Vector3i& t : mesh.triangles) {
        const unsigned char three = 3;
        put(&three, 1);
        const std::array<std::int32_t, 3> corners{t[0], t[1], t[2]};
        put(corners.data(), 12);
    }
    return bytes;
}

}  // namespace seamwright
