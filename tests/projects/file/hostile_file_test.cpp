// Files that somebody else made, cut off or changed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/capture/sqlite.h"
#include "projects/file/project_file.h"
#include "tests/projects/file/kill_test.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

void expect_refused(const fs::path& path, const char* words) {
    for (const FileAccess access : {FileAccess::read_only, FileAccess::read_write}) {
        auto file = ProjectFile::open(path, access);
        ASSERT_FALSE(file) << path;
        EXPECT_EQ(file.error().kind, ErrorKind::file);
        EXPECT_THAT(file.error().sentence(), HasSubstr(words));
        EXPECT_THAT(file.error().sentence(), HasSubstr(path.filename().string()));
    }
}

class HostileFile : public testing::Test {
  protected:
    void SetUp() override {
        auto file = ProjectFile::create(path, sample_project());
        ASSERT_TRUE(file);
        ASSERT_TRUE(file->append_run(sample_run(1), sample_project()));
    }
    void sql(const std::string& text) {
        sqlite3* db = nullptr;
        ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
        char* message = nullptr;
        EXPECT_EQ(sqlite3_exec(db, text.c_str(), nullptr, nullptr, &message), SQLITE_OK) << message;
        sqlite3_free(message);
        sqlite3_close(db);
    }
    TemporaryFolder folder;
    fs::path path = folder / "a.seam";
};

TEST_F(HostileFile, ForeignEmptyMissing) {
    expect_refused(folder / "missing.seam", "does not exist");
    write_bytes(folder / "empty.seam", "");
    expect_refused(folder / "empty.seam", "empty");
    write_bytes(folder / "text.seam", "hello\n");
    expect_refused(folder / "text.seam", "no project file");
    write_bytes(folder / "long.seam", std::string(100000, 'x'));
    expect_refused(folder / "long.seam", "no project file");
    write_bytes(folder / "zero.seam", std::string(8192, '\0'));
    expect_refused(folder / "zero.seam", "no project file");
    fs::create_directory(folder / "folder.seam");
    expect_refused(folder / "folder.seam", "no file");
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open((folder / "other.seam").c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, "CREATE TABLE t(x)", nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(db);
    expect_refused(folder / "other.seam", "another program's");
}

TEST_F(HostileFile, NewerVersion) {
    sql("PRAGMA user_version = 9999");
    expect_refused(path, "newer Seamwright");
}

TEST_F(HostileFile, NegativeVersion) {
    sql("PRAGMA user_version = -5");
    expect_refused(path, "no valid version");
}

TEST_F(HostileFile, PlantedTriggerOrView) {
    sql("CREATE TRIGGER evil AFTER INSERT ON runs BEGIN DELETE FROM events; END");
    expect_refused(path, "tables");
    sql("DROP TRIGGER evil; CREATE VIEW evil AS SELECT * FROM runs");
    expect_refused(path, "tables");
    sql("DROP VIEW evil; DROP TABLE events");
    expect_refused(path, "tables");
}

TEST_F(HostileFile, BrokenReference) {
    sql("PRAGMA foreign_keys = OFF; INSERT INTO run_spots VALUES (55, 0, 'S1', 'measured', '{}', 0)");
    expect_refused(path, "not there");
}

TEST_F(HostileFile, TruncatedAtManyLengths) {
    const std::string whole = file_bytes(path);
    std::mt19937 rng(3);
    std::vector<std::size_t> lengths{
        1, 15, 16, 99, 100, 511, 512, 4095, 4096, 4097, whole.size() - 1, whole.size() - 4096};
    for (int i = 0; i < 60; ++i) lengths.push_back(1 + rng() % (whole.size() - 1));
    for (const std::size_t length : lengths) {
        write_bytes(folder / "cut.seam", whole.substr(0, length));
        auto file = ProjectFile::open(folder / "cut.seam");
        ASSERT_FALSE(file) << "of " << whole.size() << " bytes " << length;
        EXPECT_EQ(file.error().kind, ErrorKind::file);
    }
}

TEST_F(HostileFile, WrongValuesInColumns) {
    const auto load_fails = [&](const std::string& change, const char* words) {
        const std::string before = file_bytes(path);
        sql(change);
        expect_refused(path, "checksum");
        seal_all_rows(path);  // as somebody does who means it
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        auto project = file->load();
        EXPECT_FALSE(project) << change;
        if (!project) {
            EXPECT_EQ(project.error().kind, ErrorKind::file);
            EXPECT_THAT(project.error().sentence(), HasSubstr(words));
        }
        EXPECT_FALSE(file->check().empty());
        write_bytes(path, before);
    };
    load_fails("UPDATE spots SET body = 'x' WHERE id = 'S2'", "cannot be read");
    load_fails("UPDATE spots SET body = '[]' WHERE id = 'S2'", "an object was expected");
    load_fails("UPDATE spots SET body = '{\"id\":\"S9\"}' WHERE id = 'S2'", "another's id");
    load_fails("UPDATE spots SET body = json_set(body, '$.sigma_mm', 'abc') WHERE id = 'S2'", "sigma_mm");
    load_fails(
        "UPDATE spots SET body = json_set(body, '$.base_from_flange.matrix[0][0]', 'nan') WHERE id = 'S2'",
        "base_from_flange");
    load_fails("UPDATE spots SET body = json_set(body, '$.base_from_flange.matrix[0][0]', 7) WHERE id = 'S2'",
               "orthonormal");
    load_fails("UPDATE spots SET body = json_set(body, '$.surprise', 7) WHERE id = 'S2'", "surprise");
    load_fails("UPDATE sensors SET body = json_set(body, '$.peaks.per_line', 99999999999)", "out of range");
    load_fails("UPDATE sensors SET body = json_set(body, '$.peaks.method', 'guess')", "not known");
    load_fails("UPDATE spots SET body = zeroblob(0) || '' WHERE id = 'S2'", "cannot be read");
    load_fails("UPDATE spots SET body = replace(hex(zeroblob(500000)), '00', '[') WHERE id = 'S2'",
               "cannot be read");
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    load_fails("UPDATE sensors SET body = replace(body, '\"settings\":', '\"settings\":" + deep + ",\"x\":')",
               "cannot be read");
    load_fails("UPDATE spots SET reference_profile = x'00' WHERE id = 'S2'", "no block of profiles");
    load_fails("UPDATE spots SET reference_profile = substr(reference_profile, 1, 500) WHERE id = 'S2'",
               "checksum");
    load_fails("UPDATE spots SET reference_profile = (SELECT data FROM captures) WHERE id = 'S2'",
               "another kind");
}

// What has the right checksums is not deep all the same: no reader may follow it to the bottom of its stack.
TEST_F(HostileFile, DeepJsonInTheRowsOfARun) {
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    const std::string before = file_bytes(path);
    for (const char* table : {"setups", "run_spots", "run_regions"}) {
        sql(fmt::format("UPDATE {} SET body = '{}'", table, "{\"id\":" + deep + "}"));
        seal_all_rows(path);
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file) << file.error().sentence();
        EXPECT_FALSE(file->load_run(1) && file->load_run_setup(1)) << table;
        EXPECT_FALSE(file->check().empty()) << table;
        write_bytes(path, before);
    }
}

TEST_F(HostileFile, DamagedRunIsRefusedAlone) {
    {
        auto file = ProjectFile::open(path);
        ASSERT_TRUE(file->append_run(sample_run(2), sample_project()));
    }
    sql("UPDATE captures SET data = CAST(substr(data, 1, 100) || x'42' || substr(data, 102) AS BLOB) WHERE "
        "run = 1");
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file);
    EXPECT_FALSE(file->load_run(1));
    EXPECT_TRUE(file->load_run(1, false));
    EXPECT_TRUE(file->load_run(2));
    EXPECT_THAT(file->load_run(1).error().sentence(), HasSubstr("checksum"));
    EXPECT_EQ(file->check().size(), 2u) << "the chain says so too";
}

}  // namespace
}  // namespace seamwright
