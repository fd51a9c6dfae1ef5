// {"radius_mm":r or null,"observations":[{"id","base_from_flange":POSE,"profile":[[x,z],..]}],
//  "nominal_flange_from_sensor":POSE?,"robot":{"sigma_mm","sigma_deg"?}?}; z null = no return; robot: of one arrival, an axis.
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
#include "projects/calibrate/input/sphere_data.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {

using nlohmann::json;

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
        put_scale(solved.scale, solution);
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
    m.layout =
        R"({"radius_mm":R or null,"nominal_flange_from_sensor":POSE?,"robot":{"sigma_mm","sigma_deg"?}?,
   "observations":[{"id"?,"base_from_flange":POSE,"profile":[[x,z],..]},..]}   mm; z null: no return)";
    m.fields = {{"", {"radius_mm", "nominal_flange_from_sensor", "observations", "robot"}},
                {"observations[]", {"id", "base_from_flange", "profile"}},
                robot_fields()};
    m.example = tcp_sphere_example;
    m.poses = {{"observations", kRobotPose}};
    m.quantities = {{"observations[].base_from_flange"}, {"observations[].profile", QuantityKind::lengths}};
    m.solve = solve_tcp_sphere;
    m.convention_fits = tcp_sphere_conventions;
    m.entries = "observations";
    m.capture = CaptureKind::sphere_profile;
    m.fewest = 6;
    // With the scatter of a robot that nobody has stated (0.03 mm an axis), 9 serve in 17 cells of 20, 12 in all.
    m.advised = 12;
    m.robot = m.model = m.repeatability = true;
    m.settings = {sphere_radius_setting()};
    m.prepare = prepare_tcp_sphere;
    m.title = "Sensor on the flange (sphere)";
    m.why = "Finds where the sensor sits on the flange, from cuts through one fixed sphere.";
    m.need = {"A matt sphere of known radius on a stiff post that nobody touches.",
              "Camera and laser plane calibrated: the profile must be in millimetres.",
              "12 or more poses: the stripe off the middle to both sides, the sensor turned about all three "
              "axes by 20 degrees and more."};
    m.file = "JSON with radius, robot poses and profiles";
    m.drawing = SetUpDrawing::sphere;
    return m;
}

}  // namespace seamwright
