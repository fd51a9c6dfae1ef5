#include "devices/simulated/scene/mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace seamwright {
namespace {

constexpr int kLeafSize = 4;
constexpr int kBins = 16;
constexpr int kStack = 96;
constexpr std::int32_t kSamples = 128;  // triangles by which a node's split is chosen

// Where triangles lie, as far as the choice of a split needs it.
struct Bounds {
    std::array<float, 3> low = {kFar, kFar, kFar}, high = {-kFar, -kFar, -kFar};
    static constexpr float kFar = std::numeric_limits<float>::infinity();
    void extend(const std::array<float, 3>& p) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    void extend(const Eigen::Vector3d& p) {
        extend(std::array<float, 3>{static_cast<float>(p.x()), static_cast<float>(p.y()),
                                    static_cast<float>(p.z())});
    }
    void extend(const Bounds& other) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], other.low[k]);
            high[k] = std::max(high[k], other.high[k]);
        }
    }
    std::array<float, 3> middle() const {
        return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
    }
    float area() const {
        const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
        return x * y + y * z + z * x;
    }
};

float down(double v) {
    return std::nextafter(static_cast<float>(v), -std::numeric_limits<float>::infinity());
}
float up(double v) {
    return std::nextafter(static_cast<float>(v), std::numeric_limits<float>::infinity());
}

// Ray against a box grown by rounding: true when they meet before `limit`; `entry` orders the children.
struct BoxTest {
    Eigen::Vector3f origin, inverse;
    BoxTest(const Eigen::Vector3d& o, const Eigen::Vector3d& d) : origin(o.cast<float>()) {
        for (int k = 0; k < 3; ++k) {
            const double v = std::abs(d[k]) < 1e-12 ? std::copysign(1e-12, d[k]) : d[k];
            inverse[k] = static_cast<float>(1.0 / v);
        }
    }
    bool meets(const Eigen::Vector3f& low, const Eigen::Vector3f& high, float limit, float& entry) const {
        float near = -1e-3F, far = limit;
        for (int k = 0; k < 3; ++k) {
            float t0 = (low[k] - origin[k]) * inverse[k], t1 = (high[k] - origin[k]) * inverse[k];
            if (t0 > t1) std::swap(t0, t1);
            near = std::max(near, t0 - 1e-4F * std::abs(t0));
            far = std::min(far, t1 + 1e-4F * std::abs(t1));
        }
        entry = near;
        return near <= far;
    }
};

}  // namespace

MeshTree::MeshTree(TriangleMesh mesh) : mesh_(std::move(mesh)) {
    build();
    fit();
}

void MeshTree::build() {
    const auto n = static_cast<std::int32_t>(mesh_.triangles.size());
    order_.resize(static_cast<std::size_t>(n));
    std::iota(order_.begin(), order_.end(), 0);
    std::vector<Bounds> boxes(order_.size());
    std::vector<std::array<float, 3>> middles(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
        for (int k = 0; k < 3; ++k)
            boxes[i].extend(mesh_.vertices[static_cast<std::size_t>(mesh_.triangles[i][k])]);
        middles[i] = boxes[i].middle();
    }
    nodes_.clear();
    nodes_.push_back({{}, {}, 0, n});
    std::vector<std::int32_t> open = {0};
    while (!open.empty()) {
        const std::int32_t at = open.back();
        open.pop_back();
        const std::int32_t first = nodes_[static_cast<std::size_t>(at)].first;
        const std::int32_t count = nodes_[static_cast<std::size_t>(at)].count;
        if (count <= kLeafSize) continue;
        const std::int32_t stride = std::max(1, count / kSamples);
        const auto sample = [&](std::int32_t i) {
            return static_cast<std::size_t>(order_[static_cast<std::size_t>(i)]);
        };
        Bounds spread;
        int samples = 0;
        for (std::int32_t i = first; i < first + count; i += stride, ++samples)
            spread.extend(middles[sample(i)]);
        int best_axis = -1, best_bin = 0;
        float best_cost = std::numeric_limits<float>::infinity();
        const auto bin_of = [&](std::size_t triangle, std::size_t axis) {
            const float place =
                (middles[triangle][axis] - spread.low[axis]) / (spread.high[axis] - spread.low[axis]) * kBins;
            return static_cast<int>(std::clamp(place, 0.0F, kBins - 1.0F));
        };
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!(spread.high[axis] > spread.low[axis])) continue;
            std::array<Bounds, kBins> bin;
            std::array<int, kBins> in{};
            for (std::int32_t i = first; i < first + count; i += stride) {
                const std::size_t t = sample(i);
                const auto b = static_cast<std::size_t>(bin_of(t, axis));
                bin[b].extend(boxes[t]);
                ++in[b];
            }
            std::array<float, kBins> right{};
            Bounds grown;
            int number = 0;
            for (std::size_t b = kBins - 1; b > 0; --b) {
                grown.extend(bin[b]);
                number += in[b];
                right[b] = number > 0 ? grown.area() * static_cast<float>(number) : 0;
            }
            grown = {};
            number = 0;
            for (std::size_t b = 0; b + 1 < kBins; ++b) {
                grown.extend(bin[b]);
                number += in[b];
                if (number == 0 || number == samples) continue;
                const float cost = grown.area() * static_cast<float>(number) + right[b + 1];
                if (cost < best_cost) {
                    best_cost = cost;
                    best_axis = static_cast<int>(axis);
                    best_bin = static_cast<int>(b);
                }
            }
        }
        auto middle = order_.begin() + first + count / 2;
        if (best_axis >= 0) {
            middle =
                std::partition(order_.begin() + first, order_.begin() + first + count, [&](std::int32_t t) {
                    return bin_of(static_cast<std::size_t>(t), static_cast<std::size_t>(best_axis)) <=
                           best_bin;
                });
        }
        const auto split = static_cast<std::int32_t>(middle - order_.begin());
        const auto left = static_cast<std::int32_t>(nodes_.size());
        nodes_.push_back({{}, {}, first, split - first});
        nodes_.push_back({{}, {}, split, first + count - split});
        nodes_[static_cast<std::size_t>(at)].first = left;
        nodes_[static_cast<std::size_t>(at)].count = 0;
        open.push_back(left);
        open.push_back(left + 1);
    }
}

void MeshTree::fit() {
    corners_.resize(order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) {
        const auto& t = mesh_.triangles[static_cast<std::size_t>(order_[i])];
        const auto& a = mesh_.vertices[static_cast<std::size_t>(t[0])];
        corners_[i] = {a, mesh_.vertices[static_cast<std::size_t>(t[1])] - a,
                       mesh_.vertices[static_cast<std::size_t>(t[2])] - a};
    }
    for (std::size_t n = nodes_.size(); n-- > 0;) {  // children stand behind their parents
        Node& node = nodes_[n];
        if (node.count == 0 && !order_.empty()) {
            const Node& l = nodes_[static_cast<std::size_t>(node.first)];
            const Node& r = nodes_[static_cast<std::size_t>(node.first) + 1];
            node.low = l.low.cwiseMin(r.low);
            node.high = l.high.cwiseMax(r.high);
            continue;
        }
        Eigen::AlignedBox3d box;
        for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
            const Corner& c = corners_[static_cast<std::size_t>(i)];
            box.extend(c.p);
            box.extend(c.p + c.e1);
            box.extend(c.p + c.e2);
        }
        if (box.isEmpty()) box.extend(Eigen::Vector3d::Zero());
        for (int k = 0; k < 3; ++k) {
            node.low[k] = down(box.min()[k]);
            node.high[k] = up(box.max()[k]);
        }
    }
}

void MeshTree::move_vertices(std::vector<Eigen::Vector3d> vertices) {
    mesh_.vertices = std::move(vertices);
    fit();
}

Eigen::Vector3d MeshTree::normal(int triangle) const {
    const auto& t = mesh_.triangles[static_cast<std::size_t>(triangle)];
    const auto& a = mesh_.vertices[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3d n = (mesh_.vertices[static_cast<std::size_t>(t[1])] - a)
                                  .cross(mesh_.vertices[static_cast<std::size_t>(t[2])] - a);
    const double length = n.norm();
    return length > 0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

// Moeller-Trumbore, both sides.
bool MeshTree::hits(std::size_t slot, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                    double& t) const {
    const Corner& c = corners_[slot];
    const Eigen::Vector3d h = direction.cross(c.e2);
    const double det = c.e1.dot(h);
    if (det == 0) return false;
    const double inverse = 1.0 / det;
    const Eigen::Vector3d s = origin - c.p;
    const double u = s.dot(h) * inverse;
    if (!(u >= 0 && u <= 1)) return false;
    const Eigen::Vector3d q = s.cross(c.e1);
    const double v = direction.dot(q) * inverse;
    if (!(v >= 0 && u + v <= 1)) return false;
    t = c.e2.dot(q) * inverse;
    return true;
}

std::optional<RayHit> MeshTree::first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                          double min_mm, double max_mm, int ignore) const {
    RayHit best{max_mm, -1};
    const BoxTest test(origin, direction);
    std::array<std::int32_t, kStack> stack;
    int top = 0;
    stack[static_cast<std::size_t>(top++)] = 0;
    while (top > 0) {
        const Node& node = nodes_[static_cast<std::size_t>(stack[static_cast<std::size_t>(--top)])];
        float entry;
        if (!test.meets(node.low, node.high, static_cast<float>(best.distance_mm) * 1.0001F, entry)) continue;
        if (node.count > 0) {
            for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
                const auto slot = static_cast<std::size_t>(i);
                double t;
                if (order_[slot] != ignore && hits(slot, origin, direction, t) && t > min_mm &&
                    t < best.distance_mm) {
                    best = {t, order_[slot]};
                }
            }
            continue;
        }
        if (order_.empty()) break;
        const Node& l = nodes_[static_cast<std::size_t>(node.first)];
        const Node& r = nodes_[static_cast<std::size_t>(node.first) + 1];
        float tl, tr;
        const auto limit = static_cast<float>(best.distance_mm) * 1.0001F;
        const bool left = test.meets(l.low, l.high, limit, tl), right = test.meets(r.low, r.high, limit, tr);
        const bool left_first = tl <= tr;
        if (top + 2 > kStack) continue;
        if (left && right) {
            stack[static_cast<std::size_t>(top++)] = node.first + (left_first ? 1 : 0);
            stack[static_cast<std::size_t>(top++)] = node.first + (left_first ? 0 : 1);
        } else if (left) {
            stack[static_cast<std::size_t>(top++)] = node.first;
        } else if (right) {
            stack[static_cast<std::size_t>(top++)] = node.first + 1;
        }
    }
    if (best.triangle < 0) return std::nullopt;
    return best;
}

bool MeshTree::blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int ignore,
                       double skip_mm) const {
    const Eigen::Vector3d way = to - from;
    const double length = way.norm();
    if (length <= 2 * skip_mm || order_.empty()) return false;
    const Eigen::Vector3d direction = way / length;
    const BoxTest test(from, direction);
    const double last = length - skip_mm;
    std::array<std::int32_t, kStack> stack;
    int top = 0;
    stack[static_cast<std::size_t>(top++)] = 0;
    while (top > 0) {
        const Node& node = nodes_[static_cast<std::size_t>(stack[static_cast<std::size_t>(--top)])];
        float entry;
        if (!test.meets(node.low, node.high, static_cast<float>(length), entry)) continue;
        if (node.count == 0) {
            if (top + 2 > kStack) continue;
            stack[static_cast<std::size_t>(top++)] = node.first;
            stack[static_cast<std::size_t>(top++)] = node.first + 1;
            continue;
        }
        for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
            const auto slot = static_cast<std::size_t>(i);
            double t;
            if (order_[slot] != ignore && hits(slot, from, direction, t) && t > skip_mm && t < last)
                return true;
        }
    }
    return false;
}

void MeshTree::cut(const Eigen::Vector3d& normal, double offset_mm, const Eigen::Vector3d& centre,
                   double radius_mm, std::vector<CutSegment>& segments) const {
    segments.clear();
    if (order_.empty()) return;
    const Eigen::Vector3f n = normal.cast<float>(), n_abs = n.cwiseAbs();
    const Eigen::Vector3f low = (centre.array() - radius_mm).matrix().cast<float>();
    const Eigen::Vector3f high = (centre.array() + radius_mm).matrix().cast<float>();
    std::array<std::int32_t, kStack> stack;
    int top = 0;
    stack[static_cast<std::size_t>(top++)] = 0;
    while (top > 0) {
        const Node& node = nodes_[static_cast<std::size_t>(stack[static_cast<std::size_t>(--top)])];
        if ((node.low.array() > high.array()).any() || (node.high.array() < low.array()).any()) continue;
        const Eigen::Vector3f c = 0.5F * (node.low + node.high), half = 0.5F * (node.high - node.low);
        if (std::abs(n.dot(c) - static_cast<float>(offset_mm)) > n_abs.dot(half) + 1e-2F) continue;
        if (node.count == 0) {
            if (top + 2 > kStack) continue;
            stack[static_cast<std::size_t>(top++)] = node.first;
            stack[static_cast<std::size_t>(top++)] = node.first + 1;
            continue;
        }
        for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
            const Corner& corner = corners_[static_cast<std::size_t>(i)];
            const Eigen::Vector3d p[3] = {corner.p, corner.p + corner.e1, corner.p + corner.e2};
            double d[3];
            int above = 0;
            for (int k = 0; k < 3; ++k) {
                d[k] = normal.dot(p[k]) - offset_mm;
                above += d[k] >= 0;
            }
            if (above == 0 || above == 3) continue;
            CutSegment segment;
            segment.triangle = order_[static_cast<std::size_t>(i)];
            int found = 0;
            for (int k = 0; k < 3; ++k) {
                const int m = (k + 1) % 3;
                if ((d[k] >= 0) == (d[m] >= 0)) continue;
                const Eigen::Vector3d x = p[k] + (p[m] - p[k]) * (d[k] / (d[k] - d[m]));
                (found++ == 0 ? segment.a : segment.b) = x;
            }
            segments.push_back(segment);
        }
    }
}

}  // namespace seamwright
