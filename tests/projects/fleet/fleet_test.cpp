// Stations publish to a real server: once, the same numbers as in their files, whatever names and values hold.

#include <limits>
#include <thread>

#include "devices/capture/sqlite.h"
#include "projects/fleet/fleet_board.h"
#include "tests/projects/fleet/fleet_fixture.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(Fleet, StatisticsAreThoseOfTheFile) {
    auto runs = five_days();
    for (int i = 0; i < 4; ++i) {  // a panel job beside
        RunRecord run = production_run(5 * 1440 + i, {});
        run.regions.clear();
        run.panel = sample_panel_record(5);
        for (PanelMeasurement& place : run.panel->after) {
            place.gap_mm = 3.5 + 0.1 * i;
            place.flush_mm = 0.2 - 0.05 * i * i;
        }
        runs.push_back(std::move(run));
    }
    auto file = make("a.seam", runs);
    EXPECT_EQ(publish(file), 84);
    for (const auto& [since, until] :
         {std::pair<std::string, std::string>{"", ""},
          {utc_text(1'714'564'800 + 86400 + 3000), ""},
          {utc_text(1'714'564'800 + 600), utc_text(1'714'564'800 + 3 * 86400 + 4000)},
          {"", utc_text(1'714'564'800 + 1200)}}) {
        StatisticsOptions options;
        options.runs.since_utc = since;
        options.runs.until_utc = until;
        options.tolerance_mm = 1.0;
        const auto by_file = production_statistics({folder_ / "a.seam"}, options);
        ASSERT_TRUE(by_file) << sentence(by_file);
        expect_same(statistics_json(*by_file), statistics_json(of_fleet({options, {}})), "");
    }
}

TEST_F(Fleet, StationsAreNoNeighboursOfEachOther) {
    auto left = make("left.seam", five_days(1, 0.5)), right = make("right.seam", five_days(2, 1.5));
    publish(left, "left");
    publish(right, "right");
    const auto of_x = [](const Statistics& s) {
        for (const Characteristic& c : s.regions.front().characteristics)
            if (c.key == "x_mm") return c.summary;
        return ProcessSummary{};
    };
    const ProcessSummary both = of_x(of_fleet()), alone = of_x(of_fleet({{}, {"left"}}));
    EXPECT_NEAR(both.sigma_within / alone.sigma_within, 1, 0.25);
    EXPECT_EQ(both.n, 2 * alone.n);
    EXPECT_EQ(of_fleet().production.files.size(), 2u);
    EXPECT_EQ(of_fleet({{}, {"right"}}).production.files.front().path, "right");
    EXPECT_THAT(sentence(fleet_statistics(target(), {{}, {"midle"}})),
                AllOf(HasSubstr("no station \"midle\""), HasSubstr("left, right")));
    FleetStatisticsOptions unknown;
    unknown.statistics.region = "nowhere";
    EXPECT_THAT(sentence(fleet_statistics(target(), unknown)), HasSubstr("no region"));
}

TEST_F(Fleet, EveryRunOnceAndItsNewestOutcome) {
    auto runs = five_days();
    auto file = make("a.seam", {runs.begin(), runs.begin() + 10});
    EXPECT_EQ(*file.queued(), 10);
    EXPECT_EQ(publish(file), 10);
    EXPECT_EQ(*file.queued(), 0);
    EXPECT_EQ(publish(file), 0);
    // What became of a pushed part comes later.
    RunRecord run = runs[4];
    run.number = 5;
    run.status = RunStatus::not_taken;
    run.message = Text("the application did not begin in {} s", 30);
    ASSERT_TRUE(file.update_run(run));
    EXPECT_EQ(publish(file), 1);
    EXPECT_EQ(server_->ask("SELECT count(*), count(DISTINCT uid), count(*) FILTER (WHERE status = "
                           "'not_taken') FROM seamwright.run"),
              "10|10|1");
    EXPECT_EQ(
        server_->ask("SELECT number, message_key, message FROM seamwright.run WHERE status = 'not_taken'"),
        "5|the application did not begin in {} s|the application did not begin in 30 s");
    EXPECT_EQ(server_->ask("SELECT count(*) FROM seamwright.result"), "10");
    // A copy of the file has the same runs; what it measures by itself are others under the same numbers.
    ASSERT_TRUE(file.append_run(runs[10], project_));
    ASSERT_TRUE(file.copy_to(folder_ / "b.seam"));
    auto copy = ProjectFile::open(folder_ / "b.seam").value();
    ASSERT_TRUE(file.append_run(runs[11], project_));
    ASSERT_TRUE(copy.append_run(runs[12], project_));
    EXPECT_EQ(publish(file, "left"), 2);
    EXPECT_EQ(publish(copy, "right"), 2) << "the one it shares is confirmed, and not stored again";
    EXPECT_EQ(server_->ask("SELECT s.name, count(*), max(number) FROM seamwright.run JOIN seamwright.station "
                           "s ON s.id = station "
                           "GROUP BY 1 ORDER BY 1"),
              "left|12|12\nright|1|12");
    EXPECT_TRUE(file.check().empty());
    EXPECT_TRUE(copy.check().empty());
}

TEST_F(Fleet, AnOldOutcomeNeverReplacesANewerOne) {
    auto file = make("a.seam", {five_days().front()});
    ASSERT_TRUE(file.copy_to(folder_ / "old.seam"));
    RunRecord run = five_days().front();
    run.number = 1;
    run.status = RunStatus::alarm;
    ASSERT_TRUE(file.update_run(run));
    publish(file);
    auto old = ProjectFile::open(folder_ / "old.seam").value();
    publish(old);
    EXPECT_EQ(server_->ask("SELECT status FROM seamwright.run"), "alarm");
}

// A run that a watching forgets (--keep) is published all the same.
TEST_F(Fleet, WhatWasKeptOfADeletedRunIsPublished) {
    auto runs = five_days();
    auto file = make("a.seam", {runs.begin(), runs.begin() + 3});
    {
        const FleetTarget nowhere = target("postgresql://seam@127.0.0.1:1/fleet");
        auto publisher = FleetPublisher::start(file, nowhere, {"left"});
        ASSERT_TRUE(publisher);
        ASSERT_TRUE((*publisher)->part_done(2));
    }
    ASSERT_TRUE(file.delete_run(1));
    ASSERT_TRUE(file.delete_run(2));
    EXPECT_EQ(*file.queued(), 2) << "the first had no message, it is gone";
    EXPECT_TRUE(file.check().empty());
    EXPECT_EQ(publish(file), 2);
    EXPECT_EQ(server_->ask(
                  "SELECT string_agg(number::text || ' ' || part, ', ' ORDER BY number) FROM seamwright.run"),
              "2 car 7, 3 car 14");
}

TEST_F(Fleet, AFileOfBeforeQueuesAllItsRuns) {
    auto made = make("a.seam", five_days());
    { const ProjectFile closed = std::move(made); }
    {
        auto db = Database::open((folder_ / "a.seam").string(), SQLITE_OPEN_READWRITE).value();
        ASSERT_TRUE(
            db.execute("DROP TABLE outbox; DROP TABLE guides; DROP TABLE fleet; PRAGMA user_version = 12"));
    }
    auto file = ProjectFile::open(folder_ / "a.seam");
    ASSERT_TRUE(file) << sentence(file);
    EXPECT_EQ(*file->queued(), 80);
    EXPECT_EQ(publish(*file), 80);
    EXPECT_TRUE(file->check().empty());
}

TEST_F(Fleet, NamesAndValuesOfStrangersAreData) {
    const std::vector<std::string> names{"x'); DROP TABLE seamwright.run; --", "\"quoted\"",
                                         "back\\slash {1,NULL}", "Straße 7 \xe2\x98\x83", "$1 %s"};
    std::size_t shared = 0;
    for (const std::string& name : names) {
        auto runs = five_days(static_cast<unsigned>(++shared));
        std::vector<RunRecord> few{runs.begin(), runs.begin() + 2};
        few[0].part_id = std::string("a\0b", 3) + "\xff\xfe" + name + std::string(10'000, 'x');
        few[1].type_id = name + std::string(5'000, 'y');
        few[1].message = Text(std::string("NUL \0 and \x80", 12));
        few[1].regions.front().refusals = {Text(name + "\xc3"), Text("sigma {:.3f} mm", std::nan(""))};
        few[1].regions.front().gate_passed = false;
        few[0].regions.front().correction->sigma_xyz_mm = {std::nan(""),
                                                           std::numeric_limits<double>::infinity(), 1};
        auto file = make("f" + std::to_string(shared) + ".seam", few);
        EXPECT_EQ(publish(file, name), 2) << name;
    }
    EXPECT_EQ(server_->ask("SELECT count(*) FROM seamwright.run"), std::to_string(2 * names.size()));
    EXPECT_EQ(server_->ask(
                  "SELECT count(*) FROM seamwright.result WHERE 'NaN' = ANY (vals) OR 'NaN' = ANY (numbers)"),
              "0");
    const auto standing = fleet_standing(target(), 10);
    ASSERT_TRUE(standing);
    EXPECT_EQ(standing->parts.size(), 10u);
    std::vector<std::string> found;
    for (const FleetStation& s : standing->stations) found.push_back(s.name);
    EXPECT_THAT(found, testing::UnorderedElementsAreArray(names));
    for (const std::string& name : names) EXPECT_EQ(of_fleet({{}, {name}}).parts, 2u) << name;
    FleetStatisticsOptions injected;
    injected.statistics.runs.type_id = "'; DROP TABLE seamwright.run; --";
    EXPECT_EQ(of_fleet(injected).parts, 0u);
    auto file = make("last.seam", {});
    for (const std::string& bad :
         {std::string(65, 'x'), std::string("a\0b", 3), std::string("\xff"), std::string("a\nb")}) {
        const auto done = publish_file(file, target(), {bad});
        EXPECT_THAT(sentence(done), HasSubstr("the station's name")) << bad;
    }
}

// A run whose row cannot be read is told, and holds up no other.
TEST_F(Fleet, ADamagedRunHoldsUpNoOther) {
    auto runs = five_days();
    std::vector<RunRecord> few{runs.begin(), runs.begin() + 3};
    few[1].regions.front().correction->displacement.workobject_from_movedworkobject.translation().x() =
        std::nan("");
    few[2].started_utc = "yesterday";
    auto file = make("a.seam", few);
    PublishOptions options;
    options.station = "left";
    const auto done = publish_file(file, target(), options);
    ASSERT_TRUE(done) << sentence(done);
    EXPECT_EQ(done->runs + done->waiting, 3);
    EXPECT_EQ(done->refused.size(), static_cast<std::size_t>(done->waiting));
    EXPECT_GE(done->runs, 2);
    EXPECT_EQ(of_fleet().parts, 1u) << "a run without a time is kept, and no part of the numbers";
}

TEST_F(Fleet, InitIsIdempotentAndRefusesANewerSchema) {
    const auto again = init_fleet(target());
    ASSERT_TRUE(again);
    EXPECT_EQ(again->before, fleet_schema_version());
    EXPECT_EQ(again->version, fleet_schema_version());
    server_->ask("INSERT INTO seamwright.migration (version) VALUES (1000)");
    EXPECT_THAT(sentence(init_fleet(target())),
                AllOf(HasSubstr("has version 1000"), HasSubstr("newer Seamwright")));
    auto file = make("a.seam", {five_days().front()});
    EXPECT_THAT(sentence(publish_file(file, target(), {"left"})), HasSubstr("newer Seamwright"));
    EXPECT_EQ(*file.queued(), 1);
    server_->ask("DROP SCHEMA seamwright CASCADE");
    EXPECT_THAT(sentence(publish_file(file, target(), {"left"})), HasSubstr("fleet init"));
    EXPECT_THAT(sentence(fleet_standing(target(), 0)), HasSubstr("fleet init"));
    ASSERT_TRUE(init_fleet(target()));
    EXPECT_EQ(publish(file), 1);
}

TEST_F(Fleet, WhyADatabaseIsNotReachedIsSaidWithoutThePassword) {
    const auto said = [](const std::string& uri) {
        const std::string text = sentence(init_fleet(target(uri)));
        EXPECT_THAT(text, Not(HasSubstr("hunter2"))) << uri;
        EXPECT_THAT(text, Not(HasSubstr(PostgresServer::kPassword))) << uri;
        return text;
    };
    EXPECT_THAT(said("postgresql://seam:hunter2@127.0.0.1:1/fleet"), HasSubstr("no database server answers"));
    EXPECT_THAT(said("postgresql://seam:hunter2@no.such.host.invalid/fleet"),
                HasSubstr("no database server answers"));
    EXPECT_THAT(said(server_->uri("fleet", "hunter2")), HasSubstr("refuses the password"));
    EXPECT_THAT(said(server_->uri("fleet", "")), HasSubstr("asks for a password"));
    EXPECT_THAT(said(server_->uri("nowhere")), HasSubstr("no such database"));
    EXPECT_EQ(target(server_->uri()).name(),
              "postgresql://seam@127.0.0.1:" + std::to_string(server_->port()) + "/fleet");
    EXPECT_EQ(target("postgresql://a:pw@h/d").cleaned("pw wrong: pw"), "*** wrong: ***");
    ::setenv("PGPASSWORD", PostgresServer::kPassword, 1);
    EXPECT_TRUE(init_fleet(target(server_->uri("fleet", ""))));
    ::unsetenv("PGPASSWORD");
    for (const std::string bad :
         {"", "hunter2", "host=x password=hunter2", "http://u:hunter2@h/d", "postgresql://u:hunter2@h:port/d",
          "postgresql://u:hunter2@h/d?nonsense=hunter2", "postgresql://u:%zz@h/d"}) {
        const auto t = FleetTarget::from(bad);
        // A port that is none is noticed where it is connected to.
        const std::string text = t ? sentence(init_fleet(*t)) : t.error().sentence();
        EXPECT_THAT(text, Not(HasSubstr("hunter2"))) << bad;
        EXPECT_THAT(text, Not(HasSubstr("went well"))) << bad;
    }
}

// A user who may only read sees the numbers, and publishes nothing.
TEST_F(Fleet, ReadingNeedsNoRightToWrite) {
    auto file = make("a.seam", five_days());
    publish(file);
    server_->ask("DROP ROLE IF EXISTS guest");
    server_->ask(
        "CREATE ROLE guest LOGIN PASSWORD 'g'; GRANT USAGE ON SCHEMA seamwright TO guest; GRANT SELECT ON "
        "ALL TABLES "
        "IN SCHEMA seamwright TO guest");
    const std::string uri = "postgresql://guest:g@127.0.0.1:" + std::to_string(server_->port()) + "/fleet";
    const auto s = fleet_statistics(target(uri), {});
    ASSERT_TRUE(s) << sentence(s);
    EXPECT_EQ(s->parts, 78u);
    ASSERT_TRUE(file.append_run(five_days().front(), project_));
    EXPECT_THAT(sentence(publish_file(file, target(uri), {"left"})), HasSubstr("does not allow it"));
    EXPECT_EQ(*file.queued(), 1);
    server_->ask("DROP OWNED BY guest; DROP ROLE guest");
}

// While a station is watched: the database is away, comes, goes and comes, and every part is there in the end.
TEST_F(Fleet, AWatchingPublishesInItsPauses) {
    const auto runs = five_days();
    auto file = make("a.seam", {});
    std::vector<std::string> told;
    std::mutex mutex;
    PublisherOptions options;
    options.station = "left";
    options.retry_first = std::chrono::milliseconds(20);
    options.retry_longest = std::chrono::milliseconds(100);
    options.told = [&](const Text& text) {
        const std::lock_guard lock(mutex);
        told.push_back(text.english());
    };
    server_->stop();
    auto publisher = FleetPublisher::start(file, target(), options);
    ASSERT_TRUE(publisher) << sentence(publisher);
    for (std::size_t i = 0; i < 60; ++i) {
        if (i == 20 || i == 50) {
            ASSERT_TRUE(server_->resume());
        }
        if (i == 40) server_->kill();
        (*publisher)->measuring(true);
        ASSERT_TRUE((*publisher)->idle());
        const auto number = file.append_run(runs[i], project_);
        ASSERT_TRUE(number);
        (*publisher)->measuring(false);
        ASSERT_TRUE((*publisher)->part_done(*number));
        if (i >= 5) {
            ASSERT_TRUE(file.delete_run(*number - 5));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        ASSERT_TRUE((*publisher)->idle());
    }
    std::int64_t left = 1;
    for (int i = 0; i < 200 && left > 0; ++i) {
        left = (*publisher)->finish(std::chrono::milliseconds(500));
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_EQ(left, 0);
    publisher->reset();
    EXPECT_EQ(server_->ask("SELECT count(*), count(DISTINCT number), max(number) FROM seamwright.run"),
              "60|60|60");
    EXPECT_THAT(told, testing::Contains(HasSubstr("runs wait for the fleet's database")));
    EXPECT_THAT(told, testing::Contains(HasSubstr("takes runs again")));
}

}  // namespace
}  // namespace seamwright
