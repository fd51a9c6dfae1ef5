#pragma once
// The linear algebra under solve_region and plan_region: the weighted least-squares problem of a region, its
// linearisation and what follows from it. Fixed-size; allocates only when the number of spots grows.
//
// Inner coordinates xi of a small displacement, chosen so that xi of length 1 moves the spots by about 1 mm
// whatever the distance of the work object's origin:
//     xi = (translation of the displaced centroid [mm], L * rotation vector [mm]),  L = rms distance from the
//     centroid.
// To the tangent of pose.h: w = xi_w / L, dt = xi_t + (R c) x w, with c the taught centroid and R the
// rotation of D. Parameters theta are what the solver steps in: xi itself when all six are free, else (x, y,
// z, rotation), the rotation as a rotation vector when all its three are free and as KUKA angles otherwise,
// so that "fixed" is exact.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/correction/correction.h"
#include "core/correction/nuisance.h"

namespace seamwright::correction {

// D and, when single rotations are fixed, the angles that it is made of.
struct State {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
    Eigen::Vector3d abc = Eigen::Vector3d::Zero();  // rad
    Pose pose() const { return make_pose(rotation, translation); }
};

struct Linearization {
    Matrix6 information = Matrix6::Zero();  // J^T Omega J in xi
    Matrix6 meat =
        Matrix6::Zero();  // J^T Omega diag(sigma^2) Omega J in xi; only with weights other than 0, 1
    Vector6 gradient = Vector6::Zero();  // J^T Omega e
    double cost = 0;                     // e^T Omega e
};

// Covariance at a linearisation; `bread` is (J^T Omega J)^-1 and `covariance` the sandwich, both in xi, of
// rank = number of free degrees. `regular` is false when the information is singular; then both are zero.
struct Spread {
    bool regular = false;
    Matrix6 bread = Matrix6::Zero(), covariance = Matrix6::Zero();
};

// Directions of the free space whose predicted sigma exceeds the limits, as columns in xi, and the weakest of
// all.
struct Observability {
    bool ok = false;
    bool singular = false;
    Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> weak;  // unit length each
    Vector6 weakest = Vector6::Zero();                       // unit length
    double weakest_sigma_mm = 0;                             // at the spots; infinity when singular
};

// What errs at one spot beside the noise of its measure, along the sensor's axes, mm^2: the reference, the
// arrival when it was taught, that of the run.
struct LocalTerms {
    bool any = false;
    Eigen::Matrix3d reference = Eigen::Matrix3d::Zero(), taught = Eigen::Matrix3d::Zero(),
                    run = Eigen::Matrix3d::Zero();
};
// `from_reference`: the taught point stands for the measured one. `arrival`: arrival_along_sensor() of the spot's, where
// it states one.
LocalTerms local_terms(const SpotObservation& spot, bool from_reference, const Matrix6& arrival);
LocalTerms local_terms(const SpotObservation& spot, bool from_reference);
// Of the noise alone.
Eigen::Matrix3d noise_covariance(const SpotObservation& spot);
// What is folded in of a spot's covariance: its observed axes, and the correlations where these weigh the same.
Eigen::Matrix3d kept(const Eigen::Vector3d& weights, Eigen::Matrix3d covariance);

// A stated covariance S of (x, z) is folded in: `shape` T with T T^T sigma^2 = S on x and z, 1 on y, and
// everything below is T^-1 times the sensor's own. Residuals then have the noise sigma along all axes.
struct PreparedSpot {
    Eigen::Matrix3d shape;
    Eigen::Matrix3d sensor_from_workobject;   // rotation only
    Eigen::Vector3d sensor_origin, measured;  // in the work object
    Eigen::Matrix3d axes;                     // the sensor's axes in the work object, columns
    Eigen::Vector3d offset;                   // reference + sensor_from_workobject * sensor_origin
    Eigen::Vector3d reference, weights;
    double sigma = 1;
    bool curved = false;  // else straight along Y
    ContourCurve curve;
    int observed = 0;
    // Share of the folded covariance that is systematic: 0 to 1 along each direction, observed axes alone.
    bool repeats = false;
    Eigen::Matrix3d systematic;
    // Of a sensor with priors: index in RegionSystem::priors(), and the spot as it stands in the sensor frame.
    int sensor = -1;
    SharedGeometry geometry;
};

// What was found to be covariances, by spot and sensor: they are the same part after part, and looking costs.
struct Accepted {
    struct Robot {
        Matrix6 covariance = Matrix6::Zero();
        unsigned revision = 0;  // another with every other covariance; 0: none
        bool same = false;      // as in the call before
    };
    std::vector<Robot> robots;
    unsigned revisions = 0;
    std::vector<SensorPrior> sensors;
};

class RegionSystem {
  public:
    // `from_reference`: the taught points stand for the measured ones (planning). `accepted`: of check_region() of the
    // same spots, always from the same place; may be null.
    void load(std::span<const SpotObservation> spots, const CorrectionOptions& options, bool from_reference,
              const Accepted* accepted = nullptr);

    std::size_t size() const { return spots_.size(); }
    const PreparedSpot& spot(std::size_t n) const { return spots_[n]; }
    int free_count() const { return free_count_; }
    double spread_mm() const { return spread_; }
    const Eigen::Vector3d& centroid() const { return centroid_; }
    bool weights_are_binary() const { return binary_; }
    // A sensor has priors other than 0.
    bool shares() const { return !priors_.empty(); }

    // Residual r - W^-1 D^-1 W m (all three axes, unweighted) and its derivative by xi, both divided by the
    // spot's shape.
    void residual(std::size_t n, const State& state, Eigen::Vector3d& e, Rows& rows) const;
    // Sum over spots with factor > 0, each term times its factor.
    void linearize(const State& state, std::span<const double> factor, Linearization& out) const;
    // The same with the sensors' errors as further unknowns, eliminated: information, gradient, cost and meat
    // are what is left for D. `shared` holds what the spots tell about them.
    void linearize_shared(const State& state, std::span<const double> factor, Linearization& out,
                          Shared& shared) const;
    // One spot's share of the information; for leave-one-out.
    void add_information(std::size_t n, const Rows& rows, double factor, Matrix6& information,
                         Matrix6& meat) const;
    // Travel along the contour, beyond the range of its curve; 0 when inside or without a curve.
    double beyond_curve_mm(std::size_t n, const State& state) const;

    Spread spread(const Linearization& lin, const State& state) const;
    // `inflation` multiplies every predicted sigma.
    Observability observability(const Linearization& lin, const State& state, double inflation = 1) const;
    // Cheap and sufficient: no direction can exceed the limits. When false, ask observability().
    bool surely_observable(const Spread& spread) const;
    // Largest predicted sigma at the spots.
    double weakest_sigma_mm(const Spread& spread) const;
    // xi from theta; columns of fixed parameters are 0.
    Matrix6 xi_from_parameters(const State& state) const;
    // Covariance in the tangent of pose.h and sigma of (x, y, z) mm and (A, B, C) rad from one in xi.
    void outer(const Matrix6& covariance_xi, const State& state, Matrix6& tangent, Eigen::Vector3d& sigma_xyz,
               Eigen::Vector3d& sigma_abc) const;
    // The tangent alone, and the sigmas of one; `abc_from_rotation` is d(A, B, C)/d(rotation vector).
    Matrix6 tangent_of(const Matrix6& covariance_xi, const State& state) const;
    Eigen::Matrix3d abc_from_rotation(const State& state) const;
    static void sigmas(const Matrix6& tangent, const Eigen::Matrix3d& abc_from_rotation,
                       Eigen::Vector3d& sigma_xyz, Eigen::Vector3d& sigma_abc);
    Vector6 tangent_from_xi(const Vector6& xi, const State& state) const;

    struct Fit {
        bool converged = false;
        int iterations = 0;
        State state;
        Linearization lin;
        Shared shared;
        void clear();  // keeps the memory
    };
    // Levenberg-Marquardt from `from`; then, where sensors have priors, Gauss-Newton steps with their errors
    // as unknowns.
    void fit(std::span<const double> factor, Fit& out, const State& from = {}) const;
    // Displaced further by xi, to first order where single degrees are fixed.
    State shifted(State state, const Vector6& xi) const;
    // Residual and rows at the fit as residual() gives them, freed of the sensors' errors as estimated.
    void cleared(std::size_t n, const Fit& fit, Eigen::Vector3d& e, Rows& rows) const;
    // The covariance that the sensors' uncertainty leaves in that residual, and a quick upper bound of it.
    Eigen::Matrix3d left(std::size_t n, const Fit& fit) const;
    Eigen::Matrix3d left_at_most(std::size_t n, const Fit& fit) const;
    // The two parts of spread.covariance, in xi. `shared` may be empty where nothing is shared.
    struct Parts {
        Matrix6 random, systematic;
    };
    Parts parts(const Shared& shared, const State& state, std::span<const double> factor,
                const Spread& spread) const;
    // Some term is systematic.
    bool repeats() const { return repeats_ || shares() || adds(); }
    // Some term adds to D itself.
    bool adds() const {
        return !options_.workobject_covariance.isZero(0) || options_.robot_drift_sigma_mm > 0;
    }
    // What no spot can show, in xi: the robot's drift, and the work object that the path is laid in.
    struct Added {
        Matrix6 robot_drift = Matrix6::Zero(), workobject = Matrix6::Zero();
        Matrix6 sum() const { return robot_drift + workobject; }
    };
    Added added(const State& state) const;

  private:
    // 1 / limit for each coordinate of xi.
    Vector6 per_limit() const;
    void fit_shared(std::span<const double> factor, Fit& out) const;
    // dx/dy and dz/dy of the spot's curve, scaled like its residual.
    static std::array<double, 2> slopes(const PreparedSpot& spot, double travel_mm);
    void step(State& state, const Vector6& theta, const Vector6& xi) const;

    template <int N>
    void add_shared(const State& state, std::span<const double> factor, int sensor, Linearization& out,
                    Shared& shared) const;

    // What a spot states of its robot is the same part after part, and turning it costs.
    struct Arrival {
        Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
        Matrix6 covariance = Matrix6::Zero(), along_sensor = Matrix6::Zero();
        unsigned revision = 0;
        bool none = true;
    };
    const Arrival& arrival_of(std::size_t n, const SpotObservation& spot, const Accepted* accepted);

    std::vector<PreparedSpot> spots_;
    std::vector<Arrival> arrivals_;
    std::vector<SharedRoot> priors_;
    std::vector<int> prior_of_;  // by CorrectionOptions::sensors; -1: nothing
    bool repeats_ = false;
    CorrectionOptions options_;
    Eigen::Vector3d centroid_ = Eigen::Vector3d::Zero();
    double spread_ = 1;
    int free_count_ = 6;
    bool all_free_ = true, by_angles_ = false, binary_ = true;
};

// The normal equations as they will stand when the part displaced by `displacement` is measured without noise
// (measured_mm is ignored). As taught, `shared` is empty: nothing that a sensor errs by shows.
struct Predicted {
    RegionSystem system;
    State state;
    std::vector<double> factor;
    Linearization lin;
    Shared shared;
    Spread spread;
};
Predicted predict(std::span<const SpotObservation> spots, const CorrectionOptions& options,
                  const Displacement& displacement);

// Plain words for a set of unobservable directions (columns in xi, spanning the unobservable space): pure
// translations first, then rotations with their axis. `centroid` and `spread` as in RegionSystem.
std::vector<Text> name_directions(const Eigen::Ref<const Eigen::Matrix<double, 6, Eigen::Dynamic>>& xi,
                                  const Eigen::Vector3d& centroid, double spread);

// Checks everything that solve_region and plan_region refuse. `accepted`: from call to call; may be null.
Expected<void> check_region(std::span<const SpotObservation> spots, const CorrectionOptions& options,
                            bool measured, Accepted* accepted = nullptr);

// Fills covariance, its parts and sigmas as RegionCorrection describes them (T is that or RegionPlan), also
// for a singular region. `parts` may be null: all is random.
template <class T>
void report_spread(const RegionSystem& system, const Spread& spread, const Observability& seen,
                   const State& state, const RegionSystem::Parts* parts, T& out);

}  // namespace seamwright::correction
