// `seamwright fleet` and `statistics --fleet` as a script calls them, with a real server.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/app/run_program.h"
#include "tests/projects/fleet/postgres_server.h"
#include "tests/projects/statistics/production_runs.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class FleetCommand : public testing::Test {
  protected:
    fs::path folder = test_folder("fleet"), file = folder / "door.seam";
    std::unique_ptr<PostgresServer> server;

    void SetUp() override {
        std::string why;
        server = PostgresServer::start(why);
        if (!server) GTEST_SKIP() << "skipped: " << why;
        const Project project = production_project();
        auto made = ProjectFile::create(file, project);
        ASSERT_TRUE(made);
        for (int i = 0; i < 15; ++i)
            ASSERT_TRUE(made->append_run(production_run(i, {0.1 * (i % 4), 0.2 * (i % 3), 0}), project));
    }
    ~FleetCommand() override { fs::remove_all(folder); }
    ProgramResult run(const std::vector<std::string>& arguments, int exit_code) const {
        ProgramResult r = run_program(arguments, folder);
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        EXPECT_THAT(r.out + r.err, Not(HasSubstr(PostgresServer::kPassword)));
        EXPECT_THAT(r.out + r.err, Not(HasSubstr(PostgresServer::kPasswordInUri)));
        return r;
    }
    json answer(std::vector<std::string> arguments, int exit_code = 0) const {
        arguments.insert(arguments.end(), {"--json", "-"});
        return json::parse(run(arguments, exit_code).out, nullptr, false);
    }
};

TEST_F(FleetCommand, FromTheFileToTheStatisticsOfAllStations) {
    const std::string uri = server->uri();
    EXPECT_THAT(run({"fleet", "publish", file.string(), "--to", uri}, 3).err, HasSubstr("fleet init"));
    EXPECT_EQ(answer({"fleet", "init", "--to", uri})["before"], 0);
    EXPECT_EQ(answer({"fleet", "init", "--to", uri})["before"], 2);
    const json published = answer({"fleet", "publish", file.string(), "--to", uri, "--station", "line 2"});
    EXPECT_EQ(published["published"], 15);
    EXPECT_EQ(published["waiting"], 0);
    EXPECT_EQ(published["station"], "line 2");
    EXPECT_EQ(answer({"fleet", "publish", file.string(), "--to", uri, "--station", "line 2"})["published"],
              0);
    const json status = answer({"fleet", "status", "--to", uri});
    ASSERT_EQ(status["stations"].size(), 1u);
    EXPECT_EQ(status["stations"][0]["parts"], 15);
    EXPECT_EQ(status["stations"][0]["last"]["part"], "car 14");
    EXPECT_EQ(status["parts"].size(), 15u);
    EXPECT_THAT(run({"fleet", "status", "--to", uri}, 0).out, HasSubstr("line 2"));
    const json by_fleet = answer({"statistics", "--fleet", uri, "--station", "line 2"}),
               by_file = answer({"statistics", file.string()});
    EXPECT_EQ(by_fleet["runs"], by_file["runs"]);
    EXPECT_EQ(by_fleet["files"], json::array({"line 2"}));
    EXPECT_NEAR(by_fleet["regions"][0]["characteristics"][0]["s"].get<double>(),
                by_file["regions"][0]["characteristics"][0]["s"].get<double>(), 1e-9);
    run({"statistics", "--fleet", uri, "--html", (folder / "s.html").string(), "--xlsx",
         (folder / "s.xlsx").string(), "--dfq", (folder / "s.dfq").string()},
        0);
    EXPECT_THAT(slurp(folder / "s.html"), HasSubstr("line 2"));
    EXPECT_GT(fs::file_size(folder / "s.xlsx"), 1000u);
    EXPECT_THAT(slurp(folder / "s.dfq"), HasSubstr("K0100"));
    EXPECT_EQ(answer({"statistics", "--fleet", uri, "--since", "1h"}, 1)["status"], "no_production");
}

TEST_F(FleetCommand, WhatIsWrongIsSaid) {
    EXPECT_THAT(run({"fleet", "init", "--to", "door.seam"}, 2).err, HasSubstr("no address"));
    EXPECT_THAT(run({"fleet", "init", "--to", "postgresql://u@127.0.0.1:1/d"}, 3).err,
                HasSubstr("no database server answers"));
    EXPECT_THAT(run({"statistics"}, 2).err, HasSubstr("no file is given"));
    EXPECT_EQ(run_program({"statistics", file.string(), "--fleet", server->uri()}, folder).exit_code, 2);
    EXPECT_EQ(run_program({"run", file.string(), "--fleet", server->uri()}, folder).exit_code, 2);
    EXPECT_THAT(run({"fleet", "publish", (folder / "none.seam").string(), "--to", server->uri()}, 3).err,
                HasSubstr("does not exist"));
}

TEST_F(FleetCommand, AFleetThatTheProjectNamesNeedsNoUrl) {
    EXPECT_THAT(run({"fleet", "publish", file.string()}, 2).err, HasSubstr("names no fleet"));
    EXPECT_THAT(run({"service", file.string(), "--fleet"}, 2).err, HasSubstr("names no fleet"));
    EXPECT_THAT(run({"fleet", "set", file.string(), "--to", server->uri()}, 2).err,
                HasSubstr("no place for a password"));
    EXPECT_THAT(run({"fleet", "set", file.string(), "--to", "postgresql://seam@h/d?password=x"}, 2).err,
                HasSubstr("no place for a password"));
    EXPECT_EQ(run_program({"fleet", "set", file.string(), "--station", "line 2"}, folder).exit_code, 2);
    const std::string uri = server->uri("fleet", "");
    EXPECT_EQ(answer({"fleet", "set", file.string(), "--to", uri, "--station", "line 2"})["to"], uri);
    EXPECT_EQ(answer({"fleet", "set", file.string()})["station"], "line 2");
    EXPECT_THAT(slurp(file), Not(HasSubstr(PostgresServer::kPassword)));
    ::setenv("PGPASSWORD", PostgresServer::kPassword, 1);
    run({"fleet", "init", "--to", uri}, 0);
    const json published = answer({"fleet", "publish", file.string()});
    EXPECT_EQ(published["published"], 15);
    EXPECT_EQ(published["station"], "line 2");
    ::unsetenv("PGPASSWORD");
    EXPECT_THAT(run({"service", file.string(), "--fleet"}, 0).out, HasSubstr(" \"--fleet\"\n"));
    // As a document too: neither out of it nor into it comes a password.
    const auto document = folder / "door.json";
    run({"export", file.string(), "--out", document.string()}, 0);
    std::string text = slurp(document);
    ASSERT_THAT(text, HasSubstr("line 2"));
    for (auto at = text.find("//seam@"); at != std::string::npos; at = text.find("//seam@"))
        text.replace(at, 7, "//seam:secret@");
    std::ofstream(document) << text;
    EXPECT_THAT(run({"import", (folder / "again.seam").string(), "--from", document.string()}, 2).err,
                HasSubstr("holds a password"));
    EXPECT_EQ(answer({"fleet", "set", file.string(), "--remove"})["to"], "");
    EXPECT_THAT(run({"fleet", "publish", file.string()}, 2).err, HasSubstr("names no fleet"));
}

// As long as it runs, it answers; a signal ends it.
TEST_F(FleetCommand, ThePageOfAllStations) {
    const std::string uri = server->uri();
    run({"fleet", "init", "--to", uri}, 0);
    run({"fleet", "publish", file.string(), "--to", uri, "--station", "<line> 2"}, 0);
    const fs::path err = folder / "serve.err";
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        if (!std::freopen("/dev/null", "w", stdout) || !std::freopen(err.c_str(), "w", stderr)) _exit(1);
        execl(SEAMWRIGHT_PROGRAM, SEAMWRIGHT_PROGRAM, "fleet", "status", "--to", uri.c_str(), "--serve",
              "127.0.0.1:0", static_cast<char*>(nullptr));
        _exit(127);
    }
    const std::string said = "status page: http://127.0.0.1:";
    std::string page, metrics;
    const auto get = [&](const std::string& path) {
        const std::string text = slurp(err);
        const auto at = text.find(said);
        if (at == std::string::npos) return std::string();
        const std::string command =
            "exec 3<>/dev/tcp/127.0.0.1/" + std::to_string(std::stoi(text.substr(at + said.size()))) +
            "; printf 'GET " + path +
            " HTTP/1.1\\r\\nHost: localhost\\r\\nConnection: close\\r\\n\\r\\n' >&3; cat <&3";
        (void)!std::system(
            ("bash -c \"" + command + "\" >'" + (folder / "got").string() + "' 2>/dev/null").c_str());
        return slurp(folder / "got");
    };
    for (int i = 0; i < 300 && page.find("car 14") == std::string::npos; ++i) {
        usleep(100000);
        page = get("/");
    }
    EXPECT_THAT(page, HasSubstr("&lt;line&gt; 2"));
    EXPECT_THAT(page, HasSubstr("car 14"));
    EXPECT_THAT(get("/metrics"), HasSubstr("seamwright_fleet_parts_total{station=\"<line> 2\"} 15"));
    EXPECT_THAT(get("/api/state"), HasSubstr("\"parts\":15"));
    EXPECT_THAT(get("/nothing"), HasSubstr("404"));
    kill(child, SIGTERM);
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace seamwright
