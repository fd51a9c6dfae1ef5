#pragma once
// The vertices of a mesh by place: what files tell apart that lies at one place.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "core/geometry/triangle_mesh.h"

namespace seamwright {

// For every vertex the first of those that lie with it, within a millionth of the mesh's size.
inline std::vector<int> welded(const TriangleMesh& mesh) {
    constexpr double kGrain = 1e-6, kLeastGrain_mm = 1e-9;
    const Eigen::AlignedBox3d box = mesh.box();
    const double grain = std::max(kLeastGrain_mm, kGrain * box.diagonal().norm());
    std::map<std::array<std::int64_t, 3>, int> known;
    std::vector<int> first(mesh.vertices.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
        const Eigen::Vector3d q = (mesh.vertices[i] - box.min()) / grain;
        const std::array<std::int64_t, 3> key{std::llround(q.x()), std::llround(q.y()), std::llround(q.z())};
        first[i] = known.emplace(key, static_cast<int>(i)).first->second;
    }
    return first;
}

}  // namespace seamwright
