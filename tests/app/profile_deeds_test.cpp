// `track`, `double-head` and `plate-pose` on data whose truth is known: candidates with a brighter reflection beside the
// contour, two heads whose relation is off by a known amount, a plate drawn by casting a ray through every pixel.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/pose.h"
#include "devices/exchange/pose_json.h"
#include "tests/app/cli_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

using ProfileDeeds = CliCase;

// --- track

constexpr int kLines = 400;
double contour(double x) {
    return 5 + 0.15 * x + (x > 22 ? 4 : 0);
}

// The contour on every line; on every third line of the middle a reflection that is twice as bright and jumps about.
// Written from the last line to the first, so that no order helps.
struct Scene {
    std::string csv = "line,x_mm,z_mm,intensity\n";
    json lines = json::array();
    int reflections = 0;
};
Scene reflected(std::uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.02);
    std::uniform_real_distribution<double> beside(-9, 9);
    Scene scene;
    for (int i = 0; i < kLines; ++i) scene.lines.push_back(json::array());
    for (int i = kLines - 1; i >= 0; --i) {
        const double x = 0.1 * i;
        json& line = scene.lines[static_cast<std::size_t>(i)];
        if (i > 100 && i < 350 && i % 3 == 0) {
            double off = beside(random);
            off += off < 0 ? -3 : 3;
            line.push_back({x, contour(x) + off, 220.0});
            ++scene.reflections;
        }
        line.push_back({x, contour(x) + noise(random), 110.0});
        for (const json& c : line)
            scene.csv +=
                fmt::format("{},{},{},{}\n", i, c[0].get<double>(), c[1].get<double>(), c[2].get<double>());
    }
    return scene;
}

TEST_F(ProfileDeeds, TrackChoosesTheContourAmongBrighterReflections) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        const Scene scene = reflected(seed);
        const std::string csv = write("c.csv", scene.csv),
                          js = write("c.json", json{{"lines", scene.lines}}.dump());
        const json a = answer({"track", csv, "--points", "--out", (folder / "out.csv").string()}, 0);
        const json& p = a["profiles"][0];
        EXPECT_EQ(p["unit"], "mm");
        EXPECT_EQ(p["lines"], kLines);
        EXPECT_EQ(p["with_several"], scene.reflections);
        EXPECT_EQ(p["segments"], 2) << "the step parts it";
        int wrong = 0, accepted = 0;
        for (const json& point : p["points"]) {
            if (point["candidate"].is_null()) continue;
            ++accepted;
            wrong += std::abs(point["z"].get<double>() - contour(point["x"].get<double>())) > 0.2;
        }
        EXPECT_EQ(wrong, 0);
        EXPECT_GT(accepted, 0.8 * kLines);
        EXPECT_GE(p["not_the_brightest"].get<int>(), 0.7 * scene.reflections);
        EXPECT_THAT(slurp(folder / "out.csv"), HasSubstr("segment"));
        // JSON says the same.
        json other = answer({"track", js, "--points"}, 0)["profiles"][0];
        other["file"] = p["file"];
        EXPECT_EQ(other, p);
    }
}

TEST_F(ProfileDeeds, TrackOfAnImageIsTrackOfItsPeaks) {
    // A stripe along the columns with a spot of light beside it.
    constexpr int kWidth = 160, kHeight = 120;
    std::string pgm = fmt::format("P5\n{} {}\n255\n", kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth; ++u) {
            const double d = v - (50 + 0.1 * u), r = std::hypot(u - 80, v - 95);
            const double grey = 8 + 180 * std::exp(-d * d / 4) + 220 * std::exp(-r * r / 18);
            pgm += static_cast<char>(static_cast<unsigned char>(std::min(255.0, grey)));
        }
    const std::string image = write("frame.pgm", pgm), peaks = (folder / "peaks.csv").string();
    answer({"extract", image, "--columns", "--peaks", "3", "--out", peaks}, 0);
    const json a = answer({"track", image, "--columns", "--peaks", "3", "--points"}, 0)["profiles"][0];
    const json b = answer({"track", peaks, "--points"}, 0)["profiles"][0];
    EXPECT_EQ(a["unit"], "px");
    EXPECT_EQ(a["accepted"], b["accepted"]);
    EXPECT_EQ(a["with_several"], b["with_several"]);
    EXPECT_GT(a["with_several"], 3);
    for (const json& point : a["points"]) {
        if (point["candidate"].is_null()) continue;
        EXPECT_NEAR(point["z"].get<double>(), 50 + 0.1 * point["x"].get<double>(), 0.3);
    }
    // Several files go into a folder.
    const std::string out = (folder / "tracked").string();
    answer({"track", peaks, image, "--columns", "--out", out}, 0);
    EXPECT_TRUE(std::filesystem::exists(folder / "tracked" / "peaks.csv"));
    EXPECT_TRUE(std::filesystem::exists(folder / "tracked" / "frame.csv"));
}

TEST_F(ProfileDeeds, TrackRefusesInOneSentence) {
    const auto refused = [&](const std::string& name, const std::string& text, const char* part) {
        expect_refused({"track", write(name, text)}, part);
    };
    refused("a.csv", "", "the file is empty");
    refused("a.csv", "line,x_mm\n1,2\n", "z_mm");
    refused("a.csv", "line,x_mm,z_mm\n", "there is no candidate");
    refused("a.csv", "line,x_mm,z_mm\n-1,0,0\n", "line 2");
    refused("a.csv", "line,x_mm,z_mm\n1.5,0,0\n", "line 2");
    refused("a.csv", "line,x_mm,z_mm\n1e9,0,0\n", "line 2");
    refused("a.csv", "line,x_mm,z_mm\n1,,0\n", "without a place");
    refused("a.csv", "line,x_mm,z_mm\n1,inf,0\n", "infinite");
    std::string many = "line,x_mm,z_mm\n";
    for (int i = 0; i < 70; ++i) many += fmt::format("3,{},0\n", i);
    refused("a.csv", many, "line 3 has more than 64");
    refused("a.json", "{\"lines\":5}", "lines");
    refused("a.json", "{\"lines\":[[]]}", "there is no candidate");
    refused("a.json", "{\"lines\":[[[1]]]}", "lines[0][0]");
    refused("a.json", "{\"lines\":[[[1,2,3]],[[1,2]]]}", "some candidates have an intensity");
    refused("a.json", "{\"lines\":[[[1,2]]],\"per_line\":3}", "per_line");
    expect_refused({"track", (folder / "none.csv").string()}, "none.csv", 3);
    expect_refused({"track", write("a.csv", "line,x_mm,z_mm\n0,0,0\n"), "--band", "99"}, "band");
}

// --- double-head

// A body left of a gap and a panel right of it, 0.4 mm proud, in the common frame; rounded folds are left out: the
// sheets end.
constexpr double kGap = 4, kFlush = 0.4;

struct HeadView {
    Pose sensor_from_head = Pose::Identity();
    double from = -25, to = 25;
};
std::string head_csv(const HeadView& view, double lift, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.01);
    std::string text = "x_mm,z_mm\n";
    const Pose head_from_sensor = view.sensor_from_head.inverse();
    for (double x = view.from + 0.03 * seed; x < view.to; x += 0.1) {
        if (std::abs(x) < kGap / 2) {
            text += ",\n";
            continue;
        }
        const Eigen::Vector3d q =
            head_from_sensor * Eigen::Vector3d(x, 0, (x > 0 ? kFlush : 0) + lift + noise(random));
        text += fmt::format("{},{}\n", q.x(), q.z());
    }
    return text;
}

TEST_F(ProfileDeeds, DoubleHeadMergesMeasuresTheGapAndTellsHowFarTheyAreOff) {
    const HeadView first, second{make_pose(rotation_exp({0, 0.4, 0}), {30, 0, 12}), -10, 24};
    const std::string a = write("a.csv", head_csv(first, 0, 1));
    const std::string pose = pose_json(second.sensor_from_head).dump();
    const std::string b = write("b.csv", head_csv(second, 0.06, 2));
    const json m = answer(
        {"double-head", a, b, "--second-pose", pose, "--gap", "--out", (folder / "m.csv").string()}, 0);
    EXPECT_EQ(m["status"], "ok");
    EXPECT_NEAR(m["offset_mm"].get<double>(), 0.06, 4 * m["offset_sigma_mm"].get<double>() + 0.002);
    EXPECT_NEAR(m["overlap_mm"].get<double>(), 34 - kGap, 1.5);
    EXPECT_EQ(m["gap"]["status"], "ok");
    EXPECT_NEAR(m["gap"]["gap_mm"].get<double>(), kGap, 0.15);
    EXPECT_NEAR(m["gap"]["flush_mm"].get<double>(), kFlush, 0.05);
    EXPECT_GT(slurp(folder / "m.csv").size(), 1000u);
    // Seen from the panel the body stands back.
    const json right =
        answer({"double-head", a, b, "--second-pose", pose, "--gap", "--reference", "right"}, 0);
    EXPECT_NEAR(right["gap"]["flush_mm"].get<double>(), -kFlush, 0.05);
    // A relation that does not hold any more.
    const std::string off = write("off.csv", head_csv(second, 0.3, 2));
    const json worse = answer({"double-head", a, off, "--second-pose", pose, "--gap"}, 1);
    EXPECT_EQ(worse["status"], "disagree");
    EXPECT_FALSE(worse.contains("gap"));
    EXPECT_EQ(answer({"double-head", a, off, "--second-pose", pose, "--limit-mm", "0.4"}, 0)["status"], "ok");
    // One that never looks at the same place.
    const std::string away = write("away.csv", head_csv({second.sensor_from_head, 26, 40}, 0, 2));
    EXPECT_EQ(answer({"double-head", a, away, "--second-pose", pose}, 1)["status"], "no_overlap");
}

TEST_F(ProfileDeeds, DoubleHeadRefusesInOneSentence) {
    const std::string a = write("a.csv", head_csv({}, 0, 1));
    const std::string pose = "{\"xyz\":[0,0,0],\"abc\":[0,0,0]}";
    expect_refused({"double-head", a, a}, "where the second head stands is missing");
    expect_refused({"double-head", a, a, "--second-pose", "{\"xyz\":[0,0]}"}, "--second-pose");
    expect_refused({"double-head", a, "none.csv", "--second-pose", pose}, "none.csv", 3);
    expect_refused({"double-head", a, a, "--second-pose", pose, "--limit-mm", "-1"}, "limit");
    expect_refused({"double-head", a, a, "--second-pose", pose, "--second-sigma-mm", "0"}, "sigma");
    expect_refused({"double-head", a, a, "--project", (folder / "no.seam").string(), "--place", "P1"},
                   "no.seam", 3);
    EXPECT_EQ(run({"double-head", a, a, "--second-pose", pose, "--reference", "left"}).exit_code, 2);
}

// --- plate-pose

struct View {
    int width = 640, height = 480;
    double fx = 900, fy = 905, cx = 322, cy = 236, k1 = -0.12;
    json camera() const {
        return {{"fx", fx}, {"fy", fy},       {"cx", cx},        {"cy", cy},
                {"k1", k1}, {"width", width}, {"height", height}};
    }
};
constexpr int kColumns = 7, kRows = 6;  // inner corners
constexpr double kPitch = 10;

// A chessboard with a white rim, by a ray through 5 x 5 places of every pixel.
std::string drawn(const View& v, const Pose& camera_from_plate) {
    std::string pgm = fmt::format("P5\n{} {}\n255\n", v.width, v.height);
    const Pose plate_from_camera = camera_from_plate.inverse();
    const Eigen::Vector3d eye = plate_from_camera.translation();
    constexpr int kFine = 5;
    for (int y = 0; y < v.height; ++y)
        for (int x = 0; x < v.width; ++x) {
            double sum = 0;
            for (int i = 0; i < kFine * kFine; ++i) {
                const double u = x - 0.5 + (i % kFine + 0.5) / kFine, w = y - 0.5 + (i / kFine + 0.5) / kFine;
                const double xd = (u - v.cx) / v.fx, yd = (w - v.cy) / v.fy;
                double xn = xd, yn = yd;
                for (int k = 0; k < 20; ++k) {
                    const double r2 = xn * xn + yn * yn;
                    xn = xd / (1 + v.k1 * r2);
                    yn = yd / (1 + v.k1 * r2);
                }
                const Eigen::Vector3d ray = plate_from_camera.linear() * Eigen::Vector3d(xn, yn, 1);
                const Eigen::Vector3d p = eye - ray * (eye.z() / ray.z());
                const double a = p.x() / kPitch + 1, b = p.y() / kPitch + 1;
                double grey = 90;
                if (a > -0.8 && a < kColumns + 1.8 && b > -0.8 && b < kRows + 1.8) grey = 215;
                if (a > 0 && a < kColumns + 1 && b > 0 && b < kRows + 1)
                    grey = (static_cast<int>(a) + static_cast<int>(b)) % 2 == 0 ? 30 : 215;
                sum += grey;
            }
            pgm += static_cast<char>(static_cast<unsigned char>(sum / (kFine * kFine) + 0.5));
        }
    return pgm;
}

const Eigen::Vector3d kMiddle(kPitch*(kColumns - 1) / 2, kPitch*(kRows - 1) / 2, 0);

// The plate's middle at `at` before the camera, turned by `turn` (rotation vector).
Pose plate_at(const Eigen::Vector3d& at, const Eigen::Vector3d& turn) {
    const Eigen::Matrix3d r = rotation_exp(turn);
    return make_pose(r, at - r * kMiddle);
}
Pose pose_of(const json& pose) {
    Pose p = Pose::Identity();
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            p.matrix()(row, column) =
                pose["matrix"][static_cast<std::size_t>(row)][static_cast<std::size_t>(column)].get<double>();
    return p;
}

TEST_F(ProfileDeeds, PlatePoseIsThatOfTheDrawnPlate) {
    const View v;
    const std::string camera = write("camera.json", v.camera().dump());
    for (const Pose& truth :
         {plate_at({8, -5, 160}, {0.35, 0.3, 0.2}), plate_at({-15, 10, 200}, {-0.5, 0.1, -0.4})}) {
        const std::string image = write("view.pgm", drawn(v, truth));
        const json a =
            answer({"plate-pose", image, "--board", "7x6", "--pitch-mm", "10", "--camera", camera}, 0);
        EXPECT_EQ(a["status"], "ok");
        EXPECT_EQ(a["found"], kColumns * kRows);
        EXPECT_LT(a["rms_px"].get<double>(), 0.1);
        EXPECT_EQ(a["covariance"].size(), 6u);
        EXPECT_TRUE(a["rival"].is_null());
        const Pose found = pose_of(a["camera_from_plate"]);
        // Whichever corner the board is read from, its middle and its normal are the same.
        EXPECT_LT((found * kMiddle - truth * kMiddle).norm(), 0.1);
        EXPECT_LT(std::acos(std::min(1.0, found.linear().col(2).dot(truth.linear().col(2)))),
                  rad_from_deg(0.1));
        const double tilt =
            deg_from_rad(std::acos(std::abs(truth.linear().col(2).dot((truth * kMiddle).normalized()))));
        EXPECT_NEAR(a["tilt_deg"].get<double>(), tilt, 0.1);
        for (const json& p : a["points"]) EXPECT_EQ(p["used"], true);
        // The answer of `calibrate camera` holds the camera as well.
        const std::string within = write("answer.json", json{{"camera", v.camera()}}.dump());
        EXPECT_EQ(answer({"plate-pose", image, "--board", "7x6", "--pitch-mm", "10", "--camera", within},
                         0)["camera_from_plate"],
                  a["camera_from_plate"]);
    }
}

TEST_F(ProfileDeeds, PlatePoseRefusesAPlateThatMayTiltEitherWay) {
    // From afar through a long lens: three degrees to one side look like three to the other.
    const View v{640, 480, 60000, 60000, 319.5, 239.5, 0};
    const Pose truth = plate_at({0, 0, 14000}, {0.055, 0, 0.1});
    const std::string camera = write("camera.json", v.camera().dump()),
                      image = write("view.pgm", drawn(v, truth));
    const std::vector<std::string> asked{"plate-pose", image, "--board",  "7x6",
                                         "--pitch-mm", "10",  "--camera", camera};
    const json a = answer(asked, 1);
    EXPECT_EQ(a["status"], "undetermined");
    EXPECT_TRUE(a["camera_from_plate"].is_null());
    EXPECT_FALSE(a["rival"].is_null());
    EXPECT_THAT(a["reason"].get<std::string>(), HasSubstr("two places"));
    // Who knows roughly how it stands is answered, and told of the other place.
    std::vector<std::string> told = asked;
    told.insert(told.end(), {"--start", pose_json(truth).dump(), "--json", "-"});
    const json b = json::parse(run(told).out);
    EXPECT_EQ(b["status"], "ok");
    EXPECT_FALSE(b["rival"].is_null());
    const Eigen::Vector3d normal = pose_of(b["camera_from_plate"]).linear().col(2);
    EXPECT_LT(std::acos(std::min(1.0, normal.dot(truth.linear().col(2)))), rad_from_deg(1));
}

TEST_F(ProfileDeeds, PlatePoseRefusesInOneSentence) {
    const View v;
    const std::string camera = write("camera.json", v.camera().dump()),
                      image = write("view.pgm", drawn(v, plate_at({8, -5, 160}, {0.35, 0.3, 0.2})));
    const auto asked = [&](const std::string& file, const std::string& with,
                           const std::string& board = "7x6") {
        return std::vector<std::string>{"plate-pose", file, "--board",  board,
                                        "--pitch-mm", "10", "--camera", with};
    };
    expect_refused(asked(image, camera, "5x4"), "view.pgm");
    expect_refused(asked(image, camera, "7"), "7");
    expect_refused(asked((folder / "no.png").string(), camera), "no.png", 3);
    expect_refused(asked(image, (folder / "no.json").string()), "no.json", 3);
    expect_refused(asked(image, write("c.json", "[]")), "no camera");
    expect_refused(asked(image, write("c.json", "{\"fx\":900}")), "fy");
    expect_refused(asked(image, write("c.json", "{\"fx\":-1,\"fy\":1,\"cx\":1,\"cy\":1}")), "focal length");
    View other = v;
    other.width = 1280;
    expect_refused(asked(image, write("c.json", other.camera().dump())), "the camera 1280 x 480");
    expect_refused(asked(write("black.pgm", "P5\n640 480\n255\n" + std::string(640 * 480, '\0')), camera),
                   "black.pgm");
}

}  // namespace
}  // namespace seamwright
