#include "projects/file/row_checksum.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "projects/file/project_file.h"
#include "projects/file/schema.h"
#include "tests/projects/file/flipped_bits_test.h"
#include "tests/projects/file/kill_test.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(FlippedBits, OfTheFileAreNoticedOrHarmless) {
    flip_bits_of_the_file(150, 1, 14);
}

TEST(FlippedBits, OfEveryColumnAreNoticedWhenTheFileIsOpened) {
    flip_bits_of_the_rows(250, 2);
}

TEST(RowChecksum, CoversEveryColumnOfEveryTableButDataWithItsOwn) {
    auto db = Database::open(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE).value();
    ASSERT_TRUE(migrate(db));
    auto tables =
        db.prepare("SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%'")
            .value();
    std::set<std::string> names;
    while (tables.step().value()) names.insert(tables.text(0));
    EXPECT_EQ(names.erase("captures") + names.erase("images"), 2u);
    EXPECT_EQ(names.erase("chain"), 1u) << "its entries hold their own hashes";
    for (const ChecksummedTable& table : checksummed_tables()) {
        EXPECT_EQ(names.erase(table.name), 1u) << table.name;
        auto columns = db.prepare(fmt::format("SELECT group_concat(name, ', ') FROM pragma_table_info('{}')",
                                              table.name))
                           .value();
        ASSERT_TRUE(columns.step().value());
        EXPECT_EQ(columns.text(0), std::string(table.columns) + ", checksum") << table.name;
    }
    EXPECT_THAT(names, testing::IsEmpty()) << "tables without checksums";
}

TEST(RowChecksum, TellsValuesApartThatLookAlike) {
    auto db = Database::open(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE).value();
    std::set<std::int64_t> sums;
    const char* rows[] = {"'ab', 'c'", "'a', 'bc'", "'abc', ''", "'', 'abc'", "'abc'",
                          "x'616263'", "NULL",      "0",         "''",        "x''",
                          "1",         "-1",        "'1'",       "NULL, NULL"};
    for (const char* row : rows) sums.insert(db.integer(fmt::format("SELECT row_checksum({})", row)).value());
    EXPECT_EQ(sums.size(), std::size(rows));
}

TEST(RowChecksum, OlderFilesGetThemWhenTheyAreOpened) {
    for (int version = 1; version < current_version(); ++version) {
        const TemporaryFolder folder;
        const fs::path path = folder / "old.seam";
        make_old_version(path, version);
        ASSERT_TRUE(ProjectFile::open(path, FileAccess::read_only)) << version;
        ASSERT_TRUE(ProjectFile::open(path)) << version;
        auto db = Database::open(path.string(), SQLITE_OPEN_READWRITE).value();
        EXPECT_EQ(db.integer("PRAGMA user_version").value(), current_version());
        for (const ChecksummedTable& table : checksummed_tables())
            EXPECT_TRUE(check_rows(db, table.name)) << table.name;
        ASSERT_TRUE(db.execute("UPDATE regions SET body = replace(body, '2', '3')"));
        const auto file = ProjectFile::open(path);
        ASSERT_FALSE(file);
        EXPECT_THAT(file.error().sentence(), HasSubstr("checksum"));
        EXPECT_THAT(file.error().sentence(), HasSubstr("regions"));
    }
}

}  // namespace
}  // namespace seamwright
