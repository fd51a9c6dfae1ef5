#pragma once
// Propagation of distributions (JCGM 101): the inputs of a correction drawn from what is known about them, the
// real estimator run on each draw.
//
// A draw is made from what happens, not from the linearised terms of the budget: sensors that sit and scale
// otherwise than calibrated, references taught from another arrival than stated, a displaced contour cut where
// the laser plane truly is. As the residual of correction.h has it, the contour runs along the Y of the sensor as
// it truly sits. Hand-eye, scale, shear, latency, speed, drift, work object, arrivals, the spot's own sigma: normal; feature and reference: normal, or
// multivariate t where their covariance has finite degrees of freedom (JCGM 101, 6.4.9 and 6.4.8); travel of the
// trigger: uniform.

#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <stop_token>
#include <vector>

#include "core/correction/budget/budget.h"

namespace seamwright {

class CorrectionDraws {
  public:
    // Spots and options as uncertainty_budget() takes them.
    CorrectionDraws(std::span<const BudgetSpot> spots, const CorrectionOptions& options,
                    const Displacement& displacement, std::uint64_t seed);
    // Everything drawn anew: what the spots say of one part. Valid until the next call.
    std::vector<SpotObservation>& next();
    // What the path is moved by where the correction found `found`: the work object that it is laid in and the robot's drift,
    // drawn anew.
    Pose laid(const Pose& found);

  private:
    struct SpotRoots {
        int sensor = -1;  // of options.sensors
        Eigen::Matrix3d feature = Eigen::Matrix3d::Zero(), reference = Eigen::Matrix3d::Zero();
        Matrix6 arrival = Matrix6::Zero();
    };
    struct Sensor {
        Pose eye = Pose::Identity();  // calibrated_from_true
        Eigen::Matrix3d true_from_read = Eigen::Matrix3d::Identity(), read_from_true = true_from_read;
        double latency = 0, speed = 0;  // shares of the travel
        Eigen::Vector3d drift = Eigen::Vector3d::Zero();
    };
    double normal() { return normal_(rng_); }
    Eigen::Vector3d scattered(const Eigen::Matrix3d& root, double degrees);
    Pose arrived(const Pose& workobject_from_sensor, const Matrix6& root);
    Eigen::Vector3d read(const BudgetSpot& spot, const Sensor& sensor, const Pose& there,
                         const Pose& d) const;

    std::vector<BudgetSpot> spots_;
    std::vector<SpotObservation> bare_, drawn_;
    std::vector<SpotRoots> roots_;
    std::vector<SensorPrior> priors_;
    std::vector<Matrix6> eye_roots_;
    Matrix6 workobject_root_;
    double robot_drift_mm_;
    std::vector<Sensor> sensors_;
    Pose displacement_;
    std::mt19937_64 rng_;
    std::normal_distribution<double> normal_;
};

struct MonteCarloOptions {
    std::size_t block = 10000;   // trials, at most; JCGM 101 7.9.4 b for 95 %
    std::size_t most = 1000000;  // trials altogether
    double settled = 0.01;       // of u: what the limits stand to
    std::stop_token cancel;
    std::function<void(std::size_t trials)> progress;  // after each block
};

// Of one output.
struct MonteCarloFigure {
    double mean = 0, u = 0;
    double low = 0, high = 0;  // 2.5 % of the values lie below and above
};

struct MonteCarlo {
    std::vector<MonteCarloFigure> figures;
    std::size_t trials = 0, failed = 0;  // those without outputs are not in the figures
    bool settled = false;                // false: `most` was not enough, or cancelled
};

// JCGM 101, 7.9.4: blocks of trials until twice the standard deviation of the blocks' mean, u and both limits is
// below settled * u for every output. `trial` fills its outputs, as many each time, and answers false when the
// estimator refused.
MonteCarlo monte_carlo(std::size_t outputs, const MonteCarloOptions& options,
                       const std::function<bool(std::span<double>)>& trial);

}  // namespace seamwright
