// The whole job as a newcomer starts it, and what is left of it when it is killed.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <thread>

#include "projects/file/project_file.h"
#include "tests/app/run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Demo : public testing::Test {
  protected:
    std::filesystem::path folder = test_folder("demo");
    ~Demo() override { std::filesystem::remove_all(folder); }
    void serve_the_line(const std::string& out) const;
};

TEST_F(Demo, TakesADisplacedDoorWithinATenthAndThenServesTheLine) {
    const std::string project = (folder / "out" / "demo.seam").string();
    const ProgramResult r =
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
    serve_the_line((folder / "out").string());
}

// A weak distortion, where a cost that is not the image's leads into the fold of the lens.
TEST_F(Demo, CalibratesWhereTheDistortionIsWeak) {
    for (const char* seeds : {"11", "22", "28"}) {
        const ProgramResult r = run_program(
            {"demo", "--dir", (folder / "out").string(), "--seeds", seeds, "--parts", "0", "--json", "-"},
            folder);
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const json row = json::parse(r.out)["seeds"].front();
        EXPECT_EQ(row["outcome"], "ok") << row;
        EXPECT_THAT((std::vector<std::string>{"good", "usable"}),
                    testing::Contains(row["calibration_verdict"]));
        EXPECT_LT(row["calibration_error_mm"].get<double>(), 0.4);
    }
    EXPECT_EQ(run_program({"demo", "--seeds", "9..3"}, folder).exit_code, 2);
    EXPECT_EQ(run_program({"demo", "--parts", "0"}, folder).exit_code, 2);
}

// The plant in small: the cell as a process of its own, the runner waiting for the line's calls.
void Demo::serve_the_line(const std::string& out) const {
    const std::string project = out + "/demo.seam";
    FILE* cell =
        // Camera and controller stand where the demo left them in cell.json.
        popen((std::string(SEAMWRIGHT_PROGRAM) + " sim-cell " + out + "/cell.json --project " + project +
               " > " + out + "/cell.out 2>&1")
                  .c_str(),
              "w");
    ASSERT_TRUE(cell);
    const auto say = [&](const std::string& line) {
        std::fputs((line + "\n").c_str(), cell);
        std::fflush(cell);
    };
    const std::string log = out + "/watch.log";
    const auto logged = [&](const std::string& event) {
        int count = 0;
        std::istringstream lines(slurp(log));
        for (std::string line; std::getline(lines, line);) {
            const json e = json::parse(line, nullptr, false);
            EXPECT_TRUE(e.is_object()) << line;
            count += e.is_object() && e["event"] == event;
        }
        return count;
    };
    const auto wait_for = [&](const std::string& event, int count) {
        for (int i = 0; i < 600; ++i) {
            if (std::filesystem::exists(log) && logged(event) >= count) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
        return false;
    };
    std::thread line([&] {
        EXPECT_TRUE(wait_for("connected", 1));
        say(R"(part {"displacement": {"xyz": [4, -3, 2], "abc": [0.2, 0.1, -0.3]}})");
        say("start CAR-1");
        EXPECT_TRUE(wait_for("run", 1));
        say(R"(part {"displacement": {"xyz": [-6, 5, 1], "abc": [-0.1, 0.3, 0.2]}})");
        say("start CAR-2");
        EXPECT_TRUE(wait_for("run", 2));
        // The call itself is what the line breaks in; the robot makes it again.
        say("fault disconnect");
        say("start CAR-3");
        EXPECT_TRUE(wait_for("lost", 1));
        say("fault none");
        EXPECT_TRUE(wait_for("back", 1));
    });
    // The fleet's database is away: the parts wait in the file, and nothing else waits for it.
    const ProgramResult r =
        run_program({"run", project, "--watch", "--push", "--parts", "3", "--log", log, "--fleet",
                     "postgresql://seam:secret@127.0.0.1:1/fleet", "--station", "cell 7", "--json", "-"},
                    folder);
    EXPECT_NE(r.err.find("runs wait for the fleet's database"), std::string::npos) << r.err;
    EXPECT_EQ(r.err.find("secret"), std::string::npos) << r.err;
    line.join();
    say("state");
    say("stop");
    EXPECT_EQ(pclose(cell), 0) << slurp(out + "/cell.out");
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json counts = json::parse(r.out);
    EXPECT_EQ(counts["corrected"], 3) << slurp(log);
    EXPECT_EQ(counts["outages"], 1);
    std::istringstream states(slurp(out + "/cell.out"));
    json last;
    for (std::string text; std::getline(states, text);)
        if (text.starts_with("{")) last = json::parse(text);
    EXPECT_EQ(last["controllers"][0]["released"], true)
        << "the runner has gone, but the application had taken the part's frames";
    EXPECT_EQ(last["controllers"][0]["verdict"], "corrected");

    auto file = ProjectFile::open(project);
    ASSERT_TRUE(file);
    const auto runs = *file->runs();
    ASSERT_GE(runs.size(), 3u);
    EXPECT_EQ(file->queued().value(), static_cast<std::int64_t>(runs.size()));
    const auto evidence = *file->evidence();
    EXPECT_EQ(std::count_if(evidence.begin(), evidence.end(),
                            [](const Evidence& e) { return kind_of(e) == kHeadlessRun; }),
              1)
        << "three good parts, one proof";
    const auto second = file->load_run(runs[runs.size() - 2].number, false);
    EXPECT_EQ(second->part_id, "CAR-2");
    const Pose d = second->regions.front().correction->displacement.workobject_from_movedworkobject;
    EXPECT_NEAR(d.translation().x(), -6, 0.5);
    EXPECT_NEAR(d.translation().y(), 5, 0.5);
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
