#include "tests/projects/file/kill_test.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <signal.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "projects/file/project_file.h"
#include "projects/file/row_checksum.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

struct Commit {
    std::int64_t runs = 0, revision = 0;
};

[[noreturn]] void append_forever(const std::filesystem::path& path, int pipe, Commit at, bool write_ahead) {
    auto file = ProjectFile::open(path);
    if (!file) _exit(3);
    if (write_ahead) file->keep_write_ahead(true);
    auto project = file->load();
    if (!project) _exit(4);
    for (;;) {
        const RunRecord run = sample_run(static_cast<unsigned>(at.runs + 1), 6, 500);
        if (!file->append_run(run, *project)) _exit(5);
        ++at.runs;
        if (write(pipe, &at, sizeof at) != sizeof at) _exit(6);
        ++at.revision;
        project->name = std::to_string(at.revision);
        project->spots[0].reference_profile.x_mm[0] = static_cast<double>(at.revision);
        if (!file->save(*project)) _exit(7);
        if (write(pipe, &at, sizeof at) != sizeof at) _exit(6);
    }
}

}  // namespace

void kill_while_appending(int kills, unsigned seed, bool write_ahead) {
    TemporaryFolder folder;
    const std::filesystem::path path = folder / "a.seam";
    Project project = sample_project();
    project.name = "0";
    ASSERT_TRUE(ProjectFile::create(path, project));
    std::mt19937 rng(seed);
    Commit committed;
    int found_journals = 0;
    unsigned patience = 1;  // grows where a busy machine lets no child come to its first commit
    for (int i = 0; i < kills; ++i) {
        int ends[2];
        ASSERT_EQ(pipe(ends), 0);
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            close(ends[0]);
            append_forever(path, ends[1], committed, write_ahead);
        }
        close(ends[1]);
        usleep(patience * (2000 + rng() % 120000));
        kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself with " << WEXITSTATUS(status);
        Commit last;
        bool any = false;
        while (read(ends[0], &last, sizeof last) == sizeof last) committed = last, any = true;
        constexpr unsigned kMostPatience = 16;
        if (!any) patience = std::min(2 * patience, kMostPatience);
        close(ends[0]);

        found_journals += std::filesystem::exists(path.string() + (write_ahead ? "-wal" : "-journal"));
        // Every other time through a read-only opening, which must heal the file too.
        auto file = ProjectFile::open(path, i % 2 ? FileAccess::read_only : FileAccess::read_write);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_FALSE(std::filesystem::exists(path.string() + "-wal")) << "the log was not taken in";
        const auto runs = file->runs();
        ASSERT_TRUE(runs) << runs.error().sentence();
        const auto count = static_cast<std::int64_t>(runs->size());
        EXPECT_GE(count, committed.runs);
        EXPECT_LE(count, committed.runs + 1);
        auto loaded = file->load();
        ASSERT_TRUE(loaded) << loaded.error().sentence();
        const std::int64_t revision = std::stoll(loaded->name);
        EXPECT_GE(revision, committed.revision);
        EXPECT_LE(revision, committed.revision + 1);
        if (revision > 0) {
            EXPECT_EQ(loaded->spots[0].reference_profile.x_mm[0], static_cast<double>(revision))
                << "half an edit";
        }
        if (count > 0) {
            const auto run = file->load_run(count);
            ASSERT_TRUE(run) << run.error().sentence();
            const RunRecord expected = sample_run(static_cast<unsigned>(count), 6, 500);
            ASSERT_EQ(run->captures.size(), expected.captures.size());
            for (std::size_t k = 0; k < expected.captures.size(); ++k)
                EXPECT_TRUE(same_bits(run->captures[k], expected.captures[k]));
        }
        committed = {count, revision};
    }
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file);
    for (const Error& finding : file->check()) ADD_FAILURE() << finding.sentence();
    EXPECT_GT(committed.runs, kills / 4) << "the children were killed before they did anything";
    testing::Test::RecordProperty("kills_with_open_transaction", found_journals);
}

void set_blob_checksum(std::vector<std::byte>& blob) {
    const auto crc = static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(blob.data()) + 16, blob.size() - 16));
    std::memcpy(blob.data() + 12, &crc, 4);
}

void seal_all_rows(const std::filesystem::path& path) {
    auto db = Database::open(path.string(), SQLITE_OPEN_READWRITE).value();
    for (const ChecksummedTable& table : checksummed_tables())
        EXPECT_TRUE(
            db.execute(fmt::format("UPDATE {} SET checksum = row_checksum({})", table.name, table.columns)))
            << table.name;
}

void make_old_version(const std::filesystem::path& path, int version) {
    const std::string sql = file_bytes(std::filesystem::path(SEAMWRIGHT_TEST_DATA) /
                                       ("version" + std::to_string(version) + ".sql"));
    ASSERT_FALSE(sql.empty());
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
    char* message = nullptr;
    EXPECT_EQ(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, &message), SQLITE_OK) << message;
    sqlite3_free(message);
    sqlite3_close(db);
}

}  // namespace seamwright
