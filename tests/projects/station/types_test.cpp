// Parts of several types on the exact cell: what is measured, what reaches the robot, and what never does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/model/part_types.h"
#include "projects/proof/checklist.h"
#include "projects/proof/replay.h"
#include "projects/proof/zero_shift.h"
#include "projects/reuse/part_type_edits.h"
#include "projects/station/watch.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

class MixedTypes : public testing::Test {
  protected:
    // Both types push BASE_inner and BASE_outer, which were taught half a metre apart.
    void SetUp() override {
        cell->workobject_from_movedworkobject = make_pose(rotation_exp({0.006, -0.004, 0.009}), {3, -4, 2.5});
        Project p =
            *clone_part_type(*add_part_type(cell->project, {"left", "", 1}), "left", {"right", "", 2});
        for (Spot& spot : p.spots) spot.reference_state = ReferenceState::measured;  // taught by hand
        for (Region& region : p.regions)
            if (region.type_id == "right") region.base_from_frame.translation() += Eigen::Vector3d(0, 500, 0);
        cell->project = p;
        open();
        options.push = true;
        options.tell = [this](const WatchEvent& e) {
            texts += e.text.english() + "\n";
            if (std::holds_alternative<watched::RunDone>(e.happening)) frames.push_back(cell->frames);
            if (const auto* missed = std::get_if<watched::Missed>(&e.happening))
                by_type.push_back(missed->part_type);
        };
    }
    void open() {
        station.reset();
        auto file = ProjectFile::create(folder / "cell.seam", cell->project, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), cell->project);
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*cell);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<FakeRobot>(*cell);
        station->connect(std::move(sensors), std::move(robots));
    }
    void part(const std::string& id, const std::string& type) {
        const auto now = std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
        cell->starts.push_back(StartSignal{id, now, 0, type});
        cell->starts.push_back(device_error(ErrorCode::silence, kNoAnswer));
    }
    Expected<RunRecord> push(const std::string& type) {
        RunOptions run;
        run.part_type = type;
        run.push = true;
        return station->run(run);
    }
    Pose wanted(const std::string& region) const {
        for (const Region& r : cell->project.regions)
            if (r.id == region)
                return corrected_frame(cell->project.part.base_from_workobject,
                                       {cell->workobject_from_movedworkobject}, r.base_from_frame);
        return Pose::Identity();
    }

    TemporaryFolder folder;
    std::unique_ptr<FakeCell> cell = make_fake_cell();
    std::optional<Station> station;
    WatchOptions options;
    std::vector<std::map<std::string, Pose>> frames;  // on the controller, after each part
    std::vector<bool> by_type;
    std::string texts;
};

TEST_F(MixedTypes, TheFrameIsTheOneOfThePartsType) {
    const std::vector<std::string> types = {"left", "right", "2", "1", "right", "left"};
    for (std::size_t i = 0; i < types.size(); ++i) part("CAR-" + std::to_string(i), types[i]);
    options.parts = static_cast<std::int64_t>(types.size());
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->corrected, 6) << texts;
    ASSERT_EQ(frames.size(), types.size());
    const auto runs = station->file().runs();
    for (std::size_t i = 0; i < types.size(); ++i) {
        SCOPED_TRACE(i);
        const bool left = types[i] == "left" || types[i] == "1";
        for (const char* name : {"inner", "outer"}) {
            const Pose& now = frames[i].at(std::string("BASE_") + name);
            EXPECT_LT(distance_mm(now, wanted(left ? name : name + std::string("-right"))), 0.02);
            EXPECT_GT(distance_mm(now, wanted(left ? name + std::string("-right") : name)), 490);
        }
        EXPECT_EQ(runs->at(i).type_id, left ? "left" : "right");
        const auto run = station->file().load_run(runs->at(i).number);
        EXPECT_EQ(run->spots.size(), 6u);
        for (const SpotMeasurement& m : run->spots) EXPECT_EQ(m.spot_id.ends_with("-right"), !left);
    }
    EXPECT_NE(runs->at(0).setup, runs->at(1).setup);
    EXPECT_EQ(runs->at(0).setup, runs->at(5).setup);
    // Computed again from what is stored, without the other type.
    ReplayOptions again;
    const auto replayed = replay(station->file().path(), again);
    ASSERT_TRUE(replayed) << replayed.error().sentence();
    EXPECT_EQ(replayed->runs, 6);
    EXPECT_TRUE(replayed->differences.empty());
}

TEST_F(MixedTypes, AnUnknownOrMissingTypeLeavesTheFramesAsTheyAre) {
    part("CAR-1", "left");
    for (const char* type : {"", "wagon", "3", "0", "-1", "left,right", "99999999999999999999"})
        part("BAD", type);
    part("CAR-2", "right");
    options.parts = 2;
    int writes = 0;
    std::map<std::string, Pose> then;
    const auto tell = options.tell;
    options.tell = [&](const WatchEvent& e) {
        tell(e);
        if (std::holds_alternative<watched::RunDone>(e.happening) && writes == 0) {
            writes = cell->writes;
            then = cell->frames;
        }
        if (std::holds_alternative<watched::Missed>(e.happening)) {
            EXPECT_EQ(cell->writes, writes) << "nothing pushed, nothing zeroed";
            for (const auto& [name, pose] : then) EXPECT_EQ(cell->frames.at(name).matrix(), pose.matrix());
        }
    };
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->corrected, 2);
    EXPECT_EQ(counts->missed, 7);
    EXPECT_THAT(by_type, Each(true));
    EXPECT_THAT(texts, HasSubstr("part BAD: part types: no part type was said"));
    EXPECT_THAT(texts, HasSubstr("part type \"wagon\" is not in the project"));
    std::vector<PartVerdict> verdicts(7, PartVerdict::refused);
    verdicts.insert(verdicts.begin(), PartVerdict::corrected);
    verdicts.push_back(PartVerdict::corrected);
    EXPECT_EQ(cell->verdicts, verdicts) << "every call is answered";
    EXPECT_EQ(station->file().runs()->size(), 2u) << "no run of a part that was not measured";
}

TEST_F(MixedTypes, WhoSaysATypeSaysTheSame) {
    part("A", "left");
    part("B", "");
    part("C", "2");
    options.part_type = "right";
    options.parts = 2;
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->missed, 1);
    EXPECT_EQ(counts->corrected, 2);
    EXPECT_THAT(texts, HasSubstr("--type says part type right, before it was left"));
    const auto runs = station->file().runs();
    for (const RunSummary& run : *runs) EXPECT_EQ(run.type_id, "right");
}

TEST_F(MixedTypes, ATypeThatCannotBeRunIsRefusedAndTheOthersGoOn) {
    cell->project.spots.back().speed_mm_s = -1;  // of right
    open();
    part("A", "right");
    part("B", "left");
    options.parts = 1;
    const auto counts = watch(*station, options);
    ASSERT_TRUE(counts) << counts.error().sentence();
    EXPECT_EQ(counts->missed, 1);
    EXPECT_EQ(counts->corrected, 1);
    EXPECT_THAT(texts, HasSubstr("part type right"));
}

TEST_F(MixedTypes, AClonedReferenceIsMeasuredAndNeverPushed) {
    for (Spot& spot : cell->project.spots)
        if (spot.id == "S3-right") spot.reference_state = ReferenceState::from_type;
    open();
    const auto before = cell->frames;
    auto run = push("right");
    ASSERT_TRUE(run) << run.error().sentence();
    EXPECT_EQ(run->status, RunStatus::refused);
    EXPECT_THAT(run->message.english(), HasSubstr("another part type's: S3-right; teach them"));
    EXPECT_EQ(cell->writes, 0);
    EXPECT_EQ(push("left")->status, RunStatus::ok);
}

// What stands on the controller must be a part of one of the types; anything else is still a jump.
TEST_F(MixedTypes, AFrameOfNoTypeIsStillAJump) {
    cell->frames["BASE_inner"].translation().y() += 250;
    const auto run = push("right");
    ASSERT_TRUE(run);
    EXPECT_EQ(run->status, RunStatus::refused);
    EXPECT_THAT(run->message.english(), HasSubstr("the path would jump"));
    EXPECT_EQ(cell->writes, 0);
    // Of a type whose limits are none nothing follows.
    open();
    cell->frames["BASE_inner"].translation().y() -= 250;
    Project p = station->project();
    p.regions[0].limits = {std::numeric_limits<double>::infinity(), 180};  // left, inner
    station->use(p);
    const auto again = push("right");
    ASSERT_TRUE(again);
    EXPECT_EQ(again->status, RunStatus::refused);
}

TEST_F(MixedTypes, ARunWithoutATypeDoesNotBegin) {
    for (const char* type : {"", "wagon"}) {
        const auto run = push(type);
        ASSERT_FALSE(run);
        EXPECT_EQ(run.error().kind, ErrorKind::input);
    }
    EXPECT_TRUE(station->file().runs()->empty());
    EXPECT_TRUE(cell->verdicts.empty());
}

TEST_F(MixedTypes, WhatIsProvenIsOneTypesProof) {
    cell->workobject_from_movedworkobject = Pose::Identity();
    const auto step = [&] {
        Facts facts;
        EXPECT_TRUE(gather(station->file(), facts));
        for (const CheckItem& item : checklist(station->project(), facts))
            if (item.step == CheckStep::zero_shift) return item;
        return CheckItem{};
    };
    EXPECT_FALSE(measure_zero_shift(*station, {})) << "of which type?";
    ZeroShiftOptions zero;
    zero.part_type = "left";
    ASSERT_TRUE(measure_zero_shift(*station, zero));
    EXPECT_FALSE(step().done());
    EXPECT_THAT(step().why.english(), HasSubstr("part type right"));
    zero.part_type = "2";
    ASSERT_TRUE(measure_zero_shift(*station, zero));
    EXPECT_TRUE(step().done()) << step().why.english();
    // The edit of one type leaves the other's proof standing.
    Project p = station->project();
    p.spots.back().sigma_mm *= 2;
    station->use(p);
    EXPECT_EQ(step().status, CheckStatus::stale);
    EXPECT_THAT(step().why.english(), HasSubstr("part type right"));
}

}  // namespace
}  // namespace seamwright
