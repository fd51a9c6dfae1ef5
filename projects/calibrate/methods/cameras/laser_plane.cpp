// {"camera":{fx,fy,cx,cy,k1,k2,..},"pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]}],
//  "robot":{"sigma_mm","sigma_deg"?,"lever_mm"?}?} ->
// {"status","camera" (as given),"camera_from_laser","rms_px","sigma","covariance_pose",...}

#include "core/calibration/stripe/laser_plane.h"

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/laser_pairs.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/solution/camera_json.h"

namespace seamwright {

using nlohmann::json;

namespace {

Expected<CalibrationSolution> solve_laser_plane(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto camera_field, json_field(data, "camera", ""));
    SEAM_TRY(auto camera, parse_camera(*camera_field, "camera"));
    SEAM_TRY(auto pairs, parse_laser_pairs(data));
    SEAM_TRY(const double place_mm, place_sigma_of(data));
    SEAM_TRY(auto solved, calibrate_laser_plane(camera, pairs, exclude, place_mm));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool known = solved.report.judgement.verdict != Verdict::undetermined;
    if (known) solution.found = CameraAndLaser{camera, solved.camera_from_laser, std::nullopt};
    result["status"] = known ? "ok" : "undetermined";
    result["camera"] = camera_json(camera);
    result["camera_from_laser"] = known ? pose_json(solved.camera_from_laser) : json(nullptr);
    result["rms_px"] = known ? number_json(solved.rms_px) : json(nullptr);
    result["sigma"] = known ? pose_sigma_json(solved.camera_from_laser, solved.covariance) : json(nullptr);
    result["covariance_pose"] = known ? matrix_json(solved.covariance) : json(nullptr);
    solution.notices = std::move(solved.notices);
    solution.report = std::move(solved.report);
    finish_document(solution);
    return solution;
}

json laser_plane_example() {
    return {{"camera", camera_json(example::camera())}, {"pairs", example::laser_pairs()}};
}

Expected<json> prepare_laser_plane(json settings, const Calibration* base, const std::vector<Calibration>&) {
    if (!settings.contains("camera") && base && base->model)
        settings["camera"] = camera_json(base->model->camera);
    return base ? with_lever(std::move(settings), base->flange_from_sensor) : settings;
}

}  // namespace

CalibrationMethod laser_plane_method() {
    CalibrationMethod m;
    m.id = "laser-plane";
    m.help = "Laser plane in the camera from a triangular body's apexes";
    m.usage = "pairs.json";
    m.layout = R"({"camera":{"fx","fy","cx","cy","k1"?,"k2"?,"p1"?,"p2"?,"k3"?,"width"?,"height"?},
   "pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]},..],
   "robot":{"sigma_mm","sigma_deg"?,"lever_mm"?}?}   px, mm)";
    m.repeatability = true;
    m.fields = {{"", {"camera", "pairs", "robot"}, {"size", "anchor"}},
                camera_fields("camera"),
                {"pairs[]", {"id", "pixel", "laser"}, {"flanks"}},
                {"robot", {"sigma_mm", "sigma_deg", "lever_mm"}}};
    m.example = laser_plane_example;
    m.solve = solve_laser_plane;
    m.entries = "pairs";
    m.capture = CaptureKind::apex;
    m.fewest = 4;
    m.advised = 10;
    m.model = true;
    m.prepare = prepare_laser_plane;
    m.title = "Laser plane (triangular body)";
    m.why = "Finds the laser plane in a known camera, from the apex of a triangular body.";
    m.need = {"A triangular body square to the sensor, its apex seen in the picture.",
              "A sensor that gives profiles in millimetres; or the robot as the stage: it shifts the sensor "
              "along its own X and Z alone and never turns it.",
              "10 or more positions spread over the field, not on one line."};
    m.file = "JSON with pairs of pixel and laser point";
    m.drawing = SetUpDrawing::triangle;
    return m;
}

}  // namespace seamwright
