// Correction of a region of 12 spots against Ceres with automatic differentiation, same data, same process.

#include <benchmark/benchmark.h>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cstdio>
#include <ctime>

#include "core/correction/correction.h"
#include "tests/core/correction/doors.h"

namespace {

using namespace seamwright;
using namespace seamwright::testing_doors;

constexpr int kSpots = 12;
constexpr int kParts = 64;

std::vector<std::vector<SpotObservation>> parts() {
    // One region, part after part, as a cell measures it.
    Rng rng(12);
    const std::vector<SpotObservation> taught = door(rng, kSpots, {900, -400, 250});
    std::vector<std::vector<SpotObservation>> out;
    for (int i = 0; i < kParts; ++i) {
        out.push_back(taught);
        measure(out.back(), random_displacement(rng, 10, 1, {900, -400, 250}));
        add_noise(out.back(), rng, 0.05);
    }
    return out;
}

// e = r - W^-1 D^-1 W m on the two observed axes. D^-1 p = R(-w) (p - t): 6 parameters (t, w). Everything
// that does not depend on them is computed beforehand.
struct SpotCost {
    Eigen::Matrix3d rotation;  // sensor from work object
    Eigen::Vector3d measured, offset;
    double inverse_sigma;
    explicit SpotCost(const SpotObservation& s)
        : rotation(s.workobject_from_sensor.linear().transpose()),
          measured(s.workobject_from_sensor * s.measured_mm),
          offset(s.reference_mm + rotation * s.workobject_from_sensor.translation()),
          inverse_sigma(1 / s.sigma_mm) {}
    template <class T>
    bool operator()(const T* d, T* e) const {
        const T from[3] = {measured[0] - d[0], measured[1] - d[1], measured[2] - d[2]};
        const T back[3] = {-d[3], -d[4], -d[5]};
        T p[3];
        ceres::AngleAxisRotatePoint(back, from, p);
        e[0] = inverse_sigma *
               (offset[0] - (rotation(0, 0) * p[0] + rotation(0, 1) * p[1] + rotation(0, 2) * p[2]));
        e[1] = inverse_sigma *
               (offset[2] - (rotation(2, 0) * p[0] + rotation(2, 1) * p[1] + rotation(2, 2) * p[2]));
        return true;
    }
};

Pose solve_ceres(const std::vector<SpotObservation>& spots, Matrix6* covariance) {
    double d[6] = {};
    ceres::Problem::Options quick;
    quick.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    quick.disable_all_safety_checks = true;
    std::vector<std::unique_ptr<ceres::CostFunction>> costs;
    ceres::Problem problem(quick);
    for (const SpotObservation& s : spots) {
        costs.push_back(std::make_unique<ceres::AutoDiffCostFunction<SpotCost, 2, 6>>(new SpotCost(s)));
        problem.AddResidualBlock(costs.back().get(), nullptr, d);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-12;
    options.gradient_tolerance = 1e-14;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (covariance) {
        ceres::Covariance::Options how;
        how.algorithm_type = ceres::DENSE_SVD;
        ceres::Covariance c(how);
        const std::vector<std::pair<const double*, const double*>> block{{d, d}};
        if (c.Compute(block, &problem)) {
            Eigen::Matrix<double, 6, 6, Eigen::RowMajor> m;
            c.GetCovarianceBlock(d, d, m.data());
            *covariance = m;
        }
    }
    return make_pose(rotation_exp({d[3], d[4], d[5]}), {d[0], d[1], d[2]});
}

// The same parts with everything stated that can err beside the noise: two sensors, references, robot.
std::vector<std::vector<SpotObservation>> with_priors(std::vector<std::vector<SpotObservation>> all,
                                                      CorrectionOptions& options) {
    Vector6 size;
    size << 0.1, 0.1, 0.1, 1e-3, 1e-3, 1e-3;
    const Matrix6 covariance = (size.cwiseAbs2()).asDiagonal();
    for (const char* id : {"A", "B"}) {
        SensorPrior prior{id, covariance, {1e-3, 1e-3}, 1e-3};
        prior.hand_eye_covariance(0, 4) = prior.hand_eye_covariance(4, 0) = 5e-5;
        options.sensors.push_back(prior);
    }
    for (auto& spots : all)
        for (std::size_t n = 0; n < spots.size(); ++n) {
            spots[n].sensor = options.sensors[n % 2].id;
            spots[n].reference_covariance_mm2 = (Eigen::Matrix2d() << 4e-4, 1e-4, 1e-4, 4e-4).finished();
            spots[n].robot_covariance = 0.04 * covariance;
        }
    return all;
}

CorrectionOptions plain() {
    CorrectionOptions options;
    options.reject_outliers = false;
    return options;
}

void bm_region(benchmark::State& state, const CorrectionOptions& options) {
    const auto all = parts();
    RegionSolver solver;
    RegionCorrection result;
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(solver.solve(all[i++ % kParts], options, result));
    }
}
void bm_ceres(benchmark::State& state, bool covariance) {
    const auto all = parts();
    std::size_t i = 0;
    Matrix6 c;
    for (auto _ : state) benchmark::DoNotOptimize(solve_ceres(all[i++ % kParts], covariance ? &c : nullptr));
}
BENCHMARK_CAPTURE(bm_region, everything, CorrectionOptions{});
BENCHMARK_CAPTURE(bm_region, without_outlier_test, plain());
void bm_with_priors(benchmark::State& state) {
    CorrectionOptions options;
    const auto all = with_priors(parts(), options);
    RegionSolver solver;
    RegionCorrection result;
    std::size_t i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(solver.solve(all[i++ % kParts], options, result));
}
BENCHMARK(bm_with_priors);
BENCHMARK_CAPTURE(bm_ceres, solution_only, false);
BENCHMARK_CAPTURE(bm_ceres, with_covariance, true);

// Processor time, so that other programs on the machine do not count.
template <class F>
double microseconds(F&& f, int rounds) {
    const std::clock_t start = std::clock();
    for (int i = 0; i < rounds; ++i) f(static_cast<std::size_t>(i % kParts));
    return 1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / rounds;
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    const auto all = parts();
    double worst = 0, worst_covariance = 0;
    for (const auto& spots : all) {
        Matrix6 c = Matrix6::Zero();
        const Pose theirs = solve_ceres(spots, &c);
        const RegionCorrection r = *solve_region(spots, plain());
        const Pose& ours = r.displacement.workobject_from_movedworkobject;
        for (const SpotObservation& s : spots) {
            const Eigen::Vector3d p = s.workobject_from_sensor * s.reference_mm;
            worst = std::max(worst, (ours * p - theirs * p).norm());
        }
        worst = std::max(worst, distance_mm(ours, theirs));
        for (int i = 0; i < 3; ++i)
            worst_covariance =
                std::max(worst_covariance, std::abs(std::sqrt(c(i, i)) / r.sigma_xyz_mm[i] - 1));
    }
    RegionSolver solver;
    RegionCorrection result;
    const CorrectionOptions full, solution = plain();
    CorrectionOptions stated;
    const auto repeating = with_priors(all, stated);
    double ours = 1e300, ours_full = 1e300, ours_stated = 1e300, theirs = 1e300, theirs_full = 1e300;
    Matrix6 c;
    for (int repeat = 0; repeat < 5; ++repeat) {
        ours = std::min(
            ours, microseconds([&](std::size_t i) { (void)solver.solve(all[i], solution, result); }, 4000));
        ours_full = std::min(
            ours_full, microseconds([&](std::size_t i) { (void)solver.solve(all[i], full, result); }, 4000));
        ours_stated = std::min(
            ours_stated,
            microseconds([&](std::size_t i) { (void)solver.solve(repeating[i], stated, result); }, 4000));
        theirs = std::min(theirs, microseconds([&](std::size_t i) { solve_ceres(all[i], nullptr); }, 300));
        theirs_full =
            std::min(theirs_full, microseconds([&](std::size_t i) { solve_ceres(all[i], &c); }, 300));
    }
    std::printf(
        "correction of %d spots: %.2f us with outlier test and covariance, %.2f us without the test; ceres "
        "%.1f us, "
        "with covariance %.1f us\n",
        kSpots, ours_full, ours, theirs, theirs_full);
    std::printf("largest difference to ceres: %.2e mm; of sigma xyz: %.1e of it\n", worst, worst_covariance);
    std::printf("ratio correction_vs_ceres: %.1fx (ceres without covariance, ours with everything)\n",
                theirs / ours_full);
    std::printf("ratio correction_vs_ceres_with_covariance: %.1fx\n", theirs_full / ours_full);
    std::printf(
        "with what errs beside the noise (2 sensors' hand-eye, scale and shear, references, robot): %.2f us\n"
        "ratio correction_with_systematic_vs_without: %.2fx (lower is better, at most 1.5)\n",
        ours_stated, ours_stated / ours_full);
    return worst <= 1e-5 ? 0 : 1;
}
