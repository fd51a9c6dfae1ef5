#include "projects/calibrate/example.h"

#include <cmath>
#include <cstdint>

#include "core/geometry/pose.h"
#include "core/profile/sensor_model.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/camera_json.h"
#include "projects/calibrate/session/target_views.h"

namespace seamwright {
namespace {

using nlohmann::json;

// Normal numbers, the same on every machine.
class Dither {
  public:
    double operator()(double sigma) {
        double sum = -6;
        for (int i = 0; i < 12; ++i) sum += uniform();
        return sigma * sum;
    }
    double uniform() {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return static_cast<double>(state_ >> 11) / 9007199254740992.0;
    }

  private:
    std::uint64_t state_ = 2024;
};

// The cell of the examples: a camera 250 mm above the work, the laser plane at 30 degrees to its sight.
constexpr int kWidth = 1280, kHeight = 1024, kBoardColumns = 7, kBoardRows = 6;
constexpr double kPitch_mm = 10, kRadius_mm = 25, kPixelNoise = 0.03, kPointNoise_mm = 0.01,
                 kRobotNoise_mm = 0.02;

CameraModel example_camera() {
    CameraModel c;
    c.fx = 1402, c.fy = 1399, c.cx = 634, c.cy = 517, c.k1 = -0.11, c.k2 = 0.06;
    c.width = kWidth, c.height = kHeight;
    return c;
}
Pose example_camera_from_laser() {
    const double c = std::cos(kPi / 6), s = std::sin(kPi / 6);
    Eigen::Matrix3d r;
    r.col(0) = Eigen::Vector3d(1, 0, 0);
    r.col(1) = Eigen::Vector3d(0, -c, -s);
    r.col(2) = Eigen::Vector3d(0, s, -c);
    return make_pose(r, {0, 0, 250});
}
Pose example_flange_from_sensor() {
    return make_pose(rotation_exp({0.1, -0.2, 0.4}), {35, -12, 140});
}
Pose example_base_from_target() {
    return make_pose(rotation_exp({0.02, 0.03, 0.3}), {900, 150, 250});
}

Pose shaken(const Pose& pose, Dither& dither, double mm, double rad) {
    return pose * make_pose(rotation_exp({dither(rad), dither(rad), dither(rad)}),
                            {dither(mm), dither(mm), dither(mm)});
}
json pair_json(double a, double b) {
    return json::array({a, b});
}
json vector3_json(const Eigen::Vector3d& v) {
    return json::array({v.x(), v.y(), v.z()});
}
// Target frame in the middle of the plate; its first corner is the board's origin.
Pose target_from_board() {
    return make_pose(Eigen::Matrix3d::Identity(),
                     {-(kBoardColumns - 1) * kPitch_mm / 2, -(kBoardRows - 1) * kPitch_mm / 2, 0});
}
Eigen::Vector3d board_corner(int index) {
    return {kPitch_mm * (index % kBoardColumns), kPitch_mm * (index / kBoardColumns), 0};
}
Pose camera_from_board(const TargetPlace& view) {
    return example_camera_from_laser() * target_from_sensor(view).inverse() * target_from_board();
}
Pose base_from_flange(const TargetPlace& view, Dither& dither) {
    return shaken(
        example_base_from_target() * target_from_sensor(view) * example_flange_from_sensor().inverse(),
        dither, kRobotNoise_mm, 2e-5);
}

json lens_example() {
    Dither dither;
    const CameraModel camera = example_camera();
    json lines = json::array();
    for (int n = 0; n < 12; ++n) {
        const double turn = n % 2 == 0 ? 0.08 * (n - 5) : kPi / 2 + 0.08 * (n - 6);
        const double offset = (n - 5.5) * 0.055;
        json line = json::array();
        for (int i = -30; i <= 30; ++i) {
            const Eigen::Vector3d p(offset * -std::sin(turn) + 0.014 * i * std::cos(turn),
                                    offset * std::cos(turn) + 0.014 * i * std::sin(turn), 1);
            const Eigen::Vector2d pixel = camera.project(p);
            if (!(pixel.x() > 0 && pixel.y() > 0 && pixel.x() < kWidth && pixel.y() < kHeight)) continue;
            line.push_back(pair_json(pixel.x() + dither(kPixelNoise), pixel.y() + dither(kPixelNoise)));
        }
        lines.push_back(std::move(line));
    }
    return {{"size", {kWidth, kHeight}}, {"lines", lines}};
}

json camera_example() {
    Dither dither;
    json views = json::array();
    int number = 0;
    for (const TargetPlace& view : plate_views()) {
        json points = json::array();
        TargetPlace far = view;
        // All over the image.
        far.offset_mm += Eigen::Vector3d((number % 3 - 1) * 55, (number / 3 % 3 - 1) * 40, 0);
        for (int i = 0; i < kBoardColumns * kBoardRows; ++i) {
            const Eigen::Vector2d pixel = example_camera().project(camera_from_board(far) * board_corner(i));
            if (!(pixel.x() > 1 && pixel.y() > 1 && pixel.x() < kWidth - 2 && pixel.y() < kHeight - 2))
                continue;
            points.push_back(
                {{"object", vector3_json(board_corner(i))},
                 {"pixel", pair_json(pixel.x() + dither(kPixelNoise), pixel.y() + dither(kPixelNoise))}});
        }
        views.push_back({{"id", "view" + std::to_string(++number)}, {"points", points}});
    }
    return {{"size", {kWidth, kHeight}}, {"views", views}};
}

// Places of an apex all over the field, and the pixels that show it.
json laser_pairs() {
    Dither dither;
    const SensorModel model{example_camera(), example_camera_from_laser(), std::nullopt};
    json pairs = json::array();
    for (int i = -3; i <= 3; ++i)
        for (int k = -3; k <= 3; ++k) {
            const Eigen::Vector2d laser(33.0 * i, 26.0 * k);
            const auto pixel = model.to_pixel(laser);
            if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > kWidth - 1 ||
                pixel->y() > kHeight - 1)
                continue;
            pairs.push_back(
                {{"id", "P" + std::to_string(pairs.size() + 1)},
                 {"pixel", pair_json(pixel->x() + dither(kPixelNoise), pixel->y() + dither(kPixelNoise))},
                 {"laser", pair_json(laser.x(), laser.y())}});
        }
    return pairs;
}

json sphere_observations() {
    Dither dither;
    json list = json::array();
    for (const TargetPlace& view : sphere_views()) {
        const Eigen::Vector3d c = target_from_sensor(view).inverse() * Eigen::Vector3d::Zero();
        const double r = std::sqrt(kRadius_mm * kRadius_mm - c.y() * c.y());
        json profile = json::array();
        for (double t = -1.05; t <= 1.05; t += 0.03)
            profile.push_back(pair_json(c.x() + (r + dither(kPointNoise_mm)) * std::sin(t),
                                        c.z() + (r + dither(kPointNoise_mm)) * std::cos(t)));
        list.push_back({{"id", "P" + std::to_string(list.size() + 1)},
                        {"base_from_flange", pose_json(base_from_flange(view, dither))},
                        {"profile", profile}});
    }
    return list;
}

json plate_example() {
    Dither dither;
    const Pose world_from_plate = example_base_from_target();
    json points = json::array();
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(200, 0, 0), Eigen::Vector3d(200, 150, 0),
          Eigen::Vector3d(0, 150, 0), Eigen::Vector3d(100, 75, 0), Eigen::Vector3d(60, 120, 0),
          Eigen::Vector3d(140, 30, 0)}) {
        const Eigen::Vector3d noise(dither(0.03), dither(0.03), dither(0.03));
        points.push_back({{"id", "P" + std::to_string(points.size() + 1)},
                          {"plate", vector3_json(p)},
                          {"world", vector3_json(world_from_plate * p + noise)}});
    }
    return {{"points", points}, {"sigma_mm", 0.03}};
}

json static_example() {
    const auto link = [](const Pose& pose) {
        return json{{"pose", pose_json(pose)}, {"sigma_mm", 0.02}, {"sigma_deg", 0.01}};
    };
    json sensors = json::array();
    for (const int number : {0, 1}) {
        const TargetPlace& view = plate_views()[static_cast<std::size_t>(number)];
        sensors.push_back({{"id", number == 0 ? "A" : "B"},
                           {"world_from_plate", link(example_base_from_target())},
                           {"camera_from_plate", link(camera_from_board(view))},
                           {"camera_from_laser", link(example_camera_from_laser())}});
    }
    return {{"sensors", sensors}};
}

json hand_eye_example() {
    Dither dither;
    json pairs = json::array();
    for (const TargetPlace& view : plate_views())
        pairs.push_back(
            {{"id", "P" + std::to_string(pairs.size() + 1)},
             {"base_from_flange", pose_json(base_from_flange(view, dither))},
             {"camera_from_target", pose_json(shaken(camera_from_board(view), dither, 0.02, 1e-4))}});
    return {{"mount", "eye_in_hand"}, {"pairs", pairs}};
}

json stripe_camera_example() {
    Dither dither;
    const SensorModel model{example_camera(), example_camera_from_laser(), std::nullopt};
    json frames = json::array();
    for (const TargetPlace& view : plate_views()) {
        json pixels = json::array(), index = json::array(), stripe = json::array();
        for (int i = 0; i < kBoardColumns * kBoardRows; ++i) {
            const Eigen::Vector2d p = model.camera.project(camera_from_board(view) * board_corner(i));
            pixels.push_back(pair_json(p.x() + dither(kPixelNoise), p.y() + dither(kPixelNoise)));
            index.push_back(i);
        }
        // Where the plate (target z = 0) meets the laser plane (sensor y = 0): a line in the sensor's x and
        // z.
        const Pose target_from_laser = target_from_sensor(view);
        const Eigen::Vector3d n = target_from_laser.linear().row(2);
        for (int column = 0; column < kWidth; column += 8) {
            // The line's point above this column, by bisection of x.
            double low = -150, high = 150;
            const auto at = [&](double x) {
                const double z = -(target_from_laser.translation().z() + n.x() * x) / n.z();
                return model.camera.project(model.camera_from_laser * Eigen::Vector3d(x, 0, z));
            };
            for (int i = 0; i < 60; ++i) (at((low + high) / 2).x() < column ? low : high) = (low + high) / 2;
            const Eigen::Vector2d p = at((low + high) / 2);
            if (std::abs(p.x() - column) < 0.01 && p.y() > 0 && p.y() < kHeight)
                stripe.push_back(pair_json(column, p.y() + dither(kPixelNoise)));
        }
        frames.push_back(
            {{"id", "frame" + std::to_string(frames.size() + 1)},
             {"size", {kWidth, kHeight}},
             {"scan", "columns"},
             {"board", {{"pixel", pixels}, {"index", index}, {"symmetry", 1}, {"detector", "measured"}}},
             {"stripe", stripe},
             {"base_from_flange", pose_json(base_from_flange(view, dither))}});
    }
    return {{"board", {{"columns", kBoardColumns}, {"rows", kBoardRows}, {"pitch_mm", kPitch_mm}}},
            {"frames", frames}};
}

json drift_example() {
    json observations = sphere_observations();
    return {{"flange_from_sensor", pose_json(example_flange_from_sensor())},
            {"centre_base_mm", vector3_json(example_base_from_target().translation())},
            {"radius_mm", kRadius_mm},
            {"observations", observations}};
}

struct Example {
    std::string_view method, layout;
    json (*make)();
};
const Example kExamples[] = {
    {"lens", R"({"size":[W,H],"lines":[[[u,v],..],..],"full":false?}   px)", lens_example},
    {"camera",
     R"({"size":[W,H],"views":[{"id"?,"points":[{"object":[x,y,z],"pixel":[u,v]},..]},..]}   mm, px)",
     camera_example},
    {"laser-plane",
     R"({"camera":{"fx","fy","cx","cy","k1"?,"k2"?,"p1"?,"p2"?,"k3"?,"width"?,"height"?},
   "pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]},..]}   px, mm)",
     [] {
         return json{{"camera", camera_json(example_camera())}, {"pairs", laser_pairs()}};
     }},
    {"lut", R"({"size":[W,H],"step_px"?,"pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]},..]}   px, mm)",
     [] {
         return json{{"size", {kWidth, kHeight}}, {"pairs", laser_pairs()}};
     }},
    {"tcp-sphere",
     R"({"radius_mm":R or null,"nominal_flange_from_sensor":POSE?,
   "observations":[{"id"?,"base_from_flange":POSE,"profile":[[x,z],..]},..]}   mm; z null: no return)",
     [] {
         return json{{"radius_mm", kRadius_mm}, {"observations", sphere_observations()}};
     }},
    {"plate", R"({"points":[{"id"?,"plate":[x,y,z],"world":[x,y,z]},..],"sigma_mm"?}   mm)", plate_example},
    {"static",
     R"({"sensors":[{"id"?,"world_from_plate":LINK,"camera_from_plate":LINK,"camera_from_laser":LINK,
   "working_point":[x,y,z]?},..],"reference_from_world":LINK?}
  LINK = POSE or {"pose":POSE,"sigma_mm","sigma_deg"} or {"pose":POSE,"covariance":6x6 (mm, rad)})",
     static_example},
    {"hand-eye",
     R"({"mount":"eye_in_hand"|"eye_to_hand","pairs":[{"id"?,"base_from_flange":POSE,"camera_from_target":POSE},..]})",
     hand_eye_example},
    {"stripe-camera",
     R"({"board":{"columns","rows","pitch_mm"},"frames":[{"id"?,"size":[W,H],"scan":"rows"|"columns",
   "board":{"pixel":[[u,v],..],"index":[row*columns+column,..],"symmetry","detector"} or null,
   "stripe":[[u,v],..],"base_from_flange":POSE or null},..]})",
     stripe_camera_example},
    {"drift",
     R"({"flange_from_sensor":POSE,"centre_base_mm":[x,y,z],"radius_mm":R,"other_sigma_mm"?,
   "limits":{"translation_mm","rotation_deg"}?,"observations":[{"id"?,"base_from_flange":POSE,"profile":[[x,z],..]},..]}
  or {"measurements":[{"id"?,"base_from_flange":POSE,"measured_flange":[x,y,z],"known_base":[x,y,z],"sigma_mm"?},..]})",
     drift_example},
};

}  // namespace

Expected<json> calibration_example(std::string_view method) {
    for (const Example& e : kExamples)
        if (e.method == method) return e.make();
    return usage_error(Text("there is no calibration \"{}\"", method), "calibrate");
}

std::string_view calibration_layout(std::string_view method) {
    for (const Example& e : kExamples)
        if (e.method == method) return e.layout;
    return {};
}

}  // namespace seamwright
