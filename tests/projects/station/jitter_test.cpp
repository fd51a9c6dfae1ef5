// The stated covariance of a region's displacement while triggers jitter over a displaced part: laws over
// many parts. Contours are straight; spots as on the procedural door.

#include <gtest/gtest.h>

#include <random>

#include "core/evaluation/statistics.h"
#include "devices/simulated/scene/door.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

constexpr double kSigmaMm = 0.04, kJitterMm = 3;

Project straight_door(double jitter_mm, const Eigen::Vector3d& weights = {1, 0, 1}) {
    Project p;
    p.sensors.emplace_back().id = "A";
    p.sensors[0].calibration_id = "C";
    p.robots.emplace_back().id = "R";
    p.calibrations.emplace_back().id = "C";
    Region region;
    region.id = "all";
    for (const DoorSpot& door : default_door_spots()) {
        Spot& s = p.spots.emplace_back();
        s.id = door.id;
        s.sensor_id = "A";
        s.robot_id = "R";
        s.base_from_flange = door.workobject_from_sensor;
        s.reference_mm = {door.edge_mm.x(), 0, door.edge_mm.z()};
        s.weights = weights;
        s.sigma_mm = kSigmaMm;
        s.jitter_mm = jitter_mm;
        region.spot_ids.push_back(s.id);
    }
    p.regions = {region};
    return p;
}

// What the sensor sees that was carried `late_mm` too far: the displaced line r + t Y where it meets the
// plane.
SpotMeasurement cut(const Spot& spot, const Pose& displacement, double late_mm,
                    const Eigen::Vector2d& noise) {
    const Pose moved = spot.base_from_flange.inverse() * displacement * spot.base_from_flange;
    const Eigen::Vector3d at = moved * spot.reference_mm, along = moved.linear().col(1);
    const Eigen::Vector3d met = at + along * (late_mm - at.y()) / along.y();
    SpotMeasurement m;
    m.spot_id = spot.id;
    m.status = SpotStatus::measured;
    m.measured_mm = {met.x() + noise.x(), 0, met.z() + noise.y()};
    m.sigma_mm = spot.sigma_mm;
    return m;
}

struct Judged {
    int trials = 0, within95 = 0, contradicting = 0, left_out = 0;
    double nees = 0;
};

// Parts up to 12 mm and 1.5 degrees off in each direction, each spot's trigger anywhere within +-kJitterMm.
Judged judge(const Project& project, int trials, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> even(-1, 1);
    Judged judged;
    for (int trial = 0; trial < trials; ++trial) {
        const Eigen::Vector3d shift(even(random), even(random), even(random));
        const Eigen::Vector3d turn(even(random), even(random), even(random));
        const Pose truth = make_pose(rotation_exp(turn * rad_from_deg(1.5)), 12 * shift);
        std::vector<SpotMeasurement> measured;
        for (const Spot& spot : project.spots) {
            const double late = kJitterMm * even(random);
            measured.push_back(
                cut(spot, truth, late, {kSigmaMm * normal(random), kSigmaMm * normal(random)}));
        }
        const std::vector<RegionRecord> regions = correct_regions(project, measured);
        const RegionCorrection& c = regions.at(0).correction.value();
        EXPECT_EQ(c.status, CorrectionStatus::ok) << c.message;
        const Pose& found = c.displacement.workobject_from_movedworkobject;
        const double square = nees(difference(truth, found), c.covariance);
        judged.nees += square / trials;
        judged.within95 += square < 12.592;  // chi-square, 6 degrees of freedom
        judged.contradicting += !c.consistent;
        for (const SpotResidual& r : c.spots) judged.left_out += !r.used;
        ++judged.trials;
    }
    return judged;
}

TEST(Jitter, StatedCovarianceHoldsOnDisplacedParts) {
    const Judged j = judge(straight_door(kJitterMm), 1000, 1);
    EXPECT_NEAR(j.within95, 950, 20) << "95 % +- 2 %";
    EXPECT_GT(j.nees, 5.5);
    EXPECT_LT(j.nees, 6.5);
    EXPECT_LE(j.contradicting, 2) << "a good part is not refused";
}

TEST(Jitter, WithoutItsShareTheCovarianceIsTooSmall) {
    const Judged j = judge(straight_door(0), 300, 1);
    EXPECT_LT(j.within95, 265) << "285 expected of a true one";
    EXPECT_GE(j.contradicting, 1);
}

TEST(Jitter, UnequalWeightsTakeTheWorseAxis) {
    // Conservative: one sigma for both.
    const Judged j = judge(straight_door(kJitterMm, {1, 0, 0.5}), 300, 2);
    EXPECT_GT(j.within95, 275);
    EXPECT_LE(j.contradicting, 1);
}

TEST(Jitter, AGrossErrorIsStillFound) {
    const Project project = straight_door(kJitterMm);
    const Pose truth = make_pose(rotation_exp({0.01, -0.015, 0.02}), {10, -8, 12});
    std::vector<SpotMeasurement> measured;
    for (const Spot& spot : project.spots) measured.push_back(cut(spot, truth, 1, {0, 0}));
    measured[4].measured_mm.x() += 3;
    const RegionCorrection c = correct_regions(project, measured).at(0).correction.value();
    ASSERT_EQ(c.status, CorrectionStatus::ok) << c.message;
    for (std::size_t i = 0; i < c.spots.size(); ++i) EXPECT_EQ(c.spots[i].used, i != 4) << c.spots[i].id;
}

TEST(Jitter, ASpotWhereTheRobotStopsHasNone) {
    Project moving = straight_door(kJitterMm), standing = moving, none = straight_door(0);
    for (Spot& s : standing.spots) s.stop_at_trigger = true;
    const Pose truth = make_pose(rotation_exp({0.01, -0.015, 0.02}), {10, -8, 12});
    std::vector<SpotMeasurement> measured;
    for (const Spot& spot : moving.spots) measured.push_back(cut(spot, truth, 0, {0, 0}));
    const auto covariance = [&](const Project& p) {
        return correct_regions(p, measured)[0].correction->covariance;
    };
    EXPECT_EQ(covariance(standing), covariance(none));
    EXPECT_GT(covariance(moving).trace(), 1.2 * covariance(none).trace());
}

}  // namespace
}  // namespace seamwright
