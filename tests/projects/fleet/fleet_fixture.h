#pragma once
// A fleet's database on a real server, and files that publish to it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "projects/fleet/fleet_schema.h"
#include "projects/fleet/fleet_statistics.h"
#include "projects/fleet/publish.h"
#include "projects/proof/zero_shift.h"
#include "projects/statistics/statistics_page.h"
#include "tests/projects/fleet/postgres_server.h"
#include "tests/projects/statistics/production_runs.h"

namespace seamwright {

template <class T>
std::string sentence(const Expected<T>& done) {
    return done ? std::string("it went well") : done.error().sentence();
}

class Fleet : public testing::Test {
  protected:
    static void SetUpTestSuite() { server_ = PostgresServer::start(why_).release(); }
    static void TearDownTestSuite() {
        delete server_;
        server_ = nullptr;
    }
    void SetUp() override {
        if (!server_) GTEST_SKIP() << "skipped: " << why_;
        server_->ask("DROP SCHEMA IF EXISTS seamwright CASCADE");
        const auto made = init_fleet(target());
        ASSERT_TRUE(made) << made.error().sentence();
    }
    static FleetTarget target(const std::string& uri = server_->uri()) {
        auto t = FleetTarget::from(uri);
        EXPECT_TRUE(t) << sentence(t);
        return *t;
    }
    ProjectFile make(const std::string& name, const std::vector<RunRecord>& runs) {
        auto file = ProjectFile::create(folder_ / name, project_);
        EXPECT_TRUE(file) << sentence(file);
        for (const RunRecord& run : runs) EXPECT_TRUE(file->append_run(run, project_));
        return std::move(*file);
    }
    static std::int64_t publish(ProjectFile& file, const std::string& station = "left") {
        PublishOptions options;
        options.station = station;
        const auto done = publish_file(file, target(), options);
        EXPECT_TRUE(done) << sentence(done);
        for (const auto& [run, error] : done->refused) ADD_FAILURE() << run << ": " << error.sentence();
        return done ? done->runs : -1;
    }
    static Statistics of_fleet(const FleetStatisticsOptions& options = {}) {
        auto s = fleet_statistics(target(), options);
        EXPECT_TRUE(s) << sentence(s);
        return s ? std::move(*s) : Statistics{};
    }
    // Five days of 16 parts, some of which are refused, some over the limits, with a spot that is not seen now and then.
    std::vector<RunRecord> five_days(unsigned seed = 1, double middle = 0.5) {
        std::mt19937 rng(seed);
        std::normal_distribution<double> draw;
        std::vector<RunRecord> runs;
        for (int i = 0; i < 80; ++i) {
            const int minute = 1440 * (i / 16) + 7 * (i % 16);
            RunRecord run =
                i % 50 == 17 ? refused_run(minute, Text("{}: {}", "edge", Text("sigma {:.3f} mm", 0.01 * i)))
                : i % 60 == 7
                    ? refused_run(minute, Text("sigma {:.3f} mm", 0.25), CorrectionStatus::over_limit,
                                  {7, 0, 0})
                    : production_run(minute, {middle + 0.2 * draw(rng), 0.3 * draw(rng), 0.1 * draw(rng)},
                                     0.05 * draw(rng));
            if (i % 30 == 3) {
                SpotMeasurement lost;
                lost.spot_id = "S1";
                lost.status = SpotStatus::no_stripe;
                run.spots.push_back(lost);
            }
            runs.push_back(std::move(run));
        }
        runs[20].status = RunStatus::cancelled;
        runs[21].part_id = kZeroShiftPrefix + std::string("3");
        runs[21].push = false;
        return runs;
    }

    inline static PostgresServer* server_ = nullptr;
    inline static std::string why_;
    TemporaryFolder folder_;
    Project project_ = production_project();
};

// Everything but what is named differs by rounding at most.
inline void expect_same(const nlohmann::json& a, const nlohmann::json& b, const std::string& path) {
    if (path == "/files" || path == "/diagnosis") return;
    if (a.is_number() && b.is_number()) {
        const double x = a.get<double>(), y = b.get<double>();
        EXPECT_NEAR(x, y, 1e-5 * (1 + std::abs(x))) << path;
        return;
    }
    ASSERT_EQ(a.type(), b.type()) << path << "\n" << a.dump() << "\n" << b.dump();
    if (a.is_object()) {
        for (const auto& [key, value] : a.items()) {
            ASSERT_TRUE(b.contains(key)) << path << "/" << key;
            expect_same(value, b[key], path + "/" + key);
        }
        EXPECT_EQ(a.size(), b.size()) << path;
    } else if (a.is_array()) {
        ASSERT_EQ(a.size(), b.size()) << path;
        for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i], path + "/" + std::to_string(i));
    } else {
        EXPECT_EQ(a, b) << path;
    }
}

}  // namespace seamwright
