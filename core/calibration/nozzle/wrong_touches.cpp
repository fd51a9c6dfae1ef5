#include "core/calibration/nozzle/wrong_touches.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/calibration/statistics.h"

namespace seamwright::nozzle {
namespace {

constexpr double kChance = 0.001;    // of one touch in a sound set being called wrong
constexpr double kLeastFreedom = 2;  // below, the rest cannot say which touch it is

// By how much chi squared falls without touch i, and what chance may make of it.
struct Drop {
    std::size_t touch = 0;
    double fall = 0, limit = 0;
    TouchFit rest;
    bool beyond() const { return fall > limit; }
};

std::optional<Drop> drop_of(const TouchSet& set, const TouchFit& all, std::size_t i, std::size_t tried) {
    const TouchSet rest = set.without(i);
    Drop drop;
    drop.touch = i;
    drop.rest = fit_touches(rest);
    if (!drop.rest.solved || !drop.rest.determined() || drop.rest.other || drop.rest.freedom < kLeastFreedom)
        return std::nullopt;
    const int equations = set.sphere ? 1 : 3;
    const double each = kChance / static_cast<double>(tried);
    if (!drop.rest.estimated) {
        drop.fall = all.cost - drop.rest.cost;
        drop.limit = chi_squared_quantile(1 - each, equations);
        return drop;
    }
    // Both in the unit of the rest's scatter: F of `equations` and the rest's degrees of freedom.
    drop.fall = fit_touches(set, drop.rest.variance).cost - drop.rest.cost;
    const double t = student_quantile(1 - each / 2, drop.rest.freedom);
    drop.limit = std::max(equations * outlier_limit(drop.rest.freedom), equations == 1 ? t * t : 0.0);
    return drop;
}

}  // namespace

WrongTouches without_wrong_touches(const TouchSet& all, std::size_t most) {
    WrongTouches out;
    out.set = all;
    out.kept.resize(all.poses.size());
    std::iota(out.kept.begin(), out.kept.end(), std::size_t{0});
    out.fit = fit_touches(all);
    while (out.wrong.size() < most && out.fit.solved) {
        std::vector<Drop> drops;
        for (std::size_t i = 0; i < out.kept.size(); ++i)
            if (auto drop = drop_of(out.set, out.fit, i, all.poses.size())) drops.push_back(std::move(*drop));
        std::erase_if(drops, [](const Drop& d) { return !d.beyond(); });
        if (drops.empty()) break;
        // The sets without one touch each are compared in one unit: the best one's scatter.
        const auto best = std::max_element(drops.begin(), drops.end(), [](const Drop& a, const Drop& b) {
            return a.rest.estimated ? a.rest.variance > b.rest.variance : a.fall < b.fall;
        });
        out.either.clear();
        for (const Drop& d : drops) {
            const double cost = d.rest.estimated
                                    ? fit_touches(out.set.without(d.touch), best->rest.variance).cost
                                    : d.rest.cost;
            if (cost < best->rest.cost + kAlike) out.either.push_back(out.kept[d.touch]);
        }
        if (out.either.size() > 1) break;
        out.either.clear();
        out.wrong.push_back(out.kept[best->touch]);
        out.set = out.set.without(best->touch);
        out.kept.erase(out.kept.begin() + static_cast<std::ptrdiff_t>(best->touch));
        out.fit = best->rest;
    }
    return out;
}

}  // namespace seamwright::nozzle
