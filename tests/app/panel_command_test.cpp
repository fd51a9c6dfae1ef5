// panel and gap.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/geometry/pose.h"
#include "tests/app/cli_case.h"

namespace seamwright {
namespace {

using nlohmann::json;

using Cli = CliCase;

// What a station measured, typed as a job: the motion is the same, the word for the other answer too.
TEST_F(Cli, APanelJobHasTheStationsAnswerUnlessTheOtherIsNamed) {
    json job = {{"spots", json::array()}};
    for (int n = 0; n < 8; ++n) {
        const double phi = 45.0 * n, a = phi * kPi / 180;
        job["spots"].push_back(
            {{"id", "P" + std::to_string(n + 1)},
             {"gripper_from_sensor",
              {{"xyz", {500 * std::cos(a), 350 * std::sin(a), 900}},
               {"abc", {phi, 4 * (n % 3), 3 * (n % 2)}}}},
             {"panel", {{"reference", {0, 0, 0}}, {"measured", {0, 0, n == 3 ? 1.2 : 0.0}}}},
             {"body", {{"reference", {4, 0, 0}}, {"measured", {4, 0, 0}}}}});
    }
    const std::string file = write("job.json", job.dump());
    const json shared = answer({"panel", file}, 0);
    const json alone = answer({"panel", file, "--deviation", "leave_out"}, 0);
    for (const json& s : shared["spots"]) EXPECT_TRUE(s["panel_used"].get<bool>()) << s;
    for (const json& s : alone["spots"]) EXPECT_EQ(s["panel_used"].get<bool>(), s["id"] != "P4") << s;
    EXPECT_GT(std::abs(shared["gripper_motion"]["xyz"][2].get<double>()), 0.02);
    EXPECT_LT(std::abs(alone["gripper_motion"]["xyz"][2].get<double>()), 1e-6);
    job["deviation"] = "leave_out";
    EXPECT_EQ(answer({"panel", write("job.json", job.dump())}, 0)["gripper_motion"], alone["gripper_motion"]);
    EXPECT_EQ(answer({"panel", file, "--deviation", "share"}, 0)["gripper_motion"], shared["gripper_motion"]);
    expect_refused({"panel", file, "--deviation", "some"}, "share, leave_out");
}

TEST_F(Cli, PanelSettingsAreSetWithinTheirRanges) {
    const std::string project = (folder / "panel.seam").string();
    const json made = answer({"panel", project, "--simulated", "--teach", "1"}, 0);
    EXPECT_EQ(made["panel"]["job"], "panel");
    const json set = answer(
        {"panel", project, "--set", "gap_tolerance_mm", "0.31", "--set", "limit_rotation_deg", "1.5"}, 0);
    EXPECT_EQ(set["settings"]["gap_tolerance_mm"], 0.31);
    EXPECT_EQ(set["settings"]["limit_rotation_deg"], 1.5);
    EXPECT_EQ(
        answer({"panel", project, "--set", "flush_tolerance_mm", "0.2"}, 0)["settings"]["gap_tolerance_mm"],
        0.31)
        << "kept in the file";
    EXPECT_EQ(set["settings"]["deviation"], "share");
    EXPECT_EQ(answer({"panel", project, "--set", "deviation", "leave_out"}, 0)["settings"]["deviation"],
              "leave_out");
    expect_refused({"panel", project, "--set", "deviation", "perhaps"}, "share, leave_out");
    expect_refused({"panel", project, "--deviation", "share"}, "--set deviation share");
    expect_refused({"panel", project, "--set", "gap_tolerance_mm", "0"}, "give 0.01 to 20 mm");
    expect_refused({"panel", project, "--set", "gap_tolerance_mm", "nan"}, "out of range");
    expect_refused({"panel", project, "--set", "gap", "1"}, "known are");
    expect_refused({"panel", project, "--job", "other", "--set", "gap_tolerance_mm", "1"}, "other");
    expect_refused({"panel", write("job.json", "{}"), "--set", "gap_tolerance_mm", "1"}, "project");
}

TEST_F(Cli, PanelAnswersByTheContract) {
    json spots = json::array();
    // Panel and body displaced by pure translations: G = (1, 2, 0) - (0.5, 0, -0.3).
    const Eigen::Vector3d panel(0.5, 0, -0.3), body(1, 2, 0);
    for (int n = 0; n < 6; ++n) {
        const double a = rad_from_deg(60.0 * n);
        const Eigen::Matrix3d turn = rotation_exp({0, 0, a + (n % 2 ? 0.6 : -0.4)});
        const Eigen::Vector3d p = turn.transpose() * panel, b = turn.transpose() * body;
        const Eigen::Vector3d r = rotation_exp({0, 0, a}) * Eigen::Vector3d(500, 0, 0);
        const Eigen::Vector3d w = rotation_log(turn);
        spots.push_back(
            {{"id", "S" + std::to_string(n)},
             {"gripper_from_sensor", {{"xyz", {r.x(), r.y(), 900}}, {"rotvec_rad", {w.x(), w.y(), w.z()}}}},
             {"panel", {{"reference", {0, 0, 0}}, {"measured", {p.x(), p.y(), p.z()}}}},
             {"body", {{"reference", {4, 0, 0}}, {"measured", {4 + b.x(), b.y(), b.z()}}}},
             {"weights", {1, 0, 1}},
             {"sigma_mm", 0.05}});
    }
    const auto job = write("panel.json", json{{"spots", spots}}.dump());
    const json a = answer({"panel", job}, 0);
    EXPECT_EQ(a["status"], "ok");
    EXPECT_NEAR(a["gripper_motion"]["xyz"][0].get<double>(), 0.5, 1e-6);
    EXPECT_NEAR(a["gripper_motion"]["xyz"][1].get<double>(), 2.0, 1e-6);
    EXPECT_NEAR(a["gripper_motion"]["xyz"][2].get<double>(), 0.3, 1e-6);
    EXPECT_EQ(a["covariance"].size(), 6u);
    EXPECT_EQ(a["sigma"]["abc_deg"].size(), 3u);
    for (const json& s : a["spots"]) {
        EXPECT_NEAR(s["gap_mm"].get<double>(), 0, 1e-6);
        EXPECT_NEAR(s["flush_mm"].get<double>(), 0, 1e-6);
        EXPECT_EQ(s["residual_mm"].size(), 3u);
    }
    spots.erase(spots.begin() + 2, spots.end());
    EXPECT_EQ(answer({"panel", write("few.json", json{{"spots", spots}}.dump())}, 1)["status"],
              "under_determined");
    spots[0]["panel"].erase("measured");
    expect_refused({"panel", write("bad.json", json{{"spots", spots}}.dump())}, "spots[0].panel.measured");
}

TEST_F(Cli, GapNamesWhereTheNozzleDoesNotPass) {
    const std::string project = (folder / "gap.seam").string(), pass = (folder / "pass.seam").string(),
                      csv = (folder / "gap.csv").string();
    const json driven = answer({"gap", project, "--simulated", "--nozzle-mm", "2.5", "--clearance-mm", "0.4",
                                "--step-mm", "5", "--record", pass, "--out", csv},
                               1);
    EXPECT_EQ(driven["status"], "does_not_pass");
    EXPECT_NEAR(driven["length_mm"].get<double>(), 270, 0.1);
    EXPECT_EQ(driven["points"].size(), driven["frames"].get<std::size_t>());
    bool narrow = false;
    for (const json& s : driven["stretches"]) {
        if (s["verdict"] != "too_narrow" || s["narrowest_mm"] < 2) continue;
        narrow = true;
        // The part by construction: 2.6 mm wide at y = 60, 5 mm again 40 mm before and behind it.
        EXPECT_NEAR(s["narrowest_mm"].get<double>(), 2.6, 0.4);
        EXPECT_NEAR(s["workobject_mm"][1].get<double>(), 60, 5);
        EXPECT_EQ(s["where"], "between S3 and S4");
    }
    EXPECT_TRUE(narrow) << driven["stretches"].dump(1);
    std::ifstream table(csv);
    std::string header;
    std::getline(table, header);
    EXPECT_EQ(header, "path_mm,verdict,width_mm,sigma_mm,flush_mm,yaw_deg,tilt_deg,x_mm,y_mm,z_mm");
    EXPECT_EQ(static_cast<std::size_t>(std::count(std::istreambuf_iterator<char>(table), {}, '\n')),
              driven["points"].size());

    const json again =
        answer({"gap", project, "--capture", pass, "--nozzle-mm", "2.5", "--clearance-mm", "0.4"}, 1);
    EXPECT_EQ(again["points"], driven["points"]) << "the recording is measured as on the day";

    expect_refused({"gap", project, "--nozzle-mm", "2"}, "no pass to check");
    expect_refused({"gap", project, "--capture", pass, "--nozzle-mm", "0"}, "nozzle_mm");
    expect_refused({"gap", project, "--capture", pass, "--nozzle-mm", "nan"}, "nozzle_mm");
    expect_refused({"gap", project, "--capture", project, "--nozzle-mm", "2"}, "project", 3);
    expect_refused({"gap", project, "--capture", pass, "--nozzle-mm", "2", "--sensor", "Z"}, "no sensor");
    expect_refused({"gap", project, "--spots", "S1,S7", "--nozzle-mm", "2"}, "no spot \"S7\"");
    expect_refused({"gap", project, "--simulated", "--nozzle-mm", "2"}, "already");
}

}  // namespace
}  // namespace seamwright
