#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "projects/station/check.h"
#include "tests/projects/fake_cell.h"

namespace seamwright {
namespace {

struct Fault {
    const char* name;
    std::function<void(Project&)> make;
    const char* words;
};

const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInf = std::numeric_limits<double>::infinity();

TEST(Check, NamesEveryImplausibility) {
    using P = Project&;
    const std::vector<Fault> faults = {
        {"duplicate spot", [](P p) { p.spots[1].id = "S1"; }, "spot S1: the id is used twice"},
        {"duplicate sensor", [](P p) { p.sensors.push_back(p.sensors[0]); },
         "sensor A: the id is used twice"},
        {"no id", [](P p) { p.robots[0].id.clear(); }, "a robot has no id"},
        {"unknown sensor", [](P p) { p.spots[0].sensor_id = "B"; }, "sensor \"B\" is not in the project"},
        {"unknown robot", [](P p) { p.spots[0].robot_id = "R9"; }, "robot \"R9\" is not in the project"},
        {"unknown calibration", [](P p) { p.sensors[0].calibration_id = "C9"; },
         "\"C9\" is not in the project"},
        {"no calibration", [](P p) { p.sensors[0].calibration_id.clear(); }, "has no calibration"},
        {"calibration of another sensor", [](P p) { p.calibrations[0].sensor_id = "B"; },
         "made for sensor B"},
        {"exchanged sensor",
         [](P p) {
             p.sensors[0].identity = {"fake", "x", "y", "77"};
         },
         "is not the one of calibration"},
        {"poor calibration", [](P p) { p.calibrations[0].verdict = Verdict::poor; }, "verdict is poor"},
        {"no driver", [](P p) { p.sensors[0].driver.clear(); }, "has no driver"},
        {"spot without region",
         [](P p) {
             for (auto& r : p.regions) r.spot_ids.erase(r.spot_ids.begin());
         },
         "no region uses it"},
        {"region with unknown spot", [](P p) { p.regions[0].spot_ids.push_back("S99"); },
         "\"S99\" is not in the project"},
        {"spot twice in region", [](P p) { p.regions[0].spot_ids.push_back("S1"); }, "named twice"},
        {"too few spots",
         [](P p) {
             p.regions[0].spot_ids = {"S1", "S2"};
         },
         "cannot determine 6 degrees"},
        {"empty region", [](P p) { p.regions[0].spot_ids.clear(); }, "no enabled spot"},
        {"nothing free", [](P p) { p.regions[0].free.fill(false); }, "no degree of freedom is free"},
        {"required spot off", [](P p) { p.spots[0].enabled = false; }, "required spot S1 is switched off"},
        {"absurd limit", [](P p) { p.regions[0].limits.translation_mm = 5000; },
         "the limit of translation, 5000 mm, is none"},
        {"infinite limit",
         [](P p) { p.regions[0].limits.rotation_deg = std::numeric_limits<double>::infinity(); },
         "the limit of rotation, inf degrees, is none"},
        {"nan sigma limit", [](P p) { p.regions[0].sigma_limit_mm = kNan; },
         "the limit of sigma, nan mm, is none"},
        {"same frame", [](P p) { p.regions[1].frame_name = p.regions[0].frame_name; },
         "writes the same frame"},
        {"no frame", [](P p) { p.regions[1].frame_name.clear(); }, "names no frame"},
        {"nan pose", [](P p) { p.spots[0].base_from_flange(0, 3) = kNan; }, "not a finite number"},
        {"nan via point",
         [](P p) {
             p.spots[0].via = {Pose::Identity(), Pose::Identity()};
             p.spots[0].via[1](2, 3) = kNan;
         },
         "via[1]"},
        {"sheared pose", [](P p) { p.part.base_from_workobject(0, 0) += 0.1; }, "orthonormal"},
        {"nan reference", [](P p) { p.spots[0].reference_mm.x() = kNan; }, "reference is not a finite point"},
        {"no weight", [](P p) { p.spots[0].weights.setZero(); }, "no direction has a weight"},
        {"negative weight", [](P p) { p.spots[0].weights.x() = -1; }, "not negative"},
        {"sigma zero", [](P p) { p.spots[0].sigma_mm = 0; }, "sigma of 0 mm"},
        {"speed", [](P p) { p.spots[0].speed_mm_s = -3; }, "speed of -3"},
        {"unknown feature", [](P p) { p.spots[0].feature.kind = "nose"; }, "nose"},
        {"profile columns", [](P p) { p.spots[0].reference_profile.x_mm.push_back(1); }, "differ in length"},
    };
    for (const Fault& fault : faults) {
        Project project = make_fake_cell()->project;
        fault.make(project);
        std::string all;
        for (const Error& finding : check(project)) all += finding.sentence() + "\n";
        EXPECT_THAT(all, testing::HasSubstr(fault.words)) << fault.name;
    }
}

TEST(Check, AFrameIsItsOwnWhereNobodyElseWritesIt) {
    Project project = make_fake_cell()->project;
    ASSERT_GE(project.regions.size(), 2u);
    for (const Region& region : project.regions) EXPECT_TRUE(frame_of_its_own(project, region));
    Region fresh = project.regions[0];
    fresh.id = "fresh";
    const auto refused = frame_of_its_own(project, fresh);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().sentence(), "region fresh: region " + project.regions[0].id +
                                              " writes the same frame " + project.regions[0].frame_name +
                                              "; give each region its own frame");
    for (char& c : fresh.frame_name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    EXPECT_FALSE(frame_of_its_own(project, fresh));
    fresh.type_id = "another";
    EXPECT_TRUE(frame_of_its_own(project, fresh)) << "one part is of one type";
    fresh.frame_name += "_2";
    fresh.type_id.clear();
    EXPECT_TRUE(frame_of_its_own(project, fresh));
    project.panel_jobs.emplace_back().frame_name = fresh.frame_name;
    EXPECT_FALSE(frame_of_its_own(project, fresh));
}

TEST(Check, ASpotOfTheDriftWatchNeedsNoRegion) {
    Project project = make_fake_cell()->project;
    const std::size_t before = check(project).size();
    Spot fixed = project.spots[0];
    fixed.id = "W1";
    project.spots.push_back(fixed);
    EXPECT_EQ(check(project).size(), before + 1);
    project.drift.emplace().spot_ids = {"W1"};
    EXPECT_EQ(check(project).size(), before);
}

// A run does not begin with what makes a robot move wrongly; what it can tell by itself does not keep it.
TEST(Check, GradesWhatConcernsMotion) {
    const Project good = make_fake_cell()->project;
    EXPECT_TRUE(motion_findings(good, true).empty());
    const auto with = [&](const std::function<void(Project&)>& change, bool push) {
        Project project = good;
        change(project);
        return motion_findings(project, push).size();
    };
    const auto limit = [](Project& p) { p.regions[0].limits.translation_mm = kInf; };
    EXPECT_EQ(with(limit, true), 1u);
    EXPECT_EQ(with(limit, false), 0u) << "a dry run writes nothing";
    const auto frame = [](Project& p) { p.regions[1].frame_name = "base_INNER"; };
    EXPECT_EQ(with(frame, true), 1u) << "controllers do not tell upper from lower case";
    EXPECT_EQ(with([](Project& p) { p.regions.clear(); }, true), 1u);
    EXPECT_EQ(with([](Project& p) { p.spots[0].speed_mm_s = kNan; }, false), 1u);
    EXPECT_EQ(with([](Project& p) { p.spots[0].entry_mm = 5000; }, false), 1u);
    EXPECT_EQ(with([](Project& p) { p.spots[0].base_from_flange(1, 3) = kNan; }, false), 1u);
    EXPECT_EQ(with(
                  [](Project& p) {
                      p.spots[0].speed_mm_s = -1;
                      p.spots[0].enabled = false;
                      for (Region& r : p.regions) r.spot_ids.erase(r.spot_ids.begin());
                  },
                  true),
              0u)
        << "nobody goes there";
    EXPECT_EQ(with([](Project& p) { p.calibrations[0].verdict = Verdict::poor; }, true), 0u)
        << "the gate says it";
}

// In motion a sensor that is triggered by software is exposed where nobody knows; a wire, standing still, or a device of
// ours on either side knows.
TEST(Check, NoSoftwareTriggerInMotion) {
    Project project = make_fake_cell()->project;
    ASSERT_FALSE(project.spots[0].stop_at_trigger);
    const auto refused = [&] { return motion_findings(project, false).size(); };
    const std::size_t spots = project.spots.size();
    EXPECT_EQ(refused(), 0u) << "a sensor that no wire can fire";
    for (SensorSetup& s : project.sensors) s.driver = "genicam";
    for (RobotSetup& r : project.robots) r.driver = "simulated";
    EXPECT_EQ(refused(), 0u) << "the robot is ours";
    for (RobotSetup& r : project.robots) r.driver = "kuka-eki";
    EXPECT_EQ(refused(), spots);
    EXPECT_THAT(motion_findings(project, false).front().sentence(), testing::HasSubstr("hardware_trigger"));
    EXPECT_EQ(standing_findings(project).size(), 0u) << "nothing is measured in passing";
    project.robots[0].trigger_latency_ms = 14;
    EXPECT_EQ(refused(), 0u) << "measured";
    project.robots[0].trigger_latency_ms = 0;
    project.spots[0].stop_at_trigger = true;
    EXPECT_EQ(refused(), spots - 1);
    for (SensorSetup& s : project.sensors) s.settings["hardware_trigger"] = true;
    EXPECT_EQ(refused(), 0u);
    for (SensorSetup& s : project.sensors) s.settings["hardware_trigger"] = false;
    EXPECT_EQ(refused(), spots - 1);
    for (SensorSetup& s : project.sensors) s.driver = "replay";
    EXPECT_EQ(refused(), 0u);
}

// A robot of Universal Robots begins each pass standing: at 1.2 m/s2 it is as fast as v after v^2 / (2 a).
TEST(Check, TellsASpeedThatTheEntryIsTooShortFor) {
    Project project = make_fake_cell()->project;
    for (RobotSetup& r : project.robots) r.driver = "ur-rtde";
    const auto told = [&](double speed_mm_s, double entry_mm, bool stops) {
        project.spots[0].speed_mm_s = speed_mm_s;
        project.spots[0].entry_mm = entry_mm;
        project.spots[0].stop_at_trigger = stops;
        for (const Error& e : check(project))
            if (e.sentence().find("does not reach the speed") != std::string::npos) return true;
        return false;
    };
    EXPECT_FALSE(told(100, 4.2, false));
    EXPECT_TRUE(told(100, 4.1, false));
    EXPECT_TRUE(told(400, 20, false));
    EXPECT_FALSE(told(200, 20, false));
    EXPECT_TRUE(told(10, 0, false));
    EXPECT_FALSE(told(400, 0, true));
    project.spots[0].stop_at_trigger = false;
    for (RobotSetup& r : project.robots) r.driver = "kuka-eki";
    EXPECT_FALSE(told(100, 0, false)) << "it comes to the entry at travelling speed";
}

}  // namespace
}  // namespace seamwright
