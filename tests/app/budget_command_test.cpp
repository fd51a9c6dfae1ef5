// `seamwright budget`: the contract from the outside, on a project of the test cell.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "projects/file/project_file.h"
#include "tests/app/run_program.h"
#include "tests/projects/fake_cell.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kMoved = R"({"xyz":[8,-7,9],"abc":[0.4,-0.3,0.8]})";

class BudgetCommand : public testing::Test {
  protected:
    std::filesystem::path folder = test_folder("budget"), file = folder / "cell.seam";
    Project project = make_fake_cell()->project;

    void SetUp() override {
        project.robots.front().arrival_covariance = 4e-4 * Matrix6::Identity();
        project.robots.front().arrival_covariance.bottomRightCorner<3, 3>() *= 1e-6;
        project.calibrations.front().covariance = 1e-3 * Matrix6::Identity();
        project.calibrations.front().covariance.bottomRightCorner<3, 3>() *= 1e-3;
        project.calibrations.front().method = "hand-eye";
        for (Spot& s : project.spots) s.jitter_mm = 0.5;
        project.regions.back().spot_ids = {"S1", "S2", "S3", "S4", "S5"};
        ASSERT_TRUE(ProjectFile::create(file, project));
    }
    ~BudgetCommand() override { std::filesystem::remove_all(folder); }
    ProgramResult run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "budget");
        return run_program(arguments, folder);
    }
    json answer(std::vector<std::string> arguments, int exit_code) const {
        arguments.insert(arguments.begin(), file.string());
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        return json::parse(r.out, nullptr, false);
    }
    void refused(const std::vector<std::string>& arguments, const std::string& part,
                 int exit_code = 2) const {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        EXPECT_THAT(r.err, HasSubstr(part));
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_EQ(r.out, "");
    }
    template <class Change>
    std::string changed(const std::string& name, const Change& apply) const {
        Project p = project;
        apply(p);
        const auto path = folder / name;
        EXPECT_TRUE(ProjectFile::create(path, p));
        return path.string();
    }
};

TEST_F(BudgetCommand, EveryRegionAndMeasurand) {
    const json j = answer({"--displacement", kMoved}, 0);
    EXPECT_EQ(j["status"], "ok");
    ASSERT_EQ(j["regions"].size(), 2u);
    EXPECT_EQ(j["regions"][0]["id"], "inner");
    for (const json& region : j["regions"]) {
        ASSERT_EQ(region["measurands"].size(), 8u);
        EXPECT_NEAR(region["displacement"]["xyz"][2].get<double>(), 9, 1e-9);
        for (const json& m : region["measurands"]) {
            double share = 0, squares = 0;
            for (const json& row : m["rows"]) {
                share += row["share_percent"].get<double>();
                squares += std::pow(row["u"].get<double>(), 2);
            }
            EXPECT_NEAR(share, 100, 1e-9);
            EXPECT_NEAR(std::sqrt(squares), m["u"].get<double>(), 1e-12);
            EXPECT_NEAR(std::hypot(m["u_random"].get<double>(), m["u_systematic"].get<double>()),
                        m["u"].get<double>(), 1e-12);
            EXPECT_NEAR(m["expanded"].get<double>(), m["k"].get<double>() * m["u"].get<double>(), 1e-12);
            EXPECT_TRUE(m["degrees"].is_null());
            EXPECT_FALSE(m.contains("monte_carlo"));
        }
    }
    EXPECT_EQ(j["regions"][0]["measurands"][0]["name"], "normal");
    EXPECT_EQ(j["regions"][0]["measurands"][7]["unit"], "deg");
    const json one = answer({"--region", "outer"}, 0);
    ASSERT_EQ(one["regions"].size(), 1u);
    // As taught the hand-eye does not show.
    for (const json& row : one["regions"][0]["measurands"][0]["rows"])
        EXPECT_EQ(row["u"] == 0, row["source"] == "hand_eye") << row["source"];
}

TEST_F(BudgetCommand, WhatNobodyMeasuresIsStatedAndKept) {
    const auto across = [](const json& j, const std::string& source) {
        double squares = 0;
        for (const json& row : j["regions"][0]["measurands"][0]["rows"])
            if (row["source"] == source) squares += std::pow(row["u"].get<double>(), 2);
        return std::sqrt(squares);
    };
    const std::vector<std::string> moved{"--displacement", kMoved, "--region", "inner"};
    EXPECT_EQ(across(answer(moved, 0), "workobject"), 0);
    std::vector<std::string> stated = moved;
    stated.insert(stated.end(), {"--state", "workobject_mm=2", "--state", "A:scale_x=0.001"});
    const json j = answer(stated, 0);
    EXPECT_GT(across(j, "workobject"), 0);
    EXPECT_GT(across(j, "scale_x"), 0);
    EXPECT_EQ(answer(moved, 0)["regions"], j["regions"]) << "kept in the project";
    // Twice as much stated is twice as much in the budget.
    stated[5] = "workobject_mm=4";
    EXPECT_NEAR(across(answer(stated, 0), "workobject"), 2 * across(j, "workobject"), 1e-12);
}

TEST_F(BudgetCommand, ARefusedStatementChangesNothing) {
    const std::string f = file.string();
    refused({f, "--state", "workobject_mm"}, "NAME=VALUE");
    refused({f, "--state", "workobject_mm=nan"}, "NAME=VALUE");
    refused({f, "--state", "workobject_mm=-1"}, "NAME=VALUE");
    refused({f, "--state", "workobject_mm=1000"}, "one standard deviation is meant");
    refused({f, "--state", "nobody:speed_change=0.1"}, "no robot \"nobody\"");
    refused({f, "--state", "nobody:shear=0.001"}, "no sensor \"nobody\"");
    refused({f, "--state", "A:colour=0.1"}, "nothing is called \"colour\"");
    refused({f, "--state", "workobject_mm=2", "--state", "A:shear=x"}, "NAME=VALUE");
    refused({f, "--state", "workobject_mm=2", "--region", "nope"}, "no region \"nope\"");
    refused({f, "--state", "workobject_mm=2", "--out", (folder / "none" / "b.html").string()}, "b.html", 3);
    const auto read = ProjectFile::open(file, FileAccess::read_only);
    ASSERT_TRUE(read);
    EXPECT_TRUE(read->load()->part.workobject_covariance.isZero(0));
}

TEST_F(BudgetCommand, MonteCarloIsRepeatableAndBesideTheFirstOrder) {
    const std::vector<std::string> arguments{"--displacement", kMoved,  "--region", "inner", "--monte-carlo",
                                             "--most-trials",  "20000", "--seed",   "7"};
    const json j = answer(arguments, 0);
    const json& region = j["regions"][0];
    EXPECT_EQ(region["monte_carlo"]["trials"], 20000);
    EXPECT_EQ(region["monte_carlo"]["seed"], 7);
    EXPECT_EQ(region["monte_carlo"]["first_order_holds"], true);
    for (const json& m : region["measurands"])
        EXPECT_NEAR(m["monte_carlo"]["u"].get<double>() / m["u"].get<double>(), 1, 0.03);
    EXPECT_EQ(answer(arguments, 0), j);
}

TEST_F(BudgetCommand, WhereTheFirstOrderDoesNotHoldTheExitCodeSaysSo) {
    const std::string jittering = changed("jitter.seam", [](Project& p) {
        for (Spot& s : p.spots) s.sigma_mm = 0.005, s.stop_at_trigger = true;
        p.robots.front().arrival_covariance.setZero();
        p.calibrations.front().covariance.setZero();
        p.spots.front().stop_at_trigger = false;
        p.spots.front().jitter_mm = 30;
    });
    const ProgramResult r =
        run({jittering, "--region", "inner", "--displacement", R"({"xyz":[0,0,0],"abc":[2,-1.5,1.5]})",
             "--monte-carlo", "--most-trials", "10000"});
    EXPECT_EQ(r.exit_code, 1) << r.err;
    EXPECT_THAT(r.out, HasSubstr("the first order does not hold: "));
}

TEST_F(BudgetCommand, PageInGerman) {
    const auto page = folder / "budget.html";
    const ProgramResult r = run({file.string(), "--out", page.string(), "--language", "de"});
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_THAT(r.out, HasSubstr("Uncertainty budget: cell.seam"));
    EXPECT_THAT(slurp(page), HasSubstr("Unsicherheitsbudget: cell.seam"));
    EXPECT_THAT(slurp(page), HasSubstr("<svg"));
    refused({file.string(), "--out", (folder / "no/such/folder.html").string()}, "folder.html", 3);
}

TEST_F(BudgetCommand, AnUnderDeterminedRegionIsAVerdict) {
    const std::string two = changed("two.seam", [](Project& p) {
        p.regions.front().spot_ids = {"S1", "S4"};
    });
    const ProgramResult r = run({two});
    EXPECT_EQ(r.exit_code, 1) << r.err;
    EXPECT_THAT(r.out, HasSubstr("under-determined"));
}

TEST_F(BudgetCommand, HostileInputIsOneSentence) {
    const std::string f = file.string();
    refused({f, "--region", "roof"}, "there is no region \"roof\"");
    refused({f, "--displacement", R"({"xyz":[NaN,0,0],"abc":[0,0,0]})"}, "--displacement");
    refused({f, "--displacement", R"({"xyz":[null,0,0],"abc":[0,0,0]})"}, "--displacement");
    refused({f, "--displacement", R"({"xyz":[1e400,0,0],"abc":[0,0,0]})"}, "--displacement");
    refused({f, "--displacement", R"({"xyz":[1,0,0]})"}, "--displacement");
    refused({f, "--displacement", R"({"xyz":[1000,0,0],"abc":[0,0,0]})"}, "beyond the region's limits");
    refused({f, "--displacement", (folder / "none.json").string()}, "none.json", 3);
    refused({(folder / "none.seam").string()}, "none.seam", 3);
    refused({changed("empty.seam", [](Project& p) { p.regions.clear(); })}, "no region");
    refused({changed("untaught.seam", [](Project& p) { p.spots[1].reference_mm.setZero(); })},
            "spot S2 has no reference");
    refused({changed("nospots.seam", [](Project& p) { p.regions.front().spot_ids.clear(); })},
            "no calibrated spot");
    refused({changed("raw.seam", [](Project& p) { p.sensors.front().calibration_id.clear(); })},
            "no calibrated spot");
    refused({changed("wild.seam",
                     [](Project& p) {
                         p.calibrations.front().covariance.setZero();
                         p.calibrations.front().covariance(0, 0) = -1;
                     })},
            "covariance");
    EXPECT_EQ(run({f, "--most-trials", "3"}).exit_code, 2);
    EXPECT_EQ(run({f, "--seed", "-1"}).exit_code, 2);
    EXPECT_EQ(run({}).exit_code, 2);
}

}  // namespace
}  // namespace seamwright
