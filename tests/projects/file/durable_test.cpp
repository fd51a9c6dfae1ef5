// A file that others work with meanwhile, and one whose writer was killed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <fstream>
#include <optional>

#include "projects/file/project_file.h"
#include "tests/projects/file/kill_test.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class WriteAhead : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(ProjectFile::create(path, sample_project()));
        file.emplace(ProjectFile::open(path).value());
        file->keep_write_ahead(true);
        ASSERT_TRUE(file->append_run(sample_run(1), sample_project()));
        ASSERT_TRUE(fs::exists(path.string() + "-wal"));
    }
    static std::size_t runs_in(const fs::path& of) { return ProjectFile::open(of).value().runs()->size(); }
    TemporaryFolder folder;
    const fs::path path = folder / "a.seam";
    std::optional<ProjectFile> file;
};

TEST_F(WriteAhead, OthersReadAndWriteMeanwhile) {
    auto reader = ProjectFile::open(path, FileAccess::read_only);
    ASSERT_TRUE(reader) << reader.error().sentence();
    EXPECT_EQ(reader->runs()->size(), 1u);
    {
        auto writer = ProjectFile::open(path);
        ASSERT_TRUE(writer) << writer.error().sentence();
        ASSERT_TRUE(writer->append_run(sample_run(2), sample_project()));
    }
    ASSERT_TRUE(file->append_run(sample_run(3), sample_project()));
    EXPECT_EQ(reader->runs()->size(), 3u);
}

TEST_F(WriteAhead, LastToCloseLeavesOneFile) {
    {
        auto second = ProjectFile::open(path);
        ASSERT_TRUE(second);
        file.reset();
        EXPECT_TRUE(fs::exists(path.string() + "-wal"));
        ASSERT_TRUE(second->append_run(sample_run(2), sample_project()));
    }
    for (const char* suffix : {"-wal", "-shm", "-journal"}) EXPECT_FALSE(fs::exists(path.string() + suffix));
    // No log is needed to read it: a folder without write permission is enough.
    const std::string bytes = file_bytes(path);
    EXPECT_EQ(bytes.substr(18, 2), std::string("\1\1")) << "the header still asks for a log";
    EXPECT_EQ(runs_in(path), 2u);
}

TEST_F(WriteAhead, FileAloneIsWholeAfterCheckpointAndSave) {
    file->checkpoint();
    fs::copy_file(path, folder / "b.seam");
    EXPECT_EQ(runs_in(folder / "b.seam"), 1u);
    Project edited = sample_project();
    edited.name = "edited";
    ASSERT_TRUE(file->save(edited));
    fs::copy_file(path, folder / "c.seam");
    EXPECT_EQ(ProjectFile::open(folder / "c.seam")->load()->name, "edited");
}

TEST_F(WriteAhead, CopyHoldsWhatIsStillInTheLog) {
    const fs::path other = folder / "other.seam";
    ASSERT_TRUE(file->copy_to(other));
    ASSERT_TRUE(file->copy_to(other)) << "a project file there is replaced";
    EXPECT_EQ(runs_in(other), 1u);
    EXPECT_TRUE(ProjectFile::open(other)->check().empty());
    std::ofstream(folder / "note.txt") << "mine";
    EXPECT_FALSE(file->copy_to(folder / "note.txt"));
    EXPECT_EQ(file_bytes(folder / "note.txt"), "mine");
}

TEST_F(WriteAhead, FileInUseIsNotReplaced) {
    auto replaced = ProjectFile::create(path, Project{}, true);
    ASSERT_FALSE(replaced);
    EXPECT_THAT(replaced.error().sentence(), HasSubstr("another program works with the file"));
    EXPECT_EQ(file->runs()->size(), 1u);
    file.reset();
    EXPECT_TRUE(ProjectFile::create(path, Project{}, true));
    EXPECT_EQ(runs_in(path), 0u);
}

TEST_F(WriteAhead, LogOfADeletedFileNeverMeetsItsSuccessor) {
    fs::copy_file(path.string() + "-wal", folder / "kept");
    file.reset();
    fs::remove(path);
    fs::copy_file(folder / "kept", path.string() + "-wal");
    ASSERT_TRUE(ProjectFile::create(path, Project{}));
    EXPECT_EQ(runs_in(path), 0u);
    EXPECT_TRUE(ProjectFile::open(path)->load()->spots.empty());
}

TEST(Kill, EveryCommittedRunSurvives) {
    kill_while_appending(20, 1, false);
}

TEST(Kill, EveryCommittedRunSurvivesInTheWriteAheadLog) {
    kill_while_appending(20, 3, true);
}

TEST(Kill, WhileCreating) {
    for (unsigned i = 0; i < 20; ++i) {
        TemporaryFolder folder;
        const fs::path path = folder / "a.seam";
        const pid_t child = fork();
        if (child == 0) {
            (void)ProjectFile::create(path, sample_project());
            _exit(0);
        }
        usleep(500 + 1500 * i);
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        if (!fs::exists(path)) continue;
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_EQ(file->load()->spots.size(), 6u);
    }
}

}  // namespace
}  // namespace seamwright
