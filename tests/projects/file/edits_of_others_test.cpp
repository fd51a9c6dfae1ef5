// Two programs that have one project open: neither undoes what the other has saved.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/file/project_file.h"
#include "tests/projects/file/kill_test.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class TwoPrograms : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(ProjectFile::create(folder / "a.seam", sample_project()));
        for (Program* p : {&here, &there}) {
            p->file.emplace(ProjectFile::open(folder / "a.seam").value());
            p->project = p->file->load().value();
        }
    }
    struct Program {
        std::optional<ProjectFile> file;
        Project project;
        Expected<void> save() { return file->save(project); }
    };
    Project on_disk() {
        return ProjectFile::open(folder / "a.seam", FileAccess::read_only).value().load().value();
    }
    std::vector<std::string> said(const Program& p) {
        std::vector<std::string> all;
        const auto edits = p.file->edits_of_others().value();
        for (const EditOfOthers& edit : edits) all.push_back(said_of(edit).english());
        return all;
    }

    TemporaryFolder folder;
    Program here, there;
};

TEST_F(TwoPrograms, EditsOfDifferentRowsBothStay) {
    there.project.robots[0].collisions = {"2026-01-02T03:04:05.000Z"};
    ASSERT_TRUE(there.save());
    EXPECT_THAT(said(there), IsEmpty());
    EXPECT_THAT(said(here), ElementsAre(HasSubstr("robots " + here.project.robots[0].id +
                                                  " was changed meanwhile by another program")));

    for (const double limit_mm : {7.0, 9.0}) {  // the second save knows of the first
        here.project.regions[0].limits.translation_mm = limit_mm;
        const auto saved = here.save();
        ASSERT_TRUE(saved) << saved.error().sentence();
        EXPECT_THAT(on_disk().robots[0].collisions, ElementsAre("2026-01-02T03:04:05.000Z"));
        EXPECT_EQ(on_disk().regions[0].limits.translation_mm, limit_mm);
    }
    EXPECT_EQ(said(here).size(), 1u) << "the program that saved does not know of the collision yet";
    here.project = here.file->load_anew().value();
    EXPECT_THAT(here.project.robots[0].collisions, ElementsAre("2026-01-02T03:04:05.000Z"));
    EXPECT_THAT(said(here), IsEmpty());
    EXPECT_TRUE(ProjectFile::open(folder / "a.seam")->check_chain()->empty());
}

TEST_F(TwoPrograms, WhatIsMadeAndDeletedStaysSo) {
    Region fresh = there.project.regions.front();
    fresh.id = "fresh";
    fresh.frame_name = "FRESH";
    there.project.regions.push_back(fresh);
    const std::string gone = there.project.calibrations.back().id;
    there.project.calibrations.pop_back();
    ASSERT_TRUE(there.save());

    const bool required = here.project.spots[0].required = !here.project.spots[0].required;
    const auto saved = here.save();
    ASSERT_TRUE(saved) << saved.error().sentence();
    const Project now = on_disk();
    EXPECT_EQ(now.regions.back().id, "fresh");
    for (const Calibration& c : now.calibrations) EXPECT_NE(c.id, gone);
    EXPECT_EQ(now.spots[0].required, required);
}

TEST_F(TwoPrograms, OneRowThatBothChangedIsRefusedWithNothingWritten) {
    there.project.regions[0].limits.translation_mm = 3;
    ASSERT_TRUE(there.save());
    here.project.regions[0].limits.translation_mm = 30;
    here.project.name = "another name";
    const auto refused = here.save();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::input);
    EXPECT_THAT(refused.error().sentence(), HasSubstr("regions " + here.project.regions[0].id +
                                                      " was changed meanwhile by another program"));
    EXPECT_EQ(exact_text(on_disk()), exact_text(there.project));

    here.project.regions[0].limits.translation_mm = 3;  // the same by both is none's
    ASSERT_TRUE(here.save());
    EXPECT_EQ(on_disk().name, "another name");
    EXPECT_EQ(on_disk().regions[0].limits.translation_mm, 3);
}

TEST_F(TwoPrograms, OnesOwnEditsAreTakenBackAsEver) {
    const double before = here.project.regions[0].limits.translation_mm;
    for (const double limit_mm : {before + 1, before, before + 2, before}) {
        here.project.regions[0].limits.translation_mm = limit_mm;
        ASSERT_TRUE(here.save());
        EXPECT_EQ(on_disk().regions[0].limits.translation_mm, limit_mm);
        EXPECT_THAT(said(here), IsEmpty());
    }
}

}  // namespace
}  // namespace seamwright
