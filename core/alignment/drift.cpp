#include "core/alignment/drift.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/alignment/contour_ends.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright::alignment {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double rise(const PolynomialFit& f, double y, double from, double to) {
    const double s = std::clamp(y, from, to);
    const auto& c = f.coefficient;
    const double slope = c[1] + s * (2 * c[2] + s * 3 * c[3]);
    return s * (c[1] + s * (c[2] + s * c[3])) + slope * (y - s);
}

// Within the noise of both slopes the two drifts are one; so they are where one step of `grain_mm` in the middle of the travel
// makes as large a slope (of a cubic 2.8 times the step over the travel).
double differ_mm(const Drift& own, const Drift& drift, double jitter_mm, double grain_mm) {
    constexpr double kSure = 4;  // sigmas
    constexpr double kOneStep = 3;
    const double step = kOneStep * grain_mm / (own.to - own.from);
    const auto differs = [step](const PolynomialFit& a, const PolynomialFit& b) {
        const double by = a.coefficient[1] - b.coefficient[1];
        const double noise = kSure * std::hypot(a.coefficient_sigma[1], b.coefficient_sigma[1]);
        return std::abs(by) > std::max(noise, step) ? by : 0.0;
    };
    return std::hypot(differs(own.x, drift.x), differs(own.z, drift.z)) * jitter_mm;
}

}  // namespace

std::vector<std::size_t> outwards_from_trigger(std::span<const TravelProfile> pass, double window_mm) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < pass.size(); ++i)
        if (std::abs(pass[i].travel_mm) <= window_mm) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
        return std::abs(pass[a].travel_mm) < std::abs(pass[b].travel_mm);
    });
    return order;
}

void Drift::add(const TravelOffset& o) {
    travel_mm.push_back(o.travel_mm);
    dx_mm.push_back(o.dx_mm);
    dz_mm.push_back(o.dz_mm);
    dphi_deg.push_back(o.dphi_deg);
}

bool Drift::fit() {
    if (travel_mm.size() < static_cast<std::size_t>(kFewestProfiles)) return false;
    const auto [low, high] = std::minmax_element(travel_mm.begin(), travel_mm.end());
    from = std::min(0.0, *low), to = std::max(0.0, *high);
    if (*high - *low < kShortestTravel_mm) return false;
    x = fit_lowest_order(travel_mm, dx_mm, 1, 3, grain_mm.x());
    z = fit_lowest_order(travel_mm, dz_mm, 1, 3, grain_mm.y());
    phi = fit_lowest_order(travel_mm, dphi_deg, 1, 1);
    return x.ok && z.ok && phi.ok;
}

double Drift::farthest(double jitter_mm, double share) const {
    constexpr int kSteps = 50;
    double most = 0;
    for (int k = -kSteps; k <= kSteps; ++k) {
        const double at = jitter_mm * k / kSteps;
        most = std::max(most, std::hypot(rise(x, at, from, to) - share * x.coefficient[1] * at,
                                         rise(z, at, from, to) - share * z.coefficient[1] * at));
    }
    return most;
}

StandOff left_over(const Drift& drift, double jitter_mm) {
    constexpr std::size_t kFewest = 7;
    constexpr double kAlike = 1.8;            // of the noise: what is left is no noise
    constexpr double kBeyond = 3, kSeen = 2;  // times the noise; the latter where it is none
    constexpr double kSteps = 0.8;  // of a step: so much a last point leaves of an edge that stands still
    const std::size_t n = drift.travel_mm.size();
    if (n < kFewest) return {};
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return drift.travel_mm[a] < drift.travel_mm[b]; });
    const auto travel = [&](std::size_t i) { return drift.travel_mm[order[i]]; };
    std::vector<Eigen::Vector2d> middle(n, Eigen::Vector2d::Zero());
    std::vector<bool> counts(n, false);
    for (const Eigen::Index axis : {0, 1}) {
        const PolynomialFit& f = axis == 0 ? drift.x : drift.z;
        const std::vector<double>& value = axis == 0 ? drift.dx_mm : drift.dz_mm;
        std::vector<double> rest(n), size, rough;
        for (std::size_t i = 0; i < n; ++i) {
            rest[i] = value[order[i]] - f.coefficient[0] - rise(f, travel(i), drift.from, drift.to);
            size.push_back(std::abs(rest[i]));
        }
        for (std::size_t i = 1; i + 1 < n; ++i) {
            const double wide = travel(i + 1) - travel(i - 1);
            const double w = wide > 0 ? (travel(i + 1) - travel(i)) / wide : 0.5;
            rough.push_back(std::abs(rest[i] - w * rest[i - 1] - (1 - w) * rest[i + 1]) /
                            std::sqrt(1 + w * w + (1 - w) * (1 - w)));
        }
        const double noise = kMadToSigma * median(rough);
        const bool alike = kMadToSigma * median(size) > kAlike * noise;
        for (std::size_t i = 1; i + 1 < n; ++i) {
            const double a = rest[i - 1], b = rest[i], c = rest[i + 1];
            middle[i][axis] = std::max(std::min(a, b), std::min(std::max(a, b), c));
            counts[i] = counts[i] || std::abs(middle[i][axis]) > std::max((alike ? kSeen : kBeyond) * noise,
                                                                          kSteps * drift.grain_mm[axis]);
        }
    }
    StandOff most;
    for (std::size_t i = 0; i < n; ++i)
        if (counts[i] && std::abs(travel(i)) <= jitter_mm && middle[i].norm() > most.most_mm)
            most = {middle[i].norm(), travel(i)};
    return most;
}

double scatter_beyond(const Reference& best, const Drift& drift, double jitter_mm) {
    constexpr std::size_t kFewest = 7;
    constexpr double kBeyond = 5;  // of the registration's sigma
    std::vector<double> stated;
    for (const Registered& r : best.found)
        if (r.ok) stated.push_back(r.sigma_mm);
    double most = 0;
    for (const bool along_x : {true, false}) {
        const PolynomialFit& f = along_x ? drift.x : drift.z;
        const std::vector<double>& value = along_x ? drift.dx_mm : drift.dz_mm;
        std::vector<double> rest;
        for (std::size_t i = 0; i < value.size(); ++i)
            if (std::abs(drift.travel_mm[i]) <= jitter_mm)
                rest.push_back(std::abs(value[i] - f.coefficient[0] -
                                        rise(f, drift.travel_mm[i], drift.from, drift.to)));
        if (rest.size() < kFewest) continue;
        const double sigma = kMadToSigma * median(rest);
        if (sigma > kBeyond * median(stated)) most = std::max(most, 2 * sigma);
    }
    return most;
}

namespace {

Drift drift_of(const std::vector<TravelOffset>& offsets, std::size_t but) {
    Drift own;
    for (std::size_t i = 0; i < offsets.size(); ++i)
        if (i != but && offsets[i].ok) own.add(offsets[i]);
    return own;
}

// What the fit's residuals do not tell of its slopes' sigmas. An end that steps by its points: of an edge that moves by `steps` of
// them over the travel the slope errs by about so much of a step over the travel (one step anywhere, or the beat of the steps).
// And the noise of the profile that the others are registered to: it is the same for neighbours, and another one a step on.
void add_common(double pitch_mm, Drift& own) {
    constexpr double kOneStep = 0.7;
    const double travel = own.to - own.from;
    if (!(pitch_mm > 0)) return;
    const double steps = std::abs(own.x.coefficient[1]) * travel / pitch_mm;
    const double changes = steps < 1 ? steps : 1 / std::sqrt(steps);
    for (const Eigen::Index axis : {0, 1}) {
        PolynomialFit& fit = axis == 0 ? own.x : own.z;
        const double by_steps = kOneStep * own.grain_mm[axis] / std::max(1.0, steps);
        fit.coefficient_sigma[1] =
            std::hypot(fit.coefficient_sigma[1], by_steps / travel, changes * fit.sigma / travel);
    }
}

std::vector<TravelOffset> offsets_of(const Reference& piece, std::span<const TravelProfile> pass) {
    std::vector<TravelOffset> out(pass.size());
    for (std::size_t i = 0; i < pass.size(); ++i) {
        const Registered& r = piece.found[i];
        out[i] = {pass[i].travel_mm};
        if (r.ok) out[i] = {pass[i].travel_mm, r.shift.x(), r.shift.y(), deg_from_rad(r.phi), r.rms, true};
    }
    return out;
}

// The registration of the piece tells more than its last points: it has a shape.
bool well_shaped(const Reference& piece, double grain_mm) {
    constexpr double kOfGrain = 0.3;
    std::vector<double> stated;
    for (const Registered& r : piece.found)
        if (r.ok) stated.push_back(r.sigma_mm);
    return !stated.empty() && median(stated) < kOfGrain * grain_mm;
}

// By the end that the point lies on, where it lies on one: that tells most of a sheet, and nothing beside it can lead astray.
bool follow_end_of_point(const Reference& best, std::span<const TravelProfile> pass,
                         const AlignmentOptions& options, Drift& drift, std::vector<TravelOffset>& offsets,
                         double& apart_mm) {
    if (!options.reference_mm) return false;
    const auto order = outwards_from_trigger(pass, options.window_mm);
    auto end = follow_end(best, pass, order, *options.reference_mm);
    if (!end) return false;
    Drift own = drift_of(end->offsets, best.index);
    own.grain_mm = end->grain_mm;
    if (!own.fit()) return false;
    // Else what is lost is told by the whole contour.
    constexpr double kMost = 0.5;
    if (static_cast<double>(own.travel_mm.size()) < kMost * static_cast<double>(drift.travel_mm.size()))
        return false;
    add_common(end->grain_mm.x(), own);
    const auto piece = register_piece(best, pass, order, *options.reference_mm, kInfinity);
    if (piece && well_shaped(*piece, end->grain_mm.x())) {
        const std::vector<TravelOffset> piece_offsets = offsets_of(*piece, pass);
        Drift by_piece = drift_of(piece_offsets, best.index);
        const bool fits = by_piece.fit();
        if (fits) add_common(end->grain_mm.x(), by_piece);
        if (fits && !(differ_mm(own, by_piece, options.jitter_mm, end->grain_mm.x()) > 0)) {
            own = std::move(by_piece);
            end->offsets = piece_offsets;
        }
    }
    apart_mm = drift.along.isZero() ? differ_mm(own, drift, options.jitter_mm, end->grain_mm.x()) : 0;
    drift = std::move(own);
    end->offsets[best.index] = offsets[best.index];
    offsets = std::move(end->offsets);
    return true;
}

}  // namespace

double follow_point(const Reference& best, std::span<const TravelProfile> pass,
                    const AlignmentOptions& options, Drift& drift, std::vector<TravelOffset>& offsets) {
    constexpr double kNear_mm = 8, kNearest_mm = 4;
    if (double apart_mm = 0; follow_end_of_point(best, pass, options, drift, offsets, apart_mm))
        return apart_mm;
    if (!options.reference_mm || !drift.along.isZero()) return 0;
    const Eigen::Vector2d point = *options.reference_mm;
    const auto order = outwards_from_trigger(pass, options.window_mm);
    const Drift whole = drift;
    const std::vector<TravelOffset> whole_offsets = offsets;
    double most = 0;
    const auto consider = [&](const std::vector<TravelOffset>& own_offsets, bool farther, double grain_mm) {
        Drift own = drift_of(own_offsets, best.index);
        if (!own.fit()) return;
        const double apart = differ_mm(own, whole, options.jitter_mm, grain_mm);
        if (!(apart > 0) || (farther && own.farthest(options.jitter_mm) <= drift.farthest(options.jitter_mm)))
            return;
        most = std::max(most, apart);
        for (PolynomialFit* fit : {&own.x, &own.z})  // half a step at either end
            fit->coefficient_sigma[1] = std::hypot(fit->coefficient_sigma[1], grain_mm / (own.to - own.from));
        drift = std::move(own);
        offsets = own_offsets;
    };
    bool by_piece = false;
    for (const double within_mm : {kInfinity, kNear_mm, kNearest_mm}) {
        const auto piece = register_piece(best, pass, order, point, within_mm);
        if (!piece) continue;
        by_piece = by_piece || !std::isfinite(within_mm);
        std::vector<TravelOffset> own = offsets_of(*piece, pass);
        own[piece->index] = whole_offsets[piece->index];
        consider(own, std::isfinite(within_mm), 0);
    }
    const auto ends = end_offsets(best, pass, order, point);
    if (!ends.off.empty()) {
        std::vector<TravelOffset> own = whole_offsets;
        for (std::size_t i = 0; i < pass.size(); ++i) {
            if (i == best.index) continue;
            own[i].ok = own[i].ok && ends.off[i];
            if (!own[i].ok) continue;
            own[i].dx_mm += ends.off[i]->x();
            own[i].dz_mm += ends.off[i]->y();
        }
        // Of a broken contour whose piece with the point is too straight to be registered the end alone tells: the whole moves by
        // what lies beside it.
        consider(own, by_piece || !ends.broken, ends.grain_mm);
    }
    return most;
}

}  // namespace seamwright::alignment
