// {"sensors":[{"id"?,"world_from_plate":LINK,"plate_from_camera":LINK (or
// "camera_from_plate"),"camera_from_laser":LINK,
//  "working_point":[3]?}],"reference_from_world":LINK?}; one sensor may stand at the top level.
// LINK = POSE, or {"pose":POSE,"covariance":6x6 (mm, rad)}, or {"pose":POSE,"sigma_mm","sigma_deg"}.
// -> {"sensors":[{"id","world_from_laser" (or
// "reference_from_laser"),"sigma","covariance","working_sigma_mm" (null: no link has a
// covariance),"shares","verdict",..}],..}; no report but its judgement.

#include "core/calibration/pose/static_chain.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/cameras/several_cameras.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/methods/other_units.h"
#include "projects/file/stored_text.h"

namespace seamwright {
namespace {

using nlohmann::json;

constexpr double kNoAngle_deg = 1e-6;  // a frame that is the camera's own

Expected<UncertainPose> link_field(const json& entry, const std::string& key, const std::string& where) {
    SEAM_TRY(auto field, json_field(entry, key, where));
    return parse_link(*field, json_path(where, key));
}

Expected<StaticSensor> parse_sensor(const json& entry, std::size_t index, const std::string& where) {
    StaticSensor sensor;
    SEAM_TRY(auto id, entry_id(entry, index, where));
    sensor.id = id;
    SEAM_TRY(auto plate, link_field(entry, "world_from_plate", where));
    sensor.world_from_plate = plate;
    const bool inverted = !entry.contains("plate_from_camera");
    if (!inverted && entry.contains("camera_from_plate"))
        return input_error("plate_from_camera and camera_from_plate are both given", where,
                           "give one of them");
    SEAM_TRY(auto camera, link_field(entry, inverted ? "camera_from_plate" : "plate_from_camera", where));
    sensor.plate_from_camera = inverted ? inverse(camera) : camera;
    if (inverted) sensor.camera_field = "camera_from_plate";
    SEAM_TRY(auto laser, link_field(entry, "camera_from_laser", where));
    sensor.camera_from_laser = laser;
    if (entry.contains("working_point")) {
        SEAM_TRY(auto point, json_vector3(entry, "working_point", where));
        sensor.working_point_mm = point;
    }
    return sensor;
}

// A link has no residual that could show its unit. Square sensors stand within 3 degrees as well, so nothing is refused; no
// laser plane lies so flat in its camera, and quarter and half turns in radians lie above 1.2.
std::vector<Text> angles_to_check(const std::vector<StaticSensor>& sensors) {
    constexpr double kQuarterTurn = 1.2;
    const auto largest = [](const Pose& pose) {
        const KukaAbc read = kuka_from_rotation(pose.linear());
        return std::max({std::abs(read.a_deg), std::abs(read.b_deg), std::abs(read.c_deg)});
    };
    std::vector<Text> notices;
    for (const char* link : {"world_from_plate", "camera_from_plate", "camera_from_laser"}) {
        std::vector<Pose> poses;
        double most = 0;
        const bool laser = link == std::string_view("camera_from_laser");
        for (const StaticSensor& s : sensors) {
            poses.push_back(laser ? s.camera_from_laser.pose
                            : link == std::string_view("world_from_plate")
                                ? s.world_from_plate.pose
                                : s.plate_from_camera.pose.inverse());
            most = std::max(most, largest(poses.back()));
        }
        if (may_be_radians(poses) && (laser ? most > kNoAngle_deg : most > kQuarterTurn))
            notices.push_back(
                Text("no angle of {} is above {:.1f} degrees: if they are radians, write degrees", link,
                     kHalfTurnOfRadians));
    }
    return notices;
}

Expected<CalibrationSolution> solve_static(const json& data, const ExcludedIds& exclude) {
    std::vector<StaticSensor> sensors;
    if (data.contains("sensors")) {
        SEAM_TRY(auto list, json_array(data, "sensors", ""));
        for (std::size_t i = 0; i < list->size(); ++i) {
            SEAM_TRY(auto sensor, parse_sensor((*list)[i], i, json_path("sensors", i)));
            sensors.push_back(std::move(sensor));
        }
    } else {
        SEAM_TRY(auto sensor, parse_sensor(data, 0, ""));
        sensors.push_back(std::move(sensor));
    }
    StaticChainOptions options;
    options.exclude = exclude;
    if (data.contains("reference_from_world")) {
        SEAM_TRY(auto reference, link_field(data, "reference_from_world", ""));
        options.reference_from_world = reference;
    }
    SEAM_TRY(auto solved, calibrate_static(sensors, options));

    CalibrationSolution solution;
    json& result = solution.document;
    const char* frame = options.reference_from_world ? "reference_from_laser" : "world_from_laser";
    result["status"] = "ok";
    put_judgement(solved.judgement, result);
    SensorChains found;
    json list = json::array();
    for (const auto& s : solved.sensors) {
        json one;
        one["id"] = s.id;
        one[frame] = pose_json(s.world_from_laser.pose);
        const bool known = !s.world_from_laser.covariance.isZero(0);
        one["sigma"] =
            known ? pose_sigma_json(s.world_from_laser.pose, s.world_from_laser.covariance) : json(nullptr);
        one["covariance"] = known ? matrix_json(s.world_from_laser.covariance) : json(nullptr);
        one["working_sigma_mm"] = known ? number_json(s.working_sigma_mm) : json(nullptr);
        one["shares"] = {{"reference_from_world", s.shares[0]},
                         {"world_from_plate", s.shares[1]},
                         {"plate_from_camera", s.shares[2]},
                         {"camera_from_laser", s.shares[3]}};
        put_judgement(s.judgement, one);
        list.push_back(std::move(one));
        found.chains.push_back(
            {s.id, options.reference_from_world ? std::optional(s.world_from_laser) : std::nullopt,
             s.judgement});
    }
    if (!data.contains("sensors")) result[frame] = list[0][frame];
    result["sensors"] = std::move(list);
    solution.found = std::move(found);
    solution.notices = angles_to_check(sensors);
    put_texts(result, "notices", solution.notices);
    solution.report.judgement = solved.judgement;
    return solution;
}

json static_example() {
    const auto link = [](const Pose& pose) {
        return json{{"pose", pose_json(pose)}, {"sigma_mm", 0.02}, {"sigma_deg", 0.01}};
    };
    json sensors = json::array();
    for (const int number : {0, 1}) {
        const TargetPlace& view = plate_views()[static_cast<std::size_t>(number)];
        sensors.push_back({{"id", number == 0 ? "A" : "B"},
                           {"world_from_plate", link(example::base_from_target())},
                           {"camera_from_plate", link(example::camera_from_board(view))},
                           {"camera_from_laser", link(example::camera_from_laser())}});
    }
    return {{"sensors", sensors}};
}

// The plate's newest place.
Expected<json> prepare_static(json settings, const Calibration*, const std::vector<Calibration>& kept) {
    for (const Calibration& c : kept) {
        const auto solution = solution_from_document(c.result);
        const auto* plate = solution ? std::get_if<PlateInWorld>(&solution->found) : nullptr;
        if (!plate) continue;
        settings["world_from_plate"] = {{"pose", c.result.at("world_from_plate")}};
        if (c.result.contains("covariance_pose"))
            settings["world_from_plate"]["covariance"] = c.result["covariance_pose"];
    }
    return settings;
}

}  // namespace

CalibrationMethod static_method() {
    CalibrationMethod m;
    m.id = "static";
    m.help = "One-shot chain world - plate - camera - laser for several sensors";
    m.usage = "chain.json";
    m.layout =
        R"({"sensors":[{"id"?,"world_from_plate":LINK,"camera_from_plate":LINK,"camera_from_laser":LINK,
   "working_point":[x,y,z]?},..],"reference_from_world":LINK?}
  LINK = POSE or {"pose":POSE,"sigma_mm","sigma_deg"} or {"pose":POSE,"covariance":6x6 (mm, rad)})";
    m.fields = {{"",
                 {"sensors", "reference_from_world", "id", "world_from_plate", "camera_from_plate",
                  "plate_from_camera", "camera_from_laser", "working_point"},
                 {"board"}},
                {"sensors[]",
                 {"id", "world_from_plate", "camera_from_plate", "plate_from_camera", "camera_from_laser",
                  "working_point"},
                 {"sensor", "size", "outline"}}};
    m.example = static_example;
    m.solve = solve_static;
    m.entries = "sensors";
    m.capture = CaptureKind::board_chain;
    m.model = true;
    m.keeps_back = false;
    m.settings = board_settings();
    m.prepare = prepare_static;
    m.title = "Static one-shot for several sensors";
    m.why = "Puts all sensors of a gripper into one frame, from one picture each of a known plate.";
    m.need = {"A plate whose place is known (\"Plate in the world\"), seen by the camera.",
              "The laser plane in the camera; the robot tells where the flange stands."};
    m.file = "JSON with the chain of poses of each sensor";
    m.drawing = SetUpDrawing::several_sensors;
    return m;
}

}  // namespace seamwright
