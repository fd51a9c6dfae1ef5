// Data that no camera and no robot gave: every calibration ends in an answer or a sentence, never in an abort, a
// number that is none called good, or a line of a library on stderr.

#include <gtest/gtest.h>

#include <random>

#include "core/calibration/bundle/bundle.h"
#include "core/calibration/bundle/stereo.h"
#include "core/calibration/lens/lens.h"
#include "core/calibration/pose/hand_eye.h"
#include "core/calibration/stripe/laser_plane.h"
#include "tests/core/calibration/camera/camera_scene.h"

namespace seamwright {
namespace {

// Numbers of all sizes, often equal ones.
struct Numbers {
    std::mt19937 engine;
    int below(int n) { return static_cast<int>(engine() % static_cast<unsigned>(n)); }
    double any() {
        static constexpr double sizes[] = {0, 1e-300, 1e-9, 1, 30, 500, 1e5, 1e6};
        const double u = static_cast<double>(engine()) / 4294967296.0 * 2 - 1;
        return sizes[below(8)] * (below(3) ? u : 1);
    }
    double within(double least, double most) {
        return least + (most - least) * static_cast<double>(engine()) / 4294967296.0;
    }
    Eigen::Vector3d point() { return {any(), any(), any()}; }
    Eigen::Vector2d pixel() { return {within(0, 640), below(3) ? within(0, 480) : 240}; }
    Pose likely_pose() {
        const auto turn = [&] { return within(-2, 2); };
        const auto shift = [&] { return below(4) ? within(-800, 800) : 300; };
        return make_pose(rotation_exp({turn(), turn(), turn()}), {shift(), shift(), shift()});
    }
    Pose pose() { return make_pose(rotation_exp(Eigen::Vector3d(any(), any(), any()) * 1e-2), point()); }
};

class HostileData : public testing::Test {
  protected:
    void SetUp() override { testing::internal::CaptureStderr(); }
    void TearDown() override { EXPECT_EQ(testing::internal::GetCapturedStderr(), ""); }
    static void expect_numbers(const CalibrationReport& report) {
        if (report.judgement.verdict == Verdict::undetermined) return;
        for (const auto& p : report.parameters)
            EXPECT_TRUE(std::isfinite(p.value) && std::isfinite(p.sigma)) << p.name;
    }
    Numbers numbers{std::mt19937(4242)};
};

TEST_F(HostileData, Cameras) {
    for (int trial = 0; trial < 12; ++trial) {
        CameraData data{640, 480, {}};
        for (int v = 0; v < 2 + numbers.below(4); ++v) {
            CameraPoints view{std::to_string(v), {}, {}};
            for (int i = 0; i < 4 + numbers.below(8); ++i) {
                view.object_mm.push_back(trial % 2 ? numbers.point()
                                                   : Eigen::Vector3d(10.0 * i, 7.0 * (i % 3), 0));
                view.pixel.push_back(numbers.pixel());
            }
            data.views.push_back(std::move(view));
        }
        CameraOptions options;
        options.freedom = CameraFreedom{true, true, trial % 4, trial % 3 == 0};
        if (const auto r = calibrate_camera(data, options)) expect_numbers(r->report);
    }
}

TEST_F(HostileData, ViewsThatAreAllTheSamePlace) {
    std::mt19937 random(3);
    CameraData data = test::views_of(test::camera_640(), 4, random, 30, 0);
    for (std::size_t v = 1; v < 4; ++v) {
        data.views[v].pixel = data.views[0].pixel;
        for (auto& p : data.views[v].pixel) p.x() += 0.01 * static_cast<double>(v);
    }
    const auto r = calibrate_camera(data, {});
    if (r) expect_numbers(r->report);
}

TEST_F(HostileData, ObjectsOfSeveralCameras) {
    const std::vector<PlacedCamera> cameras{{"a", test::camera_640(), {}},
                                            {"b", test::camera_640(), {numbers.pose(), Matrix6::Zero()}}};
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<BundleSight> sights;
        std::vector<StereoSight> pairs;
        for (int i = 0; i < 3 + numbers.below(4); ++i) {
            const std::string id = std::to_string(i);
            sights.push_back({id, static_cast<std::size_t>(numbers.below(2)), numbers.point(),
                              numbers.pixel(), std::abs(numbers.any())});
            pairs.push_back({id, numbers.pixel(), numbers.pixel(), numbers.point()});
        }
        if (const auto r = locate_object(cameras, sights, {{}, {}, numbers.pose()})) {
            EXPECT_TRUE(r->world_from_object.matrix().allFinite());
            expect_numbers(r->report);
        }
        if (const auto r = intersect(cameras[0], cameras[1], pairs, {})) {
            for (const StereoPoint& p : r->points) EXPECT_TRUE(p.world_mm.allFinite());
        }
    }
}

TEST_F(HostileData, PosesAndLaserPairs) {
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<LaserPair> pairs;
        for (int i = 0; i < 4 + numbers.below(4); ++i)
            pairs.push_back({std::to_string(i), numbers.pixel(),
                             trial % 2 ? Eigen::Vector2d(numbers.any(), numbers.any())
                                       : Eigen::Vector2d(numbers.within(-50, 50), numbers.within(-5, 5))});
        if (const auto r = calibrate_laser_plane(test::camera_640(), pairs, {})) expect_numbers(r->report);
    }
}

TEST_F(HostileData, Lenses) {
    for (int trial = 0; trial < 20; ++trial) {
        LensData data{640, 480, {}};
        for (int i = 0; i < 3 + numbers.below(4); ++i) {
            data.lines.emplace_back();
            for (int k = 0; k < 5 + numbers.below(20); ++k) data.lines.back().push_back(numbers.pixel());
        }
        if (const auto r = calibrate_lens(data, {{}, trial % 2 == 1})) expect_numbers(r->report);
    }
}

TEST_F(HostileData, HandEyes) {
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<HandEyePair> pairs;
        for (int i = 0; i < 3 + numbers.below(5); ++i)
            pairs.push_back(
                {std::to_string(i), numbers.pose(), trial % 3 ? numbers.pose() : Pose::Identity()});
        if (const auto r = calibrate_hand_eye(Mount::eye_in_hand, pairs)) expect_numbers(r->report);
    }
}

}  // namespace
}  // namespace seamwright
