// Production in numbers: what is production, what the numbers are, why parts were refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <future>
#include <random>

#include "projects/proof/known_shift.h"
#include "projects/proof/path_direction.h"
#include "projects/proof/zero_shift.h"
#include "projects/statistics/shift_report.h"
#include "projects/statistics/statistics_page.h"
#include "tests/projects/statistics/production_runs.h"

namespace seamwright {
namespace {

class Statistic : public testing::Test {
  protected:
    ProjectFile make(const std::string& name, const std::vector<RunRecord>& runs) {
        auto file = ProjectFile::create(folder_ / name, project_);
        EXPECT_TRUE(file);
        for (const RunRecord& run : runs) EXPECT_TRUE(file->append_run(run, project_));
        return std::move(*file);
    }
    Statistics statistics(const std::vector<std::string>& names, const StatisticsOptions& options = {}) {
        std::vector<std::filesystem::path> files;
        for (const auto& name : names) files.push_back(folder_ / name);
        auto s = production_statistics(files, options);
        EXPECT_TRUE(s) << (s ? "" : s.error().sentence());
        return s ? std::move(*s) : Statistics{};
    }
    static const Characteristic& of(const Statistics& s, const std::string& key,
                                    const std::string& region = "edge") {
        static const Characteristic none;
        for (const RegionStatistics& r : s.regions)
            for (const Characteristic& c : r.characteristics)
                if (r.id == region && c.key == key) return c;
        ADD_FAILURE() << key;
        return none;
    }
    static std::vector<RunRecord> calm(int n, unsigned seed = 1, int first_minute = 0) {
        std::mt19937 rng(seed);
        std::normal_distribution<double> draw;
        std::vector<RunRecord> runs;
        for (int i = 0; i < n; ++i)
            runs.push_back(production_run(first_minute + i,
                                          {0.5 + 0.2 * draw(rng), 0.3 * draw(rng), 0.1 * draw(rng)},
                                          0.05 * draw(rng)));
        return runs;
    }

    TemporaryFolder folder_;
    Project project_ = production_project();
};

// The queries say what the runs loaded one by one say.
TEST_F(Statistic, ValuesAreThoseOfTheLoadedRuns) {
    std::vector<RunRecord> runs = calm(5);
    runs.push_back(refused_run(5, Text("sigma {:.3f} mm", 0.25), CorrectionStatus::over_limit, {7, 0, 0}));
    runs.push_back(sample_run(3));
    runs.push_back(sample_run(4));
    runs.back().regions.clear();
    const ProjectFile file = make("a.seam", runs);
    const auto values = file.run_values();
    ASSERT_TRUE(values) << values.error().sentence();
    ASSERT_EQ(values->size(), runs.size());
    for (const RunValues& v : *values) {
        const auto run = file.load_run(v.number, false);
        ASSERT_TRUE(run);
        EXPECT_EQ(v.part_id, run->part_id);
        EXPECT_EQ(v.started_utc, run->started_utc);
        EXPECT_EQ(v.finished_utc, run->finished_utc);
        EXPECT_EQ(v.push, run->push);
        EXPECT_EQ(v.status, run->status);
        ASSERT_EQ(v.regions.size(), run->regions.size());
        for (std::size_t i = 0; i < v.regions.size(); ++i) {
            const RegionRecord& r = run->regions[i];
            EXPECT_EQ(v.regions[i].region_id, r.region_id);
            EXPECT_EQ(v.regions[i].gate_passed, r.gate_passed);
            if (!r.gate_passed) {
                EXPECT_EQ(v.regions[i].refusals, r.refusals);
            }
            ASSERT_EQ(v.regions[i].status.has_value(), r.correction.has_value());
            if (!r.correction) continue;
            EXPECT_EQ(*v.regions[i].status, r.correction->status);
            if (r.correction->status == CorrectionStatus::ok ||
                r.correction->status == CorrectionStatus::over_limit) {
                EXPECT_TRUE(v.regions[i].workobject_from_movedworkobject.isApprox(
                    r.correction->displacement.workobject_from_movedworkobject, 1e-14));
            }
        }
        EXPECT_EQ(v.panel.has_value(), run->panel.has_value());
        std::size_t missing = 0;
        for (const SpotMeasurement& s : run->spots) missing += s.status != SpotStatus::measured;
        EXPECT_EQ(v.not_measured.size(), missing);
    }
}

TEST_F(Statistic, MeanLimitsAndCapabilityOfARegion) {
    make("a.seam", calm(200));
    const Statistics s = statistics({"a.seam"});
    const Characteristic& x = of(s, "x_mm");
    EXPECT_EQ(x.summary.n, 200);
    EXPECT_NEAR(x.summary.mean, 0.5, 0.06);
    EXPECT_NEAR(x.summary.s, 0.2, 0.03);
    EXPECT_EQ(x.limits.upper, 5.0);
    EXPECT_NEAR(x.summary.total.worst_side->value, 4.5 / (3 * x.summary.s), 0.5);
    EXPECT_NEAR(of(s, "c_deg").summary.s, 0.05, 0.008);
    EXPECT_EQ(of(s, "c_deg").limits.lower, -2.0);
    EXPECT_FALSE(x.trend->significant);
    EXPECT_TRUE(x.caveats.empty());
    // A is not free there: it has no numbers.
    for (const Characteristic& c : s.regions.front().characteristics) EXPECT_NE(c.key, "a_deg");
    // The worst point has the largest mean square, by the definition of the measurand.
    const auto directions = path_directions(project_, project_.regions.front());
    double largest = 0;
    std::string key;
    for (const PathDirection& d : directions) {
        double square = 0;
        for (const ProductionRun& run : s.production.runs) {
            const double v = d.value(run.values.regions.front().workobject_from_movedworkobject);
            square += v * v;
        }
        if (square > largest) largest = square, key = d.spot_id + (d.normal ? "_normal_mm" : "_binormal_mm");
    }
    EXPECT_TRUE(of(s, key).worst_point);
    ASSERT_TRUE(s.cycle);
    EXPECT_NEAR(s.cycle->mean_s, 9.5, 1e-9);
    EXPECT_NEAR(s.cycle->between_s, 60, 1e-3);
}

TEST_F(Statistic, ProofsAndStudiesAreNoProduction) {
    std::vector<RunRecord> runs = calm(20);
    ProjectFile file = make("a.seam", runs);
    const auto add = [&](const std::string& part, bool push = false) {
        RunRecord run = production_run(100, {4, 4, 4});
        run.part_id = part;
        run.push = push;
        auto number = file.append_run(run, project_);
        EXPECT_TRUE(number);
        return *number;
    };
    add(std::string(kZeroShiftPrefix) + "1");
    add(std::string(kKnownShiftPrefix) + "X +5 mm");
    ZeroShift proof;
    proof.runs = {add("a name of its own")};
    ASSERT_TRUE(file.append_evidence({0, {}, 0, proof}, project_));
    StudyPlan plan{"type3", "edge", {"master"}, 1, 5, 0};
    ASSERT_TRUE(file.append_evidence({0, {}, 0, plan}, project_));
    add("master");
    add("master", true);  // pushed: a part that went on
    RunRecord broken = production_run(101, {9, 9, 9});
    broken.status = RunStatus::interrupted;
    broken.regions.clear();
    ASSERT_TRUE(file.append_run(broken, project_));
    const Statistics s = statistics({"a.seam"});
    EXPECT_EQ(s.production.runs.size(), 21u);
    EXPECT_EQ(s.production.proofs, 3);
    EXPECT_EQ(s.production.studies, 1);
    EXPECT_EQ(s.production.unfinished, 1);
    EXPECT_EQ(s.caveats.size(), 4u);
}

TEST_F(Statistic, RefusalsAreCountedByWhatTheySayNotByTheirNumbers) {
    std::vector<RunRecord> runs = calm(30);
    for (int i = 0; i < 5; ++i)
        runs.push_back(
            refused_run(40 + i, Text("spot {} of the region is {}", fmt::format("S{}", i), "not known")));
    for (int i = 0; i < 7; ++i)
        runs.push_back(refused_run(50 + i, joined("here", ": ", Text("the speed is {:.1f} mm/s", 1.0 * i)),
                                   CorrectionStatus::over_limit, {7, 0, 0}));
    runs.push_back(refused_run(60, Text(std::string("words of a controller"))));
    make("a.seam", runs);
    const Statistics s = statistics({"a.seam"});
    const RegionStatistics& r = s.regions.front();
    ASSERT_EQ(r.refusals.size(), 3u);
    EXPECT_EQ(r.refusals[0].count, 7);
    EXPECT_EQ(r.refusals[0].pattern, "the speed is {:.1f} mm/s");
    EXPECT_EQ(r.refusals[0].said(Language::english), "the speed is … mm/s");
    EXPECT_EQ(r.refusals[1].count, 5);
    EXPECT_EQ(r.refusals[1].said(Language::german), "Messstelle … des Korrekturbereichs ist …");
    EXPECT_EQ(r.refusals[2].pattern, "words of a controller");
    // Parts over their limits are values, those that were not solved are not.
    EXPECT_EQ(r.over_limit, 7);
    EXPECT_EQ(r.left_out, 6);
    EXPECT_EQ(of(s, "x_mm").summary.n, 37);
    EXPECT_EQ(of(s, "x_mm").summary.beyond, 7);
    EXPECT_EQ(s.count(RunStatus::refused), 13);
}

TEST_F(Statistic, AWanderingRegionReachesItsLimitOnADay) {
    std::mt19937 rng(2);
    std::normal_distribution<double> draw;
    std::vector<RunRecord> runs;
    // A part every two hours for ten days, 0.2 mm a day: 2 mm by then, 5 mm after 15 more.
    for (int hour = 0; hour < 240; hour += 2)
        runs.push_back(production_run(60 * hour, {0.2 / 24 * hour + 0.1 * draw(rng), 0, 0}));
    make("a.seam", runs);
    const Statistics s = statistics({"a.seam"});
    const Characteristic& x = of(s, "x_mm");
    ASSERT_TRUE(x.trend && x.trend->significant && x.trend->crossing);
    EXPECT_NEAR(x.trend->slope_per_day, 0.2, 0.005);
    EXPECT_NEAR(x.trend->crossing->days, 15, 0.5);
    EXPECT_FALSE(x.chart->alarms.empty());
    EXPECT_FALSE(x.ewma->beyond.empty());
    const auto json = statistics_json(s);
    const auto& first = json["regions"][0]["characteristics"][0];
    EXPECT_EQ(first["trend"]["crossing"]["date"], "2024-05-26");
    EXPECT_TRUE(first["ewma"]["beyond_now"]);
    EXPECT_THAT(statistics_page(s, Language::english, "x").text(), testing::HasSubstr("2024-05-26"));
    // Y stood still to the last digit: no index, no chart, and no alarm of rounding.
    EXPECT_FALSE(of(s, "y_mm").chart);
    EXPECT_FALSE(of(s, "y_mm").trend->significant);
}

TEST_F(Statistic, SeveralFilesAreOneRowInTheOrderOfTime) {
    make("late.seam", calm(50, 1, 1000));
    make("early.seam", calm(60, 2));
    const Statistics s = statistics({"late.seam", "early.seam"});
    const Characteristic& x = of(s, "x_mm");
    ASSERT_EQ(x.values.size(), 110u);
    for (std::size_t i = 1; i < x.runs.size(); ++i)
        EXPECT_LE(s.production.runs[x.runs[i - 1]].day, s.production.runs[x.runs[i]].day);
    EXPECT_EQ(s.production.files[s.production.runs.front().file].path.filename(), "early.seam");
    const auto twice = production_statistics({folder_ / "late.seam", folder_ / "late.seam"}, {});
    ASSERT_FALSE(twice);
    EXPECT_EQ(twice.error().kind, ErrorKind::usage);
}

TEST_F(Statistic, ATimeIsCutOut) {
    make("a.seam", calm(60));
    StatisticsOptions options;
    options.runs = {utc_text(1'714'564'800 + 60 * 10), utc_text(1'714'564'800 + 60 * 20)};
    EXPECT_EQ(statistics({"a.seam"}, options).production.runs.size(), 10u);
    std::swap(options.runs.since_utc, options.runs.until_utc);
    EXPECT_FALSE(production_statistics({folder_ / "a.seam"}, options));
    // A time without parts is no failure: there is nothing to say.
    options.runs = {"2030-01-01T00:00:00.000Z", ""};
    const Statistics none = statistics({"a.seam"}, options);
    EXPECT_EQ(statistics_json(none)["status"], "no_production");
    EXPECT_THAT(statistics_page(none, Language::german, "x").html(), testing::HasSubstr("door"));
}

TEST_F(Statistic, OptionsThatAreNoneAreRefused) {
    make("a.seam", calm(5));
    const std::vector<std::filesystem::path> file{folder_ / "a.seam"};
    StatisticsOptions o;
    o.region = "nobody";
    EXPECT_FALSE(production_statistics(file, o));
    o = {};
    o.subgroup = 0;
    EXPECT_FALSE(production_statistics(file, o));
    o = {};
    for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        o.tolerance_mm = bad;
        EXPECT_FALSE(production_statistics(file, o)) << bad;
    }
    EXPECT_FALSE(production_statistics({folder_ / "none.seam"}, {}));
    EXPECT_FALSE(production_statistics({}, {}));
}

TEST_F(Statistic, GapAndFlushOfAPanelAgainstWhatWasTaught) {
    std::vector<RunRecord> runs;
    const PanelJob& job = project_.panel_jobs.front();
    for (int i = 0; i < 12; ++i) {
        RunRecord run = production_run(i, {});
        run.regions.clear();
        run.panel.emplace();
        run.panel->job_id = job.id;
        run.panel->gate_passed = true;
        PanelMeasurement m;
        m.place_id = "P1";
        m.status = SpotStatus::measured;
        m.gap_mm = job.places[0].gap_mm + 0.1 * (i % 3 - 1);
        m.flush_mm = 9;
        run.panel->before = {m};
        run.panel->before[0].gap_mm += 5;
        if (i < 10) run.panel->after = {m};
        runs.push_back(run);
    }
    make("a.seam", runs);
    const Statistics s = statistics({"a.seam"});
    const Characteristic& gap = of(s, "P1_gap_mm", job.id);
    EXPECT_EQ(gap.summary.n, 10);
    EXPECT_NEAR(gap.summary.mean, job.places[0].gap_mm, 0.02);
    EXPECT_DOUBLE_EQ(*gap.limits.upper, job.places[0].gap_mm + 0.7);
    StatisticsOptions only;
    only.region = job.id;
    EXPECT_EQ(statistics({"a.seam"}, only).regions.size(), 1u);
}

// cmake reads the archive, which we do not write ourselves; the sheet's words and numbers are found in it.
TEST_F(Statistic, AWorkbookOfEveryRun) {
    make("a.seam", calm(20));
    const Statistics s = statistics({"a.seam"});
    const auto path = folder_ / "a.xlsx";
    ASSERT_TRUE(write_workbook(statistics_workbook(s, Language::english), path));
    const std::string unpack = fmt::format("cd '{}' && cmake -E tar xf a.xlsx", folder_.path().string());
    ASSERT_EQ(std::system(unpack.c_str()), 0);
    const std::string book = file_bytes(folder_ / "xl/workbook.xml");
    for (const char* name : {"Summary", "Refusals", "\"edge\""}) EXPECT_THAT(book, testing::HasSubstr(name));
    const std::string words = file_bytes(folder_ / "xl/sharedStrings.xml");
    EXPECT_THAT(words, testing::HasSubstr("car 19"));
    const std::string sheet = file_bytes(folder_ / "xl/worksheets/sheet3.xml");
    EXPECT_THAT(sheet, testing::HasSubstr(R"(<row r="21")"));
    EXPECT_THAT(sheet, testing::HasSubstr(fmt::format("<v>{:.16G}</v>", of(s, "x_mm").values[7])));
    EXPECT_FALSE(write_workbook({}, path));
    EXPECT_FALSE(
        write_workbook(statistics_workbook(s, Language::english), folder_ / "no" / "such" / "a.xlsx"));
    // Names that Excel refuses, and one twice.
    const Workbook hostile{
        {{"a/b[c]*?:\\", {{"=1+1"}}}, {"A_B_C____", {}}, {std::string(80, 'x'), {{std::nan("")}}}}};
    EXPECT_TRUE(write_workbook(hostile, folder_ / "hostile.xlsx"));
}

TEST_F(Statistic, QdasHoldsEachCharacteristicByItsNumber) {
    make("a.seam", calm(3));
    const auto studies = statistics_qdas(statistics({"a.seam"}));
    ASSERT_EQ(studies.size(), 5u);  // path points have no limits without a tolerance
    const std::string dfq = dfq_text(studies);
    EXPECT_THAT(dfq, testing::StartsWith("K0100 5\r\n"));
    EXPECT_THAT(dfq, testing::HasSubstr("K2002/4 edge B\r\n"));
    EXPECT_THAT(dfq, testing::HasSubstr("K2142/4 deg\r\n"));
    EXPECT_THAT(dfq, testing::HasSubstr("K0014/5 car 2\r\n"));
    StatisticsOptions o;
    o.tolerance_mm = 1;
    EXPECT_GT(statistics_qdas(statistics({"a.seam"}, o)).size(), 5u);
}

TEST_F(Statistic, TimesAsPeopleWriteThem) {
    const std::string now = "2024-05-08T12:00:00.000Z";
    EXPECT_EQ(time_argument("7d", "--since", now).value(), "2024-05-01T12:00:00.000Z");
    EXPECT_EQ(time_argument("90min", "--since", now).value(), "2024-05-08T10:30:00.000Z");
    EXPECT_EQ(time_argument("2024-05-01T06:00:00Z", "--since", now).value(), "2024-05-01T06:00:00.000Z");
    EXPECT_EQ(time_argument("2024-05-01T06:00Z", "--since", now).value(), "2024-05-01T06:00:00.000Z");
    ::setenv("TZ", "Europe/Berlin", 1);
    ::tzset();
    EXPECT_EQ(time_argument("2024-05-01T06:00", "--since", now).value(), "2024-05-01T04:00:00.000Z");
    EXPECT_EQ(time_argument("2024-01-15", "--since", now).value(), "2024-01-14T23:00:00.000Z");
    ::unsetenv("TZ");
    ::tzset();
    for (const char* bad :
         {"", "yesterday", "2024-13-01", "2024-05-01T25:00", "0h", "-3h", "3", "3 h", "1e9d", "h"})
        EXPECT_FALSE(time_argument(bad, "--since", now)) << bad;
    EXPECT_EQ(utc_milliseconds("1970-01-01T00:00:01.042Z"), 1042);
    EXPECT_EQ(utc_milliseconds("1970-01-01T00:00:01Z"), 1000);
}

TEST_F(Statistic, ShiftsFollowEachOtherFromTheFirstOn) {
    ShiftReportOptions o;
    o.every_s = 8 * 3600;
    o.first_s = 6 * 3600;
    // 2024-05-01 05:59:59 local, two hours ahead of UTC: the night shift, from 22:00.
    const std::int64_t six = 1'714'536'000;  // 04:00 UTC
    EXPECT_EQ(shift_at(six - 1, 7200, o).until_s, six);
    EXPECT_EQ(shift_at(six, 7200, o).from_s, six);
    for (std::int64_t t = six - 100'000; t < six + 100'000; t += 997) {
        const Shift s = shift_at(t, 7200, o);
        EXPECT_LE(s.from_s, t);
        EXPECT_GT(s.until_s, t);
        EXPECT_EQ((s.from_s - six) % o.every_s, 0);
    }
}

TEST_F(Statistic, AShiftsReportHoldsItsPartsAlone) {
    make("a.seam", calm(60));
    ShiftReportOptions o;
    o.file = folder_ / "a.seam";
    o.folder = folder_ / "reports";
    const auto path = write_shift_report({1'714'564'800, 1'714'564'800 + 600}, o);
    ASSERT_TRUE(path) << path.error().sentence();
    auto json_path = *path;
    const auto json = nlohmann::json::parse(file_bytes(json_path.replace_extension(".json")));
    EXPECT_EQ(json["runs"], 10);
    EXPECT_THAT(file_bytes(*path), testing::HasSubstr("<svg"));
    write_bytes(folder_ / "a_file", "x");
    o.folder = folder_ / "a_file";
    EXPECT_FALSE(write_shift_report({0, 86400}, o));
}

// The thread makes up for the shift before, once, and tells what it cannot write.
TEST_F(Statistic, AShiftThatEndedWhileNobodyRanIsMadeUpFor) {
    ShiftReportOptions o;
    o.every_s = 3600;
    o.file = folder_ / "a.seam";
    o.folder = folder_ / "reports";
    const Shift now = shift_at(*utc_seconds(utc_now()), 0, o);
    std::vector<RunRecord> runs;
    for (int i = 0; i < 5; ++i) runs.push_back(production_run(i, {}, 0, now.from_s - 3000));
    make("a.seam", runs);
    std::promise<std::filesystem::path> first;
    o.written = [&](const std::filesystem::path& path) { first.set_value(path); };
    {
        const ShiftReports reports(o);
        auto path = first.get_future();
        ASSERT_EQ(path.wait_for(std::chrono::seconds(20)), std::future_status::ready);
        EXPECT_TRUE(std::filesystem::exists(path.get()));
    }
    o.written = [](const std::filesystem::path&) { ADD_FAILURE() << "written again"; };
    const ShiftReports again(o);
}

TEST_F(Statistic, EveryPageIsWholeInBothLanguages) {
    make("a.seam", calm(120));
    const Statistics s = statistics({"a.seam"});
    for (const Language language : {Language::english, Language::german}) {
        const std::string html = statistics_page(s, language, "Seamwright").html();
        EXPECT_THAT(html, testing::HasSubstr("EWMA"));
        EXPECT_THAT(html, testing::Not(testing::HasSubstr("nan")));
    }
    const auto json = statistics_json(s);
    EXPECT_EQ(json["regions"][0]["characteristics"][0]["chart"]["subgroup"], 1);
    StatisticsOptions o;
    o.subgroup = 5;
    EXPECT_EQ(of(statistics({"a.seam"}, o), "x_mm").chart->means_mm.size(), 24u);
}

}  // namespace
}  // namespace seamwright
