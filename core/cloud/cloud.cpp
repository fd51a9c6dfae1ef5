#include "core/cloud/cloud.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace seamwright {
namespace {

constexpr double kLastCell = 2097151;      // of 21 bits
constexpr float kNoDirection = 1e-6F;      // length of a mean of directions that cancel each other
constexpr double kSmallestCell_mm = 1e-6;  // where a cloud is thinned
constexpr double kMostCellsAlong = 2e6;    // a cloud's longest side, so that they have their 21 bits

// Cells are counted from the cloud's lower corner; 21 bits a coordinate. The last bit is the side from which a point was seen: the
// mean of both faces of a sheet lies on neither.
std::uint64_t cell_of(const Cloud& cloud, std::size_t i, const Eigen::Vector3d& corner, double cell_mm) {
    const Eigen::Array3d c = ((cloud.points[i] - corner).array() / cell_mm).floor().max(0.0).min(kLastCell);
    std::uint64_t cell = static_cast<std::uint64_t>(c.x()) | static_cast<std::uint64_t>(c.y()) << 21 |
                         static_cast<std::uint64_t>(c.z()) << 42;
    if (cloud.has_towards()) {
        Eigen::Index most = 0;
        cloud.towards[i].cwiseAbs().maxCoeff(&most);
        cell |= static_cast<std::uint64_t>(cloud.towards[i][most] < 0) << 63;
    }
    return cell;
}

struct Mixer {
    std::size_t operator()(std::uint64_t k) const {
        k *= 0x9E3779B97F4A7C15ULL;
        return static_cast<std::size_t>(k ^ (k >> 29));
    }
};

std::size_t cells_in(const Cloud& cloud, const Eigen::Vector3d& corner, double cell_mm, std::size_t most) {
    std::unordered_map<std::uint64_t, char, Mixer> seen;
    seen.reserve(std::min(cloud.size(), 2 * most));
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        seen.emplace(cell_of(cloud, i, corner, cell_mm), 0);
        if (seen.size() > most) break;
    }
    return seen.size();
}

}  // namespace

Eigen::AlignedBox3d Cloud::box() const {
    Eigen::AlignedBox3d b;
    for (const auto& p : points) b.extend(p);
    return b;
}

void transform(Cloud& cloud, const Pose& to_from) {
    const Eigen::Matrix3f turn = to_from.linear().cast<float>();
    for (auto& p : cloud.points) p = to_from * p;
    for (auto& n : cloud.normals) n = turn * n;
    for (auto& n : cloud.towards) n = turn * n;
}

Cloud picked(const Cloud& cloud, const std::vector<std::size_t>& index) {
    Cloud out;
    const auto take = [&](const auto& from, auto& to) {
        to.reserve(index.size());
        for (const std::size_t i : index) to.push_back(from[i]);
    };
    take(cloud.points, out.points);
    if (cloud.has_normals()) take(cloud.normals, out.normals);
    if (cloud.has_towards()) take(cloud.towards, out.towards);
    if (cloud.has_sigma()) take(cloud.sigma_mm, out.sigma_mm);
    return out;
}

void append(Cloud& cloud, const Cloud& more) {
    if (more.empty()) return;
    const bool first = cloud.empty();
    const auto join = [&](auto& to, const auto& from, bool both) {
        if (both)
            to.insert(to.end(), from.begin(), from.end());
        else
            to.clear();
    };
    join(cloud.normals, more.normals, (first || cloud.has_normals()) && more.has_normals());
    join(cloud.towards, more.towards, (first || cloud.has_towards()) && more.has_towards());
    join(cloud.sigma_mm, more.sigma_mm, (first || cloud.has_sigma()) && more.has_sigma());
    cloud.points.insert(cloud.points.end(), more.points.begin(), more.points.end());
}

void append_profile(Cloud& cloud, const Profile& profile, const Pose& base_from_sensor, double sigma_mm) {
    Cloud more;
    const Eigen::Vector3f up = base_from_sensor.linear().col(2).cast<float>();
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (!std::isfinite(profile.x_mm[i]) || !std::isfinite(profile.z_mm[i])) continue;
        if (profile.filtered() && profile.segment[i] == kOutlier) continue;
        more.points.push_back(base_from_sensor * Eigen::Vector3d(profile.x_mm[i], 0, profile.z_mm[i]));
    }
    more.towards.assign(more.size(), up);
    if (sigma_mm > 0) more.sigma_mm.assign(more.size(), static_cast<float>(sigma_mm));
    append(cloud, more);
}

Cloud voxel_grid(const Cloud& cloud, double cell_mm, std::vector<std::uint32_t>* counts) {
    Cloud out;
    if (cloud.empty()) return out;
    const Eigen::Vector3d corner = cloud.box().min();
    std::unordered_map<std::uint64_t, std::uint32_t, Mixer> slot;
    std::vector<std::uint32_t> count;
    const bool normals = cloud.has_normals(), towards = cloud.has_towards(), sigma = cloud.has_sigma();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const auto [at, fresh] =
            slot.emplace(cell_of(cloud, i, corner, cell_mm), static_cast<std::uint32_t>(out.size()));
        if (fresh) {
            out.points.emplace_back(Eigen::Vector3d::Zero());
            if (normals) out.normals.emplace_back(Eigen::Vector3f::Zero());
            if (towards) out.towards.emplace_back(Eigen::Vector3f::Zero());
            if (sigma) out.sigma_mm.push_back(0);
            count.push_back(0);
        }
        const std::uint32_t s = at->second;
        out.points[s] += cloud.points[i] - corner;
        if (normals) {
            // Of undecided sign where no sensor is known: on the side of what is there already.
            const float side = out.normals[s].dot(cloud.normals[i]) < 0 && !towards ? -1.0F : 1.0F;
            out.normals[s] += side * cloud.normals[i];
        }
        if (towards) out.towards[s] += cloud.towards[i];
        if (sigma) out.sigma_mm[s] += cloud.sigma_mm[i] * cloud.sigma_mm[i];
        ++count[s];
    }
    const auto unit = [](Eigen::Vector3f& v) {
        const float length = v.norm();
        v = length > kNoDirection ? Eigen::Vector3f(v / length) : Eigen::Vector3f::Zero();
    };
    for (std::size_t s = 0; s < out.size(); ++s) {
        out.points[s] = corner + out.points[s] / count[s];
        if (normals) unit(out.normals[s]);
        if (towards) unit(out.towards[s]);
        if (sigma) out.sigma_mm[s] = std::sqrt(out.sigma_mm[s]) / static_cast<float>(count[s]);
    }
    if (counts) *counts = std::move(count);
    return out;
}

Cloud thinned(const Cloud& cloud, std::size_t most, std::vector<std::uint32_t>* counts) {
    if (cloud.size() <= most || most == 0) {
        if (counts) counts->assign(cloud.size(), 1);
        return cloud;
    }
    const Eigen::AlignedBox3d box = cloud.box();
    double cell = std::max(box.sizes().maxCoeff(), kSmallestCell_mm);
    // The smallest cell of the series that does not go beyond `most`.
    while (cells_in(cloud, box.min(), cell / std::sqrt(2.0), most) <= most &&
           cell > box.sizes().maxCoeff() / kMostCellsAlong)
        cell /= std::sqrt(2.0);
    return voxel_grid(cloud, cell, counts);
}

}  // namespace seamwright
