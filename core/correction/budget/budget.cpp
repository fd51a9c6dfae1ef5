#include "core/correction/budget/budget.h"

#include <cmath>

#include "core/correction/region_system.h"
#include "core/correction/travel.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace correction;

// Of the whole noise: below, what is left of it is rounding.
constexpr double kRounding = 1e-12;

// Covariances of one spot's errors along the sensor's axes, mm^2.
struct Share {
    ErrorSource source;
    Eigen::Matrix3d covariance;
};

std::vector<Share> shares_of(const BudgetSpot& b, const SpotObservation& with_travel, bool as_taught) {
    const Eigen::Matrix3d noise = noise_covariance(b.spot),
                          stated = b.stated_sigma_mm * b.stated_sigma_mm * Eigen::Matrix3d::Identity();
    Eigen::Matrix3d feature = noise - stated;
    if (feature.cwiseAbs().maxCoeff() <= kRounding * noise.trace()) feature.setZero();
    const LocalTerms local = local_terms(with_travel, as_taught);
    std::vector<Share> all{{ErrorSource::feature, feature},
                           {ErrorSource::stated, stated},
                           {ErrorSource::travel, noise_covariance(with_travel) - noise},
                           {ErrorSource::robot_run, local.run},
                           {ErrorSource::reference, local.reference},
                           {ErrorSource::robot_taught, local.taught}};
    // Where nothing is folded in, the noise stands as it is.
    if (local.any)
        for (Share& s : all) s.covariance = kept(b.spot.weights, s.covariance);
    return all;
}

double mean_square(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& weights) {
    double sum = 0, axes = 0;
    for (int i = 0; i < 3; ++i)
        if (weights[i] > 0) sum += covariance(i, i), ++axes;
    return axes > 0 ? sum / axes : 0;
}

// In xi, before the bread.
Matrix6 meat_of(const Predicted& p, std::size_t n, const Eigen::Matrix3d& covariance) {
    const PreparedSpot& s = p.system.spot(n);
    Eigen::Vector3d e;
    Rows rows;
    if (p.shared.sensors.empty())
        p.system.residual(n, p.state, e, rows);
    else
        rows = p.shared.spots[n].rows;
    Eigen::Matrix3d flat = Eigen::Matrix3d::Identity();
    s.shape.triangularView<Eigen::Lower>().solveInPlace(flat);
    Eigen::Vector3d weight = s.weights.cwiseAbs2() / (s.sigma * s.sigma);
    for (int i = 0; i < 3; ++i)
        if (!(s.weights[i] > 0)) rows.row(i).setZero(), weight[i] = 0;
    const Eigen::Matrix<double, 6, 3> half = rows.transpose() * weight.asDiagonal() * flat;
    return half * covariance * half.transpose();
}

struct Writer {
    const Predicted& p;
    UncertaintyBudget& out;
    void add(ErrorSource source, std::size_t of, double input_sigma, const Matrix6& meat) const {
        BudgetTerm& term = out.terms.emplace_back();
        term.source = source;
        term.of = of;
        term.input_sigma = input_sigma;
        outer(p.spread.bread * meat * p.spread.bread, term.covariance, term.sigma);
    }
    // Of D itself.
    void add_found(ErrorSource source, double input_sigma, const Matrix6& xi) const {
        BudgetTerm& term = out.terms.emplace_back();
        term.source = source;
        term.input_sigma = input_sigma;
        outer(xi, term.covariance, term.sigma);
    }
    void outer(const Matrix6& xi, Matrix6& covariance, DofSigma& sigma) const {
        p.system.outer(xi, p.state, covariance, sigma.xyz_mm, sigma.abc_deg);
        sigma.abc_deg *= deg_from_rad(1);
    }
};

double hand_eye_sigma(std::span<const BudgetSpot> spots, const SensorPrior& prior) {
    double sum = 0, n = 0;
    for (const BudgetSpot& b : spots) {
        if (b.spot.sensor != prior.id) continue;
        Eigen::Matrix<double, 3, 6> j;
        j << Eigen::Matrix3d::Identity(), -skew(b.spot.reference_mm);
        const Eigen::Matrix3d c = j * prior.hand_eye_covariance * j.transpose();
        sum += 0.5 * (c(0, 0) + c(2, 2));
        ++n;
    }
    return n > 0 ? std::sqrt(sum / n) : 0;
}

// At the spots' references.
double workobject_sigma(std::span<const BudgetSpot> spots, const Matrix6& covariance) {
    double sum = 0;
    for (const BudgetSpot& b : spots) {
        Eigen::Matrix<double, 3, 6> j;
        j << Eigen::Matrix3d::Identity(), -skew(b.spot.workobject_from_sensor * b.spot.reference_mm);
        sum += (j * covariance * j.transpose()).trace() / 3;
    }
    return std::sqrt(sum / static_cast<double>(spots.size()));
}

double latency_travel(std::span<const BudgetSpot> spots, const SensorPrior& prior) {
    double sum = 0, n = 0;
    for (const BudgetSpot& b : spots)
        if (b.spot.sensor == prior.id) sum += b.spot.latency_travel_mm * b.spot.latency_travel_mm, ++n;
    return n > 0 ? prior.latency_sigma * std::sqrt(sum / n) : 0;
}

void add_sensor(const Writer& writer, const SensorPrior& prior, std::size_t of, const SharedBlock* block,
                double hand_eye, double latency) {
    const auto add = [&](ErrorSource source, double sigma, Eigen::Index from, Eigen::Index count) {
        if (!(sigma > 0)) return;
        Matrix6 meat = Matrix6::Zero();
        if (block) {
            const auto gain = block->gain.middleCols(from, count);
            meat = gain * gain.transpose();
        }
        writer.add(source, of, sigma, meat);
    };
    add(ErrorSource::hand_eye, hand_eye, 0, 6);
    add(ErrorSource::scale_x, prior.scale_sigma.x(), kScaleAt, 1);
    add(ErrorSource::scale_z, prior.scale_sigma.y(), kScaleAt + 1, 1);
    add(ErrorSource::shear, prior.shear_sigma, kShearAt, 1);
    add(ErrorSource::latency, latency, kLatencyAt, 1);
    add(ErrorSource::speed, latency > 0 ? prior.speed_sigma : 0, kSpeedAt, 1);
    add(ErrorSource::sensor_drift, prior.drift_sigma_mm.norm() / std::sqrt(3.0), kDriftAt, 3);
}

}  // namespace

std::string_view to_string(ErrorSource source) {
    switch (source) {
        case ErrorSource::feature:
            return "feature";
        case ErrorSource::stated:
            return "stated";
        case ErrorSource::travel:
            return "travel";
        case ErrorSource::robot_run:
            return "robot_run";
        case ErrorSource::reference:
            return "reference";
        case ErrorSource::robot_taught:
            return "robot_taught";
        case ErrorSource::nozzle:
            return "nozzle";
        case ErrorSource::offset:
            return "offset";
        case ErrorSource::workobject:
            return "workobject";
        case ErrorSource::robot_drift:
            return "robot_drift";
        case ErrorSource::hand_eye:
            return "hand_eye";
        case ErrorSource::scale_x:
            return "scale_x";
        case ErrorSource::scale_z:
            return "scale_z";
        case ErrorSource::shear:
            return "shear";
        case ErrorSource::latency:
            return "latency";
        case ErrorSource::speed:
            return "speed";
        case ErrorSource::sensor_drift:
            return "sensor_drift";
    }
    return "unknown";
}

Expected<UncertaintyBudget> uncertainty_budget(std::span<const BudgetSpot> spots,
                                               const CorrectionOptions& options,
                                               const Displacement& displacement) {
    std::vector<SpotObservation> observations;
    for (const BudgetSpot& b : spots) {
        observations.push_back(b.spot);
        observations.back().measured_mm = b.spot.reference_mm;
    }
    SEAM_OK(check_region(observations, options, false));
    const bool as_taught = displacement.workobject_from_movedworkobject.matrix().isIdentity(0);
    for (std::size_t n = 0; n < spots.size(); ++n) {
        observations[n].measured_mm = displaced_measure(observations[n], displacement);
        add_travel(observations[n], displacement, spots[n].half_window_mm);
    }
    const Predicted p = predict(observations, options, displacement);
    UncertaintyBudget out;
    out.determined = p.spread.regular;
    if (!out.determined) return out;
    const Writer writer{p, out};
    const RegionSystem::Added added = p.system.added(p.state);
    writer.outer(p.spread.covariance + added.sum(), out.covariance, out.sigma);
    if (options.robot_drift_sigma_mm > 0)
        writer.add_found(ErrorSource::robot_drift, options.robot_drift_sigma_mm, added.robot_drift);
    if (const Matrix6& c = options.workobject_covariance; !c.isZero(0))
        writer.add_found(ErrorSource::workobject, workobject_sigma(spots, c), added.workobject);
    for (std::size_t n = 0; n < spots.size(); ++n)
        for (const Share& share : shares_of(spots[n], observations[n], as_taught)) {
            if (share.source == ErrorSource::travel ? spots[n].half_window_mm == 0
                                                    : share.covariance.isZero(0))
                continue;
            const double sigma =
                share.source == ErrorSource::travel
                    ? spots[n].half_window_mm / std::sqrt(3.0)
                    : std::sqrt(std::max(0.0, mean_square(share.covariance, spots[n].spot.weights)));
            writer.add(share.source, n, sigma, meat_of(p, n, share.covariance));
        }
    std::size_t block = 0;  // sensors without priors have none
    for (std::size_t i = 0; i < options.sensors.size(); ++i) {
        if (is_zero(options.sensors[i])) continue;
        add_sensor(writer, options.sensors[i], i,
                   p.shared.sensors.empty() ? nullptr : &p.shared.sensors[block],
                   hand_eye_sigma(spots, options.sensors[i]), latency_travel(spots, options.sensors[i]));
        ++block;
    }
    return out;
}

}  // namespace seamwright
