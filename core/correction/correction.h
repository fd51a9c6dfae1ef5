#pragma once
// Path correction from sparse measures (methods.md 3; thesis 3.3): where has the part gone, from a few cuts
// that each see two of three directions.
//
// Model. Spot n was taught with sensor pose W_n = workobject_from_sensor and reference point r_n; now it
// measures m_n (both in the sensor frame, mm). The part has moved by D = workobject_from_movedworkobject.
// Residual
//     e_n(D) = diag(w_n) (r_n - W_n^-1 D^-1 W_n m_n),      minimise  sum |e_n|^2 / sigma_n^2
// (3.49, corrected: D^-1 where the thesis writes T_corr). Weights are along the sensor's axes, 0 = not
// observed. What is returned is D, the frame shift that moves the path WITH the part: corrected frame = frame
// * D when D is expressed in that frame. Its inverse is never returned.
//
// Noise model. Every observed coordinate carries independent noise of standard deviation sigma_n, isotropic
// and independent of its weight: a weight says how much a coordinate shall count, sigma how noisy it is. With
// Omega = diag(w^2 / sigma^2) the estimator is (J^T Omega J)^-1 J^T Omega e and its covariance the sandwich
//     C = (J^T Omega J)^-1 (J^T Omega diag(sigma^2) Omega J) (J^T Omega J)^-1
// over the observed coordinates, which is (J^T Omega J)^-1 whenever every weight is 0 or 1. First order in
// sigma; when the noise has no component along the travel direction (a profile point has y = 0 exactly) the
// stated sigma is on the safe side by the cosine of D's angle. A spot may state the covariance S of its
// (x, z) instead: its residual then enters as S^-1/2 (e_x, e_z). A template's landmark at the end of its
// contour is such a case: an error of the turn moves it in a direction of its own, and taking both
// coordinates for independent gives away a sixth of the information.
//
// What is the same again. That covariance knows the noise of a run alone. A correction errs too by what all
// spots of a sensor share, and by what all parts to come share. Each such term is a nuisance with a prior, to
// first order, in the sensor frame of spot n, with A = W_n^-1 D^-1 W_n and y = A m_n:
//     hand-eye, flange_from_sensor Exp(rho, theta), one per sensor:
//                           de_n = (I - R_A) rho + theta x y - R_A (theta x m_n)
//     scale and shear, K = [kappa_x 0 s; 0 0 0; 0 0 kappa_z], one per sensor:
//                           de_n = K r_n - R_A K m_n
//     reference, one per spot and all parts:       de_n = dr
//     robot, W_n Exp(rho, theta), one per arrival: de_n = -(rho + theta x r_n) when taught,
//                                                         R_A (rho + theta x m_n) in the run
//     latency, the cut lies l_n = latency times speed further along the travel e_y, one share per sensor:
//                           de_n = l_n (I - R_A) e_y
//     speed of the run against that of the teaching, one share per sensor:
//                           de_n = -l_n R_A e_y
//     drift of the sensor since it was last checked, along its axes, one per sensor:
//                           de_n = -R_A delta
// Hand-eye, scale, shear and latency vanish where the part has not moved and grow with the displacement; the change of
// speed vanishes there as long as the contour runs along the travel. What a sensor's spots share is unknown beside
// D in the normal equations, with its prior, and eliminated (Schur complement), so that what the spots
// tell about it is used; reference and robot are independent from spot to spot and join the covariance of the spot.
// The robot's errors take R_A = I. Two terms no spot can show, and they are added to D's own covariance: a robot
// that has drifted as a whole, D <- T(delta) D, and a path that is laid in another work object than is measured in,
// D <- Exp(eta) D Exp(-eta), 0 where the part has not moved. The covariance comes in two parts that add up:
// `random`, anew with every
// part (noise, travel, the arrivals of the run), and `systematic`, the same for all parts (all others). With priors
// of 0 everything is as without them, bit for bit.
//
// Observability. A displacement is judged by what it does to the spots, not to the origin of the work object, which may
// lie metres away: as translation of the spots' centroid (mm) and rotation (rad, times the rms distance of the spots
// from their centroid). A free direction is unobservable when its predicted standard deviation in this sense exceeds
// sigma_limit_mm, or its rotation alone sigma_limit_deg, or the information is singular, as taught or as displaced; or
// when most of the information is the displacement's own (a round rim's turn shows in the second order alone, like its
// growth) and the mirror image explains the measures as well. Else the taught sigma counts there. No regularisation.

#include <Eigen/Core>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"
#include "core/text.h"

namespace seamwright {

// D as a type of its own, because its inverse sends the robot the wrong way.
struct Displacement {
    Pose workobject_from_movedworkobject = Pose::Identity();
    // The frame that carries the taught path onto the displaced part. `frame` is expressed like the work
    // object.
    Pose corrected(const Pose& frame) const { return frame * workobject_from_movedworkobject; }
};

// The local shape of the contour at a spot, learnt from the profiles between entry and exit: the reference
// point as a function of travel y (mm, along the sensor's +Y, 0 at the trigger position), x(y) = r_x + x1 y +
// x2 y^2 + x3 y^3, z alike. Replaces the straight line along Y in the residual (5.1): without it a curved
// contour is mistaken by r - sqrt(r^2 - y^2) when the part slides along it. Used only where Y is not observed
// (weight 0). Beyond [valid_from, valid_to] the tangent at the end is followed, and the correction's message
// says which spot slid so far.
// Without it the edge is taken for straight along Y. One that is not looks like a wrong spot once the part slides along it (5.6
// degrees and 12 mm: 1.2 mm); nothing but its pass tells. Where the residuals are beyond chance (1 %) the covariance holds slopes as
// large as they tell (weights of 0 and 1). That is a part of the truth: of sensors up to 3 degrees off, 15 mm and 0.1 mm of
// noise, 64 to 70 % of what is answered lies in the stated 95 %.
struct ContourCurve {
    Eigen::Vector3d x_coefficients = Eigen::Vector3d::Zero();  // 1/1, 1/mm, 1/mm^2 for y, y^2, y^3
    Eigen::Vector3d z_coefficients = Eigen::Vector3d::Zero();
    double valid_from_mm = 0, valid_to_mm = 0;  // travel range the profiles covered
};

// The reference point as found in one profile of the pass, sensor frame.
struct TravelPoint {
    double travel_mm = 0, x_mm = 0, z_mm = 0;
};

// Fits x(y) and z(y) with the lowest order (up to 3, each axis its own) that the data ask for: a higher order
// is taken when it lowers the residual significantly (F test, 1e-3). Robust: points that lie off by more than
// 4 robust standard deviations are left out. Non-finite points are ignored. Refuses fewer than 5 points or a
// travel below 1 mm.
Expected<ContourCurve> fit_contour_curve(std::span<const TravelPoint> points);

struct SpotObservation {
    std::string id;
    Pose workobject_from_sensor = Pose::Identity();          // at teaching
    Eigen::Vector3d reference_mm = Eigen::Vector3d::Zero();  // r_n, sensor frame
    Eigen::Vector3d measured_mm = Eigen::Vector3d::Zero();   // m_n, sensor frame
    Eigen::Vector3d weights = {1, 0, 1};                     // sensor axes; Y is the travel direction
    double sigma_mm = 0.05;                                  // standard deviation of an observed coordinate
    std::optional<ContourCurve> curve;
    // Of (x, z) as measured, against the reference; takes sigma_mm's place for these two. Their weights must
    // be equal then.
    std::optional<Eigen::Matrix2d> covariance_mm2;
    // What else errs; 0 or absent: nothing. Where the weights of the observed axes differ, the correlations
    // of these terms between the axes are left out.
    std::string sensor;  // id in CorrectionOptions::sensors; needed when that lists any
    std::optional<Eigen::Matrix2d> reference_covariance_mm2;  // of the reference's (x, z)
    // Of workobject_from_sensor as one arrival reaches it; tangent of pose.h.
    std::optional<Matrix6> robot_covariance;
    int reference_arrivals = 1;  // independent ones that reference_mm is the mean of
    // What the sensor travels from the instant whose pose the controller tells to the exposure, along its Y: latency times
    // speed. It is in reference and measure alike, and taken off neither.
    double latency_travel_mm = 0;
};

// What one sensor errs by, the same at all of its spots; one standard deviation.
struct SensorPrior {
    std::string id;
    // (rho, theta) of flange_from_sensor Exp(rho, theta): translation (mm), then rotation vector (rad), along
    // the sensor's axes.
    Matrix6 hand_eye_covariance = Matrix6::Zero();
    Eigen::Vector2d scale_sigma = Eigen::Vector2d::Zero();  // of x and z, share: 0.001 is 1 mm on a metre
    double shear_sigma = 0;                                 // of x against z
    double latency_sigma = 0;  // share of SpotObservation::latency_travel_mm; 1: the whole of it
    // Of the share by which the speed at the spots differs from that of the teaching (override): 0.1 is a tenth.
    double speed_sigma = 0;
    // Of the sensor's drift since it was last checked, along each of its axes.
    Eigen::Vector3d drift_sigma_mm = Eigen::Vector3d::Zero();
};
// The same from the covariance of flange_from_sensor in the tangent of pose.h (axes of the flange).
Matrix6 hand_eye_along_sensor(const Pose& flange_from_sensor, const Matrix6& covariance);

struct CorrectionLimits {
    double translation_mm = std::numeric_limits<double>::infinity();  // length of D's translation
    double rotation_deg = std::numeric_limits<double>::infinity();    // angle of D's rotation
};

// Free degrees of freedom in the order x, y, z, a, b, c: the translation of D and its KUKA angles (a about Z,
// b about Y, c about X of the work object, R = Rz(a) Ry(b) Rx(c)). A fixed one is exactly 0 in D as printed
// (xyz, abc).
using FreeDof = std::array<bool, 6>;
inline constexpr FreeDof kAllFree{true, true, true, true, true, true};

struct CorrectionOptions {
    FreeDof free = kAllFree;
    CorrectionLimits limits;
    // A direction is unobservable when its predicted sigma at the spots exceeds these (and always when the
    // information is singular). The defaults let through twenty times the usual sensor noise of 0.05 mm.
    double sigma_limit_mm = 1.0;
    double sigma_limit_deg = 0.5;
    // Test of single wrong spots on their studentised residuals, significance over the whole region
    // (Bonferroni over the spots).
    bool reject_outliers = true;
    double outlier_significance = 1e-3;
    int max_iterations = 50;
    std::vector<SensorPrior> sensors;
    // (rho, theta) of workobject_measured Exp(rho, theta) that the path is laid in: translation (mm), rotation vector
    // (rad), along the work object's axes. 0: measured and laid in the same.
    Matrix6 workobject_covariance = Matrix6::Zero();
    double robot_drift_sigma_mm = 0;  // of the robot as a whole since the last check, along each axis
};

enum class CorrectionStatus {
    ok,
    under_determined,  // a free direction is not observed well enough, or the spots contradict each other
                       // beyond the sigma limit and cannot tell which is wrong; displacement is identity
    over_limit,        // solved, but beyond the limits; displacement holds the solution
    not_converged      // the step did not shrink below 1e-9 mm / 1e-12 rad within max_iterations
};
std::string_view to_string(CorrectionStatus status);

struct SpotResidual {
    std::string id;
    Eigen::Vector3d residual_mm =
        Eigen::Vector3d::Zero();  // r - W^-1 D^-1 W m in the sensor frame, unweighted axes 0
    bool used = true;             // false: found to be wrong and left out
};

// Standard deviations of the printed numbers.
struct DofSigma {
    Eigen::Vector3d xyz_mm = Eigen::Vector3d::Zero(), abc_deg = Eigen::Vector3d::Zero();
};

struct RegionCorrection {
    CorrectionStatus status = CorrectionStatus::not_converged;
    Displacement displacement;
    // Tangent of pose.h, work object. Fixed translations have rows of 0. When the information is singular,
    // the degrees of freedom concerned have an infinite variance (and sigma) and no correlations, all of it
    // counted as random.
    Matrix6 covariance = Matrix6::Zero();  // random + systematic: what the gate judges
    Matrix6 covariance_random = Matrix6::Zero(), covariance_systematic = Matrix6::Zero();
    Eigen::Vector3d sigma_xyz_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d sigma_abc_deg = Eigen::Vector3d::Zero();  // of KUKA A, B, C
    DofSigma sigma_random, sigma_systematic;
    double sigma_at_spots_mm = 0;  // of the weakest free direction, as judged (see Observability)
    double rms_mm = 0;             // weighted rms of the used residuals
    int redundancy = 0;            // observed coordinates of the used spots minus free degrees of freedom
    // (sum of (residual / sigma)^2) / redundancy: about 1 when the stated sigmas are true; 1 without
    // redundancy. The covariance above is the one that follows from the stated sigmas, never rescaled by
    // this.
    double variance_factor = 1;
    bool consistent = true;           // false: the variance factor is beyond chance (chi-square, 1e-4)
    std::vector<SpotResidual> spots;  // in the order given
    std::vector<Text> unobservable;   // plain words: "translation along X", "rotation about the axis ..."
    Text message;                     // one sentence: the verdict and how to cure it
    int iterations = 0;
};

// Refuses (Error): no spots, duplicate ids, one measure under two ids, non-finite numbers, sigma <= 0, negative weights,
// no free degree, a pose that is none, coordinates beyond 10 km, a prior that is no covariance, a sensor without prior
// beside others that have one.
//
// Wrong measures. Each spot's residual is studentised with its own covariance (what the other spots leave of
// it). When one exceeds chance, the smallest set of spots is sought without which all others agree with each
// other: every single spot, pair and triple is tried, beyond that a graduated robust fit. The set is left out
// when it is the only one that explains the contradiction and the rest still determines the displacement;
// else `message` says that the wrong spot cannot be told, and the region is refused when the contradiction,
// carried into the displacement, exceeds the sigma limits. When the stated sigma is too small altogether, a
// spot must also stand out from the scatter of the others.
Expected<RegionCorrection> solve_region(std::span<const SpotObservation> spots,
                                        const CorrectionOptions& options);

// The same for the run's hot path: keeps its memory, and that of `result`, from call to call; allocates
// nothing after the first call with as many spots unless something has to be said about them. One thread at a
// time.
class RegionSolver {
  public:
    RegionSolver();
    RegionSolver(RegionSolver&&) noexcept;
    RegionSolver& operator=(RegionSolver&&) noexcept;
    ~RegionSolver();
    Expected<void> solve(std::span<const SpotObservation> spots, const CorrectionOptions& options,
                         RegionCorrection& result);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// What a region will be able to tell, before anything is measured (measured_mm is ignored): everything at D =
// identity.
struct RegionPlan {
    CorrectionStatus status = CorrectionStatus::ok;  // ok or under_determined
    // As in RegionCorrection. Of what all spots of a sensor share only its drift shows here, where the part has not moved
    // (predicted_covariance() of forecast.h takes a displacement).
    Matrix6 covariance = Matrix6::Zero();
    Matrix6 covariance_random = Matrix6::Zero(), covariance_systematic = Matrix6::Zero();
    Eigen::Vector3d sigma_xyz_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d sigma_abc_deg = Eigen::Vector3d::Zero();
    DofSigma sigma_random, sigma_systematic;
    double sigma_at_spots_mm = 0;                 // of the weakest direction; infinity when singular
    Vector6 weakest_direction = Vector6::Zero();  // (translation of the spots' centroid, rotation vector
                                                  // times the spots' spread), unit length
    Text weakest;                                 // in plain words
    std::vector<Text> unobservable;
    int redundancy = 0;
    // Spots whose single wrong measure of kFindableErrorMm could not be found and named.
    std::vector<std::string> uncontrolled;
    Text advice;  // which spot to add, where, in which orientation
};
inline constexpr double kFindableErrorMm = 3.0;
Expected<RegionPlan> plan_region(std::span<const SpotObservation> spots, const CorrectionOptions& options);

}  // namespace seamwright
