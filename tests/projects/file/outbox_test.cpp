// Which runs wait for a fleet's database.

#include <gtest/gtest.h>

#include "projects/file/project_file.h"
#include "projects/file/schema.h"
#include "tests/projects/file/kill_test.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

std::vector<QueuedRun> queued(const ProjectFile& file, std::int64_t after = 0, std::int64_t most = 100) {
    const auto runs = file.queued_runs(after, most);
    EXPECT_TRUE(runs) << (runs ? "" : runs.error().sentence());
    return runs.value_or(std::vector<QueuedRun>());
}

TEST(Outbox, ARunIsQueuedWhenItIsFinishedAndWheneverItChanges) {
    TemporaryFolder folder;
    const Project project = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", project).value();
    RunRecord run = sample_run(1);
    const std::string finished = run.finished_utc;
    run.finished_utc.clear();
    run.number = file.begin_run(run, RunSetup::of(project).value()).value();
    EXPECT_TRUE(queued(file).empty());
    run.finished_utc = finished;
    ASSERT_TRUE(file.finish_run(run, {}));
    const auto first = queued(file);
    ASSERT_EQ(first.size(), 1u);
    EXPECT_EQ(first[0].run, run.number);
    EXPECT_EQ(first[0].id.size(), 64u);
    EXPECT_EQ(first[0].message, "");
    // Confirmed after it changed once more: it stays queued, under the same id.
    ASSERT_TRUE(file.keep_message(first[0], "{}"));
    EXPECT_EQ(queued(file)[0].message, "{}");
    ASSERT_TRUE(file.update_run(run));
    ASSERT_TRUE(file.published(first));
    const auto second = queued(file);
    ASSERT_EQ(second.size(), 1u);
    EXPECT_GT(second[0].revision, first[0].revision);
    EXPECT_EQ(second[0].id, first[0].id);
    EXPECT_EQ(second[0].message, "") << "the kept one says what was";
    ASSERT_TRUE(file.keep_message(first[0], "old")) << "without effect";
    EXPECT_EQ(queued(file)[0].message, "");
    ASSERT_TRUE(file.published(second));
    EXPECT_EQ(file.queued().value(), 0);
    EXPECT_TRUE(file.check().empty());
}

TEST(Outbox, OldestFirstAndAFewAtATime) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", sample_project()).value();
    for (unsigned i = 0; i < 7; ++i) ASSERT_TRUE(file.append_run(sample_run(i), sample_project()));
    EXPECT_EQ(file.queued().value(), 7);
    std::set<std::string> ids;
    std::vector<std::int64_t> numbers;
    for (std::int64_t after = 0;;) {
        const auto some = queued(file, after, 3);
        if (some.empty()) break;
        EXPECT_LE(some.size(), 3u);
        for (const QueuedRun& run : some) {
            numbers.push_back(run.run);
            ids.insert(run.id);
        }
        after = some.back().run;
    }
    EXPECT_EQ(numbers, (std::vector<std::int64_t>{1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(ids.size(), 7u);
}

TEST(Outbox, OnlyAKeptMessageOutlivesItsRun) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", sample_project()).value();
    for (unsigned i = 0; i < 2; ++i) ASSERT_TRUE(file.append_run(sample_run(i), sample_project()));
    const auto all = queued(file);
    ASSERT_TRUE(file.keep_message(all[1], "{\"kept\": 1}"));
    ASSERT_TRUE(file.delete_run(1));
    ASSERT_TRUE(file.delete_run(2));
    const auto left = queued(file);
    ASSERT_EQ(left.size(), 1u);
    EXPECT_EQ(left[0].run, 2);
    EXPECT_EQ(left[0].id, all[1].id);
    EXPECT_EQ(left[0].message, "{\"kept\": 1}");
    EXPECT_TRUE(file.check().empty());
}

TEST(Outbox, OlderFilesQueueWhatTheyHold) {
    for (int version = 1; version < current_version(); ++version) {
        TemporaryFolder folder;
        make_old_version(folder / "old.seam", version);
        auto file = ProjectFile::open(folder / "old.seam");
        ASSERT_TRUE(file) << version << file.error().sentence();
        std::size_t finished = 0;
        const auto runs = file->runs().value();
        for (const RunSummary& run : runs) finished += !run.finished_utc.empty();
        const auto all = queued(*file);
        EXPECT_EQ(all.size(), finished) << version;
        EXPECT_GT(all.size(), 0u) << version;
        ASSERT_TRUE(file->published(all));
        EXPECT_EQ(file->queued().value(), 0);
        EXPECT_TRUE(file->check().empty()) << version;
    }
}

TEST(Outbox, AFlippedBitIsNoticed) {
    TemporaryFolder folder;
    {
        auto file = ProjectFile::create(folder / "a.seam", sample_project()).value();
        ASSERT_TRUE(file.append_run(sample_run(1), sample_project()));
    }
    ASSERT_TRUE(Database::open((folder / "a.seam").string(), SQLITE_OPEN_READWRITE)
                    ->execute("UPDATE outbox SET revision = revision + 1"));
    EXPECT_FALSE(ProjectFile::open(folder / "a.seam"));
}

}  // namespace
}  // namespace seamwright
