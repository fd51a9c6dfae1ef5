// correct and plan: a job in, the displacement and what it is known to out.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

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

TEST_F(Cli, CorrectAsksWhereTheTaughtPlacesAreInAnotherUnit) {
    json job = door_job(8, displacement());
    for (json& spot : job["spots"]) {
        json& matrix = spot["workobject_from_sensor"]["matrix"];
        for (const int at : {3, 7, 11}) matrix[at] = matrix[at].get<double>() / 1000;
    }
    const auto metres = run({"correct", write("metres.json", job.dump())});
    EXPECT_EQ(metres.exit_code, 2);
    EXPECT_THAT(metres.err, HasSubstr("the places look like metres"));
    // A sensor that is turned about one hole: who says so is believed.
    job["units"] = "mm deg";
    EXPECT_NE(run({"correct", write("hole.json", job.dump())}).exit_code, 2);
    job["units"] = "m";
    EXPECT_EQ(run({"correct", write("other.json", job.dump())}).exit_code, 2);
    job.erase("units");

    for (std::size_t i = 0; i < job["spots"].size(); ++i)
        job["spots"][i]["workobject_from_sensor"] = {
            {"xyz", {500 * std::cos(double(i)), 350 * std::sin(double(i)), 20}},
            {"abc", {0.4 * double(i) - 1.5, 0, 3.14159}}};
    const auto radian = run({"correct", write("radian.json", job.dump())});
    EXPECT_EQ(radian.exit_code, 2);
    EXPECT_THAT(radian.err, HasSubstr("the angles look like radian"));
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

// What the gate would not send is no 0, and the sigma that the scatter leaves stands beside the stated one.
TEST_F(Cli, CorrectIsNotOkWhereTheSpotsContradictEachOther) {
    json job = door_job(8, displacement());
    const json calm = answer({"correct", write("job.json", job.dump())}, 0);
    EXPECT_EQ(calm["consistent"], true);
    EXPECT_EQ(calm["sigma_scattered"], calm["sigma"]);
    for (std::size_t n = 0; n < 8; ++n) {
        double& x = job["spots"][n]["measured"][0].get_ref<double&>();
        double& z = job["spots"][n]["measured"][2].get_ref<double&>();
        x += n % 2 == 0 ? 0.15 : -0.15;
        z += n % 4 < 2 ? 0.15 : -0.15;
    }
    const std::vector<std::string> command{"correct", write("job.json", job.dump()), "--json", "-"};
    const ProgramResult r = run(command);
    EXPECT_EQ(r.exit_code, 1);
    EXPECT_THAT(r.err, HasSubstr("times the"));
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    const json a = json::parse(r.out);
    EXPECT_EQ(a["status"], "ok");
    EXPECT_EQ(a["consistent"], false);
    const double times = std::sqrt(a["variance_factor"].get<double>());
    EXPECT_GT(times, 3);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(a["sigma_scattered"]["xyz_mm"][i].get<double>(),
                    times * a["sigma"]["xyz_mm"][i].get<double>(), 1e-9);
}

TEST_F(Cli, CorrectRefusesOneMeasureUnderTwoIds) {
    json job = door_job(8, displacement());
    job["spots"].push_back(job["spots"][2]);
    job["spots"].back()["id"] = "copy";
    expect_refused({"correct", write("job.json", job.dump())}, "\"S3\" and \"copy\" are one measure");
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

}  // namespace
}  // namespace seamwright
