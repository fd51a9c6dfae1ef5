#include "core/calibration/pose_set.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

namespace seamwright {

Expected<void> check_rigid(const std::vector<Pose>& poses, const std::vector<std::string>& ids,
                           const Text& where) {
    for (size_t i = 0; i < poses.size(); ++i)
        SEAM_OK(pose_from_matrix(poses[i].matrix(), fmt::format("{} '{}'", where, ids[i])));
    return {};
}

Expected<void> check_ids(const std::vector<std::string>& ids, const std::vector<std::string>& exclude,
                         const Text& where) {
    std::set<std::string> seen;
    for (size_t i = 0; i < ids.size(); ++i) {
        if (ids[i].empty())
            return input_error(Text("entry {} has an empty id", i), where, "give every entry a name");
        if (!seen.insert(ids[i]).second)
            return input_error(Text("the id '{}' occurs twice", ids[i]), where,
                               "give every entry a name of its own");
    }
    for (const auto& id : exclude)
        if (!seen.contains(id))
            return input_error(Text("there is no entry '{}' to exclude", id), where,
                               "name ids that occur in the data");
    return {};
}

Expected<void> check_millimetres(const std::vector<Pose>& poses, const Text& where) {
    constexpr double kMetresWithin = 10;  // all poses nearer than that to their base look like metres
    double largest = 0;
    for (const auto& pose : poses) largest = std::max(largest, pose.translation().norm());
    if (largest > 0 && largest < kMetresWithin)
        return input_error(
            Text("no pose is farther than {:.3g} from its base: these look like metres, not millimetres",
                 largest),
            where, "give translations in millimetres (times 1000)");
    return {};
}

std::vector<int> first_equal_pose(const std::vector<Pose>& poses) {
    std::vector<int> first(poses.size());
    for (size_t i = 0; i < poses.size(); ++i) {
        first[i] = static_cast<int>(i);
        for (size_t k = 0; k < i; ++k) {
            if (first[k] != static_cast<int>(k)) continue;
            if (distance_mm(poses[i], poses[k]) < kSamePose_mm &&
                angle_rad(poses[i], poses[k]) < kSamePose_rad) {
                first[i] = static_cast<int>(k);
                break;
            }
        }
    }
    return first;
}

OrientationSpread orientation_spread(const std::vector<Pose>& poses) {
    OrientationSpread spread;
    if (poses.size() < 2) return spread;
    // Mean rotation: fixed point of the averaged rotation vectors, from the first pose.
    constexpr double kMeanSettled_rad = 1e-9;  // a smaller step of the mean ends it
    Eigen::Matrix3d mean = poses.front().linear();
    for (int iteration = 0; iteration < 20; ++iteration) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const auto& pose : poses) sum += rotation_log(mean.transpose() * pose.linear());
        sum /= static_cast<double>(poses.size());
        mean = mean * rotation_exp(sum);
        if (sum.norm() < kMeanSettled_rad) break;
    }
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& pose : poses) {
        const Eigen::Vector3d w = rotation_log(mean.transpose() * pose.linear());
        scatter += w * w.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
    for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d axis = eigen.eigenvectors().col(2 - k);
        double low = 0, high = 0;
        for (const auto& pose : poses) {
            const double angle = axis.dot(rotation_log(mean.transpose() * pose.linear()));
            low = std::min(low, angle);
            high = std::max(high, angle);
        }
        spread.axes.col(k) = axis;
        spread.spread_rad[k] = high - low;
    }
    return spread;
}

std::string axis_name(const Eigen::Vector3d& axis) {
    const Eigen::Vector3d unit = axis.normalized();
    static constexpr const char* names[] = {"X", "Y", "Z"};
    Eigen::Index k = 0;
    const double largest = unit.cwiseAbs().maxCoeff(&k);
    if (largest > std::cos(rad_from_deg(kNearAxis_deg))) return names[k];
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", unit.x(), unit.y(), unit.z());
}

}  // namespace seamwright
