#include "core/cloud/deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace seamwright {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using Cell = std::tuple<int, int, int, int>;

Cell cell_at(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, double size) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return {static_cast<int>(std::floor(p.x() / size)), static_cast<int>(std::floor(p.y() / size)),
            static_cast<int>(std::floor(p.z() / size)), static_cast<int>(2 * axis) + (normal[axis] < 0)};
}

struct Place {
    std::size_t count = 0;
    double sum = 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
};

}  // namespace

void make_histogram(DeviationMap& map, int bins) {
    std::vector<float> sizes;
    for (const float v : map.signed_mm)
        if (std::isfinite(v)) sizes.push_back(std::abs(v));
    if (sizes.empty() || bins < 1) return;
    // Wide enough for all but one in a thousand; the outer bins take the rest.
    constexpr double kWithin = 0.999, kLeastReach_mm = 1e-6;
    const auto at =
        sizes.begin() + static_cast<std::ptrdiff_t>(kWithin * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), at, sizes.end());
    const double reach = std::max(kLeastReach_mm, static_cast<double>(*at)), width = 2 * reach / bins;
    for (int k = 0; k < bins; ++k) map.histogram.push_back({-reach + k * width, -reach + (k + 1) * width, 0});
    for (const float v : map.signed_mm) {
        if (!std::isfinite(v)) continue;
        const int k =
            std::clamp(static_cast<int>(std::floor((static_cast<double>(v) + reach) / width)), 0, bins - 1);
        ++map.histogram[static_cast<std::size_t>(k)].count;
    }
}

DeviationMap deviation_map(const Cloud& cloud, const Surface& surface, const Pose& base_from_part,
                           const DeviationOptions& options) {
    DeviationMap map;
    map.signed_mm.assign(cloud.size(), static_cast<float>(kNaN));
    if (cloud.empty() || surface.empty()) return map;
    const Pose part_from_base = base_from_part.inverse();
    constexpr double kPlaceCell = 0.025;  // of the part's size: points of one place
    const double cell = kPlaceCell * surface.size_mm();
    std::map<Cell, Place> places;
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        if (i % 65536 == 0 && options.cancelled && options.cancelled()) {
            map.cancelled = true;
            return map;
        }
        Eigen::Vector3d side;
        if (cloud.has_towards()) side = part_from_base.linear() * cloud.towards[i].cast<double>();
        const Eigen::Vector3d p = part_from_base * cloud.points[i];
        const auto near = surface.nearest(p, options.most_mm, cloud.has_towards() ? &side : nullptr);
        if (!near || near->at_border) continue;
        map.signed_mm[i] = static_cast<float>(near->signed_mm);
        ++map.counted;
        sum += near->signed_mm;
        squares += near->signed_mm * near->signed_mm;
        Place& place = places[cell_at(near->point, near->normal, cell)];
        ++place.count;
        place.sum += near->signed_mm;
        place.middle += near->point;
    }
    if (map.counted == 0) return map;
    const auto n = static_cast<double>(map.counted);
    map.mean_mm = sum / n;
    map.rms_mm = std::sqrt(squares / n);
    map.three_sigma_mm = 3 * std::sqrt(std::max(0.0, squares / n - map.mean_mm * map.mean_mm));
    for (const auto& [key, place] : places) {
        if (static_cast<double>(place.count) < 5) continue;
        const double mean = place.sum / static_cast<double>(place.count);
        if (std::abs(mean) <= std::abs(map.worst_mm)) continue;
        map.worst_mm = mean;
        map.worst_part_mm = place.middle / static_cast<double>(place.count);
        map.worst_base_mm = base_from_part * map.worst_part_mm;
    }
    make_histogram(map, options.bins);
    const Cloud asked = surface.sampled(8000, 3);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < asked.size(); ++i)
        seen += places.contains(cell_at(asked.points[i], asked.normals[i].cast<double>(), cell));
    map.share_seen = static_cast<double>(seen) / static_cast<double>(std::max<std::size_t>(1, asked.size()));
    return map;
}

}  // namespace seamwright
