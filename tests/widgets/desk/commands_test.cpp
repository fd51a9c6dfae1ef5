#include "widgets/desk/commands.h"

#include <gmock/gmock.h>

#include <QCoreApplication>
#include <optional>

#include "devices/simulated/cell.h"
#include "devices/simulated/scene/mesh_file.h"
#include "tests/widgets/desk/desk_fixture.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

// Two of everything, and names that nobody has any more, as they remain when a device was taken out.
Project full_project() {
    Project p = sample_project();
    for (SensorSetup& sensor : p.sensors) sensor.filter = {};
    for (Spot& spot : p.spots) spot.feature.parameters.clear();
    p.sensors.push_back(p.sensors[0]);
    p.sensors[1].id = "B";
    p.sensors[1].calibration_id.clear();
    p.robots.push_back(p.robots[0]);
    p.robots[1].id = "R2";
    p.calibrations.push_back(p.calibrations[0]);
    p.calibrations[1].id = "C2";
    p.calibrations.push_back(p.calibrations[0]);
    p.calibrations[2].id = "C of one that is gone";
    p.calibrations[2].sensor_id = "gone sensor";
    p.calibrations[2].robot_id = "gone robot";
    p.regions[0].limits.translation_mm = 25;
    p.regions.push_back(p.regions[0]);
    p.regions[1].id = "hinge";
    p.regions[1].spot_ids = {"S6", "S2", "S6"};
    return p;
}

struct Edit {
    friend void PrintTo(const Edit& edit, std::ostream* out) { *out << edit.name; }
    std::string name, text;  // as the undo list shows it
    std::function<Expected<void>(Desk&)> make;
};

std::vector<Edit> edits() {
    const auto with = [](auto thing, const auto& change) {
        change(thing);
        return thing;
    };
    return {
        {"SpotAdd", "Add spot N1",
         [=](Desk& d) { return d.add(with(d.project().spots[2], [](Spot& s) { s.id = "N1"; }), 1); }},
        {"SpotAddAtTheEnd", "Add spot N2",
         [=](Desk& d) { return d.add(with(d.project().spots[0], [](Spot& s) { s.id = "N2"; })); }},
        {"SpotRemove", "Remove spot S2", [](Desk& d) { return d.remove<Spot>("S2"); }},
        {"SpotRename", "Rename spot S6 to Säule 7", [](Desk& d) { return d.rename<Spot>("S6", "Säule 7"); }},
        {"SpotMoveUp", "Move spot S5", [](Desk& d) { return d.move<Spot>("S5", 1); }},
        {"SpotMoveDown", "Move spot S1", [](Desk& d) { return d.move<Spot>("S1", 100); }},
        {"SpotEdit", "Change spot S4",
         [=](Desk& d) {
             return d.edit(with(d.project().spots[3], [](Spot& s) {
                 s.curve.reset();
                 s.reference_profile.z_mm[7] = std::nextafter(s.reference_profile.z_mm[7], 1e9);
             }));
         }},
        {"SpotEditNamed", "Change pose of spot S4",
         [=](Desk& d) {
             return d.edit(
                 with(d.project().spots[3], [](Spot& s) { s.base_from_flange.translation().x() += 1e-12; }),
                 "pose");
         }},
        {"SpotField", "Change jitter_mm of spot S1",
         [](Desk& d) { return d.set_spot_field(SpotId("S1"), "jitter_mm", 1.0 / 3.0); }},
        {"SpotEnable", "Enable spot S6", [](Desk& d) { return d.set_spot_enabled("S6", true); }},
        {"SpotDisable", "Disable spot S1", [](Desk& d) { return d.set_spot_enabled("S1", false); }},
        {"RegionAdd", "Add region N",
         [=](Desk& d) {
             return d.add(with(d.project().regions[0], [](Region& r) { r.id = r.frame_name = "N"; }), 0);
         }},
        {"RegionRemove", "Remove region edge", [](Desk& d) { return d.remove<Region>("edge"); }},
        {"RegionRename", "Rename region edge to rim",
         [](Desk& d) { return d.rename<Region>("edge", "rim"); }},
        {"RegionMove", "Move region edge", [](Desk& d) { return d.move<Region>("edge", 1); }},
        {"RegionEdit", "Change region hinge",
         [=](Desk& d) {
             return d.edit(with(d.project().regions[1], [](Region& r) {
                 r.free[1] = false;
                 r.spot_ids = {"S1"};
             }));
         }},
        {"RegionField", "Change sigma_limit_mm of region edge",
         [](Desk& d) { return d.set_region_field(RegionId("edge"), "sigma_limit_mm", 0.3); }},
        {"SensorAdd", "Add sensor N",
         [=](Desk& d) { return d.add(with(d.project().sensors[0], [](SensorSetup& s) { s.id = "N"; })); }},
        {"SensorRemove", "Remove sensor B", [](Desk& d) { return d.remove<SensorSetup>("B"); }},
        {"SensorRename", "Rename sensor A to left",
         [](Desk& d) { return d.rename<SensorSetup>("A", "left"); }},
        {"SensorRenameToAGoneOne", "Rename sensor A to gone sensor",
         [](Desk& d) { return d.rename<SensorSetup>("A", "gone sensor"); }},
        {"SensorMove", "Move sensor A", [](Desk& d) { return d.move<SensorSetup>("A", 1); }},
        {"SensorEdit", "Change sensor A",
         [=](Desk& d) {
             return d.edit(
                 with(d.project().sensors[0], [](SensorSetup& s) { s.settings["exposure_us"] = 0.1; }));
         }},
        {"SensorField", "Change per_line of sensor A",
         [](Desk& d) { return d.set_sensor_field(SensorId("A"), "per_line", 5); }},
        {"RobotAdd", "Add robot N",
         [=](Desk& d) { return d.add(with(d.project().robots[0], [](RobotSetup& r) { r.id = "N"; }), 0); }},
        {"RobotRemove", "Remove robot R2", [](Desk& d) { return d.remove<RobotSetup>("R2"); }},
        {"RobotRename", "Rename robot R1 to big", [](Desk& d) { return d.rename<RobotSetup>("R1", "big"); }},
        {"RobotRenameToAGoneOne", "Rename robot R1 to gone robot",
         [](Desk& d) { return d.rename<RobotSetup>("R1", "gone robot"); }},
        {"RobotMove", "Move robot R2", [](Desk& d) { return d.move<RobotSetup>("R2", 0); }},
        {"RobotEdit", "Change robot R1",
         [=](Desk& d) {
             return d.edit(
                 with(d.project().robots[0], [](RobotSetup& r) { r.required_mode = RobotMode::automatic; }));
         }},
        {"CalibrationAdd", "Add calibration N",
         [=](Desk& d) {
             return d.add(with(d.project().calibrations[0], [](Calibration& c) { c.id = "N"; }));
         }},
        {"CalibrationUse", "Use calibration C2 at sensor A",
         [](Desk& d) { return d.use_calibration(SensorId("A"), CalibrationId("C2")); }},
        {"CalibrationUseNone", "Use calibration  at sensor A",
         [](Desk& d) { return d.use_calibration(SensorId("A"), CalibrationId("")); }},
        {"CalibrationTake", "Use calibration N",
         [=](Desk& d) {
             return d.take_calibrations(
                 {with(d.project().calibrations[0], [](Calibration& c) { c.id = "N"; })}, true);
         }},
        {"CalibrationsTake", "Use calibrations N, M",
         [=](Desk& d) {
             return d.take_calibrations(
                 {with(d.project().calibrations[0], [](Calibration& c) { c.id = "N", c.sensor_id = "A"; }),
                  with(d.project().calibrations[0], [](Calibration& c) { c.id = "M", c.sensor_id = "B"; })},
                 true);
         }},
        {"CalibrationsKeep", "Keep calibrations N, M",
         [=](Desk& d) {
             return d.take_calibrations(
                 {with(d.project().calibrations[0], [](Calibration& c) { c.id = "N"; }),
                  with(d.project().calibrations[0], [](Calibration& c) { c.id = "M"; })},
                 false);
         }},
        {"CalibrationKeep", "Keep calibration N",
         [=](Desk& d) {
             return d.take_calibrations(
                 {with(d.project().calibrations[0], [](Calibration& c) { c.id = "N"; })}, false);
         }},
        {"PartEdit", "another part",
         [=](Desk& d) {
             return d.edit_part(with(d.project().part, [](PartSetup& p) { p.name = "door right"; }),
                                "another part");
         }},
        {"PartMeshAlone", "another mesh",
         [=](Desk& d) {
             return d.edit_part(with(d.project().part, [](PartSetup& p) { p.mesh_ply[10] ^= std::byte{1}; }),
                                "another mesh");
         }},
        {"ProjectRename", "Rename project to x", [](Desk& d) { return d.rename_project("x"); }},
        {"RequirementsEdit", "Change the requirements",
         [](Desk& d) { return d.set_requirement("sigma3_mm", 1.0 / 3.0); }},
        {"Reteach", "Take up again after an exchange",
         [](Desk& d) -> Expected<void> {
             Exchange exchange{"A", "C2", {}};
             if (auto moved = d.reteach(exchange); !moved) return tl::unexpected(moved.error());
             return {};
         }},
        {"PlacePart", "Place the simulated part",
         [](Desk& d) {
             return d.place_simulated_part(make_pose(Eigen::Matrix3d::Identity(), {1, 2, 3}), 0.1, 0.2);
         }},
    };
}

class Commands : public testing::Test {
  protected:
    TemporaryFolder folder;
    WatchedDesk me;
    Desk& desk = me.desk;
    void SetUp() override { ASSERT_TRUE(desk.create(folder / "a.seam", full_project())); }
    std::string now() const { return bits(desk.project()); }
    Expected<void> imported(const std::filesystem::path& mesh, const std::string& unit) {
        std::optional<Expected<void>> told;
        desk.import_part(mesh, unit, [&](const Expected<void>& how) { told = how; });
        EXPECT_FALSE(told) << "nobody waits for the file";
        while (!told) QCoreApplication::processEvents(QEventLoop::WaitForMoreEvents);
        return *told;
    }
};

class EveryEdit : public Commands, public testing::WithParamInterface<Edit> {};

TEST_P(EveryEdit, ComesAndGoesBitForBit) {
    const std::string before = now();
    QUndoStack& stack = desk.undo_stack();
    std::vector<std::string> seen;  // by the autosave too: a crash finds one of them
    QObject::connect(&desk, &Desk::project_changed, &desk, [&] { seen.push_back(now()); });
    const auto made = GetParam().make(desk);
    ASSERT_TRUE(made) << made.error().sentence();
    ASSERT_EQ(stack.count(), 1) << "one step";
    EXPECT_EQ(stack.undoText().toStdString(), GetParam().text);
    EXPECT_TRUE(desk.modified());
    const std::string after = now();
    EXPECT_NE(after, before);
    for (int round = 0; round < 2; ++round) {
        stack.undo();
        EXPECT_EQ(now(), before);
        EXPECT_FALSE(desk.modified());
        stack.redo();
        EXPECT_EQ(now(), after);
        EXPECT_TRUE(desk.modified());
    }
    for (const std::string& state : seen) EXPECT_TRUE(state == before || state == after) << "half an edit";
    // And it is stored as it stands.
    ASSERT_TRUE(desk.save());
    EXPECT_EQ(bits(what_a_crash_leaves(desk.path()).saved), after);
    stack.undo();
    EXPECT_EQ(now(), before);
    EXPECT_TRUE(desk.modified());
}
INSTANTIATE_TEST_SUITE_P(Edits, EveryEdit, testing::ValuesIn(edits()),
                         [](const auto& edit) { return edit.param.name; });

TEST_F(Commands, AnyRowOfEditsIsUndoneAndRedoneStepByStep) {
    std::mt19937 rng(8);
    const auto all = edits();
    std::vector<std::string> states{now()};
    QUndoStack& stack = desk.undo_stack();
    int refused = 0;
    for (int i = 0; i < 400; ++i) {
        if (rng() % 5 == 0 && stack.canUndo()) {  // back a little: what follows replaces what was undone
            stack.undo();
            states.pop_back();
            EXPECT_EQ(now(), states.back());
            continue;
        }
        const int count = stack.count(), index = stack.index();
        const std::string before = now();
        if (!all[rng() % all.size()].make(desk)) {
            ++refused;
            EXPECT_EQ(now(), before) << "an Error changes nothing";
            EXPECT_EQ(stack.index(), index);
            EXPECT_EQ(stack.count(), count);
        } else if (stack.index() > index) {
            states.push_back(now());
        } else {
            EXPECT_EQ(now(), before) << "an edit without a step";
        }
    }
    EXPECT_GT(refused, 10);
    ASSERT_GT(states.size(), 25U);
    while (stack.canRedo()) stack.redo(), states.push_back(now());
    for (std::size_t i = states.size() - 1; i-- > 0;) {
        stack.undo();
        ASSERT_EQ(now(), states[i]) << "step " << i;
    }
    EXPECT_FALSE(stack.canUndo());
    for (std::size_t i = 1; i < states.size(); ++i) {
        stack.redo();
        ASSERT_EQ(now(), states[i]) << "step " << i;
    }
}

TEST_F(Commands, AnEditThatIsNoneIsNoStep) {
    const Project p = desk.project();
    EXPECT_TRUE(desk.edit(p.spots[0]));
    EXPECT_TRUE(desk.edit(p.regions[0]));
    EXPECT_TRUE(desk.edit(p.sensors[0]));
    EXPECT_TRUE(desk.edit(p.robots[0]));
    EXPECT_TRUE(desk.edit_part(p.part, "x"));
    EXPECT_TRUE(desk.rename<Spot>("S1", "S1"));
    EXPECT_TRUE(desk.move<Spot>("S1", 0));
    EXPECT_TRUE(desk.set_spot_enabled("S1", true));
    EXPECT_TRUE(desk.set_spot_field(SpotId("S1"), "jitter_mm", p.spots[0].jitter_mm));
    EXPECT_TRUE(desk.use_calibration(SensorId("A"), CalibrationId("C1")));
    EXPECT_TRUE(desk.rename_project(p.name));
    EXPECT_EQ(desk.undo_stack().count(), 0);
    EXPECT_FALSE(desk.modified());
    const Pose there = make_pose(Eigen::Matrix3d::Identity(), {1, 2, 3});
    EXPECT_TRUE(desk.place_simulated_part(there, 0, 0));
    EXPECT_TRUE(desk.place_simulated_part(there, 0, 0));
    EXPECT_EQ(desk.undo_stack().count(), 1) << "it stands there already";
}

TEST_F(Commands, WhatIsWrongIsRefusedAndChangesNothing) {
    const Project p = desk.project();
    const std::string before = now();
    const auto refused = [&](const Expected<void>& result, const std::string& why) {
        ASSERT_FALSE(result) << why;
        EXPECT_THAT(result.error().sentence(), HasSubstr(why));
        EXPECT_EQ(now(), before);
        EXPECT_EQ(desk.undo_stack().count(), 0);
    };
    const auto with = [](auto thing, const auto& change) {
        change(thing);
        return thing;
    };
    refused(desk.add(p.spots[0]), "used already");
    refused(desk.add(with(p.spots[0], [](Spot& s) { s.id = ""; })), "empty");
    refused(desk.add(with(p.spots[0], [](Spot& s) { s.id = std::string(65, 'x'); })), "longer");
    refused(desk.edit(with(p.spots[0], [](Spot& s) { s.sensor_id = "Z"; })), "the sensor \"Z\"");
    refused(desk.edit(with(p.spots[0], [](Spot& s) { s.robot_id = "Z"; })), "the robot \"Z\"");
    refused(desk.edit(with(p.spots[0], [](Spot& s) { s.base_from_flange.matrix()(0, 0) += 0.1; })), "S1");
    refused(desk.edit(with(p.spots[0], [](Spot& s) { s.jitter_mm = -1; })), "jitter_mm");
    refused(desk.set_spot_field(SpotId("S1"), "sigma_mm", 0), "sigma_mm");
    refused(desk.set_spot_field(SpotId("none"), "sigma_mm", 1), "no spot \"none\"");
    refused(desk.rename<Spot>("S1", "S2"), "used already");
    refused(desk.rename<Spot>("none", "S9"), "\"none\"");
    refused(desk.remove<Spot>("none"), "\"none\"");
    refused(desk.move<Spot>("none", 1), "\"none\"");
    refused(desk.edit(with(p.regions[0], [](Region& r) { r.spot_ids = {"none"}; })), "no spot \"none\"");
    refused(desk.edit(with(p.regions[0], [](Region& r) { r.free.fill(false); })), "degree of freedom");
    refused(desk.set_region_field(RegionId("edge"), "sigma_limit_mm", 100), "sigma_limit_mm");
    refused(desk.edit(with(p.sensors[0], [](SensorSetup& s) { s.driver = "none"; })), "driver \"none\"");
    refused(desk.edit(with(p.robots[0], [](RobotSetup& r) { r.driver = "none"; })), "driver \"none\"");
    refused(desk.remove<SensorSetup>("A"), "spot S1 uses it");
    refused(desk.remove<RobotSetup>("R1"), "spot S1 uses it");
    refused(desk.use_calibration(SensorId("B"), CalibrationId("C1")), "another sensor");
    refused(desk.set_sensor_field(SensorId("A"), "per_line", 0), "per_line");
    refused(desk.set_sensor_field(SensorId("A"), "lookahead", 50), "min_segment_points");
    refused(desk.set_sensor_field(SensorId("Z"), "per_line", 3), "\"Z\"");
    const Calibration good = with(p.calibrations[0], [](Calibration& c) { c.id = "M"; });
    const Calibration lost = with(good, [](Calibration& c) { c.id = "N", c.sensor_id = "Z"; });
    refused(desk.take_calibrations({lost}, true), "\"Z\"");
    refused(desk.take_calibrations({good, lost}, true), "\"Z\"");
    refused(desk.take_calibrations({good, good}, false), "used already");
    refused(desk.use_calibration(SensorId("A"), CalibrationId("none")), "\"none\"");
    refused(imported(folder / "none.stl", "mm"), "none.stl");
}

TEST_F(Commands, ImportedPartsComeAndGo) {
    const auto cell = SimulatedCell::open({{"seed", 1}}).value();
    const std::vector<std::byte> ply = ply_bytes(cell->part_mesh());
    write_bytes(folder / "door.ply", {reinterpret_cast<const char*>(ply.data()), ply.size()});
    const std::string before = now();
    ASSERT_TRUE(imported(folder / "door.ply", ""));
    EXPECT_EQ(desk.undo_stack().undoText(), "Import part door.ply");
    EXPECT_EQ(desk.project().part.mesh_ply, ply);
    EXPECT_EQ(desk.project().part.name, "door left") << "a name that is there stays";
    desk.undo_stack().undo();
    EXPECT_EQ(now(), before);
}

TEST_F(Commands, RenamingTakesEverythingAlongThatNamesIt) {
    ASSERT_TRUE(desk.rename<Spot>("S6", "post"));
    EXPECT_EQ(desk.project().regions[1].spot_ids, (std::vector<std::string>{"post", "S2", "post"}));
    ASSERT_TRUE(desk.rename<SensorSetup>("A", "left"));
    ASSERT_TRUE(desk.rename<RobotSetup>("R1", "big"));
    for (const Spot& spot : desk.project().spots) {
        EXPECT_EQ(spot.sensor_id, "left");
        EXPECT_EQ(spot.robot_id, "big");
    }
    EXPECT_EQ(desk.project().calibrations[1].sensor_id, "left");
    EXPECT_EQ(desk.project().calibrations[1].robot_id, "big");
    EXPECT_EQ(desk.project().calibrations[2].sensor_id, "gone sensor");
}

TEST_F(Commands, ASelectionFollowsTheThing) {
    desk.selection().select_spot("S3");
    ASSERT_TRUE(desk.rename<Spot>("S3", "three"));
    EXPECT_EQ(desk.selection().spot(), "three");
    ASSERT_TRUE(desk.remove<Spot>("three"));
    EXPECT_EQ(desk.selection().spot(), "") << "what is gone is not selected";
    EXPECT_EQ(desk.free_id<Spot>("S"), "S3");
}

TEST(DeskEdits, NobodySignedInChangesNothing) {
    TemporaryFolder folder;
    const auto path = folder / "a.seam";
    {
        auto file = ProjectFile::create(path, full_project());
        ASSERT_TRUE(file) << file.error().sentence();
        ASSERT_TRUE(file->add_user("ada", Role::administrator, "correct horse battery"));
    }
    Desk desk;
    ASSERT_TRUE(desk.open(path));
    const std::string before = bits(desk.project());
    const auto refuses = [&](const auto& result, const char* what) {
        ASSERT_FALSE(result) << what;
        EXPECT_THAT(result.error().sentence(), HasSubstr("nobody is signed in")) << what;
        EXPECT_EQ(bits(desk.project()), before) << what;
        EXPECT_FALSE(desk.undo_stack().canUndo()) << what;
    };
    const Spot& spot = desk.project().spots[0];
    refuses(desk.set_spot_enabled(spot.id, !spot.enabled), "switching a spot");
    refuses(desk.use_calibration(SensorId("A"), CalibrationId("C2")), "choosing a calibration");
    refuses(desk.reteach(Exchange{}), "taking up again");
    Region region = desk.project().regions[0];
    region.spot_ids.pop_back();
    refuses(desk.edit(region), "changing a region");
    EXPECT_EQ(desk.edit(region).error().sentence(), desk.may(Deed::limits).error().sentence());
    EXPECT_EQ(desk.remove<Region>(region.id).error().sentence(), desk.may(Deed::limits).error().sentence());
    EXPECT_NE(desk.may(Deed::limits).error().sentence(), desk.may(Deed::teach).error().sentence());
    ASSERT_TRUE(desk.sign_in("ada", "correct horse battery"));
    EXPECT_TRUE(desk.set_spot_enabled(spot.id, !spot.enabled));
    EXPECT_TRUE(desk.edit(region));
}

TEST(DeskEdits, WithoutAProjectNothingIsEdited) {
    Desk desk;
    const auto refuses = [&](const auto& result, const char* what) {
        ASSERT_FALSE(result) << what;
        EXPECT_EQ(result.error().sentence(), "no project is open; open or make one") << what;
    };
    const Project full = full_project();
    refuses(desk.add(full.sensors[0]), "a sensor");
    refuses(desk.add(full.robots[0]), "a robot");
    refuses(desk.add(full.regions[0]), "a region");
    refuses(desk.edit_part(full.part, "x"), "the part");
    refuses(desk.rename_project("x"), "its name");
    refuses(desk.set_requirement("sigma3_mm", 0.3), "a requirement");
    refuses(desk.edit_acceptance({}), "the acceptance");
    refuses(desk.edit_project([](Project& p) { p.name = "x"; }, "x"), "anything");
    refuses(desk.reteach(Exchange{}), "taking up again");
    bool told = false;
    desk.import_part("none.stl", "mm", [&](const Expected<void>& imported) {
        told = true;
        refuses(imported, "a mesh");
    });
    EXPECT_TRUE(told) << "before it is read";
    EXPECT_EQ(desk.undo_stack().count(), 0);
    EXPECT_FALSE(desk.modified());
}

// One that comes with a project is told by check(); it keeps nobody from the other edits.
TEST_F(Commands, AFrameOfAnotherRegionOrPanelIsNotNamedNewly) {
    const Project p = desk.project();
    ASSERT_EQ(p.regions[0].frame_name, p.regions[1].frame_name);
    ASSERT_FALSE(p.panel_jobs.empty());
    EXPECT_TRUE(desk.set_region_field(RegionId("hinge"), "sigma_limit_mm", 0.21));
    Region own = desk.project().regions[1];
    own.frame_name = "BASE_OWN";
    EXPECT_TRUE(desk.edit(own));
    const auto refused = [&](const std::string& frame, const std::string& why) {
        Region r = own;
        r.frame_name = frame;
        const auto edited = desk.edit(r);
        ASSERT_FALSE(edited) << frame;
        EXPECT_EQ(edited.error().sentence(), why);
        r.id = "new";
        const auto added = desk.add(r);
        ASSERT_FALSE(added) << frame;
        EXPECT_THAT(added.error().sentence(), HasSubstr("writes the same frame"));
    };
    refused("base_data[7]",
            "region hinge: region edge writes the same frame BASE_DATA[7]; give each region its own frame");
    refused("BASE_data[9]", "region hinge: panel job " + p.panel_jobs[0].id +
                                " writes the same frame BASE_DATA[9]; give each region its own frame");
    EXPECT_EQ(desk.project().regions[1].frame_name, "BASE_OWN");
    // Two types push the same frame, one at a time.
    ASSERT_TRUE(desk.edit_project(
        [](Project& all) {
            all.regions[0].type_id = "left";
            all.regions[1].type_id = "right";
        },
        "types"));
    Region shared = desk.project().regions[1];
    shared.frame_name = "BASE_DATA[7]";
    EXPECT_TRUE(desk.edit(shared));
}

TEST(DeskEdits, ANameIsCountedInSigns) {
    TemporaryFolder folder;
    Desk desk;
    ASSERT_TRUE(desk.create(folder / "a.seam", full_project()));
    const auto umlauts = [](int signs) {
        std::string name;
        for (int k = 0; k < signs; ++k) name += "ü";
        return name;
    };
    const std::string id = desk.project().spots[0].id;
    EXPECT_FALSE(desk.rename<Spot>(id, umlauts(65)));
    EXPECT_FALSE(desk.rename<Spot>(id, std::string(65, 'x')));
    EXPECT_FALSE(desk.rename<Spot>(id, std::string(300, '\x80'))) << "no sign begins in it";
    ASSERT_TRUE(desk.rename<Spot>(id, umlauts(64)));
    const auto saved = desk.save();
    EXPECT_TRUE(saved) << saved.error().sentence();
}

}  // namespace
}  // namespace seamwright
