#include "core/cloud/edge/sheet_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <unordered_map>
#include <unordered_set>

#include "core/geometry/decompositions.h"
#include "core/median.h"

namespace seamwright {
namespace {

using Eigen::Vector3d;
constexpr double kOpenDeg = 100;       // of a straight border's 180, a corner's 270, a surrounded point's 45
constexpr double kSurroundedDeg = 75;  // open about a point at most
constexpr double kOnePoint_mm2 = 1e-12;  // squared distance
// Of the cloud's size: between these the radius is looked for, growing by steps of kRadiusGrows until it surrounds
// kMostSurrounded of the points asked.
constexpr double kLeastRadius = 1e-4, kMostRadius = 0.2, kRadiusGrows = 1.3, kMostSurrounded = 0.6;
// The flat cone of a sheet: half its thickness in the noise or of the radius, and its slope.
constexpr double kThickNoise = 2.5, kThickShare = 0.02, kConeSlope = 0.06;
constexpr double kLeastTriple = 0.05;  // of the radius' square: twice the area of a triple that tells a plane
constexpr std::size_t kMostPoints = 200000, kMostCandidates = 20000;

// Points by cubes of one size.
class PointGrid {
  public:
    PointGrid(const std::vector<Vector3d>& points, double cell_mm) : points_(points), cell_(cell_mm) {
        for (std::size_t i = 0; i < points.size(); ++i) cells_[key(points[i], 0, 0, 0)].push_back(i);
    }
    // Within a cell's size of p, itself included.
    void near(const Vector3d& p, std::vector<std::size_t>& out) const {
        out.clear();
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z)
                    if (const auto c = cells_.find(key(p, x, y, z)); c != cells_.end())
                        for (const std::size_t i : c->second)
                            if ((points_[i] - p).squaredNorm() <= cell_ * cell_) out.push_back(i);
    }
    // The first point of every cell.
    std::vector<std::size_t> firsts() const {
        std::vector<std::size_t> out;
        for (const auto& [k, members] : cells_) out.push_back(members.front());
        std::sort(out.begin(), out.end());
        return out;
    }

  private:
    std::int64_t key(const Vector3d& p, int x, int y, int z) const {
        const auto part = [&](double v, int step) {
            return (static_cast<std::int64_t>(std::floor(v / cell_)) + step) & 0x1fffff;
        };
        return part(p.x(), x) << 42 | part(p.y(), y) << 21 | part(p.z(), z);
    }
    const std::vector<Vector3d>& points_;
    double cell_;
    std::unordered_map<std::int64_t, std::vector<std::size_t>> cells_;
};

std::vector<Vector3d> one_a_cell(const std::vector<Vector3d>& points, double cell_mm) {
    std::vector<Vector3d> out;
    for (const std::size_t i : PointGrid(points, cell_mm).firsts()) out.push_back(points[i]);
    return out;
}

struct Directions {
    Vector3d u, v;
};
Directions across(const Vector3d& normal) {
    const Vector3d u = normal.unitOrthogonal();
    return {u, normal.cross(u)};
}

// The largest opening between the directions of those in the plane, degrees, and its middle.
double opening(const std::vector<Vector3d>& offsets, const Vector3d& normal, Vector3d& middle) {
    const Directions d = across(normal);
    std::vector<double> angles;
    for (const Vector3d& o : offsets) angles.push_back(std::atan2(o.dot(d.v), o.dot(d.u)));
    std::sort(angles.begin(), angles.end());
    double most = 0, at = 0;
    for (std::size_t i = 0; i < angles.size(); ++i) {
        const double next = i + 1 < angles.size() ? angles[i + 1] : angles.front() + 2 * kPi;
        if (next - angles[i] > most) most = next - angles[i], at = (next + angles[i]) / 2;
    }
    middle = std::cos(at) * d.u + std::sin(at) * d.v;
    return deg_from_rad(most);
}

// Plane of all neighbours: normal, and the scatter about it.
double plane_of(const std::vector<Vector3d>& offsets, Vector3d& normal) {
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& o : offsets) mean += o / static_cast<double>(offsets.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Vector3d& o : offsets) spread += (o - mean) * (o - mean).transpose();
    const SymmetricEigen e = symmetric_eigen(spread);
    normal = e.vectors.col(0);
    return std::sqrt(std::max(0.0, e.values[0]) / std::max(1.0, static_cast<double>(offsets.size()) - 3));
}

bool surrounded(const std::vector<Vector3d>& offsets, const Vector3d& normal) {
    Vector3d middle;
    return offsets.size() >= 8 && opening(offsets, normal, middle) < kSurroundedDeg;
}

}  // namespace

SheetEnds sheet_ends(const Cloud& given, const std::function<bool()>& cancelled) {
    SheetEnds out;
    const Cloud cloud = thinned(given, kMostPoints);
    if (cloud.size() < 50) return out;
    const double size = cloud.box().diagonal().norm();
    std::mt19937_64 random(11);
    std::vector<std::size_t> near;
    std::vector<Vector3d> offsets;
    const auto look = [&](const PointGrid& grid, const std::vector<Vector3d>& points, const Vector3d& p) {
        grid.near(p, near);
        offsets.clear();
        for (const std::size_t i : near)
            if (const Vector3d o = points[i] - p; o.squaredNorm() > kOnePoint_mm2) offsets.push_back(o);
    };
    double radius = std::max(2 * spacing_mm(cloud), kLeastRadius * size);
    for (; radius < kMostRadius * size; radius *= kRadiusGrows) {
        const PointGrid grid(cloud.points, radius);
        constexpr int kAsked = 300;
        int round = 0;
        std::vector<double> scatter;
        for (int k = 0; k < kAsked; ++k) {
            look(grid, cloud.points, cloud.points[random() % cloud.size()]);
            if (offsets.size() < 8) continue;
            Vector3d normal;
            const double s = plane_of(offsets, normal);
            if (!surrounded(offsets, normal)) continue;
            ++round;
            scatter.push_back(s);
        }
        if (round < kMostSurrounded * kAsked) continue;
        out.noise_mm = median(scatter);
        break;
    }
    if (!(radius < kMostRadius * size)) return out;
    // Twice the radius that surrounds a point: an end has but half of the neighbours.
    radius *= 2;
    out.radius_mm = radius;
    const std::vector<Vector3d> points = one_a_cell(cloud.points, radius / 8);
    const PointGrid grid(points, radius);
    const double thick = std::max(kThickNoise * out.noise_mm, kThickShare * radius);
    const std::size_t stride = std::max<std::size_t>(1, points.size() / kMostCandidates);
    std::vector<Vector3d> best, with;
    for (std::size_t i = 0; i < points.size(); i += stride) {
        if (i % 256 == 0 && cancelled && cancelled()) return {};
        look(grid, points, points[i]);
        if (offsets.size() < 6) continue;
        best.clear();
        Vector3d normal = Vector3d::UnitZ();
        for (int trial = 0; trial < 24; ++trial) {
            const Vector3d n = offsets[random() % offsets.size()].cross(offsets[random() % offsets.size()]);
            if (n.norm() < kLeastTriple * radius * radius) continue;
            const Vector3d unit = n.normalized();
            with.clear();
            for (const Vector3d& o : offsets)
                if (std::abs(o.dot(unit)) < thick + kConeSlope * o.norm()) with.push_back(o);
            if (with.size() > best.size()) best = with, normal = unit;
        }
        if (best.size() < 6) continue;
        SheetEnd end{points[i], Vector3d::Zero(), normal};
        if (opening(best, normal, end.outward) > kOpenDeg) out.ends.push_back(end);
    }
    return out;
}

}  // namespace seamwright
