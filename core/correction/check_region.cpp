#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "core/correction/nuisance.h"
#include "core/correction/region_system.h"

namespace seamwright::correction {
namespace {

constexpr double kFarthestMm = 1e7;
// Priors wider than these are none, and the first order would not hold: standard deviations.
constexpr double kLargestMm = 1000, kLargestRad = 0.5, kLargestScale = 0.1, kLargestShare = 10;

constexpr double kOrthonormal = 1e-4;  // what R R^T may be off the identity
constexpr double kSmallestWeight = 1e-6, kLargestWeight = 1e6;
constexpr double kSmallestSigmaMm = 1e-9, kLargestSigmaMm = 1e6;
constexpr double kSmallestVarianceMm2 = kSmallestSigmaMm * kSmallestSigmaMm;
constexpr double kLargestVarianceMm2 = kLargestSigmaMm * kLargestSigmaMm;
constexpr double kAsymmetry = 1e-9;  // of a covariance's scale
// What a correlation must leave: beyond it a direction would count as known exactly.
constexpr double kUncorrelated = 1e-9;

bool is_pose(const Pose& pose) {
    const Eigen::Matrix3d r = pose.linear();
    return (r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kOrthonormal &&
           r.determinant() > 0;
}

Text where(std::size_t n, const SpotObservation& spot, const char* field) {
    return Text("spots[{}] \"{}\" {}", n, spot.id, field);
}

constexpr const char* kNoCovariance =
    "the covariance is not finite, not symmetric, negative in some direction or too large";
bool covariance_of_mm(const Eigen::Matrix2d& c) {
    return semidefinite_xz(c) && c.diagonal().maxCoeff() <= kLargestMm * kLargestMm;
}
bool covariance_of_pose(const Matrix6& c) {
    return (definite(c) || semidefinite(c)) && c.diagonal().head<3>().maxCoeff() <= kLargestMm * kLargestMm &&
           c.diagonal().tail<3>().maxCoeff() <= kLargestRad * kLargestRad;
}

Expected<void> check_sensors(std::span<const SpotObservation> spots, const std::vector<SensorPrior>& sensors,
                             const Accepted* accepted) {
    const bool known = accepted && same_priors(accepted->sensors, sensors);
    for (std::size_t i = 0; i < sensors.size() && !known; ++i) {
        const SensorPrior& p = sensors[i];
        const auto at = [&](const char* field) { return Text("sensors \"{}\" {}", p.id, field); };
        if (p.id.empty())
            return input_error("a sensor has an empty id", "sensors", "give every sensor its name");
        for (std::size_t k = 0; k < i; ++k)
            if (sensors[k].id == p.id)
                return input_error(Text("the sensor id \"{}\" occurs twice", p.id), "sensors",
                                   "give every sensor its own id");
        if (!covariance_of_pose(p.hand_eye_covariance))
            return input_error(kNoCovariance, at("hand_eye_covariance"),
                               "give six rows of translation (mm) and rotation vector (rad), symmetric and "
                               "without a negative variance");
        const auto sigma = [](double v) { return v >= 0 && v <= kLargestScale; };
        if (!sigma(p.scale_sigma.x()) || !sigma(p.scale_sigma.y()))
            return input_error("the sigma of a scale is negative, not finite or above 0.1", at("scale_sigma"),
                               "give shares, e.g. [0.001, 0.001] for 0.1 %");
        if (!sigma(p.shear_sigma))
            return input_error("the sigma of the shear is negative, not finite or above 0.1",
                               at("shear_sigma"), "give a share, e.g. 0.001 for 0.1 %");
        if (!(p.latency_sigma >= 0 && p.latency_sigma <= kLargestShare) ||
            !(p.speed_sigma >= 0 && p.speed_sigma <= kLargestShare))
            return input_error("the sigma of the latency or of the speed is negative, not finite or above 10",
                               at("speed_sigma"), "give a share, e.g. 0.1 for a tenth");
        if (!(p.drift_sigma_mm.minCoeff() >= 0 && p.drift_sigma_mm.maxCoeff() <= kLargestMm))
            return input_error("the sigma of the drift is negative, not finite or above 1000 mm",
                               at("drift_sigma_mm"), "give mm along the sensor's axes");
    }
    for (std::size_t n = 0; n < spots.size(); ++n) {
        const SpotObservation& s = spots[n];
        if (s.sensor.empty() && sensors.empty()) continue;
        if (s.sensor.empty())
            return input_error("the spot names no sensor although sensors are stated", where(n, s, "sensor"),
                               "name the sensor that measures it");
        if (std::none_of(sensors.begin(), sensors.end(),
                         [&](const SensorPrior& p) { return p.id == s.sensor; }))
            return input_error(Text("the sensor \"{}\" is not among the stated ones", s.sensor),
                               where(n, s, "sensor"), "add it to \"sensors\" or mend the id");
    }
    return {};
}

// As it was accepted before at the same place.
bool known(Accepted* accepted, std::size_t n, const Matrix6& covariance) {
    if (!accepted) return false;
    Accepted::Robot& robot = accepted->robots[n];
    robot.same = robot.revision > 0 && same_bits(robot.covariance, covariance);
    return robot.same;
}

tl::unexpected<Error> twice(const std::string& id) {
    return input_error(Text("the spot id \"{}\" occurs twice", id), "spots", "give every spot its own id");
}

// Numbers written with three decimals and read again, and poses turned into angles and back.
constexpr double kRewrittenMm = 2e-3, kRewrittenRad = 1e-4;
constexpr double kCopiedChance = 5e-5;  // that two measures come so near to each other of themselves
constexpr int kMostDecimals = 6;

// The step that all observed coordinates of both are multiples of, if they were rounded to decimals; else 0.
double rounding_mm(const SpotObservation& a, const SpotObservation& b) {
    double step = 1;
    const auto whole = [&](const SpotObservation& s) {
        for (int i = 0; i < 3; ++i)
            if (s.weights[i] > 0 && std::abs(std::remainder(s.measured_mm[i], step)) > 1e-6 * step)
                return false;
        return true;
    };
    for (int decimals = 0; decimals <= kMostDecimals; ++decimals, step /= 10)
        if (whole(a) && whole(b)) return step;
    return 0;
}

// Along the sensor's axes, that of z given x: their product is the root of the covariance's determinant.
Eigen::Vector3d sigmas_mm(const SpotObservation& s) {
    if (!s.covariance_mm2) return Eigen::Vector3d::Constant(s.sigma_mm);
    const Eigen::Matrix2d& c = *s.covariance_mm2;
    return {std::sqrt(c(0, 0)), s.sigma_mm, std::sqrt(c.determinant() / c(0, 0))};
}

// One measure under two ids: the same numbers of the same place, or these written in another frame or with fewer decimals, so
// that in the work object the reference and what was observed of the point are equal. What was measured twice has another
// noise: two such coordinates differ by N(0, 2 sigma^2), and k of them come within r sigma by chance in (r / sqrt(pi))^k of all
// cases; rounded ones are equal within half a step. Of the same pose and numbers nothing says that it was measured twice.
bool same_measure(const SpotObservation& a, const SpotObservation& b) {
    const Pose &at_a = a.workobject_from_sensor, &at_b = b.workobject_from_sensor;
    if (!((at_a * a.reference_mm - at_b * b.reference_mm).squaredNorm() < kRewrittenMm * kRewrittenMm))
        return false;
    if (a.measured_mm == b.measured_mm && a.reference_mm == b.reference_mm && at_a.matrix() == at_b.matrix())
        return a.weights.cwiseProduct(b.weights).maxCoeff() > 0;
    const Eigen::Vector3d apart_mm = at_b * b.measured_mm - at_a * a.measured_mm;
    const Eigen::Vector3d sigma_a = sigmas_mm(a), sigma_b = sigmas_mm(b);
    const double half_step_mm = rounding_mm(a, b) / 2;
    double r = 0;
    int shared = 0;
    for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d axis = at_a.linear().col(i);
        for (int k = 0; k < 3; ++k) {
            if (!(a.weights[i] > 0) || !(b.weights[k] > 0) ||
                axis.cross(at_b.linear().col(k)).norm() > kRewrittenRad)
                continue;
            const double along_mm = std::abs(axis.dot(apart_mm));
            if (along_mm > kRewrittenMm) return false;
            r = std::max(r, std::max(along_mm, half_step_mm) / std::min(sigma_a[i], sigma_b[k]));
            ++shared;
        }
    }
    return shared > 0 && std::pow(r / std::sqrt(kPi), shared) < kCopiedChance;
}

tl::unexpected<Error> copied(const SpotObservation& a, const SpotObservation& b) {
    return input_error(Text("\"{}\" and \"{}\" are one measure: their reference and measured point are equal "
                            "in the work object",
                            a.id, b.id),
                       "spots", "keep one of them, or measure the spot once more");
}

// Of many spots, those whose references lie near each other along a direction that no contour follows.
Expected<void> check_copies(std::span<const SpotObservation> spots) {
    const Eigen::Vector3d skew = Eigen::Vector3d(0.53, 0.62, 0.58).normalized();
    std::vector<std::pair<double, std::size_t>> along;
    for (std::size_t n = 0; n < spots.size(); ++n)
        along.emplace_back(skew.dot(spots[n].workobject_from_sensor * spots[n].reference_mm), n);
    std::sort(along.begin(), along.end());
    for (std::size_t n = 1; n < along.size(); ++n)
        for (std::size_t k = n; k-- > 0 && along[n].first - along[k].first < kRewrittenMm;) {
            const auto [first, then] = std::minmax(along[k].second, along[n].second);
            if (same_measure(spots[first], spots[then])) return copied(spots[first], spots[then]);
        }
    return {};
}

Expected<void> check_spot(std::size_t n, const SpotObservation& s, bool measured, Accepted* accepted) {
    const auto bad_point = [](const Eigen::Vector3d& p) {
        return !p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthestMm;
    };
    const char* far = "is not finite or lies beyond 10 km";
    if (!s.workobject_from_sensor.matrix().allFinite() || bad_point(s.workobject_from_sensor.translation()))
        return input_error(Text("the pose {}", far), where(n, s, "workobject_from_sensor"),
                           "give finite numbers in millimetres");
    if (!is_pose(s.workobject_from_sensor))
        return input_error("the rotation is not orthonormal", where(n, s, "workobject_from_sensor"),
                           "give a rotation without scale, shear or mirroring");
    if (bad_point(s.reference_mm))
        return input_error(Text("the reference point {}", far), where(n, s, "reference"),
                           "give finite numbers in millimetres");
    if (measured && bad_point(s.measured_mm))
        return input_error(Text("the measured point {}", far), where(n, s, "measured"),
                           "leave spots that were not measured out of the list");
    if (!s.weights.allFinite() || s.weights.minCoeff() < 0 || s.weights.maxCoeff() > kLargestWeight)
        return input_error("a weight is negative, not finite or above 1e6", where(n, s, "weights"),
                           "use 0 for an axis that is not observed, else 1 or a share of it");
    for (int i = 0; i < 3; ++i) {
        if (s.weights[i] > 0 && s.weights[i] < kSmallestWeight)
            return input_error("a weight lies between 0 and 1e-6", where(n, s, "weights"),
                               "use 0 for \"not observed\"");
    }
    if (!(s.sigma_mm >= kSmallestSigmaMm) || !(s.sigma_mm <= kLargestSigmaMm))
        return input_error("sigma is not a positive number of millimetres", where(n, s, "sigma_mm"),
                           "give the standard deviation of a measured coordinate, e.g. 0.05");
    if (s.covariance_mm2) {
        const Eigen::Matrix2d& c = *s.covariance_mm2;
        const double scale = std::sqrt(c(0, 0) * c(1, 1));
        if (!c.allFinite() || !(c(0, 0) >= kSmallestVarianceMm2) || !(c(1, 1) >= kSmallestVarianceMm2) ||
            !(scale <= kLargestVarianceMm2) || std::abs(c(0, 1) - c(1, 0)) > kAsymmetry * scale ||
            !(std::abs(c(0, 1)) <= (1 - kUncorrelated) * scale))
            return input_error("the covariance is not a symmetric, positive definite 2 x 2 matrix in mm^2",
                               where(n, s, "covariance_mm2"),
                               "give that of the measured x and z, or sigma_mm alone");
        if (s.weights.x() != s.weights.z())
            return input_error("a covariance is given, but the weights of x and z differ",
                               where(n, s, "covariance_mm2"), "give both the same weight, or sigma_mm alone");
    }
    if (s.reference_covariance_mm2 && !covariance_of_mm(*s.reference_covariance_mm2))
        return input_error(kNoCovariance, where(n, s, "reference_covariance_mm2"),
                           "give [[xx, xz], [xz, zz]] in mm^2, symmetric and without a negative variance");
    if (s.robot_covariance && !known(accepted, n, *s.robot_covariance) &&
        !covariance_of_pose(*s.robot_covariance))
        return input_error(kNoCovariance, where(n, s, "robot_covariance"),
                           "give six rows of translation (mm) and rotation vector (rad), symmetric and "
                           "without a negative variance");
    if (s.reference_arrivals < 1)
        return input_error(Text("the reference is the mean of {} arrivals", s.reference_arrivals),
                           where(n, s, "reference_arrivals"), "give 1 or more");
    if (!(std::abs(s.latency_travel_mm) <= kLargestMm))
        return input_error("the travel in the latency is not finite or above 1000 mm",
                           where(n, s, "latency_travel_mm"), "give latency times speed in mm");
    if (s.curve) {
        const ContourCurve& c = *s.curve;
        if (!c.x_coefficients.allFinite() || !c.z_coefficients.allFinite() ||
            !std::isfinite(c.valid_from_mm) || !std::isfinite(c.valid_to_mm) ||
            c.valid_from_mm > c.valid_to_mm)
            return input_error("the contour curve is not finite or its range is reversed",
                               where(n, s, "curve"), "learn it again from the profiles of the pass");
    }
    return {};
}

}  // namespace

Expected<void> check_region(std::span<const SpotObservation> spots, const CorrectionOptions& o, bool measured,
                            Accepted* accepted) {
    if (spots.empty())
        return input_error("there are no spots", "spots", "give at least three in different orientations");
    if (std::none_of(o.free.begin(), o.free.end(), [](bool f) { return f; }))
        return input_error("no degree of freedom is free", "free", "name at least one of x, y, z, a, b, c");
    if (!(o.limits.translation_mm >= 0) || !(o.limits.rotation_deg >= 0))
        return input_error("a limit is negative or not a number", "limits", "give limits of at least 0");
    if (!(o.sigma_limit_mm > 0) || !(o.sigma_limit_deg > 0))
        return input_error("a sigma limit is not positive", "sigma limits",
                           "give millimetres and degrees above 0");
    if (!(o.outlier_significance > 0 && o.outlier_significance < 1))
        return input_error("the outlier significance is not between 0 and 1", "outlier_significance",
                           "use e.g. 0.001");
    if (o.max_iterations < 1)
        return input_error("at least one iteration is needed", "max_iterations", "use e.g. 50");
    if (!o.workobject_covariance.isZero(0) && !covariance_of_pose(o.workobject_covariance))
        return input_error(kNoCovariance, "workobject_covariance",
                           "give six rows of translation (mm) and rotation vector (rad), symmetric and "
                           "without a negative variance");
    if (!(o.robot_drift_sigma_mm >= 0 && o.robot_drift_sigma_mm <= kLargestMm))
        return input_error("the sigma of the robot's drift is negative, not finite or above 1000 mm",
                           "robot_drift_sigma_mm", "give mm");
    if (accepted) accepted->robots.resize(spots.size());
    for (std::size_t n = 0; n < spots.size(); ++n) SEAM_OK(check_spot(n, spots[n], measured, accepted));
    SEAM_OK(check_sensors(spots, o.sensors, accepted));
    // Few spots are compared pair by pair, which needs no memory; many are sorted.
    if (spots.size() <= 64) {
        for (std::size_t n = 0; n < spots.size(); ++n) {
            for (std::size_t k = 0; k < n; ++k) {
                if (spots[n].id == spots[k].id) return twice(spots[n].id);
                if (measured && same_measure(spots[k], spots[n])) return copied(spots[k], spots[n]);
            }
        }
    } else {
        std::vector<std::string_view> ids;
        for (const SpotObservation& s : spots) ids.push_back(s.id);
        std::sort(ids.begin(), ids.end());
        const auto same = std::adjacent_find(ids.begin(), ids.end());
        if (same != ids.end()) return twice(std::string(*same));
        if (measured) {
            SEAM_OK(check_copies(spots));
        }
    }
    if (accepted) {
        for (std::size_t n = 0; n < spots.size(); ++n) {
            Accepted::Robot& robot = accepted->robots[n];
            if (!spots[n].robot_covariance || robot.same) continue;
            robot.covariance = *spots[n].robot_covariance;
            robot.revision = ++accepted->revisions;
        }
        if (!same_priors(accepted->sensors, o.sensors)) accepted->sensors = o.sensors;
    }
    return {};
}

}  // namespace seamwright::correction
