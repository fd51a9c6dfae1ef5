#include "devices/simulated/scene/swept_rim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/pose.h"
#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/profile_cut.h"

namespace seamwright {
namespace {

Profile seen(const RimPiece& piece, const Pose& part_from_sensor) {
    const MeshTree tree(swept_rim_mesh({&piece, 1}));
    Profile profile;
    cut_profile(tree, part_from_sensor, {}, profile);
    return profile;
}

// Middle of the step between hem flange and sealing land, x in the sensor frame: both neighbours are flat.
double step_x(const Profile& p) {
    double last = std::nan("");  // x of the last point on the flange
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (!std::isfinite(p.z_mm[i])) continue;
        if (p.z_mm[i] > -0.4)
            last = p.x_mm[i];
        else if (std::isfinite(last))
            return 0.5 * (last + p.x_mm[i]);
    }
    return std::nan("");
}

TEST(SweptRim, StraightPieceShowsTheDoorsCrossSectionAllAlong) {
    const RimPiece piece;
    const auto section = door_rim_section();
    for (const double y : {-50.0, 0.0, 37.0}) {
        Pose at = Pose::Identity();
        at.translation().y() = y;
        const Profile p = seen(piece, at);
        int points = 0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (!std::isfinite(p.z_mm[i])) continue;
            ++points;
            double nearest = 1e9;
            const Eigen::Vector2d q(p.x_mm[i], p.z_mm[i]);
            for (std::size_t k = 1; k < section.size(); ++k) {
                const Eigen::Vector2d a(section[k - 1].inboard_mm - 15,
                                        section[k - 1].height_mm - kDoorFlangeTop_mm);
                const Eigen::Vector2d b(section[k].inboard_mm - 15, section[k].height_mm - kDoorFlangeTop_mm);
                const double s = std::clamp((b - a).dot(q - a) / (b - a).squaredNorm(), 0.0, 1.0);
                nearest = std::min(nearest, (a + s * (b - a) - q).norm());
            }
            EXPECT_LT(nearest, 1e-9);
        }
        EXPECT_GT(points, 500);
    }
}

TEST(SweptRim, CircleRecedesTowardsItsCentre) {
    for (const double radius : {200.0, -200.0, 350.0, 3000.0}) {
        RimPiece piece;
        piece.radius_mm = radius;
        const double start = step_x(seen(piece, Pose::Identity()));
        ASSERT_NEAR(start, -6, 0.1);
        for (const double y : {-20.0, 10.0, 45.0}) {
            Pose at = Pose::Identity();
            at.translation().y() = y;
            // The step lies 9 mm inboard of the outermost line.
            const double r = std::abs(radius - 9);
            const double sagitta = std::copysign(r - std::sqrt(r * r - y * y), radius);
            // Columns are 0.078 mm apart, and a slanted step hides more of the land behind it.
            EXPECT_NEAR(step_x(seen(piece, at)) - start, sagitta, 0.12) << radius << " " << y;
        }
    }
}

TEST(SweptRim, PiecesStandWhereTheirSensorsAre) {
    std::vector<RimPiece> pieces;
    for (const DoorSpot& s : default_door_spots()) pieces.push_back({s.workobject_from_sensor, 500, 60});
    const MeshTree tree(swept_rim_mesh(pieces));
    const Profile alone = seen({Pose::Identity(), 500, 60}, Pose::Identity());
    for (const RimPiece& piece : pieces) {
        Profile p;
        cut_profile(tree, piece.part_from_sensor, {}, p);
        int same = 0, points = 0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (!std::isfinite(alone.z_mm[i])) continue;
            ++points;
            same += std::abs(p.z_mm[i] - alone.z_mm[i]) < 1e-6;
        }
        EXPECT_GT(same, 0.99 * points);
    }
}

}  // namespace
}  // namespace seamwright
