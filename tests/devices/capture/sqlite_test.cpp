// Statements kept for another use answer as new ones would.

#include "devices/capture/sqlite.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "tests/devices/capture/capture_frames.h"

namespace seamwright {
namespace {

class Sqlite : public testing::Test {
  protected:
    const std::filesystem::path path = capture_test::fresh_path("a.db");
    ~Sqlite() override { std::filesystem::remove(path); }
    Database open() {
        auto db = Database::open(path.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
        EXPECT_TRUE(db);
        EXPECT_TRUE(db->execute("CREATE TABLE IF NOT EXISTS t (a, b)"));
        return std::move(*db);
    }
    static std::int64_t count(Database& db, const char* where) {
        return db.integer(std::string("SELECT count(*) FROM t WHERE ") + where).value_or(-1);
    }
};

TEST_F(Sqlite, AStatementUsedAgainHasNoneOfItsValues) {
    Database db = open();
    constexpr const char* kInsert = "INSERT INTO t VALUES (?, ?)";
    {
        const std::vector<std::byte> blob(100, std::byte{7});
        auto s = db.prepare(kInsert);
        ASSERT_TRUE(s);
        s->bind(1, std::span<const std::byte>(blob));
        s->bind(2, std::int64_t{5});
        ASSERT_TRUE(s->run());
    }  // the blob is gone
    auto s = db.prepare(kInsert);
    ASSERT_TRUE(s);
    ASSERT_TRUE(s->run());
    EXPECT_EQ(count(db, "b = 5"), 1);
    EXPECT_EQ(count(db, "a IS NULL AND b IS NULL"), 1);
}

TEST_F(Sqlite, TwoOfTheSameSqlDoNotDisturbEachOther) {
    Database db = open();
    ASSERT_TRUE(db.execute("INSERT INTO t VALUES (1, 1), (2, 2), (3, 3)"));
    for (int round = 0; round < 3; ++round) {
        auto outer = db.prepare("SELECT a FROM t ORDER BY a");
        ASSERT_TRUE(outer);
        std::int64_t expected = 0;
        while (outer->step().value()) {
            EXPECT_EQ(outer->integer(0), ++expected);
            auto inner = db.prepare("SELECT a FROM t ORDER BY a");
            ASSERT_TRUE(inner);
            ASSERT_TRUE(inner->step().value());
            EXPECT_EQ(inner->integer(0), 1);
        }
        EXPECT_EQ(expected, 3);
    }
}

TEST_F(Sqlite, OneLeftInTheMiddleStartsAnewAndHoldsNoLock) {
    Database db = open();
    ASSERT_TRUE(db.execute("INSERT INTO t VALUES (1, 1), (2, 2)"));
    {
        auto s = db.prepare("SELECT a FROM t ORDER BY a");
        ASSERT_TRUE(s->step().value());
    }
    Database other = open();
    EXPECT_TRUE(other.execute("INSERT INTO t VALUES (3, 3)"));
    auto s = db.prepare("SELECT a FROM t ORDER BY a");
    ASSERT_TRUE(s->step().value());
    EXPECT_EQ(s->integer(0), 1);
}

TEST_F(Sqlite, AChangedTableIsSeen) {
    Database db = open();
    ASSERT_TRUE(db.execute("INSERT INTO t VALUES (1, 1)"));
    { ASSERT_TRUE(db.prepare("SELECT * FROM t")->step().value()); }
    ASSERT_TRUE(db.execute("DROP TABLE t; CREATE TABLE t (c); INSERT INTO t VALUES ('new')"));
    auto s = db.prepare("SELECT * FROM t");
    ASSERT_TRUE(s);
    ASSERT_TRUE(s->step().value());
    EXPECT_EQ(s->text(0), "new");
    ASSERT_TRUE(db.execute("INSERT INTO t VALUES ('x')"));
    s->reset();
    ASSERT_TRUE(db.execute("DROP TABLE t"));
    EXPECT_FALSE(db.prepare("SELECT * FROM t")) << "there is no such table any more";
}

TEST_F(Sqlite, AStatementMayOutliveItsDatabase) {
    std::optional<Statement> s;
    {
        Database db = open();
        ASSERT_TRUE(db.execute("INSERT INTO t VALUES (1, 1)"));
        { ASSERT_TRUE(db.prepare("SELECT b FROM t")->step().value()); }
        s = std::move(*db.prepare("SELECT a FROM t"));
        Database moved = std::move(db);
        ASSERT_TRUE(s->step().value());
    }
    EXPECT_EQ(s->integer(0), 1);
    s.reset();
}

}  // namespace
}  // namespace seamwright
