// Ten stations with a hundred thousand parts each: the statistics, and how long they take.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>

#include "projects/fleet/fleet_board.h"
#include "projects/fleet/fleet_schema.h"
#include "projects/fleet/fleet_statistics.h"
#include "projects/fleet/publish.h"
#include "tests/projects/fleet/postgres_server.h"
#include "tests/projects/statistics/production_runs.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begun) {
    return std::chrono::duration<double>(Clock::now() - begun).count();
}

// Run `number` of a station, made by the database of its first one: other values, another time.
constexpr const char* kMore = R"sql(
WITH first AS (SELECT r.*, x.measurands, x.region FROM seamwright.run r JOIN seamwright.result x ON x.run = r.id WHERE r.station = $1
               ORDER BY r.id LIMIT 1),
made AS (
    INSERT INTO seamwright.run (uid, revision, station, setup, number, made_with, part, type, started, finished, cycle_ms, push,
        status, purpose, message_key, message)
    SELECT sha256(convert_to($1 || ' ' || n, 'UTF8')), 1, station, setup, n, made_with, 'car ' || n, type,
        started + n * interval '1 minute', finished + n * interval '1 minute', 9000 + (n * 7919) % 2000, push,
        CASE WHEN n % 50 = 0 THEN 'refused' ELSE 'ok' END, 0, message_key, message
    FROM first, generate_series(2, 100000) AS n
    RETURNING id, number, station, started, type)
INSERT INTO seamwright.result (run, position, station, started, type, production, panel, region, passed, status, used, numbers, sigma,
    measurands, vals)
SELECT m.id, 0, m.station, m.started, m.type, true, false, f.region, m.number % 50 <> 0,
    CASE WHEN m.number % 50 = 0 THEN 'under_determined' ELSE 'ok' END, m.number % 50 <> 0, v.vals[1:6], NULL, f.measurands, v.vals
FROM made m CROSS JOIN first f JOIN seamwright.measurands k ON k.id = f.measurands CROSS JOIN LATERAL (
    SELECT array_agg(0.1 * (random() + random() + random() + random() - 2) + 0 * k_th + 0 * m.number) AS vals
    FROM generate_series(1, cardinality(k.keys)) AS k_th) AS v
)sql";

// Without what keeps the runs' sums, in the schema that had those of closed days.
constexpr const char* kOfBefore = R"sql(
DROP TABLE seamwright.hour_sums, seamwright.hour_counts, seamwright.day_runs, seamwright.day_cycles, seamwright.day_refusals,
    seamwright.day_unmeasured;
DROP INDEX seamwright.run_newest, seamwright.refusal_by_time, seamwright.unmeasured_by_time;
CREATE INDEX run_by_time ON seamwright.run (station, started DESC);
CREATE TABLE seamwright.station_day (station int NOT NULL, day date NOT NULL, done boolean NOT NULL, PRIMARY KEY (station, day));
DELETE FROM seamwright.migration WHERE version > 1;
)sql";
constexpr int kMoreParts = 2000;

TEST(FleetMillion, StatisticsOfAMillionParts) {
    std::string why;
    const auto server = PostgresServer::start(why);
    if (!server) GTEST_SKIP() << "skipped: " << why;
    const FleetTarget target = FleetTarget::from(server->uri()).value();
    ASSERT_TRUE(init_fleet(target));
    TemporaryFolder folder;
    Project project = production_project();
    std::vector<std::filesystem::path> files;
    for (int station = 1; station <= 10; ++station) {
        const auto path = folder / fmt::format("{}.seam", station);
        auto file = ProjectFile::create(path, project).value();
        ASSERT_TRUE(file.append_run(production_run(0, {0.1, 0, 0}), project));
        ASSERT_TRUE(publish_file(file, target, {fmt::format("station {}", station)}));
        std::string more = kMore;
        for (auto at = more.find("$1"); at != std::string::npos; at = more.find("$1", at))
            more.replace(at, 2, std::to_string(station));
        server->ask(more);
        files.push_back(path);
    }
    server->ask(
        "INSERT INTO seamwright.refusal SELECT id, 0, station, started, type, true, false, 'edge', 'sigma "
        "{:.3f} mm', 'sigma 0.250 "
        "mm', 'sigma 0.250 mm' FROM seamwright.run WHERE status = 'refused'");
    // As a database of before, whose sums are made once for all.
    server->ask("VACUUM ANALYZE");
    auto begun = Clock::now();
    server->ask(kOfBefore);
    ASSERT_TRUE(init_fleet(target));
    fmt::print("sums of all runs made in {:.1f} s\n", seconds_since(begun));
    server->ask("VACUUM ANALYZE");
    // The next parts of each station: one by one, as a watching sends them, and in one go.
    begun = Clock::now();
    for (int station = 1; station <= 10; ++station) {
        auto file = ProjectFile::open(files[static_cast<std::size_t>(station - 1)]).value();
        ASSERT_TRUE(file.append_run(production_run(100'001, {0.1, 0, 0}), project));
        const auto done = publish_file(file, target, {fmt::format("station {}", station)});
        ASSERT_TRUE(done) << done.error().sentence();
    }
    fmt::print("one part of each of ten stations, files opened, published in {:.2f} s\n",
               seconds_since(begun));
    {
        auto file = ProjectFile::create(folder / "more.seam", project).value();
        for (int i = 0; i < kMoreParts; ++i)
            ASSERT_TRUE(file.append_run(production_run(100'010 + i, {0.1, 0, 0}), project));
        begun = Clock::now();
        const auto done = publish_file(file, target, {"station 1"});
        ASSERT_TRUE(done) << done.error().sentence();
        ASSERT_EQ(done->runs, kMoreParts);
        fmt::print("published in one go: {:.0f} parts a second\n", kMoreParts / seconds_since(begun));
    }
    const auto last_week = production_run(93'000, {}).started_utc;
    for (const auto& [since, tolerance_mm] :
         {std::pair<std::string, double>{"", 1.0}, {last_week, 1.0}, {"", 0.2}, {"", 1.0}}) {
        FleetStatisticsOptions options;
        options.statistics.runs.since_utc = since;
        options.statistics.tolerance_mm = tolerance_mm;  // 0.2: a good part of all values lies beyond
        begun = Clock::now();
        const auto s = fleet_statistics(target, options);
        ASSERT_TRUE(s) << s.error().sentence();
        fmt::print("{} parts, {} characteristics: {:.2f} s\n", s->parts,
                   s->regions.front().characteristics.size(), seconds_since(begun));
        if (!since.empty()) continue;
        ASSERT_EQ(s->parts, 1'000'010u + kMoreParts);
        EXPECT_EQ(s->regions.front().characteristics.front().summary.n, 980'010 + kMoreParts);
        EXPECT_NEAR(s->regions.front().characteristics.front().summary.s, 0.1 * std::sqrt(4 / 12.0), 1e-3);
        ASSERT_EQ(s->regions.front().refusals.size(), 1u);
        EXPECT_EQ(s->regions.front().refusals.front().count, 20'000);
    }
    begun = Clock::now();
    ASSERT_EQ(fleet_standing(target, 30)->stations.size(), 10u);
    fmt::print("status: {:.2f} s\n", seconds_since(begun));
}

}  // namespace
}  // namespace seamwright
