#pragma once
// Made-up cameras and plates with known truth for the camera tests.

#include <random>

#include "core/calibration/camera/camera.h"

namespace seamwright::test {

inline CameraModel camera_640() {
    CameraModel c;
    c.fx = 540, c.fy = 543, c.cx = 325, c.cy = 236;
    c.k1 = -0.25, c.k2 = 0.08, c.p1 = 0.0012, c.p2 = -0.0008, c.k3 = 0;
    c.width = 640, c.height = 480;
    return c;
}

inline std::vector<Eigen::Vector3d> plate(int columns, int rows, double pitch) {
    std::vector<Eigen::Vector3d> out;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) out.emplace_back(c * pitch, r * pitch, 0);
    return out;
}

// Plate in front of the camera, tilted up to `tilt_deg`, all points inside the image.
inline CameraPoints view_of(const CameraModel& camera, const std::vector<Eigen::Vector3d>& object,
                            std::mt19937& random, double tilt_deg, double distance, double noise_px,
                            const std::string& id, Pose* truth = nullptr) {
    std::uniform_real_distribution<double> u(-1, 1);
    std::normal_distribution<double> n(0, 1);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& p : object) middle += p / static_cast<double>(object.size());
    for (;;) {
        const Eigen::Vector3d w(rad_from_deg(tilt_deg) * u(random), rad_from_deg(tilt_deg) * u(random),
                                u(random));
        const Eigen::Matrix3d r = rotation_exp(w);
        const double z = distance * (1 + 0.25 * u(random));
        const Eigen::Vector3d at(0.35 * z * u(random), 0.28 * z * u(random), z);
        const Pose pose = make_pose(r, at - r * middle);
        CameraPoints v;
        v.id = id;
        bool inside = true;
        for (const auto& p : object) {
            const Eigen::Vector2d q = camera.project(pose * p);
            inside &= q.allFinite() && q.x() > 2 && q.y() > 2 && q.x() < camera.width - 3 &&
                      q.y() < camera.height - 3;
            v.object_mm.push_back(p);
            v.pixel.push_back(q + noise_px * Eigen::Vector2d(n(random), n(random)));
        }
        if (!inside) continue;
        if (truth) *truth = pose;
        return v;
    }
}

inline CameraData views_of(const CameraModel& camera, int count, std::mt19937& random, double tilt_deg,
                           double noise_px) {
    CameraData d;
    d.width = camera.width, d.height = camera.height;
    for (int i = 0; i < count; ++i)
        d.views.push_back(
            view_of(camera, plate(9, 6, 25), random, tilt_deg, 420, noise_px, "v" + std::to_string(i)));
    return d;
}

}  // namespace seamwright::test
