// The command line as others script against it: names, fields, exit codes, one sentence on stderr.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <tuple>

#include "core/geometry/pose.h"
#include "tests/app/cli_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using Cli = CliCase;

// A door of n spots around an ellipse, displaced by D: the edge runs along each sensor's Y, the cut is where
// the displaced straight edge meets the sensor's plane. Built from the definition of the measurement, not
// from the solver's residual.
json door_job(int n, const Pose& d, bool parallel = false) {
    json spots = json::array();
    for (int i = 0; i < n; ++i) {
        const double a = 2 * kPi * i / n;
        const Eigen::Vector3d origin(500 * std::cos(a), 350 * std::sin(a), 20.0 * (i % 3));
        Eigen::Vector3d y =
            parallel ? Eigen::Vector3d::UnitY() : Eigen::Vector3d(-std::sin(a), std::cos(a), 0.1 * (i % 2));
        y.normalize();
        const Eigen::Vector3d x = y.cross(Eigen::Vector3d(0.1 * (i % 4), 0, 1).normalized()).normalized();
        Eigen::Matrix3d rotation;
        rotation << x, y, x.cross(y);
        const Pose w = make_pose(rotation, origin);
        const Eigen::Vector3d r(3.0 - i, 0, 2.0 + 0.5 * i);
        const Pose moved = w.inverse() * d * w;
        Eigen::Vector3d m = moved * r;
        const Eigen::Vector3d direction = moved.linear().col(1);
        m -= direction * (m.y() / direction.y());
        json matrix = json::array();
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column) matrix.push_back(w.matrix()(row, column));
        spots.push_back({{"id", "S" + std::to_string(i + 1)},
                         {"workobject_from_sensor", {{"matrix", matrix}}},
                         {"reference", {r.x(), r.y(), r.z()}},
                         {"measured", {m.x(), m.y(), m.z()}},
                         {"weights", {1, 0, 1}},
                         {"sigma_mm", 0.05}});
    }
    return {{"spots", spots}};
}

Pose displacement() {
    return make_pose(rotation_exp({0.01, -0.008, 0.012}), {6, -4, 3});
}

TEST_F(Cli, CorrectAnswersDWithTheContractsFields) {
    const json a = answer({"correct", write("job.json", door_job(8, displacement()).dump())}, 0);
    EXPECT_EQ(a["status"], "ok");
    const auto m = a["displacement"]["matrix"].get<std::vector<std::vector<double>>>();
    ASSERT_EQ(m.size(), 4u);
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            EXPECT_NEAR(m[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)],
                        displacement().matrix()(row, column), 1e-6);
    EXPECT_EQ(a["displacement"]["xyz"].size(), 3u);
    EXPECT_EQ(a["displacement"]["abc"].size(), 3u);
    EXPECT_EQ(a["covariance"].size(), 6u);
    EXPECT_NEAR(a["sigma"]["xyz_mm"][0].get<double>(), std::sqrt(a["covariance"][0][0].get<double>()), 1e-9);
    EXPECT_EQ(a["sigma"]["abc_deg"].size(), 3u);
    EXPECT_LT(a["rms_mm"].get<double>(), 1e-6);
    ASSERT_EQ(a["spots"].size(), 8u);
    EXPECT_EQ(a["spots"][0]["id"], "S1");
    EXPECT_EQ(a["spots"][0]["residual_mm"].size(), 3u);
    EXPECT_EQ(a["spots"][0]["used"], true);
    EXPECT_TRUE(a["unobservable"].empty());
}

TEST_F(Cli, CorrectRefusesParallelEdgesAndNamesTheDirection) {
    const json a = answer({"correct", write("job.json", door_job(3, displacement(), true).dump())}, 1);
    EXPECT_EQ(a["status"], "under_determined");
    EXPECT_THAT(a["unobservable"].dump(), HasSubstr("translation along Y"));
}

TEST_F(Cli, CorrectNamesTheWrongSpotAmongEight) {
    json job = door_job(8, displacement());
    job["spots"][4]["measured"][0] = job["spots"][4]["measured"][0].get<double>() + 3;
    const json a = answer({"correct", write("job.json", job.dump())}, 0);
    EXPECT_EQ(a["status"], "ok");
    for (const json& spot : a["spots"]) EXPECT_EQ(spot["used"].get<bool>(), spot["id"] != "S5") << spot;
    EXPECT_NEAR(a["displacement"]["xyz"][0].get<double>(), 6, 1e-6);
}

TEST_F(Cli, CorrectTakesTheCovarianceOfAMeasureInPlaceOfItsSigma) {
    json job = door_job(8, displacement());
    const auto sigma_of = [&] {
        return answer({"correct", write("job.json", job.dump())}, 0)["sigma"]["xyz_mm"][0].get<double>();
    };
    const double by_sigma = sigma_of();
    const auto state = [&](const json& covariance) {
        for (json& spot : job["spots"]) spot["covariance_mm2"] = covariance;
    };
    state({{0.0025, 0.0}, {0.0, 0.0025}});
    EXPECT_NEAR(sigma_of(), by_sigma, 1e-9);
    state({{0.0025, 0.0023}, {0.0023, 0.0025}});
    EXPECT_GT(std::abs(sigma_of() - by_sigma), 0.02 * by_sigma);
    state({{0.0025, 0.003}, {0.003, 0.0025}});
    expect_refused({"correct", write("job.json", job.dump())}, "covariance_mm2: the covariance is not");
    state(json::array({0.0025, 0.0}));
    expect_refused({"correct", write("job.json", job.dump())}, "spots[0].covariance_mm2");
}

// Six of (mm, mm, mm, rad, rad, rad).
json diagonal(double mm, double rad) {
    json rows = json::array();
    for (int i = 0; i < 6; ++i) {
        rows.push_back({0, 0, 0, 0, 0, 0});
        rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(i)] = i < 3 ? mm * mm : rad * rad;
    }
    return rows;
}

TEST_F(Cli, CorrectAndPlanStateWhatRepeats) {
    json job = door_job(8, displacement());
    const json before = answer({"correct", write("job.json", job.dump())}, 0);
    EXPECT_EQ(before["covariance_random"], before["covariance"]);
    EXPECT_EQ(before["covariance_systematic"][0][0], 0.0);
    for (json& s : job["spots"]) {
        s["sensor"] = "A";
        s["reference_covariance_mm2"] = {{0.0016, 0.0004}, {0.0004, 0.0016}};
        s["robot_covariance"] = diagonal(0.03, 1e-4);
    }
    job["sensors"] = {{"A",
                       {{"hand_eye_covariance", diagonal(0.1, 2e-3)},
                        {"scale_sigma", {0.001, 0.001}},
                        {"shear_sigma", 0.001}}}};
    for (const char* command : {"correct", "plan"}) {
        const json a = answer({command, write("job.json", job.dump())}, 0);
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t k = 0; k < 6; ++k)
                EXPECT_NEAR(a["covariance"][i][k].get<double>(),
                            a["covariance_random"][i][k].get<double>() +
                                a["covariance_systematic"][i][k].get<double>(),
                            1e-9 * std::sqrt(a["covariance"][i][i].get<double>() *
                                             a["covariance"][k][k].get<double>()));
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_GT(a["sigma_systematic"]["xyz_mm"][i].get<double>(), 0);
            EXPECT_GT(a["sigma_random"]["abc_deg"][i].get<double>(), 0);
            EXPECT_GT(a["sigma"]["xyz_mm"][i].get<double>(), before["sigma"]["xyz_mm"][i].get<double>());
        }
    }
    const auto spoilt = [&](const auto& spoil) {
        json bad = job;
        spoil(bad);
        return write("bad.json", bad.dump());
    };
    for (const char* command : {"correct", "plan"}) {
        const auto refused = [&](const auto& spoil, const char* part) {
            expect_refused({command, spoilt(spoil)}, part);
        };
        refused([](json& j) { j["spots"][2]["sensor"] = "B"; }, "\"B\" is not among");
        refused([](json& j) { j["spots"][2].erase("sensor"); }, "names no sensor");
        refused([](json& j) { j["spots"][2]["sensor"] = ""; }, "spots[2].sensor");
        refused([](json& j) { j.erase("sensors"); }, "\"A\" is not among");
        refused([](json& j) { j["sensors"] = json::array(); }, "sensors");
        refused([](json& j) { j["sensors"]["A"]["hand_eye"] = 1; }, "hand_eye");
        refused([](json& j) { j["sensors"]["A"]["hand_eye_covariance"].erase(0); }, "six rows");
        refused([](json& j) { j["sensors"]["A"]["hand_eye_covariance"][0][1] = 0.001; }, "not symmetric");
        refused([](json& j) { j["sensors"]["A"]["hand_eye_covariance"][0][0] = -1; }, "negative");
        refused([](json& j) { j["sensors"]["A"]["scale_sigma"] = {0.1}; }, "scale_sigma");
        refused([](json& j) { j["sensors"]["A"]["scale_sigma"][0] = -0.1; }, "scale_sigma");
        refused([](json& j) { j["sensors"]["A"]["shear_sigma"] = 7; }, "shear_sigma");
        refused([](json& j) { j["spots"][1]["robot_covariance"][3][3] = nullptr; },
                "spots[1].robot_covariance");
        refused([](json& j) { j["spots"][1]["robot_covariance"][3][3] = 1e300; }, "robot_covariance");
        refused([](json& j) { j["spots"][1]["reference_covariance_mm2"] = 0.1; }, "two rows");
        refused([](json& j) { j["spots"][1]["reference_covariance_mm2"][0][1] = 1; },
                "reference_covariance_mm2");
    }
}

TEST_F(Cli, CorrectOverItsLimitsIsNotOk) {
    json job = door_job(8, displacement());
    job["limits"] = {{"translation_mm", 5}, {"rotation_deg", 3}};
    EXPECT_EQ(answer({"correct", write("job.json", job.dump())}, 1)["status"], "over_limit");
}

TEST_F(Cli, EveryPoseFormMeansTheSame) {
    const json with_matrix = answer({"correct", write("job.json", door_job(6, displacement()).dump())}, 0);
    json job = door_job(6, displacement());
    for (json& spot : job["spots"]) {
        const auto m = spot["workobject_from_sensor"]["matrix"].get<std::vector<double>>();
        Eigen::Matrix3d r;
        r << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
        const Eigen::Quaterniond q(r);
        const Eigen::Vector3d w = rotation_log(r);
        if (spot["id"] == "S1")
            spot["workobject_from_sensor"] = {{"xyz", {m[3], m[7], m[11]}},
                                              {"quat_wxyz", {q.w(), q.x(), q.y(), q.z()}}};
        else
            spot["workobject_from_sensor"] = {{"xyz", {m[3], m[7], m[11]}},
                                              {"rotvec_rad", {w.x(), w.y(), w.z()}}};
    }
    const json other = answer({"correct", write("other.json", job.dump())}, 0);
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(with_matrix["displacement"]["xyz"][i].get<double>(),
                    other["displacement"]["xyz"][i].get<double>(), 1e-7);
}

TEST_F(Cli, HostileJobsAreRefusedInOneSentence) {
    const json good = door_job(5, displacement());
    expect_refused({"correct", write("a.json", "")}, "JSON");
    expect_refused({"correct", write("a.json", "{\"spots\": [")}, "JSON");
    expect_refused({"correct", write("a.json", "[]")}, "object");
    expect_refused({"correct", write("a.json", "{\"spots\": []}")}, "spot");
    expect_refused({"correct", (folder / "missing.json").string()}, "missing.json", 3);
    const auto changed = [&](auto change) {
        json job = good;
        change(job["spots"][3]);
        return write("a.json", job.dump());
    };
    expect_refused({"correct", changed([](json& s) { s.erase("measured"); })}, "spots[3].measured");
    expect_refused({"correct", changed([](json& s) { s["id"] = "S1"; })}, "S1");
    expect_refused({"correct", changed([](json& s) { s["sigma_mm"] = 0; })}, "sigma");
    expect_refused({"correct", changed([](json& s) { s["sigma_mm"] = "0.05"; })}, "spots[3].sigma_mm");
    expect_refused({"correct", changed([](json& s) { s["measured"] = {1, 2}; })}, "spots[3].measured");
    expect_refused({"correct", changed([](json& s) { s["measured"][1] = nullptr; })}, "spots[3].measured");
    expect_refused({"correct", changed([](json& s) { s["weight"] = {1, 0, 1}; })}, "weight");
    expect_refused({"correct", changed([](json& s) { s["workobject_from_sensor"]["matrix"][0] = 3.0; })},
                   "orthonormal");
    expect_refused({"correct", changed([](json& s) { s["workobject_from_sensor"]["matrix"].erase(0); })},
                   "16");
    expect_refused({"correct", changed([](json& s) {
                        s["workobject_from_sensor"] = {{"xyz", {1, 2, 3}}, {"quat_wxyz", {2, 0, 0, 0}}};
                    })},
                   "quaternion");
    json job = good;
    job["free"] = {"x", "q"};
    expect_refused({"correct", write("a.json", job.dump())}, "free[1]");
}

TEST_F(Cli, UsageErrorsEndWithTwo) {
    EXPECT_EQ(run({}).exit_code, 2);
    EXPECT_EQ(run({"no-such-command"}).exit_code, 2);
    EXPECT_EQ(run({"correct"}).exit_code, 2);
    EXPECT_EQ(run({"feature", write("p.csv", "x_mm,z_mm\n0,0\n"), "--kind", "no-such-kind"}).exit_code, 2);
    EXPECT_EQ(run({"--help"}).exit_code, 0);
    EXPECT_EQ(run({"--version"}).exit_code, 0);
}

TEST_F(Cli, EveryCommandsHelpShowsAnExample) {
    for (const char* command :
         {"demo",   "new",       "info",          "check",           "run",      "replay",   "export",
          "import", "correct",   "plan",          "filter",          "feature",  "match",    "extract",
          "align",  "calibrate", "devices",       "panel",           "evaluate", "sim-cell", "robot-program",
          "path",   "gap",       "measure-robot", "measure-trigger", "follow"}) {
        const ProgramResult r = run({command, "--help"});
        EXPECT_EQ(r.exit_code, 0) << command;
        EXPECT_THAT(r.out, HasSubstr("Example:")) << command;
        EXPECT_THAT(r.out, HasSubstr("--json")) << command;
    }
}

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

TEST_F(Cli, APathIsFollowedOnlyByAGuideAndARobotThatTakesCorrectionsInEveryCycle) {
    const std::string project = (folder / "gap.seam").string();
    EXPECT_EQ(run({"gap", project, "--simulated", "--nozzle-mm", "2.5", "--clearance-mm", "0.4"}).exit_code,
              1);
    const std::string guide =
        write("guide.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n0,0,0,0,0,0\n0,10,0,0,0,0\n0,20,0,0,0,0\n");
    expect_refused({"follow", project}, "there is no guide");
    expect_refused({"follow", project, "--guide", project + ".csv"}, "gap.seam.csv", 3);
    expect_refused(
        {"follow", project, "--guide", write("one.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n0,0,0,0,0,0\n")},
        "two points");
    expect_refused({"follow", project, "--guide", guide, "--teach"}, "--spot");
    const std::vector<std::pair<std::vector<std::string>, const char*>> wrong_options = {
        {{"follow", project, "--guide", guide, "--limit-mm", "0"}, "limit-mm"},
        {{"follow", project, "--simulate", "ur-rtde"}, "ur-rtde"},
        {{"follow", project, "--bend-mm", "2"}, "--simulate"}};
    for (const auto& [arguments, part] : wrong_options) {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, 2);
        EXPECT_THAT(r.err, HasSubstr(part));
    }
}

TEST_F(Cli, PlanPredictsWhatCorrectStates) {
    const json job = door_job(7, displacement());
    const json plan = answer({"plan", write("job.json", job.dump())}, 0);
    const json corrected = answer({"correct", write("job.json", job.dump())}, 0);
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(plan["sigma"]["xyz_mm"][i].get<double>(), corrected["sigma"]["xyz_mm"][i].get<double>(),
                    0.05 * corrected["sigma"]["xyz_mm"][i].get<double>());
    EXPECT_TRUE(plan.contains("weakest"));
    EXPECT_TRUE(plan.contains("advice"));
}

std::string step_profile() {
    std::string csv = "x_mm,z_mm\n";
    for (int i = 0; i < 300; ++i) {
        const double x = 0.1 * i;
        csv += std::to_string(x) + "," +
               (i == 150 ? ""
                         : std::to_string(i == 80  ? 9.0
                                          : x < 20 ? 1.0
                                                   : -2.0)) +
               "\n";
    }
    return csv;
}

// The same in a field that is wider than the sheets.
std::string step_in_a_wide_field() {
    std::string csv = step_profile();
    std::string before, after;
    for (int i = 1; i <= 20; ++i) {
        before = std::to_string(-0.1 * i) + ",\n" + before;
        after += std::to_string(29.9 + 0.1 * i) + ",\n";
    }
    csv.insert(csv.find('\n') + 1, before);
    return csv + after;
}

TEST_F(Cli, FilterMarksEveryPointAndLosesNone) {
    const std::string out = (folder / "out.csv").string();
    const json a = answer({"filter", write("in.csv", step_profile()), "--out", out}, 0);
    EXPECT_EQ(a["points"], 300);
    EXPECT_EQ(a["outliers"], 1);
    EXPECT_EQ(a["no_return"], 1);
    EXPECT_EQ(a["segments"], 2);
    const std::string text = slurp(out);
    EXPECT_THAT(text, HasSubstr("valid"));
    EXPECT_THAT(text, HasSubstr("segment"));
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 301);
}

TEST_F(Cli, FeatureFindsTheContourEndOnEitherSide) {
    const std::string in = write("in.csv", step_in_a_wide_field());
    const json left =
        answer({"feature", in, "--kind", "contour-end", "--side", "left", "--segment", "outermost"}, 0);
    const json right =
        answer({"feature", in, "--kind", "contour-end", "--side", "right", "--segment", "outermost"}, 0);
    // Both sheets end to the right: nothing is chosen unasked.
    const json two = answer({"feature", in, "--kind", "contour-end", "--side", "right"}, 1);
    EXPECT_EQ(two["status"], "ambiguous");
    ASSERT_EQ(two["rivals_mm"].size(), 2u);
    // Seen to the rim of the field, no end is seen.
    const json cut = answer({"feature", write("cut.csv", "x_mm,z_mm\n-2.1,\n" + step_profile().substr(10)),
                             "--kind", "contour-end", "--side", "left", "--segment", "outermost"},
                            1);
    EXPECT_EQ(cut["status"], "not_found");
    EXPECT_EQ(left["status"], "ok");
    EXPECT_NEAR(left["point"][0].get<double>(), 0.0, 0.1);
    EXPECT_NEAR(right["point"][0].get<double>(), 29.9, 0.1);
    EXPECT_EQ(left["covariance"].size(), 2u);
    expect_refused({"feature", in, "--kind", "contour-end", "--side", "upwards"}, "left");
}

TEST_F(Cli, HostileProfilesAreRefused) {
    const std::string out = (folder / "out.csv").string();
    expect_refused({"filter", write("a.csv", ""), "--out", out}, "a.csv");
    expect_refused({"filter", write("a.csv", "a,b\n1,2\n"), "--out", out}, "x_mm");
    expect_refused({"filter", write("a.csv", "x_mm,z_mm\n1,2\n3;4\n"), "--out", out}, "3");
    expect_refused({"filter", write("a.csv", "x_mm,z_mm\n1,2\nfoo,4\n"), "--out", out}, "foo");
    EXPECT_FALSE(std::filesystem::exists(out)) << "nothing may be half-written";
}

std::string in_unit(double mm_each, const std::string& csv) {
    std::istringstream in(csv);
    std::string line, out;
    std::getline(in, line);
    out = line + "\n";
    while (std::getline(in, line)) {
        const auto comma = line.find(',');
        out += std::to_string(std::stod(line.substr(0, comma)) / mm_each) + ",";
        if (comma + 1 < line.size()) out += std::to_string(std::stod(line.substr(comma + 1)) / mm_each);
        out += "\n";
    }
    return out;
}

TEST_F(Cli, ProfilesInAnotherUnitAreSuspectedUnlessTheUnitIsSaid) {
    const std::string out = (folder / "out.csv").string(), mm = write("mm.csv", step_profile());
    for (const auto& [unit, mm_each, word] :
         {std::tuple{"m", 1000.0, "looks like metres"}, std::tuple{"um", 1e-3, "looks like micrometres"}}) {
        const std::string in = write("in.csv", in_unit(mm_each, step_in_a_wide_field()));
        for (const std::vector<std::string>& command : {std::vector<std::string>{"filter", in, "--out", out},
                                                        {"feature", in, "--kind", "contour-end"},
                                                        {"match", "--template", in, "--scene", in}}) {
            expect_refused(command, word);
            expect_refused(command, "--unit");
        }
        const json left = answer({"feature", in, "--unit", unit, "--kind", "contour-end", "--side", "right",
                                  "--segment", "outermost"},
                                 0);
        EXPECT_NEAR(left["point"][0].get<double>(), 29.9, 0.1) << unit;
        EXPECT_EQ(answer({"filter", in, "--unit", unit, "--out", out}, 0)["segments"], 2) << unit;
    }
    EXPECT_FALSE(
        answer({"filter", write("in.csv", in_unit(1000, step_profile())), "--unit", "mm", "--out", out}, 0)
            .empty())
        << "whoever says so means it";
    const ProgramResult inch = run({"filter", mm, "--unit", "inch", "--out", out});
    EXPECT_EQ(inch.exit_code, 2);
    EXPECT_THAT(inch.err, HasSubstr("--unit"));
}

// A hundred thousand arrays in one another: no reader may follow them to the bottom of its stack.
TEST_F(Cli, DeepJsonIsRefusedByEveryCommandThatReadsJson) {
    for (const auto& [open, close] : {std::pair{"[", "]"}, {"{\"a\":", "}"}}) {
        std::string text;
        for (int i = 0; i < 100000; ++i) text += open;
        text += "1";
        for (int i = 0; i < 100000; ++i) text += close;
        const std::string deep = write("deep.json", text);
        const std::string inside = write("inside.json", "{\"spots\":" + text + "}");
        const std::string new_file = (folder / "new.seam").string();
        std::vector<std::vector<std::string>> commands{{"correct", deep},
                                                       {"correct", inside},
                                                       {"plan", deep},
                                                       {"panel", deep},
                                                       {"sim-cell", deep},
                                                       {"import", new_file, "--from", deep},
                                                       {"import", new_file, "--from", inside}};
        for (const char* method : {"lens", "camera", "laser-plane", "lut", "tcp-sphere", "plate", "stereo",
                                   "bundle", "static", "hand-eye"})
            commands.push_back({"calibrate", method, deep});
        // Pose files beside the images, and the list of a recording.
        std::filesystem::create_directories(folder / "images");
        std::ofstream(folder / "images" / "1.json") << text;
        std::ofstream(folder / "images" / "1.csv") << step_profile();
        commands.push_back({"import", new_file, "--from", (folder / "images").string()});
        for (const auto& command : commands) {
            const ProgramResult r = run(command);
            EXPECT_TRUE(r.exit_code == 2 || r.exit_code == 3)
                << command[0] << " " << command[1] << ": " << r.exit_code;
            EXPECT_THAT(r.err, HasSubstr("nested deeper than 64")) << command[0] << " " << command[1];
        }
        // On the command line and on standard input.
        const std::string short_deep = text.substr(0, 40000);
        expect_refused({"import", new_file, "--from", (folder / "images").string(), "--flange-from-sensor",
                        "{\"matrix\":" + short_deep},
                       "nested deeper than 64");
        const std::string part = write("part.txt", "part " + short_deep + "\nstop\n");
        const int status = std::system(("'" SEAMWRIGHT_PROGRAM "' sim-cell --camera '' <'" + part + "' >'" +
                                        (folder / "cell.txt").string() + "' 2>&1")
                                           .c_str());
        EXPECT_TRUE(WIFEXITED(status)) << "sim-cell ended by a signal";
    }
}

// What a person or a script makes of the simulated cell while it is served.
TEST_F(Cli, TheSimulatedCellObeysItsLines) {
    const std::string lines = write("lines.txt",
                                    R"(part {"displacement": {"xyz": [1, 2, 3], "abc": [0, 0, 0]}}
shift {"xyz": [0.5, 0, 0], "abc": [0, 0, 0]}
shift 7
camera off
camera on
camera sideways
type left
stop
)");
    const std::string out = (folder / "cell.txt").string();
    ASSERT_EQ(
        std::system(
            ("'" SEAMWRIGHT_PROGRAM "' sim-cell --camera free <'" + lines + "' >'" + out + "' 2>&1").c_str()),
        0)
        << slurp(out);
    std::vector<json> said;
    std::istringstream text(slurp(out));
    for (std::string line; std::getline(text, line);)
        if (line.starts_with("{")) said.push_back(json::parse(line));
    ASSERT_EQ(said.size(), 9u) << slurp(out);
    const auto place = [](const json& state) {
        const auto xyz = state["part"]["displacement"]["xyz"].get<std::vector<double>>();
        return Eigen::Vector3d(xyz[0], xyz[1], xyz[2]);
    };
    EXPECT_NEAR((place(said[1]) - Eigen::Vector3d(1, 2, 3)).norm(), 0, 1e-9);
    EXPECT_NEAR((place(said[2]) - Eigen::Vector3d(1, 2, 3)).norm(), 0.5, 1e-9)
        << "a robot that stands off sees the part off";
    EXPECT_EQ(said[2]["shift"]["xyz"][0], 0.5);
    EXPECT_EQ(said[3]["ok"], false);
    EXPECT_EQ(said[4]["camera"]["plugged"], false);
    EXPECT_EQ(said[5]["camera"]["plugged"], true);
    EXPECT_EQ(said[5]["camera"]["address"], said[0]["camera"]["address"]);
    EXPECT_THAT(said[6]["error"].get<std::string>(), HasSubstr("camera on, or camera off"));
    EXPECT_THAT(said[7]["error"].get<std::string>(), HasSubstr("has no part types"));
    EXPECT_EQ(said[8]["ok"], true);
}

TEST_F(Cli, AnswersAreWrittenThroughToWhatIsNoFile) {
    const std::string job = write("job.json", door_job(5, displacement()).dump());
    const auto answer_in = [&](const std::string& target) { return run({"correct", job, "--json", target}); };
    ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
    std::string got;
    std::thread reader([&] { got = slurp(folder / "fifo"); });
    EXPECT_EQ(answer_in((folder / "fifo").string()).exit_code, 0);
    reader.join();
    EXPECT_EQ(json::parse(got)["status"], "ok");
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "fifo"));

    std::filesystem::create_symlink("far.json", folder / "link.json");
    EXPECT_EQ(answer_in((folder / "link.json").string()).exit_code, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.json"));
    EXPECT_EQ(json::parse(slurp(folder / "far.json"))["status"], "ok");

    const auto shown = answer_in("/dev/stdout");
    EXPECT_EQ(shown.exit_code, 0) << shown.err;
    EXPECT_EQ(json::parse(shown.out)["status"], "ok");
    EXPECT_TRUE(std::filesystem::exists("/dev/stdout"));
    EXPECT_TRUE(std::filesystem::is_symlink("/dev/stdout"));
    EXPECT_EQ(answer_in("/dev/null").exit_code, 0);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
    EXPECT_EQ(answer_in("/dev/full").exit_code, 3);
}

TEST_F(Cli, ProjectFilesAreMadeToldAndChecked) {
    const std::string file = (folder / "door.seam").string();
    EXPECT_EQ(run({"new", file, "--name", "Door"}).exit_code, 0);
    expect_refused({"new", file}, "door.seam", run({"new", file}).exit_code);
    EXPECT_EQ(answer({"info", file}, 0)["name"], "Door");
    EXPECT_EQ(run({"info", write("text.seam", "no project")}).exit_code, 3);
    EXPECT_EQ(run({"info", (folder / "missing.seam").string()}).exit_code, 3);
    EXPECT_EQ(run({"check", write("empty.seam", "")}).exit_code, 3);
    const std::string exported = (folder / "door.json").string(), again = (folder / "again.seam").string();
    EXPECT_EQ(run({"export", file, "--out", exported}).exit_code, 0);
    EXPECT_EQ(run({"import", again, "--from", exported}).exit_code, 0);
    EXPECT_EQ(answer({"info", again}, 0)["name"], "Door");
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

TEST_F(Cli, EvaluateIsTheSameForASeedWhateverTheNumberOfJobs) {
    const std::vector<std::string> arguments{"evaluate", "--experiment", "2", "--seed", "3", "--jobs"};
    auto one = arguments, three = arguments;
    one.push_back("1");
    three.push_back("3");
    const json a = answer(one, 0);
    EXPECT_EQ(a, answer(three, 0));
    const json& e = a["experiments"][0];
    EXPECT_EQ(e["experiment"], 2);
    for (const char* column : {"translation", "rotation", "both"}) {
        EXPECT_GT(e["columns"][column]["three_sigma_mm"].get<double>(), 0.02);
        EXPECT_EQ(e["columns"][column]["refused"], 0);
    }
    EXPECT_EQ(run({"evaluate", "--experiment", "6"}).exit_code, 2);
}

TEST_F(Cli, DevicesListsTheDrivers) {
    const json a = answer({"devices"}, 0);
    std::vector<std::string> names;
    for (const char* list : {"sensor_drivers", "robot_drivers"})
        for (const json& driver : a[list]) names.push_back(driver["name"]);
    EXPECT_THAT(names, testing::IsSupersetOf({"simulated", "replay", "genicam", "kuka-eki", "kuka-kvp",
                                              "kuka-rsi", "abb-rapid"}));
    expect_refused({"robot-program", "none.seam", "--brand", "kuka", "--out", "krc"}, "none.seam", 3);
}

}  // namespace
}  // namespace seamwright
