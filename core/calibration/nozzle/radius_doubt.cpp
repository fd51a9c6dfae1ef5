#include "core/calibration/nozzle/radius_doubt.h"

#include <algorithm>
#include <cmath>

#include "core/acceptance/distributions.h"
#include "core/calibration/statistics.h"

namespace seamwright::nozzle {
namespace {

// Of a right radius being called wrong: 5 in a thousand leave room for touches that are not quite normal.
constexpr double kChanceOfRadius = 0.005;
constexpr double kLeastFreedomOfRadius = 2;  // below, the scatter tells nothing to judge by

}  // namespace

std::optional<double> other_radius(const TouchSet& set, const TouchFit& fit) {
    if (!set.sphere) return std::nullopt;
    TouchSet freed = set, given = set;
    freed.near = given.near = fit.state.head<3>();
    freed.spread_mm = set.rho_mm;  // wide enough to say nothing
    if (!set.spread_stated) given.spread_mm = 0;
    const TouchFit free = fit_touches(freed);
    if (!free.solved || !free.determined()) return std::nullopt;
    // A stated sigma needs no scatter to judge by. One that no radius explains is another mistake.
    if (free.estimated
            ? free.freedom < kLeastFreedomOfRadius
            : !set.sigma_mm || (free.freedom >= 1 && contradicts_stated(free.misfit, free.freedom)))
        return std::nullopt;
    const double fall = std::max(0.0, fit_touches(given, free.variance).cost - free.cost);
    const double chance = free.estimated ? f_upper(1, free.freedom, fall) : 1 - chi_square_cdf(1, fall);
    const double off = freed.spread_mm * free.state[6];
    if (!(chance < kChanceOfRadius) || (!set.spread_stated && std::abs(off) < set.spread_mm))
        return std::nullopt;
    return set.rho_mm + off;
}

}  // namespace seamwright::nozzle
