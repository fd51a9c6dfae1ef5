// `run --push` as a script calls it: what stops it before anything moves, and what it says about the release.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "projects/file/project_file.h"
#include "tests/app/run_program.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class RunCommand : public testing::Test {
  protected:
    fs::path folder = test_folder("run_command"), file = folder / "door.seam";
    Project project;

    void SetUp() override {
        json settings = cell_settings(Pose::Identity());
        const auto cell = SimulatedCell::open(settings).value();
        settings["robot"]["frames"]["path"] = pose_json(cell->base_from_workobject());
        project = door_project(*cell, settings);
        ASSERT_TRUE(ProjectFile::create(file, project));
        ASSERT_NE(run({"run", file.string()}).exit_code, 3);
        // References as the first run measures them.
        auto opened = ProjectFile::open(file).value();
        const RunRecord first = opened.load_run(1).value();
        for (std::size_t i = 0; i < first.spots.size(); ++i) {
            project.spots[i].enabled = first.spots[i].status == SpotStatus::measured;
            project.spots[i].reference_mm = first.spots[i].measured_mm;
        }
        ASSERT_TRUE(opened.save(project));
    }
    ~RunCommand() override { fs::remove_all(folder); }
    ProgramResult run(const std::vector<std::string>& arguments) const {
        return run_program(arguments, folder);
    }
    json pushed(int exit_code) const {
        const ProgramResult r = run({"run", file.string(), "--part", "CAR-1", "--push", "--json", "-"});
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        return json::parse(r.out, nullptr, false);
    }
    template <class Change>
    void change(const Change& apply) {
        Project changed = project;
        apply(changed);
        auto opened = ProjectFile::open(file);
        ASSERT_TRUE(opened);
        ASSERT_TRUE(opened->save(changed));
    }
    std::size_t runs() const { return ProjectFile::open(file)->runs()->size(); }
};

TEST_F(RunCommand, SaysWhatBecameOfTheRelease) {
    const json answer = pushed(0);
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["release"]["R1"], "taken");
    EXPECT_EQ(answer["regions"][0]["push"]["release"], "taken");
    EXPECT_EQ(run({"run", file.string(), "--hold", "5"}).exit_code, 2) << "only with --push";
}

TEST_F(RunCommand, WhatConcernsMotionStopsItBeforeADeviceIsTouched) {
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<std::pair<const char*, std::function<void(Project&)>>> cases = {
        {"no region", [](Project& p) { p.regions.clear(); }},
        {"is none", [&](Project& p) { p.regions[0].limits.translation_mm = inf; }},
        {"is none", [&](Project& p) { p.regions[0].sigma_limit_mm = inf; }},
        {"writes the same frame",
         [](Project& p) {
             p.regions.push_back(p.regions[0]);
             p.regions[1].id = "again";
             p.regions[1].frame_name = "PATH";
         }},
        {"speed", [](Project& p) { p.spots[0].enabled = true, p.spots[0].speed_mm_s = -1; }},
    };
    const std::size_t before = runs();
    for (const auto& [words, spoil] : cases) {
        SCOPED_TRACE(words);
        change(spoil);
        const json answer = pushed(1);
        EXPECT_EQ(answer["status"], "refused");
        EXPECT_THAT(answer["findings"].dump(), HasSubstr(words));
        EXPECT_EQ(runs(), before) << "nothing was measured";
        EXPECT_EQ(ProjectFile::open(file)->events()->back().kind, EventKind::refusal);
    }
}

TEST_F(RunCommand, ATaughtFrameInMetresIsRefused) {
    change([](Project& p) { p.regions[0].base_from_frame.translation() *= 1e-3; });
    const json answer = pushed(1);
    EXPECT_EQ(answer["status"], "refused");
    EXPECT_THAT(answer["regions"][0]["refusals"].dump(), HasSubstr("would jump"));
    EXPECT_EQ(answer["regions"][0]["push"]["status"], "not_pushed");
}

}  // namespace
}  // namespace seamwright
