#include "projects/calibrate/methods/example/example_cell.h"

#include <cmath>

#include "devices/exchange/pose_json.h"

namespace seamwright::example {

using nlohmann::json;

namespace {
constexpr double kPointNoise_mm = 0.01, kRobotNoise_mm = 0.02;
}

double Dither::operator()(double sigma) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sigma * sum;
}

double Dither::uniform() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) / 9007199254740992.0;
}

CameraModel camera() {
    CameraModel c;
    c.fx = 1402, c.fy = 1399, c.cx = 634, c.cy = 517, c.k1 = -0.11, c.k2 = 0.06;
    c.width = kWidth, c.height = kHeight;
    return c;
}
Pose camera_from_laser() {
    const double c = std::cos(kPi / 6), s = std::sin(kPi / 6);
    Eigen::Matrix3d r;
    r.col(0) = Eigen::Vector3d(1, 0, 0);
    r.col(1) = Eigen::Vector3d(0, -c, -s);
    r.col(2) = Eigen::Vector3d(0, s, -c);
    return make_pose(r, {0, 0, 250});
}
Pose flange_from_sensor() {
    return make_pose(rotation_exp({0.1, -0.2, 0.4}), {35, -12, 140});
}
Pose base_from_target() {
    return make_pose(rotation_exp({0.02, 0.03, 0.3}), {900, 150, 250});
}

Pose shaken(const Pose& pose, Dither& dither, double mm, double rad) {
    return pose * make_pose(rotation_exp({dither(rad), dither(rad), dither(rad)}),
                            {dither(mm), dither(mm), dither(mm)});
}
json pair_json(double a, double b) {
    return json::array({a, b});
}
json vector3_json(const Eigen::Vector3d& v) {
    return json::array({v.x(), v.y(), v.z()});
}
namespace {
// Target frame in the middle of the plate; its first corner is the board's origin.
Pose target_from_board() {
    return make_pose(Eigen::Matrix3d::Identity(),
                     {-(kBoardColumns - 1) * kPitch_mm / 2, -(kBoardRows - 1) * kPitch_mm / 2, 0});
}
}  // namespace
Eigen::Vector3d board_corner(int index) {
    return {kPitch_mm * (index % kBoardColumns), kPitch_mm * (index / kBoardColumns), 0};
}
Pose camera_from_board(const TargetPlace& view) {
    return camera_from_laser() * target_from_sensor(view).inverse() * target_from_board();
}
Pose base_from_flange(const TargetPlace& view, Dither& dither) {
    return shaken(base_from_target() * target_from_sensor(view) * flange_from_sensor().inverse(), dither,
                  kRobotNoise_mm, 2e-5);
}

json laser_pairs() {
    Dither dither;
    const SensorModel model{camera(), camera_from_laser(), std::nullopt};
    json pairs = json::array();
    for (int i = -3; i <= 3; ++i)
        for (int k = -3; k <= 3; ++k) {
            const Eigen::Vector2d laser(33.0 * i, 26.0 * k);
            const auto pixel = model.to_pixel(laser);
            if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > kWidth - 1 ||
                pixel->y() > kHeight - 1)
                continue;
            pairs.push_back(
                {{"id", "P" + std::to_string(pairs.size() + 1)},
                 {"pixel", pair_json(pixel->x() + dither(kPixelNoise), pixel->y() + dither(kPixelNoise))},
                 {"laser", pair_json(laser.x(), laser.y())}});
        }
    return pairs;
}

json sphere_observations() {
    Dither dither;
    json list = json::array();
    for (const TargetPlace& view : sphere_views()) {
        const Eigen::Vector3d c = target_from_sensor(view).inverse() * Eigen::Vector3d::Zero();
        const double r = std::sqrt(kRadius_mm * kRadius_mm - c.y() * c.y());
        json profile = json::array();
        for (double t = -1.05; t <= 1.05; t += 0.03)
            profile.push_back(pair_json(c.x() + (r + dither(kPointNoise_mm)) * std::sin(t),
                                        c.z() + (r + dither(kPointNoise_mm)) * std::cos(t)));
        list.push_back({{"id", "P" + std::to_string(list.size() + 1)},
                        {"base_from_flange", pose_json(base_from_flange(view, dither))},
                        {"profile", profile}});
    }
    return list;
}

}  // namespace seamwright::example
