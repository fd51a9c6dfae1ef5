#include "core/panel/panel_fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/correction/region_system.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/notation.h"

namespace seamwright {
namespace {

using Rows = Eigen::MatrixXd;

SpotObservation observation_of(const PanelSpot& spot, const PanelSide& side) {
    SpotObservation o;
    o.id = spot.id;
    o.workobject_from_sensor = spot.gripper_from_sensor;
    o.reference_mm = side.reference_mm;
    o.measured_mm = side.measured_mm;
    o.weights = spot.weights;
    o.sigma_mm = spot.sigma_mm;
    return o;
}

Eigen::Vector3d observed(const PanelSpot& spot, const Eigen::Vector3d& v) {
    return (spot.weights.array() > 0).select(v, 0.0);
}

// e = r - S^-1 D^-1 S m, all three axes.
Eigen::Vector3d residual(const SpotObservation& o, const Pose& displacement) {
    const Pose& s = o.workobject_from_sensor;
    return o.reference_mm - s.inverse() * (displacement.inverse() * (s * o.measured_mm));
}

// How the least-squares solution answers to a change of the residuals: d(tangent) = -gain * de, and the
// residuals to a change of the tangent: de = jacobian * d(tangent). Rows of unused spots are 0.
struct Response {
    Eigen::MatrixXd jacobian;  // [3 n x 6]
    Eigen::MatrixXd gain;      // [6 x 3 n]
};

Response respond(std::span<const SpotObservation> spots, const std::vector<SpotResidual>& used,
                 const Pose& displacement) {
    const Eigen::Index n = static_cast<Eigen::Index>(spots.size());
    Response out;
    out.jacobian = Eigen::MatrixXd::Zero(3 * n, 6);
    Eigen::VectorXd omega = Eigen::VectorXd::Zero(3 * n);
    const Eigen::Matrix3d back = displacement.linear().transpose();
    for (Eigen::Index k = 0; k < n; ++k) {
        const SpotObservation& o = spots[static_cast<std::size_t>(k)];
        const Eigen::Matrix3d axes = o.workobject_from_sensor.linear().transpose() * back;
        const Eigen::Vector3d lever = o.workobject_from_sensor * o.measured_mm - displacement.translation();
        // de/dt = axes; R <- Exp(w) R gives R^T (I - skew(w)) lever, so de/dw = -axes skew(lever).
        out.jacobian.block<3, 3>(3 * k, 0) = axes;
        out.jacobian.block<3, 3>(3 * k, 3) = -axes * skew(lever);
        if (!used[static_cast<std::size_t>(k)].used) continue;
        for (int i = 0; i < 3; ++i)
            if (o.weights[i] > 0) omega[3 * k + i] = std::pow(o.weights[i] / o.sigma_mm, 2);
    }
    const Eigen::MatrixXd weighted = omega.asDiagonal() * out.jacobian;
    const Matrix6 information = out.jacobian.transpose() * weighted;
    // Scaled to a unit diagonal: mm and rad.
    const Vector6 scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Matrix6 scaled = scale.asDiagonal() * information * scale.asDiagonal();
    out.gain = scale.asDiagonal() * solve_symmetric(scaled, scale.asDiagonal() * weighted.transpose());
    return out;
}

// d(tangent of B P^-1)/d(tangent of B) and .../d(tangent of P).
void motion_jacobians(const Pose& b, const Pose& p, Matrix6& by_b, Matrix6& by_p) {
    // G = B Q, Q = P^-1. t_G = R_B t_Q + t_B; R_G = R_B R_Q.
    const Eigen::Vector3d t_q = p.inverse().translation();
    const Eigen::Matrix3d r_g = b.linear() * p.linear().transpose();
    by_b.setIdentity();
    by_b.topRightCorner<3, 3>() = -skew(b.linear() * t_q);
    by_p.setZero();
    // t_Q = -R_P^T t_P: moved by dt_P gives -R_P^T dt, turned by w gives +R_P^T (w x t_P)... = -R_P^T
    // skew(t_P) w; R_Q <- R_P^T Exp(-w) turns R_G by -R_B R_P^T w.
    by_p.topLeftCorner<3, 3>() = -r_g;
    by_p.topRightCorner<3, 3>() = -r_g * skew(p.translation());
    by_p.bottomRightCorner<3, 3>() = -r_g;
}

Text with_side(const char* side, const RegionCorrection& r) {
    return Text("{}: {}", Text(side), r.message.empty() ? Text(to_string(r.status).data()) : r.message);
}

Error on_side(Error error, const char* side) {
    error.what = Text("{} ({})", error.what, Text(side));
    return error;
}

// The spots of a side that contradict the others, as the rejection would tell them.
std::vector<std::string> contradicting(std::span<const SpotObservation> side, CorrectionOptions options) {
    options.reject_outliers = true;
    std::vector<std::string> names;
    if (const auto solved = solve_region(side, options))
        for (const SpotResidual& s : solved->spots)
            if (!s.used) names.push_back(s.id);
    return names;
}

// Sigma of G at the spots and the directions that exceed the limits.
void judge(std::span<const SpotObservation> spots, const PanelOptions& options, PanelFit& fit,
           bool& observable) {
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (const SpotObservation& o : spots) centroid += o.workobject_from_sensor * o.reference_mm;
    centroid /= static_cast<double>(spots.size());
    double square = 0;
    for (const SpotObservation& o : spots)
        square += (o.workobject_from_sensor * o.reference_mm - centroid).squaredNorm();
    const double spread = std::max(1.0, std::sqrt(square / static_cast<double>(spots.size())));
    Matrix6 to_xi = Matrix6::Identity();
    to_xi.topRightCorner<3, 3>() = -skew(fit.gripper_motion.linear() * centroid);
    to_xi.bottomRightCorner<3, 3>() *= spread;
    const Matrix6 xi = to_xi * fit.covariance * to_xi.transpose();
    fit.sigma_at_spots_mm = std::sqrt(std::max(0.0, symmetric_eigen(xi).values[5]));
    const double limit_rotation =
        std::min(options.sigma_limit_mm, rad_from_deg(options.sigma_limit_deg) * spread);
    Vector6 limit;
    limit << Eigen::Vector3d::Constant(options.sigma_limit_mm), Eigen::Vector3d::Constant(limit_rotation);
    const Vector6 per = limit.cwiseInverse();
    const SymmetricEigen eta = symmetric_eigen(per.asDiagonal() * xi * per.asDiagonal());
    Eigen::Matrix<double, 6, Eigen::Dynamic> weak(6, 0);
    for (int k = 0; k < 6; ++k) {
        if (eta.values[k] <= 1) continue;
        weak.conservativeResize(6, weak.cols() + 1);
        weak.col(weak.cols() - 1) = (limit.asDiagonal() * eta.vectors.col(k)).normalized();
    }
    observable = weak.cols() == 0;
    if (!observable) fit.unobservable = correction::name_directions(weak, centroid, spread);
}

void fill_spots(std::span<const PanelSpot> spots, std::span<const SpotObservation> panel,
                std::span<const SpotObservation> body, const Pose& p, const Pose& b, PanelFit& fit) {
    double squares = 0, weights = 0;
    for (std::size_t n = 0; n < spots.size(); ++n) {
        const PanelSpot& s = spots[n];
        PanelSpotResult& out = fit.spots[n];
        out.residual_mm = observed(s, residual(body[n], b) - residual(panel[n], p));
        const GapFlushValue zero = out.taught;
        const Eigen::Vector3d relation = s.panel.reference_mm - s.body.reference_mm;
        const GapFlushValue left = gap_and_flush(s, relation + out.residual_mm, Eigen::Vector3d::Zero());
        out.remaining = {left.gap_mm - zero.gap_mm, left.flush_mm - zero.flush_mm};
        if (!out.panel_used || !out.body_used) continue;
        for (int i = 0; i < 3; ++i) {
            if (!(s.weights[i] > 0)) continue;
            squares += std::pow(s.weights[i] * out.residual_mm[i], 2);
            weights += s.weights[i] * s.weights[i];
        }
    }
    fit.rms_mm = weights > 0 ? std::sqrt(squares / weights) : 0;
}

// Both sides' measures, and what they say of gap and flush before anything moves.
Expected<void> read_spots(std::span<const PanelSpot> spots, std::vector<SpotObservation>& panel,
                          std::vector<SpotObservation>& body, PanelFit& fit) {
    for (const PanelSpot& s : spots) {
        if (!std::isfinite(s.surface_rad))
            return input_error("the surface's direction is not a finite number", Text("spot {}", s.id));
        panel.push_back(observation_of(s, s.panel));
        body.push_back(observation_of(s, s.body));
        PanelSpotResult out;
        out.id = s.id;
        out.taught = gap_and_flush(s, s.panel.reference_mm, s.body.reference_mm);
        const GapFlushValue seen = gap_and_flush(s, s.panel.measured_mm, s.body.measured_mm);
        out.before = {seen.gap_mm - out.taught.gap_mm, seen.flush_mm - out.taught.flush_mm};
        fit.spots.push_back(out);
    }
    return {};
}

CorrectionOptions side_options(const PanelOptions& options) {
    CorrectionOptions each;
    each.sigma_limit_mm = options.sigma_limit_mm;
    each.sigma_limit_deg = options.sigma_limit_deg;
    each.reject_outliers = options.deviation == PanelDeviation::leave_out;
    each.outlier_significance = options.outlier_significance;
    return each;
}

// What the two sides' own answers say of the whole.
void say_of_sides(PanelFit& fit) {
    for (const auto& [side, solved] :
         {std::pair<const char*, const RegionCorrection*>{"panel", &fit.panel}, {"body", &fit.body}}) {
        if (solved->status != CorrectionStatus::ok) {
            if (fit.message.empty() || solved->status == CorrectionStatus::under_determined)
                fit.status = solved->status;
            for (const Text& direction : solved->unobservable)
                if (std::find(fit.unobservable.begin(), fit.unobservable.end(), direction) ==
                    fit.unobservable.end())
                    fit.unobservable.push_back(direction);
            fit.covariance += solved->covariance;
        } else if (solved->message.empty()) {
            continue;
        }
        fit.message = joined(fit.message, "; ", with_side(side, *solved));
    }
}

// A side is not known: its spots as far as they go, and the sigmas of both sides alone.
void fill_unsolved(PanelFit& fit) {
    fit.sigma_xyz_mm = (fit.panel.sigma_xyz_mm.cwiseAbs2() + fit.body.sigma_xyz_mm.cwiseAbs2()).cwiseSqrt();
    fit.sigma_abc_deg =
        (fit.panel.sigma_abc_deg.cwiseAbs2() + fit.body.sigma_abc_deg.cwiseAbs2()).cwiseSqrt();
    fit.sigma_at_spots_mm = std::hypot(fit.panel.sigma_at_spots_mm, fit.body.sigma_at_spots_mm);
}

// The joint form: the panel is fitted to where the body asks for it, r_P - e_B. A spot whose body is left out asks for
// nothing but the taught place; a spot whose panel is left out does not count.
struct JointSpots {
    std::vector<SpotObservation> asked, counted;
    std::vector<char> follows;  // the body, one a spot
};
JointSpots joint_spots(std::span<const PanelSpot> spots, const std::vector<SpotObservation>& panel,
                       const std::vector<SpotObservation>& body, const Pose& b, const PanelFit& fit) {
    JointSpots joint;
    for (std::size_t n = 0; n < spots.size(); ++n) {
        SpotObservation o = panel[n];
        const bool from_body = fit.spots[n].body_used;
        if (from_body) o.reference_mm -= observed(spots[n], residual(body[n], b));
        joint.follows.push_back(from_body);
        joint.asked.push_back(o);
        if (fit.spots[n].panel_used) joint.counted.push_back(o);
    }
    return joint;
}

// The gripper's motion b p^-1 with the noise of both sides:
// dB = -K_B n_B, e_B changes by (I - J_B K_B) n_B, so the panel's residual does by the negative of that.
void set_covariance(std::span<const PanelSpot> spots, const std::vector<SpotObservation>& body,
                    const JointSpots& joint, const Pose& b, const Pose& p, PanelFit& fit) {
    const Response from_body = respond(body, fit.body.spots, b);
    const Response from_panel = respond(joint.asked, fit.panel.spots, p);
    const Eigen::Index rows = from_body.jacobian.rows();
    Eigen::VectorXd variance(rows), observes(rows), passes(rows);
    for (std::size_t n = 0; n < spots.size(); ++n)
        for (int i = 0; i < 3; ++i) {
            const Eigen::Index k = static_cast<Eigen::Index>(3 * n) + i;
            variance[k] = std::pow(spots[n].sigma_mm, 2);
            observes[k] = spots[n].weights[i] > 0 ? 1 : 0;
            passes[k] = observes[k] * (joint.follows[n] ? 1 : 0);
        }
    Matrix6 by_b, by_p;
    motion_jacobians(b, p, by_b, by_p);
    const Eigen::MatrixXd k_b = from_body.gain, k_p = from_panel.gain;
    const Eigen::MatrixXd remains =
        passes.asDiagonal() * (Eigen::MatrixXd::Identity(rows, rows) - from_body.jacobian * k_b);
    const Rows from_n_body = -by_b * k_b + by_p * k_p * remains;
    const Rows from_n_panel = -by_p * k_p;
    const Eigen::VectorXd spread = variance.cwiseProduct(observes);
    fit.covariance = from_n_body * spread.asDiagonal() * from_n_body.transpose() +
                     from_n_panel * spread.asDiagonal() * from_n_panel.transpose();
    fit.sigma_xyz_mm = fit.covariance.diagonal().head<3>().cwiseSqrt();
    const Eigen::Matrix3d to_abc = kuka_jacobian(fit.gripper_motion.linear());
    const Eigen::Matrix3d abc = to_abc * fit.covariance.bottomRightCorner<3, 3>() * to_abc.transpose();
    fit.sigma_abc_deg = abc.diagonal().cwiseSqrt() * deg_from_rad(1);
}

void judge_motion(const PanelOptions& options, PanelFit& fit) {
    const double moved = fit.gripper_motion.translation().norm();
    const double turned = deg_from_rad(rotation_log(fit.gripper_motion.linear()).norm());
    if (moved > options.limits.translation_mm || turned > options.limits.rotation_deg) {
        fit.status = CorrectionStatus::over_limit;
        const Text sentence(
            "the gripper would move by {:.3f} mm and {:.3f} degrees, beyond the limits of {:g} mm and {:g} "
            "degrees: check the seat of panel and body",
            moved, turned, options.limits.translation_mm, options.limits.rotation_deg);
        fit.message = joined(sentence, "; ", fit.message);
    }
}

}  // namespace

GapFlushObserved observed_gap_flush(const Eigen::Vector3d& weights, double surface_rad) {
    const double c = std::cos(surface_rad), s = std::sin(surface_rad);
    const bool x = weights.x() > 0, z = weights.z() > 0;
    return {(x || c == 0) && (z || s == 0), (z || c == 0) && (x || s == 0)};
}

GapFlushValue gap_and_flush(const PanelSpot& spot, const Eigen::Vector3d& panel_mm,
                            const Eigen::Vector3d& body_mm) {
    const double c = std::cos(spot.surface_rad), s = std::sin(spot.surface_rad);
    const auto along = [&](const Eigen::Vector3d& v) { return c * v.x() + s * v.z(); };
    const auto across = [&](const Eigen::Vector3d& v) { return -s * v.x() + c * v.z(); };
    const GapFlushObserved observed = observed_gap_flush(spot.weights, spot.surface_rad);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double side = along(spot.body.reference_mm - spot.panel.reference_mm) < 0 ? -1 : 1;
    GapFlushValue v;
    v.gap_mm = observed.gap ? side * along(body_mm - panel_mm) : nan;
    v.flush_mm = observed.flush ? across(panel_mm - body_mm) : nan;
    return v;
}

Expected<PanelFit> fit_panel(std::span<const PanelSpot> spots, const PanelOptions& options) {
    std::vector<SpotObservation> panel, body;
    PanelFit fit;
    SEAM_OK(read_spots(spots, panel, body, fit));
    const CorrectionOptions each = side_options(options);
    auto solved_body = solve_region(body, each);
    if (!solved_body) return tl::unexpected(on_side(solved_body.error(), "body"));
    auto solved_panel = solve_region(panel, each);
    if (!solved_panel) return tl::unexpected(on_side(solved_panel.error(), "panel"));
    fit.body = std::move(*solved_body);
    fit.panel = std::move(*solved_panel);
    for (std::size_t n = 0; n < spots.size(); ++n) {
        fit.spots[n].panel_used = fit.panel.spots[n].used;
        fit.spots[n].body_used = fit.body.spots[n].used;
    }
    const Pose b = fit.body.displacement.workobject_from_movedworkobject;
    const Pose p_alone = fit.panel.displacement.workobject_from_movedworkobject;
    say_of_sides(fit);
    if (fit.panel.status != CorrectionStatus::ok || fit.body.status != CorrectionStatus::ok) {
        fill_spots(spots, panel, body, p_alone, b, fit);
        fill_unsolved(fit);
        return fit;
    }
    fit.single_step = b * p_alone.inverse();

    const JointSpots joint = joint_spots(spots, panel, body, b, fit);
    CorrectionOptions plain = each;
    plain.reject_outliers = false;
    constexpr double kNoLimit = 1e6;  // it is judged below, for the motion as a whole
    plain.sigma_limit_mm = kNoLimit;
    plain.sigma_limit_deg = kNoLimit;
    auto solved = solve_region(joint.counted, plain);
    if (!solved) return tl::unexpected(on_side(solved.error(), "panel to body"));
    if (solved->status != CorrectionStatus::ok) {
        fit.status = solved->status;
        fit.unobservable = solved->unobservable;
        fit.message = with_side("panel to body", *solved);
        fill_spots(spots, panel, body, p_alone, b, fit);
        return fit;
    }
    const Pose p = solved->displacement.workobject_from_movedworkobject;
    fit.gripper_motion = b * p.inverse();

    set_covariance(spots, body, joint, b, p, fit);

    fill_spots(spots, panel, body, p, b, fit);
    bool observable = true;
    judge(panel, options, fit, observable);
    if (!observable) {
        fit.status = CorrectionStatus::under_determined;
        fit.gripper_motion = fit.single_step = Pose::Identity();
        fit.message = Text(
            "panel and body together do not determine the gripper's {} well enough: add a spot whose edge "
            "runs "
            "in another direction",
            std::accumulate(fit.unobservable.begin(), fit.unobservable.end(), Text(),
                            [](const Text& so_far, const Text& one) { return joined(so_far, ", ", one); }));
        fill_spots(spots, panel, body, p_alone, b, fit);
        return fit;
    }
    fit.status = CorrectionStatus::ok;
    if (options.deviation == PanelDeviation::share)
        for (const auto& [side, of] : {std::pair{"panel", &panel}, std::pair{"body", &body}})
            if (const auto names = contradicting(*of, each); !names.empty())
                fit.message =
                    joined(fit.message, "; ",
                           Text("the {} deviates from its taught shape at {}: shared out over the spots",
                                Text(side), fmt::format("{}", fmt::join(names, ", "))));
    judge_motion(options, fit);
    return fit;
}

}  // namespace seamwright
