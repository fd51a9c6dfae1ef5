// Stated 95 % of amplitudes and bead on parts that were not learnt from.

#include <gtest/gtest.h>

#include "tests/core/elastic/bent_doors.h"

namespace seamwright {
namespace {

using namespace bent_doors;

TEST(ElasticCoverage, BeadAndUnseenPartsLieWithinWhatIsStated) {
    constexpr int kLearnings = 12, kParts = 60;
    const Door d = door(12);
    int acted = 0, trials = 0, inside = 0, points = 0, amplitudes = 0, amplitudes_inside = 0;
    double stated = 0, found_square = 0, rigid_square = 0;
    for (int l = 0; l < kLearnings; ++l) {
        Rng rng(100 + static_cast<std::uint64_t>(l));
        const auto modes = learn_modes(slots(d), rows(d, 40, 0.3, 0.2, rng));
        ASSERT_TRUE(modes);
        ASSERT_EQ(modes->modes.size(), 2u);
        const auto shape = BeadShape::make(*modes, spot_places(d), {true, arc_length(2 * kPi)});
        ASSERT_TRUE(shape);
        std::normal_distribution<double> n;
        for (int p = 0; p < kParts; ++p) {
            const Bend bend{0.3 * n(rng), 0.2 * n(rng), 0};
            const Pose truth = small_motion(rng, 1, 0.1);
            const auto spots = measured(d, truth, bend, rng);
            ++trials;
            const auto elastic = solve_elastic(spots, {}, *modes);
            const auto noiseless = solve_elastic(measured(d, truth, bend, rng, 0), {}, *modes);
            CorrectionOptions all;
            all.reject_outliers = false;
            const auto rigid = solve_region(spots, all);
            ASSERT_TRUE(elastic && rigid && noiseless);
            if (!elastic->acted) continue;
            ++acted;
            // What a measure without noise says is the amplitude, but for the prior's pull.
            for (std::size_t k = 0; noiseless->acted && k < 2; ++k) {
                ++amplitudes;
                amplitudes_inside +=
                    std::abs(elastic->amplitudes[k].value_mm - noiseless->amplitudes[k].value_mm) <
                    1.96 * elastic->amplitudes[k].sigma_mm;
            }
            for (int i = 0; i < 4; ++i) {
                const double t = 0.3 + 1.5708 * i + 0.1 * (p % 7);
                const Eigen::Vector3d true_place = truth * bent(t, bend);
                const BeadPoint found = bead_point(*elastic, *shape, bead(d, t));
                const Eigen::Vector3d off_rigid =
                    rigid->displacement.workobject_from_movedworkobject * contour(t) - true_place;
                const auto [up, aside] = across(d, t);
                for (const Eigen::Vector3d& n_of : {up, aside}) {
                    const double off = (found.place_mm - true_place).dot(n_of);
                    const double variance = n_of.dot(found.covariance_mm2 * n_of);
                    ++points;
                    inside += std::abs(off) < 1.96 * std::sqrt(variance);
                    stated += variance;
                    found_square += off * off;
                    rigid_square += off_rigid.dot(n_of) * off_rigid.dot(n_of);
                }
            }
        }
    }
    fmt::print(
        "simulated, noise 0.03 mm, bend 0.3 mm, twist 0.2 mm: bead 3 sigma {:.4f} mm with modes, {:.4f} "
        "without; "
        "stated {:.4f}; inside 95 %: bead {:.1f} %, amplitudes {:.1f} %; acted on {} of {}\n",
        3 * std::sqrt(found_square / points), 3 * std::sqrt(rigid_square / points),
        3 * std::sqrt(stated / points), 100.0 * inside / points, 100.0 * amplitudes_inside / amplitudes,
        acted, trials);
    EXPECT_GE(trials, 500);
    EXPECT_GE(acted, trials * 0.97);
    EXPECT_GT(inside, 0.92 * points);
    EXPECT_GT(amplitudes_inside, 0.93 * amplitudes);
    EXPECT_LT(found_square * 4, rigid_square);
    EXPECT_LT(stated, 1.6 * 1.6 * found_square);
}

}  // namespace
}  // namespace seamwright
