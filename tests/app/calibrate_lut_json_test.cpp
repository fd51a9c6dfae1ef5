#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/profile/sensor_model.h"
#include "devices/exchange/lookup_table_file.h"
#include "projects/calibrate/methods/methods.h"
#include "tests/app/run_program.h"
#include "tests/core/calibration/camera/camera_scene.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

using nlohmann::json;

const SensorModel kSensor{test::camera_640(), make_pose(rotation_exp({1.0, 0.2, 0.15}), {10, -5, 320}), {}};

json grid(int side, double noise_px) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    const auto n = [&](std::mt19937& engine) { return noise_px * normal(engine); };
    json data{{"size", {640, 480}}, {"pairs", json::array()}};
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
            const Eigen::Vector2d p(5 + i * 629.0 / (side - 1), 5 + j * 469.0 / (side - 1));
            const Eigen::Vector2d xz = *kSensor.to_laser(p);
            data["pairs"].push_back(
                {{"pixel", {p.x() + n(random), p.y() + n(random)}}, {"laser", {xz.x(), xz.y()}}});
        }
    return data;
}

Expected<CalibrationSolution> solved_lut(const json& data, const ExcludedIds& exclude = {}) {
    return solve_calibration(*find_method("lut"), data, exclude);
}

// As the command line does it: the table goes to `path`.
ProgramResult table_of(const json& data, const TemporaryFolder& folder, const std::filesystem::path& path,
                       const char* exclude = "") {
    const auto file = folder.path() / "data.json";
    std::ofstream(file) << data.dump();
    std::vector<std::string> arguments{"calibrate", "lut", file.string(), "--table", path.string(),
                                       "--json",    "-"};
    if (*exclude) arguments.insert(arguments.end(), {"--exclude", exclude});
    return run_program(arguments, folder.path());
}

TEST(CalibrateLutJson, FollowsTheContractAndWritesTheTable) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "sensor.lut";
    json data = grid(15, 0.1);
    data["step_px"] = 16;
    const auto outcome = table_of(data, folder, path, "3");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const json r = json::parse(outcome.out);
    EXPECT_EQ(r["status"], "ok");
    EXPECT_EQ(r["verdict"], "good") << r["reason"];
    EXPECT_EQ(r["table"]["step_u"], 16);
    EXPECT_EQ(r["table_file"], path.string());
    EXPECT_EQ(r["per_pose"].size(), 225u);
    EXPECT_EQ(r["per_pose"][3]["note"], "excluded");
    EXPECT_TRUE(r["wrong_pairs"].empty());
    EXPECT_EQ(r["covariance"].size(), r["parameters"].size());
    EXPECT_GT(r["hold_out"]["folds"], 0);
    const auto table = read_lookup_table(path);
    ASSERT_TRUE(table) << table.error().sentence();
    EXPECT_EQ(r["table"]["columns"], table->columns);
    EXPECT_EQ(r["table"]["rows"], table->rows);
    int holes = 0;
    for (const double x : table->x_mm) holes += std::isnan(x);
    EXPECT_EQ(r["table"]["holes"], holes);
    const auto xz = table->at({320, 240});
    ASSERT_TRUE(xz);
    EXPECT_LT((*xz - *kSensor.to_laser({320, 240})).norm(), 0.05);
}

TEST(CalibrateLutJson, WritesNoTableThatMustNotBeUsed) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "sensor.lut";
    json line{{"size", {640, 480}}, {"pairs", json::array()}};
    for (int i = 0; i < 30; ++i) line["pairs"].push_back({{"pixel", {20 * i, 100}}, {"laser", {3 * i, 5}}});
    const auto outcome = table_of(line, folder, path);
    ASSERT_EQ(outcome.exit_code, 1) << outcome.err;
    const json r = json::parse(outcome.out);
    EXPECT_EQ(r["status"], "undetermined");
    EXPECT_TRUE(r["table"].is_null());
    EXPECT_TRUE(r["forward_rms_mm"].is_null());
    EXPECT_TRUE(r["table_file"].is_null());
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_EQ(table_of(grid(8, 0.1), folder, folder.path() / "no" / "where.lut").exit_code, 3);
}

TEST(CalibrateLive, ItsOptionsAreNotPassedOverWithData) {
    const TemporaryFolder folder;
    const std::string data = (folder.path() / "sphere.json").string();
    const auto solved = [&](std::vector<std::string> more) {
        std::vector<std::string> all{"calibrate", "tcp-sphere", data};
        all.insert(all.end(), more.begin(), more.end());
        return run_program(all, folder.path());
    };
    ASSERT_EQ(solved({"--example", data}).exit_code, 0);
    EXPECT_EQ(solved({}).exit_code, 0);
    for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
             {"--set", "radius=30"}, {"--captures", "9"}, {"--robot", "R1"}, {"--anew"}, {"--use"}}) {
        const auto refused = solved(more);
        EXPECT_EQ(refused.exit_code, 2) << more.front();
        EXPECT_NE(refused.err.find("--live"), std::string::npos) << refused.err;
    }
}

TEST(CalibrateLutJson, RefusesBadInput) {
    const json good = grid(8, 0.1);
    EXPECT_TRUE(solved_lut(good));
    const auto refused = [&](const char* pointer, json value) {
        json data = good;
        data[json::json_pointer(pointer)] = std::move(value);
        return !solved_lut(data).has_value();
    };
    EXPECT_TRUE(refused("/size", json::array({640})));
    EXPECT_TRUE(refused("/size", json::array({0, 480})));
    EXPECT_TRUE(refused("/size", json::array({1e300, 480})));
    EXPECT_TRUE(refused("/step_px", 0));
    EXPECT_TRUE(refused("/step_px", "8"));
    EXPECT_TRUE(refused("/pairs", json::array()));
    EXPECT_TRUE(refused("/pairs", 3));
    EXPECT_TRUE(refused("/pairs/4", 3));
    EXPECT_TRUE(refused("/pairs/4/pixel", json::array({1, 2, 3})));
    EXPECT_TRUE(refused("/pairs/4/pixel", nullptr));
    EXPECT_TRUE(refused("/pairs/4/laser", json::array({"a", 2})));
    EXPECT_TRUE(refused("/pairs/4/id", json::object()));
    EXPECT_FALSE(solved_lut(json(3)));
    EXPECT_FALSE(solved_lut(good, {"nobody"}));
}

}  // namespace
}  // namespace seamwright
