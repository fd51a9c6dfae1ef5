// A region's spots made ready: each with its noise as unit, what errs from spot to spot folded in.

#include <algorithm>
#include <cmath>

#include "core/correction/region_system.h"

namespace seamwright::correction {
namespace {

void put_xz(const Eigen::Matrix2d& c, Eigen::Matrix3d& out) {
    out(0, 0) = c(0, 0);
    out(2, 2) = c(1, 1);
    out(0, 2) = out(2, 0) = c(1, 0);
}

// shape with shape shape^T sigma^2 = noise + local terms over the observed axes; flat is its inverse.
void fold(const SpotObservation& in, const LocalTerms& local, PreparedSpot& s, Eigen::Matrix3d& flat) {
    const double variance = in.sigma_mm * in.sigma_mm;
    const Eigen::Matrix3d repeating = local.taught + local.reference;
    const Eigen::Matrix3d systematic = kept(in.weights, repeating);
    Eigen::Matrix3d all = kept(in.weights, noise_covariance(in) + (local.run + repeating));
    for (int i = 0; i < 3; ++i)
        if (!(in.weights[i] > 0)) all(i, i) = variance;
    // Cholesky, and its inverse.
    Eigen::Matrix3d& t = s.shape;
    t(0, 0) = std::sqrt(all(0, 0));
    t(1, 0) = all(1, 0) / t(0, 0);
    t(2, 0) = all(2, 0) / t(0, 0);
    t(1, 1) = std::sqrt(all(1, 1) - t(1, 0) * t(1, 0));
    t(2, 1) = (all(2, 1) - t(2, 0) * t(1, 0)) / t(1, 1);
    t(2, 2) = std::sqrt(all(2, 2) - t(2, 0) * t(2, 0) - t(2, 1) * t(2, 1));
    t /= in.sigma_mm;
    for (int i = 0; i < 3; ++i) flat(i, i) = 1 / t(i, i);
    flat(1, 0) = -t(1, 0) * flat(0, 0) * flat(1, 1);
    flat(2, 1) = -t(2, 1) * flat(1, 1) * flat(2, 2);
    flat(2, 0) = -(t(2, 0) * flat(0, 0) + t(2, 1) * flat(1, 0)) * flat(2, 2);
    s.repeats = !systematic.isZero(0);
    const Eigen::Matrix3d half = flat.lazyProduct(systematic);
    s.systematic = half.lazyProduct(flat.transpose()) / variance;
}

// The same of the usual spot, straight and x and z observed alike: two by two. False where nothing errs.
bool fold_xz(const SpotObservation& in, const Matrix6* arrival, const Eigen::Vector3d& measured_mm,
             PreparedSpot& s, Eigen::Matrix3d& flat) {
    const double variance = in.sigma_mm * in.sigma_mm;
    CovarianceXz run, same;
    if (arrival) {
        run = arrival_xz(*arrival, measured_mm);
        const CovarianceXz taught = arrival_xz(*arrival, in.reference_mm);
        const double share = 1 / static_cast<double>(in.reference_arrivals);
        same = {share * taught.xx, share * taught.zx, share * taught.zz};
    }
    if (in.reference_covariance_mm2) {
        const Eigen::Matrix2d& c = *in.reference_covariance_mm2;
        if (!arrival && c.isZero(0)) return false;
        same.xx += c.coeff(0, 0);
        same.zx += c.coeff(1, 0);
        same.zz += c.coeff(1, 1);
    } else if (!arrival) {
        return false;
    }
    double nxx = variance, nzx = 0, nzz = variance;
    if (in.covariance_mm2) {
        nxx = in.covariance_mm2->coeff(0, 0);
        nzx = in.covariance_mm2->coeff(1, 0);
        nzz = in.covariance_mm2->coeff(1, 1);
    }
    // Cholesky (a, 0; c, d), and its inverse.
    const double a = std::sqrt(nxx + run.xx + same.xx), per_a = 1 / a;
    const double c = (nzx + run.zx + same.zx) * per_a;
    const double d = std::sqrt(nzz + run.zz + same.zz - c * c);
    const double by = 1 / in.sigma_mm, p = in.sigma_mm * per_a, r = in.sigma_mm / d, q = -c * per_a * r;
    s.shape.coeffRef(0, 0) = a * by;
    s.shape.coeffRef(2, 0) = c * by;
    s.shape.coeffRef(2, 2) = d * by;
    flat.coeffRef(0, 0) = p;
    flat.coeffRef(2, 0) = q;
    flat.coeffRef(2, 2) = r;
    s.repeats = same.xx != 0 || same.zx != 0 || same.zz != 0;
    // flat (xx, zx; zx, zz) flat^T / variance.
    const double inverse = by * by, qx = q * same.xx + r * same.zx, qz = q * same.zx + r * same.zz;
    s.systematic.setZero();
    s.systematic.coeffRef(0, 0) = p * p * same.xx * inverse;
    s.systematic.coeffRef(2, 0) = s.systematic.coeffRef(0, 2) = p * qx * inverse;
    s.systematic.coeffRef(2, 2) = (q * qx + r * qz) * inverse;
    return true;
}

}  // namespace

LocalTerms local_terms(const SpotObservation& in, bool from_reference) {
    return local_terms(in, from_reference,
                       in.robot_covariance
                           ? arrival_along_sensor(in.workobject_from_sensor, *in.robot_covariance)
                           : Matrix6(Matrix6::Zero()));
}

LocalTerms local_terms(const SpotObservation& in, bool from_reference, const Matrix6& arrival) {
    LocalTerms out;
    if (in.robot_covariance && !in.robot_covariance->isZero(0)) {
        out.any = true;
        const bool curved = in.curve && in.weights.y() == 0;
        const bool travel = curved || in.weights.y() > 0;
        out.run = arrival_covariance(arrival, from_reference ? in.reference_mm : in.measured_mm, travel);
        out.taught =
            arrival_covariance(arrival, in.reference_mm, travel) / static_cast<double>(in.reference_arrivals);
        if (curved) {
            // An arrival further along the contour sees it where it runs on.
            Eigen::Matrix3d along = Eigen::Matrix3d::Identity();
            along(0, 1) = -in.curve->x_coefficients[0];
            along(2, 1) = -in.curve->z_coefficients[0];
            out.run = along * out.run * along.transpose();
            out.taught = along * out.taught * along.transpose();
        }
    }
    if (in.reference_covariance_mm2 && !in.reference_covariance_mm2->isZero(0)) {
        out.any = true;
        put_xz(*in.reference_covariance_mm2, out.reference);
    }
    return out;
}

Eigen::Matrix3d noise_covariance(const SpotObservation& in) {
    Eigen::Matrix3d out = in.sigma_mm * in.sigma_mm * Eigen::Matrix3d::Identity();
    if (in.covariance_mm2) put_xz(*in.covariance_mm2, out);
    return out;
}

Eigen::Matrix3d kept(const Eigen::Vector3d& weights, Eigen::Matrix3d covariance) {
    const double weight = weights.maxCoeff();
    bool together = true;  // the observed axes count the same
    for (int i = 0; i < 3; ++i) together = together && (weights[i] == 0 || weights[i] == weight);
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            if (!(weights[i] > 0 && weights[k] > 0 && (together || i == k))) covariance(i, k) = 0;
    return covariance;
}

const RegionSystem::Arrival& RegionSystem::arrival_of(std::size_t n, const SpotObservation& in,
                                                      const Accepted* accepted) {
    Arrival& known = arrivals_[n];
    if (!in.robot_covariance) return known;
    const Eigen::Matrix3d axes = in.workobject_from_sensor.linear();
    const unsigned revision = accepted ? accepted->robots[n].revision : 0;
    const bool same =
        revision > 0 ? known.revision == revision : same_bits(known.covariance, *in.robot_covariance);
    if (!same || !same_bits(known.axes, axes)) {
        known.axes = axes;
        known.covariance = *in.robot_covariance;
        known.along_sensor = arrival_along_sensor(in.workobject_from_sensor, known.covariance);
        known.revision = revision;
        known.none = known.covariance.isZero(0);
    }
    return known;
}

void RegionSystem::load(std::span<const SpotObservation> spots, const CorrectionOptions& options,
                        bool from_reference, const Accepted* accepted) {
    if (!same_priors(options_.sensors, options.sensors)) {
        priors_.clear();
        prior_of_.clear();
        for (const SensorPrior& prior : options.sensors) {
            prior_of_.push_back(is_zero(prior) ? -1 : static_cast<int>(priors_.size()));
            if (prior_of_.back() >= 0) priors_.push_back(root_of(prior));
        }
    }
    options_ = options;
    spots_.resize(spots.size());
    arrivals_.resize(spots.size());
    binary_ = true;
    repeats_ = false;
    centroid_.setZero();
    const auto prior_index = [&](const std::string& id) {
        for (std::size_t i = 0; i < options.sensors.size(); ++i)
            if (options.sensors[i].id == id) return prior_of_[i];
        return -1;
    };
    for (std::size_t n = 0; n < spots.size(); ++n) {
        const SpotObservation& in = spots[n];
        PreparedSpot& s = spots_[n];
        s.shape.setIdentity();
        Eigen::Matrix3d flat = Eigen::Matrix3d::Identity();
        s.repeats = false;
        const Arrival& arrival = arrival_of(n, in, accepted);
        bool folded = false;
        if (in.weights.y() == 0 && in.weights.x() > 0 && in.weights.x() == in.weights.z() && !in.curve) {
            const bool arrives = in.robot_covariance && !arrival.none;
            folded = fold_xz(in, arrives ? &arrival.along_sensor : nullptr,
                             from_reference ? in.reference_mm : in.measured_mm, s, flat);
        } else if (const LocalTerms local = local_terms(in, from_reference, arrival.along_sensor);
                   local.any) {
            fold(in, local, s, flat);
            folded = true;
        }
        if (folded) {
            repeats_ = repeats_ || s.repeats;
        } else if (in.covariance_mm2) {
            // Lower triangle of Cholesky, over sigma.
            const Eigen::Matrix2d& c = *in.covariance_mm2;
            const double xx = std::sqrt(c(0, 0)), zx = c(1, 0) / xx, zz = std::sqrt(c(1, 1) - zx * zx);
            s.shape(0, 0) = xx / in.sigma_mm;
            s.shape(2, 0) = zx / in.sigma_mm;
            s.shape(2, 2) = zz / in.sigma_mm;
            flat(0, 0) = in.sigma_mm / xx;
            flat(2, 2) = in.sigma_mm / zz;
            flat(2, 0) = -zx / xx * flat(2, 2);
        }
        s.sensor_from_workobject = flat * in.workobject_from_sensor.linear().transpose();
        s.sensor_origin = in.workobject_from_sensor.translation();
        s.axes = s.sensor_from_workobject.transpose();
        s.offset = flat * in.reference_mm + s.sensor_from_workobject * s.sensor_origin;
        s.measured = in.workobject_from_sensor * (from_reference ? in.reference_mm : in.measured_mm);
        s.reference = flat * in.reference_mm;
        s.weights = in.weights;
        s.sigma = in.sigma_mm;
        s.curved = in.curve && in.weights.y() == 0;
        if (s.curved) {
            s.curve = *in.curve;
            s.curve.x_coefficients *= flat(0, 0);
            s.curve.z_coefficients =
                flat(2, 0) * in.curve->x_coefficients + flat(2, 2) * in.curve->z_coefficients;
        }
        s.sensor = prior_index(in.sensor);
        if (s.sensor >= 0) {
            s.geometry.axes = in.workobject_from_sensor.linear();
            s.geometry.origin = in.workobject_from_sensor.translation();
            s.geometry.reference = in.reference_mm;
            s.geometry.measured = from_reference ? in.reference_mm : in.measured_mm;
            s.geometry.flat = flat;
            s.geometry.latency_travel = in.latency_travel_mm;
        }
        s.observed = 0;
        for (int i = 0; i < 3; ++i) {
            s.observed += in.weights[i] > 0;
            binary_ = binary_ && (in.weights[i] == 0 || in.weights[i] == 1);
        }
        centroid_ += in.workobject_from_sensor * in.reference_mm;
    }
    centroid_ /= static_cast<double>(spots.size());
    double square = 0;
    for (const SpotObservation& in : spots)
        square += (in.workobject_from_sensor * in.reference_mm - centroid_).squaredNorm();
    spread_ = std::max(1.0, std::sqrt(square / static_cast<double>(spots.size())));
    free_count_ = static_cast<int>(std::count(options.free.begin(), options.free.end(), true));
    all_free_ = free_count_ == 6;
    by_angles_ = !(options.free[3] && options.free[4] && options.free[5]);
}

}  // namespace seamwright::correction
