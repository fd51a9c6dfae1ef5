#include <algorithm>
#include <limits>

#include "core/correction/placing/placing.h"

namespace seamwright {
namespace {

constexpr double kShorter_mm = 1e-9;

double length_of(std::span<const Eigen::Vector3d> p, const std::vector<std::size_t>& order) {
    double sum = 0;
    for (std::size_t i = 1; i < order.size(); ++i) sum += (p[order[i]] - p[order[i - 1]]).norm();
    return sum;
}

std::vector<std::size_t> nearest_from(std::span<const Eigen::Vector3d> p, std::size_t start) {
    std::vector<std::size_t> order{start}, left;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (i != start) left.push_back(i);
    while (!left.empty()) {
        const auto next = std::min_element(left.begin(), left.end(), [&](std::size_t a, std::size_t b) {
            return (p[a] - p[order.back()]).norm() < (p[b] - p[order.back()]).norm();
        });
        order.push_back(*next);
        left.erase(next);
    }
    return order;
}

}  // namespace

std::vector<std::size_t> short_way(std::span<const Eigen::Vector3d> points_mm, double& length_mm) {
    std::vector<std::size_t> best;
    length_mm = points_mm.empty() ? 0 : std::numeric_limits<double>::infinity();
    for (std::size_t start = 0; start < points_mm.size(); ++start) {
        std::vector<std::size_t> order = nearest_from(points_mm, start);
        double length = length_of(points_mm, order);
        for (bool better = true; better;) {
            better = false;
            for (std::size_t i = 0; i + 1 < order.size(); ++i)
                for (std::size_t k = i + 2; k <= order.size(); ++k) {
                    const auto first = order.begin() + static_cast<std::ptrdiff_t>(i);
                    const auto last = order.begin() + static_cast<std::ptrdiff_t>(k);
                    std::reverse(first, last);
                    const double turned = length_of(points_mm, order);
                    if (turned < length - kShorter_mm) {
                        length = turned;
                        better = true;
                    } else {
                        std::reverse(first, last);
                    }
                }
        }
        if (length < length_mm - kShorter_mm) length_mm = length, best = order;
    }
    return best;
}

}  // namespace seamwright
