// A nearly straight rim that ends at the reference point, over ground that stands still, goes with it or is not there: yaw and
// pitch are those of the set-up within what is stated, and the cure cures.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/alignment/alignment.h"

namespace seamwright {
namespace {

constexpr double kDegree = 3.14159265358979 / 180;

enum class Ground { none, still, with_the_part };

struct Rim {
    double sagitta_mm = 0;  // of the last 20 mm of the sheet
    double tilt = 0;
    Ground ground = Ground::none;
    double depth_mm = 4, slope = 0;

    double height(double x) const {
        const double t = x / 20;
        return tilt * x + 4 * sagitta_mm * (t * t + t);
    }
};

// Height in the sensor's frame of what its line meets at x: the sheet where it is there (world x <= 0), else the ground.
double seen(const Rim& rim, const Eigen::Matrix3d& world_from_sensor, double x, double travel) {
    const Eigen::Vector3d from = world_from_sensor * Eigen::Vector3d(x, travel, 0);
    const Eigen::Vector3d up = world_from_sensor.col(2);
    double z = 0;
    for (int step = 0; step < 20; ++step) {
        const Eigen::Vector3d p = from + z * up;
        const double t = p.x() / 20, slope = rim.tilt + 4 * rim.sagitta_mm * (2 * t + 1) / 20;
        z -= (p.z() - rim.height(p.x())) / (up.z() - slope * up.x());
    }
    if ((from + z * up).x() <= 0) return z;
    if (rim.ground == Ground::none) return std::nan("");
    if (rim.ground == Ground::still) return -rim.depth_mm + rim.slope * x;
    const Eigen::Vector3d normal(-rim.slope, 0, 1);
    return (-rim.depth_mm - normal.dot(from)) / normal.dot(up);
}

std::vector<TravelProfile> pass_of(const Rim& rim, const Eigen::Matrix3d& world_from_sensor, double noise_mm,
                                   std::mt19937_64& engine) {
    constexpr double kPitch_mm = 0.1;
    std::normal_distribution<double> normal(0, noise_mm);
    std::vector<TravelProfile> out;
    for (double y = -20; y <= 20; y += 1) {
        TravelProfile t;
        t.travel_mm = y;
        for (int i = -160; i < 90; ++i) {
            const double x = kPitch_mm * (i + 0.37), z = seen(rim, world_from_sensor, x, y),
                         e = normal(engine);
            if (std::isnan(z)) continue;
            t.profile.x_mm.push_back(x);
            t.profile.z_mm.push_back(z + e);
        }
        out.push_back(std::move(t));
    }
    return out;
}

Eigen::Matrix3d turned(double z_deg, double x_deg, double y_deg = 0) {
    return (Eigen::AngleAxisd(z_deg * kDegree, Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(x_deg * kDegree, Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(y_deg * kDegree, Eigen::Vector3d::UnitY()))
        .toRotationMatrix();
}

AlignmentResult rim_checked(const std::vector<TravelProfile>& pass) {
    AlignmentOptions options;
    options.reference_mm = Eigen::Vector2d(0, 0);
    const auto r = check_alignment(pass, options);
    EXPECT_TRUE(r) << r.error().sentence();
    return r.value_or(AlignmentResult{});
}

double causes_mm(const Eigen::Matrix3d& world_from_sensor) {
    const Eigen::Vector3d along = world_from_sensor.transpose().col(1);
    return 5 * std::hypot(along.x(), along.z()) / along.y();
}

TEST(StraightRim, IsJudgedOverWhateverGround) {
    std::mt19937_64 engine(71);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int trials = 0, yaw_within = 0, pitch_within = 0, undetermined = 0;
    for (const Ground ground : {Ground::still, Ground::with_the_part})
        for (const double sagitta : {0.0, 0.05, 0.2, 1.0})
            for (const double noise : {0.01, 0.05})
                for (const double off : {0.3, 2.0, 6.0}) {
                    Rim rim;
                    rim.sagitta_mm = sagitta;
                    rim.ground = ground;
                    rim.tilt = 0.15 * uniform(engine);
                    rim.slope = 0.1 * uniform(engine);
                    rim.depth_mm = 4.5 + 0.5 * uniform(engine);
                    const double z = off * uniform(engine), x = off * uniform(engine),
                                 y = off * uniform(engine);
                    const Eigen::Matrix3d world_from_sensor = turned(z, x, y);
                    const AlignmentResult r = rim_checked(pass_of(rim, world_from_sensor, noise, engine));
                    const std::string which = std::to_string(static_cast<int>(ground)) + " " +
                                              std::to_string(sagitta) + " " + std::to_string(noise) + " " +
                                              std::to_string(off);
                    const double causes = causes_mm(world_from_sensor);
                    const Eigen::Vector3d along = world_from_sensor.transpose().col(1);
                    ++trials;
                    yaw_within += std::abs(r.yaw_deg - std::atan(along.x() / along.y()) / kDegree) <=
                                  1.96 * r.sigma_yaw_deg;
                    pitch_within += std::abs(r.pitch_deg - std::atan(along.z() / along.y()) / kDegree) <=
                                    1.96 * r.sigma_pitch_deg;
                    undetermined += r.status == AlignmentStatus::undetermined;
                    if (causes > 0.06) EXPECT_NE(r.status, AlignmentStatus::frozen) << which;
                    if (r.status != AlignmentStatus::drifting) continue;
                    EXPECT_GT(causes, 0.04) << which;
                    EXPECT_LT(causes_mm(world_from_sensor * turned(r.cure_about_z_deg, r.cure_about_x_deg)),
                              0.05)
                        << which;
                }
    EXPECT_EQ(undetermined, 0);
    // Binomial: of 48 at 0.95 fewer than 41 in 1 of 400.
    EXPECT_GE(yaw_within, 41) << trials;
    EXPECT_GE(pitch_within, 41) << trials;
}

// Without ground the end that moves is a rim; one that does not may as well be where the field of view ends.
TEST(StraightRim, WithoutGroundIsFollowedWhereItsEndMoves) {
    std::mt19937_64 engine(72);
    for (const double tilt : {-0.1, 0.0, 0.07}) {
        Rim rim;
        rim.tilt = tilt;
        const Eigen::Matrix3d off = turned(4, -3, 2);
        const AlignmentResult r = rim_checked(pass_of(rim, off, 0.03, engine));
        const Eigen::Vector3d along = off.transpose().col(1);
        EXPECT_EQ(r.status, AlignmentStatus::drifting) << tilt;
        EXPECT_FALSE(r.sliding) << tilt;
        EXPECT_NEAR(r.yaw_deg, std::atan(along.x() / along.y()) / kDegree, 0.2) << tilt;
        EXPECT_NEAR(r.pitch_deg, std::atan(along.z() / along.y()) / kDegree, 0.1) << tilt;
        EXPECT_LT(causes_mm(off * turned(r.cure_about_z_deg, r.cure_about_x_deg)), 0.05) << tilt;
        // The same rim, of which the field of view ends before its end.
        std::vector<TravelProfile> cut = pass_of(rim, off, 0.03, engine);
        for (TravelProfile& t : cut)
            while (!t.profile.x_mm.empty() && t.profile.x_mm.back() > -4) {
                t.profile.x_mm.pop_back();
                t.profile.z_mm.pop_back();
            }
        AlignmentOptions options;
        options.reference_mm = Eigen::Vector2d(-4, rim.height(-4));
        const auto blind = check_alignment(cut, options);
        ASSERT_TRUE(blind);
        EXPECT_NE(blind->status, AlignmentStatus::frozen) << tilt;
        EXPECT_TRUE(blind->sliding) << tilt;
        // What is not seen of the drift along a tilted sheet is in the sigma of what is.
        EXPECT_LE(std::abs(blind->pitch_deg - std::atan(along.z() / along.y()) / kDegree),
                  3 * blind->sigma_pitch_deg)
            << tilt;
    }
}

}  // namespace
}  // namespace seamwright
