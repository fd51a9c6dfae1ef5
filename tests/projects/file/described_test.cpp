// Every member of a stored type is written: a structured binding does not compile before a member that is
// added is named here, and then the document must hold as many fields.

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

#include "projects/file/project_json.h"

namespace seamwright {
namespace {

std::size_t names_in(std::string_view list) {
    return static_cast<std::size_t>(std::count(list.begin(), list.end(), ',')) + 1;
}

// The type's members by name, in order.
#define MEMBERS(T, ...)                                     \
    std::size_t members(const T& value) {                   \
        [[maybe_unused]] const auto& [__VA_ARGS__] = value; \
        return names_in(#__VA_ARGS__);                      \
    }
MEMBERS(SpotResidual, a, b, c)
MEMBERS(DofSigma, a, b)
MEMBERS(RegionCorrection, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r)
MEMBERS(Feature, a, b, c, d, e, f, g, h)
MEMBERS(SpotMeasurement, a, b, c, d, e, f, g, h, i, j, k)
MEMBERS(SeenLight, a, b, c, d, e)
MEMBERS(SpotLight, a, b, c, d, e)
MEMBERS(PaintLight, a, b)
MEMBERS(PushRecord, a, b, c, d, e, f, g)
MEMBERS(RegionRecord, a, b, c, d, e, f, g, h, i)
MEMBERS(ActingDrift, a, b, c, d, e, f, g, h, i)
MEMBERS(DriftWatch, a, b, c, d, e, f, g, h, i, j, k, l)
MEMBERS(LearntDrift, a, b, c, d, e, f, g, h)
MEMBERS(LearntDirection, a, b, c, d, e, f)
MEMBERS(SetAside, a, b, c, d, e)
MEMBERS(DriftPoint, a, b, c, d, e, f, g, h, i, j, k, l)
MEMBERS(ActingModes, a, b, c, d, e, f, g)
MEMBERS(RegionModes, a, b, c, d, e, f, g)
MEMBERS(ElasticModes, a, b, c, d, e, f, g, h)
MEMBERS(ElasticMode, a, b, c, d, e, f, g)
MEMBERS(ElasticSpot, a, b, c, d, e, f, g)
MEMBERS(LearntRun, a, b, c)
MEMBERS(ActingOffset, a, b)
MEMBERS(PanelMeasurement, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
MEMBERS(PanelFit, a, b, c, d, e, f, g, h, i, j, k, l, m)
MEMBERS(PanelSpotResult, a, b, c, d, e, f, g)
MEMBERS(PanelRecord, a, b, c, d, e, f, g, h, i, j, k, l)
MEMBERS(PanelServo, a, b, c)
MEMBERS(PanelServoMove, a, b)
MEMBERS(PanelSensitivity, a, b, c, d, e, f)
MEMBERS(PartSetup, a, b, c, d, e)
MEMBERS(PartType, a, b, c)
MEMBERS(SensorSetup, a, b, c, d, e, f, g)
MEMBERS(PeakOptions, a, b, c, d, e, f, g)
MEMBERS(FilterOptions, a, b, c, d, e, f, g)
MEMBERS(RobotSetup, a, b, c, d, e, f, g, h, i)
MEMBERS(NozzleTip, a, b, c, d)
MEMBERS(Calibration, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q)
MEMBERS(FeatureRecipe, a, b, c, d)
MEMBERS(Spot, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x)
MEMBERS(DrawingOrigin, a, b, c, d, e, f)
MEMBERS(Region, a, b, c, d, e, f, g, h, i, j, k)
MEMBERS(KeptOffset, a, b, c, d, e)
MEMBERS(PanelPlace, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
MEMBERS(PanelJob, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
MEMBERS(Requirements, a, b, c, d, e, f)
MEMBERS(AcceptanceRequirements, a, b, c, d, e, f, g, h, i, j, k)
MEMBERS(FrozenContour, a, b, c, d, e, f, g, h, i)
MEMBERS(ZeroShift, a, b, c)
MEMBERS(KnownShift, a, b, c, d)
MEMBERS(HeadlessRun, a, b, c, d)
MEMBERS(SpotReturns, a, b, c, d, e, f)
MEMBERS(RobotReturns, a, b, c, d)
MEMBERS(TriggerPass, a, b, c)
MEMBERS(TriggerPasses, a, b, c, d, e, f, g, h)
MEMBERS(StudyPlan, a, b, c, d, e, f)
#undef MEMBERS

template <class T>
void whole(const T& value, const nlohmann::json& document, std::size_t elsewhere = 0) {
    EXPECT_EQ(document.size() + elsewhere, members(value)) << document.dump(1).substr(0, 1000);
}

TEST(Described, EveryMemberOfWhatIsStored) {
    RegionRecord region;
    region.correction.emplace();
    region.correction->spots.resize(1);
    region.offset.emplace();
    region.modes.emplace();
    region.drift.emplace().standing_mm = 0.01;
    const auto r = to_json_document(region);
    whole(region, r);
    whole(*region.offset, r["offset"]);
    whole(*region.modes, r["modes"]);
    whole(*region.drift, r["drift"]);
    whole(region.push, r["push"]);
    whole(*region.correction, r["correction"]);
    whole(region.correction->sigma_random, r["correction"]["sigma_random"]);
    whole(region.correction->spots[0], r["correction"]["spots"][0]);

    SpotMeasurement spot;
    spot.light.emplace();
    const auto s = to_json_document(spot);
    whole(spot, s);
    whole(*spot.light, s["light"]);
    whole(spot.feature, s["feature"]);

    PanelRecord panel;
    panel.before.resize(1);
    panel.fit.emplace();
    panel.fit->spots.resize(1);
    panel.servo.emplace().moves.resize(1);
    const auto p = to_json_document(panel);
    whole(*panel.servo, p["servo"]);
    whole(panel.servo->moves[0], p["servo"]["moves"][0]);
    whole(panel, p);
    whole(panel.before[0], p["before"][0]);
    whole(*panel.fit, p["fit"]);
    whole(panel.fit->spots[0], p["fit"]["spots"][0]);

    whole(PartType{}, to_json_document(PartType{}));
    PartSetup part;
    part.workobject_covariance.setIdentity();
    whole(part, to_json_document(part), 1);  // the mesh is a row of its own
    SensorSetup sensor;
    sensor.filter.as_delivered = true;
    const auto c = to_json_document(sensor);
    whole(sensor, c);
    whole(sensor.peaks, c["peaks"]);
    whole(sensor.filter, c["filter"]);
    RobotSetup robot;
    robot.speed_sigma = 0.1;
    robot.collisions = {"2026-03-05T00:00:00Z"};
    whole(robot, to_json_document(robot));
    Calibration touched;
    touched.nozzle.emplace();
    touched.scale_sigma.setConstant(1e-3);
    touched.shear_sigma = 1e-3;
    const auto n = to_json_document(touched);
    whole(touched, n);
    whole(*touched.nozzle, n["nozzle"]);
    Spot taught;
    taught.type_id = "left";
    taught.via.resize(1, Pose::Identity());
    taught.reference_arrivals = 5;
    taught.reference_state = ReferenceState::from_drawing;
    taught.drawn.emplace();
    taught.reference_light.emplace();
    taught.light.paints.resize(1);
    const auto t = to_json_document(taught);
    whole(taught.light, t["light"]);
    whole(taught.light.paints[0], t["light"]["paints"][0]);
    whole(taught, t);
    whole(*taught.drawn, t["drawn"]);
    whole(taught.feature, t["feature"]);
    Region kept;
    kept.type_id = "left";
    kept.offsets.resize(1);
    kept.offset_switches = {0};
    const auto k = to_json_document(kept);
    whole(kept, k);
    whole(kept.offsets[0], k["offsets"][0]);
    RegionModes modes;
    modes.modes.spots.resize(1);
    modes.modes.modes.resize(1);
    modes.learnt_from.resize(1);
    const auto m = to_json_document(modes);
    whole(modes, m);
    whole(modes.modes, m["modes"]);
    whole(modes.modes.spots[0], m["modes"]["spots"][0]);
    whole(modes.modes.modes[0], m["modes"]["modes"][0]);
    whole(modes.learnt_from[0], m["learnt_from"][0]);
    whole(StudyPlan{}, to_json_document(StudyPlan{}));
    DriftWatch drift;
    drift.learnt.emplace().directions.resize(1);
    drift.set_aside.resize(1);
    const auto w = to_json_document(drift);
    whole(drift, w);
    whole(*drift.learnt, w["learnt"]);
    whole(drift.learnt->directions[0], w["learnt"]["directions"][0]);
    whole(drift.set_aside[0], w["set_aside"][0]);
    whole(DriftPoint{}, to_json_document(DriftPoint{}));
    PanelJob job;
    job.sensitivity.emplace();
    job.places.resize(1);
    const auto j = to_json_document(job);
    whole(job, j);
    whole(*job.sensitivity, j["sensitivity"]);
    whole(job.places[0], j["places"][0]);
    Requirements required;
    required.acceptance.tolerance_mm = 1;
    const auto g = to_json_document(required);
    whole(required, g);
    whole(required.acceptance, g["acceptance"]);
    whole(FrozenContour{}, to_json_document(FrozenContour{}));
    whole(ZeroShift{}, to_json_document(ZeroShift{}));
    whole(KnownShift{}, to_json_document(KnownShift{}));
    whole(HeadlessRun{}, to_json_document(HeadlessRun{}));
    RobotReturns returns;
    returns.spots.resize(1);
    const auto q = to_json_document(returns);
    whole(returns, q);
    whole(returns.spots[0], q["spots"][0]);
    TriggerPasses passes;
    passes.passes.resize(1);
    const auto v = to_json_document(passes);
    whole(passes, v);
    whole(passes.passes[0], v["passes"][0]);
}

// A file from before random and systematic were told apart: all it knew was random.
TEST(Described, ACorrectionWithoutPartsIsRandom) {
    RegionRecord region;
    region.correction.emplace();
    region.correction->covariance.setIdentity();
    region.correction->sigma_xyz_mm.setOnes();
    auto document = to_json_document(region);
    for (const char* field :
         {"covariance_random", "covariance_systematic", "sigma_random", "sigma_systematic"})
        ASSERT_EQ(document["correction"].erase(field), 1u) << field;
    const auto back = from_json_document<RegionRecord>(document, "region");
    ASSERT_TRUE(back);
    EXPECT_EQ(back->correction->covariance_random, Matrix6::Identity());
    EXPECT_EQ(back->correction->covariance_systematic, Matrix6::Zero());
    EXPECT_EQ(back->correction->sigma_random.xyz_mm, Eigen::Vector3d::Ones());
}

TEST(Described, ACorrectionComesBackWhole) {
    RegionRecord region;
    region.correction.emplace();
    region.correction->sigma_at_spots_mm = 0.125;
    region.correction->variance_factor = 3.5;
    region.correction->consistent = false;
    const auto again = from_json_document<RegionRecord>(to_json_document(region), "region");
    ASSERT_TRUE(again) << again.error().sentence();
    EXPECT_EQ(again->correction->sigma_at_spots_mm, 0.125);
    EXPECT_EQ(again->correction->variance_factor, 3.5);
    EXPECT_FALSE(again->correction->consistent);
    auto old = to_json_document(region);
    for (const char* name : {"sigma_at_spots_mm", "variance_factor", "consistent"})
        old["correction"].erase(name);
    ASSERT_TRUE(from_json_document<RegionRecord>(old, "region")) << "a file of before is read";
}

}  // namespace
}  // namespace seamwright
