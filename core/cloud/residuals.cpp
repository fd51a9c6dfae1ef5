// What is left between a scan and the part, and what the noise and the form are taken from.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/cloud/fit_steps.h"
#include "core/median.h"

namespace seamwright::fitting {
namespace {

// 0..5: the axis that a normal follows most, and its side.
int facing_of(const Eigen::Vector3d& normal) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return static_cast<int>(2 * axis) + (normal[axis] < 0);
}

using Key = std::array<int, 4>;
Key key_of(const Residual& r, const Eigen::Vector3d& corner, double cell_mm) {
    const Eigen::Vector3d c = (r.place - corner) / cell_mm;
    return {static_cast<int>(std::floor(c.x())), static_cast<int>(std::floor(c.y())),
            static_cast<int>(std::floor(c.z())), facing_of(r.normal)};
}

std::map<Key, std::vector<std::size_t>> cells_of(const std::vector<Residual>& residuals, double cell_mm) {
    Eigen::AlignedBox3d box;
    for (const Residual& r : residuals) box.extend(r.place);
    std::map<Key, std::vector<std::size_t>> cells;
    for (std::size_t i = 0; i < residuals.size(); ++i)
        cells[key_of(residuals[i], box.min(), cell_mm)].push_back(i);
    return cells;
}

double longest(const std::vector<Residual>& residuals) {
    Eigen::AlignedBox3d box;
    for (const Residual& r : residuals) box.extend(r.place);
    constexpr double kLeastSize_mm = 1e-3;
    return box.isEmpty() ? 1 : std::max(kLeastSize_mm, box.diagonal().norm());
}

// Cells of the size at which there are about `count`.
std::map<Key, std::vector<std::size_t>> cells_about(const std::vector<Residual>& residuals,
                                                    std::size_t count) {
    constexpr double kFiner = 1.25;  // from one size of cells to the next
    double cell = longest(residuals);
    auto cells = cells_of(residuals, cell);
    for (int k = 0; k < 24; ++k) {
        auto finer = cells_of(residuals, cell / kFiner);
        if (finer.size() > count) break;
        cell /= kFiner;
        cells = std::move(finer);
    }
    return cells;
}

}  // namespace

std::vector<Residual> residuals_of(const Cloud& cloud, const Surface& surface, const Pose& base_from_part,
                                   double gate_mm, bool facing) {
    const Pose part_from_base = base_from_part.inverse();
    std::vector<Residual> out;
    out.reserve(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        Eigen::Vector3d side;
        const bool known = facing && cloud.has_towards() && !cloud.towards[i].isZero();
        if (known) side = part_from_base.linear() * cloud.towards[i].cast<double>();
        const auto near = surface.nearest(part_from_base * cloud.points[i], gate_mm, known ? &side : nullptr);
        if (!near || near->at_border) continue;
        const double sigma = cloud.has_sigma() ? static_cast<double>(cloud.sigma_mm[i]) : 0;
        out.push_back({base_from_part * near->point, base_from_part.linear() * near->normal, near->signed_mm,
                       sigma * sigma});
    }
    return out;
}

double local_noise_mm(const std::vector<Residual>& residuals) {
    std::vector<double> variances;
    for (const auto& [key, members] :
         cells_about(residuals, std::max<std::size_t>(1, residuals.size() / 8))) {
        if (members.size() < 3) continue;
        double mean = 0, squares = 0;
        for (const std::size_t i : members)
            mean += residuals[i].value_mm / static_cast<double>(members.size());
        for (const std::size_t i : members)
            squares += (residuals[i].value_mm - mean) * (residuals[i].value_mm - mean);
        variances.push_back(squares / static_cast<double>(members.size() - 1));
    }
    // The median of a variance of some eight points lies a tenth below it.
    constexpr double kMeanOfMedian = 1.1;
    return std::sqrt(kMeanOfMedian * median(variances));
}

std::vector<FormNode> form_nodes(const std::vector<Residual>& residuals, const FitSystem& system,
                                 double noise_mm) {
    constexpr double kLeastNoise_mm2 = 1e-10;
    constexpr double kNoNormal = 1e-3;  // length of a mean of normals that cancel each other
    std::vector<FormNode> nodes;
    for (const auto& [key, members] : cells_about(residuals, 180)) {
        FormNode node;
        const auto n = static_cast<double>(members.size());
        for (const std::size_t i : members) {
            const Residual& r = residuals[i];
            node.place_mm += r.place / n;
            node.normal += r.normal / n;
            node.residual_mm += r.value_mm / n;
            node.noise_mm2 += (r.noise_mm2 > 0 ? r.noise_mm2 : noise_mm * noise_mm) / (n * n);
            Vector6 row;
            row << r.normal, (r.place - system.middle).cross(r.normal) / system.spread_mm;
            node.row += row / n;
        }
        node.noise_mm2 = std::max(node.noise_mm2, kLeastNoise_mm2);
        const double length = node.normal.norm();
        if (length < kNoNormal) continue;
        node.normal /= length;
        nodes.push_back(node);
    }
    return nodes;
}

}  // namespace seamwright::fitting
