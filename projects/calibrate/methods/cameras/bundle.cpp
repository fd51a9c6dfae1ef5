// {"cameras":[{"id"?,"camera":CAMERA,"world_from_camera":LINK,
//              "sights":[{"feature"?,"object":[3],"pixel":[u,v],"weight"?}]}],"sigma_px"?,"start":POSE?};
// LINK and CAMERA as in several_cameras.h; a sight without "feature" is called after its place on the object. Of pictures
// taken with a gripper's sensors the world is the robot's base. Cameras and features can be excluded by id.
// -> {"status","world_from_object","covariance_pose","sigma","rms_px","sigma_px","worst_mm","features",
//     "sights":[{"camera","feature","off_px":[2],"used","wrong"}],"rival" (another place that fits as well) or null,...}

#include "core/calibration/bundle/bundle.h"

#include <fmt/format.h>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/cameras/several_cameras.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/solution/camera_json.h"

namespace seamwright {
namespace {

using nlohmann::json;

constexpr double kHeaviest = 1e6;  // weight of a sight, an ordinary one has 1

Expected<BundleSight> parse_bundle_sight(const json& entry, std::size_t camera, const std::string& where) {
    BundleSight sight;
    sight.camera = camera;
    SEAM_TRY(auto object, json_vector3(entry, "object", where));
    SEAM_TRY(auto pixel, json_vector2(entry, "pixel", where));
    SEAM_TRY(auto weight, json_number_or(entry, "weight", 1, where));
    if (!(weight >= 0 && weight <= kHeaviest))
        return input_error("the weight must be 0 or positive", json_path(where, "weight"),
                           "give 1 for an ordinary feature, 0 for none");
    SEAM_TRY(auto feature,
             json_string_or(entry, "feature",
                            fmt::format("({:g}, {:g}, {:g})", object.x(), object.y(), object.z()), where));
    sight.object_mm = object;
    sight.pixel = pixel;
    sight.weight = weight;
    sight.feature = feature;
    return sight;
}

Expected<CalibrationSolution> solve_bundle(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto list, json_array(data, "cameras", ""));
    std::vector<PlacedCamera> cameras;
    std::vector<BundleSight> sights;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string where = json_path("cameras", i);
        SEAM_TRY(auto camera, parse_placed_camera((*list)[i], i, where));
        cameras.push_back(std::move(camera));
        SEAM_TRY(auto seen, json_array((*list)[i], "sights", where));
        for (std::size_t k = 0; k < seen->size(); ++k) {
            SEAM_TRY(auto sight, parse_bundle_sight((*seen)[k], i, json_path(json_path(where, "sights"), k)));
            sights.push_back(std::move(sight));
        }
    }
    BundleOptions options;
    options.exclude = exclude;
    if (data.contains("sigma_px")) {
        SEAM_TRY(auto sigma, json_sigma(data, "sigma_px", ""));
        options.sigma_px = sigma;
    }
    if (data.contains("start")) {
        SEAM_TRY(auto start, parse_pose(data["start"], "start"));
        options.start = start;
    }
    SEAM_TRY(auto solved, locate_object(cameras, sights, options));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool known = solved.determined;
    const auto given = [&](double v) { return known ? number_json(v) : json(nullptr); };
    result["status"] = known ? "ok" : "undetermined";
    result["world_from_object"] = known ? pose_json(solved.world_from_object) : json(nullptr);
    result["covariance_pose"] = known ? matrix_json(solved.covariance) : json(nullptr);
    result["sigma"] = known ? pose_sigma_json(solved.world_from_object, solved.covariance) : json(nullptr);
    result["rms_px"] = given(solved.rms_px);
    result["sigma_px"] = given(solved.sigma_px);
    result["worst_mm"] = given(solved.worst_mm);
    result["features"] = solved.features;
    result["rival"] = solved.rival ? pose_json(*solved.rival) : json(nullptr);
    json off = json::array();
    for (std::size_t i = 0; known && i < sights.size(); ++i)
        off.push_back({{"camera", cameras[sights[i].camera].id},
                       {"feature", sights[i].feature},
                       {"off_px", vector_json(solved.sights[i].off_px)},
                       {"used", solved.sights[i].used},
                       {"wrong", solved.sights[i].wrong}});
    result["sights"] = std::move(off);
    for (std::size_t i = 0; i < sights.size(); ++i)
        if (solved.sights[i].wrong)
            solution.notices.push_back(
                Text("feature '{}' in camera '{}' contradicts the others and is left out", sights[i].feature,
                     cameras[sights[i].camera].id));
    if (solved.rival)
        solution.notices.push_back(
            "another place explains the features as well: the one nearer to the start was taken");
    solution.report = std::move(solved.report);
    finish_document(solution);
    return solution;
}

// Four cameras about an object of six features, each of which sees four.
json bundle_example() {
    example::Dither dither;
    const Pose world_from_object = example::base_from_target();
    const std::vector<Eigen::Vector3d> features{{0, 0, 0},     {180, 0, 0},  {180, 120, 10},
                                                {0, 120, -15}, {90, 60, 40}, {40, 100, 25}};
    json cameras = json::array();
    for (int c = 0; c < 4; ++c) {
        const double side = c % 2 == 0 ? 1 : -1, along = c < 2 ? 1 : -1;
        const Eigen::Vector3d from(0.5 * side, 0.4 * along, 1);
        const Eigen::Matrix3d turn = rotation_between(Eigen::Vector3d::UnitZ(), -from);
        const Pose world_from_camera =
            world_from_object * make_pose(turn, Eigen::Vector3d(90, 60, 0) + 420 * from.normalized());
        json sights = json::array();
        for (std::size_t i = 0; i < features.size(); ++i) {
            if (i % 3 == static_cast<std::size_t>(c) % 3) continue;
            const Eigen::Vector2d pixel =
                example::camera().project(world_from_camera.inverse() * (world_from_object * features[i]));
            sights.push_back({{"feature", "F" + std::to_string(i + 1)},
                              {"object", example::vector3_json(features[i])},
                              {"pixel", example::pair_json(pixel.x() + dither(example::kPixelNoise),
                                                           pixel.y() + dither(example::kPixelNoise))}});
        }
        cameras.push_back(
            {{"id", "C" + std::to_string(c + 1)},
             {"camera", camera_json(example::camera())},
             {"world_from_camera",
              {{"pose", pose_json(world_from_camera)}, {"sigma_mm", 0.01}, {"sigma_deg", 0.001}}},
             {"sights", sights}});
    }
    return {{"cameras", cameras}};
}

}  // namespace

CalibrationMethod bundle_method() {
    CalibrationMethod m;
    m.id = "bundle";
    m.help = "Where an object stands whose features one or several placed cameras see";
    m.usage = "sights.json";
    m.layout =
        R"({"cameras":[{"id"?,"camera":{fx,fy,cx,cy,k1?..,width,height},"world_from_camera":LINK,
   "sights":[{"feature"?,"object":[x,y,z],"pixel":[u,v],"weight"?},..]},..],"sigma_px"?,"start":POSE?}
  LINK = POSE or {"pose":POSE,"sigma_mm","sigma_deg"} or {"pose":POSE,"covariance":6x6 (mm, rad)})";
    m.fields = {{"", {"cameras", "sigma_px", "start"}, {"board"}},
                {"cameras[]", {"id", "camera", "world_from_camera", "sights"}, {"size", "outline"}},
                camera_fields("cameras[].camera"),
                {"cameras[].sights[]", {"feature", "object", "pixel", "weight"}}};
    m.example = bundle_example;
    m.solve = solve_bundle;
    m.entries = "cameras";
    m.capture = CaptureKind::board_sights;
    m.use = AnswerUse::record;
    m.fewest = 1;
    m.advised = 2;
    m.robot = m.model = true;
    m.keeps_back = false;
    m.settings = board_settings();
    m.title = "World frame from several cameras (bundle)";
    m.why =
        "Finds where an object with known features stands, from all cameras that see it, each from where it "
        "is.";
    m.need = {"Calibrated sensors on the gripper: lens, laser plane and place on the flange.",
              "A board on the object: every capture takes a picture with each of them. The robot may stand "
              "elsewhere "
              "for the next.",
              "Or the features of the object and their pixels, from a file; features may be seen by one "
              "camera each."};
    m.file = "JSON with cameras, their places and the features they see";
    m.drawing = SetUpDrawing::several_sensors;
    return m;
}

}  // namespace seamwright
