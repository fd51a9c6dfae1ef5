// {"cameras":[CAM,CAM],"points":[{"id"?,"first":[u,v],"second":[u,v],"world":[3]?}],"sigma_px"?};
// CAM = {"id"?,"camera":CAMERA,"world_from_camera":LINK} (several_cameras.h); "world" is where a point is known to be: it
// checks the answer and takes no part in it
// -> {"status","points":[{"id","world","covariance" 3x3,"sigma_mm" (largest),"gap_mm","gap_px","angle_deg","off_mm" (known
//     points),"used"}],"baseline_mm","sigma_px","gap_rms_mm","worst_mm","smallest_angle_deg","known_points",...}

#include "core/calibration/bundle/stereo.h"

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/cameras/several_cameras.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/solution/camera_json.h"

namespace seamwright {
namespace {

using nlohmann::json;

Expected<StereoSight> parse_stereo_sight(const json& entry, std::size_t index, const std::string& where) {
    StereoSight sight;
    SEAM_TRY(auto id, entry_id(entry, index, where));
    sight.id = id;
    SEAM_TRY(auto first, json_vector2(entry, "first", where));
    SEAM_TRY(auto second, json_vector2(entry, "second", where));
    sight.first_px = first;
    sight.second_px = second;
    if (entry.contains("world")) {
        SEAM_TRY(auto world, json_vector3(entry, "world", where));
        sight.known_mm = world;
    }
    return sight;
}

json point_json(const StereoPoint& p, bool used) {
    json one{{"id", p.id}, {"used", used}};
    one["world"] = p.met ? vector_json(p.world_mm) : json(nullptr);
    one["covariance"] = p.met ? matrix_json(p.covariance) : json(nullptr);
    one["sigma_mm"] = p.met ? number_json(worst_sigma(p.covariance)) : json(nullptr);
    one["gap_mm"] = p.met ? number_json(p.gap_mm) : json(nullptr);
    one["gap_px"] = p.met ? number_json(p.gap_px) : json(nullptr);
    one["angle_deg"] = p.met ? number_json(p.angle_deg) : json(nullptr);
    if (p.off_mm) one["off_mm"] = *p.off_mm;
    return one;
}

Expected<CalibrationSolution> solve_stereo(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto cameras, json_array(data, "cameras", ""));
    if (cameras->size() != 2)
        return input_error(Text("{} cameras are given", cameras->size()), "cameras",
                           "two see a point; for more of them see calibrate bundle");
    SEAM_TRY(auto first, parse_placed_camera((*cameras)[0], 0, json_path("cameras", 0)));
    SEAM_TRY(auto second, parse_placed_camera((*cameras)[1], 1, json_path("cameras", 1)));
    SEAM_TRY(auto list, json_array(data, "points", ""));
    std::vector<StereoSight> sights;
    for (std::size_t i = 0; i < list->size(); ++i) {
        SEAM_TRY(auto sight, parse_stereo_sight((*list)[i], i, json_path("points", i)));
        sights.push_back(std::move(sight));
    }
    StereoOptions options;
    options.exclude = exclude;
    if (data.contains("sigma_px")) {
        SEAM_TRY(auto sigma, json_sigma(data, "sigma_px", ""));
        options.sigma_px = sigma;
    }
    SEAM_TRY(auto solved, intersect(first, second, sights, options));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool known = solved.report.judgement.verdict != Verdict::undetermined;
    const auto given = [&](double v) { return known ? number_json(v) : json(nullptr); };
    result["status"] = known ? "ok" : "undetermined";
    json points = json::array();
    for (std::size_t i = 0; i < solved.points.size(); ++i)
        points.push_back(point_json(solved.points[i], solved.report.poses[i].used));
    result["points"] = std::move(points);
    result["baseline_mm"] = number_json(solved.baseline_mm);
    result["sigma_px"] = given(solved.sigma_px);
    result["gap_rms_mm"] = given(solved.gap_rms_mm);
    result["worst_mm"] = given(solved.worst_mm);
    result["smallest_angle_deg"] = given(solved.smallest_deg);
    result["known_points"] = solved.known;
    solution.report = std::move(solved.report);
    finish_document(solution);
    return solution;
}

// Two cameras 300 mm apart, turned towards each other.
json stereo_example() {
    example::Dither dither;
    json cameras = json::array(), points = json::array();
    std::vector<Pose> places;
    for (const double side : {-1.0, 1.0}) {
        places.push_back(make_pose(rotation_exp({0, -0.36 * side, 0}), {150 * side, 0, 0}));
        cameras.push_back({{"id", side < 0 ? "left" : "right"},
                           {"camera", camera_json(example::camera())},
                           {"world_from_camera",
                            {{"pose", pose_json(places.back())}, {"sigma_mm", 0.01}, {"sigma_deg", 0.001}}}});
    }
    for (int i = 0; i < 16; ++i) {
        const Eigen::Vector3d world(45.0 * (i % 4) - 67, 40.0 * (i / 4) - 60, 380 + 12.0 * ((i * 5) % 4));
        json point{{"id", "P" + std::to_string(i + 1)}};
        for (std::size_t c = 0; c < 2; ++c) {
            const Eigen::Vector2d pixel = example::camera().project(places[c].inverse() * world);
            point[c == 0 ? "first" : "second"] = example::pair_json(pixel.x() + dither(example::kPixelNoise),
                                                                    pixel.y() + dither(example::kPixelNoise));
        }
        if (i % 5 == 0) point["world"] = example::vector3_json(world);
        points.push_back(std::move(point));
    }
    return {{"cameras", cameras}, {"points", points}};
}

}  // namespace

CalibrationMethod stereo_method() {
    CalibrationMethod m;
    m.id = "stereo";
    m.help = "Points that two placed cameras see, from where their rays pass each other";
    m.usage = "pairs.json";
    m.layout =
        R"({"cameras":[CAM,CAM],"points":[{"id"?,"first":[u,v],"second":[u,v],"world":[x,y,z]?},..],"sigma_px"?}
  CAM = {"id"?,"camera":{fx,fy,cx,cy,k1?..,width,height},"world_from_camera":LINK}
  LINK = POSE or {"pose":POSE,"sigma_mm","sigma_deg"} or {"pose":POSE,"covariance":6x6 (mm, rad)})";
    m.fields = {{"", {"cameras", "points", "sigma_px"}},
                {"cameras[]", {"id", "camera", "world_from_camera"}},
                camera_fields("cameras[].camera"),
                {"points[]", {"id", "first", "second", "world"}}};
    m.example = stereo_example;
    m.quantities = {{"cameras[].world_from_camera"}};
    m.solve = solve_stereo;
    m.entries = "points";
    m.use = AnswerUse::record;
    m.fewest = 1;
    m.advised = 12;
    m.keeps_back = false;
    m.title = "Points seen by two cameras (stereo)";
    m.why =
        "Measures points in the world where the rays of two placed cameras meet, and says how well they do.";
    m.need = {"Two cameras that are calibrated and whose places in the world are known.",
              "A file with the pixels of each point in both pictures.",
              "One or more points whose place in the world is known: only they confirm the scale."};
    m.file = "JSON with two cameras and the pixels of points in both";
    m.drawing = SetUpDrawing::several_sensors;
    return m;
}

}  // namespace seamwright
