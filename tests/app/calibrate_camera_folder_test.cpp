#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "projects/calibrate/methods/methods.h"
#include "tests/devices/real_data.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

fs::path scratch(const std::string& name) {
    const fs::path p = fs::path(testing::TempDir()) / ("seamwright_plate_" + name);
    fs::remove_all(p);
    fs::create_directories(p);
    return p;
}

Expected<CalibrationSolution> solved_folder(const char* method, const fs::path& folder, const char* board,
                                            double pitch_mm, const char* pattern = "chessboard",
                                            const ExcludedIds& exclude = {}) {
    const CalibrationMethod& m = *find_method(method);
    auto data = m.data_of_images(
        {folder.string(), {.counts = board, .pitch_mm = pitch_mm, .pattern = pattern}, exclude});
    if (!data) return tl::unexpected(data.error());
    return solve_calibration(m, *data, {});
}

TEST(StripeCameraCommand, RootAnswersByTheContract) {
    const fs::path folder = real_data() / "etna" / "root";
    if (!fs::exists(folder)) GTEST_SKIP() << "skipped: no real data";
    const auto r = solved_folder("stripe-camera", folder, "7x6", 10);
    ASSERT_TRUE(r) << r.error().sentence();
    const json& j = r->document;
    EXPECT_TRUE(serves(r->verdict()));
    EXPECT_EQ(j["status"], "ok");
    EXPECT_EQ(j["images"], 8);
    EXPECT_EQ(j["boards_found"], 8);
    EXPECT_GE(j["on_plane_share"].get<double>(), 0.95);
    EXPECT_LE(j["hand_eye"]["target_spread_mm"].get<double>(), 1.0);
    for (const char* k : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"})
        EXPECT_TRUE(j["camera"].contains(k)) << k;
    EXPECT_EQ(j["laser_plane"]["normal"].size(), 3u);
    EXPECT_EQ(j["frames"].size(), 8u);
}

// robot_cal_tools publishes fx 542.324 fy 543.515 cx 320.474 cy 226.039.
TEST(CameraCommand, CircleGridWithOneBigDot) {
    const fs::path folder = real_data() / "robot_cal_tools" / "test_set_10x10" / "images";
    if (!fs::exists(folder)) GTEST_SKIP() << "skipped: no real data";
    const auto r = solved_folder("camera", folder, "10x10", 25.4, "circles");
    ASSERT_TRUE(r) << r.error().sentence();
    const json& c = r->document["camera"];
    EXPECT_EQ(r->document["boards_found"], 15);
    EXPECT_NEAR(c["fx"].get<double>(), 542.324, 5.4);
    EXPECT_NEAR(c["fy"].get<double>(), 543.515, 5.4);
    EXPECT_NEAR(c["cx"].get<double>(), 320.474, 3.2);
    EXPECT_NEAR(c["cy"].get<double>(), 226.039, 2.26);
}

// left_intrinsics.yml of OpenCV's examples: f = 535.916, rms 0.3926 px.
TEST(CameraCommand, OpenCVsLeftChessboards) {
    const fs::path examples = "/usr/share/doc/opencv-doc/examples/data";
    if (!fs::exists(examples / "left01.jpg")) GTEST_SKIP() << "skipped: no opencv-doc";
    const fs::path folder = scratch("left");
    for (int i = 1; i <= 14; ++i) {
        const std::string name = std::string("left") + (i < 10 ? "0" : "") + std::to_string(i) + ".jpg";
        if (fs::exists(examples / name)) fs::copy_file(examples / name, folder / name);
    }
    const auto r = solved_folder("camera", folder, "9x6", 25, "chessboard");
    ASSERT_TRUE(r) << r.error().sentence();
    EXPECT_EQ(r->document["boards_found"], 13);
    EXPECT_NEAR(r->document["camera"]["fx"].get<double>() / 535.916, 1, 0.005);
    EXPECT_LE(r->document["reprojection_rms_px"].get<double>(), 0.42);
    fs::remove_all(folder);
}

TEST(PlateFolders, BadInputIsOneSentence) {
    const auto said = [](const Expected<CalibrationSolution>& r) {
        return r ? std::string("accepted") : r.error().sentence();
    };
    EXPECT_THAT(said(solved_folder("stripe-camera", "/nowhere", "7x6", 10)), HasSubstr("no folder"));
    const fs::path empty = scratch("empty");
    EXPECT_THAT(said(solved_folder("stripe-camera", empty, "7x6", 10)), HasSubstr("no image"));
    EXPECT_THAT(said(solved_folder("stripe-camera", empty, "7by6", 10)), HasSubstr("7by6"));
    EXPECT_THAT(said(solved_folder("stripe-camera", empty, "7x6", 0.01)), HasSubstr("metres"));
    EXPECT_THAT(said(solved_folder("stripe-camera", empty, "7x6", -1)), HasSubstr("positive"));
    EXPECT_THAT(said(solved_folder("camera", empty, "7x6", 10, "squares")), HasSubstr("squares"));
    std::ofstream(empty / "frame1.png") << "this is no image";
    const auto broken = solved_folder("stripe-camera", empty, "7x6", 10);
    EXPECT_THAT(said(broken), HasSubstr("frame1"));
    EXPECT_EQ(broken.error().kind, ErrorKind::input);
    EXPECT_THAT(said(solved_folder("stripe-camera", empty, "7x6", 10, "chessboard", {"frame7"})),
                HasSubstr("frame7"));
    fs::remove_all(empty);
}

TEST(CameraCommand, RefusesMalformedData) {
    for (const char* text : {"[]", "{}", R"({"size":[640]})", R"({"size":[640,480],"views":3})",
                             R"({"size":[640,480],"views":[]})", R"({"size":[0,480],"views":[]})",
                             R"({"size":[640,480],"views":[{"points":[{"object":[0,0],"pixel":[1,1]}]}]})",
                             R"({"size":[640,480],"views":[{"id":"a","points":[]}]})"}) {
        const auto r = solve_calibration(*find_method("camera"), json::parse(text), {});
        ASSERT_FALSE(r) << text;
        EXPECT_FALSE(r.error().sentence().empty());
    }
}

}  // namespace
}  // namespace seamwright
