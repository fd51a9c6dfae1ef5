#include "projects/proof/checklist.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "projects/measure/measure.h"
#include "projects/measure/reference_feature.h"
#include "projects/model/part_types.h"
#include "projects/proof/known_shift.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

constexpr const char* kToday = "2024-06-01T00:00:00.000Z";

// A project with everything done, and its evidence.
class Checklist : public testing::Test {
  protected:
    Project project;
    Facts facts;

    void SetUp() override {
        const nlohmann::json settings = cell_settings(Pose::Identity());
        const auto cell = SimulatedCell::open(settings);
        ASSERT_TRUE(cell);
        project = door_project(**cell, settings);
        project.calibrations[0].created_utc = "2024-05-01T10:00:00.000Z";
        project.requirements.sigma3_mm = 1;
        for (Spot& spot : project.spots) {
            spot.reference_profile.x_mm = {0, 1};
            spot.reference_profile.z_mm = {0, 0};
            spot.curve.emplace();
        }
        project.regions[0].limits = {5, 0.5};
        project.regions[0].sigma_limit_mm = 0.3;
        facts.now_utc = kToday;
        for (const Spot& spot : project.spots) {
            FrozenContour f;
            f.spot_id = spot.id;
            f.status = AlignmentStatus::frozen;
            f.jitter_mm = spot.jitter_mm;
            put(f);
        }
        ZeroShift zero;
        zero.runs = {1, 2, 3};
        zero.regions = {{"all", {}, {}, {}, 0.1}};
        put(zero);
        KnownShift proof;
        ShiftGrid grid;
        grid.step_mm = 10, grid.step_deg = 1;
        proof.range_mm = grid.range_mm, proof.range_deg = grid.range_deg;
        proof.tests = shift_tests(project, grid).value();
        for (ShiftTest& test : proof.tests) test.regions = {{"all", true, 0.1, {0.1, 0.05, -0.05}, ""}};
        put(proof);
        put(HeadlessRun{9, "car", false, "pc"});
    }
    template <class T>
    void put(const T& what) {
        const auto id = static_cast<std::int64_t>(facts.evidence.size()) + 1;
        facts.evidence.push_back({id, "2024-05-20T10:00:00.000Z", id, what});
        facts.setups[id] = std::make_shared<const Project>(project);
    }
    template <class T>
    T& proof_of() {
        for (auto e = facts.evidence.rbegin(); e != facts.evidence.rend(); ++e)
            if (T* what = std::get_if<T>(&e->what)) return *what;
        throw std::logic_error("no such evidence");
    }
    CheckItem item(CheckStep step) const {
        for (const CheckItem& i : checklist(project, facts))
            if (i.step == step) return i;
        return {};
    }
    void expect(CheckStep step, CheckStatus status, const std::string& why) const {
        const CheckItem i = item(step);
        EXPECT_EQ(i.status, status) << to_string(step) << ": " << i.why.in(Language::english);
        EXPECT_THAT(i.why.in(Language::english), testing::HasSubstr(why));
        EXPECT_NE(i.why.in(Language::german), i.why.in(Language::english));
    }
};

TEST_F(Checklist, EverythingDoneShowsItsEvidence) {
    const auto items = checklist(project, facts);
    ASSERT_EQ(items.size(), kCheckSteps.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        EXPECT_EQ(items[i].step, kCheckSteps[i]);
        EXPECT_TRUE(items[i].done()) << to_string(items[i].step) << ": "
                                     << items[i].why.in(Language::english);
        EXPECT_FALSE(items[i].evidence.empty()) << to_string(items[i].step);
    }
}

TEST_F(Checklist, AReferenceOfTheDriftWatchIsToBeTaughtButCorrectsNothing) {
    project.part_types = {{"reference", "", 9}, {"left", "", 1}};
    for (Spot& spot : project.spots) spot.type_id = "left";
    for (Region& region : project.regions) region.type_id = "left";
    Spot fixed = project.spots.front();
    fixed.id = "W1";
    fixed.type_id = "reference";
    project.spots.push_back(fixed);
    project.drift.emplace().spot_ids = {"W1"};
    const auto left = std::make_shared<const Project>(of_type(project, "left"));
    for (auto& [id, setup] : facts.setups) setup = left;
    FrozenContour f;
    f.spot_id = "W1";
    f.status = AlignmentStatus::frozen;
    f.jitter_mm = fixed.jitter_mm;
    put(f);
    const auto items = checklist(project, facts);
    ASSERT_EQ(items.size(), kCheckSteps.size());
    for (const CheckItem& i : items) EXPECT_TRUE(i.done()) << to_string(i.step) << ": " << i.why.english();
    project.spots.back().reference_profile = {};
    EXPECT_THAT(item(CheckStep::taught).why.english(), testing::HasSubstr("part type reference"));
    project.drift.reset();
    EXPECT_FALSE(item(CheckStep::observable).done()) << "a type that was forgotten";
}

TEST_F(Checklist, NothingIsDoneInAnEmptyProject) {
    for (const CheckItem& i : checklist({}, {})) {
        EXPECT_EQ(i.status, CheckStatus::missing) << to_string(i.step);
        EXPECT_FALSE(i.why.empty());
    }
}

TEST_F(Checklist, DevicesCountAsTheyAnswer) {
    facts.sensors = {{"A", false, ""}};
    expect(CheckStep::sensors, CheckStatus::missing, "connect");
    facts.sensors = {{"A", true, "no light"}};
    expect(CheckStep::sensors, CheckStatus::missing, "no light");
    facts.sensors = {{"A", true, ""}};
    expect(CheckStep::sensors, CheckStatus::done, "all sensors answer (1)");
    facts.robots.emplace();
    expect(CheckStep::robots, CheckStatus::missing, "connect");
    facts.robots.reset();
    project.robots[0].identity = {};
    expect(CheckStep::robots, CheckStatus::missing, "who it is");
}

TEST_F(Checklist, CalibrationMustBeOfThisDeviceGoodAndFresh) {
    facts.now_utc = "2026-01-01T00:00:00.000Z";
    expect(CheckStep::calibrations, CheckStatus::stale, "610 days old, 365");
    project.requirements.calibration_age_days = 700;
    expect(CheckStep::calibrations, CheckStatus::done, "fresh");
    project.sensors[0].identity.serial = "another";
    expect(CheckStep::calibrations, CheckStatus::stale, "another");
    project.sensors[0].identity = project.calibrations[0].sensor_identity;
    project.calibrations[0].verdict = Verdict::poor;
    expect(CheckStep::calibrations, CheckStatus::missing, "is poor");
    project.calibrations[0].verdict = Verdict::good;
    project.calibrations[0].created_utc = "yesterday";
    expect(CheckStep::calibrations, CheckStatus::stale, "no date");
    project.sensors[0].calibration_id = "";
    expect(CheckStep::calibrations, CheckStatus::missing, "no calibration in use");
}

TEST_F(Checklist, FrozenIsStaleWhenItsSpotWasTurned) {
    project.spots[2].base_from_flange.translate(Eigen::Vector3d(0, 0.1, 0));
    expect(CheckStep::frozen, CheckStatus::stale, project.spots[2].id);
    project.spots[2] = facts.setups.begin()->second->spots[2];
    // Teaching its reference again leaves the contour where it is; a wider jitter does not.
    project.spots[2].reference_mm.x() += 1;
    expect(CheckStep::frozen, CheckStatus::done, "stands still");
    project.spots[2].jitter_mm *= 2;
    expect(CheckStep::frozen, CheckStatus::stale, project.spots[2].id);
    project.spots[2].curve.reset();
    expect(CheckStep::frozen, CheckStatus::missing, "record the pass");
    project.spots[2].enabled = false;
    expect(CheckStep::frozen, CheckStatus::done, "stands still");
    const std::vector<Evidence> kept = facts.evidence;
    facts.evidence.clear();
    expect(CheckStep::frozen, CheckStatus::missing, "holds no accepted pass");
    facts.evidence = kept;
    FrozenContour drifting;
    drifting.spot_id = project.spots[0].id;
    drifting.status = AlignmentStatus::drifting;
    put(drifting);
    expect(CheckStep::frozen, CheckStatus::missing, "drifting");
}

TEST_F(Checklist, FrozenAtAWidenedToleranceStaysOpen) {
    project.requirements.sigma3_mm = 0.95;
    const auto judge = [&](double expected_error_mm, double tolerance_mm) {
        FrozenContour f;
        f.spot_id = project.spots[1].id;
        f.status = AlignmentStatus::frozen;
        f.jitter_mm = project.spots[1].jitter_mm;
        f.expected_error_mm = expected_error_mm;
        f.tolerance_mm = tolerance_mm;
        put(f);
    };
    judge(0.012, 0.05);
    expect(CheckStep::frozen, CheckStatus::done, "stands still");
    EXPECT_THAT(item(CheckStep::frozen).evidence[1].in(Language::english),
                testing::HasSubstr("expected error 0.012 mm at a jitter of 3.000 mm, tolerance 0.050 mm"));
    judge(0.012, 5);
    expect(CheckStep::frozen, CheckStatus::missing, "at a tolerance of 5.000 mm, 0.950 mm are required");
    judge(2.5, 5);
    expect(CheckStep::frozen, CheckStatus::missing, "by up to 2.500 mm, 0.950 mm are required");
    judge(0.9, 0.95);
    expect(CheckStep::frozen, CheckStatus::done, "stands still");
    judge(std::numeric_limits<double>::quiet_NaN(), 0.05);
    EXPECT_EQ(item(CheckStep::frozen).status, CheckStatus::missing);
}

// A contour that ends at `at`, seen with 0.05 mm of noise.
Profile ending_at(const Eigen::Vector2d& at, std::mt19937& random) {
    std::normal_distribution<double> noise(0, 0.05);
    Profile seen;
    for (int k = 0; k < 400; ++k) {
        seen.x_mm.push_back(at.x() + 0.1 * k);
        seen.z_mm.push_back(at.y() + noise(random));
        seen.segment.push_back(0);
    }
    return seen;
}

TEST_F(Checklist, AReferenceBesideItsFeatureIsNotTaught) {
    Spot& spot = project.spots[0];
    spot.feature = {};
    spot.feature.kind = "contour-end";
    spot.feature.parameters["side"] = 0;
    std::mt19937 random(5);
    // As teaching leaves it: the mean of five arrivals of an ordinary robot, and the profile of one of them.
    std::normal_distribution<double> repeats(0, 0.1);
    for (int k = 0; k < 60; ++k) {
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        for (int arrival = 0; arrival < 5; ++arrival) {
            const Eigen::Vector2d at(-15 + repeats(random), -1 + repeats(random));
            spot.reference_profile = ending_at(at, random);
            const auto found = feature_at_reference(spot);
            ASSERT_TRUE(found);
            sum += found->point_mm;
        }
        spot.reference_mm = {sum.x() / 5, 0, sum.y() / 5};
        ASSERT_EQ(reference_beside_mm(project, spot), 0) << k;
    }
    expect(CheckStep::taught, CheckStatus::done, "have their reference");
    // Clicked somewhere in the plot.
    spot.reference_mm += Eigen::Vector3d(27, 0, 11);
    expect(CheckStep::taught, CheckStatus::missing, "the reference of spot " + spot.id + " lies 29.");
    spot.weights = {0, 1, 0};
    expect(CheckStep::taught, CheckStatus::done, "have their reference");
}

TEST_F(Checklist, RegionsMustReachTheRequired3Sigma) {
    project.requirements.sigma3_mm = 0.02;
    expect(CheckStep::observable, CheckStatus::missing, "0.020 mm are required: ");
    project.requirements.sigma3_mm = 1;
    // What the gate would refuse at every part is not sure enough either.
    project.regions[0].sigma_limit_mm = 0.01;
    expect(CheckStep::observable, CheckStatus::missing, "0.030 mm are required: ");
    project.regions[0].sigma_limit_mm = 1;
    project.regions[0].sigma_limit_deg = 1e-4;
    expect(CheckStep::observable, CheckStatus::missing, "its limit is 0.0001 deg");
    project.regions[0].sigma_limit_deg = 0.5;
    project.requirements.sigma3_mm = 1;
    project.regions[0].spot_ids.resize(1);
    expect(CheckStep::observable, CheckStatus::missing, "under-determined");
}

TEST_F(Checklist, ProofsAreStaleBySpotButNotByLimit) {
    project.regions[0].limits.translation_mm = 4;
    project.requirements.sigma3_mm = 0.95;
    for (const CheckStep step : {CheckStep::zero_shift, CheckStep::known_shift, CheckStep::headless})
        EXPECT_TRUE(item(step).done()) << to_string(step);
    project.spots[1].weights.x() = 0.5;
    for (const CheckStep step : {CheckStep::zero_shift, CheckStep::known_shift, CheckStep::headless})
        expect(step, CheckStatus::stale, "spot " + project.spots[1].id + " was changed");
    project.spots[1].weights.x() = 1;
    project.calibrations[0].flange_from_sensor.translate(Eigen::Vector3d(0, 0, 1));
    expect(CheckStep::zero_shift, CheckStatus::stale, "calibration truth");
    project.calibrations[0] = facts.setups.begin()->second->calibrations[0];
    // The simulated part is moved by every proof.
    project.sensors[0].settings["part"] = {{"bend_mm", 3}};
    EXPECT_TRUE(item(CheckStep::zero_shift).done());
}

// As the desk renames: with all that names it. By value: a name may be the thing's own.
void rename_spot(Project& p, std::string from, std::string to) {
    for (Spot& spot : p.spots)
        if (spot.id == from) spot.id = to;
    for (Region& region : p.regions) std::replace(region.spot_ids.begin(), region.spot_ids.end(), from, to);
}
void rename_sensor(Project& p, std::string from, std::string to) {
    for (SensorSetup& sensor : p.sensors)
        if (sensor.id == from) sensor.id = to;
    for (Spot& spot : p.spots)
        if (spot.sensor_id == from) spot.sensor_id = to;
    for (Calibration& c : p.calibrations)
        if (c.sensor_id == from) c.sensor_id = to;
}

TEST_F(Checklist, WhatWasProvenStandsUnderANewName) {
    const Project before = project;
    const auto all_done = [&](const char* after) {
        for (const CheckItem& i : checklist(project, facts))
            EXPECT_TRUE(i.done()) << after << ", " << to_string(i.step) << ": " << i.why.english();
        for (const Spot& spot : project.spots) EXPECT_FALSE(frozen_open(project, facts, spot)) << after;
    };
    rename_spot(project, project.spots[1].id, "pillar");
    all_done("a spot renamed");
    rename_sensor(project, "A", "left sensor");
    all_done("a sensor renamed");
    const std::string robot = project.robots[0].id;
    project.robots[0].id = "big";
    for (Spot& spot : project.spots) spot.robot_id = "big";
    for (Calibration& c : project.calibrations)
        if (c.robot_id == robot) c.robot_id = "big";
    all_done("a robot renamed");
    project.regions[0].id = "door";
    all_done("a region renamed");
    ASSERT_FALSE(item(CheckStep::known_shift).evidence.empty() ||
                 item(CheckStep::zero_shift).evidence.empty());
    EXPECT_THAT(item(CheckStep::known_shift).evidence[0].english(), testing::HasSubstr("region door: 18"));
    EXPECT_THAT(item(CheckStep::zero_shift).evidence[0].english(),
                testing::HasSubstr("region door: mean of 3"));
    // The names of two exchanged.
    const std::string first = project.spots[0].id, third = project.spots[2].id;
    rename_spot(project, first, "");
    rename_spot(project, third, first);
    rename_spot(project, "", third);
    all_done("two spots' names exchanged");
    // What follows is judged as under the old name.
    project.spots[1].base_from_flange.translate(Eigen::Vector3d(0, 0.1, 0));
    EXPECT_TRUE(frozen_open(project, facts, project.spots[1]));
    EXPECT_EQ(item(CheckStep::zero_shift).status, CheckStatus::stale);
    project.spots[1].base_from_flange = before.spots[1].base_from_flange;
    project.spots[1].jitter_mm *= 2;
    expect(CheckStep::frozen, CheckStatus::stale, "spot pillar was changed");
    project = before;
    all_done("all taken back");
}

TEST_F(Checklist, WhoTakesAFormerNameInheritsNothing) {
    const Project before = project;
    const std::string name = project.spots[1].id;
    const auto open = [&](std::size_t i) {
        return frozen_open(project, facts, project.spots[i]).has_value();
    };
    // A new spot under the name of one that was removed.
    project.spots[1].base_from_flange.translate(Eigen::Vector3d(0, 40, 0));
    EXPECT_TRUE(open(1));
    // Another spot under it: it brings its own pass, not the removed one's.
    project = before;
    const std::string other = project.spots[2].id;
    project.spots.erase(project.spots.begin() + 1);
    rename_spot(project, other, name);
    EXPECT_FALSE(open(1)) << "renamed, with its pass";
    project.spots[1].base_from_flange.translate(Eigen::Vector3d(0, 40, 0));
    EXPECT_TRUE(open(1));
    // A new one under the former name of one that was renamed: each has its own.
    project = before;
    Spot fresh = project.spots[1];
    fresh.base_from_flange.translate(Eigen::Vector3d(0, 40, 0));
    rename_spot(project, name, "pillar");
    project.spots.push_back(fresh);
    EXPECT_FALSE(open(1));
    EXPECT_TRUE(open(project.spots.size() - 1));
    // A duplicate has no pass of its own.
    project = before;
    Spot twin = project.spots[1];
    twin.id = "twin";
    project.spots.insert(project.spots.begin() + 2, twin);
    EXPECT_FALSE(open(1));
    EXPECT_TRUE(open(2));
    // Another device of the same kind under the sensor's name.
    project = before;
    SensorSetup second = project.sensors[0];
    second.identity.serial = "another";
    rename_sensor(project, "A", "B");
    project.sensors.push_back(second);
    EXPECT_FALSE(open(1));
    for (Spot& spot : project.spots) spot.sensor_id = "A";
    EXPECT_TRUE(open(1));
    // A region of other spots under the name of one that was renamed.
    project = before;
    Region half = project.regions[0];
    project.regions[0].id = "door";
    half.spot_ids.pop_back();
    project.regions.push_back(half);
    EXPECT_EQ(item(CheckStep::known_shift).status, CheckStatus::stale);
}

// What all regions read as one is the part's; what one of them reads alone was taught wrong.
TEST_F(Checklist, AZeroShiftOfAPartThatLiesOffNamesThePart) {
    const std::string sensor = project.sensors[0].driver;
    Region half = project.regions[0];
    half.id = "half";
    half.spot_ids.resize(half.spot_ids.size() / 2);
    project.regions.push_back(half);
    const auto setup = std::make_shared<const Project>(project);
    for (auto& [id, then] : facts.setups) then = setup;
    // As regions of a part that has bent as well see it: turned about a point beside it, the rest 3 % of the way.
    const Eigen::Vector3d turn(0.004, -0.006, 0.005);
    const auto read = [&](std::size_t k, const Eigen::Vector3d& t_mm, const Eigen::Vector3d& w) {
        RunRecord run;
        for (std::size_t i = 0; i < 2; ++i) {
            RegionRecord r;
            r.region_id = project.regions[i].id;
            r.correction.emplace();
            if (i == 0 || k == 2)
                r.correction->displacement.workobject_from_movedworkobject =
                    make_pose(rotation_exp(w),
                              i == 0 ? t_mm : Eigen::Vector3d(t_mm + Eigen::Vector3d(0.1, -0.1, 0.15)));
            run.regions.push_back(std::move(r));
        }
        proof_of<ZeroShift>().regions = summarise_zero_shift(project, {run, run, run}).regions;
    };
    project.requirements.sigma3_mm = 0.3;
    read(2, {6, -5, 4}, turn);
    expect(CheckStep::zero_shift, CheckStatus::missing, "simulated part does not lie as taught");
    project.sensors[0].driver = "genicam";
    for (auto& [id, then] : facts.setups) then = std::make_shared<const Project>(project);
    expect(CheckStep::zero_shift, CheckStatus::missing, "Put it back");
    read(1, {6, -5, 4}, turn);
    expect(CheckStep::zero_shift, CheckStatus::missing, "teach it again");
    read(1, {6, -5, 4}, {0, 0, 0});
    expect(CheckStep::zero_shift, CheckStatus::missing, "teach it again");
    read(2, {0.05, 0, 0.02}, {0, 0, 0});
    EXPECT_TRUE(item(CheckStep::zero_shift).done()) << item(CheckStep::zero_shift).why.english();
    project.sensors[0].driver = sensor;
}

TEST_F(Checklist, ZeroShiftIsJudged) {
    proof_of<ZeroShift>().regions[0].worst_mean_mm = 1.5;
    expect(CheckStep::zero_shift, CheckStatus::missing, "1.500 mm");
    proof_of<ZeroShift>().runs = {1, 2};
    expect(CheckStep::zero_shift, CheckStatus::missing, "2 of 3");
    proof_of<ZeroShift>().refused = 1;
    expect(CheckStep::zero_shift, CheckStatus::missing, "refused");
}

TEST_F(Checklist, KnownShiftIsJudgedByAccuracyAndRange) {
    project.requirements.known_shift_mm = 15;
    expect(CheckStep::known_shift, CheckStatus::missing, "required are 15 mm");
    project.requirements.known_shift_mm = 10;
    project.requirements.sigma3_mm = 0.2;
    expect(CheckStep::known_shift, CheckStatus::missing, "required are 0.200 mm");
    project.requirements.sigma3_mm = 1;
    proof_of<KnownShift>().tests[4].regions[0].ok = false;
    expect(CheckStep::known_shift, CheckStatus::missing, "1 of 18");
}

TEST_F(Checklist, LimitsMayNotExceedWhatWasProven) {
    project.regions[0].limits.translation_mm = 25;
    expect(CheckStep::limits, CheckStatus::missing, "lets 25 mm");
    project.regions[0].limits = {5, std::numeric_limits<double>::infinity()};
    expect(CheckStep::limits, CheckStatus::missing, "through");
    project.regions[0].limits = {5, 0.5};
    project.regions[0].sigma_limit_mm = 0.4;
    expect(CheckStep::limits, CheckStatus::missing, "lower its sigma limit");
    project.regions[0].sigma_limit_mm = 0.3;
    facts.evidence.clear();
    expect(CheckStep::limits, CheckStatus::missing, "known shift");
}

TEST(Dates, AreCountedInDays) {
    EXPECT_EQ(days_between("2024-02-28T23:59:00.000Z", "2024-03-01T00:00:00.000Z"), 2);
    EXPECT_FALSE(days_between("2024-02-30", "2024-03-01"));
    EXPECT_FALSE(days_between("", "2024-03-01"));
}

}  // namespace
}  // namespace seamwright
