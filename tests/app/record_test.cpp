// A session recorded from the command line, and measured again from its capture.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Record : public testing::Test {
  protected:
    // Half a minute of work that all tests begin with: done once, copied.
    static std::filesystem::path& commissioned() {
        static std::filesystem::path folder;
        return folder;
    }
    static void SetUpTestSuite() {
        commissioned() = test_folder("record_demo");
        const auto demo =
            run_program({"demo", "--in-process", "--parts", "1", "--dir", (commissioned() / "out").string()},
                        commissioned());
        ASSERT_EQ(demo.exit_code, 0) << demo.err;
    }
    static void TearDownTestSuite() { std::filesystem::remove_all(commissioned()); }

    std::filesystem::path folder = test_folder("record");
    std::string project = (folder / "out" / "demo.seam").string();
    void SetUp() override {
        std::filesystem::copy(commissioned() / "out", folder / "out",
                              std::filesystem::copy_options::recursive);
    }
    ~Record() override { std::filesystem::remove_all(folder); }
    json answer_of(const std::vector<std::string>& arguments, int exit_code = 0) {
        auto with_json = arguments;
        with_json.insert(with_json.end(), {"--json", "-"});
        const auto r = run_program(with_json, folder);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        return json::parse(r.out, nullptr, false);
    }
};

TEST_F(Record, ASensorThatRefusesItsTriggersIsToldAndEndsIt) {
    const std::string capture = (folder / "refused.capture").string();
    const auto begun = std::chrono::steady_clock::now();
    const auto r = run_program(
        {"record", project, "--out", capture, "--no-robots", "--trigger-hz", "20", "--profiles", "5"},
        folder);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(20));
    EXPECT_EQ(r.exit_code, 3) << r.out;
    EXPECT_THAT(r.err, HasSubstr("the robot has not moved anywhere yet"));
    EXPECT_EQ(answer_of({"check", capture})["status"], "ok") << "what there is of it is whole";
}

TEST_F(Record, NamesInTablesAreOneField) {
    const std::string exported = (folder / "project.json").string(), again = (folder / "again.seam").string(),
                      table = (folder / "shift.csv").string();
    answer_of({"export", project, "--out", exported, "--with-taught"});
    json text = json::parse(std::ifstream(exported));
    text["runs"] = json::array();
    text["events"] = json::array();
    text["project"]["regions"][0]["id"] = "edge, \"left\"";
    std::ofstream(exported) << text.dump();
    answer_of({"import", again, "--from", exported});
    (void)run_program({"known-shift", again, "--range-mm", "1", "--step-mm", "1", "--range-deg", "0.1",
                       "--step-deg", "0.1", "--csv", table},
                      folder);
    const std::string rows = slurp(table);
    EXPECT_THAT(rows, HasSubstr(",\"edge, \"\"left\"\"\","));
    EXPECT_THAT(rows, HasSubstr("translation,X,"));
}

TEST_F(Record, ARunIsMeasuredAgainFromItsCapture) {
    const std::string capture = (folder / "run.capture").string();
    const json run = answer_of({"run", project, "--part", "CAR-7", "--record", capture});
    ASSERT_EQ(run["recording"]["sources"]["A"]["frames"], 16) << run.dump(1).substr(0, 2000);
    EXPECT_EQ(run["recording"]["sources"]["A"]["dropped"], 0);
    const json info = answer_of({"info", capture});
    EXPECT_EQ(info["kind"], "capture");
    EXPECT_EQ(info["sources"][0]["counters"]["frames"], 16);
    EXPECT_EQ(info["sources"][1]["events"]["trigger"], 16);
    EXPECT_EQ(answer_of({"check", capture})["status"], "ok");

    // The same project on the recording instead of the devices.
    const std::string exported = (folder / "project.json").string(), again = (folder / "again.seam").string();
    answer_of({"export", project, "--out", exported, "--with-taught"});
    json text = json::parse(std::ifstream(exported));
    text["runs"] = json::array();
    text["events"] = json::array();
    for (const char* kind : {"sensors", "robots"})
        for (json& device : text["project"][kind]) {
            device["driver"] = "replay";
            device["settings"] = {{"file", capture}, {"source", device["id"]}, {"speed", 0}};
        }
    std::ofstream(exported) << text.dump();
    answer_of({"import", again, "--from", exported});
    const json replayed = answer_of({"run", again, "--part", "CAR-7"}, 1);
    EXPECT_THAT(replayed["message"].get<std::string>(), HasSubstr("calibrated was [simulated"))
        << "a recording is no device: nothing of it may be pushed";
    ASSERT_EQ(replayed["regions"].size(), run["regions"].size()) << replayed.dump(1).substr(0, 2000);
    for (std::size_t i = 0; i < run["regions"].size(); ++i)
        EXPECT_EQ(replayed["regions"][i]["correction"], run["regions"][i]["correction"]) << "bit for bit";
}

TEST_F(Record, ThePathIsCorrectedByARun) {
    const std::string bead = (folder / "out" / "bead.csv").string(), out = (folder / "krc").string();
    const json path =
        answer_of({"path", project, "--path", bead, "--brand", "kuka", "--closed", "--out", out});
    EXPECT_EQ(path["status"], "ok");
    EXPECT_EQ(path["regions"].size(), 4u);
    ASSERT_EQ(path["files"].size(), 2u);
    EXPECT_LT(path["largest_step_mm"]["mm"].get<double>(), 0.6 * path["unblended_step_mm"].get<double>());
    // Inside a region a point moves as the pushed frame does.
    const json info = answer_of({"export", project, "--out", (folder / "p.json").string()});
    const json document = json::parse(std::ifstream(folder / "p.json"));
    const json& run = document["runs"].back();
    EXPECT_EQ(run["number"], path["run"]);
    const auto lines = [](const std::filesystem::path& file) {
        std::ifstream in(file);
        std::vector<std::string> all;
        for (std::string line; std::getline(in, line);) all.push_back(line);
        return all;
    };
    const auto taught = lines(bead), moved = lines(std::filesystem::path(out) / "seamwright_path.csv");
    ASSERT_EQ(taught.size(), moved.size());
    EXPECT_EQ(taught[0], moved[0]);
    const auto krl = lines(std::filesystem::path(out) / "seamwright_path.src");
    EXPECT_EQ(
        std::count_if(krl.begin(), krl.end(), [](const std::string& l) { return l.starts_with("LIN "); }),
        static_cast<std::ptrdiff_t>(taught.size()))
        << "closed: back to the first point";
    // The program that was written is a path like the table it was made beside.
    const std::string written = (std::filesystem::path(out) / "seamwright_path.src").string();
    const json again = answer_of({"path", project, "--path", written});
    EXPECT_EQ(again["status"], "ok");
    EXPECT_EQ(again["points"].get<std::size_t>(), taught.size()) << "with the first point again at its end";
    EXPECT_NEAR(again["largest_shift_mm"].get<double>(), path["largest_shift_mm"].get<double>(), 0.5);
    // The table names every point's region; by the places of the spots alone only some at the corners are told otherwise.
    const std::string unnamed = (folder / "unnamed.csv").string(),
                      by_place = (folder / "by_place.csv").string();
    {
        std::ofstream cut(unnamed);
        for (const std::string& line : taught) cut << line.substr(0, line.rfind(',')) << '\n';
    }
    answer_of({"path", project, "--path", unnamed, "--brand", "kuka", "--closed", "--out", by_place});
    const auto told = lines(std::filesystem::path(by_place) / "seamwright_path.csv");
    ASSERT_EQ(told.size(), moved.size());
    const auto region_of = [](const std::string& line) { return line.substr(line.rfind(',') + 1); };
    int otherwise = 0;
    for (std::size_t i = 1; i < told.size(); ++i) otherwise += region_of(told[i]) != region_of(moved[i]);
    EXPECT_LE(otherwise, static_cast<int>(told.size()) / 6) << "of " << told.size();
    // A wrong notation and a run that is not there.
    EXPECT_EQ(run_program({"path", project, "--path", bead, "--brand", "abb"}, folder).exit_code, 2);
    EXPECT_EQ(
        run_program({"path", project, "--path", bead, "--brand", "kuka", "--run", "99"}, folder).exit_code,
        2);
}

TEST_F(Record, RefusesAnExistingFileAndUnknownDevices) {
    const std::string capture = (folder / "there").string();
    std::ofstream(capture) << "mine";
    EXPECT_EQ(run_program({"record", project, "--out", capture, "--seconds", "1"}, folder).exit_code, 3);
    std::string kept;
    std::getline(std::ifstream(capture), kept);
    EXPECT_EQ(kept, "mine");
    const auto r = run_program({"record", project, "--out", capture + "2", "--sensor", "Z"}, folder);
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_THAT(r.err, HasSubstr("no sensor \"Z\""));
    EXPECT_FALSE(std::filesystem::exists(capture + "2"));
}

TEST_F(Record, EndsInOrderOnSigterm) {
    const std::string capture = (folder / "signal.capture").string();
    // "exec" gives the shell's process to the program, so that its number is the program's.
    const std::string command = "echo $$ > " + (folder / "pid").string() + "; exec " + SEAMWRIGHT_PROGRAM +
                                " record " + project + " --out " + capture +
                                " --trigger-hz 20 > /dev/null 2>&1";
    int status = -1;
    std::thread program([&] { status = std::system(("sh -c '" + command + "'").c_str()); });
    for (int i = 0; i < 200 && !std::filesystem::exists(capture); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    int pid = 0;
    std::ifstream(folder / "pid") >> pid;
    ASSERT_GT(pid, 1);
    kill(pid, SIGTERM);
    program.join();
    ASSERT_TRUE(WIFEXITED(status)) << "ended by itself, not by the signal";
    EXPECT_EQ(WEXITSTATUS(status), 1) << "the simulated robot stands nowhere yet: no frame came";
    const json info = answer_of({"info", capture});
    EXPECT_EQ(info["end"], "stopped");
    EXPECT_FALSE(info["finished_utc"].get<std::string>().empty());
}

}  // namespace
}  // namespace seamwright
