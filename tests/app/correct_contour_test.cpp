// `correct` and `plan` with spots told by contours. The truth is made from the definition of the measurement alone: a
// section, extruded along the sensor's Y, stands on the displaced part and is cut by the laser plane; taught and
// measured at different points of the section, with noise of a fixed seed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/geometry/pose.h"
#include "tests/app/cli_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using CorrectContour = CliCase;
using Section = std::function<double(double)>;  // z of x, mm

constexpr double kNoise_mm = 0.02;

// A sheet that bends down over a radius of 5 mm into a flank of 50 degrees.
double bent(double x) {
    const double turn = rad_from_deg(50), r = 5;
    if (x < 0) return 0;
    if (x < r * std::sin(turn)) return std::sqrt(r * r - x * x) - r;
    return r * (std::cos(turn) - 1) - (x - r * std::sin(turn)) * std::tan(turn);
}
double straight(double x) {
    return 0.1 * x;
}
// The same rise again every 12 mm.
double waves(double x) {
    return 1.5 * std::sin(2 * kPi * x / 12);
}

// W of spot i of n, around an ellipse; the section runs along the sensor's Y.
Pose spot_pose(int i, int n) {
    const double a = 2 * kPi * i / n;
    Eigen::Vector3d y(-std::sin(a), std::cos(a), 0.2 * (i % 2));
    y.normalize();
    const Eigen::Vector3d x = y.cross(Eigen::Vector3d(0.1 * (i % 4), 0, 1).normalized()).normalized();
    Eigen::Matrix3d rotation;
    rotation << x, y, x.cross(y);
    return make_pose(rotation, {500 * std::cos(a), 350 * std::sin(a), 20.0 * (i % 3)});
}

struct Cut {
    double from, to, step;
};

// The section's cut with the laser plane where the part stands at `d`, in the sensor frame of W.
json cut(const Section& section, const Cut& at, const Pose& w, const Pose& d, std::mt19937& random) {
    std::normal_distribution<double> noise(0, kNoise_mm);
    const Pose moved = w.inverse() * d * w;
    const Eigen::Vector3d along = moved.linear().col(1);
    json points = json::array();
    for (double x = at.from; x <= at.to; x += at.step) {
        Eigen::Vector3d p = moved * Eigen::Vector3d(x, 0, section(x));
        p -= along * (p.y() / along.y());
        points.push_back({p.x(), p.z() + noise(random)});
    }
    return points;
}

Pose displacement() {
    return make_pose(rotation_exp({0.008, -0.006, 0.009}), {3, -2, 2.5});
}

json contour_job(int n, std::uint32_t seed) {
    std::mt19937 random(seed);
    json spots = json::array();
    for (int i = 0; i < n; ++i) {
        const Pose w = spot_pose(i, n);
        json matrix = json::array();
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column) matrix.push_back(w.matrix()(row, column));
        spots.push_back({{"id", "S" + std::to_string(i + 1)},
                         {"workobject_from_sensor", {{"matrix", matrix}}},
                         {"reference", {2.0, 0, -1.0}},
                         {"reference_curve", cut(bent, {-12, 12, 0.1}, w, Pose::Identity(), random)},
                         {"curve", cut(bent, {-20.03, 19, 0.11}, w, displacement(), random)}});
    }
    return {{"spots", spots}};
}

// Angles of D's rotation towards the truth, rad.
Eigen::Vector3d turned(const json& d) {
    Eigen::Matrix3d r;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            r(row, column) =
                d["matrix"][static_cast<std::size_t>(row)][static_cast<std::size_t>(column)].get<double>();
    return rotation_log(Eigen::Matrix3d(r * displacement().linear().transpose()));
}

TEST_F(CorrectContour, FindsTheDisplacementWithinItsStatedSigma) {
    // Less than every point of eight cuts bearing on one direction leaves cannot be known.
    const double least = kNoise_mm * std::sqrt(1.0 / (8 * 240) + 1.0 / (8 * 355));
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        const json a = answer({"correct", write("job.json", contour_job(8, seed).dump())}, 0);
        ASSERT_EQ(a["status"], "ok") << a;
        for (std::size_t i = 0; i < 3; ++i) {
            const double sigma = a["sigma"]["xyz_mm"][i].get<double>();
            EXPECT_GT(sigma, least);
            EXPECT_LT(sigma, 0.05);
            EXPECT_NEAR(a["displacement"]["xyz"][i].get<double>(),
                        displacement().translation()(static_cast<Eigen::Index>(i)), 4.5 * sigma);
        }
        EXPECT_LT(turned(a["displacement"]).norm(), 3e-4);
        ASSERT_EQ(a["spots"].size(), 8u);
        for (const json& spot : a["spots"]) {
            EXPECT_EQ(spot["used"], true);
            EXPECT_EQ(spot["registration"]["status"], "ok");
            EXPECT_GT(spot["registration"]["covariance"][0][0].get<double>(), 0);
        }
    }
}

TEST_F(CorrectContour, PlanForeseesWhatCorrectStates) {
    const json job = contour_job(8, 4);
    const json a = answer({"correct", write("job.json", job.dump())}, 0);
    json taught = job;
    for (json& spot : taught["spots"]) spot.erase("curve");
    const json plan = answer({"plan", write("taught.json", taught.dump())}, 0);
    EXPECT_EQ(plan["contours"].size(), 8u);
    for (std::size_t i = 0; i < 3; ++i) {
        const double foreseen = plan["sigma"]["xyz_mm"][i].get<double>(),
                     stated = a["sigma"]["xyz_mm"][i].get<double>();
        EXPECT_LT(foreseen, 1.5 * stated);
        EXPECT_GT(foreseen, stated / 1.5);
    }
    // The noise of the teaching is the same for all parts.
    EXPECT_GT(plan["sigma_systematic"]["xyz_mm"][0].get<double>(), 0);
}

TEST_F(CorrectContour, WhatACurveSharesIsAddedToItsCovariance) {
    json job = contour_job(8, 5);
    const auto sigma = [&] {
        return answer({"correct", write("job.json", job.dump())}, 0)["sigma"]["xyz_mm"][0].get<double>();
    };
    const double noise_alone = sigma();
    for (json& spot : job["spots"]) spot["sigma_mm"] = 0.1;
    const double with_sigma = sigma();
    EXPECT_GT(with_sigma, 3 * noise_alone);
    for (json& spot : job["spots"]) {
        spot.erase("sigma_mm");
        spot["covariance_mm2"] = {{0.01, 0}, {0, 0.01}};
    }
    EXPECT_NEAR(sigma(), with_sigma, 1e-9);
}

TEST_F(CorrectContour, RefusesOneThatSlidesByNameAndTheOthersDecide) {
    json job = contour_job(8, 6);
    std::mt19937 random(60);
    const Pose w = spot_pose(3, 8);
    job["spots"][3]["reference_curve"] = cut(straight, {-12, 12, 0.1}, w, Pose::Identity(), random);
    job["spots"][3]["curve"] = cut(straight, {-20, 20, 0.1}, w, displacement(), random);
    const std::string file = write("job.json", job.dump());
    const json a = answer({"correct", file}, 0);
    ASSERT_EQ(a["spots"].size(), 8u);
    EXPECT_EQ(a["spots"][3]["id"], "S4");
    EXPECT_EQ(a["spots"][3]["used"], false);
    EXPECT_EQ(a["spots"][3]["registration"]["status"], "ill_conditioned");
    EXPECT_EQ(a["spots"][4]["id"], "S5");
    EXPECT_NEAR(a["displacement"]["xyz"][0].get<double>(), displacement().translation().x(), 0.1);
    EXPECT_THAT(run({"correct", file}).out, HasSubstr("S4           refused: ill_conditioned"));
    // Before anything is measured the plan says the same.
    const json plan = answer({"plan", file}, 0);
    EXPECT_EQ(plan["contours"][3]["registration"]["status"], "ill_conditioned");
}

TEST_F(CorrectContour, RefusesOneThatFitsAtTwoPlaces) {
    json job = contour_job(8, 7);
    std::mt19937 random(70);
    const Pose w = spot_pose(5, 8);
    job["spots"][5]["reference_curve"] = cut(waves, {-12, 12, 0.1}, w, Pose::Identity(), random);
    job["spots"][5]["curve"] = cut(waves, {-40, 40, 0.1}, w, displacement(), random);
    job["spots"][5]["window"] = {15, 15, 5};
    const json a = answer({"correct", write("job.json", job.dump())}, 0);
    EXPECT_EQ(a["spots"][5]["used"], false);
    EXPECT_EQ(a["spots"][5]["registration"]["status"], "ambiguous");
}

TEST_F(CorrectContour, WithoutAnyContourFoundNothingIsCorrected) {
    json job = contour_job(4, 8);
    std::mt19937 random(80);
    for (json& spot : job["spots"])
        spot["curve"] = cut(straight, {-20, 20, 0.1}, Pose::Identity(), Pose::Identity(), random);
    const json a = answer({"correct", write("job.json", job.dump())}, 1);
    EXPECT_EQ(a["status"], "under_determined");
    EXPECT_EQ(a["spots"].size(), 4u);
    EXPECT_TRUE(a["sigma"]["xyz_mm"][0].is_null());
    EXPECT_THAT(a["message"].get<std::string>(), HasSubstr("no spot"));
}

TEST_F(CorrectContour, TakesCurvesFromFilesBesideTheJobAndPointsBesideContours) {
    json job = contour_job(8, 9);
    const json before = answer({"correct", write("job.json", job.dump())}, 0);
    for (const char* key : {"reference_curve", "curve"}) {
        std::string text = "x_mm,z_mm\n";
        for (const json& p : job["spots"][0][key]) text += p[0].dump() + "," + p[1].dump() + "\n";
        write(std::string(key) + ".csv", text);
        job["spots"][0][key] = std::string(key) + ".csv";
    }
    EXPECT_EQ(answer({"correct", write("job.json", job.dump())}, 0)["displacement"], before["displacement"]);
    // A spot told by points among them, at the truth.
    const Pose w = spot_pose(2, 8), moved = w.inverse() * displacement() * w;
    Eigen::Vector3d m = moved * Eigen::Vector3d(2, 0, -1);
    m -= moved.linear().col(1) * (m.y() / moved.linear().col(1).y());
    json& spot = job["spots"][2];
    spot.erase("reference_curve");
    spot.erase("curve");
    spot["measured"] = {m.x(), m.y(), m.z()};
    const json mixed = answer({"correct", write("job.json", job.dump())}, 0);
    EXPECT_FALSE(mixed["spots"][2].contains("registration"));
    EXPECT_NEAR(mixed["displacement"]["xyz"][0].get<double>(), displacement().translation().x(), 0.1);
}

TEST_F(CorrectContour, HostileContoursAreRefusedInOneSentence) {
    const json good = contour_job(4, 10);
    const auto refused = [&](const auto& spoil, const char* part, int exit_code = 2) {
        json bad = good;
        spoil(bad["spots"][1]);
        expect_refused({"correct", write("bad.json", bad.dump())}, part, exit_code);
    };
    refused([](json& s) { s.erase("curve"); }, "spots[1].curve");
    refused([](json& s) { s.erase("reference_curve"); }, "spots[1].reference_curve");
    refused([](json& s) { s["measured"] = {1, 0, 1}; }, "spots[1].measured");
    refused([](json& s) { s["curve"] = 5; }, "spots[1].curve");
    refused([](json& s) { s["curve"] = json::array(); }, "spots[1].curve");
    refused([](json& s) { s["curve"] = json::array({{1, 2, 3}}); }, "spots[1].curve[0]");
    refused([](json& s) { s["curve"][7] = {"1", 2}; }, "spots[1].curve[7]");
    refused([](json& s) { s["curve"][7] = {1e300, 2}; }, "spots[1].curve[7]");
    refused([](json& s) { s["curve"] = "nowhere.csv"; }, "nowhere.csv", 3);
    refused(
        [](json& s) {
            s["reference_curve"] = json::array({{0, 0}, {1, 0}, {2, 1}});
        },
        "spots[1].reference_curve");
    refused([](json& s) { s["reference"] = {2, 1, 0}; }, "spots[1].reference");
    refused([](json& s) { s["window"] = {10, 10}; }, "spots[1].window");
    refused([](json& s) { s["window"] = {-1, 10, 5}; }, "spots[1].window");
    refused([](json& s) { s["covariance_mm2"] = {{1, 5}, {5, 1}}; }, "spots[1].covariance_mm2");
    refused([](json& s) { s["sigma_mm"] = -1; }, "spots[1].sigma_mm");
    refused([](json& s) { s["id"] = "S1"; }, "S1");
    // Numbers in metres are seen.
    refused(
        [](json& s) {
            for (json& p : s["curve"]) p = {p[0].get<double>() / 1000, p[1].get<double>() / 1000};
        },
        "spots[1].curve");
    // Points without return are no error.
    json holes = good;
    for (std::size_t i = 0; i < 30; ++i) holes["spots"][1]["curve"][i][1] = nullptr;
    EXPECT_EQ(answer({"correct", write("holes.json", holes.dump())}, 0)["spots"][1]["used"], true);
}

}  // namespace
}  // namespace seamwright
