#include "projects/file_use.h"

#include <gtest/gtest.h>

#include <optional>

#include "tests/projects/other_program.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

TEST(FileUse, ASecondProgramIsToldWhoHasIt) {
    const TemporaryFolder folder;
    const auto file = folder / "door.seam";
    std::optional<OtherProgram> other(std::in_place, file, FileUse::For::desk);
    ASSERT_TRUE(other->has_it);
    const auto refused = FileUse::take(file, FileUse::For::desk);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().sentence().find("open already"), std::string::npos);
    EXPECT_NE(refused.error().sentence().find("process " + std::to_string(other->pid())), std::string::npos)
        << refused.error().sentence();
    EXPECT_TRUE(FileUse::take(file, FileUse::For::devices)) << "another use";
    EXPECT_TRUE(FileUse::take(folder / "other.seam", FileUse::For::desk)) << "another file";
    EXPECT_FALSE(FileUse::take(folder / "." / "door.seam", FileUse::For::desk)) << "the same by another name";
    other.reset();  // killed
    EXPECT_TRUE(FileUse::take(file, FileUse::For::desk)) << "what a killed one left is taken over";
}

TEST(FileUse, EndsWithItsOwnerAndLeavesNothing) {
    const TemporaryFolder folder;
    const auto file = folder / "door.seam";
    {
        auto use = FileUse::take(file, FileUse::For::desk);
        ASSERT_TRUE(use);
        const FileUse moved = std::move(*use);
        EXPECT_FALSE(FileUse::take(file, FileUse::For::desk));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    EXPECT_TRUE(FileUse::take(file, FileUse::For::desk));
    EXPECT_TRUE(FileUse::take(folder / "no such folder" / "a.seam", FileUse::For::desk))
        << "no lock, no refusal";
}

}  // namespace
}  // namespace seamwright
