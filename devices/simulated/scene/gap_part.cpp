#include "devices/simulated/scene/gap_part.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace seamwright {
namespace {

constexpr double kFlankDepth_mm = 8, kSheet_mm = 60;

}  // namespace

std::vector<GapStation> default_gap_stations() {
    return {{-150, 5, 0.0}, {-85, 5, 0.0},  {-84, 0, 0.0}, {-76, 0, 0.0}, {-75, 5, 0.0},
            {20, 5, 0.3},   {60, 2.6, 0.5}, {100, 5, 0.5}, {150, 5, 0.5}};
}

TriangleMesh gap_part_mesh(const std::vector<GapStation>& stations, double fold_mm) {
    assert(stations.size() >= 2);
    assert(std::is_sorted(stations.begin(), stations.end(),
                          [](const GapStation& a, const GapStation& b) { return a.y_mm < b.y_mm; }));
    // Into the sheet, over the sheet.
    std::vector<Eigen::Vector2d> section{{0, -kFlankDepth_mm}};
    constexpr int kFacets = 32;
    if (fold_mm > 0)
        for (int k = 0; k <= kFacets; ++k) {
            const double a = std::numbers::pi / 2 * k / kFacets;
            section.emplace_back(fold_mm * (1 - std::cos(a)), fold_mm * (std::sin(a) - 1));
        }
    else
        section.emplace_back(0, 0);
    section.emplace_back(kSheet_mm, 0);

    const int rows = static_cast<int>(section.size());
    TriangleMesh mesh;
    for (const double side : {-1.0, 1.0}) {
        const int first = static_cast<int>(mesh.vertices.size());
        for (const GapStation& s : stations)
            for (const Eigen::Vector2d& c : section)
                mesh.vertices.emplace_back(side * (s.width_mm / 2 + c.x()), s.y_mm,
                                           c.y() + (side > 0 ? s.flush_mm : 0));
        const auto at = [&](std::size_t i, int row) { return first + static_cast<int>(i) * rows + row; };
        for (std::size_t i = 0; i + 1 < stations.size(); ++i)
            for (int r = 0; r + 1 < rows; ++r) {
                mesh.triangles.emplace_back(at(i, r), at(i + 1, r), at(i, r + 1));
                mesh.triangles.emplace_back(at(i + 1, r), at(i + 1, r + 1), at(i, r + 1));
            }
    }
    return mesh;
}

GapStation gap_at(const std::vector<GapStation>& stations, double y_mm) {
    const auto after = std::lower_bound(stations.begin(), stations.end(), y_mm,
                                        [](const GapStation& s, double y) { return s.y_mm < y; });
    if (after == stations.begin()) return stations.front();
    if (after == stations.end()) return stations.back();
    const GapStation &a = *std::prev(after), &b = *after;
    const double u = (y_mm - a.y_mm) / (b.y_mm - a.y_mm);
    return {y_mm, (1 - u) * a.width_mm + u * b.width_mm, (1 - u) * a.flush_mm + u * b.flush_mm};
}

}  // namespace seamwright
