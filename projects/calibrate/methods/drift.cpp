// {"flange_from_sensor":POSE
// (stored),"observations":[{"id"?,"base_from_flange":POSE,"profile":[[x,z],..],"centre_base_mm":[3],
//  "radius_mm"}],"other_sigma_mm"?,"robot":{"sigma_mm","sigma_deg"?}?,"limits":{"translation_mm","rotation_deg"}?,
//  "covariance"?}: centre and radius may stand once at the top; or
// {"measurements":[{"id"?,"base_from_flange":POSE,"measured_flange":[3],"known_base":[3],"sigma_mm"?}],"limits"?}
// (plate points).
// "covariance": of the stored calibration as the result of tcp-sphere holds it, 9x9 or 10x10 in mm and deg (mounting, centre
// at the top, radius where it was solved for), or 6x6 of the mounting alone; absent: taken as exact, which a notice says.
// ->
// {"status":"holds|drifted|undetermined","change":POSE,"change_mm","change_deg","sigma_mm","sigma_deg","chi_squared",
//     "chi_squared_limit","not_determined",...}

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/calibration/sphere/drift_check.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/input/sphere_data.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {
namespace {

using nlohmann::json;

constexpr double kSmallestSphere_mm = 0.1, kLargestSphere_mm = 1000;  // radius

// A field of the entry, or the one at the top that counts for all.
const json& entry_or_top(const json& entry, const json& data, const char* key) {
    return entry.contains(key) ? entry : data;
}

Expected<std::vector<DriftMeasurement>> from_spheres(const json& data,
                                                     const std::vector<std::string>& exclude) {
    SEAM_TRY(auto stored_field, json_field(data, "flange_from_sensor", ""));
    SEAM_TRY(auto stored, parse_pose(*stored_field, "flange_from_sensor"));
    SEAM_TRY(auto other, json_sigma_or_exact(data, "other_sigma_mm", 0.02, ""));
    SEAM_TRY(auto list, json_array(data, "observations", ""));
    std::vector<DriftMeasurement> measurements;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& entry = (*list)[i];
        const std::string where = json_path("observations", i);
        SEAM_TRY(auto observation, parse_sphere_observation(entry, i, where));
        if (std::find(exclude.begin(), exclude.end(), observation.id) != exclude.end()) continue;
        SEAM_TRY(auto radius, json_number(entry_or_top(entry, data, "radius_mm"), "radius_mm", where));
        if (!(radius >= kSmallestSphere_mm && radius <= kLargestSphere_mm))
            return input_error("the sphere's radius is not between 0.1 and 1000 mm",
                               entry.contains("radius_mm") ? json_path(where, "radius_mm") : "radius_mm",
                               "give it in millimetres as its certificate says");
        SEAM_TRY(auto centre,
                 json_vector3(entry_or_top(entry, data, "centre_base_mm"), "centre_base_mm", where));
        SEAM_TRY(auto measurement, drift_measurement(observation, radius, stored, centre, other));
        // A sphere with a centre of its own is not the one that the calibration knows.
        if (entry.contains("centre_base_mm")) measurement.by_stored.rightCols<4>().setZero();
        measurements.push_back(measurement);
    }
    return measurements;
}

Expected<std::vector<DriftMeasurement>> from_points(const json& data,
                                                    const std::vector<std::string>& exclude) {
    SEAM_TRY(auto list, json_array(data, "measurements", ""));
    std::optional<Pose> stored;
    if (data.contains("covariance")) {
        SEAM_TRY(auto stored_field, json_field(data, "flange_from_sensor", ""));
        SEAM_TRY(auto pose, parse_pose(*stored_field, "flange_from_sensor"));
        stored = pose;
    }
    std::vector<DriftMeasurement> measurements;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& entry = (*list)[i];
        const std::string where = json_path("measurements", i);
        DriftMeasurement m;
        SEAM_TRY(auto id, entry_id(entry, i, where));
        m.id = id;
        if (std::find(exclude.begin(), exclude.end(), m.id) != exclude.end()) continue;
        SEAM_TRY(auto field, json_field(entry, "base_from_flange", where));
        SEAM_TRY(auto pose, parse_pose(*field, json_path(where, "base_from_flange")));
        m.base_from_flange = pose;
        SEAM_TRY(auto measured, json_vector3(entry, "measured_flange", where));
        m.measured_flange_mm = measured;
        if (stored) m.by_stored.leftCols<6>() = drift_by_mounting(*stored, measured);
        SEAM_TRY(auto known, json_vector3(entry, "known_base", where));
        m.known_base_mm = known;
        double sigma = 0.05;
        if (entry.contains("sigma_mm")) {
            SEAM_TRY(sigma, json_sigma(entry, "sigma_mm", where));
        }
        m.covariance = sigma * sigma * Eigen::Matrix3d::Identity();
        measurements.push_back(m);
    }
    return measurements;
}

// "covariance", zero where absent.
Expected<StoredCovariance> stored_covariance(const json& data) {
    StoredCovariance stored = StoredCovariance::Zero();
    const auto it = data.find("covariance");
    if (it == data.end() || it->is_null()) return stored;
    const std::size_t n = it->is_array() ? it->size() : 0;
    if (n != 6 && n != 9 && n != 10)
        return input_error("the covariance of the stored calibration is no matrix of 6, 9 or 10 rows",
                           "covariance", "give it as the calibration's result states it");
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = 0; k < n; ++k) {
            const json& row = (*it)[i];
            if (!row.is_array() || row.size() != n || !row[k].is_number())
                return input_error("the covariance of the stored calibration is no square of numbers",
                                   "covariance", "give it as the calibration's result states it");
            const auto turns = [](std::size_t at) { return at >= 3 && at < 6 ? rad_from_deg(1) : 1.0; };
            stored(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
                row[k].get<double>() * turns(i) * turns(k);
        }
    Eigen::VectorXd variances = stored.diagonal().head(static_cast<Eigen::Index>(n));
    if (n > 6) variances.tail(static_cast<Eigen::Index>(n) - 6) *= std::pow(rad_from_deg(1), 2);
    SEAM_OK(check_variances(variances, "covariance"));
    return stored;
}

// The flange stands off by what the robot repeats, and its turn acts with the lever to the place that is measured.
void add_repeatability(const RobotRepeatability& robot, std::vector<DriftMeasurement>& measurements) {
    for (DriftMeasurement& m : measurements) {
        const Eigen::Matrix3d lever = skew(m.measured_flange_mm);
        m.covariance += robot.sigma_mm * robot.sigma_mm * Eigen::Matrix3d::Identity() +
                        robot.sigma_rad * robot.sigma_rad * lever * lever.transpose();
    }
}

Expected<CalibrationSolution> solve_drift(const json& data, const ExcludedIds& exclude) {
    DriftLimits limits;
    if (const auto it = data.find("limits"); it != data.end()) {
        SEAM_TRY(auto mm, json_number_or(*it, "translation_mm", limits.translation_mm, "limits"));
        SEAM_TRY(auto deg, json_number_or(*it, "rotation_deg", limits.rotation_deg, "limits"));
        limits = {mm, deg};
    }
    auto measurements =
        data.contains("measurements") ? from_points(data, exclude) : from_spheres(data, exclude);
    if (!measurements) return tl::unexpected(measurements.error());
    SEAM_TRY(const auto robot, repeatability_of(data));
    add_repeatability(robot, *measurements);
    SEAM_TRY(const auto stored, stored_covariance(data));
    SEAM_TRY(auto checked, check_drift(*measurements, limits, stored));

    CalibrationSolution solution;
    if (stored.isZero(0))
        solution.notices.emplace_back(
            "the covariance of the stored calibration is not given: its mounting and centre are taken as "
            "exact, and "
            "what they err is taken for a change");
    json& result = solution.document;
    result["status"] = std::string(name_of(checked.status));
    result["change"] = pose_json(checked.change);
    result["change_mm"] = checked.change_mm;
    result["change_deg"] = checked.change_deg;
    result["sigma_mm"] = number_json(checked.sigma_mm);
    result["sigma_deg"] = number_json(checked.sigma_deg);
    result["sigma"] = pose_sigma_json(checked.change, checked.covariance);
    result["chi_squared"] = number_json(checked.chi_squared);
    result["chi_squared_limit"] = checked.chi_squared_limit;
    result["rms_before_mm"] = number_json(checked.rms_before_mm);
    result["rms_after_mm"] = number_json(checked.rms_after_mm);
    result["not_determined"] = checked.not_determined;
    solution.report = std::move(checked.report);
    finish_document(solution);
    return solution;
}

// Of a good calibration: 0.02 mm and 0.004 degrees.
json example_covariance() {
    Eigen::VectorXd sigma = Eigen::VectorXd::Constant(9, 0.02);
    sigma.segment<3>(3).setConstant(0.004);
    return matrix_json(sigma.cwiseAbs2().asDiagonal());
}

json drift_example() {
    json observations = example::sphere_observations();
    return {{"flange_from_sensor", pose_json(example::flange_from_sensor())},
            {"centre_base_mm", example::vector3_json(example::base_from_target().translation())},
            {"radius_mm", example::kRadius_mm},
            {"covariance", example_covariance()},
            {"observations", observations}};
}

Expected<json> prepare_drift(json settings, const Calibration* base, const std::vector<Calibration>&) {
    if (!base) return input_error("there is no calibration in use to check", "drift", "calibrate first");
    settings["flange_from_sensor"] = pose_json(base->flange_from_sensor);
    if (!settings.contains("covariance") && base->result.contains("covariance") &&
        base->result["covariance"].is_array()) {
        const std::size_t rows = base->result["covariance"].size();
        if (base->result.contains("centre_base_mm") && !settings.contains("centre_base_mm") &&
            (rows == 9 || rows == 10))
            settings["covariance"] = base->result["covariance"];
    }
    if (!settings.contains("covariance") && !base->covariance.isZero(0)) {
        Vector6 unit = Vector6::Ones();
        unit.tail<3>().setConstant(deg_from_rad(1));
        settings["covariance"] = matrix_json(unit.asDiagonal() * base->covariance * unit.asDiagonal());
    }
    if (base->result.contains("centre_base_mm") && base->result["centre_base_mm"].is_array() &&
        !settings.contains("centre_base_mm")) {
        settings["centre_base_mm"] = base->result["centre_base_mm"];
        if (base->result.contains("radius_mm") && base->result["radius_mm"].is_number())
            settings["radius_mm"] = base->result["radius_mm"];
    }
    if (!settings.contains("centre_base_mm"))
        return input_error("where the sphere stands is not known", "drift",
                           "check a calibration that was made with the sphere, or load measured data");
    return settings;
}

}  // namespace

CalibrationMethod drift_method() {
    CalibrationMethod m;
    m.id = "drift";
    m.help = "Does a stored calibration still hold";
    m.usage = "measured.json";
    m.layout =
        R"({"flange_from_sensor":POSE,"centre_base_mm":[x,y,z],"radius_mm":R,"other_sigma_mm"?,"robot":{"sigma_mm","sigma_deg"?}?,
   "limits":{"translation_mm","rotation_deg"}?,"covariance":as in tcp-sphere's result?,"observations":[{"id"?,"base_from_flange":POSE,"profile":[[x,z],..]},..]}
  or {"measurements":[{"id"?,"base_from_flange":POSE,"measured_flange":[x,y,z],"known_base":[x,y,z],"sigma_mm"?},..]})";
    m.fields = {{"",
                 {"flange_from_sensor", "centre_base_mm", "radius_mm", "observations", "measurements",
                  "other_sigma_mm", "limits", "covariance", "robot"}},
                {"observations[]", {"id", "base_from_flange", "profile", "centre_base_mm", "radius_mm"}},
                {"measurements[]", {"id", "base_from_flange", "measured_flange", "known_base", "sigma_mm"}},
                {"limits", {"translation_mm", "rotation_deg"}},
                robot_fields()};
    m.example = drift_example;
    m.poses = {{"observations", kRobotPose}, {"measurements", kRobotPose}};
    m.quantities = {{"observations[].base_from_flange"},
                    {"observations[].profile", QuantityKind::lengths},
                    {"measurements[].base_from_flange"},
                    {"measurements[].measured_flange", QuantityKind::lengths},
                    {"measurements[].known_base", QuantityKind::lengths},
                    {"flange_from_sensor"}};
    m.solve = solve_drift;
    m.entries = "observations";
    m.capture = CaptureKind::sphere_profile;
    m.use = AnswerUse::check;
    m.fewest = 1;
    m.advised = kDriftViews;
    m.robot = m.model = m.repeatability = true;
    m.keeps_back = false;
    m.settings = {
        sphere_radius_setting(),
        number_setting("limit_mm", "/limits/translation_mm", "mm", 0.001, 10, 0.1, 3,
                       "A shift beyond this counts as drifted.", "Allowed shift"),
        number_setting("limit_deg", "/limits/rotation_deg", "deg", 0.001, 10, DriftLimits{}.rotation_deg, 3,
                       "A turn beyond this counts as drifted.", "Allowed turn")};
    m.prepare = prepare_drift;
    m.title = "Does the calibration still hold?";
    m.why = "Measures the sphere again and says whether the sensor has moved on its flange.";
    m.need = {"The sphere where it stood when the sensor was calibrated.",
              "9 poses from different directions, the sphere near and far, left and right in the view."};
    m.file = "JSON with stored calibration and new profiles";
    m.drawing = SetUpDrawing::moved_sphere;
    return m;
}

}  // namespace seamwright
