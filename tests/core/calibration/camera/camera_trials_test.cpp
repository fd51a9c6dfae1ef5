// Simulated camera, lens and laser-plane calibrations: no bias, and stated 95 % intervals that hold.

#include <gtest/gtest.h>

#include "core/calibration/lens/lens.h"
#include "core/calibration/stripe/laser_plane.h"
#include "tests/core/calibration/camera/camera_scene.h"

namespace seamwright {
namespace {

struct Tally {
    std::vector<int> inside;
    std::vector<double> sum, variance;
    int trials = 0;
    explicit Tally(std::size_t n) : inside(n), sum(n), variance(n) {}
    void add(std::size_t k, double error, double sigma) {
        inside[k] += std::abs(error) < 1.96 * sigma ? 1 : 0;
        sum[k] += error;
        variance[k] += sigma * sigma;
    }
    void check(const std::vector<std::string>& names) const {
        for (std::size_t k = 0; k < inside.size(); ++k) {
            const double share = static_cast<double>(inside[k]) / trials;
            EXPECT_GE(share, 0.93) << names[k];
            EXPECT_LE(share, 0.97) << names[k];
            // The mean error of unbiased estimates is within four of its own standard deviations.
            EXPECT_LT(std::abs(sum[k]), 4 * std::sqrt(variance[k])) << names[k];
        }
    }
};

TEST(CameraTrials, Camera) {
    const CameraModel truth = test::camera_640();
    const Intrinsics exact = intrinsics_of(truth);
    CameraOptions options;
    options.freedom = CameraFreedom{true, true, 2, true};
    Tally tally(8);  // all but k3, which is held
    std::vector<std::string> names;
    for (unsigned trial = 0; trial < 1000; ++trial) {
        std::mt19937 random(50000 + trial);
        const auto data = test::views_of(truth, 10, random, 35, 0.2);
        const auto r = calibrate_camera(data, options);
        ASSERT_TRUE(r) << r.error().sentence();
        ASSERT_GE(r->report.parameters.size(), 8u);
        names.clear();
        for (std::size_t k = 0; k < 8; ++k) {
            const auto& p = r->report.parameters[k];
            const auto which = std::find(kIntrinsicNames.begin(), kIntrinsicNames.end(), p.name);
            ASSERT_NE(which, kIntrinsicNames.end()) << p.name;
            tally.add(k, p.value - exact(which - kIntrinsicNames.begin()), p.sigma);
            names.push_back(p.name);
        }
        ++tally.trials;
    }
    tally.check(names);
}

TEST(CameraTrials, Lens) {
    CameraModel truth;
    truth.fx = truth.fy = 400, truth.cx = 330, truth.cy = 232, truth.k1 = -0.2, truth.k2 = 0.05;
    const Intrinsics exact = intrinsics_of(truth);
    Tally tally(4);
    std::vector<std::string> names;
    for (unsigned trial = 0; trial < 1000; ++trial) {
        std::mt19937 random(60000 + trial);
        std::normal_distribution<double> n(0, 0.1);
        LensData data{640, 480, {}};
        const auto add = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
            std::vector<Eigen::Vector2d> line;
            for (int i = 0; i <= 40; ++i) {
                const Eigen::Vector2d p = a + (b - a) * (i / 40.0);
                const Eigen::Vector2d q = truth.project({(p.x() - 330) / 400, (p.y() - 232) / 400, 1});
                if (q.x() > 1 && q.y() > 1 && q.x() < 638 && q.y() < 478)
                    line.push_back(q + Eigen::Vector2d(n(random), n(random)));
            }
            if (line.size() >= 5) data.lines.push_back(line);
        };
        for (int i = 0; i < 7; ++i) add({0, 20.0 + 72 * i}, {640, 40.0 + 66 * i});
        for (int i = 0; i < 7; ++i) add({30.0 + 95 * i, 0}, {50.0 + 90 * i, 480});
        const auto r = calibrate_lens(data, {});
        ASSERT_TRUE(r) << r.error().sentence();
        ASSERT_EQ(r->report.parameters.size(), 4u);
        names.clear();
        for (std::size_t k = 0; k < 4; ++k) {
            tally.add(k, r->report.parameters[k].value - exact(static_cast<Eigen::Index>(k) + 2),
                      r->report.parameters[k].sigma);
            names.push_back(r->report.parameters[k].name);
        }
        ++tally.trials;
    }
    tally.check(names);
}

TEST(CameraTrials, LaserPlane) {
    const CameraModel camera = test::camera_640();
    const Pose truth = make_pose(rotation_exp({1.0, 0.2, 0.15}), {10, -5, 320});
    Tally tally(6);
    for (unsigned trial = 0; trial < 1000; ++trial) {
        std::mt19937 random(70000 + trial);
        std::uniform_real_distribution<double> u(-1, 1);
        std::normal_distribution<double> n(0, 0.2);
        std::vector<LaserPair> pairs;
        while (pairs.size() < 25) {
            const Eigen::Vector2d xz(70 * u(random), 60 * u(random));
            const Eigen::Vector2d q = camera.project(truth * Eigen::Vector3d(xz.x(), 0, xz.y()));
            if (!q.allFinite() || q.x() < 0 || q.y() < 0 || q.x() > 639 || q.y() > 479) continue;
            pairs.push_back({std::to_string(pairs.size()), q + Eigen::Vector2d(n(random), n(random)), xz});
        }
        const auto r = calibrate_laser_plane(camera, pairs, {});
        ASSERT_TRUE(r) << r.error().sentence();
        const Vector6 e = difference(r->camera_from_laser, truth);
        for (std::size_t k = 0; k < 6; ++k) {
            const auto i = static_cast<Eigen::Index>(k);
            tally.add(k, e(i), std::sqrt(r->covariance(i, i)));
        }
        ++tally.trials;
    }
    tally.check({"x", "y", "z", "rx", "ry", "rz"});
}

}  // namespace
}  // namespace seamwright
