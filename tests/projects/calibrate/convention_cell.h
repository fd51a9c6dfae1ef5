#pragma once
// Calibration data whose poses are written by another robot (tests/core/calibration/pose/convention_data.h).

#include <gtest/gtest.h>

#include <functional>

#include "projects/calibrate/detect_convention.h"
#include "projects/calibrate/methods/methods.h"
#include "tests/core/calibration/pose/convention_data.h"
#include "tests/core/calibration/pose/hand_eye_simulation.h"
#include "tests/core/calibration/sphere/sphere_simulation.h"

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

using WriteOne = std::function<json(const Pose&)>;

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
    auto answer = detect_pose_convention(*find_method(method), data, {});
    EXPECT_TRUE(answer.has_value()) << (answer ? "" : answer.error().sentence());
    return answer ? std::move(*answer) : ConventionAnswer{};
}

inline const WriteOne kAsTheHouse = [](const Pose& p) { return misread(p, {}); };
inline WriteOne as(const Writing& writing) {
    return [writing](const Pose& p) { return misread(p, writing); };
}

inline json sphere(unsigned seed, const WriteOne& written, int poses = 9, double noise_mm = 0.03,
                   double robot_mm = 0.05) {
    simulation::Random random(seed);
    simulation::SphereCell cell = simulation::any_cell(random);
    cell.noise_mm = noise_mm;
    cell.robot_mm = robot_mm;
    cell.robot_deg = robot_mm / 10;
    return sphere_data(cell, simulation::sphere_observations(cell, poses, random), written);
}

inline json hand_eye(unsigned seed, const WriteOne& robot, const WriteOne& camera) {
    simulation::Random random(seed);
    const simulation::HandEyeCell cell = simulation::any_hand_eye_cell(random);
    return hand_eye_data(cell.mount, simulation::hand_eye_pairs(cell, 10, random), robot, camera);
}

}  // namespace seamwright::elsewhere
