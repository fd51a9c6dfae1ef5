// Prediction of a region from its taught poses, and advice where a further spot helps most.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/correction/predicted.h"
#include "core/correction/region_system.h"
#include "core/correction/travel.h"
#include "core/geometry/notation.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace correction;
using Spots = std::vector<SpotObservation>;

constexpr double kPower95 = 1.645;          // normal quantile: a wrong measure is found in 95 of 100 cases
constexpr std::size_t kMostPairs = 24;      // spots up to which mix-ups of two spots are looked at
constexpr std::size_t kMostPositions = 24;  // taught positions tried for a further spot
constexpr double kCornerPenalty =
    1.2;  // a corner of the bounding box may lie off the part: must be this much better
constexpr std::size_t kMostAdded = 5;

struct Judgement {
    Linearization lin;
    Observability seen;
};

Judgement judge(RegionSystem& system, std::span<const SpotObservation> spots,
                const CorrectionOptions& options) {
    Judgement out;
    system.load(spots, options, true);
    const std::vector<double> all(spots.size(), 1.0);
    system.linearize(State{}, all, out.lin);
    out.seen = system.observability(out.lin, State{});
    return out;
}

// Smallest error at spot n, in its least controlled observed direction, that stands out from what the others
// predict with 95 % power; infinity when they predict nothing.
double findable_error_mm(const RegionSystem& system, std::size_t n, const Rows& rows,
                         const Linearization& others, double level) {
    const Spread spread = system.spread(others, State{});
    if (!spread.regular) return kInfinity;
    const PreparedSpot& s = system.spot(n);
    Eigen::Matrix3d c =
        s.shape *
        (s.sigma * s.sigma * Eigen::Matrix3d::Identity() + rows * spread.covariance * rows.transpose()) *
        s.shape.transpose();
    for (int i = 0; i < 3; ++i) {
        if (s.weights[i] > 0) continue;
        c.row(i).setZero();
        c.col(i).setZero();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(c, Eigen::EigenvaluesOnly);
    const double threshold = std::sqrt(-2.0 * std::log(level)) + kPower95;
    return threshold * std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

// `system` is loaded with the spots, `lin` is their sum.
std::vector<std::size_t> uncontrolled_spots(const RegionSystem& system, const Linearization& lin,
                                            const CorrectionOptions& options) {
    const std::size_t n = system.size();
    const State start;
    std::vector<Rows> rows(n);
    std::vector<Linearization> own(n);
    Eigen::Vector3d e;
    int observed = 0;
    for (std::size_t k = 0; k < n; ++k) {
        system.residual(k, start, e, rows[k]);
        system.add_information(k, rows[k], 1.0, own[k].information, own[k].meat);
        observed += system.spot(k).observed;
    }
    const auto without = [&](const Linearization& from, std::size_t k) {
        Linearization out = from;
        out.information -= own[k].information;
        out.meat -= own[k].meat;
        return out;
    };
    const double level = options.outlier_significance / static_cast<double>(n);
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < n; ++k) {
        if (system.spot(k).observed == 0) continue;
        const Linearization others = without(lin, k);
        bool found = observed - system.spot(k).observed - system.free_count() > 0 &&
                     system.observability(others, start).ok &&
                     findable_error_mm(system, k, rows[k], others, level) <= kFindableErrorMm;
        // It must also show when another spot is suspected and left out instead.
        for (std::size_t j = 0; found && n <= kMostPairs && j < n; ++j) {
            if (j != k && system.spot(j).observed > 0)
                found = findable_error_mm(system, k, rows[k], without(others, j), level) <= kFindableErrorMm;
        }
        if (!found) out.push_back(k);
    }
    return out;
}

std::string axis_name(Eigen::Vector3d v) {
    constexpr double kByItsName = 0.999;    // cos of 2.6 degrees: nearer to an axis it is called by it
    constexpr double kNoMinusZero = 0.005;  // below it 0 is written
    Eigen::Index largest;
    v.cwiseAbs().maxCoeff(&largest);
    if (v[largest] < 0) v = -v;
    for (int i = 0; i < 3; ++i) {
        if (v[i] > kByItsName) return std::string(1, "XYZ"[i]);
        if (std::abs(v[i]) < kNoMinusZero) v[i] = 0;
    }
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x(), v.y(), v.z());
}

// A spot whose sensor's Y runs along `edge`, X and Z observed; of the sensor of a taught one.
SpotObservation spot_across(const Eigen::Vector3d& position, const Eigen::Vector3d& edge, double sigma,
                            const SpotObservation& like) {
    SpotObservation s;
    s.sensor = like.sensor;
    s.reference_covariance_mm2 = like.reference_covariance_mm2;
    s.robot_covariance = like.robot_covariance;
    s.reference_arrivals = like.reference_arrivals;
    s.latency_travel_mm = like.latency_travel_mm;
    s.workobject_from_sensor = make_pose(rotation_between(Eigen::Vector3d::UnitY(), edge), position);
    s.sigma_mm = sigma;
    return s;
}

struct Candidate {
    SpotObservation spot;
    Text words;
    std::string near, edge;
    Eigen::Index weak = 6;  // directions still unobservable
    std::size_t uncontrolled = 0;
    double sigma_mm = kInfinity, penalty = 1;
    bool operator<(const Candidate& o) const {
        if (weak != o.weak) return weak < o.weak;
        if (uncontrolled != o.uncontrolled) return uncontrolled < o.uncontrolled;
        return sigma_mm * penalty < o.sigma_mm * o.penalty;
    }
};

std::vector<Candidate> candidates(std::span<const SpotObservation> spots) {
    std::vector<double> sigmas;
    for (const SpotObservation& s : spots) sigmas.push_back(s.sigma_mm);
    std::nth_element(sigmas.begin(), sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2),
                     sigmas.end());
    const double sigma = sigmas[sigmas.size() / 2];

    std::vector<Eigen::Vector3d> edges{Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                       Eigen::Vector3d::UnitZ()};
    constexpr double kSameEdge = 0.97;  // cos of 14 degrees
    for (const SpotObservation& s : spots) {
        const Eigen::Vector3d edge = s.workobject_from_sensor.linear().col(1);
        const bool known = std::any_of(edges.begin(), edges.end(), [&](const Eigen::Vector3d& o) {
            return std::abs(o.dot(edge)) > kSameEdge;
        });
        if (!known && edges.size() < 10) edges.push_back(edge);
    }
    std::vector<Candidate> out;
    const auto add = [&](const Eigen::Vector3d& p, const std::string& near, const std::string& place,
                         double penalty, const SpotObservation& like) {
        for (const Eigen::Vector3d& edge : edges) {
            Candidate c;
            c.spot = spot_across(p, edge, sigma, like);
            c.penalty = penalty;
            c.near = near;
            c.edge = axis_name(edge);
            c.words = Text("{} at ({:.0f}, {:.0f}, {:.0f}) mm of the work object with its edge along {}",
                           place, p.x() + 0.0, p.y() + 0.0, p.z() + 0.0, c.edge);
            out.push_back(std::move(c));
        }
    };
    Eigen::Vector3d low = Eigen::Vector3d::Constant(kInfinity), high = -low;
    const std::size_t every = (spots.size() + kMostPositions - 1) / kMostPositions;
    for (std::size_t n = 0; n < spots.size(); ++n) {
        const Eigen::Vector3d p = spots[n].workobject_from_sensor * spots[n].reference_mm;
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
        if (n % every == 0) add(p, spots[n].id, "near " + spots[n].id, 1.0, spots[n]);
    }
    // Corners of the box around the spots; around a single spot or a tight cluster the box is taken 500 mm
    // wide.
    const bool tight = (high - low).norm() < 50;
    if (tight) {
        low.array() -= 250;
        high.array() += 250;
    }
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d p = low;
        bool flat = false;
        for (int i = 0; i < 3; ++i) {
            if (!(corner >> i & 1)) continue;
            flat = flat || high[i] - low[i] < 1;  // the same corner once more
            p[i] = high[i];
        }
        if (!flat) add(p, "", tight ? "on the part" : "towards the corner", kCornerPenalty, spots.front());
    }
    return out;
}

Text advise(std::span<const SpotObservation> spots, const CorrectionOptions& options,
            const RegionPlan& plan) {
    Spots extended(spots.begin(), spots.end());
    std::vector<Text> added;
    RegionSystem system;
    Candidate best;
    const bool weak_before = plan.status != CorrectionStatus::ok;
    for (std::size_t round = 0; round < kMostAdded; ++round) {
        std::vector<Candidate> all = candidates(extended);
        extended.emplace_back();
        for (Candidate& c : all) {
            extended.back() = c.spot;
            const Judgement j = judge(system, extended, options);
            c.weak = j.seen.weak.cols();
            c.sigma_mm = j.seen.weakest_sigma_mm;
        }
        std::sort(all.begin(), all.end());
        // Counting uncontrolled spots is dear: only for the most promising, once all directions are observed.
        if (!plan.uncontrolled.empty() && all.front().weak == 0) {
            all.resize(std::min<std::size_t>(all.size(), 40));
            for (Candidate& c : all) {
                extended.back() = c.spot;
                const Judgement j = judge(system, extended, options);
                c.uncontrolled = uncontrolled_spots(system, j.lin, options).size();
            }
            std::sort(all.begin(), all.end());
        }
        best = all.front();
        best.spot.id = fmt::format("new {}", round + 1);
        while (std::any_of(spots.begin(), spots.end(), [&](const auto& s) { return s.id == best.spot.id; }))
            best.spot.id += "'";
        extended.back() = best.spot;
        added.push_back(best.words);
        if (best.weak == 0) break;
    }
    if (weak_before && best.weak > 0)
        return "add spots whose edges run in other directions and which lie far apart: no few further spots "
               "near the "
               "taught ones would do";
    Text where;
    for (const Text& place : added) where = where.empty() ? place : Text("{}; and {}", where, place);
    const Text count = added.size() == 1 ? Text("a spot") : Text("{} spots", added.size());
    const auto sigma = [](double mm) {
        return std::isfinite(mm) ? Text("{:.3g} mm", mm) : Text("undetermined");
    };
    const Text gain("the weakest direction goes from {} to {} (1 sigma at the spots)",
                    sigma(plan.sigma_at_spots_mm), sigma(best.sigma_mm));
    if (weak_before) return Text("add {} {}: {}", count, where, gain);
    if (!plan.uncontrolled.empty() && best.uncontrolled < plan.uncontrolled.size())
        return Text(
            "add {} {}: {}, and the number of spots whose wrong measure would go unnoticed from {} to {}",
            count, where, gain, plan.uncontrolled.size(), best.uncontrolled);
    return Text("no further spot is needed; the best one would be {}: {}", where, gain);
}

}  // namespace

Expected<RegionPlan> plan_region(std::span<const SpotObservation> spots, const CorrectionOptions& options) {
    SEAM_OK(check_region(spots, options, false));
    RegionSystem system;
    const Judgement now = judge(system, spots, options);
    const State start;
    RegionPlan plan;
    plan.status = now.seen.ok ? CorrectionStatus::ok : CorrectionStatus::under_determined;
    plan.unobservable = name_directions(now.seen.weak, system.centroid(), system.spread_mm());
    plan.weakest_direction = now.seen.weakest;
    plan.sigma_at_spots_mm = now.seen.weakest_sigma_mm;
    Predicted taught = predict(spots, options, {});
    const RegionSystem::Parts parts =
        taught.system.parts(taught.shared, taught.state, taught.factor, taught.spread);
    report_spread(taught.system, taught.spread, now.seen, start, &parts, plan);
    if (taught.system.repeats() && taught.spread.regular) {
        taught.spread.covariance += taught.system.added(start).sum();
        plan.sigma_at_spots_mm = taught.system.weakest_sigma_mm(taught.spread);
    }
    // Of several equally undetermined directions any mixture is as weak: then the nicely named ones are
    // listed.
    if (now.seen.singular && !plan.unobservable.empty()) {
        plan.weakest = plan.unobservable.front();
    } else {
        const auto names = name_directions(now.seen.weakest, system.centroid(), system.spread_mm());
        plan.weakest = names.empty() ? "" : names.front();
    }
    for (std::size_t n = 0; n < spots.size(); ++n) plan.redundancy += system.spot(n).observed;
    plan.redundancy -= system.free_count();
    for (const std::size_t n : uncontrolled_spots(system, now.lin, options))
        plan.uncontrolled.push_back(spots[n].id);
    plan.advice = advise(spots, options, plan);
    return plan;
}

std::optional<FurtherSpot> best_further_spot(std::span<const SpotObservation> spots,
                                             const CorrectionOptions& options) {
    if (!check_region(spots, options, false)) return std::nullopt;
    RegionSystem system;
    Candidate best;
    const Judgement now = judge(system, spots, options);
    best.sigma_mm = now.seen.weakest_sigma_mm;
    best.weak = now.seen.weak.cols();
    Spots extended(spots.begin(), spots.end());
    extended.emplace_back();
    for (Candidate& c : candidates(spots)) {
        extended.back() = c.spot;
        const Judgement j = judge(system, extended, options);
        c.weak = j.seen.weak.cols();
        c.sigma_mm = j.seen.weakest_sigma_mm;
        if (c < best) best = std::move(c);
    }
    if (best.words.empty()) return std::nullopt;
    return FurtherSpot{std::move(best.spot), std::move(best.near), std::move(best.edge)};
}

}  // namespace seamwright
