// Images through the real program: millimetres by a stored calibration, and the laser in its colour.

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/import_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// A camera 250 mm above the work, the laser plane at 30 degrees to its sight; by the textbook's pinhole.
constexpr int kImageWidth = 640, kImageHeight = 480;
constexpr double kFocal = 900;
Pose camera_from_laser() {
    const double c = std::cos(kPi / 6), s = std::sin(kPi / 6);
    Eigen::Matrix3d r;
    r << 1, 0, 0, 0, -c, s, 0, -s, -c;
    return make_pose(r, {0, 0, 250});
}
std::string stripe_image(const Eigen::Vector2d& end, const Eigen::Vector2d& into) {
    std::vector<double> grey(kImageWidth * kImageHeight, 4);
    const auto pixel = [&](double s) {
        const Eigen::Vector2d p = end + s * into;
        const Eigen::Vector3d c = camera_from_laser() * Eigen::Vector3d(p.x(), 0, p.y());
        return Eigen::Vector2d(kFocal * c.x() / c.z() + 320, kFocal * c.y() / c.z() + 240);
    };
    for (double s = 0; s < 40; s += 0.02) {
        const Eigen::Vector2d p = pixel(s);
        const int column = static_cast<int>(std::lround(p.x()));
        for (int row = static_cast<int>(p.y()) - 6; row <= static_cast<int>(p.y()) + 6; ++row)
            if (column >= 0 && row >= 0 && column < kImageWidth && row < kImageHeight)
                grey[static_cast<std::size_t>(row * kImageWidth + column)] +=
                    12 * std::exp(-0.5 * std::pow((row - p.y()) / 1.6, 2));
    }
    std::string image = "P5\n640 480\n255\n";
    for (const double g : grey) image += static_cast<char>(static_cast<unsigned char>(std::min(250.0, g)));
    return image;
}

TEST_F(Import, ImagesBecomeMillimetresByAStoredCalibrationAndPixelsAreNotRetaught) {
    for (const bool moved : {false, true})
        for (std::size_t i = 0; i < cell.places.size(); ++i) {
            const auto [end, into] = cell.cut(cell.places[i], moved ? kMoved : Pose::Identity());
            write((moved ? "car/scan_" : "master/scan_") + std::to_string(i + 1) + ".pgm",
                  stripe_image(end, into));
        }
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    const json laser = json::parse(pose_text(camera_from_laser()));
    json solved{{"method", "stripe-camera"},
                {"verdict", "good"},
                {"camera",
                 {{"fx", kFocal}, {"fy", kFocal}, {"cx", 320}, {"cy", 240}, {"width", 640}, {"height", 480}}},
                {"camera_from_laser", laser},
                {"hand_eye",
                 {{"flange_from_camera",
                   json::parse(pose_text(cell.flange_from_sensor * camera_from_laser().inverse()))}}}};
    const std::string calibration = write("solved.json", solved.dump());
    const json made = answer(
        job("mm", {"--calibration", calibration, "--set", "side=right", "--sigma-limit-mm", "0.4"}), 0);
    EXPECT_EQ(made["in_pixels"], false);
    expect_motion("mm", 0.4);  // a pixel is 0.28 mm

    // The stored one of that project does as well, for further recordings.
    answer(job("mm2", {"--calibration", (folder / "mm.seam").string(), "--set", "side=right",
                       "--sigma-limit-mm", "0.4"}),
           0);
    expect_motion("mm2", 0.4);

    // What the command line led to before: pixels, a calibration stored beside them, and reteach.
    const std::string pixels = (folder / "px.seam").string(), example = (folder / "example.json").string();
    EXPECT_EQ(answer(job("px", {"--set", "side=right", "--set", "fit_length_mm=60"}), 0)["in_pixels"], true);
    EXPECT_EQ(run({"calibrate", "stripe-camera", "--example", example}).exit_code, 0);
    const json stored =
        answer({"calibrate", "stripe-camera", example, "--store", pixels, "--sensor", "A"}, 0);
    const std::string id = stored["stored_as"];
    const json before = answer({"info", pixels}, 0)["project"];
    expect_refused({"reteach", pixels, "--sensor", "A", "--calibration", id}, "taught in pixels");
    EXPECT_EQ(answer({"info", pixels}, 0)["project"], before);
    // It is offered for the import, and refused for images of another camera.
    expect_refused(job("no", {"--calibration", pixels, "--set", "side=right"}), "1280 x 1024");
    expect_refused(job("no", {"--calibration", pixels, "--calibration-id", "none"}), id);
    expect_refused(job("no", {"--calibration", pixels, "--calibration-id", "import"}), "pixels");
    solved.erase("hand_eye");
    solved["hand_eye"] = nullptr;
    // Its laser plane alone does not say where the camera sits.
    expect_refused(job("no", {"--calibration", write("half.json", solved.dump()), "--set", "side=right"}),
                   "--flange-from-sensor");
    expect_refused(job("no", {"--calibration", write("text.json", "[1,2]")}), "text.json");

    // A table of the same camera, as `calibrate lut` writes it.
    json pairs = json::array();
    const Pose laser_from_camera = camera_from_laser().inverse();
    for (int u = 5; u < 640; u += 21)
        for (int v = 5; v < 480; v += 21) {
            const Eigen::Vector3d ray =
                laser_from_camera.linear() * Eigen::Vector3d((u - 320) / kFocal, (v - 240) / kFocal, 1);
            const Eigen::Vector3d from = laser_from_camera.translation();
            const double far = -from.y() / ray.y();
            if (far > 0)
                pairs.push_back(
                    {{"pixel", {u, v}}, {"laser", {from.x() + far * ray.x(), from.z() + far * ray.z()}}});
        }
    const std::string table = (folder / "camera.lut").string();
    const std::string data = write("pairs.json", json{{"size", {640, 480}}, {"pairs", pairs}}.dump());
    answer({"calibrate", "lut", data, "--table", table}, 0);
    EXPECT_EQ(answer(job("table",
                         {"--calibration", table, "--flange-from-sensor", pose_text(cell.flange_from_sensor),
                          "--set", "side=right", "--sigma-limit-mm", "0.4"}),
                     0)["in_pixels"],
              false);
    expect_motion("table", 0.4);
    expect_refused(job("no", {"--calibration", table, "--set", "side=right"}), "--flange-from-sensor");
    expect_refused(job("no", {"--calibration", write("text.lut", "no table")}), "text.lut");
}

// A red line on a colour camera under white light, beside a bright white reflection.
TEST_F(Import, TheLaserIsReadInItsColour) {
    constexpr int kWidth = 480, kHeight = 320;
    const auto row_of_laser = [](int column) { return 200 + 0.05 * column; };
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 2);
    const auto picture = [&](bool laser) {
        std::string image = "P6\n480 320\n255\n";
        for (int r = 0; r < kHeight; ++r)
            for (int c = 0; c < kWidth; ++c) {
                const double white =
                    60 + 140 * std::exp(-0.5 * std::pow((r - 80.0) / 2.5, 2)) + noise(random);
                const double red = laser ? 70 * std::exp(-0.5 * std::pow((r - row_of_laser(c)) / 1.8, 2)) : 0;
                for (const double v : {white + red, white, white})
                    image += static_cast<char>(static_cast<unsigned char>(std::clamp(v, 0.0, 255.0)));
            }
        return image;
    };
    const std::string on = write("on.ppm", picture(true)), off = write("off.ppm", picture(false));
    const std::string out = (folder / "peaks.csv").string();
    const auto right = [&] {
        std::istringstream text(slurp(out));
        std::string line;
        int count = 0;
        std::getline(text, line);
        while (std::getline(text, line)) {
            int column = 0, peak = 0;
            double position = 0, grey = 0, width = 0;
            if (std::sscanf(line.c_str(), "%d,%lf,%lf,%lf,%d", &column, &position, &grey, &width, &peak) ==
                    5 &&
                peak == 0 && std::abs(position - row_of_laser(column)) < 0.6)
                ++count;
        }
        return count / static_cast<double>(kWidth);
    };
    json r = answer({"extract", on, "--columns", "--out", out}, 0);
    EXPECT_EQ(r["channel"], "red-difference");
    EXPECT_EQ(r["colour"], true);
    EXPECT_GE(right(), 0.99);
    r = answer({"extract", on, "--columns", "--channel", "grey", "--out", out}, 0);
    EXPECT_LE(right(), 0.01) << "in grey the reflection is the stronger line";
    EXPECT_THAT(r["warnings"].dump(), HasSubstr("folded to grey"));
    r = answer({"extract", on, "--columns", "--channel", "grey", "--laser-off", off, "--out", out}, 0);
    EXPECT_GE(right(), 0.99);
    expect_refused(
        {"extract", on, "--laser-off", write("small.ppm", "P6\n2 2\n255\nabcabcabcabc"), "--out", out},
        "no pair");
    EXPECT_EQ(run({"extract", on, "--channel", "infrared", "--out", out}).exit_code, 2);
}

}  // namespace
}  // namespace seamwright
