// Part types: what is a type of a project, and what a person does with them.

#include "projects/model/part_types.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/file/project_file.h"
#include "projects/reuse/part_type_edits.h"
#include "projects/station/check.h"
#include "projects/station/program.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// The exact cell's six spots and two regions as the type "left", cloned as "right".
Project two_types() {
    const auto cell = make_fake_cell();
    Project p = cell->project;
    Profile seen;
    seen.x_mm = {0, 1};
    seen.z_mm = {0, 0};
    for (Spot& spot : p.spots) spot.reference_profile = seen;
    p.spots[0].curve.emplace();
    p.regions[0].offsets.resize(1);
    p.regions[0].offsets[0].version = 1;
    p.regions[0].offset_switches = {1};
    return clone_part_type(*add_part_type(p, {"left", "door left", 1}), "left", {"right", "", 2}).value();
}

RunValuesWanted only(const std::string& type) {
    RunValuesWanted wanted;
    wanted.type_id = type;
    return wanted;
}

template <class T>
std::vector<std::string> ids(const std::vector<T>& items) {
    std::vector<std::string> all;
    for (const T& item : items) all.push_back(item.id);
    return all;
}

TEST(PartTypes, TheFirstTypeOwnsWhatThereIs) {
    const auto cell = make_fake_cell();
    const auto after = add_part_type(cell->project, {"left", "", 1});
    ASSERT_TRUE(after) << after.error().sentence();
    for (const Spot& spot : after->spots) EXPECT_EQ(spot.type_id, "left");
    for (const Region& region : after->regions) EXPECT_EQ(region.type_id, "left");
    const auto second = add_part_type(*after, {"wagon", "", 0});
    ASSERT_TRUE(second);
    EXPECT_TRUE(of_type(*second, "wagon").spots.empty());
    // And the last one gives it back: the project is as it was.
    const auto removed = remove_part_type(*remove_part_type(*second, "wagon", false), "left", false);
    ASSERT_TRUE(removed);
    EXPECT_EQ(to_json_document(*removed), to_json_document(cell->project));
}

TEST(PartTypes, ACloneHasIdsOfItsOwnAndNothingThatWasMeasured) {
    const Project p = two_types();
    const Project right = of_type(p, "right");
    EXPECT_THAT(ids(right.spots),
                ElementsAre("S1-right", "S2-right", "S3-right", "S4-right", "S5-right", "S6-right"));
    EXPECT_THAT(ids(right.regions), ElementsAre("inner-right", "outer-right"));
    EXPECT_EQ(right.regions[0].spot_ids, ids(right.spots));
    EXPECT_EQ(right.regions[0].frame_name, "BASE_inner");
    for (const Spot& spot : right.spots) {
        EXPECT_EQ(spot.reference_state, ReferenceState::from_type);
        EXPECT_FALSE(spot.curve);
    }
    EXPECT_TRUE(right.regions[0].offsets.empty());
    EXPECT_TRUE(right.regions[0].offset_switches.empty());
    const Project left = of_type(p, "left");
    for (const Spot& spot : left.spots) EXPECT_EQ(spot.reference_state, ReferenceState::measured);
    // A clone of the clone does not pile names up.
    const auto third = clone_part_type(p, "right", {"wagon", "", 3});
    ASSERT_TRUE(third) << third.error().sentence();
    EXPECT_THAT(ids(of_type(*third, "wagon").regions), ElementsAre("inner-wagon", "outer-wagon"));
}

TEST(PartTypes, OfATypeIsTheProjectWithoutTheOthers) {
    const Project p = two_types();
    const Project left = of_type(p, "left"), right = of_type(p, "right");
    EXPECT_EQ(left.spots.size() + right.spots.size(), p.spots.size());
    EXPECT_EQ(left.regions.size() + right.regions.size(), p.regions.size());
    EXPECT_THAT(ids(left.part_types), ElementsAre("left"));
    EXPECT_EQ(left.calibrations.size(), p.calibrations.size());
    // Another type's edit leaves it as it was, bit for bit.
    Project edited = p;
    edited.spots.back().sigma_mm = 3;
    edited.part_types.push_back({"wagon", "", 9});
    EXPECT_EQ(to_json_document(of_type(edited, "left")), to_json_document(left));
    EXPECT_NE(to_json_document(of_type(edited, "right")), to_json_document(right));
    const auto plain = make_fake_cell();
    EXPECT_EQ(to_json_document(of_type(plain->project, "")), to_json_document(plain->project));
}

TEST(PartTypes, ATypeIsCalledByItsIdOrItsNumber) {
    const Project p = two_types();
    EXPECT_EQ(called_type(p, "left").value(), "left");
    EXPECT_EQ(called_type(p, "2").value(), "right");
    EXPECT_EQ(called_type(p, "002").value(), "right");
    for (const char* bad :
         {"", "0", "3", "-1", "LEFT", "left ", "99999999999999999999", "2.0", "left\n", "\xff"}) {
        const auto called = called_type(p, bad);
        ASSERT_FALSE(called) << bad;
        EXPECT_EQ(called.error().kind, ErrorKind::input);
        EXPECT_THAT(called.error().sentence(), HasSubstr("left (1), right (2)"));
    }
    const auto plain = make_fake_cell();
    EXPECT_EQ(called_type(plain->project, "").value(), "");
    EXPECT_THAT(called_type(plain->project, "left").error().sentence(), HasSubstr("has no part types"));
}

TEST(PartTypes, WhatIsNoneIsRefusedWithASentence) {
    const Project p = two_types();
    const auto refused = [&](auto spoil, const char* why) {
        Project bad = p;
        spoil(bad);
        const auto checked = check_part_types(bad);
        ASSERT_FALSE(checked) << why;
        EXPECT_THAT(checked.error().sentence(), HasSubstr(why));
        EXPECT_THAT(check(bad), testing::Not(IsEmpty()));
        // Neither is it saved.
        TemporaryFolder folder;
        EXPECT_FALSE(ProjectFile::create(folder / "bad.seam", bad));
    };
    refused([](Project& b) { b.part_types[1].id = "left"; }, "two part types are called \"left\"");
    refused([](Project& b) { b.part_types[1].number = 1; }, "its number 1 is that of left too");
    refused([](Project& b) { b.part_types[1].number = 65536; }, "65536 is no number of a part type");
    refused([](Project& b) { b.part_types[1].number = -1; }, "-1 is no number of a part type");
    refused([](Project& b) { b.part_types[1].id = "12"; }, "\"12\" is no id of a part type");
    refused([](Project& b) { b.part_types[1].id = ""; }, "no id of a part type");
    refused([](Project& b) { b.part_types[1].id = "a b"; }, "no id of a part type");
    refused([](Project& b) { b.part_types[1].id = std::string(17, 'x'); }, "no id of a part type");
    refused([](Project& b) { b.part_types[1].id = "t\xc3\xbcr"; }, "no id of a part type");
    refused([](Project& b) { b.spots[0].type_id = "wagon"; },
            "its part type \"wagon\" is not in the project");
    refused([](Project& b) { b.regions[0].type_id = "wagon"; },
            "its part type \"wagon\" is not in the project");
    refused([](Project& b) { b.regions[0].spot_ids.push_back("S1-right"); },
            "its spot S1-right is of right, the region of left");
    refused([](Project& b) { b.spots[0].type_id.clear(); },
            "its spot S1 is of no part type, the region of left");
    refused([](Project& b) { b.part_types.clear(); }, "the project has no part types");
    EXPECT_TRUE(check_part_types(p));
}

TEST(PartTypes, WhatIsOfNoTypeIsFoundAndTaken) {
    Project p = two_types();
    Spot stray = p.spots[0];
    stray.id = "S99";
    stray.type_id.clear();
    Region loose = p.regions[0];
    loose.id = "loose";
    loose.type_id.clear();
    loose.spot_ids = {"S99"};
    loose.frame_name = "BASE_loose";
    p.spots.push_back(stray);
    p.regions.push_back(loose);
    ASSERT_TRUE(check_part_types(p)) << "it can be saved";
    std::string found;
    for (const Error& e : check(p)) found += e.sentence() + "\n";
    EXPECT_THAT(found, HasSubstr("spot S99: it is of no part type, and is not run"));
    const auto taken = take_into_part_type(p, "right", {"loose"});
    ASSERT_TRUE(taken) << taken.error().sentence();
    EXPECT_EQ(taken->spots.back().type_id, "right");
    EXPECT_EQ(taken->regions.back().type_id, "right");
    EXPECT_THAT(take_into_part_type(p, "right", {"S1"}).error().sentence(),
                HasSubstr("it is of part type left"));
    EXPECT_THAT(take_into_part_type(p, "right", {"S404"}).error().sentence(),
                HasSubstr("not in the project"));
    EXPECT_THAT(take_into_part_type(p, "wagon", {"loose"}).error().sentence(),
                HasSubstr("no part type \"wagon\""));
}

TEST(PartTypes, RemovingTakesSpotsOnlyWhenToldTo) {
    const Project p = two_types();
    EXPECT_THAT(remove_part_type(p, "right", false).error().sentence(),
                HasSubstr("6 spots and 2 regions are of it"));
    const auto after = remove_part_type(p, "right", true);
    ASSERT_TRUE(after);
    EXPECT_EQ(to_json_document(*after), to_json_document(of_type(p, "left")));
    EXPECT_FALSE(remove_part_type(p, "wagon", true));
    EXPECT_FALSE(clone_part_type(p, "wagon", {"van", "", 0}));
    EXPECT_FALSE(clone_part_type(p, "left", {"right", "", 0}));
}

TEST(PartTypes, ComparedByWhatACloneIsNamedAfter) {
    Project p = two_types();
    // As cloned, only what was measured on the other part differs.
    auto differences = compare_part_types(p, "left", "right");
    ASSERT_TRUE(differences);
    for (const PartTypeDifference& d : *differences)
        EXPECT_THAT(d.field, testing::AnyOf("reference_state", "curve", "offsets", "offset_switches"))
            << d.what;
    const std::size_t before = differences->size();
    for (Spot& spot : p.spots)
        if (spot.id == "S2-right") spot.sigma_mm = 0.5;
    p.regions.back().limits.translation_mm = 7;
    std::erase_if(p.spots, [](const Spot& spot) { return spot.id == "S6"; });
    differences = compare_part_types(p, "left", "right");
    ASSERT_TRUE(differences);
    std::vector<std::string> said;
    for (const PartTypeDifference& d : *differences) said.push_back(d.what + " " + d.field);
    EXPECT_THAT(said, testing::IsSupersetOf({"spot S2 sigma_mm", "region outer limits", "spot S6 "}));
    EXPECT_EQ(differences->size(), before + 2) << "S6 lost one line and gained one";
    EXPECT_FALSE(compare_part_types(p, "left", "left"));
    EXPECT_FALSE(compare_part_types(p, "left", "wagon"));
}

TEST(PartTypes, ComeBackFromTheFile) {
    TemporaryFolder folder;
    const Project p = two_types();
    {
        auto file = ProjectFile::create(folder / "types.seam", p);
        ASSERT_TRUE(file) << file.error().sentence();
        RunRecord run;
        run.part_id = "CAR";
        run.started_utc = run.finished_utc = "2026-05-01T10:00:00.000Z";
        ASSERT_TRUE(file->append_run(run, p));
        run.type_id = "left";
        ASSERT_TRUE(file->append_run(run, of_type(p, "left")));
        run.type_id = "right";
        ASSERT_TRUE(file->append_run(run, of_type(p, "right")));
    }
    auto file = ProjectFile::open(folder / "types.seam");
    ASSERT_TRUE(file) << file.error().sentence();
    EXPECT_TRUE(file->check().empty());
    EXPECT_EQ(to_json_document(*file->load()), to_json_document(p));
    const auto runs = file->runs();
    ASSERT_EQ(runs->size(), 3u);
    EXPECT_EQ(runs->at(0).type_id, "");
    EXPECT_EQ(runs->at(1).type_id, "left");
    EXPECT_EQ(file->load_run(3)->type_id, "right");
    EXPECT_THAT(ids(file->load_run_setup(3)->regions), ElementsAre("inner-right", "outer-right"));
    const auto values = file->run_values(only("right"));
    ASSERT_TRUE(values) << values.error().sentence();
    ASSERT_EQ(values->size(), 1u);
    EXPECT_EQ(values->front().number, 3);
    EXPECT_EQ(file->run_values()->size(), 3u);
    ASSERT_TRUE(file->delete_run(3));
    EXPECT_TRUE(file->check().empty());
    EXPECT_TRUE(file->run_values(only("right"))->empty());
}

TEST(PartTypes, TwoTypesMayShareAFrameTwoRegionsOfOneMayNot) {
    Project p = two_types();
    const auto frames = [](const Project& project) {
        std::string said;
        for (const Error& e : check(project)) said += e.sentence() + "\n";
        return said.find("writes the same frame") != std::string::npos;
    };
    EXPECT_FALSE(frames(p));
    p.regions[1].frame_name = p.regions[0].frame_name;
    EXPECT_TRUE(frames(p));
}

TEST(PartTypes, ARobotsProgramIsOfOneTypeAndSaysSo) {
    const Project p = two_types();
    EXPECT_THAT(program_request(p, RobotId("R1")).error().sentence(), HasSubstr("no part type was said"));
    const auto left = program_request(p, RobotId("R1"), PartTypeId("1")),
               right = program_request(p, RobotId("R1"), PartTypeId("right"));
    ASSERT_TRUE(left && right);
    EXPECT_EQ(left->part_type, "left");
    EXPECT_EQ(right->frames.size(), 2u);
    EXPECT_NE(program_signature(left->moves), program_signature(right->moves))
        << "the controller's program of one type measures no other";
}

}  // namespace
}  // namespace seamwright
