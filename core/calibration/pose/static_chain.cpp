#include "core/calibration/pose/static_chain.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

constexpr double kGoodChain_mm = 0.1, kUsableChain_mm = 0.3;  // three sigma of the working point
constexpr double kNoCovariance = 1e-12;                       // one all smaller is none

double largest_sigma(const Pose& pose, const Matrix6& covariance, const Eigen::Vector3d& point) {
    Eigen::Matrix<double, 3, 6> j;
    j.leftCols<3>().setIdentity();
    j.rightCols<3>() = -skew(pose.linear() * point);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
        Eigen::Matrix3d(j * covariance * j.transpose()));
    return std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

// No camera stands so near its plate, no plate so near a world that is not the plate itself; a sensor's own frame may lie
// beside its camera.
constexpr double kNearestPlate_mm = 10, kNearestLaser_mm = 2;

Expected<void> check_link(const UncertainPose& link, const Text& where, double nearest_mm) {
    SEAM_OK(check_uncertain_pose(link, where));
    const double length = link.pose.translation().norm();
    if (length > 0 && length < nearest_mm)
        return input_error(
            Text("its translation is {:.3g} long: this looks like metres, not millimetres", length), where,
            "give translations in millimetres (times 1000)");
    return {};
}

}  // namespace

Expected<void> check_uncertain_pose(const UncertainPose& link, const Text& where) {
    SEAM_OK(pose_from_matrix(link.pose.matrix(), where));
    if (!link.covariance.allFinite())
        return input_error("the covariance holds a value that is not a finite number", where);
    const double scale = std::max(kNoCovariance, link.covariance.cwiseAbs().maxCoeff());
    if ((link.covariance - link.covariance.transpose()).cwiseAbs().maxCoeff() > kCovarianceSlack * scale)
        return input_error("the covariance is not symmetric", where);
    // Rows and columns of millimetres and radians differ much in size: judge the correlation matrix.
    const Vector6 inverse = link.covariance.diagonal().cwiseMax(0).cwiseSqrt().unaryExpr(
        [](double s) { return s > 0 ? 1 / s : 0.0; });
    const Matrix6 correlation = inverse.asDiagonal() * link.covariance * inverse.asDiagonal();
    if (link.covariance.diagonal().minCoeff() < 0 ||
        symmetric_eigen(correlation).values[0] < -kCovarianceSlack)
        return input_error(
            "the covariance is not positive (a variance below zero or a correlation above one)", where);
    for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k)
            if (link.covariance(i, i) == 0 && link.covariance(i, k) != 0)
                return input_error("the covariance couples a value that has no variance", where);
    return {};
}

UncertainPose operator*(const UncertainPose& a, const UncertainPose& b) {
    return {a.pose * b.pose, covariance_of_product(a.pose, a.covariance, b.pose, b.covariance)};
}

UncertainPose inverse(const UncertainPose& a) {
    return {a.pose.inverse(), covariance_of_inverse(a.pose, a.covariance)};
}

Expected<StaticChainResult> calibrate_static(const std::vector<StaticSensor>& sensors,
                                             const StaticChainOptions& options) {
    std::vector<std::string> ids;
    for (const auto& sensor : sensors) ids.push_back(sensor.id);
    if (sensors.empty()) return input_error("there is no sensor", "sensors", "give at least one");
    SEAM_OK(check_ids(ids, options.exclude, "sensors"));
    for (const auto& sensor : sensors) {
        const Text where("sensor '{}', ", sensor.id);
        SEAM_OK(check_link(sensor.world_from_plate, joined(where, "", "world_from_plate"), kNearestPlate_mm));
        SEAM_OK(check_link(sensor.plate_from_camera, joined(where, "", Text(sensor.camera_field)),
                           kNearestPlate_mm));
        SEAM_OK(
            check_link(sensor.camera_from_laser, joined(where, "", "camera_from_laser"), kNearestLaser_mm));
        if (!sensor.working_point_mm.allFinite())
            return input_error("the working point is not finite", joined(where, "", "working_point_mm"));
    }
    if (options.reference_from_world)
        SEAM_OK(check_link(*options.reference_from_world, "reference_from_world", kNearestPlate_mm));

    StaticChainResult result;
    result.judgement = {Verdict::good, "", ""};
    for (const auto& sensor : sensors) {
        if (std::find(options.exclude.begin(), options.exclude.end(), sensor.id) != options.exclude.end())
            continue;
        StaticSensorResult one;
        one.id = sensor.id;
        const UncertainPose reference = options.reference_from_world.value_or(UncertainPose{});
        const UncertainPose links[] = {reference, sensor.world_from_plate, sensor.plate_from_camera,
                                       sensor.camera_from_laser};
        one.world_from_laser = links[0] * links[1] * links[2] * links[3];
        one.working_sigma_mm = largest_sigma(one.world_from_laser.pose, one.world_from_laser.covariance,
                                             sensor.working_point_mm);
        // Share of each link: its own error alone, the others exact.
        double sum = 0;
        for (int k = 0; k < 4; ++k) {
            UncertainPose chain;
            for (int i = 0; i < 4; ++i)
                chain = chain *
                        UncertainPose{links[i].pose, i == k ? links[i].covariance : Matrix6::Zero().eval()};
            one.shares[k] = std::pow(largest_sigma(chain.pose, chain.covariance, sensor.working_point_mm), 2);
            sum += one.shares[k];
        }
        for (double& share : one.shares) share = sum > 0 ? share / sum : 0;
        const auto largest =
            std::max_element(std::begin(one.shares), std::end(one.shares)) - std::begin(one.shares);
        static constexpr const char* names[] = {
            "the reference in the world", "the plate's place in the world", "the camera's pose on the plate",
            "the laser plane in the camera"};
        const double three = 3 * one.working_sigma_mm;
        const Text figure("sensor {}: three sigma at the working point {:.3f} mm", one.id, three);
        if (sum == 0)
            one.judgement = {Verdict::usable,
                             Text("sensor {}: no covariance was given, the accuracy is unknown", one.id),
                             "give the covariance of each link"};
        else if (three > kUsableChain_mm)
            one.judgement = {Verdict::poor, figure,
                             Text("most of it is {}: calibrate that better", Text(names[largest]))};
        else if (three > kGoodChain_mm)
            one.judgement = {Verdict::usable, figure, Text("most of it is {}", Text(names[largest]))};
        else
            one.judgement = {Verdict::good, figure, ""};
        std::vector<Text> exact;
        for (int k = options.reference_from_world ? 0 : 1; sum > 0 && k < 4; ++k)
            if (links[k].covariance.isZero(0)) exact.emplace_back(names[k]);
        if (!exact.empty() && serves(one.judgement.verdict))
            one.judgement = {Verdict::usable, Text("{}; taken as exact: {}", figure, listed(exact)),
                             "give the covariance of each link"};
        if (result.sensors.empty() || one.judgement.verdict > result.judgement.verdict)
            result.judgement = one.judgement;
        result.sensors.push_back(std::move(one));
    }
    if (result.sensors.empty()) return input_error("every sensor is excluded", "sensors");
    return result;
}

}  // namespace seamwright
