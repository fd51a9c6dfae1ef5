#pragma once
// Calibration data whose poses are written by another robot (tests/core/calibration/convention_data.h).

#include <gtest/gtest.h>

#include "projects/calibrate/detect_convention.h"
#include "projects/calibrate/methods.h"
#include "tests/core/calibration/convention_data.h"
#include "tests/core/calibration/hand_eye_simulation.h"
#include "tests/core/calibration/sphere_simulation.h"

namespace seamwright::elsewhere {

using nlohmann::json;

inline json numbers(const Eigen::Vector3d& v) {
    return json::array({v.x(), v.y(), v.z()});
}

// As if the numbers were x, y, z, A, B, C in millimetres and degrees.
inline json misread(const Pose& pose, const Writing& writing) {
    const Written w = write(pose, writing);
    return {{"xyz", numbers(w.position)}, {"abc", numbers(w.angles)}};
}

inline json quaternion(const Pose& pose, bool w_first, bool conjugate) {
    const Eigen::Quaterniond q(pose.linear());
    const double s = conjugate ? -1 : 1;
    const Eigen::Vector3d v = s * q.vec();
    return {{"xyz", numbers(pose.translation())},
            {"quat_wxyz", w_first ? json{q.w(), v.x(), v.y(), v.z()} : json{v.x(), v.y(), v.z(), q.w()}}};
}

inline json matrix(const Pose& pose, bool transposed, bool whole) {
    Eigen::Matrix4d m = pose.matrix();
    if (transposed && whole) m.transposeInPlace();
    if (transposed && !whole) m.topLeftCorner<3, 3>().transposeInPlace();
    json rows = json::array();
    for (int r = 0; r < 4; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
    return {{"matrix", rows}};
}

template <class Write>
json sphere_data(const simulation::SphereCell& cell, const std::vector<SphereObservation>& observations,
                 const Write& written) {
    json data{{"radius_mm", cell.radius}, {"observations", json::array()}};
    for (const auto& o : observations) {
        json profile = json::array();
        for (std::size_t i = 0; i < o.profile.size(); ++i)
            profile.push_back({o.profile.x_mm[i], number_json(o.profile.z_mm[i])});
        data["observations"].push_back(
            {{"id", o.id}, {"base_from_flange", written(o.base_from_flange)}, {"profile", profile}});
    }
    return data;
}

template <class Write>
json hand_eye_data(Mount mount, const std::vector<HandEyePair>& pairs, const Write& robot,
                   const Write& camera) {
    json data{{"mount", std::string(name_of(mount))}, {"pairs", json::array()}};
    for (const auto& p : pairs)
        data["pairs"].push_back({{"id", p.id},
                                 {"base_from_flange", robot(p.base_from_flange)},
                                 {"camera_from_target", camera(p.camera_from_target)}});
    return data;
}

inline ConventionAnswer asked(const char* method, const json& data) {
    auto answer = detect_pose_convention(method, data, {});
    EXPECT_TRUE(answer.has_value()) << (answer ? "" : answer.error().sentence());
    return answer ? std::move(*answer) : ConventionAnswer{};
}

}  // namespace seamwright::elsewhere
