#include "core/correction/budget/monte_carlo.h"

#include <algorithm>
#include <cmath>

#include "core/correction/region_system.h"
#include "core/correction/travel.h"
#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

// root root^T = covariance, which may be singular.
template <class Matrix>
Matrix root_of(const Matrix& covariance) {
    const SymmetricEigen eigen = symmetric_eigen(covariance);
    return eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace

CorrectionDraws::CorrectionDraws(std::span<const BudgetSpot> spots, const CorrectionOptions& options,
                                 const Displacement& displacement, std::uint64_t seed)
    : spots_(spots.begin(), spots.end()),
      priors_(options.sensors),
      workobject_root_(root_of<Matrix6>(options.workobject_covariance)),
      robot_drift_mm_(options.robot_drift_sigma_mm),
      sensors_(options.sensors.size()),
      displacement_(displacement.workobject_from_movedworkobject),
      rng_(seed) {
    for (const SensorPrior& p : priors_) eye_roots_.push_back(root_of<Matrix6>(p.hand_eye_covariance));
    for (const BudgetSpot& b : spots_) {
        SpotRoots& roots = roots_.emplace_back();
        for (std::size_t i = 0; i < priors_.size(); ++i)
            if (priors_[i].id == b.spot.sensor) roots.sensor = static_cast<int>(i);
        const double stated = b.stated_sigma_mm * b.stated_sigma_mm;
        roots.feature = root_of<Eigen::Matrix3d>(correction::noise_covariance(b.spot) -
                                                 stated * Eigen::Matrix3d::Identity());
        if (const auto& c = b.spot.reference_covariance_mm2) {
            Eigen::Matrix3d reference = Eigen::Matrix3d::Zero();
            reference(0, 0) = (*c)(0, 0), reference(2, 2) = (*c)(1, 1);
            reference(0, 2) = reference(2, 0) = (*c)(1, 0);
            roots.reference = root_of<Eigen::Matrix3d>(reference);
        }
        if (b.spot.robot_covariance) roots.arrival = root_of<Matrix6>(*b.spot.robot_covariance);
        bare_.push_back(b.spot);
    }
}

Eigen::Vector3d CorrectionDraws::scattered(const Eigen::Matrix3d& root, double degrees) {
    Eigen::Vector3d v;
    for (int i = 0; i < 3; ++i) v[i] = normal();
    double wider = 1;
    if (std::isfinite(degrees))
        wider = std::sqrt(degrees / std::chi_squared_distribution<double>(degrees)(rng_));
    return wider * (root * v);
}

Pose CorrectionDraws::arrived(const Pose& workobject_from_sensor, const Matrix6& root) {
    if (root.isZero(0)) return workobject_from_sensor;
    Vector6 v;
    for (int i = 0; i < 6; ++i) v[i] = normal();
    return retract(workobject_from_sensor, root * v);
}

// `there`: the sensor as calibrated, in the work object.
Eigen::Vector3d CorrectionDraws::read(const BudgetSpot& b, const Sensor& sensor, const Pose& there,
                                      const Pose& d) const {
    const Pose& w = b.spot.workobject_from_sensor;
    const Pose contour = w * sensor.eye, plane = there * sensor.eye;
    SpotObservation s = b.spot;
    s.reference_mm = sensor.true_from_read * b.spot.reference_mm;
    if (s.weights.y() > 0)  // a point, no contour
        return sensor.read_from_true * (plane.inverse() * (d * (contour * s.reference_mm)));
    // displaced_measure() cuts contour^-1 D contour, which is to be plane^-1 d contour.
    s.workobject_from_sensor = contour;
    return sensor.read_from_true * displaced_measure(s, {contour * plane.inverse() * d});
}

std::vector<SpotObservation>& CorrectionDraws::next() {
    for (std::size_t i = 0; i < priors_.size(); ++i) {
        Sensor& s = sensors_[i];
        Vector6 v;
        for (int k = 0; k < 6; ++k) v[k] = normal();
        const Vector6 eta = eye_roots_[i] * v;
        s.eye = make_pose(rotation_exp(eta.tail<3>()), eta.head<3>());
        s.true_from_read.setIdentity();
        s.true_from_read(0, 0) += priors_[i].scale_sigma.x() * normal();
        s.true_from_read(2, 2) += priors_[i].scale_sigma.y() * normal();
        s.true_from_read(0, 2) += priors_[i].shear_sigma * normal();
        s.read_from_true = s.true_from_read.inverse();
        if (priors_[i].latency_sigma > 0) s.latency = priors_[i].latency_sigma * normal();
        if (priors_[i].speed_sigma > 0) s.speed = priors_[i].speed_sigma * normal();
        for (int k = 0; k < 3; ++k)
            if (priors_[i].drift_sigma_mm[k] > 0) s.drift[k] = priors_[i].drift_sigma_mm[k] * normal();
    }
    const Sensor perfect;
    drawn_ = bare_;
    for (std::size_t n = 0; n < spots_.size(); ++n) {
        const BudgetSpot& b = spots_[n];
        const SpotRoots& roots = roots_[n];
        const Sensor& sensor = roots.sensor < 0 ? perfect : sensors_[static_cast<std::size_t>(roots.sensor)];
        const Pose& w = b.spot.workobject_from_sensor;
        SpotObservation& o = drawn_[n];
        const Matrix6 mean_arrival =
            roots.arrival / std::sqrt(static_cast<double>(b.spot.reference_arrivals));
        const auto further = [&](double share) {
            Pose pose = w;
            pose.translation() += share * b.spot.latency_travel_mm * w.linear().col(1);
            return pose;
        };
        o.reference_mm = read(b, sensor, arrived(further(sensor.latency), mean_arrival), Pose::Identity()) +
                         scattered(roots.reference, b.reference_degrees);
        Pose there = further(sensor.latency + sensor.speed);
        if (b.half_window_mm > 0) {
            std::uniform_real_distribution<double> window(-b.half_window_mm, b.half_window_mm);
            there.translation() += window(rng_) * w.linear().col(1);
        }
        Eigen::Vector3d noise = scattered(roots.feature, b.feature_degrees);
        for (int i = 0; i < 3; ++i) noise[i] += b.stated_sigma_mm * normal();
        for (int i = 0; i < 3; ++i)
            if (!(b.spot.weights[i] > 0)) noise[i] = 0;
        for (int i = 0; i < 3; ++i)
            if (i != 1 || b.spot.weights.y() > 0) noise[i] -= sensor.drift[i];
        o.measured_mm = read(b, sensor, arrived(there, roots.arrival), displacement_) + noise;
    }
    return drawn_;
}

Pose CorrectionDraws::laid(const Pose& found) {
    Pose out = found;
    if (!workobject_root_.isZero(0)) {
        Vector6 v;
        for (int k = 0; k < 6; ++k) v[k] = normal();
        const Vector6 eta = workobject_root_ * v;
        const Pose off = make_pose(rotation_exp(eta.tail<3>()), eta.head<3>());
        out = off * out * off.inverse();
    }
    if (robot_drift_mm_ > 0)
        for (int k = 0; k < 3; ++k) out.translation()[k] += robot_drift_mm_ * normal();
    return out;
}

namespace {

MonteCarloFigure figure_of(std::vector<double>& values) {
    MonteCarloFigure f;
    const double n = static_cast<double>(values.size());
    for (const double v : values) f.mean += v / n;
    for (const double v : values) f.u += (v - f.mean) * (v - f.mean) / (n - 1);
    f.u = std::sqrt(f.u);
    // JCGM 101, 7.7: the interval from the sorted values, as many left out on either side.
    constexpr double kOutside = 0.025;
    const auto out = static_cast<std::ptrdiff_t>(kOutside * n);
    const auto low = values.begin() + out, high = values.end() - 1 - out;
    std::nth_element(values.begin(), low, values.end());
    f.low = *low;
    std::nth_element(low, high, values.end());
    f.high = *high;
    return f;
}

// Twice the standard deviation of the blocks' average.
bool stands(const std::vector<MonteCarloFigure>& blocks, double MonteCarloFigure::*what, double to) {
    const double n = static_cast<double>(blocks.size());
    double mean = 0, square = 0;
    for (const MonteCarloFigure& f : blocks) mean += f.*what / n;
    for (const MonteCarloFigure& f : blocks) square += (f.*what - mean) * (f.*what - mean);
    return 2 * std::sqrt(square / (n * (n - 1))) <= to;
}

}  // namespace

MonteCarlo monte_carlo(std::size_t outputs, const MonteCarloOptions& options,
                       const std::function<bool(std::span<double>)>& trial) {
    MonteCarlo out;
    std::vector<std::vector<double>> all(outputs), block(outputs);
    std::vector<std::vector<MonteCarloFigure>> blocks(outputs);
    std::vector<double> values(outputs);
    const std::size_t size = std::min(options.block, options.most);
    constexpr std::size_t kFewest = 40;  // values that leave one on either side
    constexpr std::size_t kFewestBlocks = 5;
    while (size > 0 && out.trials + size <= options.most && !out.settled &&
           !options.cancel.stop_requested()) {
        for (auto& b : block) b.clear();
        for (std::size_t i = 0; i < size && !options.cancel.stop_requested(); ++i) {
            ++out.trials;
            if (!trial(values)) {
                ++out.failed;
                continue;
            }
            for (std::size_t k = 0; k < outputs; ++k) block[k].push_back(values[k]);
        }
        bool settled = true;
        for (std::size_t k = 0; k < outputs; ++k) {
            all[k].insert(all[k].end(), block[k].begin(), block[k].end());
            if (block[k].size() >= kFewest) blocks[k].push_back(figure_of(block[k]));
            if (blocks[k].size() < kFewestBlocks) {
                settled = false;
                continue;
            }
            double u = 0;
            for (const MonteCarloFigure& f : blocks[k]) u += f.u / static_cast<double>(blocks[k].size());
            for (const auto what : {&MonteCarloFigure::mean, &MonteCarloFigure::u, &MonteCarloFigure::low,
                                    &MonteCarloFigure::high})
                settled = settled && stands(blocks[k], what, options.settled * u);
        }
        out.settled = settled;
        if (options.progress) options.progress(out.trials);
    }
    for (auto& values_of_one : all)
        out.figures.push_back(values_of_one.size() >= kFewest ? figure_of(values_of_one)
                                                              : MonteCarloFigure{});
    return out;
}

}  // namespace seamwright
