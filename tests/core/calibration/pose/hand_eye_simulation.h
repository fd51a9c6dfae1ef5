#pragma once
// Robot poses and target poses with noise, for both mounts, and OpenCV as the peer.

#include <opencv2/calib3d.hpp>
#include <string>
#include <vector>

#include "core/calibration/pose/hand_eye.h"
#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright::simulation {

struct HandEyeCell {
    Mount mount = Mount::eye_in_hand;
    Pose x, y;  // as in HandEyeResult
    double tilt_deg = 30, turn_deg = 60;
    double sigma_mm = 0.2, sigma_rad = 0.0015;  // of the target's pose in the camera, an axis
};

inline HandEyeCell any_hand_eye_cell(Random& random) {
    HandEyeCell cell;
    cell.mount = uniform(random, 0, 1) < 0.5 ? Mount::eye_in_hand : Mount::eye_to_hand;
    const auto near = [&] {
        return make_pose(any_rotation(random),
                         {uniform(random, -150, 150), uniform(random, -150, 150), uniform(random, 20, 250)});
    };
    const Pose far = make_pose(any_rotation(random), {uniform(random, 700, 1500), uniform(random, -500, 500),
                                                      uniform(random, 100, 800)});
    cell.x = cell.mount == Mount::eye_in_hand ? near() : far;
    cell.y = cell.mount == Mount::eye_in_hand ? far : near();
    return cell;
}

inline std::vector<HandEyePair> hand_eye_pairs(const HandEyeCell& cell, int count, Random& random) {
    std::vector<HandEyePair> pairs;
    for (int i = 0; i < count; ++i) {
        // The camera looks at the target from 300 to 500 mm.
        const double tilt = rad_from_deg(cell.tilt_deg);
        const Eigen::Matrix3d turn =
            rotation_exp({uniform(random, -tilt, tilt), uniform(random, -tilt, tilt), 0}) *
            rotation_exp({0, 0, rad_from_deg(uniform(random, -cell.turn_deg, cell.turn_deg))});
        const Pose camera_from_target =
            make_pose(turn * Eigen::Vector3d(1, -1, -1).asDiagonal(),
                      {uniform(random, -60, 60), uniform(random, -60, 60), uniform(random, 300, 500)});
        // A X C = Y
        const Pose a = cell.y * camera_from_target.inverse() * cell.x.inverse();
        HandEyePair pair;
        pair.id = "P" + std::to_string(i + 1);
        pair.base_from_flange = cell.mount == Mount::eye_in_hand ? a : a.inverse();
        Vector6 error;
        for (int k = 0; k < 3; ++k) error[k] = normal(random, cell.sigma_mm);
        for (int k = 3; k < 6; ++k) error[k] = normal(random, cell.sigma_rad);
        pair.camera_from_target = retract(camera_from_target, error);
        pairs.push_back(pair);
    }
    return pairs;
}

inline cv::Mat cv_rotation(const Eigen::Matrix3d& r) {
    cv::Mat m(3, 3, CV_64F);
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) m.at<double>(i, k) = r(i, k);
    return m;
}
inline cv::Mat cv_translation(const Eigen::Vector3d& t) {
    cv::Mat m(3, 1, CV_64F);
    for (int i = 0; i < 3; ++i) m.at<double>(i) = t[i];
    return m;
}

// eye_in_hand only. A method that fails or throws answers identity.
inline Pose opencv_hand_eye(const std::vector<HandEyePair>& pairs, cv::HandEyeCalibrationMethod method) {
    std::vector<cv::Mat> rg, tg, rt, tt;
    for (const auto& pair : pairs) {
        rg.push_back(cv_rotation(pair.base_from_flange.linear()));
        tg.push_back(cv_translation(pair.base_from_flange.translation()));
        rt.push_back(cv_rotation(pair.camera_from_target.linear()));
        tt.push_back(cv_translation(pair.camera_from_target.translation()));
    }
    cv::Mat r, t;
    try {
        cv::calibrateHandEye(rg, tg, rt, tt, r, t, method);
    } catch (const cv::Exception&) {
        return Pose::Identity();
    }
    Pose x = Pose::Identity();
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) x.linear()(i, k) = r.at<double>(i, k);
        x.translation()[i] = t.at<double>(i);
    }
    return x;
}

}  // namespace seamwright::simulation
