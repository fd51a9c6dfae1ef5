// {"radius_mm":r or null,"observations":[{"id","base_from_flange":POSE,"profile":[[x,z],..]}],
//  "nominal_flange_from_sensor":POSE?}; z null = no return.
// ->
// {"status","flange_from_sensor","centre_base_mm","radius_mm","rms_mm","noise_mm","sigma":{"xyz_mm","abc_deg","centre_mm",
//     "radius_mm","working_mm"},"covariance_pose" 6x6 (mm,
//     rad),"mirrored","degenerate","proposals":[{"words","base_from_flange","sigma_mm"}],...}

#include <algorithm>
#include <limits>
#include <memory>

#include "core/calibration/sphere/tcp_sphere.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/methods/sphere_profile_json.h"

namespace seamwright {

using nlohmann::json;

Expected<SphereObservation> parse_sphere_observation(const json& entry, std::size_t index,
                                                     const std::string& where) {
    SphereObservation observation;
    SEAM_TRY(auto id, entry_id(entry, index, where));
    observation.id = id;
    SEAM_TRY(auto pose_field, json_field(entry, "base_from_flange", where));
    SEAM_TRY(auto pose, parse_pose(*pose_field, json_path(where, "base_from_flange")));
    observation.base_from_flange = pose;
    SEAM_TRY(auto profile, json_array(entry, "profile", where));
    const std::string path = json_path(where, "profile");
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < profile->size(); ++i) {
        const json& point = (*profile)[i];
        double x = none, z = none;
        if (!point.is_null()) {
            if (!point.is_array() || point.size() != 2)
                return input_error("a point is not [x, z]", json_path(path, i),
                                   "write two numbers, null for no return");
            if (!(point[0].is_number() || point[0].is_null()) ||
                !(point[1].is_number() || point[1].is_null()))
                return input_error("a coordinate is no number", json_path(path, i),
                                   "write two numbers, null for no return");
            if (point[0].is_number()) x = point[0].get<double>();
            if (point[1].is_number()) z = point[1].get<double>();
        }
        observation.profile.x_mm.push_back(x);
        observation.profile.z_mm.push_back(z);
    }
    return observation;
}

Expected<SphereData> parse_sphere_data(const json& data, const std::vector<std::string>& exclude) {
    SphereData sphere;
    TcpSphereOptions& options = sphere.options;
    options.exclude = exclude;
    if (!data.contains("radius_mm"))
        return input_error("the sphere's radius is missing", "radius_mm",
                           "give it in millimetres, or null to solve for it");
    if (!data["radius_mm"].is_null()) {
        SEAM_TRY(auto radius, json_number(data, "radius_mm", ""));
        options.radius_mm = radius;
    }
    if (const auto it = data.find("nominal_flange_from_sensor"); it != data.end() && !it->is_null()) {
        SEAM_TRY(auto nominal, parse_pose(*it, "nominal_flange_from_sensor"));
        options.nominal_flange_from_sensor = nominal;
    }
    SEAM_TRY(auto list, json_array(data, "observations", ""));
    for (std::size_t i = 0; i < list->size(); ++i) {
        SEAM_TRY(auto observation, parse_sphere_observation((*list)[i], i, json_path("observations", i)));
        sphere.observations.push_back(std::move(observation));
    }
    return sphere;
}

namespace {

Expected<CalibrationSolution> solve_tcp_sphere(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto sphere, parse_sphere_data(data, exclude));
    SEAM_TRY(auto solved, calibrate_tcp_sphere(sphere.observations, sphere.options));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool ok = solved.status == TcpSphereStatus::ok;
    if (ok) solution.found = SensorOnFlange{{solved.flange_from_sensor, solved.covariance}};
    result["status"] = std::string(name_of(solved.status));
    result["flange_from_sensor"] = ok ? pose_json(solved.flange_from_sensor) : json(nullptr);
    result["centre_base_mm"] = ok ? vector_json(solved.centre_base_mm) : json(nullptr);
    result["radius_mm"] = ok ? json(solved.radius_mm) : json(nullptr);
    result["rms_mm"] = ok ? number_json(solved.rms_mm) : json(nullptr);
    result["noise_mm"] = ok ? number_json(solved.noise_mm) : json(nullptr);
    if (ok) {
        json sigma = pose_sigma_json(solved.flange_from_sensor, solved.covariance);
        const Eigen::Vector3d centre = solved.centre_covariance.diagonal().cwiseMax(0).cwiseSqrt();
        sigma["centre_mm"] = vector_json(centre);
        sigma["radius_mm"] = solved.radius_sigma_mm;
        sigma["working_mm"] = solved.working_sigma_mm;
        result["sigma"] = std::move(sigma);
        result["centre_covariance_mm2"] = matrix_json(solved.centre_covariance);
        result["covariance_pose"] = matrix_json(solved.covariance);
        result["working_point_mm"] = vector_json(solved.working_point_mm);
    } else {
        result["sigma"] = nullptr;
    }
    result["mirrored"] = std::string(name_of(solved.mirrored));
    json proposals = json::array();
    for (const auto& p : solved.proposals)
        proposals.push_back({{"words", p.words},
                             {"base_from_flange", pose_json(p.base_from_flange)},
                             {"sigma_mm", number_json(p.sigma_mm)}});
    result["proposals"] = std::move(proposals);
    solution.report = std::move(solved.report);
    solution.notices = std::move(solved.notices);
    solution.degenerate = std::move(solved.degenerate);
    solution.proposals = std::move(solved.proposals);
    finish_document(solution);
    return solution;
}

json tcp_sphere_example() {
    return {{"radius_mm", example::kRadius_mm}, {"observations", example::sphere_observations()}};
}

// Residuals below this are exact: two readings then tie.
constexpr double kExactPoint_mm = 0.002;

using Lists = std::vector<std::vector<Pose>>;

// The three numbers of a profile weigh very unequally where the poses err, the cut's radius least: two count.
std::optional<ConventionFit> sphere_fit(SphereData& set, const std::vector<Pose>& poses, bool thorough) {
    for (std::size_t i = 0; i < set.observations.size(); ++i) set.observations[i].base_from_flange = poses[i];
    set.options.thorough = thorough;
    const auto solved = calibrate_tcp_sphere(set.observations, set.options);
    if (!solved || solved->status == TcpSphereStatus::not_converged) return std::nullopt;
    const double unknowns = set.options.radius_mm ? 9 : 10;
    return ConventionFit{std::max(kExactPoint_mm * kExactPoint_mm, solved->poses_variance_mm2),
                         std::max(1.0, (solved->poses_freedom + unknowns) * 2 / 3 - unknowns), solved->rms_mm,
                         thorough && solved->fits,
                         thorough ? solved->report.judgement.verdict : Verdict::undetermined};
}

Expected<ConventionFits> tcp_sphere_conventions(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto sphere,
             parse_sphere_data(without_poses(tcp_sphere_method().poses, data, pose_json(Pose::Identity())),
                               exclude));
    const auto set = std::make_shared<SphereData>(std::move(sphere));
    return ConventionFits{[set](const Lists& lists) { return sphere_fit(*set, lists[0], true); },
                          [set](const Lists& lists) { return sphere_fit(*set, lists[0], false); }};
}

// The mounting as far as it is known.
Expected<json> prepare_tcp_sphere(json settings, const Calibration* base, const std::vector<Calibration>&) {
    if (!settings.contains("nominal_flange_from_sensor") && base &&
        !base->flange_from_sensor.isApprox(Pose::Identity()))
        settings["nominal_flange_from_sensor"] = pose_json(base->flange_from_sensor);
    return settings;
}

}  // namespace

CalibrationMethod tcp_sphere_method() {
    CalibrationMethod m;
    m.id = "tcp-sphere";
    m.help = "Sensor on the flange from profiles of one sphere";
    m.usage = "sphere.json --exclude P3";
    m.layout = R"({"radius_mm":R or null,"nominal_flange_from_sensor":POSE?,
   "observations":[{"id"?,"base_from_flange":POSE,"profile":[[x,z],..]},..]}   mm; z null: no return)";
    m.example = tcp_sphere_example;
    m.poses = {{"observations", kRobotPose}};
    m.solve = solve_tcp_sphere;
    m.convention_fits = tcp_sphere_conventions;
    m.entries = "observations";
    m.capture = CaptureKind::sphere_profile;
    m.fewest = 6;
    m.advised = 9;
    m.robot = m.model = true;
    m.settings = {sphere_radius_setting()};
    m.prepare = prepare_tcp_sphere;
    m.title = "Sensor on the flange (sphere)";
    m.why = "Finds where the sensor sits on the flange, from cuts through one fixed sphere.";
    m.need = {"A matt sphere of known radius on a stiff post that nobody touches.",
              "Camera and laser plane calibrated: the profile must be in millimetres.",
              "9 or more poses: the stripe off the middle to both sides, the sensor turned about all three "
              "axes by 20 degrees and more."};
    m.file = "JSON with radius, robot poses and profiles";
    m.drawing = SetUpDrawing::sphere;
    return m;
}

}  // namespace seamwright
