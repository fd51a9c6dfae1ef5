#include "core/elastic/elastic_solve.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/correction/wrong_spots.h"
#include "core/elastic/elastic_system.h"

namespace seamwright {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostRounds = 12;
constexpr double kStandsMm = 1e-7;  // an amplitude that changes by less stands

// Learnt modes as matrices.
struct Prior {
    MatrixXd shapes;  // Phi
    VectorXd common, mean, precision;
};
Prior prior_of(const ElasticModes& modes) {
    const auto j = static_cast<Index>(modes.modes.size());
    const auto slots = static_cast<Index>(modes.spots.size());
    Prior p{MatrixXd(3 * slots, j), VectorXd(3 * slots), VectorXd(j), VectorXd(j)};
    for (Index n = 0; n < slots; ++n)
        p.common.segment<3>(3 * n) = modes.spots[static_cast<std::size_t>(n)].common_mm;
    for (Index k = 0; k < j; ++k) {
        const ElasticMode& mode = modes.modes[static_cast<std::size_t>(k)];
        for (Index n = 0; n < slots; ++n)
            p.shapes.col(k).segment<3>(3 * n) = mode.shape[static_cast<std::size_t>(n)];
        p.mean[k] = mode.mean_mm;
        p.precision[k] = 1 / mode.variance_mm2;
    }
    return p;
}

// The measures with the noise that the learning found, where it is more than stated.
std::vector<SpotObservation> as_noisy(std::span<const SpotObservation> spots, std::span<const int> slot_of,
                                      const ElasticModes& modes) {
    std::vector<SpotObservation> out(spots.begin(), spots.end());
    for (std::size_t n = 0; n < out.size(); ++n) {
        const double own = modes.spots[static_cast<std::size_t>(slot_of[n])].noise_factor;
        const double factor = std::max(1.0, modes.noise_factor * own);
        out[n].sigma_mm *= factor;
        if (out[n].covariance_mm2) *out[n].covariance_mm2 *= factor * factor;
    }
    return out;
}

// The measure of a part that is bent by u (work object, as taught), as if it were not; only what the cut tells
// is changed, so that nothing slides along the contour.
SpotObservation freed(SpotObservation o, const Displacement& displacement, const Eigen::Vector3d& u) {
    const Eigen::Matrix3d axes = o.workobject_from_sensor.linear();
    Eigen::Vector3d along = axes.transpose() * u;
    for (int i = 0; i < 3; ++i)
        if (!(o.weights[i] > 0)) along[i] = 0;
    const Pose& d = displacement.workobject_from_movedworkobject;
    o.measured_mm -= axes.transpose() * (d.linear() * (axes * along));
    return o;
}

struct Joint {
    bool found = false;
    Text why;
    RegionCorrection correction;
    VectorXd amplitudes;
    MatrixXd covariance;             // of the amplitudes
    MatrixXd rigid_from_amplitudes;  // K
    double chi_square = 0;
    int degrees = 0;
};

Joint joint_solution(std::span<const SpotObservation> spots, std::span<const int> slot_of,
                     const CorrectionOptions& options, const Prior& prior, const std::vector<bool>& used,
                     const Displacement& from, std::size_t slots) {
    Joint out;
    out.amplitudes = prior.mean;
    std::vector<SpotObservation> kept;
    std::vector<int> kept_slots;
    for (std::size_t n = 0; n < spots.size(); ++n)
        if (used[n]) {
            kept.push_back(spots[n]);
            kept_slots.push_back(slot_of[n]);
        }
    const std::vector<bool> all(kept.size(), true);
    CorrectionOptions together = options;
    together.reject_outliers = false;
    out.correction.displacement = from;
    RegionSolver solver;
    for (int round = 0; round < kMostRounds; ++round) {
        const elastic::ShapeInformation seen =
            elastic::shape_information(slots, kept_slots, kept, options, out.correction.displacement, all);
        if (!seen.regular || seen.rank < 1) {
            out.why = "the measured spots are too few to tell the shape from the motion";
            return out;
        }
        const MatrixXd heavy = seen.information * prior.shapes;
        MatrixXd a = prior.shapes.transpose() * heavy;
        a.diagonal() += prior.precision;
        const Eigen::LDLT<MatrixXd> factorised(a);
        const VectorXd before = out.amplitudes;
        const VectorXd y = seen.measured - prior.common;
        out.amplitudes = factorised.solve(heavy.transpose() * y + prior.precision.cwiseProduct(prior.mean));
        out.covariance = factorised.solve(MatrixXd::Identity(a.rows(), a.cols()));
        out.rigid_from_amplitudes = seen.rigid_from_shape * prior.shapes;
        const VectorXd left = y - prior.shapes * out.amplitudes;
        const VectorXd off = out.amplitudes - prior.mean;
        out.chi_square = left.dot(seen.information * left) + off.dot(prior.precision.cwiseProduct(off));
        out.degrees = seen.rank;
        const VectorXd u = prior.shapes * out.amplitudes + prior.common;
        std::vector<SpotObservation> straight;
        for (std::size_t n = 0; n < kept.size(); ++n)
            straight.push_back(freed(kept[n], out.correction.displacement, u.segment<3>(3 * kept_slots[n])));
        const auto solved = solver.solve(straight, together, out.correction);
        if (!solved || out.correction.status != CorrectionStatus::ok) {
            out.why = solved ? out.correction.message : solved.error().text();
            if (solved && out.correction.status == CorrectionStatus::over_limit)
                out.why = "the part has moved beyond the limits";
            return out;
        }
        if (round > 0 && (out.amplitudes - before).cwiseAbs().maxCoeff() < kStandsMm) {
            out.found = out.amplitudes.allFinite();
            return out;
        }
    }
    out.why = "amplitudes and displacement did not settle";
    return out;
}

bool fits(const Joint& joint, double significance) {
    return joint.found && correction::chi_square_p(joint.chi_square, joint.degrees) >= significance;
}

// The whole set, or without the one spot that alone explains what does not fit.
Joint best_joint(std::span<const SpotObservation> spots, std::span<const int> slot_of,
                 const CorrectionOptions& options, const Prior& prior, const Displacement& from,
                 std::size_t slots, double significance, std::vector<bool>& used) {
    used.assign(spots.size(), true);
    Joint whole = joint_solution(spots, slot_of, options, prior, used, from, slots);
    if (fits(whole, significance) || !options.reject_outliers || !whole.found) return whole;
    int explain = 0;
    std::size_t which = 0;
    Joint best;
    for (std::size_t n = 0; n < spots.size() && explain < 2; ++n) {
        std::vector<bool> without(spots.size(), true);
        without[n] = false;
        Joint trial = joint_solution(spots, slot_of, options, prior, without, from, slots);
        if (!fits(trial, significance)) continue;
        ++explain;
        which = n;
        best = std::move(trial);
    }
    if (explain != 1) return whole;
    used[which] = false;
    return best;
}

// Spots of the answer in the order given, with the residuals that the joint solution leaves.
void report_spots(std::span<const SpotObservation> spots, const std::vector<bool>& used, Joint& joint) {
    std::vector<SpotResidual> all;
    std::size_t k = 0;
    for (std::size_t n = 0; n < spots.size(); ++n) {
        if (used[n])
            all.push_back(std::move(joint.correction.spots[k++]));
        else
            all.push_back({spots[n].id, Eigen::Vector3d::Zero(), false});
        if (!used[n])
            joint.correction.message = joined(joint.correction.message, "; ",
                                              Text("left out as wrong: {}: look there for a foreign particle "
                                                   "or a wrong feature",
                                                   spots[n].id));
    }
    joint.correction.spots = std::move(all);
}

// Adds what the amplitudes' uncertainty does to the pose; all of it is anew with every part.
void widen(const Joint& joint, double reach_mm, ElasticCorrection& out) {
    RegionCorrection& c = out.correction;
    const Index j = joint.amplitudes.size();
    const MatrixXd cross = joint.rigid_from_amplitudes * joint.covariance;
    const Matrix6 added = cross * joint.rigid_from_amplitudes.transpose();
    const Matrix6 before = c.covariance;
    c.covariance_random += added;
    c.covariance = c.covariance_systematic + c.covariance_random;
    out.covariance = MatrixXd::Zero(6 + j, 6 + j);
    out.covariance.topLeftCorner<6, 6>() = c.covariance;
    out.covariance.topRightCorner(6, j) = cross;
    out.covariance.bottomLeftCorner(j, 6) = cross.transpose();
    out.covariance.bottomRightCorner(j, j) = joint.covariance;
    // Printed sigmas grow as their covariance does: xyz exactly, the angles by the largest ratio.
    double ratio = 1;
    for (int i = 0; i < 6; ++i)
        if (before(i, i) > 0) ratio = std::max(ratio, c.covariance(i, i) / before(i, i));
    for (int i = 0; i < 3; ++i) {
        c.sigma_xyz_mm[i] = std::sqrt(std::max(0.0, c.covariance(i, i)));
        c.sigma_random.xyz_mm[i] = std::sqrt(std::max(0.0, c.covariance_random(i, i)));
    }
    c.sigma_abc_deg *= std::sqrt(ratio);
    c.sigma_random.abc_deg *= std::sqrt(ratio);
    c.sigma_at_spots_mm = std::hypot(c.sigma_at_spots_mm, reach_mm);
}

// The reason why the modes must not act, empty when they may.
Text objection(const Joint& joint, const ElasticModes& modes, const ElasticOptions& elastic,
               ElasticCorrection& out) {
    out.chi_square = joint.chi_square;
    out.degrees = joint.degrees;
    out.probability = correction::chi_square_p(joint.chi_square, joint.degrees);
    out.shape_fits = out.probability >= elastic.fit_significance;
    if (!out.shape_fits)
        return Text(
            "the part has a shape that was not learnt: what the modes leave is {:.1f} times the stated "
            "sigma",
            std::sqrt(joint.chi_square / joint.degrees));
    for (std::size_t k = 0; k < out.amplitudes.size(); ++k) {
        if (out.amplitudes[k].learnt) continue;
        const ElasticMode& mode = modes.modes[k];
        return Text("mode {} stands at {:.3f} mm, learnt were {:.3f} to {:.3f} mm", k + 1,
                    out.amplitudes[k].value_mm, mode.lowest_mm, mode.highest_mm);
    }
    if (!(out.largest_added_mm <= elastic.most_added_mm))
        return Text("the modes would add {:.3f} mm, over the limit of {:.3f} mm", out.largest_added_mm,
                    elastic.most_added_mm);
    return {};
}

Text not_as_learnt(std::span<const SpotObservation> spots, std::span<const int> slot_of,
                   const ElasticModes& modes) {
    constexpr double kAsLearnt = 1e-6;  // mm, and a rotation's entries
    for (std::size_t n = 0; n < spots.size(); ++n) {
        if (slot_of[n] < 0)
            return Text("spot {} was added since the modes were learnt: learn them again", spots[n].id);
        const ElasticSpot& then = modes.spots[static_cast<std::size_t>(slot_of[n])];
        const bool same = (then.workobject_from_sensor.matrix() - spots[n].workobject_from_sensor.matrix())
                                  .cwiseAbs()
                                  .maxCoeff() < kAsLearnt &&
                          (then.reference_mm - spots[n].reference_mm).cwiseAbs().maxCoeff() < kAsLearnt &&
                          then.weights == spots[n].weights;
        if (!same)
            return Text("spot {} was taught anew since the modes were learnt: learn them again", spots[n].id);
    }
    return {};
}

}  // namespace

Expected<ElasticCorrection> solve_elastic(std::span<const SpotObservation> spots,
                                          const CorrectionOptions& options, const ElasticModes& modes,
                                          const ElasticOptions& elastic) {
    ElasticCorrection out;
    SEAM_TRY(out.correction, solve_region(spots, options));
    if (modes.modes.empty()) return out;
    SEAM_OK(check_modes(modes));
    const std::vector<int> slot_of = elastic::slots_of(modes.spots, spots);
    out.why = not_as_learnt(spots, slot_of, modes);
    if (!out.why.empty()) return out;

    // From where all spots together put the part: a bent one may look like wrong spots to the rigid solve.
    CorrectionOptions all = options;
    all.reject_outliers = false;
    all.limits = {};
    SEAM_TRY(const RegionCorrection rough, solve_region(spots, all));
    if (rough.status != CorrectionStatus::ok) {
        out.why = "the displacement is not found";
        return out;
    }
    const Prior prior = prior_of(modes);
    std::vector<bool> used;
    Joint joint = best_joint(as_noisy(spots, slot_of, modes), slot_of, options, prior, rough.displacement,
                             modes.spots.size(), elastic.fit_significance, used);
    if (!joint.found) {
        out.why = joint.why;
        return out;
    }
    for (Index k = 0; k < joint.amplitudes.size(); ++k) {
        const ElasticMode& mode = modes.modes[static_cast<std::size_t>(k)];
        const double value = joint.amplitudes[k], room = std::sqrt(mode.variance_mm2);
        out.amplitudes.push_back({value, std::sqrt(std::max(0.0, joint.covariance(k, k))),
                                  value >= mode.lowest_mm - room && value <= mode.highest_mm + room});
    }
    const VectorXd u = prior.shapes * joint.amplitudes;
    double reach = 0;
    for (const int slot : slot_of) {
        out.largest_added_mm = std::max(out.largest_added_mm, u.segment<3>(3 * slot).norm());
        const MatrixXd at = prior.shapes.middleRows(3 * slot, 3);
        const Eigen::Matrix3d spread = at * joint.covariance * at.transpose();
        reach = std::max(reach, std::sqrt(std::max(0.0, spread.trace())));
    }
    out.why = objection(joint, modes, elastic, out);
    if (!out.why.empty()) return out;
    report_spots(spots, used, joint);
    out.correction = std::move(joint.correction);
    widen(joint, reach, out);
    out.acted = true;
    return out;
}

}  // namespace seamwright
