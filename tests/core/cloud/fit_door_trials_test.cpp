// The stated covariance against the truth on a bent and twisted part of which 40 % are seen: 200 drawn parts and poses.
//
// What is asked here is that no less is inside the stated region than it says, and that hardly any is refused; the figures
// are printed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/cloud/fit.h"
#include "tests/core/cloud/test_parts.h"

namespace seamwright {
namespace {

using Eigen::Vector3d;
using namespace test_parts;

// A sheet that was bent along its length and twisted, each about a place of its own somewhere on it: the displacement is
// zero there, and so is its slope.
struct BentSheet {
    double bend_mm, twist_mm, bend_at, twist_x, twist_y;
    explicit BentSheet(std::mt19937_64& random) {
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> uniform(-1, 1);
        bend_mm = 1.5 * normal(random);
        twist_mm = 1.0 * normal(random);
        bend_at = uniform(random);
        twist_x = uniform(random);
        twist_y = uniform(random);
    }
    Vector3d at(const Vector3d& p) const {
        const double u = 2 * p.x() / kPanelX - 1, v = 2 * p.y() / kPanelY - 1;
        return {0, 0, bend_mm * (u - bend_at) * (u - bend_at) / 2 + twist_mm * (u - twist_x) * (v - twist_y)};
    }
};

struct DoorTrials {
    int ok = 0, inside = 0, refused = 0;
    double mean_square = 0, worst_mm = 0;
};

DoorTrials door_trials(int count, std::uint64_t seed, double seen) {
    const Surface surface(panel(8));
    DoorTrials t;
    for (int i = 0; i < count; ++i) {
        std::mt19937_64 random(seed + static_cast<std::uint64_t>(i));
        const BentSheet sheet(random);
        Cloud cloud = panel_scan(random, 4000, 0.05, seen, [&](const Vector3d& p) { return sheet.at(p); });
        const Pose truth = random_pose(random, 0.05, 15);
        transform(cloud, truth);
        FitOptions options;
        options.start = Pose::Identity();
        const auto fit = fit_surface(cloud, surface, options);
        if (!fit || fit->status != FitStatus::ok) {
            ++t.refused;
            continue;
        }
        ++t.ok;
        const Vector6 d = difference(fit->base_from_part, truth);
        const double square = d.dot(fit->covariance.ldlt().solve(d));
        t.inside += square < 12.592;  // chi^2 of 6 at 95 %
        t.mean_square += square;
        t.worst_mm = std::max(t.worst_mm, d.head<3>().norm());
    }
    t.mean_square /= std::max(1, t.ok);
    fmt::print(
        "{} ok, {} refused; {} of {} inside the stated 95 % ({:.1f} %), mean chi^2 {:.2f} of 6, worst {:.2f} "
        "mm\n",
        t.ok, t.refused, t.inside, t.ok, 100.0 * t.inside / std::max(1, t.ok), t.mean_square, t.worst_mm);
    return t;
}

TEST(FitDoorTrials, OfABentAndTwistedSheetNoLessIsInsideTheStatedRegionThanItSays) {
    const DoorTrials t = door_trials(200, 5000, 0.4);
    EXPECT_GE(t.ok, 180);
    EXPECT_GE(t.inside, 0.93 * t.ok);
}

}  // namespace
}  // namespace seamwright
