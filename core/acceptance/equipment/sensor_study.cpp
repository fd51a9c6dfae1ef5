#include "core/acceptance/equipment/sensor_study.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

namespace seamwright {
namespace {

constexpr double kFarthest_mm = 1e6;
constexpr double kInPlane = 1e-9;  // of the largest eigenvalue: the points lie in a plane
constexpr double kLeastDistance = 1e-12, kSettled = 1e-14;  // of the points' extent; of it and the radius
// Of variances: across a line, of that along it; out of a plane, of that across the line.
constexpr double kOnLine = 1e-4, kNoPlane = 0.25;

using Points = std::vector<Eigen::Vector3d>;

bool is_size(double value) {
    return std::isfinite(value) && value >= 0 && value < kFarthest_mm;
}

Expected<void> check_points(const Points& points, const Text& where) {
    if (static_cast<int>(points.size()) < kFewestProbed)
        return input_error(Text("{} points", points.size()), where,
                           Text("{} are needed at least", kFewestProbed));
    if (!std::all_of(points.begin(), points.end(), [](const auto& p) { return p.allFinite(); }))
        return input_error("a point is not finite", where);
    return {};
}

Eigen::Vector3d mean_of(const Points& points) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
    return mean;
}

// Largest minus smallest, those farthest off left out as allowed.
double range_of(std::vector<double> deviations, int& left_out) {
    std::sort(deviations.begin(), deviations.end());
    left_out = static_cast<int>(kLeftOutShare * static_cast<double>(deviations.size()));
    auto low = deviations.begin(), high = deviations.end() - 1;
    for (int i = 0; i < left_out; ++i) std::abs(*low) > std::abs(*high) ? ++low : --high;
    return *high - *low;
}

double rms_of(const std::vector<double>& deviations) {
    double sum = 0;
    for (const double d : deviations) sum += d * d;
    return std::sqrt(sum / static_cast<double>(deviations.size()));
}

SensorIndex judged(double value, double U, double limit) {
    SensorIndex index{value, U, limit, {}};
    if (limit > 0)
        index.verdict = std::abs(value) + U <= limit  ? AcceptanceVerdict::ok
                        : std::abs(value) - U > limit ? AcceptanceVerdict::not_ok
                                                      : AcceptanceVerdict::conditional;
    return index;
}

// Geometric least squares by Gauss-Newton from the algebraic sphere, about the points' mean.
Expected<ProbedSphere> probe(const SphereProbing& sphere, const SensorLimits& limits) {
    const Text where("sphere {}", sphere.id);
    SEAM_OK(check_points(sphere.points_mm, where));
    if (!is_size(sphere.diameter_u_mm) || !is_size(sphere.form_mm) ||
        (sphere.diameter_mm && !(is_size(*sphere.diameter_mm) && *sphere.diameter_mm > 0)))
        return input_error("the certificate holds a number that is none", where);
    const Eigen::Vector3d mean = mean_of(sphere.points_mm);
    const auto degenerate = [&] {
        return input_error("too little of it is seen to tell radius and centre apart", where,
                           "take several cuts, spread over more of the sphere");
    };
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double scale = 0;
    for (const Eigen::Vector3d& p : sphere.points_mm) scale = std::max(scale, (p - mean).norm());
    if (!(scale > 0)) return degenerate();
    for (const Eigen::Vector3d& p : sphere.points_mm) {
        Eigen::Vector4d row;
        row << (p - mean) / scale, 1;
        normal += row * row.transpose();
        right += row * row.head<3>().squaredNorm();
    }
    const auto count = static_cast<double>(sphere.points_mm.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> first(normal);
    if (!(first.eigenvalues()[0] > kInPlane * first.eigenvalues()[3])) return degenerate();
    const Eigen::Vector4d start = normal.ldlt().solve(right);
    Eigen::Vector3d centre = start.head<3>() / 2;
    double radius = std::sqrt(std::max(0.0, start[3] + centre.squaredNorm()));
    ProbedSphere r;
    std::vector<double> deviations(sphere.points_mm.size());
    double condition = 0;
    for (int step = 0; step < 100; ++step) {
        normal.setZero();
        right.setZero();
        for (std::size_t i = 0; i < deviations.size(); ++i) {
            const Eigen::Vector3d from = (sphere.points_mm[i] - mean) / scale - centre;
            const double distance = from.norm();
            deviations[i] = distance - radius;
            Eigen::Vector4d row;
            row << -from / std::max(distance, kLeastDistance), -1;
            normal += row * row.transpose();
            right -= row * deviations[i];
        }
        condition = std::sqrt(
            std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(normal).eigenvalues()[0] / count));
        if (!(condition > kLeastCondition)) return degenerate();
        const Eigen::Vector4d by = normal.ldlt().solve(right);
        centre += by.head<3>();
        radius += by[3];
        if (!by.allFinite() || !(radius > 0)) return degenerate();
        if (by.norm() < kSettled * (1 + radius)) break;
    }
    for (double& d : deviations) d *= scale;
    r.id = sphere.id;
    r.points = static_cast<int>(deviations.size());
    r.centre_mm = mean + scale * centre;
    r.diameter_mm = 2 * scale * radius;
    r.rms_mm = rms_of(deviations);
    r.form = judged(range_of(deviations, r.left_out), sphere.form_mm, limits.form_mm);
    if (sphere.diameter_mm)
        r.size = judged(r.diameter_mm - *sphere.diameter_mm, 2 * sphere.diameter_u_mm, limits.size_mm);
    return r;
}

Expected<ProbedPlane> probe(const PlaneProbing& plane, const SensorLimits& limits) {
    const Text where("plane {}", plane.id);
    SEAM_OK(check_points(plane.points_mm, where));
    if (!is_size(plane.flatness_mm)) return input_error("the certificate holds a number that is none", where);
    const Eigen::Vector3d mean = mean_of(plane.points_mm);
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& p : plane.points_mm) scatter += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
    // A line and its scatter are no plane.
    if (!(axes.eigenvalues()[1] > kOnLine * axes.eigenvalues()[2]) ||
        !(axes.eigenvalues()[0] < kNoPlane * axes.eigenvalues()[1]))
        return input_error("the points are on no plane, or on a line of it alone", where,
                           "take cuts that are spread over the plane");
    std::vector<double> deviations;
    for (const Eigen::Vector3d& p : plane.points_mm)
        deviations.push_back(axes.eigenvectors().col(0).dot(p - mean));
    ProbedPlane r;
    r.id = plane.id;
    r.points = static_cast<int>(deviations.size());
    r.rms_mm = rms_of(deviations);
    r.flatness = judged(range_of(deviations, r.left_out), plane.flatness_mm, limits.flatness_mm);
    return r;
}

}  // namespace

Expected<SensorStudy> sensor_study(const SensorStudyData& data) {
    if (data.spheres.empty() && data.planes.empty())
        return input_error("there is no sphere and no plane", "sensor", "give the data of one");
    for (const double limit :
         {data.limits.form_mm, data.limits.size_mm, data.limits.distance_mm, data.limits.flatness_mm})
        if (!is_size(limit))
            return input_error(Text("the permitted error of {} is none", limit), "sensor",
                               "give a positive number");
    SensorStudy study;
    std::set<std::string> ids;
    const auto once = [&](const std::string& id) -> Expected<void> {
        if (ids.insert(id).second) return {};
        return input_error(Text("two artefacts are called \"{}\"", id), "sensor", "rename one");
    };
    for (const SphereProbing& sphere : data.spheres) {
        SEAM_OK(once(sphere.id));
        SEAM_TRY(auto probed, probe(sphere, data.limits));
        study.spheres.push_back(std::move(probed));
    }
    for (const PlaneProbing& plane : data.planes) {
        SEAM_OK(once(plane.id));
        SEAM_TRY(auto probed, probe(plane, data.limits));
        study.planes.push_back(std::move(probed));
    }
    for (const CertifiedDistance& d : data.distances) {
        const auto find = [&](const std::string& id) {
            return std::find_if(study.spheres.begin(), study.spheres.end(),
                                [&](const ProbedSphere& s) { return s.id == id; });
        };
        const auto from = find(d.from), to = find(d.to);
        const Text where("distance {} - {}", d.from, d.to);
        if (from == study.spheres.end() || to == study.spheres.end() || from == to)
            return input_error("it is between two spheres of the data", where, "name two of them");
        if (!is_size(d.length_mm) || !(d.length_mm > 0) || !is_size(d.u_mm))
            return input_error("the certificate holds a number that is none", where);
        ProbedDistance probed{d.from, d.to, (from->centre_mm - to->centre_mm).norm(), {}};
        probed.error = judged(probed.measured_mm - d.length_mm, 2 * d.u_mm, data.limits.distance_mm);
        study.distances.push_back(std::move(probed));
    }
    std::vector<AcceptanceVerdict> all;
    const auto take = [&](const SensorIndex& index) {
        if (index.verdict) all.push_back(*index.verdict);
    };
    for (const ProbedSphere& s : study.spheres) {
        take(s.form);
        if (s.size) take(*s.size);
    }
    for (const ProbedPlane& p : study.planes) take(p.flatness);
    for (const ProbedDistance& d : study.distances) take(d.error);
    if (!all.empty()) study.verdict = AcceptanceVerdict::ok;
    for (const AcceptanceVerdict worse : {AcceptanceVerdict::conditional, AcceptanceVerdict::not_ok})
        if (std::find(all.begin(), all.end(), worse) != all.end()) study.verdict = worse;
    return study;
}

}  // namespace seamwright
