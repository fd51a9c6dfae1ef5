#include "core/correction/correction.h"

#include <fmt/format.h>

#include <cmath>

#include "core/correction/region_system.h"
#include "core/correction/unseen_course.h"
#include "core/correction/wrong_spots.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace correction;

// Times the information of the taught geometry: twice as sure by the displacement alone.
constexpr double kLent = 4;
// Chi-square by which a displacement must explain the measures better than its mirror image.
constexpr double kClearOfMirror = 9;

}  // namespace

std::string_view to_string(CorrectionStatus status) {
    switch (status) {
        case CorrectionStatus::ok:
            return "ok";
        case CorrectionStatus::under_determined:
            return "under_determined";
        case CorrectionStatus::over_limit:
            return "over_limit";
        case CorrectionStatus::not_converged:
            return "not_converged";
    }
    return "unknown";
}

namespace correction {

template <class T>
void report_spread(const RegionSystem& system, const Spread& spread, const Observability& seen,
                   const State& state, const RegionSystem::Parts* parts, T& out) {
    out.covariance_systematic.setZero();
    out.sigma_systematic = {};
    if (spread.regular) {
        const Eigen::Matrix3d to_abc = system.abc_from_rotation(state);
        const auto sigmas = [&](const Matrix6& tangent, Eigen::Vector3d& xyz_mm, Eigen::Vector3d& abc_deg) {
            RegionSystem::sigmas(tangent, to_abc, xyz_mm, abc_deg);
            abc_deg *= deg_from_rad(1);
        };
        out.covariance = system.tangent_of(
            system.adds() ? Matrix6(spread.covariance + system.added(state).sum()) : spread.covariance,
            state);
        sigmas(out.covariance, out.sigma_xyz_mm, out.sigma_abc_deg);
        if (parts) {
            out.covariance_systematic = system.tangent_of(parts->systematic, state);
            out.covariance_random = out.covariance - out.covariance_systematic;
            sigmas(out.covariance_random, out.sigma_random.xyz_mm, out.sigma_random.abc_deg);
            sigmas(out.covariance_systematic, out.sigma_systematic.xyz_mm, out.sigma_systematic.abc_deg);
        }
    } else {
        // Singular: infinite where a degree of freedom takes part in an undetermined direction, nothing known
        // elsewhere.
        constexpr double kTakesPart = 1e-6;  // of a direction of length 1
        out.covariance.setZero();
        for (Eigen::Index k = 0; k < seen.weak.cols(); ++k) {
            const Vector6 t = system.tangent_from_xi(seen.weak.col(k), state);
            for (int i = 0; i < 6; ++i) {
                const double size = i < 3 ? std::abs(t[i]) : std::abs(t[i]) * system.spread_mm();
                if (size > kTakesPart) out.covariance(i, i) = kInfinity;
            }
        }
        for (int i = 0; i < 3; ++i) {
            out.sigma_xyz_mm[i] = std::sqrt(out.covariance(i, i));
            // A about Z, B about Y, C about X.
            out.sigma_abc_deg[i] = out.covariance(5 - i, 5 - i) > 0 ? kInfinity : 0.0;
        }
    }
    if (!parts || !spread.regular) {
        out.covariance_random = out.covariance;
        out.sigma_random = {out.sigma_xyz_mm, out.sigma_abc_deg};
    }
}
template void report_spread(const RegionSystem&, const Spread&, const Observability&, const State&,
                            const RegionSystem::Parts*, RegionCorrection&);
template void report_spread(const RegionSystem&, const Spread&, const Observability&, const State&,
                            const RegionSystem::Parts*, RegionPlan&);

}  // namespace correction

struct RegionSolver::Impl {
    RegionSystem taught, system;
    Linearization taught_lin;
    Spread taught_spread;
    Accepted accepted;
    WrongSpotSearch search;
    std::vector<double> factor, slide_mm;
    RegionSystem::Fit fit;

    void refuse(const Observability& seen, const State& state, const Spread& spread, RegionCorrection& r) {
        r.status = CorrectionStatus::under_determined;
        r.displacement = {};
        r.unobservable = name_directions(seen.weak, system.centroid(), system.spread_mm());
        r.sigma_at_spots_mm = seen.weakest_sigma_mm;
        report_spread(system, spread, seen, state, nullptr, r);
        r.message = Text("the spots do not determine the {}: add a spot whose edge runs in another direction",
                         listed(r.unobservable));
    }

    void fill_spots(std::span<const SpotObservation> spots, RegionCorrection& r) {
        r.spots.resize(spots.size());
        Eigen::Vector3d e;
        Rows rows;
        double weighted = 0, weights = 0;
        for (std::size_t n = 0; n < spots.size(); ++n) {
            SpotResidual& out = r.spots[n];
            out.id.assign(spots[n].id);
            out.used = factor[n] > 0;
            system.residual(n, fit.state, e, rows);
            e = system.spot(n).shape * e;
            for (int i = 0; i < 3; ++i) {
                const double w = spots[n].weights[i];
                out.residual_mm[i] = w > 0 ? e[i] : 0.0;
                if (!out.used || !(w > 0)) continue;
                weighted += w * w * e[i] * e[i];
                weights += w * w;
            }
        }
        r.rms_mm = weights > 0 ? std::sqrt(weighted / weights) : 0;
    }

    // How far the part slid along the travel of a spot whose contour's course was not taken.
    double unseen_slide_mm(const SpotObservation& s) const {
        if (s.curve || s.weights.y() > 0) return 0;
        const Pose sensor_from_part = (fit.state.pose() * s.workobject_from_sensor).inverse();
        const Eigen::Vector3d now = sensor_from_part * (s.workobject_from_sensor * s.measured_mm);
        return std::abs(now.y() - s.reference_mm.y());
    }

    std::vector<Text> slid_spots(std::span<const SpotObservation> spots) const {
        std::vector<Text> out;
        for (const SpotObservation& s : spots)
            if (const double mm = unseen_slide_mm(s); mm > kNoticedSlide_mm)
                out.push_back(Text("{} ({:.1f} mm)", s.id, mm));
        return out;
    }

    void remarks(std::span<const SpotObservation> spots, Verdict verdict, double unseen_slope,
                 RegionCorrection& r) {
        std::vector<Text> out;
        for (std::size_t n = 0; n < spots.size(); ++n) {
            const SpotResidual& s = r.spots[n];
            if (s.used) continue;
            constexpr double kSteepest_deg = 8;  // nobody sets up a sensor worse
            const double slide = unseen_slide_mm(spots[n]), off = s.residual_mm.norm();
            const double angle_deg = deg_from_rad(std::atan2(off, slide));
            if (slide > kNoticedSlide_mm && angle_deg < kSteepest_deg)
                out.push_back(Text("{} (off by {:.2f} mm, as an edge {:.1f} degrees off the travel would be)",
                                   s.id, off, angle_deg));
            else
                out.push_back(Text("{} (off by {:.2f} mm)", s.id, off));
        }
        const auto add = [&](const Text& sentence) { r.message = joined(r.message, "; ", sentence); };
        if (!out.empty())
            add(Text("left out as wrong: {}: look there for a foreign particle or a wrong feature",
                     listed(out)));
        const double scatter = std::sqrt(r.variance_factor);
        if (verdict == Verdict::contradictory)
            add(Text(
                "the spots contradict each other ({:.1f} times their stated sigma) and too few are left to "
                "tell which is wrong: check every spot, or add spots",
                scatter));
        else if (!r.consistent)
            add(Text(
                "the residuals are {:.1f} times the stated sigma: the part is deformed or sigma is stated "
                "too small",
                scatter));
        if (!out.empty() || !r.consistent || verdict == Verdict::contradictory) {
            const std::vector<Text> slid = slid_spots(spots);
            if (!slid.empty())
                add(Text(
                    "the part slid along the travel of {}, where no pass was accepted: an edge that does not "
                    "run along the travel looks wrong then: align the sensor there and accept its pass",
                    listed(slid)));
        } else if (unseen_slope > 0) {
            add(
                Text("the part slid along the travel of {}, where no pass was accepted, and the residuals "
                     "are as of edges {:.1f} degrees off the travel, which sigma takes in: align the sensor "
                     "there and "
                     "accept its pass",
                     listed(slid_spots(spots)), deg_from_rad(unseen_slope)));
        }
        for (std::size_t n = 0; n < spots.size(); ++n) {
            constexpr double kBeyondToldMm = 0.5;
            const double beyond = system.beyond_curve_mm(n, fit.state);
            if (beyond > kBeyondToldMm)
                add(Text("{} slid {:.1f} mm beyond the taught range of its contour curve", spots[n].id,
                         beyond));
        }
    }

    // With the spots that are used.
    void judge_taught() {
        taught.linearize({}, factor, taught_lin);
        taught_spread = taught.spread(taught_lin, {});
    }

    // What only the displacement itself makes visible is not known: a round rim shows its turn in the second
    // order alone, in either sense alike and like a rim that has grown. And a wild measure lends no lever.
    bool refused_as_taught(std::span<const SpotObservation> spots, const CorrectionOptions& options,
                           RegionCorrection& r) {
        taught.load(spots, options, true, &accepted);
        judge_taught();
        if (taught_spread.regular && taught.surely_observable(taught_spread)) return false;
        const Observability seen = taught.observability(taught_lin, {});
        if (seen.ok) return false;
        fit.clear();
        fill_spots(spots, r);
        refuse(seen, {}, taught_spread, r);
        return true;
    }

    // A region that is observed as taught, but weakly, is in between: what the second order adds is taken back, the
    // stated sigma is that of the taught geometry. False when the displacement could as well be its mirror image along
    // such a direction, which `seen` then names.
    bool told_from_mirror(Spread& spread, Observability& seen) const {
        Matrix6 turn = Matrix6::Zero();
        turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = fit.state.rotation;
        const Matrix6 before = turn.lazyProduct(taught_spread.bread.lazyProduct(turn.transpose()));
        // Sum over all directions of the gain in information.
        if (fit.lin.information.cwiseProduct(before).sum() < system.free_count() + kLent - 1) return true;
        const SymmetricEigen own = symmetric_eigen(before);
        const Matrix6 root = own.vectors * own.values.cwiseMax(0).cwiseSqrt().asDiagonal();
        const SymmetricEigen gain = symmetric_eigen(root.transpose() * fit.lin.information * root);
        const Matrix6 weight = turn * taught_lin.information * turn.transpose();
        const auto moved = [&](const State& state, const Vector6& along) {
            Vector6 xi;
            xi << state.rotation * system.centroid() + state.translation - system.centroid(),
                system.spread_mm() * rotation_log(state.rotation);
            return along.dot(weight * xi);  // in sigmas
        };
        for (Eigen::Index k = 0; k < gain.values.size(); ++k) {
            if (!(gain.values[k] > kLent)) continue;
            const Vector6 along = root * gain.vectors.col(k);  // a sigma as taught
            const double here = moved(fit.state, along);
            RegionSystem::Fit mirrored;
            system.fit(factor, mirrored, system.shifted(fit.state, -2 * here * along));
            if (mirrored.converged && std::abs(moved(mirrored.state, along) - here) > 1 &&
                mirrored.lin.cost < fit.lin.cost + kClearOfMirror) {
                seen.weak = along.normalized();
                seen.weakest_sigma_mm = along.norm();
                return false;
            }
            spread.covariance += (1 - 1 / gain.values[k]) * along * along.transpose();
        }
        return true;
    }

    Expected<void> solve(std::span<const SpotObservation> spots, const CorrectionOptions& options,
                         RegionCorrection& r) {
        SEAM_OK(check_region(spots, options, true, &accepted));
        r.status = CorrectionStatus::not_converged;
        r.displacement = {};
        r.covariance.setZero();
        r.covariance_random.setZero();
        r.covariance_systematic.setZero();
        r.sigma_xyz_mm.setZero();
        r.sigma_abc_deg.setZero();
        r.sigma_random = r.sigma_systematic = {};
        r.sigma_at_spots_mm = r.rms_mm = 0;
        r.variance_factor = 1;
        r.consistent = true;
        r.unobservable.clear();
        r.message.clear();
        r.iterations = 0;

        factor.assign(spots.size(), 1.0);
        system.load(spots, options, false, &accepted);
        fit.clear();

        int observed = 0;
        for (std::size_t n = 0; n < spots.size(); ++n) observed += system.spot(n).observed;
        r.redundancy = observed - system.free_count();
        if (refused_as_taught(spots, options, r)) return {};
        system.fit(factor, fit);
        Verdict verdict = Verdict::agree;
        Spread spread = fit.converged ? system.spread(fit.lin, fit.state) : Spread{};
        const double level = options.outlier_significance / static_cast<double>(spots.size());
        Agreement a = agreement(system, fit, spread, factor, level);
        const bool agreed = fit.converged && a.plausible && a.smallest_p >= level;
        if (!agreed && options.reject_outliers && r.redundancy > 0) {
            verdict = search.run(system, taught, options.outlier_significance, a, fit, factor);
            if (verdict == Verdict::found || verdict == Verdict::noisy) {
                spread = system.spread(fit.lin, fit.state);
                a = agreement(system, fit, spread, factor);
                judge_taught();
            }
        }
        r.iterations = fit.iterations;
        fill_spots(spots, r);
        if (!fit.converged) {
            r.message = Text(
                "no displacement explains the measures within {} iterations, the spots contradict each "
                "other: check that "
                "measures and poses belong together",
                options.max_iterations);
            return {};
        }
        r.redundancy = a.redundancy;
        if (a.redundancy > 0) r.variance_factor = a.sum_squares / a.redundancy;
        r.consistent = a.plausible && verdict != Verdict::contradictory;
        const double inflation =
            verdict == Verdict::contradictory ? std::max(1.0, std::sqrt(r.variance_factor)) : 1.0;
        const bool sure = inflation == 1.0 && spread.regular && system.surely_observable(spread);
        Observability seen;
        if (!sure || !r.consistent) seen = system.observability(fit.lin, fit.state, inflation);
        if (!sure && !seen.ok) {
            refuse(seen, fit.state, spread, r);
            if (verdict == Verdict::contradictory) {
                r.message.clear();
                remarks(spots, verdict, 0, r);
            }
            return {};
        }
        const bool repeats = system.repeats();
        RegionSystem::Parts parts =
            repeats ? system.parts(fit.shared, fit.state, factor, spread) : RegionSystem::Parts{};
        if (!told_from_mirror(spread, seen)) {
            refuse(seen, fit.state, spread, r);
            return {};
        }
        slide_mm.resize(spots.size());
        for (std::size_t n = 0; n < spots.size(); ++n) slide_mm[n] = unseen_slide_mm(spots[n]);
        const UnseenCourse unseen = unseen_course(system, fit, spread, factor, slide_mm, a);
        if (unseen) {
            spread.covariance += unseen.added;
            parts.random += unseen.added;
        }
        if (repeats) {
            report_spread(system, spread, seen, fit.state, &parts, r);
        } else {
            report_spread(system, spread, seen, fit.state, nullptr, r);
        }
        if (system.adds()) spread.covariance += system.added(fit.state).sum();
        r.sigma_at_spots_mm = system.weakest_sigma_mm(spread);
        r.displacement.workobject_from_movedworkobject = fit.state.pose();
        r.status = CorrectionStatus::ok;
        remarks(spots, verdict, unseen.slope, r);
        const double moved = fit.state.translation.norm();
        const double turned = deg_from_rad(rotation_log(fit.state.rotation).norm());
        if (moved > options.limits.translation_mm || turned > options.limits.rotation_deg) {
            r.status = CorrectionStatus::over_limit;
            const Text sentence(
                "the part has moved by {:.3f} mm and {:.3f} degrees, beyond the limits of {:g} mm and {:g} "
                "degrees: check its seat",
                moved, turned, options.limits.translation_mm, options.limits.rotation_deg);
            r.message = joined(sentence, "; ", r.message);
        }
        return {};
    }
};

RegionSolver::RegionSolver() : impl_(std::make_unique<Impl>()) {}
RegionSolver::RegionSolver(RegionSolver&&) noexcept = default;
RegionSolver& RegionSolver::operator=(RegionSolver&&) noexcept = default;
RegionSolver::~RegionSolver() = default;

Expected<void> RegionSolver::solve(std::span<const SpotObservation> spots, const CorrectionOptions& options,
                                   RegionCorrection& result) {
    return impl_->solve(spots, options, result);
}

Expected<RegionCorrection> solve_region(std::span<const SpotObservation> spots,
                                        const CorrectionOptions& options) {
    RegionSolver solver;
    RegionCorrection result;
    SEAM_OK(solver.solve(spots, options, result));
    return result;
}

}  // namespace seamwright
