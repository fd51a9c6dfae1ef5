// `run --push` as a script calls it: what stops it before anything moves, and what it says about the release.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "projects/file/project_file.h"
#include "tests/app/run_program.h"
#include "tests/projects/door_project.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class RunCommand : public testing::Test {
  protected:
    fs::path folder = test_folder("run_command"), file = folder / "door.seam";
    Project project;

    void SetUp() override {
        json settings = cell_settings(Pose::Identity());
        const auto cell = SimulatedCell::open(settings).value();
        settings["robot"]["frames"]["path"] = pose_json(cell->base_from_workobject());
        project = door_project(*cell, settings);
        ASSERT_TRUE(ProjectFile::create(file, project));
        ASSERT_NE(run({"run", file.string()}).exit_code, 3);
        // References as the first run measures them.
        auto opened = ProjectFile::open(file).value();
        const RunRecord first = opened.load_run(1).value();
        for (std::size_t i = 0; i < first.spots.size(); ++i) {
            project.spots[i].enabled = first.spots[i].status == SpotStatus::measured;
            project.spots[i].reference_mm = first.spots[i].measured_mm;
        }
        ASSERT_TRUE(opened.save(project));
    }
    ~RunCommand() override { fs::remove_all(folder); }
    ProgramResult run(const std::vector<std::string>& arguments) const {
        return run_program(arguments, folder);
    }
    json pushed(int exit_code) const {
        const ProgramResult r = run({"run", file.string(), "--part", "CAR-1", "--push", "--json", "-"});
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        return json::parse(r.out, nullptr, false);
    }
    template <class Change>
    void change(const Change& apply) {
        Project changed = project;
        apply(changed);
        auto opened = ProjectFile::open(file);
        ASSERT_TRUE(opened);
        ASSERT_TRUE(opened->save(changed));
    }
    std::size_t runs() const { return ProjectFile::open(file)->runs()->size(); }
};

TEST_F(RunCommand, SaysWhatBecameOfTheRelease) {
    const json answer = pushed(0);
    EXPECT_EQ(answer["status"], "ok");
    EXPECT_EQ(answer["release"]["R1"], "taken");
    EXPECT_EQ(answer["regions"][0]["push"]["release"], "taken");
    EXPECT_EQ(run({"run", file.string(), "--hold", "5"}).exit_code, 2) << "only with --push";
}

// A log is written on and rotated away, so nothing but a log may be one.
TEST_F(RunCommand, ALogIsNoOtherKindOfFile) {
    const fs::path notes = folder / "notes.txt", before = folder / "before.seam";
    std::ofstream(notes) << "written by hand\n";
    fs::copy_file(file, before);
    const auto bytes = [](const fs::path& of) {
        std::ifstream in(of, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    for (const fs::path& log : {before, notes}) {
        const std::string was = bytes(log);
        const ProgramResult r = run({"run", file.string(), "--watch", "--parts", "1", "--log", log.string()});
        EXPECT_EQ(r.exit_code, 2) << r.err;
        EXPECT_THAT(r.err, HasSubstr("give the name of another file"));
        EXPECT_EQ(bytes(log), was) << log;
    }
}

TEST_F(RunCommand, WhatConcernsMotionStopsItBeforeADeviceIsTouched) {
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<std::pair<const char*, std::function<void(Project&)>>> cases = {
        {"no region", [](Project& p) { p.regions.clear(); }},
        {"is none", [&](Project& p) { p.regions[0].limits.translation_mm = inf; }},
        {"is none", [&](Project& p) { p.regions[0].sigma_limit_mm = inf; }},
        {"writes the same frame",
         [](Project& p) {
             p.regions.push_back(p.regions[0]);
             p.regions[1].id = "again";
             p.regions[1].frame_name = "PATH";
         }},
        {"speed", [](Project& p) { p.spots[0].enabled = true, p.spots[0].speed_mm_s = -1; }},
    };
    const std::size_t before = runs();
    for (const auto& [words, spoil] : cases) {
        SCOPED_TRACE(words);
        change(spoil);
        const json answer = pushed(1);
        EXPECT_EQ(answer["status"], "refused");
        EXPECT_THAT(answer["findings"].dump(), HasSubstr(words));
        EXPECT_EQ(runs(), before) << "nothing was measured";
        EXPECT_EQ(ProjectFile::open(file)->events()->back().kind, EventKind::refusal);
    }
}

// The program itself, killed between and in its runs; the same command goes on.
TEST_F(RunCommand, AnAcceptanceGoesOnAfterAKill) {
    const std::vector<std::string> command = {"acceptance",     file.string(), "--study",
                                              "type1",          "--runs",      "5",
                                              "--tolerance-mm", "5",           "--keep-requirements"};
    const std::size_t before = runs();
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        std::vector<const char*> words{SEAMWRIGHT_PROGRAM};
        for (const std::string& word : command) words.push_back(word.c_str());
        words.push_back(nullptr);
        if (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr)) _exit(1);
        execv(SEAMWRIGHT_PROGRAM, const_cast<char* const*>(words.data()));
        _exit(1);
    }
    int status = 0;
    while (runs() < before + 3 && waitpid(child, &status, WNOHANG) == 0) usleep(5000);
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself";
    const auto whole = [&] {
        int n = 0;
        const auto all = ProjectFile::open(file)->runs().value();
        for (const RunSummary& r : all) n += r.part_id.starts_with("zero shift") && r.status == RunStatus::ok;
        return n;
    };
    const int made = whole();
    EXPECT_LT(made, 5);
    std::vector<std::string> again = command;
    again.insert(again.end(), {"--json", "-"});
    const ProgramResult r = run(again);
    EXPECT_EQ(r.exit_code, 1) << r.err;  // five values prove nothing
    EXPECT_THAT(r.err, HasSubstr("forecast: s "));
    const json answer = json::parse(r.out, nullptr, false);
    EXPECT_EQ(answer["status"], "too_little_data");
    EXPECT_EQ(answer["type1"]["n"], 5);
    EXPECT_EQ(answer["plan"]["complete"], true);
    EXPECT_EQ(answer["plan"]["made"], 5);
    EXPECT_EQ(answer["plan"]["resumed"], made > 0);
    EXPECT_TRUE(answer["type1"]["forecast"].contains("s")) << answer["type1"].dump();
    EXPECT_EQ(whole(), 5);
    // The tolerance is the project's now; nothing is measured again.
    const std::size_t stored = runs();
    const ProgramResult kept =
        run({"acceptance", file.string(), "--study", "type1", "--runs", "5", "--json", "-"});
    EXPECT_EQ(json::parse(kept.out, nullptr, false)["settings"]["from"]["tolerance_mm"], "project")
        << kept.err;
    EXPECT_EQ(runs(), stored);
    // Without a person at the keyboard the parts are waited for.
    const ProgramResult parts = run(
        {"acceptance", file.string(), "--study", "type3", "--runs", "2", "--parts", "A,B", "--json", "-"});
    EXPECT_EQ(parts.exit_code, 1) << parts.err;
    const json waits = json::parse(parts.out, nullptr, false);
    EXPECT_EQ(waits["status"], "incomplete");
    EXPECT_THAT(waits["plan"]["stopped"].get<std::string>(), HasSubstr("part A is waited for"));
    EXPECT_EQ(runs(), stored);
}

TEST_F(RunCommand, AKeptOffsetIsSaidWhereItActs) {
    change([](Project& p) { p.regions[0].offsets = {{1, "2024-05-01T12:00:00.000Z", "cmm", {0, 0, 0.05}}}; });
    const auto offset_of_run = [&] {
        const ProgramResult r = run({"run", file.string(), "--part", "CAR-2", "--json", "-"});
        const json answer = json::parse(r.out, nullptr, false);
        return answer["regions"][0].value("offset", json());
    };
    EXPECT_TRUE(offset_of_run().is_null()) << "kept, not switched on";
    EXPECT_EQ(run({"acceptance", file.string(), "--switch-offset", "2"}).exit_code, 2);
    const ProgramResult on = run({"acceptance", file.string(), "--switch-offset", "1"});
    EXPECT_EQ(on.exit_code, 0) << on.err;
    EXPECT_THAT(on.out, HasSubstr("ACTS"));
    EXPECT_EQ(offset_of_run()["version"], 1);
    EXPECT_THAT(run({"run", file.string(), "--part", "CAR-3"}).out, HasSubstr("kept offset 1 acts"));
    EXPECT_EQ(run({"acceptance", file.string(), "--undo-offset"}).exit_code, 0);
    EXPECT_TRUE(offset_of_run().is_null());
    EXPECT_EQ(run({"acceptance", file.string(), "--undo-offset"}).exit_code, 2);
}

TEST_F(RunCommand, ATaughtFrameInMetresIsRefused) {
    change([](Project& p) { p.regions[0].base_from_frame.translation() *= 1e-3; });
    const json answer = pushed(1);
    EXPECT_EQ(answer["status"], "refused");
    EXPECT_THAT(answer["regions"][0]["refusals"].dump(), HasSubstr("would jump"));
    EXPECT_EQ(answer["regions"][0]["push"]["status"], "not_pushed");
}

// The runner and a PLC that is another program's (mbpoll).
TEST_F(RunCommand, ThePlcStartsAPart) {
    const ProgramResult set =
        run({"line", "set", file.string(), "plc", "--protocol", "modbus-server", "--settings",
             R"({"port": 0, "start": "line", "call_timeout_ms": 60000})", "--json", "-"});
    ASSERT_EQ(set.exit_code, 0) << set.err;
    const fs::path err = folder / "watch.err";
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        if (!std::freopen("/dev/null", "w", stdout) || !std::freopen(err.c_str(), "w", stderr)) _exit(1);
        execl(SEAMWRIGHT_PROGRAM, SEAMWRIGHT_PROGRAM, "run", file.c_str(), "--watch", "--push", "--parts",
              "1", static_cast<char*>(nullptr));
        _exit(127);
    }
    const std::string said = "line plc: modbus-server, port ";
    const auto wait_for = [&](const auto& condition) {
        for (int i = 0; i < 600; ++i) {
            if (condition()) return true;
            usleep(100000);
        }
        return false;
    };
    EXPECT_TRUE(wait_for([&] { return slurp(err).find(said) != std::string::npos; })) << slurp(err);
    const std::string text = slurp(err);
    const std::string port =
        std::to_string(std::stoi("0" + text.substr(std::min(text.size(), text.find(said) + said.size()))));
    const auto mbpoll = [&](const std::string& arguments) {
        const fs::path out = folder / "mbpoll.txt";
        (void)!std::system(
            ("mbpoll -m tcp -0 -1 -a 1 -t 4 -p " + port + " " + arguments + " >'" + out.string() + "' 2>&1")
                .c_str());
        return slurp(out);
    };
    EXPECT_TRUE(wait_for([&] { return mbpoll("-r 1 127.0.0.1 0").find("Written 1") != std::string::npos; }));
    EXPECT_TRUE(
        wait_for([&] { return mbpoll("-r 102 -c 1 127.0.0.1").find("[102]: \t1") != std::string::npos; }));
    mbpoll("-r 2 127.0.0.1 0 0 0 815");
    mbpoll("-r 1 127.0.0.1 1");
    // The part ends the watching, and the server with it: what was told is in the file.
    int status = 0;
    EXPECT_TRUE(wait_for([&] { return waitpid(child, &status, WNOHANG) == child; })) << slurp(err);
    kill(child, SIGKILL);
    EXPECT_EQ(WEXITSTATUS(status), 0) << slurp(err);
    const auto all = ProjectFile::open(file)->runs().value();
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all.back().part_id, "815");
    EXPECT_EQ(all.back().status, RunStatus::ok);
}

}  // namespace
}  // namespace seamwright
