#include "projects/file/file_use.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <filesystem>
#include <optional>

#include "tests/projects/file/other_program.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

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

// What somebody planted where the lock comes to stand.
TEST(FileUse, NothingElseIsFollowedOrTouched) {
    const TemporaryFolder folder;
    const auto file = folder / "door.seam", lock = folder / "door.seam.lock", victim = folder / "victim";
    write_bytes(victim, "precious");
    const auto refused = [&](const char* what) {
        const auto use = FileUse::take(file, FileUse::For::desk);
        ASSERT_FALSE(use) << what;
        EXPECT_EQ(use.error().kind, ErrorKind::file);
        EXPECT_NE(use.error().sentence().find("door.seam.lock"), std::string::npos) << use.error().sentence();
        EXPECT_EQ(file_bytes(victim), "precious") << what;
        EXPECT_TRUE(fs::exists(fs::symlink_status(lock))) << what;
        fs::remove(lock);
    };
    fs::create_symlink(victim, lock);
    refused("a link");
    fs::create_symlink(folder / "nothing", lock);
    refused("a link to nothing");
    EXPECT_FALSE(fs::exists(folder / "nothing"));
    fs::create_hard_link(victim, lock);
    refused("another name of a file");
    fs::copy_file(victim, lock);
    refused("a file of other contents");
    fs::create_directory(lock);
    refused("a folder");
    ASSERT_EQ(::mkfifo(lock.c_str(), 0600), 0);
    refused("a FIFO that nobody reads");
    write_bytes(lock, "seamwright, process 1 on line-pc, since 2024-01-01 10:00");
    EXPECT_TRUE(FileUse::take(file, FileUse::For::desk)) << "what a killed one left";
    write_bytes(lock, "");
    EXPECT_TRUE(FileUse::take(file, FileUse::For::desk)) << "what one left that was killed at once";
}

}  // namespace
}  // namespace seamwright
