#pragma once
// Cameras around a body, whose pixels OpenCV makes: no code shared with what is tried.

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <random>

#include "core/calibration/bundle/bundle.h"
#include "core/calibration/bundle/stereo.h"

namespace seamwright::camera_ring {

class Ring {
  public:
    explicit Ring(unsigned seed) : random(seed) {}

    double normal(double sigma) { return sigma * std::normal_distribution<double>()(random); }
    double within(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); }
    Eigen::Vector3d direction() { return Eigen::Vector3d(normal(1), normal(1), normal(1)).normalized(); }
    Pose anywhere(double mm) {
        return make_pose(Eigen::AngleAxisd(within(0, kPi), direction()).toRotationMatrix(),
                         Eigen::Vector3d(within(-mm, mm), within(-mm, mm), within(-mm, mm)));
    }

    // Looks at `at` from `distance_mm` away.
    PlacedCamera looking_at(const std::string& id, const Eigen::Vector3d& at, double distance_mm,
                            const Eigen::Vector3d& from) {
        PlacedCamera c;
        c.id = id;
        c.camera.fx = 1500, c.camera.fy = 1497, c.camera.cx = 651, c.camera.cy = 505;
        c.camera.k1 = -0.1, c.camera.k2 = 0.05, c.camera.p1 = 0.0006, c.camera.p2 = -0.0004;
        c.camera.width = 1280, c.camera.height = 1024;
        Eigen::Matrix3d r;
        r.col(2) = -from.normalized();
        r.col(0) = r.col(2).unitOrthogonal();
        r.col(1) = r.col(2).cross(r.col(0));
        c.world_from_camera.pose = make_pose(r, at + distance_mm * from.normalized());
        return c;
    }

    static Eigen::Vector2d pixel(const PlacedCamera& c, const Pose& world_from_camera,
                                 const Eigen::Vector3d& world) {
        const Pose camera_from_world = world_from_camera.inverse();
        const Eigen::AngleAxisd turn(camera_from_world.linear());
        const Eigen::Vector3d w = turn.angle() * turn.axis(), t = camera_from_world.translation();
        const std::vector<cv::Point3d> object{{world.x(), world.y(), world.z()}};
        std::vector<cv::Point2d> image;
        const cv::Matx33d k(c.camera.fx, 0, c.camera.cx, 0, c.camera.fy, c.camera.cy, 0, 0, 1);
        const std::vector<double> lens{c.camera.k1, c.camera.k2, c.camera.p1, c.camera.p2, c.camera.k3};
        cv::projectPoints(object, cv::Vec3d(w.x(), w.y(), w.z()), cv::Vec3d(t.x(), t.y(), t.z()), k, lens,
                          image);
        return {image[0].x, image[0].y};
    }

    // Where a camera really stands whose place is stated with this covariance, tangent of geometry/pose.h.
    Pose truly(const UncertainPose& stated) {
        const Vector6 sigma = stated.covariance.diagonal().cwiseSqrt();
        Pose out = stated.pose;
        Eigen::Vector3d w;
        for (int i = 0; i < 3; ++i) {
            out.translation()(i) += normal(sigma(i));
            w(i) = normal(sigma(3 + i));
        }
        if (w.norm() > 0)
            out.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() * out.linear();
        return out;
    }

    std::mt19937 random;
};

// A body of the size of a door, off one plane.
inline std::vector<Eigen::Vector3d> body(int features) {
    std::vector<Eigen::Vector3d> list;
    for (int i = 0; i < features; ++i)
        list.emplace_back(200 * std::cos(2.4 * i) * (0.5 + 0.1 * (i % 6)), 160 * std::sin(2.4 * i),
                          20.0 * ((i * 7) % 5));
    return list;
}

}  // namespace seamwright::camera_ring
