#include "core/geometry/three_two_one.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace seamwright {
namespace {

using Eigen::Vector3d;

// Whatever frame the picks were made in, wherever on plane and line: that frame comes back.
TEST(ThreeTwoOne, GivesBackTheFrameThatThePicksLieIn) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> mm(-500, 500), turn(-3, 3);
    int tried = 0;
    for (int i = 0; i < 500; ++i) {
        const Pose truth = make_pose(
            Eigen::AngleAxisd(turn(random), Vector3d(mm(random), mm(random), mm(random)).normalized())
                .toRotationMatrix(),
            {mm(random), mm(random), mm(random)});
        std::array<Vector3d, 3> flat{Vector3d(mm(random), mm(random), 0), Vector3d(mm(random), mm(random), 0),
                                     Vector3d(mm(random), mm(random), 0)};
        const double twice_area = (flat[1] - flat[0]).cross(flat[2] - flat[0]).z();
        const double longest =
            std::max({(flat[1] - flat[0]).norm(), (flat[2] - flat[1]).norm(), (flat[0] - flat[2]).norm()});
        if (std::abs(twice_area) < 0.2 * longest * longest) continue;  // flatter than one would pick
        if (twice_area < 0) std::swap(flat[1], flat[2]);               // round z to the right
        // The line's and the last point may lie off the plane: only their shadow on it counts.
        const double x0 = mm(random), x1 = x0 + 50 + std::abs(mm(random));
        const std::array<Vector3d, 2> line{Vector3d(x0, 0, 0.1 * mm(random)),
                                           Vector3d(x1, 0, 0.1 * mm(random))};
        const Vector3d point(0, mm(random), mm(random));
        const auto found = frame_by_three_two_one({truth * flat[0], truth * flat[1], truth * flat[2]},
                                                  {truth * line[0], truth * line[1]}, truth * point);
        ASSERT_TRUE(found) << found.error().sentence();
        EXPECT_LT((found->matrix() - truth.matrix()).norm(), 1e-8);
        ++tried;
    }
    EXPECT_GT(tried, 200);
}

TEST(ThreeTwoOne, RefusesPicksThatSayNoFrame) {
    const std::array<Vector3d, 3> plane{Vector3d(0, 0, 0), Vector3d(100, 0, 0), Vector3d(0, 100, 0)};
    const std::array<Vector3d, 2> line{Vector3d(0, 0, 0), Vector3d(50, 0, 0)};
    const Vector3d point(10, 10, 0);
    ASSERT_TRUE(frame_by_three_two_one(plane, line, point));
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 huge = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(frame_by_three_two_one({plane[0], plane[0], plane[2]}, line, point)) << "twice the same";
    EXPECT_FALSE(frame_by_three_two_one({plane[0], plane[1], Vector3d(50, 0.5, 0)}, line, point))
        << "on a line";
    EXPECT_FALSE(frame_by_three_two_one(plane, {line[0], line[0]}, point));
    EXPECT_FALSE(frame_by_three_two_one(plane, {line[0], Vector3d(0, 0.1, 80)}, point)) << "upright";
    EXPECT_FALSE(frame_by_three_two_one(plane, line, Vector3d(nan, 0, 0)));
    EXPECT_FALSE(frame_by_three_two_one({Vector3d(huge, 0, 0), plane[1], plane[2]}, line, point));
}

}  // namespace
}  // namespace seamwright
