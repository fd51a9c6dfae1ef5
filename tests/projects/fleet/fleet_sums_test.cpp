// What the database keeps added up is what its rows say, whatever was published in whatever order, how often, and by which version.

#include <thread>

#include "tests/projects/fleet/fleet_fixture.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class FleetSums : public Fleet {
  protected:
    // How many rows of the sums are not those of a plain SELECT of all values, of hours or days: SQL.
    static std::string wrong_sums(const std::string& table, const std::string& time,
                                  const std::string& unit) {
        return (
            "WITH v AS (SELECT station, date_trunc('" + unit +
            "', started, 'UTC') AS at, panel, region, type, key, x, extract(epoch FROM started - "
            "date_trunc('day', started, 'UTC'))::float8 / 86400 AS t, run FROM seamwright.result JOIN "
            "seamwright.measurands m ON m.id = measurands CROSS JOIN LATERAL unnest(vals, keys) AS u(x, key) "
            "WHERE "
            "production AND used AND x IS NOT NULL AND started IS NOT NULL), n AS (SELECT v.*, lag(x) OVER r "
            "AS px, "
            "lag(t) OVER r AS pt FROM v WINDOW r AS (PARTITION BY station, at, panel, region, type, key "
            "ORDER BY t, "
            "run)), p AS (SELECT station, at, panel, region, type, key, count(*) AS n, sum(x) AS sx, sum(t) "
            "AS st, "
            "sum(x * t) AS sxt, sum(x ^ 2) AS sxx, min(x) AS low, max(x) AS high, count(px) AS pn, sum(abs(x "
            "- px)) AS "
            "ranges, sum(x * px) AS pxx, sum(x * pt) AS pxt, sum(t * px) AS ptx, sum(t * pt) AS ptt, sum(px) "
            "AS px0, "
            "sum(pt) AS pt0 FROM n GROUP BY 1, 2, 3, 4, 5, 6) SELECT count(*) FROM p FULL JOIN (SELECT "
            "d.*, " +
            time + " AS at FROM seamwright." + table +
            " d) d USING (station, at, panel, region, type, key) WHERE d.n IS DISTINCT FROM p.n OR d.pn IS "
            "DISTINCT "
            "FROM p.pn OR d.lowest <> p.low OR d.highest <> p.high OR greatest(abs(d.sx - p.sx), abs(d.st - "
            "p.st), "
            "abs(d.sxt - p.sxt), abs(d.sxx - p.sxx), abs(d.ranges - p.ranges), abs(d.pxx - p.pxx), abs(d.pxt "
            "- "
            "p.pxt), abs(d.ptx - p.ptx), abs(d.ptt - p.ptt), abs(d.px0 - p.px0), abs(d.pt0 - p.pt0)) > 1e-9");
    }
    static void expect_sums() {
        std::string sql =
            "SELECT 'hour_sums' WHERE 0 <> (" + wrong_sums("hour_sums", "hour", "hour") +
            ") UNION ALL SELECT 'day_sums' WHERE 0 <> (" +
            wrong_sums("day_sums", "day::timestamp AT TIME ZONE 'UTC'", "day") +
            ") UNION ALL SELECT 'vals of ' || hour FROM seamwright.hour_sums WHERE cardinality(vals) <> n "
            "OR vals <> ARRAY(SELECT v FROM unnest(vals) AS v ORDER BY v)";
        const auto same = [&](const std::string& sums, const std::string& rows) {
            std::string name;
            for (const char c : sums) name += c == '\'' ? std::string("''") : std::string(1, c);
            sql += " UNION ALL SELECT '" + name + "' WHERE (SELECT array_agg(t::text) FROM (SELECT " + sums +
                   ") t) IS DISTINCT FROM (SELECT array_agg(t::text) FROM (SELECT " + rows + ") t)";
        };
        for (const char* table : {"day_counts", "hour_counts"})
            same("sum(runs), sum(passed), sum(over_limit), sum(used) FROM seamwright." + std::string(table),
                 "count(*), count(*) FILTER (WHERE passed), count(*) FILTER (WHERE NOT passed AND status = "
                 "'over_limit'), count(*) FILTER (WHERE used) FROM seamwright.result WHERE production");
        same("sum(runs), max(last) FROM seamwright.day_runs", "count(*), max(started) FROM seamwright.run");
        same("status, sum(runs) FROM seamwright.day_runs GROUP BY 1 ORDER BY 1",
             "status, count(*) FROM seamwright.run GROUP BY 1 ORDER BY 1");
        same("coalesce(sum(refusals), 0) FROM seamwright.day_refusals",
             "count(*) FROM seamwright.refusal WHERE production");
        same("coalesce(sum(spots), 0) FROM seamwright.day_unmeasured",
             "count(*) FROM seamwright.unmeasured WHERE production");
        same(
            "sum(runs), round(sum(seconds)) FROM seamwright.day_cycles",
            "count(*), round(sum(cycle_ms / 1e3::float8)) FROM seamwright.run WHERE cycle_ms IS NOT NULL AND "
            "purpose = 0 AND status NOT IN ('cancelled', 'interrupted')");
        EXPECT_EQ(server_->ask(sql), "") << "what differs";
    }
};

// Late parts, parts again, copies that have some of the same runs, outcomes that change.
TEST_F(FleetSums, AreThoseOfTheRowsInWhateverOrderTheyCame) {
    std::mt19937 rng(7);
    for (unsigned seed = 1; seed <= 2; ++seed) {
        const std::string name = "station " + std::to_string(seed), path = std::to_string(seed) + ".seam";
        auto runs = five_days(seed, 0.4 * seed);
        for (std::size_t i = 0; i < runs.size(); ++i) runs[i].type_id = i % 7 == 2 ? "left" : "";
        runs[5].started_utc = "yesterday";
        std::ranges::shuffle(runs, rng);
        auto file = ProjectFile::create(folder_ / path, project_).value();
        for (std::size_t i = 0; i < runs.size(); ++i) {
            ASSERT_TRUE(file.append_run(runs[i], project_));
            if (i % 9 == 4) {
                runs[i].number = static_cast<std::int64_t>(i + 1);
                runs[i].status = RunStatus::not_taken;
                ASSERT_TRUE(file.update_run(runs[i]));
            }
            if (rng() % 19 != 0) continue;
            // The copy has the queue of before: what it sends the database has, or is to have, already.
            const auto copied = folder_ / (path + std::to_string(i));
            ASSERT_TRUE(file.copy_to(copied));
            publish(file, name);
            auto copy = ProjectFile::open(copied).value();
            publish(copy, rng() % 2 == 0 ? name : "a copy");
            expect_sums();
        }
        publish(file, name);
    }
    expect_sums();
    EXPECT_EQ(server_->ask("SELECT count(*) FROM seamwright.run"), "160");
}

TEST_F(FleetSums, WhatLiesBeyondLimitsIsCountedInDaysHoursAndWhatATimeCuts) {
    auto runs = five_days(4, 1.2);
    auto file = make("a.seam", runs);
    publish(file);
    constexpr std::int64_t kFirst = 1'714'564'800;  // 12:00 UTC
    for (const std::int64_t from : {0, 1, 60 * 13, 3600, 5000, 12 * 3600, 86400 + 1234})
        for (const std::int64_t until : {60 * 20, 3599, 3600, 7000, 12 * 3600, 2 * 86400, 3 * 86400 + 4321}) {
            if (from >= until) continue;
            StatisticsOptions options;
            options.runs.since_utc = utc_text(kFirst + from);
            options.runs.until_utc = utc_text(kFirst + until);
            options.tolerance_mm = 0.9;
            const auto by_file = production_statistics({folder_ / "a.seam"}, options);
            ASSERT_TRUE(by_file) << sentence(by_file);
            expect_same(statistics_json(*by_file), statistics_json(of_fleet({options, {}})), "");
        }
    EXPECT_THAT(sentence(fleet_statistics(target(),
                                          [] {
                                              FleetStatisticsOptions options;
                                              options.statistics.runs.since_utc = "yesterday";
                                              return options;
                                          }())),
                HasSubstr("is no time"));
}

TEST_F(FleetSums, ADatabaseOfBeforeIsBroughtUpToDate) {
    auto file = make("a.seam", five_days());
    publish(file);
    const json all = statistics_json(of_fleet());
    const auto contents = [] {
        std::string text;
        for (const char* table : {"hour_sums", "hour_counts", "day_sums", "day_counts", "day_runs",
                                  "day_cycles", "day_refusals", "day_unmeasured"})
            text += server_->ask("SELECT md5(string_agg(t::text, ' ' ORDER BY t::text)) FROM seamwright." +
                                 std::string(table) + " t");
        return text;
    };
    const std::string sums = contents();
    server_->ask(
        "DROP TABLE seamwright.hour_sums, seamwright.hour_counts, seamwright.day_runs, "
        "seamwright.day_cycles, "
        "seamwright.day_refusals, seamwright.day_unmeasured; DROP INDEX seamwright.run_newest, "
        "seamwright.refusal_by_time, seamwright.unmeasured_by_time; CREATE INDEX run_by_time ON "
        "seamwright.run "
        "(station, started DESC); CREATE TABLE seamwright.station_day (station int NOT NULL, day date NOT "
        "NULL, done "
        "boolean NOT NULL, PRIMARY KEY (station, day)); DELETE FROM seamwright.migration WHERE version > 1; "
        "DELETE "
        "FROM seamwright.day_counts; UPDATE seamwright.day_sums SET n = n + 1");
    EXPECT_THAT(sentence(fleet_statistics(target(), {})),
                AllOf(HasSubstr("has version 1"), HasSubstr("fleet init")));
    ASSERT_TRUE(file.append_run(production_run(5 * 1440, {0.4, 0.3, 0.1}, 0.05), project_));
    EXPECT_THAT(sentence(publish_file(file, target(), {"left"})), HasSubstr("fleet init"));
    const auto made = init_fleet(target());
    ASSERT_TRUE(made) << sentence(made);
    EXPECT_EQ(made->before, 1);
    EXPECT_EQ(contents(), sums);
    expect_same(all, statistics_json(of_fleet()), "");
    EXPECT_EQ(publish(file), 1);
    expect_sums();
}

// Squares that a double does not hold are errors to the database.
TEST_F(FleetSums, ValuesThatNothingMeasuresHoldNothingUp) {
    auto file = make("a.seam", {production_run(0, {1, 2, 3})});
    EXPECT_EQ(publish(file), 1);
    server_->ask("UPDATE seamwright.result SET vals[1] = 1e-200, vals[2] = 5e-324, vals[3] = 1e200");
    ASSERT_TRUE(file.append_run(production_run(1, {1, 2, 3}), project_));
    EXPECT_EQ(publish(file), 1);
    EXPECT_EQ(
        server_->ask("SELECT key, n, sx FROM seamwright.day_sums WHERE key IN ('x_mm', 'z_mm') ORDER BY 1"),
        "x_mm|2|1\nz_mm|1|3");
}

// The schema changes under a station that publishes: it notices, and its runs wait.
TEST_F(FleetSums, AStationOfBeforeIsRefusedWhileItIsConnected) {
    auto file = make("a.seam", {five_days().front()});
    std::mutex mutex;
    std::string told;
    PublisherOptions options;
    options.station = "left";
    options.retry_first = options.retry_longest = std::chrono::milliseconds(50);
    options.told = [&](const Text& text) {
        const std::lock_guard lock(mutex);
        told += text.english() + "\n";
    };
    auto publisher = FleetPublisher::start(file, target(), options);
    ASSERT_TRUE(publisher) << sentence(publisher);
    EXPECT_EQ((*publisher)->finish(std::chrono::seconds(20)), 0);
    server_->ask("INSERT INTO seamwright.migration (version) VALUES (1000)");
    const auto number = file.append_run(five_days().back(), project_);
    ASSERT_TRUE(number && (*publisher)->part_done(*number));
    EXPECT_EQ((*publisher)->finish(std::chrono::seconds(20)), 1);
    publisher->reset();
    EXPECT_THAT(told, HasSubstr("use a newer Seamwright"));
    EXPECT_EQ(server_->ask("SELECT count(*) FROM seamwright.run"), "1");
}

}  // namespace
}  // namespace seamwright
