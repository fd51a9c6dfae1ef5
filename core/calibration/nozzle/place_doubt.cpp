#include "core/calibration/nozzle/place_doubt.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/acceptance/distributions.h"
#include "core/calibration/statistics.h"

namespace seamwright::nozzle {
namespace {

// Of a right place being called wrong: as of the radius, touches are not quite normal.
constexpr double kChanceOfPlace = 0.005;
// Of a scatter that much larger than that of the touches without the wrong ones, where both are the hand's.
constexpr double kChanceAlike = 0.01;
constexpr double kLeastFreedomOfPlace = 2;  // below, the scatter tells nothing to judge by
constexpr double kAnywhere_mm = 100;        // wide enough to say nothing
constexpr double kInformation = 4;          // of chi squared: what two numbers more must explain (Akaike)

// The target may stand anywhere.
TouchSet freed(const TouchSet& set, const TouchFit& fit) {
    TouchSet out = set;
    out.near = fit.state.head<3>();
    const Eigen::Matrix3d wide =
        set.half * set.half.transpose() + kAnywhere_mm * kAnywhere_mm * Eigen::Matrix3d::Identity();
    out.half = wide.llt().matrixL();
    return out;
}

bool scatter_tells(const TouchFit& fit) {
    return fit.estimated && fit.determined() && fit.freedom >= kLeastFreedomOfPlace;
}

// A set that leaves out fewer touches is told by its own scatter, where it tells one: that of few touches, chosen for
// how well they fit, is too small to judge more of them by.
bool explains_as_well(const WrongTouches& rival, const TouchFit& found) {
    if (!rival.fit.solved) return false;
    if (found.estimated && scatter_tells(rival.fit))
        return f_upper(rival.fit.freedom, found.freedom, rival.fit.variance / found.variance) > kChanceAlike;
    return fit_touches(rival.set, found.variance).cost < found.cost + kAlike;
}

OtherPlace place_of(const TouchSet& set, const TouchSet& free, const TouchFit& fit) {
    OtherPlace out;
    out.off_mm = free.half * fit.state.segment<3>(3);
    if (!set.sphere) return out;
    TouchSet resized = set;
    resized.near = fit.state.head<3>();
    resized.spread_mm = set.rho_mm;
    out.radius_as_well = fit_touches(resized, fit.variance).cost < fit.cost + kInformation;
    return out;
}

}  // namespace

std::optional<OtherPlace> other_place(const TouchSet& whole, const WrongTouches& found) {
    if (!found.wrong.empty()) {
        const WrongTouches rival = without_wrong_touches(freed(whole, found.fit), found.wrong.size() - 1);
        if (explains_as_well(rival, found.fit)) {
            TouchSet given = rival.set;
            given.half = whole.half;
            return place_of(given, rival.set, rival.fit);
        }
    }
    const TouchSet free = freed(found.set, found.fit);
    const TouchFit fit = fit_touches(free);
    if (!fit.solved) return std::nullopt;
    // A stated sigma needs no scatter to judge by. One that no place explains is another mistake.
    if (fit.estimated ? !scatter_tells(fit)
                      : !free.sigma_mm || (fit.freedom >= 1 && contradicts_stated(fit.misfit, fit.freedom)))
        return std::nullopt;
    const double fall = std::max(0.0, fit_touches(found.set, fit.variance).cost - fit.cost);
    const double chance = fit.estimated ? f_upper(3, fit.freedom, fall / 3) : 1 - chi_square_cdf(3, fall);
    if (!(chance < kChanceOfPlace)) return std::nullopt;
    return place_of(found.set, free, fit);
}

}  // namespace seamwright::nozzle
