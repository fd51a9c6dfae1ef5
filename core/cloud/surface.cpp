#include "core/cloud/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <unordered_map>

#include "core/geometry/welded.h"

namespace seamwright {
namespace {

constexpr double kSmoothCos = 0.819;  // cos of 35 degrees
constexpr double kGrazing = 0.1;      // cos of 84 degrees: no stripe is seen on a face that leans away more
constexpr std::int32_t kLeafFaces = 4;

using Corners = std::array<int, 3>;

std::uint64_t edge_key(int a, int b) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(std::min(a, b))) << 32 |
           static_cast<std::uint32_t>(std::max(a, b));
}

// Nearest point of a triangle and where it lies: 0..2 the edge from that corner, 3..5 a corner, -1 inside (Ericson,
// Real-Time Collision Detection, 5.1.5).
Eigen::Vector3d nearest_in(const std::array<Eigen::Vector3d, 3>& c, const Eigen::Vector3d& p, int& place,
                           Eigen::Vector3d& weights) {
    const Eigen::Vector3d &a = c[0], &b = c[1], &d = c[2];
    const Eigen::Vector3d ab = b - a, ac = d - a, ap = p - a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return place = 3, weights = {1, 0, 0}, a;
    const Eigen::Vector3d bp = p - b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return place = 4, weights = {0, 1, 0}, b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        const double v = d1 / (d1 - d3);
        return place = 0, weights = {1 - v, v, 0}, a + v * ab;
    }
    const Eigen::Vector3d cp = p - d;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return place = 5, weights = {0, 0, 1}, d;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        const double w = d2 / (d2 - d6);
        return place = 2, weights = {1 - w, 0, w}, a + w * ac;
    }
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return place = 1, weights = {0, 1 - w, w}, b + w * (d - b);
    }
    const double sum = va + vb + vc, v = vb / sum, w = vc / sum;
    return place = -1, weights = {1 - v - w, v, w}, a + ab * v + ac * w;
}

}  // namespace

Surface::Surface(const TriangleMesh& mesh) : box_(mesh.box()) {
    const std::vector<int> one = welded(mesh);
    std::vector<Corners> corners;
    std::unordered_map<std::uint64_t, int> edges;
    std::vector<std::vector<int>> at(one.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        Face face;
        Corners ids{};
        for (int k = 0; k < 3; ++k) {
            const auto v = static_cast<std::size_t>(mesh.triangles[t][k]);
            ids[static_cast<std::size_t>(k)] = one[v];
            face.corner[k] = mesh.vertices[v];
        }
        const Eigen::Vector3d across =
            (face.corner[1] - face.corner[0]).cross(face.corner[2] - face.corner[0]);
        if (!(across.norm() > 0) || ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0]) continue;
        face.normal = across.normalized();
        face.triangle = static_cast<int>(t);
        area_ += across.norm() / 2;
        for (std::size_t k = 0; k < 3; ++k) {
            ++edges[edge_key(ids[k], ids[(k + 1) % 3])];
            at[static_cast<std::size_t>(ids[k])].push_back(static_cast<int>(faces_.size()));
        }
        corners.push_back(ids);
        faces_.push_back(face);
    }
    std::vector<char> border(one.size(), 0);
    for (std::size_t f = 0; f < faces_.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            if (edges[edge_key(corners[f][k], corners[f][(k + 1) % 3])] != 1) continue;
            faces_[f].border = static_cast<std::uint8_t>(faces_[f].border | 1U << k);
            border[static_cast<std::size_t>(corners[f][k])] =
                border[static_cast<std::size_t>(corners[f][(k + 1) % 3])] = 1;
        }
    for (std::size_t f = 0; f < faces_.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto id = static_cast<std::size_t>(corners[f][k]);
            if (border[id]) faces_[f].border = static_cast<std::uint8_t>(faces_[f].border | 8U << k);
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (const int g : at[id]) {
                const Face& other = faces_[static_cast<std::size_t>(g)];
                if (other.normal.dot(faces_[f].normal) < kSmoothCos) continue;
                // Weighted by the angle at the corner: how the sheet is cut into triangles does not matter.
                const auto& ids = corners[static_cast<std::size_t>(g)];
                const int j = ids[0] == static_cast<int>(id) ? 0 : ids[1] == static_cast<int>(id) ? 1 : 2;
                const Eigen::Vector3d u = (other.corner[(j + 1) % 3] - other.corner[j]).normalized(),
                                      v = (other.corner[(j + 2) % 3] - other.corner[j]).normalized();
                sum += std::acos(std::clamp(u.dot(v), -1.0, 1.0)) * other.normal;
            }
            faces_[f].smooth[k] = sum.norm() > 0 ? Eigen::Vector3d(sum.normalized()) : faces_[f].normal;
        }
    if (faces_.empty()) return;
    nodes_.reserve(faces_.size());
    nodes_.emplace_back();
    build(0, 0, static_cast<std::int32_t>(faces_.size()));
}

void Surface::build(std::int32_t node, std::int32_t first, std::int32_t count) {
    Eigen::AlignedBox3d box, middles;
    for (std::int32_t i = first; i < first + count; ++i) {
        const Face& f = faces_[static_cast<std::size_t>(i)];
        for (const auto& c : f.corner) box.extend(c);
        middles.extend((f.corner[0] + f.corner[1] + f.corner[2]) / 3);
    }
    nodes_[static_cast<std::size_t>(node)].box = box;
    Eigen::Index axis = 0;
    if (count <= kLeafFaces || !(middles.sizes().maxCoeff(&axis) > 0)) {
        nodes_[static_cast<std::size_t>(node)].first = first;
        nodes_[static_cast<std::size_t>(node)].count = count;
        return;
    }
    const auto key = [axis](const Face& f) {
        return f.corner[0][axis] + f.corner[1][axis] + f.corner[2][axis];
    };
    const std::int32_t half = count / 2;
    std::nth_element(faces_.begin() + first, faces_.begin() + first + half, faces_.begin() + first + count,
                     [&](const Face& a, const Face& b) { return key(a) < key(b); });
    const auto child = static_cast<std::int32_t>(nodes_.size());
    nodes_[static_cast<std::size_t>(node)].first = child;
    nodes_.emplace_back();
    nodes_.emplace_back();
    build(child, first, half);
    build(child + 1, first + half, count - half);
}

SurfacePoint Surface::on(const Face& face, const Eigen::Vector3d& p) const {
    SurfacePoint s;
    int place = -1;
    Eigen::Vector3d w;
    s.point = nearest_in(face.corner, p, place, w);
    s.distance_mm = (p - s.point).norm();
    s.triangle = face.triangle;
    s.normal = (w[0] * face.smooth[0] + w[1] * face.smooth[1] + w[2] * face.smooth[2]).normalized();
    s.at_border = place >= 0 && (face.border >> place & 1U) != 0;
    // Beside an edge the point lies where the mean of the two faces says.
    const double side = (p - s.point).dot(place < 0 ? face.normal : s.normal);
    s.signed_mm = side < 0 ? -s.distance_mm : s.distance_mm;
    return s;
}

std::optional<SurfacePoint> Surface::nearest(const Eigen::Vector3d& p, double most_mm,
                                             const Eigen::Vector3d* facing) const {
    if (nodes_.empty()) return std::nullopt;
    double best = most_mm * most_mm;
    const Face* found = nullptr;
    std::array<std::pair<double, std::int32_t>, 96> stack;
    std::size_t depth = 0;
    stack[depth++] = {nodes_[0].box.squaredExteriorDistance(p), 0};
    while (depth > 0) {
        const auto [far, at] = stack[--depth];
        if (far > best) continue;
        const Node& node = nodes_[static_cast<std::size_t>(at)];
        if (node.count > 0) {
            for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
                const Face& face = faces_[static_cast<std::size_t>(i)];
                if (facing && face.normal.dot(*facing) <= kGrazing) continue;
                int place = -1;
                Eigen::Vector3d w;
                const double d = (nearest_in(face.corner, p, place, w) - p).squaredNorm();
                if (d > best || (d == best && found)) continue;
                best = d;
                found = &face;
            }
            continue;
        }
        std::pair<double, std::int32_t> left{0, node.first}, right{0, node.first + 1};
        left.first = nodes_[static_cast<std::size_t>(left.second)].box.squaredExteriorDistance(p);
        right.first = nodes_[static_cast<std::size_t>(right.second)].box.squaredExteriorDistance(p);
        if (left.first < right.first) std::swap(left, right);
        stack[depth++] = left;  // the nearer one comes first
        stack[depth++] = right;
    }
    if (!found) return std::nullopt;
    return on(*found, p);
}

Cloud Surface::sampled(std::size_t count, std::uint64_t seed) const {
    Cloud cloud;
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    const double step = area_ / static_cast<double>(std::max<std::size_t>(1, count));
    double next = step * uniform(random);
    double passed = 0;
    for (const Face& f : faces_) {
        const double area = (f.corner[1] - f.corner[0]).cross(f.corner[2] - f.corner[0]).norm() / 2;
        for (; next < passed + area && cloud.size() < count; next += step) {
            const double u = std::sqrt(uniform(random)), v = uniform(random);
            const Eigen::Vector3d w(1 - u, u * (1 - v), u * v);
            cloud.points.emplace_back(w[0] * f.corner[0] + w[1] * f.corner[1] + w[2] * f.corner[2]);
            cloud.normals.emplace_back(
                (w[0] * f.smooth[0] + w[1] * f.smooth[1] + w[2] * f.smooth[2]).normalized().cast<float>());
        }
        passed += area;
    }
    return cloud;
}

}  // namespace seamwright
