// The server is killed in the middle of a publishing, the station too: every run arrives once, and none is lost.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <thread>

#include "projects/fleet/fleet_schema.h"
#include "projects/fleet/fleet_statistics.h"
#include "projects/fleet/publish.h"
#include "projects/statistics/statistics_page.h"
#include "tests/projects/fleet/postgres_server.h"
#include "tests/projects/statistics/production_runs.h"

namespace seamwright {
namespace {

constexpr int kRounds = 8, kRunsARound = 250;

TEST(FleetKill, EveryRunOnceWhateverDies) {
    std::string why;
    const auto server = PostgresServer::start(why);
    if (!server) GTEST_SKIP() << "skipped: " << why;
    const FleetTarget target = FleetTarget::from(server->uri()).value();
    ASSERT_TRUE(init_fleet(target));
    TemporaryFolder folder;
    const auto path = folder / "a.seam";
    const Project project = production_project();
    ASSERT_TRUE(ProjectFile::create(path, project));
    std::mt19937 rng(5);
    std::normal_distribution<double> draw;
    int made = 0, cut_off = 0;
    for (int round = 0; round < kRounds; ++round) {
        {
            auto file = ProjectFile::open(path);
            ASSERT_TRUE(file) << file.error().sentence();
            for (int i = 0; i < kRunsARound; ++i, ++made) {
                const auto run = made % 10 == 3
                                     ? refused_run(made, Text("sigma {:.3f} mm", 0.25))
                                     : production_run(made, {0.5 + 0.2 * draw(rng), 0.3 * draw(rng), 0}, 0);
                ASSERT_TRUE(file->append_run(run, project));
            }
        }
        // A station is a process of its own, so that it can be killed too.
        const pid_t station = ::fork();
        ASSERT_GE(station, 0);
        if (station == 0) {
            auto file = ProjectFile::open(path);
            const auto done = file ? publish_file(*file, target, {"left"}) : Expected<PublishReport>();
            ::_exit(done && done->waiting == 0 ? 0 : 1);
        }
        std::this_thread::sleep_for(
            std::chrono::milliseconds(std::uniform_int_distribution<int>(30, 400)(rng)));
        if (round % 4 == 3) ::kill(station, SIGKILL);
        if (round % 4 == 2)
            server->stop();
        else
            server->kill();
        int status = 0;
        ASSERT_EQ(::waitpid(station, &status, 0), station);
        cut_off += status != 0;
        ASSERT_TRUE(server->resume());
    }
    EXPECT_GT(cut_off, kRounds / 3) << "the publishings were over before they were cut off";
    RecordProperty("cut_off", cut_off);
    auto file = ProjectFile::open(path);
    ASSERT_TRUE(file) << file.error().sentence();
    const auto done = publish_file(*file, target, {"left"});
    ASSERT_TRUE(done) << done.error().sentence();
    EXPECT_EQ(done->waiting, 0);
    const std::string all = std::to_string(made);
    EXPECT_EQ(
        server->ask(
            "SELECT count(*), count(DISTINCT uid), count(DISTINCT number), max(number) FROM seamwright.run"),
        all + "|" + all + "|" + all + "|" + all);
    EXPECT_EQ(server->ask("SELECT count(*), count(DISTINCT run) FROM seamwright.result"), all + "|" + all);
    EXPECT_EQ(server->ask("SELECT count(*) FROM seamwright.refusal"), std::to_string(made / 10));
    // The sums of the closed days too: each value of the file is in them once.
    const auto of_file = production_statistics({path}, {});
    const auto of_fleet = fleet_statistics(target, {});
    ASSERT_TRUE(of_file);
    ASSERT_TRUE(of_fleet) << of_fleet.error().sentence();
    ASSERT_EQ(of_fleet->regions.size(), of_file->regions.size());
    for (std::size_t r = 0; r < of_file->regions.size(); ++r) {
        EXPECT_EQ(of_fleet->regions[r].runs, of_file->regions[r].runs);
        EXPECT_EQ(of_fleet->regions[r].passed, of_file->regions[r].passed);
        for (std::size_t c = 0; c < of_file->regions[r].characteristics.size(); ++c) {
            const ProcessSummary &a = of_file->regions[r].characteristics[c].summary,
                                 &b = of_fleet->regions[r].characteristics[c].summary;
            EXPECT_EQ(a.n, b.n);
            EXPECT_NEAR(a.mean, b.mean, 1e-9);
            EXPECT_NEAR(a.s, b.s, 1e-6);
            EXPECT_NEAR(a.sigma_within, b.sigma_within, 1e-7);
        }
    }
    EXPECT_TRUE(file->check().empty());
}

}  // namespace
}  // namespace seamwright
