// `seamwright evaluate|replay|acceptance --engine slurm` on a Slurm that the test starts itself: the same to the bit as here, whatever
// is killed in between.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/app/run_program.h"
#include "tests/projects/batch/slurm_server.h"
#include "tests/projects/file/replay_store.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class SlurmCommand : public testing::Test {
  protected:
    static void SetUpTestSuite() { server_ = SlurmServer::start(2, why_).release(); }
    static void TearDownTestSuite() {
        delete server_;
        server_ = nullptr;
    }
    void SetUp() override {
        if (!server_) GTEST_SKIP() << "skipped: " << why_;
    }
    ~SlurmCommand() override { fs::remove_all(folder); }

    json answer(std::vector<std::string> words, int exit_code = 0) {
        words.insert(words.end(), {"--json", "-"});
        last = run_program(words, folder);
        EXPECT_EQ(last.exit_code, exit_code) << last.err << last.out;
        json out = json::parse(last.out, nullptr, false);
        for (const char* of_this_time : {"seconds", "jobs"})
            if (out.is_object()) out.erase(of_this_time);
        return out;
    }
    std::vector<std::string> by_slurm(std::vector<std::string> words, int tasks,
                                      const std::string& name = "job") {
        words.insert(words.end(), {"--engine", "slurm", "--tasks", std::to_string(tasks), "--folder",
                                   (folder / name).string()});
        return words;
    }
    // In the background; its number.
    pid_t begin(std::vector<std::string> words) {
        words.insert(words.begin(), SEAMWRIGHT_PROGRAM);
        std::vector<char*> arguments;
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        const pid_t child = ::fork();
        if (child == 0) {
            if (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr))
                ::_exit(126);
            ::execv(arguments[0], arguments.data());
            ::_exit(127);
        }
        return child;
    }
    int parts(const std::string& name = "job") const {
        int n = 0;
        std::error_code none;
        for (const auto& entry : fs::directory_iterator(folder / name, none))
            n += entry.path().filename().string().starts_with("part-");
        return n;
    }
    void wait_for_parts(int least, const std::string& name = "job") const {
        for (int i = 0; i < 3000 && parts(name) < least; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        ASSERT_GE(parts(name), least);
    }
    // All tasks, those that run at once: what ends by itself within Slurm's half a minute of grace would be done.
    static void take_away() {
        SlurmServer::ask("scancel --user=root --state=PENDING");
        SlurmServer::ask("scancel --user=root --full --signal=KILL");
    }
    static std::string queue() { return SlurmServer::ask("squeue --noheader --array --format='%K %t'"); }

    inline static SlurmServer* server_ = nullptr;
    inline static std::string why_;
    fs::path folder = test_folder("slurm");
    ProgramResult last;
    const std::vector<std::string> experiment{"evaluate", "--experiment", "2", "--seed", "3", "--jobs", "1"};
};

TEST_F(SlurmCommand, AnEvaluationIsTheSameToTheBit) {
    const json here = answer(experiment);
    ASSERT_FALSE(here.is_discarded() || here.empty());
    EXPECT_EQ(answer(by_slurm(experiment, 3)), here);
    // Everything is there: nothing is begun, and the same comes out.
    last = run_program(by_slurm(experiment, 3), folder);
    EXPECT_EQ(last.err.find("Slurm has"), std::string::npos) << last.err;
    // Another seed is another job.
    auto other = experiment;
    other[4] = "4";
    EXPECT_EQ(run_program(by_slurm(other, 3), folder).exit_code, 2);
}

TEST_F(SlurmCommand, AReplayAndAnAcceptanceAreTheSameToTheBit) {
    const auto file = (folder / "a.seam").string();
    store_runs(file, 30, 6, "master");
    {
        auto project = ProjectFile::open(file);
        auto run = project->load_run(2);
        double& x = run->spots[3].measured_mm.x();
        x = std::nextafter(x, 1e9);
        ASSERT_TRUE(project->append_run(*run, *project->load_run_setup(2)));
    }
    const json here = answer({"replay", file}, 1);
    ASSERT_EQ(here.at("files").size(), 1u);
    EXPECT_FALSE(here["files"][0].at("differences").empty()) << "the changed value is told";
    EXPECT_EQ(answer(by_slurm({"replay", file}, 7), 1), here);
    const std::vector<std::string> judged{"acceptance",     file, "--region", "inner",
                                          "--reference",    "0",  "--study",  "type1",
                                          "--tolerance-mm", "1"};
    last = run_program(judged, folder);
    const int code = last.exit_code;
    ASSERT_LE(code, 1) << last.err;
    const json by_tasks = answer(by_slurm(judged, 5, "judged"), code);
    EXPECT_EQ(by_tasks, answer(judged, code));
}

// Killed with -9 while it waits, twice; the tasks are taken away from Slurm, its controller is killed: what is done stays
// done.
TEST_F(SlurmCommand, WhatIsKilledGoesOn) {
    const json here = answer(experiment);
    for (int kill = 0; kill < 2; ++kill) {
        const pid_t child = begin(by_slurm(experiment, 8));
        wait_for_parts(kill == 0 ? 1 : 3);
        ::kill(child, SIGKILL);
        int status = 0;
        ::waitpid(child, &status, 0);
        if (kill == 0) {
            // The tasks do not notice; who comes again finds them under way.
            EXPECT_NE(queue(), "");
            continue;
        }
        const std::string before = queue();
        take_away();
        EXPECT_NE(before, "") << "all was done before";
        for (int i = 0; i < 1500 && !queue().empty(); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(40));
        server_->kill_controller();
        ASSERT_TRUE(server_->resume_controller());
    }
    for (int i = 0; i < 1500 && !queue().empty(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(40));
    const int kept = parts();
    EXPECT_LT(kept, 8);
    const auto before = fs::last_write_time(folder / "job" / "part-0.json");
    EXPECT_EQ(answer(by_slurm(experiment, 8)), here);
    EXPECT_THAT(last.err, HasSubstr(fmt::format("Slurm has {} tasks", 8 - kept)));
    EXPECT_EQ(fs::last_write_time(folder / "job" / "part-0.json"), before);
}

// Taken away while it runs; the same command begins it again.
TEST_F(SlurmCommand, AFailedTaskIsNamedWithItsLog) {
    const auto words = by_slurm(experiment, 2);
    const fs::path told = folder / "told.json";
    auto told_in_file = words;
    told_in_file.insert(told_in_file.end(), {"--json", told.string()});
    const pid_t child = begin(told_in_file);
    for (int i = 0; i < 1500 && queue().find('R') == std::string::npos; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    take_away();
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 3);
    const json failed = json::parse(slurp(told), nullptr, false);
    ASSERT_TRUE(failed.is_object()) << slurp(told);
    EXPECT_EQ(failed.at("status"), "failed");
    ASSERT_FALSE(failed.at("failed").empty());
    for (const json& task : failed["failed"]) {
        EXPECT_LT(task.at("task").get<int>(), 2);
        EXPECT_FALSE(task.at("why").empty());
        EXPECT_TRUE(task.at("log").get<std::string>().starts_with((folder / "job").string())) << task;
    }
    EXPECT_EQ(answer(words)["status"], answer(experiment)["status"]);
}

TEST_F(SlurmCommand, WhatSlurmRefusesIsSaidInItsWords) {
    auto words = by_slurm(experiment, 2);
    words.push_back("--sbatch=--partition=nowhere");
    last = run_program(words, folder);
    EXPECT_EQ(last.exit_code, 3);
    EXPECT_THAT(last.err, AllOf(HasSubstr("Slurm refuses the job"), HasSubstr("partition")));
    EXPECT_EQ(run_program({"evaluate", "--engine", "slurm"}, folder).exit_code, 2) << "without a folder";
    EXPECT_EQ(run_program({"evaluate", "--experiment", "panel", "--engine", "slurm"}, folder).exit_code, 2);
}

// The times are printed, not judged: other programs run beside it.
TEST_F(SlurmCommand, TwoWorkersAgainstOne) {
    std::vector<json> answers;
    for (const bool two : {false, true}) {
        auto all = by_slurm(experiment, 4, two ? "two" : "one");
        if (!two) all.push_back("--sbatch=--array=0-3%1");
        const auto begun = std::chrono::steady_clock::now();
        answers.push_back(answer(all));
        fmt::print("{} at a time: {:.1f} s\n", two ? "two" : "one",
                   std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
    }
    EXPECT_EQ(answers[0], answers[1]);
}

}  // namespace
}  // namespace seamwright
