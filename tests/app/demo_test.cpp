// The whole job as a newcomer starts it, and what is left of it when it is killed.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "projects/project_file.h"
#include "tests/app/run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Demo : public testing::Test {
  protected:
    std::filesystem::path folder = test_folder("demo");
    ~Demo() override { std::filesystem::remove_all(folder); }
};

TEST_F(Demo, TakesADisplacedDoorWithinATenthAndCanBeComputedAgain) {
    const std::string project = (folder / "out" / "demo.seam").string();
    ProgramResult r =
        run_program({"demo", "--dir", (folder / "out").string(), "--parts", "3", "--json", "-"}, folder);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json a = json::parse(r.out);
    EXPECT_EQ(a["status"], "ok");
    EXPECT_EQ(a["pushed"], 3);
    EXPECT_THAT((std::vector<std::string>{"good", "usable"}), testing::Contains(a["calibration_verdict"]));
    EXPECT_LT(a["calibration_error_mm"].get<double>(), 0.4);
    const json all = a["path"].back();
    EXPECT_GT(all["before_max_mm"].get<double>(), 5);
    EXPECT_LT(all["after_three_sigma_mm"].get<double>(), 0.15);
    EXPECT_LT(std::abs(all["after_mean_mm"].get<double>()), 0.03);

    const std::string report = slurp(folder / "out" / "report.html");
    EXPECT_THAT(report, HasSubstr("<svg"));
    EXPECT_THAT(report, HasSubstr("Simulated"));
    EXPECT_EQ(report.find("http://www.w3.org"), report.find("http"))
        << "nothing may be loaded from elsewhere";

    EXPECT_EQ(run_program({"check", project}, folder).exit_code, 0);
    EXPECT_EQ(run_program({"replay", project, "--jobs", "2"}, folder).exit_code, 0);
    // The project runs on its own devices from the command line, too.
    r = run_program({"run", project, "--part", "again", "--json", "-"}, folder);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(json::parse(r.out)["regions"].size(), 4u);
}

// What the killed program said it had stored (runs are numbered as they are committed).
TEST_F(Demo, KilledAtAnyInstantItLeavesASoundFile) {
    const char* wanted = std::getenv("SEAMWRIGHT_KILLS");
    const int kills = wanted ? std::atoi(wanted) : 8;
    std::mt19937 random(5);
    std::uniform_int_distribution<int> wait_ms(500, 14000);
    int with_runs = 0;
    for (int k = 0; k < kills; ++k) {
        const std::string out = (folder / ("k" + std::to_string(k))).string();
        const pid_t child = fork();
        if (child == 0) {
            const int nowhere = open("/dev/null", O_WRONLY);
            dup2(nowhere, 1);
            dup2(nowhere, 2);
            execl(SEAMWRIGHT_PROGRAM, "seamwright", "demo", "--dir", out.c_str(), "--parts", "40", "--seed",
                  "1", static_cast<char*>(nullptr));
            _exit(127);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms(random)));
        ::kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        const auto file = std::filesystem::path(out) / "demo.seam";
        if (!std::filesystem::exists(file))
            continue;  // killed before the file was complete: then there is none
        auto opened = ProjectFile::open(file);
        ASSERT_TRUE(opened) << "kill " << k << ": " << opened.error().sentence();
        EXPECT_TRUE(opened->check().empty()) << "kill " << k;
        auto runs = opened->runs();
        ASSERT_TRUE(runs);
        for (std::size_t i = 0; i < runs->size(); ++i) {
            EXPECT_EQ((*runs)[i].number, static_cast<std::int64_t>(i + 1)) << "kill " << k;
            EXPECT_TRUE(opened->load_run((*runs)[i].number)) << "kill " << k;
        }
        with_runs += !runs->empty();
        std::filesystem::remove_all(out);
    }
    if (kills >= 20) {
        EXPECT_GT(with_runs, 0);
    }
}

}  // namespace
}  // namespace seamwright
