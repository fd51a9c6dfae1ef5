// Camera calibration beside cv::calibrateCamera, on the same views with the same unknowns.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>

#include "core/calibration/camera/camera.h"
#include "tests/core/calibration/camera/camera_scene.h"

namespace seamwright {
namespace {

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

struct Solved {
    CameraModel camera;
    double rms_px = 0;
};

Solved ours(const CameraData& data) {
    const auto start = start_camera(data);
    if (!start) return {};
    const auto s = refine_camera(data, {}, CameraFreedom{true, true, 3, true}, *start);
    return {camera_of(s.intrinsics, data.width, data.height),
            std::sqrt(s.cost / static_cast<double>(s.points))};
}

Solved opencv(const CameraData& data) {
    std::vector<std::vector<cv::Point3f>> object;
    std::vector<std::vector<cv::Point2f>> image;
    for (const auto& v : data.views) {
        object.emplace_back();
        image.emplace_back();
        for (std::size_t i = 0; i < v.pixel.size(); ++i) {
            object.back().emplace_back(static_cast<float>(v.object_mm[i].x()),
                                       static_cast<float>(v.object_mm[i].y()),
                                       static_cast<float>(v.object_mm[i].z()));
            image.back().emplace_back(static_cast<float>(v.pixel[i].x()), static_cast<float>(v.pixel[i].y()));
        }
    }
    cv::Mat k, d;
    std::vector<cv::Mat> r, t;
    Solved out;
    // Iterated as far as ours, not to its default of 30 steps.
    out.rms_px = cv::calibrateCamera(object, image, {data.width, data.height}, k, d, r, t, 0,
                                     {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-10});
    out.camera.fx = k.at<double>(0, 0), out.camera.fy = k.at<double>(1, 1);
    out.camera.cx = k.at<double>(0, 2), out.camera.cy = k.at<double>(1, 2);
    out.camera.k1 = d.at<double>(0), out.camera.k2 = d.at<double>(1), out.camera.p1 = d.at<double>(2),
    out.camera.p2 = d.at<double>(3), out.camera.k3 = d.at<double>(4);
    out.camera.width = data.width, out.camera.height = data.height;
    return out;
}

void compare() {
    const CameraModel truth = test::camera_640();
    constexpr int kTrials = 20;
    for (const int views : {8, 20}) {
        double ours_ms = 0, theirs_ms = 0, ours_error = 0, theirs_error = 0, worst = 0;
        for (int trial = 0; trial < kTrials; ++trial) {
            std::mt19937 random(static_cast<unsigned>(8000 + trial));
            const auto data = test::views_of(truth, views, random, 35, 0.2);
            double t = now_ms();
            const Solved a = ours(data);
            ours_ms += (now_ms() - t) / kTrials;
            t = now_ms();
            const Solved b = opencv(data);
            theirs_ms += (now_ms() - t) / kTrials;
            ours_error += std::pow(a.camera.fx - truth.fx, 2) / kTrials;
            theirs_error += std::pow(b.camera.fx - truth.fx, 2) / kTrials;
            worst = std::max(worst, a.rms_px / b.rms_px);
        }
        std::printf("camera, %d views of 54 points: ours %.2f ms, OpenCV %.2f ms\n", views, ours_ms,
                    theirs_ms);
        std::printf("ratio camera_vs_opencv_time_%d_views: %.2fx\n", views, theirs_ms / ours_ms);
        std::printf("ratio camera_vs_opencv_error_%d_views: %.4f (ours/theirs, rms of fx %.3f px)\n", views,
                    std::sqrt(ours_error / theirs_error), std::sqrt(ours_error));
        std::printf("ratio camera_vs_opencv_residual_%d_views: %.6f (ours/theirs, worst of %d trials)\n",
                    views, worst, kTrials);
    }
}

void BM_camera(benchmark::State& state) {
    std::mt19937 random(1);
    const auto data = test::views_of(test::camera_640(), 12, random, 35, 0.2);
    for (auto _ : state) benchmark::DoNotOptimize(ours(data));
}
BENCHMARK(BM_camera)->Unit(benchmark::kMillisecond);

void BM_camera_opencv(benchmark::State& state) {
    std::mt19937 random(1);
    const auto data = test::views_of(test::camera_640(), 12, random, 35, 0.2);
    for (auto _ : state) benchmark::DoNotOptimize(opencv(data));
}
BENCHMARK(BM_camera_opencv)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace seamwright

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    seamwright::compare();
}
