#include "core/calibration/sphere/tcp_sphere_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/geometry/decompositions.h"

namespace seamwright::tcp_sphere {
namespace {

// A section agrees with a solution that misses its points by no more than this.
constexpr double kAgrees_mm = 0.2;
// Starts in one basin: of the coarse search, and once they have been settled.
constexpr double kSameBasin_rad = 0.05, kSameBasin_mm = 10, kSameMinimum_rad = 0.02, kSameMinimum_mm = 5;
// A free radius is looked for from the largest cut on.
constexpr std::array<double, 3> kRadiusStarts{1.01, 1.15, 1.5};
// Scales of the loss, in millimetre squared: wide while a start is coarse, narrow when what does not belong is to go.
constexpr std::array<double, 3> kSettlingScales{10.0, 3.0, 1.0};
constexpr std::array<double, 2> kSubsetScales{1.0, 0.3};
constexpr double kReweight_mm = 0.1;      // residuals below this count alike in a start
constexpr double kStartRidge = 1e-9;      // on the unit diagonal of a start's normal equations
constexpr double kCoarseScale_mm = 10.0;  // of the loss, where every direction is tried
constexpr std::size_t kCoarseKept = 24;

// Evenly spread directions on the whole sphere (Fibonacci spiral).
Eigen::Vector3d spiral_direction(int i, int n) {
    const double y = 1 - (2 * i + 1.0) / n;
    const double ring = std::sqrt(1 - y * y), angle = i * kPi * (3 - std::sqrt(5.0));
    return {ring * std::cos(angle), y, ring * std::sin(angle)};
}

// For an assumed sensor Y axis n (flange frame) the two in-plane components of R s_i + t = B_i^-1 c are
// linear in (cos, sin) of the turn about n, in the in-plane part of t and in c. Re-weighted against profiles
// that show something else.
Model start_for_axis(const std::vector<Section>& sections, const Eigen::Vector3d& n, double radius) {
    Eigen::Matrix3d basis;  // columns e1, e2, n: right-handed
    basis.col(0) = n.unitOrthogonal();
    basis.col(1) = n.cross(basis.col(0));
    basis.col(2) = n;
    using Vector7 = Eigen::Matrix<double, 7, 1>;
    using Matrix7 = Eigen::Matrix<double, 7, 7>;
    using Matrix2x7 = Eigen::Matrix<double, 2, 7>;
    // Base frame moved to the mean flange position: keeps the normal equations well scaled.
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    double used = 0;
    for (const auto& section : sections) {
        if (!section.used) continue;
        origin -= section.flange_from_base.linear().transpose() * section.flange_from_base.translation();
        used += 1;
    }
    origin /= std::max(1.0, used);
    const auto rows = [&](const Section& section, Matrix2x7& a, Eigen::Vector2d& right) {
        // R s + t - (Rinv (c - origin) + Rinv origin + tinv) = 0
        const double x = section.circle.x_mm, z = section.circle.z_mm;
        const Eigen::Matrix<double, 2, 3> project = basis.leftCols<2>().transpose();
        a.setZero();
        a(0, 0) = x;
        a(0, 1) = z;
        a(1, 0) = -z;
        a(1, 1) = x;
        a(0, 2) = a(1, 3) = 1;
        a.rightCols<3>() = -project * section.flange_from_base.linear();
        right = project * (section.flange_from_base * origin);
    };
    Vector7 solution = Vector7::Zero();
    std::vector<double> weight(sections.size(), 1.0);
    for (int round = 0; round < 3; ++round) {
        Matrix7 h = Matrix7::Zero();
        Vector7 g = Vector7::Zero();
        Matrix2x7 a;
        Eigen::Vector2d right;
        for (size_t i = 0; i < sections.size(); ++i) {
            if (!sections[i].used) continue;
            rows(sections[i], a, right);
            h.noalias() += weight[i] * a.transpose() * a;
            g.noalias() += weight[i] * a.transpose() * right;
        }
        const Vector7 scale = h.diagonal().cwiseMax(kFloor).cwiseSqrt().cwiseInverse();
        h = scale.asDiagonal() * h * scale.asDiagonal();
        h.diagonal().array() += kStartRidge;
        solution = scale.asDiagonal() * solve_symmetric(h, scale.asDiagonal() * g);
        for (size_t i = 0; i < sections.size(); ++i) {
            if (!sections[i].used) continue;
            rows(sections[i], a, right);
            weight[i] = 1 / ((a * solution - right).norm() + kReweight_mm);
        }
    }
    const double length = std::hypot(solution[0], solution[1]);
    const double cosine = length > kFloor ? solution[0] / length : 1,
                 sine = length > kFloor ? solution[1] / length : 0;
    // x axis: cos e1 + sin e2; z axis = x axis cross n: sin e1 - cos e2.
    Model model;
    model.radius = radius;
    Eigen::Matrix3d rotation;
    rotation.col(0) = cosine * basis.col(0) + sine * basis.col(1);
    rotation.col(1) = n;
    rotation.col(2) = sine * basis.col(0) - cosine * basis.col(1);
    model.centre_base = solution.tail<3>() + origin;
    // t again for the unit-length turn, then its component along n from |s_y| = sqrt(r^2 - rho^2).
    Eigen::Vector2d in_plane = Eigen::Vector2d::Zero();
    double sum = 0;
    std::vector<double> along, height;
    for (size_t i = 0; i < sections.size(); ++i) {
        const auto& section = sections[i];
        if (!section.used) continue;
        const Eigen::Vector3d target = section.flange_from_base * model.centre_base;
        const Eigen::Vector3d flat = rotation * Eigen::Vector3d(section.circle.x_mm, 0, section.circle.z_mm);
        in_plane += weight[i] * (basis.leftCols<2>().transpose() * (target - flat));
        sum += weight[i];
        along.push_back(n.dot(target));
        height.push_back(
            std::sqrt(std::max(0.0, radius * radius - section.circle.radius_mm * section.circle.radius_mm)));
    }
    in_plane /= sum;
    double best = std::numeric_limits<double>::infinity(), best_along = 0;
    for (size_t i = 0; i < along.size(); ++i) {
        for (const double sign : {-1.0, 1.0}) {
            const double t_n = along[i] - sign * height[i];
            double cost = 0;
            for (size_t k = 0; k < along.size(); ++k)
                cost += std::min(std::abs(std::abs(along[k] - t_n) - height[k]), radius);
            if (cost < best) {
                best = cost;
                best_along = t_n;
            }
        }
    }
    model.flange_from_sensor = make_pose(rotation, basis.leftCols<2>() * in_plane + best_along * n);
    return model;
}

// All minima worth a look from every assumed axis, best first.
std::vector<Start> search(const std::vector<Section>& sections, double radius, bool radius_free) {
    std::vector<double> radii{radius};
    if (radius_free) {
        radii.clear();
        for (const double factor : kRadiusStarts) radii.push_back(radius * factor);
    }
    constexpr int kDirections = 96;
    std::vector<Start> coarse;
    for (const double r : radii) {
        for (int i = 0; i < kDirections; ++i) {
            Start start{start_for_axis(sections, spiral_direction(i, kDirections), r), 0};
            start.cost = solve_reduced(sections, start.model, false, kCoarseScale_mm, 4);
            if (std::isfinite(start.cost)) coarse.push_back(start);
        }
    }
    std::sort(coarse.begin(), coarse.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
    if (coarse.size() > kCoarseKept) coarse.resize(kCoarseKept);
    std::vector<Start> found;
    const auto same = [](const Start& one, const Start& other, double rad, double mm) {
        return angle_rad(one.model.flange_from_sensor, other.model.flange_from_sensor) < rad &&
               distance_mm(one.model.flange_from_sensor, other.model.flange_from_sensor) < mm;
    };
    for (auto& start : coarse) {
        // Most starts have already run into a minimum that is known.
        if (std::any_of(found.begin(), found.end(), [&](const Start& other) {
                return same(start, other, kSameBasin_rad, kSameBasin_mm);
            }))
            continue;
        for (const double scale : kSettlingScales)
            start.cost = solve_reduced(sections, start.model, radius_free, scale, 25);
        const bool known = std::any_of(found.begin(), found.end(), [&](const Start& other) {
            return same(start, other, kSameMinimum_rad, kSameMinimum_mm);
        });
        if (!known && std::isfinite(start.cost)) found.push_back(start);
    }
    std::sort(found.begin(), found.end(), [](const Start& a, const Start& b) { return a.cost < b.cost; });
    if (found.size() > 4) found.resize(4);
    return found;
}

int agreeing(const std::vector<Section>& sections, const Model& model) {
    int count = 0;
    for (const auto& section : sections)
        count +=
            section.used && disagreement(section, model) / section.count() < kAgrees_mm * kAgrees_mm ? 1 : 0;
    return count;
}

}  // namespace

std::vector<Start> global_start(const std::vector<Section>& sections, double radius, bool radius_free,
                                bool subsets) {
    auto found = search(sections, radius, radius_free);
    std::vector<size_t> used;
    for (size_t i = 0; i < sections.size(); ++i)
        if (sections[i].used) used.push_back(i);
    const size_t few = radius_free ? 6 : 5;
    int best = found.empty() ? 0 : agreeing(sections, found.front().model);
    if (!subsets || best == static_cast<int>(used.size()) || used.size() <= few) return found;
    // Some profiles show something else: search within small subsets, count who agrees, polish on all.
    std::mt19937 random(7u);
    int since_better = 0;  // once most profiles agree, a dozen subsets without a better answer are enough
    for (int trial = 0; trial < 40 && best < static_cast<int>(used.size()) - 1; ++trial) {
        if (++since_better > 12 && 2 * best > static_cast<int>(used.size())) break;
        std::vector<Section> subset;
        std::vector<size_t> pick = used;
        for (size_t k = 0; k < few; ++k) {
            std::swap(pick[k], pick[k + random() % (pick.size() - k)]);
            subset.push_back(sections[pick[k]]);
        }
        for (auto& start : search(subset, radius, radius_free)) {
            if (agreeing(subset, start.model) < static_cast<int>(few)) continue;
            for (const double scale : kSubsetScales)
                start.cost = solve_reduced(sections, start.model, radius_free, scale, 25);
            const int count = agreeing(sections, start.model);
            if (count <= std::max(best, static_cast<int>(few) - 1)) continue;
            best = count;
            since_better = 0;
            start.cost = solve_reduced(sections, start.model, radius_free, 1.0, 25);
            found.insert(found.begin(), start);
        }
    }
    if (found.size() > 4) found.resize(4);
    return found;
}

}  // namespace seamwright::tcp_sphere
