// The project's path: regions, frames, the gate and its limits at every point.

#include "projects/measure/path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/projects/gate/numeric_members.h"

namespace seamwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Pose shift(double x, double y, double z, double turn_deg = 0) {
    return make_pose(rotation_exp({0, 0, rad_from_deg(turn_deg)}), Eigen::Vector3d(x, y, z));
}

// Two regions with a spot each at x = 0 and x = 1000 of the work object, and one spot that both share.
struct Setting {
    Project project;
    RunRecord run;
    ApplicationPath path;  // along X in base, 10 mm apart
    Setting() {
        project.part.base_from_workobject = make_pose(rotation_exp({0.2, -0.1, 1.3}), {1500, 200, 700});
        SensorSetup sensor;
        sensor.id = "A";
        sensor.calibration_id = "C";
        project.sensors.push_back(sensor);
        Calibration c;
        c.id = "C";
        c.sensor_id = "A";
        c.flange_from_sensor = make_pose(rotation_exp({0.3, 0.1, 0}), {10, 20, 130});
        project.calibrations.push_back(c);
        for (const auto& [id, x] : {std::pair("S1", 0.0), std::pair("S2", 500.0), std::pair("S3", 1000.0)}) {
            Spot s;
            s.id = id;
            s.sensor_id = "A";
            s.base_from_flange =
                project.part.base_from_workobject * shift(x, 0, 0) * c.flange_from_sensor.inverse();
            project.spots.push_back(s);
        }
        for (const auto& [id, other, frame] :
             {std::tuple("left", "S1", "L"), std::tuple("right", "S3", "R")}) {
            Region region;
            region.id = id;
            region.spot_ids = {other, "S2"};
            region.frame_name = frame;
            project.regions.push_back(region);
        }
        for (const auto& [id, d] :
             {std::pair("left", shift(5, 2, -1, 0.4)), std::pair("right", shift(6, -1, 1, -0.2))}) {
            RegionRecord r;
            r.region_id = id;
            r.gate_passed = true;
            r.correction.emplace();
            r.correction->status = CorrectionStatus::ok;
            r.correction->displacement.workobject_from_movedworkobject = d;
            r.correction->covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-10, 1e-10, 1e-10;
            run.regions.push_back(r);
        }
        for (int i = 0; i <= 100; ++i)
            path.points.push_back({project.part.base_from_workobject * shift(10.0 * i, 0, 0, i), ""});
    }
    Expected<PathAnswer> answer(PathFrame frame = PathFrame::base) const {
        return correct_application_path(project, run, path, frame, {100, false});
    }
};

struct PathRequest {
    std::vector<Region> regions;
    std::vector<RegionCorrection> corrections;
    std::vector<Pose> points;
    double blend_mm = 100;
};
void numbers(const NumberVisitor& visit, const std::string& path, PathRequest& v) {
    using seamwright::numbers;
    auto& [regions, corrections, points, blend] = v;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        numbers(visit, path + "limits", regions[i].limits);
        numbers(visit, path + "sigma_limit_mm", regions[i].sigma_limit_mm);
        numbers(visit, path + "sigma_limit_deg", regions[i].sigma_limit_deg);
        numbers(visit, path + "displacement", corrections[i].displacement);
        numbers(visit, path + "covariance", corrections[i].covariance);
    }
    numbers(visit, path + "points", points);
    numbers(visit, path + "blend_mm", blend);
}

TEST(Path, EveryNumberThatIsNotFiniteIsRefused) {
    const Setting good;
    PathRequest request{good.project.regions, {}, {}};
    for (const RegionRecord& r : good.run.regions) request.corrections.push_back(*r.correction);
    for (const std::size_t i : {0, 40, 50, 60, 100})
        request.points.push_back(good.path.points[i].frame_from_tool);
    const auto refuses = [&](const PathRequest& r) {
        Setting s = good;
        s.project.regions = r.regions;
        for (std::size_t i = 0; i < 2; ++i) s.run.regions[i].correction = r.corrections[i];
        s.path.points.clear();
        for (const Pose& p : r.points) s.path.points.push_back({p, ""});
        const auto answer =
            correct_application_path(s.project, s.run, s.path, PathFrame::base, {r.blend_mm, false});
        return !answer || !answer->ok();
    };
    ASSERT_FALSE(refuses(request));
    int tried = 0;
    EXPECT_THAT(passes_with_one_not_finite(request, refuses, tried), testing::ElementsAre());
    EXPECT_EQ(tried, 3 * (2 * (4 + 12 + 36) + 5 * 12 + 1));
}

TEST(Path, PointsOfARegionMoveAsItsPushedFrameWould) {
    const Setting s;
    const auto a = s.answer();
    ASSERT_TRUE(a) << a.error().sentence();
    EXPECT_TRUE(a->ok());
    const Pose& b = s.project.part.base_from_workobject;
    const auto by = [&](int region, int point) {
        return b *
               s.run.regions[static_cast<std::size_t>(region)]
                   .correction->displacement.workobject_from_movedworkobject *
               b.inverse() * s.path.points[static_cast<std::size_t>(point)].frame_from_tool;
    };
    const auto at = [&](int i) { return a->path.points[static_cast<std::size_t>(i)].frame_from_tool; };
    for (const int i : {0, 20, 44}) EXPECT_TRUE(at(i).isApprox(by(0, i), 1e-12)) << i;
    for (const int i : {56, 80, 100}) EXPECT_TRUE(at(i).isApprox(by(1, i), 1e-12)) << i;
    EXPECT_FALSE(at(50).isApprox(by(0, 50), 1e-6));
    EXPECT_FALSE(at(50).isApprox(by(1, 50), 1e-6));
    // The border lies in the middle between S1 and S3; S2, which both share, has no say.
    EXPECT_EQ(a->path.points[49].region_id, "left");
    EXPECT_EQ(a->path.points[51].region_id, "right");
    EXPECT_LT(a->corrected.largest_mm.mm, 0.3 * a->corrected.unblended_mm);
}

TEST(Path, RegionsThatShareAllTheirSpotsAreToldByTheNearestThatTheyDoNot) {
    Setting s;
    Region ends = s.project.regions[0];
    ends.id = "ends";
    ends.spot_ids = {"S1", "S3"};
    s.project.regions.push_back(ends);
    RegionRecord r = s.run.regions[0];
    r.region_id = ends.id;
    s.run.regions.push_back(r);
    const auto a = s.answer();
    ASSERT_TRUE(a) << a.error().sentence();
    // Beside S1: left and ends share it; S2 is nearer than S3.
    for (const std::size_t i : {5U, 30U, 49U}) EXPECT_EQ(a->path.points[i].region_id, "left") << i;
    for (const std::size_t i : {51U, 70U, 95U}) EXPECT_EQ(a->path.points[i].region_id, "right") << i;
    // In whatever order they stand in the project.
    std::swap(s.project.regions[0], s.project.regions[2]);
    const auto b = s.answer();
    ASSERT_TRUE(b);
    for (std::size_t i = 0; i < a->path.points.size(); ++i) {
        if (i == 50) continue;  // as far from the one as from the other
        EXPECT_EQ(a->path.points[i].region_id, b->path.points[i].region_id) << i;
    }
}

TEST(Path, IsTheSameInBaseAndInTheWorkObject) {
    Setting s;
    const auto in_base = s.answer();
    const Pose& b = s.project.part.base_from_workobject;
    for (ApplicationPoint& p : s.path.points) p.frame_from_tool = b.inverse() * p.frame_from_tool;
    const auto in_part = s.answer(PathFrame::workobject);
    ASSERT_TRUE(in_base && in_part);
    for (std::size_t i = 0; i < s.path.points.size(); ++i)
        EXPECT_TRUE((b * in_part->path.points[i].frame_from_tool)
                        .isApprox(in_base->path.points[i].frame_from_tool, 1e-11));
}

TEST(Path, NamedRegionsCountAndUnknownOnesAreRefused) {
    Setting s;
    s.path.regions_named = true;
    for (std::size_t i = 0; i < s.path.points.size(); ++i)
        s.path.points[i].region_id = i < 30 ? "left" : i > 60 ? "right" : "";
    const auto a = s.answer();
    ASSERT_TRUE(a);
    EXPECT_NEAR(a->corrected.points[45].share, 0.5, 0.05);
    EXPECT_EQ(a->path.points[45].region_id, "");
    s.path.points[7].region_id = "top";
    const auto refused = s.answer();
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("path point 8"));
    s.path.regions_named = false;
    s.project.regions[1].spot_ids = {"S2"};
    EXPECT_THAT(s.answer().error().sentence(),
                AllOf(HasSubstr("all spots of region right belong to region left too"),
                      HasSubstr("add a column region")));
}

TEST(Path, WhatTheGateRefusedIsRefused) {
    Setting s;
    s.run.regions[1].gate_passed = false;
    s.run.regions[1].refusals = {"sigma of 0.4 mm is over"};
    auto a = s.answer();
    ASSERT_TRUE(a);
    ASSERT_EQ(a->refusals.size(), 1u);
    EXPECT_EQ(a->refusals[0].region_id, "right");
    EXPECT_THAT(a->refusals[0].reason, HasSubstr("sigma of 0.4"));
    s = Setting();
    s.run.regions.pop_back();
    EXPECT_FALSE(s.answer()->ok());
    s = Setting();
    s.run.regions[0].correction->status = CorrectionStatus::under_determined;
    s.run.regions[0].correction->covariance.setConstant(std::numeric_limits<double>::infinity());
    EXPECT_FALSE(s.answer()->ok());
}

TEST(Path, LimitsHoldAtEveryPoint) {
    Setting s;
    s.project.regions[0].limits = {5.48, 3};   // the left one's D is 5.4772 mm long
    s.project.regions[1].limits = {6.165, 3};  // the right one's 6.1644 mm
    auto a = s.answer();
    ASSERT_TRUE(a);
    EXPECT_TRUE(a->ok()) << a->refusals[0].reason;
    s.project.regions[1].limits.translation_mm = 6.16;
    a = s.answer();
    ASSERT_FALSE(a->ok());
    EXPECT_EQ(a->refusals[0].region_id, "right");
    EXPECT_GT(a->refusals[0].points, 40u);
    s = Setting();
    s.project.regions[0].limits.rotation_deg = 0.39;
    a = s.answer();
    ASSERT_FALSE(a->ok());
    EXPECT_THAT(a->refusals[0].reason, HasSubstr("degrees is beyond"));
    // Sigma grows with the lever: fine at the spots, over the limit 3 m away.
    s = Setting();
    for (Region& r : s.project.regions) r.sigma_limit_mm = 0.02;
    EXPECT_TRUE(s.answer()->ok());
    s.path.points[100].frame_from_tool = s.project.part.base_from_workobject * shift(3000, 0, 0);
    a = s.answer();
    ASSERT_FALSE(a->ok());
    EXPECT_EQ(a->refusals[0].point, 100u);
    EXPECT_THAT(a->refusals[0].reason, HasSubstr("at the path"));
}

}  // namespace
}  // namespace seamwright
