#include "core/correction/wrong_spots.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

#include "core/correction/contour_fit.h"

namespace seamwright::correction {
namespace {

// Likelihood-ratio distance (in chi-square) by which the best explanation must beat the next.
constexpr double kClear = 9.0;
// Exhaustive search up to so many refits times spots per size of the set.
constexpr double kMostWork = 30000;
// Leaving out several spots could explain mere noise away when sigma is stated too small. So the rest must
// have twice as much redundancy as went, or (down to once as much) every spot left out must be off by more
// than 20 sigma.
constexpr double kGross = 400.0;
// A direction of a spot's residual with less redundancy than this says nothing.
constexpr double kNoRedundancy = 1e-6;
// Below this one the closed form is not taken.
constexpr double kPlainRedundancy = 1e-3;

// Statistic e^T S^+ e of one spot over its observed axes, and its degrees.
struct Studentised {
    double value = 0;
    int degrees = 0;
};

Studentised studentise(const PreparedSpot& spot, const Eigen::Vector3d& e,
                       const Eigen::Matrix3d& covariance) {
    Eigen::Vector3d v = e / spot.sigma;
    Eigen::Matrix3d s = covariance / (spot.sigma * spot.sigma);
    for (int i = 0; i < 3; ++i) {
        if (spot.weights[i] > 0) continue;
        v[i] = 0;
        s.row(i).setZero();
        s.col(i).setZero();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(s);
    Studentised out;
    for (int k = 0; k < 3; ++k) {
        const double lambda = eigen.eigenvalues()[k];
        if (!(lambda > kNoRedundancy)) continue;
        const double along = eigen.eigenvectors().col(k).dot(v);
        out.value += along * along / lambda;
        ++out.degrees;
    }
    return out;
}

// Residual of a spot that was left out of the fit, against what the fit predicts for it.
Studentised predicted(const RegionSystem& system, std::size_t n, const RegionSystem::Fit& fit,
                      const Spread& spread) {
    Eigen::Vector3d e;
    Rows rows;
    system.cleared(n, fit, e, rows);
    const PreparedSpot& s = system.spot(n);
    const Eigen::Matrix3d covariance = s.sigma * s.sigma * Eigen::Matrix3d::Identity() +
                                       rows * spread.covariance * rows.transpose() + system.left(n, fit);
    return studentise(s, e, covariance);
}

double binomial(std::size_t n, std::size_t k) {
    double c = 1;
    for (std::size_t i = 0; i < k; ++i) c = c * static_cast<double>(n - i) / static_cast<double>(i + 1);
    return c;
}

std::size_t count_used(std::span<const double> factor) {
    return static_cast<std::size_t>(
        std::count_if(factor.begin(), factor.end(), [](double f) { return f > 0; }));
}

// The spots kept determine the displacement: as they lie now, and not by the displacement alone.
bool determined(const RegionSystem& system, const RegionSystem& taught, const RegionSystem::Fit& fit,
                std::span<const double> factor) {
    Linearization as_taught;
    const State start;
    taught.linearize(start, factor, as_taught);
    return system.observability(fit.lin, fit.state).ok && taught.observability(as_taught, start).ok;
}

}  // namespace

double chi_square_p(double value, int degrees) {
    if (degrees <= 0) return 1;
    if (!(value > 0)) return std::isnan(value) ? 0.0 : 1.0;
    if (!std::isfinite(value)) return 0;
    switch (degrees) {  // closed forms for the degrees of one spot
        case 1:
            return std::erfc(std::sqrt(0.5 * value));
        case 2:
            return std::exp(-0.5 * value);
        case 3:
            return std::erfc(std::sqrt(0.5 * value)) + std::sqrt(2 * value / kPi) * std::exp(-0.5 * value);
        default:
            return Eigen::numext::igammac(0.5 * degrees, 0.5 * value);
    }
}

Agreement agreement(const RegionSystem& system, const RegionSystem::Fit& fit, const Spread& spread,
                    std::span<const double> factor, double enough) {
    Agreement out;
    Eigen::Vector3d e;
    Rows rows;
    double largest = 0;  // statistic with two degrees
    // One that would be no larger than this with all that can be left of the sensors' errors is not looked at closely.
    const bool shared = !fit.shared.sensors.empty();
    const double harmless = shared && enough < 1 ? -2 * std::log(enough) : 0;
    // What the sensors are found to err by counts against their priors.
    for (const SharedBlock& b : fit.shared.sensors) out.sum_squares += b.value.squaredNorm();
    for (std::size_t n = 0; n < system.size(); ++n) {
        if (!(factor[n] > 0)) continue;
        system.cleared(n, fit, e, rows);
        const PreparedSpot& s = system.spot(n);
        out.observed += s.observed;
        for (int i = 0; i < 3; ++i) {
            if (s.weights[i] > 0) out.sum_squares += e[i] * e[i] / (s.sigma * s.sigma);
        }
        if (!spread.regular) continue;
        if (s.weights.x() == 1 && s.weights.y() == 0 && s.weights.z() == 1 && system.weights_are_binary()) {
            // The usual spot: x and z, covariance sigma^2 I - J C J^T inverted in closed form.
            const Vector6 jx = rows.row(0).transpose(), jz = rows.row(2).transpose();
            const Vector6 cx = spread.bread.lazyProduct(jx), cz = spread.bread.lazyProduct(jz);
            const double v = 1 / (s.sigma * s.sigma);
            const double jxx = jx.dot(cx), jxz = jx.dot(cz), jzz = jz.dot(cz);
            const auto statistic = [&](const Eigen::Matrix3d& left) -> std::optional<double> {
                const double xx = 1 - v * (jxx + left(0, 0)), xz = -v * (jxz + left(0, 2)),
                             zz = 1 - v * (jzz + left(2, 2));
                const double det = xx * zz - xz * xz;
                if (!(xx > kPlainRedundancy && zz > kPlainRedundancy && det > kPlainRedundancy * xx * zz))
                    return std::nullopt;
                return v * (zz * e.x() * e.x() - 2 * xz * e.x() * e.z() + xx * e.z() * e.z()) / det;
            };
            if (harmless > 0)
                if (const auto t = statistic(system.left_at_most(n, fit)); t && *t <= harmless) continue;
            if (const auto t = statistic(system.left(n, fit))) {
                largest = std::max(largest, *t);
                continue;
            }
        }
        const Eigen::Matrix3d left = system.left(n, fit);
        // Residual = (I - J K) noise with the gain K = bread J^T Omega.
        const Eigen::Matrix3d j = rows * spread.bread * rows.transpose() + left;
        const Eigen::Matrix3d gain = j * Eigen::Matrix3d(s.weights.cwiseAbs2().asDiagonal());
        const Eigen::Matrix3d c = rows * spread.covariance * rows.transpose() + left;
        const Eigen::Matrix3d covariance =
            s.sigma * s.sigma * Eigen::Matrix3d::Identity() - gain - gain.transpose() + c;
        const Studentised t = studentise(s, e, covariance);
        out.smallest_p = std::min(out.smallest_p, chi_square_p(t.value, t.degrees));
    }
    out.smallest_p = std::min(out.smallest_p, chi_square_p(largest, 2));
    out.redundancy = out.observed - system.free_count();
    // Below mean + 2 standard deviations the tail is never small; the incomplete gamma function is dear.
    out.plausible = out.sum_squares < out.redundancy + 2 * std::sqrt(2.0 * std::max(0, out.redundancy)) ||
                    chi_square_p(out.sum_squares, out.redundancy) >= kGlobalDisagreement;
    return out;
}

// Tries every set of `count` spots: is the rest in agreement without it? True when exactly one set explains
// best.
bool WrongSpotSearch::explain(const RegionSystem& system, const RegionSystem& taught, std::size_t count,
                              double level, std::vector<double>& factor, RegionSystem::Fit& fit, bool& tied) {
    const std::size_t n = system.size();
    int observed = 0;
    for (std::size_t i = 0; i < n; ++i) observed += system.spot(i).observed;
    std::vector<std::size_t> set(count);
    for (std::size_t i = 0; i < count; ++i) set[i] = i;
    double best = std::numeric_limits<double>::infinity(), second = best;
    RegionSystem::Fit best_fit, candidate;
    std::vector<std::size_t> best_set;
    for (bool more = n > count; more;) {
        trial_.assign(n, 1.0);
        for (const std::size_t i : set) trial_[i] = 0;
        system.fit(trial_, candidate);
        const Spread spread = candidate.converged ? system.spread(candidate.lin, candidate.state) : Spread{};
        const Agreement a = agreement(system, candidate, spread, trial_);
        const int lost = observed - a.observed;
        if (a.redundancy <= 0 || (count > 1 && a.redundancy < lost)) {
            tied = tied || a.redundancy <= 0;
        } else if (!spread.regular) {
            // The rest does not determine the displacement: this set cannot be acquitted unless the rest
            // disagrees.
            if (a.plausible) second = std::min(second, a.sum_squares);
        } else {
            const double rest = static_cast<double>(n - count);
            bool fits = a.smallest_p >= level / rest && a.plausible;
            // Each one left out must be wrong by itself, or a smaller set would do.
            for (const std::size_t i : set) {
                if (!fits) break;
                const Studentised t = predicted(system, i, candidate, spread);
                fits = chi_square_p(t.value, t.degrees) < level / static_cast<double>(n) &&
                       (count == 1 || a.redundancy >= 2 * lost || t.value > kGross);
            }
            if (fits && a.sum_squares < best) {
                second = std::min(second, best);
                best = a.sum_squares;
                best_fit = candidate;
                best_set = set;
            } else if (fits) {
                second = std::min(second, a.sum_squares);
            }
        }
        // Next combination in lexicographic order.
        more = false;
        for (std::size_t i = count; i-- > 0;) {
            if (set[i] < n - count + i) {
                ++set[i];
                for (std::size_t k = i + 1; k < count; ++k) set[k] = set[k - 1] + 1;
                more = true;
                break;
            }
        }
    }
    if (tied || best_set.empty()) return false;
    if (second - best < kClear) {
        tied = true;
        return false;
    }
    // The rest must still determine the displacement.
    trial_.assign(n, 1.0);
    for (const std::size_t i : best_set) trial_[i] = 0;
    if (!determined(system, taught, best_fit, trial_)) {
        tied = true;
        return false;
    }
    factor = trial_;
    fit = best_fit;
    return true;
}

// Many wrong spots: Geman-McClure weights, annealed from wide to the stated noise, then hard decisions by
// prediction.
bool WrongSpotSearch::graduated(const RegionSystem& system, const RegionSystem& taught, double level,
                                std::vector<double>& factor, RegionSystem::Fit& fit) {
    const std::size_t n = system.size();
    soft_.assign(n, 1.0);
    RegionSystem::Fit soft_fit;
    std::vector<double> square(n, 0.0);
    Eigen::Vector3d e;
    Rows rows;
    // Squared sigmas: the width of the weight function at last, and a spot that is wrong to begin with.
    constexpr double kNarrowest = 9, kFarOff = 36;
    constexpr double kNarrows = 0.6;  // from round to round
    constexpr double kLeastWeight = 1e-12;
    double width = 0;
    for (int round = 0; round < 60; ++round) {
        system.fit(soft_, soft_fit);
        if (!soft_fit.state.translation.allFinite()) return false;
        double largest = 0;
        for (std::size_t k = 0; k < n; ++k) {
            system.residual(k, soft_fit.state, e, rows);
            const PreparedSpot& s = system.spot(k);
            square[k] = 0;
            for (int i = 0; i < 3; ++i) {
                if (s.weights[i] > 0) square[k] += e[i] * e[i] / (s.sigma * s.sigma);
            }
            largest = std::max(largest, square[k]);
        }
        width = round == 0 ? largest : std::max(kNarrowest, kNarrows * width);
        for (std::size_t k = 0; k < n; ++k) {
            const double u = width / (width + square[k]);
            soft_[k] = std::max(kLeastWeight, u * u);
        }
        if (width <= kNarrowest && round > 5) break;
    }
    trial_.assign(n, 1.0);
    for (std::size_t k = 0; k < n; ++k) {
        if (square[k] > kFarOff) trial_[k] = 0;
    }
    RegionSystem::Fit hard;
    for (int round = 0; round < 10; ++round) {
        const std::size_t used = count_used(trial_);
        if (3 * (n - used) > n) return false;  // a third may be wrong, not more
        system.fit(trial_, hard);
        if (!hard.converged) return false;
        const Spread spread = system.spread(hard.lin, hard.state);
        if (!spread.regular) return false;
        bool changed = false;
        for (std::size_t k = 0; k < n; ++k) {
            if (trial_[k] > 0) continue;
            const Studentised t = predicted(system, k, hard, spread);
            if (chi_square_p(t.value, t.degrees) >= level / static_cast<double>(n)) {
                trial_[k] = 1;
                changed = true;
            }
        }
        if (changed) continue;
        const Agreement a = agreement(system, hard, spread, trial_);
        int lost = 0;
        double smallest = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < n; ++k) {
            if (trial_[k] > 0) continue;
            lost += system.spot(k).observed;
            smallest = std::min(smallest, predicted(system, k, hard, spread).value);
        }
        if (a.redundancy < lost || (a.redundancy < 2 * lost && smallest <= kGross)) return false;
        if (a.smallest_p < level / static_cast<double>(used) || !a.plausible || used == n) return false;
        if (!determined(system, taught, hard, trial_)) return false;
        factor = trial_;
        fit = hard;
        return true;
    }
    return false;
}

// The stated sigma is too small for all: a spot is wrong when leaving it out lowers the scatter of the rest
// beyond chance (F test on the empirical variance), one after the other.
bool WrongSpotSearch::stands_out(const RegionSystem& system, const RegionSystem& taught, double level,
                                 std::vector<double>& factor, RegionSystem::Fit& fit) {
    const std::size_t n = system.size();
    bool any = false;
    for (std::size_t round = 0; round < n / 3; ++round) {
        const std::size_t used = count_used(factor);
        const Agreement now = agreement(system, fit, system.spread(fit.lin, fit.state), factor);
        double best = std::numeric_limits<double>::infinity(), second = best;
        std::size_t which = n;
        RegionSystem::Fit best_fit, candidate;
        for (std::size_t k = 0; k < n; ++k) {
            if (!(factor[k] > 0)) continue;
            trial_ = factor;
            trial_[k] = 0;
            system.fit(trial_, candidate);
            if (!candidate.converged) continue;
            const Spread spread = system.spread(candidate.lin, candidate.state);
            if (!spread.regular || !determined(system, taught, candidate, trial_)) continue;
            const double rest = agreement(system, candidate, spread, trial_).sum_squares;
            if (rest < best) {
                second = best;
                best = rest;
                which = k;
                best_fit = candidate;
            } else {
                second = std::min(second, rest);
            }
        }
        if (which == n) return any;
        const int lost = system.spot(which).observed;
        const int left = now.redundancy - lost;
        if (left < 3) return any;
        const double variance = best / left;
        const double f = (now.sum_squares - best) / lost / variance;
        if (f_test(f, lost, left) >= level / static_cast<double>(used) || (second - best) / variance < kClear)
            return any;
        factor[which] = 0;
        fit = best_fit;
        any = true;
    }
    return any;
}

Verdict WrongSpotSearch::run(const RegionSystem& system, const RegionSystem& taught, double significance,
                             const Agreement& all, RegionSystem::Fit& fit, std::vector<double>& factor) {
    const std::size_t n = system.size();
    if (fit.converged && all.smallest_p >= significance / static_cast<double>(n)) {
        return all.plausible ? Verdict::agree : Verdict::noisy;
    }
    if (all.redundancy <= 0) return Verdict::agree;
    bool tied = false;
    bool searched = true;
    for (std::size_t count = 1; count <= 3 && 2 * count < n; ++count) {
        if (binomial(n, count) * static_cast<double>(n) > kMostWork) {
            searched = false;
            break;
        }
        if (explain(system, taught, count, significance, factor, fit, tied)) return Verdict::found;
        if (tied) return Verdict::contradictory;
    }
    if ((!searched || n > 6) && graduated(system, taught, significance, factor, fit)) return Verdict::found;
    if (fit.converged && stands_out(system, taught, significance, factor, fit)) return Verdict::noisy;
    return Verdict::contradictory;
}

}  // namespace seamwright::correction
