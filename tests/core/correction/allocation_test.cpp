// The run's hot path allocates nothing after the first call.

#include <gtest/gtest.h>

#include "core/correction/correction.h"
#include "tests/allocations.h"
#include "tests/core/correction/doors.h"

namespace seamwright {
namespace {

using namespace testing_doors;

TEST(RegionSolver, AllocatesNothingAfterTheFirstCall) {
    Rng rng(1);
    RegionSolver solver;
    RegionCorrection result;
    for (const auto& [restricted, priors] :
         {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
        CorrectionOptions options;
        if (priors) {
            SensorPrior prior{"A", 1e-4 * Matrix6::Identity(), {1e-3, 1e-3}, 1e-3};
            options.sensors = {prior};
        }
        if (restricted) options.free = {true, true, true, true, false, false};
        std::vector<std::vector<SpotObservation>> parts;
        for (int i = 0; i < 20; ++i) {
            parts.push_back(door(rng, 12));
            measure(parts.back(), make_pose(rotation_exp({0, 0, 0.01}), {3, -2, 1}));
            add_noise(parts.back(), rng, 0.02);
            for (std::size_t n = 0; n < parts.back().size(); ++n) {
                if (priors) {
                    parts.back()[n].sensor = "A";
                    parts.back()[n].reference_covariance_mm2 = 1e-4 * Eigen::Matrix2d::Identity();
                    parts.back()[n].robot_covariance = 1e-6 * Matrix6::Identity();
                }
                if (n % 3 == 0) parts.back()[n].curve = ContourCurve{{0, 1e-6, 0}, {0, 0, 0}, -20, 20};
            }
        }
        ASSERT_TRUE(solver.solve(parts[0], options, result).has_value());
        const long before = allocations_so_far();
        for (const auto& spots : parts) {
            const auto good = solver.solve(spots, options, result);
            ASSERT_TRUE(good.has_value() && result.status == CorrectionStatus::ok && result.message.empty());
        }
        EXPECT_EQ(allocations_so_far(), before);
    }
}

// Nothing of an earlier part may shine through.
TEST(RegionSolver, ReusedResultEqualsAFreshOne) {
    Rng rng(2);
    RegionSolver solver;
    RegionCorrection reused;
    for (int i = 0; i < 40; ++i) {
        std::vector<SpotObservation> spots = door(rng, 3 + i % 9);
        measure(spots, random_displacement(rng, 10, 1, {0, 0, 0}));
        add_noise(spots, rng, 0.05);
        if (i % 4 == 0) spots[1].measured_mm.x() += 4;
        ASSERT_TRUE(solver.solve(spots, {}, reused).has_value());
        const RegionCorrection fresh = *solve_region(spots, {});
        EXPECT_EQ(reused.status, fresh.status);
        EXPECT_EQ(reused.message, fresh.message);
        EXPECT_EQ(reused.unobservable, fresh.unobservable);
        EXPECT_EQ(reused.covariance, fresh.covariance);
        EXPECT_EQ(reused.displacement.workobject_from_movedworkobject.matrix(),
                  fresh.displacement.workobject_from_movedworkobject.matrix());
        ASSERT_EQ(reused.spots.size(), fresh.spots.size());
        for (std::size_t n = 0; n < spots.size(); ++n) {
            EXPECT_EQ(reused.spots[n].id, fresh.spots[n].id);
            EXPECT_EQ(reused.spots[n].used, fresh.spots[n].used);
            EXPECT_EQ(reused.spots[n].residual_mm, fresh.spots[n].residual_mm);
        }
    }
}

}  // namespace
}  // namespace seamwright
