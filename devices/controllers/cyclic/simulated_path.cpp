#include "devices/controllers/cyclic/simulated_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/exchange/pose_json.h"

namespace seamwright {
namespace {
const Eigen::Matrix3d kPlane = rotation_exp({0.3, -0.2, 0.1});
constexpr double kLine = 4000;  // mm, one way

// The pose that the way ends at, and what of it is gone.
std::pair<std::size_t, double> stretch_at(const SimulatedPath& p, double way_mm) {
    const auto end = std::upper_bound(p.way_mm.begin() + 1, p.way_mm.end() - 1, way_mm);
    const auto i = static_cast<std::size_t>(end - p.way_mm.begin());
    return {i, std::clamp((way_mm - p.way_mm[i - 1]) / (p.way_mm[i] - p.way_mm[i - 1]), 0.0, 1.0)};
}

}  // namespace

Pose SimulatedPath::at(double time_s) const {
    if (!poses.empty()) {
        const auto [i, share] = stretch_at(*this, speed_mm_s * time_s);
        return interpolate(poses[i - 1], poses[i], share);
    }
    if (straight) {
        const double way = std::fmod(speed_mm_s * time_s, 2 * kLine);
        const double along = way <= kLine ? way : 2 * kLine - way;
        return make_pose(rotation_exp({kPi - 0.2, 0.1, 0.05}),
                         centre_mm + kPlane * Eigen::Vector3d(0, along, 0));
    }
    const double angle = speed_mm_s * time_s / radius_mm;
    const Eigen::Vector3d on_circle(radius_mm * std::cos(angle), radius_mm * std::sin(angle), 0);
    const Eigen::Matrix3d tool = rotation_exp({kPi - 0.2, 0.1 * std::sin(angle), 0.15 * std::cos(angle)});
    return make_pose(tool, centre_mm + kPlane * on_circle);
}

Eigen::Vector3d SimulatedPath::tangent(double time_s) const {
    if (!poses.empty()) {
        const std::size_t i = stretch_at(*this, speed_mm_s * time_s).first;
        return (poses[i].translation() - poses[i - 1].translation()).normalized();
    }
    if (straight)
        return kPlane * Eigen::Vector3d(0, std::fmod(speed_mm_s * time_s, 2 * kLine) <= kLine ? 1 : -1, 0);
    const double angle = speed_mm_s * time_s / radius_mm;
    return kPlane * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0);
}

void SimulatedPath::carry(SimulatedCell* cell, const Pose& reference_from_tcp) const {
    if (cell && !poses.empty()) cell->follow(reference_from_tcp * flange_from_tcp.inverse());
}

Expected<void> read_simulated_path(const nlohmann::json& settings, SimulatedPath& path) {
    if (const auto tcp = settings.find("flange_from_tcp"); tcp != settings.end()) {
        SEAM_TRY(path.flange_from_tcp, parse_pose(*tcp, "flange_from_tcp"));
    }
    const auto list = settings.find("path");
    if (list == settings.end()) return {};
    if (!list->is_array() || list->size() < 2)
        return input_error("must be a list of two poses or more", "path");
    for (std::size_t i = 0; i < list->size(); ++i) {
        SEAM_TRY(const auto pose, parse_pose((*list)[i], fmt::format("path[{}]", i)));
        const double step = path.poses.empty() ? 0 : distance_mm(path.poses.back(), pose);
        if (!path.poses.empty() && !(step > 1e-3))
            return input_error("the path stands still there", Text("path[{}]", i));
        path.way_mm.push_back(path.poses.empty() ? 0 : path.way_mm.back() + step);
        path.poses.push_back(pose);
    }
    return {};
}

}  // namespace seamwright
