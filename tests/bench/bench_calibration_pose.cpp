// Sphere TCP beside a plain Ceres auto-diff of the same objective, and hand-eye beside cv::calibrateHandEye.

#include <benchmark/benchmark.h>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <array>
#include <cstdio>
#include <ctime>

#include "tests/core/calibration/pose/hand_eye_simulation.h"
#include "tests/core/calibration/sphere/sphere_simulation.h"

namespace seamwright {
namespace {

using namespace simulation;
// Processor time of this (single) thread in milliseconds: a loaded machine must not move the ratios.
double now_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// |B (R p + t) - c| - r of one profile point.
struct SphereDistance {
    Pose base_from_flange;
    Eigen::Vector3d point;
    double radius;
    template <class T>
    bool operator()(const T* pose, const T* centre, T* residual) const {  // pose: t, rotation vector
        const T p[3] = {T(point.x()), T(point.y()), T(point.z())};
        T q[3];
        ceres::AngleAxisRotatePoint(pose + 3, p, q);
        Eigen::Matrix<T, 3, 1> flange(q[0] + pose[0], q[1] + pose[1], q[2] + pose[2]);
        const Eigen::Matrix<T, 3, 1> base =
            base_from_flange.linear().cast<T>() * flange + base_from_flange.translation().cast<T>();
        const Eigen::Matrix<T, 3, 1> d = base - Eigen::Matrix<T, 3, 1>(centre[0], centre[1], centre[2]);
        residual[0] = d.norm() - T(radius);
        return true;
    }
};

// The plain way: every return point is a residual, the user's guess is the start (a few millimetres and
// degrees off).
Pose plain_ceres(const SphereCell& cell, const std::vector<SphereObservation>& observations,
                 const Pose& guess) {
    double pose[6], centre[3];
    const Eigen::Vector3d w = rotation_log(guess.linear());
    for (int k = 0; k < 3; ++k) {
        pose[k] = guess.translation()[k];
        pose[3 + k] = w[k];
        centre[k] = cell.centre_base[k] + 3;
    }
    ceres::Problem problem;
    for (const auto& o : observations)
        for (size_t i = 0; i < o.profile.size(); ++i)
            if (std::isfinite(o.profile.z_mm[i]))
                problem.AddResidualBlock(
                    new ceres::AutoDiffCostFunction<SphereDistance, 1, 6, 3>(new SphereDistance{
                        o.base_from_flange, {o.profile.x_mm[i], 0, o.profile.z_mm[i]}, cell.radius}),
                    nullptr, pose, centre);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 100;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return make_pose(rotation_exp({pose[3], pose[4], pose[5]}), {pose[0], pose[1], pose[2]});
}

void compare_sphere() {
    const int trials = 20;
    double ours_ms = 0, theirs_ms = 0, ours = 0, theirs = 0;
    for (int trial = 0; trial < trials; ++trial) {
        Random random(static_cast<unsigned>(trial));
        SphereCell cell = any_cell(random);
        cell.table = cell.post = false;  // only sphere points, as the plain way cannot tell others apart
        const auto observations = sphere_observations(cell, 9, random);
        const Pose guess =
            retract(cell.flange_from_sensor, (Vector6() << 3, -4, 5, 0.05, -0.06, 0.04).finished());
        TcpSphereOptions options;
        options.radius_mm = cell.radius;
        const auto t0 = now_ms();
        const auto result = calibrate_tcp_sphere(observations, options);
        const auto t1 = now_ms();
        const Pose peer = plain_ceres(cell, observations, guess);
        const auto t2 = now_ms();
        ours_ms += (t1 - t0) / trials;
        theirs_ms += (t2 - t1) / trials;
        ours +=
            (result->flange_from_sensor.translation() - cell.flange_from_sensor.translation()).squaredNorm();
        theirs += (peer.translation() - cell.flange_from_sensor.translation()).squaredNorm();
    }
    std::printf(
        "sphere TCP, 9 poses: ours %.2f ms without a guess, plain Ceres auto-diff %.2f ms from a near "
        "guess\n",
        ours_ms, theirs_ms);
    std::printf("ratio tcp_sphere_vs_ceres_time: %.2fx\n", theirs_ms / ours_ms);
    std::printf("ratio tcp_sphere_vs_ceres_error: %.4f (ours/theirs, rms %.4f mm)\n",
                std::sqrt(ours / theirs), std::sqrt(ours / trials));
}

constexpr std::array<cv::HandEyeCalibrationMethod, 5> kMethods = {
    cv::CALIB_HAND_EYE_TSAI, cv::CALIB_HAND_EYE_PARK, cv::CALIB_HAND_EYE_HORAUD, cv::CALIB_HAND_EYE_ANDREFF,
    cv::CALIB_HAND_EYE_DANIILIDIS};
constexpr std::array<const char*, 5> kNames = {"tsai", "park", "horaud", "andreff", "daniilidis"};

void compare_hand_eye() {
    const int trials = 100;
    double ours_ms = 0, ours_mm = 0, ours_rad = 0;
    std::array<double, 5> ms{}, mm{}, rad{};
    for (int trial = 0; trial < trials; ++trial) {
        Random random(static_cast<unsigned>(3000 + trial));
        HandEyeCell cell = any_hand_eye_cell(random);
        while (cell.mount != Mount::eye_in_hand) cell = any_hand_eye_cell(random);
        const auto pairs = hand_eye_pairs(cell, 12, random);
        const auto t0 = now_ms();
        const auto result = calibrate_hand_eye(cell.mount, pairs);
        ours_ms += (now_ms() - t0) / trials;
        ours_mm += std::pow(distance_mm(result->x, cell.x), 2) / trials;
        ours_rad += std::pow(angle_rad(result->x, cell.x), 2) / trials;
        for (size_t m = 0; m < kMethods.size(); ++m) {
            const auto t1 = now_ms();
            const Pose x = opencv_hand_eye(pairs, kMethods[m]);
            ms[m] += (now_ms() - t1) / trials;
            mm[m] += std::pow(distance_mm(x, cell.x), 2) / trials;
            rad[m] += std::pow(angle_rad(x, cell.x), 2) / trials;
        }
    }
    std::printf("hand-eye, 12 pairs: ours %.3f ms, rms error %.3f mm %.4f deg\n", ours_ms, std::sqrt(ours_mm),
                deg_from_rad(std::sqrt(ours_rad)));
    for (size_t m = 0; m < kMethods.size(); ++m)
        std::printf("ratio hand_eye_vs_opencv_%s: time %.3fx, error mm %.3f, error deg %.3f (ours/theirs)\n",
                    kNames[m], ms[m] / ours_ms, std::sqrt(ours_mm / mm[m]), std::sqrt(ours_rad / rad[m]));
}

void BM_tcp_sphere(benchmark::State& state) {
    Random random(1);
    const SphereCell cell = any_cell(random);
    const auto observations = sphere_observations(cell, 9, random);
    TcpSphereOptions options;
    options.radius_mm = cell.radius;
    for (auto _ : state) benchmark::DoNotOptimize(calibrate_tcp_sphere(observations, options));
}
BENCHMARK(BM_tcp_sphere)->Unit(benchmark::kMillisecond);

void BM_hand_eye(benchmark::State& state) {
    Random random(1);
    const HandEyeCell cell = any_hand_eye_cell(random);
    const auto pairs = hand_eye_pairs(cell, 12, random);
    for (auto _ : state) benchmark::DoNotOptimize(calibrate_hand_eye(cell.mount, pairs));
}
BENCHMARK(BM_hand_eye)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace seamwright

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    seamwright::compare_sphere();
    seamwright::compare_hand_eye();
}
