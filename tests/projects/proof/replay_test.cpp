#include "projects/proof/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "tests/projects/file/replay_store.h"

namespace seamwright {
namespace {

TEST(Replay, ReproducesEveryBit) {
    TemporaryFolder folder;
    store_runs(folder / "a.seam", 20, 10);
    expect_reproduced(folder / "a.seam", 20, 10);
    ReplayOptions one;
    one.run = 7;
    EXPECT_EQ(replay(folder / "a.seam", one)->runs, 1);
    one.run = 99;
    EXPECT_FALSE(replay(folder / "a.seam", one));
    one.run = 0;
    one.jobs = 0;
    EXPECT_FALSE(replay(folder / "a.seam", one));
    std::stop_source stop;
    stop.request_stop();
    ReplayOptions cancelled;
    cancelled.cancel = stop.get_token();
    EXPECT_TRUE(replay(folder / "a.seam", cancelled)->cancelled);
}

// The smallest change of what is stored must show.
TEST(Replay, FindsASingleChangedBit) {
    TemporaryFolder folder;
    const auto path = folder / "a.seam";
    store_runs(path, 4, 6);
    {
        auto file = ProjectFile::open(path);
        auto run = file->load_run(2);
        double& x = run->spots[3].measured_mm.x();
        x = std::nextafter(x, 1e9);
        run->regions[0].correction->rms_mm = std::nextafter(run->regions[0].correction->rms_mm, 1e9);
        ASSERT_TRUE(file->append_run(*run, *file->load_run_setup(2)));
    }
    for (const int jobs : {1, 2}) {
        ReplayOptions options;
        options.jobs = jobs;
        auto result = replay(path, options);
        ASSERT_TRUE(result);
        ASSERT_EQ(result->differences.size(), 2u);
        EXPECT_EQ(result->differences[0].run, 5);
        EXPECT_EQ(result->differences[0].what, "spot S4");
        EXPECT_GT(result->differences[0].size_mm, 0);
        EXPECT_EQ(result->differences[1].what, "region inner");
    }
}

// Another setup gives other results: the replay really computes.
TEST(Replay, UsesTheSetupOfTheRun) {
    TemporaryFolder folder;
    store_runs(folder / "a.seam", 2, 6);
    auto file = ProjectFile::open(folder / "a.seam");
    auto run = file->load_run(1);
    Project other = *file->load_run_setup(1);
    other.calibrations[0].flange_from_sensor.translation().x() += 1;
    auto again = recompute(*run, other);
    ASSERT_TRUE(again);
    EXPECT_FALSE(compare(*run, *again).empty());
}

TEST(Replay, DamagedRawDataIsAnError) {
    TemporaryFolder folder;
    const auto path = folder / "a.seam";
    store_runs(path, 3, 6);
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &db), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(db, "UPDATE captures SET data = zeroblob(length(data)) WHERE run = 2", nullptr,
                           nullptr, nullptr),
              SQLITE_OK);
    sqlite3_close(db);
    ReplayOptions options;
    options.jobs = 2;
    auto result = replay(path, options);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::file);
}

}  // namespace
}  // namespace seamwright
