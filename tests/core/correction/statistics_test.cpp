// Monte Carlo: the stated sigma against the scatter of many solutions, per degree of freedom and jointly.

#include <gtest/gtest.h>

#include "core/correction/correction.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/notation.h"
#include "tests/core/correction/doors.h"

namespace seamwright {
namespace {

using namespace testing_doors;

struct Coverage {
    std::array<int, 9> inside{};  // x y z, rotation vector, A B C
    double nees = 0, variance_factor = 0;
    int joint = 0, left_out = 0, trials = 0, inconsistent = 0;
};

// Weights by `weigh` for every spot; noise of sigma_mm on each observed coordinate, whatever its weight.
template <class Weigh>
Coverage cover(unsigned seed, int trials, int spots_per_door, const CorrectionOptions& options, double mm,
               double deg, Weigh weigh) {
    Rng rng(seed);
    Coverage c;
    const Eigen::Vector3d offset(900, -400, 250);
    while (c.trials < trials) {
        std::vector<SpotObservation> spots = door(rng, spots_per_door, offset);
        for (SpotObservation& s : spots) weigh(rng, s);
        Pose truth = random_displacement(rng, mm, deg, offset);
        if (options.free != kAllFree)
            truth = make_pose(rotation_from_kuka({uniform(rng, -1, 1), 0, 0}), {uniform(rng, -5, 5), 3, 0});
        measure(spots, truth);
        for (SpotObservation& s : spots) {
            const Eigen::Vector3d e = s.sigma_mm * gaussian(rng);
            for (int i = 0; i < 3; ++i) {
                if (s.weights[i] > 0) s.measured_mm[i] += e[i];
            }
        }
        const auto solved = solve_region(spots, options);
        if (!solved || solved->status != CorrectionStatus::ok) continue;  // weak doors are refused beforehand
        const RegionCorrection& r = *solved;
        ++c.trials;
        for (const SpotResidual& s : r.spots) c.left_out += !s.used;
        c.inconsistent += !r.consistent;
        c.variance_factor += r.variance_factor / trials;
        const Pose& d = r.displacement.workobject_from_movedworkobject;
        const Vector6 e = difference(truth, d);
        for (int i = 0; i < 6; ++i) {
            c.inside[static_cast<std::size_t>(i)] += std::abs(e[i]) <= 1.96 * std::sqrt(r.covariance(i, i));
        }
        const KukaAbc a = kuka_from_rotation(truth.linear()), b = kuka_from_rotation(d.linear());
        const double off[3] = {a.a_deg - b.a_deg, a.b_deg - b.b_deg, a.c_deg - b.c_deg};
        for (int i = 0; i < 3; ++i)
            c.inside[static_cast<std::size_t>(i + 6)] += std::abs(off[i]) <= 1.96 * r.sigma_abc_deg[i];
        if (options.free == kAllFree) {
            const Vector6 scale = r.covariance.diagonal().cwiseSqrt();
            const Matrix6 correlation =
                scale.cwiseInverse().asDiagonal() * r.covariance * scale.cwiseInverse().asDiagonal();
            const Vector6 u = e.cwiseQuotient(scale);
            const double nees = u.dot(Vector6(solve_symmetric(correlation, u)));
            c.nees += nees / trials;
            c.joint += nees <= 12.592;  // 95 % of chi-square with 6 degrees
        }
    }
    return c;
}

void expect_95(const Coverage& c, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
        EXPECT_GE(c.inside[i], 0.93 * c.trials) << i;
        EXPECT_LE(c.inside[i], 0.97 * c.trials) << i;
    }
}

TEST(Sigma, CoversNinetyFivePercentForDoorsOfManySizes) {
    for (const int n : {4, 6, 8, 12, 20}) {
        const Coverage c = cover(static_cast<unsigned>(n), 1000, n, {}, 10, 1, [](Rng&, SpotObservation&) {});
        expect_95(c, 0, 9);
        EXPECT_GE(c.joint, 0.93 * c.trials);
        EXPECT_LE(c.joint, 0.97 * c.trials);
        EXPECT_NEAR(c.nees, 6.0, 4 * std::sqrt(12.0 / c.trials));  // chi-square: mean 6, variance 12
        EXPECT_NEAR(c.variance_factor, 1.0, 4 * std::sqrt(2.0 / (2 * n - 6) / c.trials));
        // False alarms over the whole region at the stated significance of 1e-3: 1 +- 1 expected.
        EXPECT_LE(c.left_out, 6);
        EXPECT_LE(c.inconsistent, 4);
    }
}

TEST(Sigma, CoversWithMixedSigmasAndThreeObservedAxes) {
    const Coverage c = cover(21, 1000, 8, {}, 10, 1, [](Rng& rng, SpotObservation& s) {
        s.sigma_mm = uniform(rng, 0.01, 0.2);
        if (rng() % 3 == 0) s.weights = {1, 1, 1};
    });
    expect_95(c, 0, 9);
    EXPECT_NEAR(c.nees, 6.0, 4 * std::sqrt(12.0 / c.trials));
}

// A weight is importance, sigma is noise: the stated covariance is true for any weights.
TEST(Sigma, CoversWithFractionalWeights) {
    const Coverage c = cover(22, 1000, 10, {}, 10, 1, [](Rng& rng, SpotObservation& s) {
        s.weights = {uniform(rng, 0.1, 3.0), 0, uniform(rng, 0.1, 3.0)};
    });
    expect_95(c, 0, 9);
    EXPECT_NEAR(c.nees, 6.0, 4 * std::sqrt(12.0 / c.trials));
}

TEST(Sigma, CoversRestrictedDegrees) {
    CorrectionOptions options;
    options.free = {true, true, false, true, false, false};
    const Coverage c = cover(23, 1000, 5, options, 0, 0, [](Rng&, SpotObservation&) {});
    for (const std::size_t i : {0u, 1u, 5u, 6u}) {
        EXPECT_GE(c.inside[i], 0.93 * c.trials) << i;
        EXPECT_LE(c.inside[i], 0.97 * c.trials) << i;
    }
}

TEST(Sigma, CoversLargeDisplacements) {
    const Coverage c = cover(24, 1000, 10, {}, 50, 20, [](Rng&, SpotObservation&) {});
    expect_95(c, 0, 9);
}

}  // namespace
}  // namespace seamwright
