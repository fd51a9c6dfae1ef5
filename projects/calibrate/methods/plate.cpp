// {"points":[{"id"?,"plate":[3],"world":[3]} or {"id"?,"points":[{"plate","world"},..]} (measured in one
// stand, left out together; "base_from_flange"? of it)],"sigma_mm"?,"robot":{"sigma_mm","sigma_deg"?}?} ->
// {"status","world_from_plate","rms_mm","sigma","scale","mirrored",...}

#include "core/calibration/pose/plate.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/statistics.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {
namespace {

using nlohmann::json;

// Of a stand of the robot with several points. Stands see the same points of the plate again: each is solved with as
// the mean over the stands that take part.
struct Stand {
    std::string id;
    std::vector<PlatePoint> points;
    double lever_mm = 0;  // from the flange to the middle of its points; 0: the flange's place is not known
    bool used = true;
};

double squares_of(const Stand& stand, const Pose& world_from_plate) {
    double squares = 0;
    for (const PlatePoint& p : stand.points) squares += (p.world - world_from_plate * p.plate).squaredNorm();
    return squares;
}

// The points of one stand err together, by the robot and the sensor on it, and the mean over the stands hides by how
// much: what the stands say of their own scatter.
struct StandScatter {
    double rms_mm = 0;    // of a point an axis, about the mean
    double sigma_mm = 0;  // of a mean point an axis, as if its error were its own (Student's factor in it)
};
std::optional<StandScatter> scatter_of(const std::vector<Stand>& stands, const Pose& world_from_plate) {
    double squares = 0, points = 0, used = 0;
    for (const Stand& stand : stands) {
        if (!stand.used) continue;
        squares += squares_of(stand, world_from_plate);
        points += static_cast<double>(stand.points.size());
        ++used;
    }
    if (used < 2) return std::nullopt;
    const double each = points / used;
    StandScatter scatter;
    scatter.rms_mm = std::sqrt(squares / (3 * each * (used - 1)));
    // A stand errs in six ways.
    const double student = student_quantile(0.975, 6 * (used - 1)) / 1.959964;
    scatter.sigma_mm = scatter.rms_mm * student * std::sqrt(each / used);
    return scatter;
}

// Of a mean point an axis, as if its error were its own, by the robot's stated repeatability: the points of a stand err
// together, and more stands make it smaller. Points by themselves were touched one by one.
double stated_sigma_mm(const RobotRepeatability& robot, const std::vector<Stand>& stands) {
    double variance = 0, points = 0, used = 0;
    for (const Stand& stand : stands) {
        if (!stand.used) continue;
        variance += std::pow(robot.sigma_mm, 2) + std::pow(robot.sigma_rad * stand.lever_mm, 2);
        points += static_cast<double>(stand.points.size());
        ++used;
    }
    return used == 0 ? robot.sigma_mm : std::sqrt(variance / used * (points / used) / used);
}

Expected<double> lever_of(const json& entry, const Stand& stand, const std::string& where) {
    const auto field = entry.find("base_from_flange");
    if (field == entry.end() || field->is_null()) return 0.0;
    SEAM_TRY(const Pose base_from_flange, parse_pose(*field, json_path(where, "base_from_flange")));
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const PlatePoint& p : stand.points) middle += p.world / static_cast<double>(stand.points.size());
    return (middle - base_from_flange.translation()).norm();
}

Expected<CalibrationSolution> solve_plate(const json& data, const ExcludedIds& exclude) {
    PlateOptions options;
    options.exclude = exclude;
    if (data.contains("sigma_mm") && !data["sigma_mm"].is_null()) {
        SEAM_TRY(auto sigma, json_sigma(data, "sigma_mm", ""));
        options.sigma_mm = sigma;
    }
    SEAM_TRY(const auto robot, repeatability_of(data));
    SEAM_TRY(auto list, json_array(data, "points", ""));
    std::vector<PlatePoint> points;
    std::vector<Stand> stands;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& entry = (*list)[i];
        const std::string where = json_path("points", i);
        SEAM_TRY(auto id, entry_id(entry, i, where));
        const auto point = [](const json& from, const std::string& name,
                              const std::string& at) -> Expected<PlatePoint> {
            SEAM_TRY(auto plate, json_vector3(from, "plate", at));
            SEAM_TRY(auto world, json_vector3(from, "world", at));
            return PlatePoint{name, plate, world};
        };
        if (!entry.contains("points")) {
            SEAM_TRY(auto one, point(entry, id, where));
            points.push_back(std::move(one));
            continue;
        }
        SEAM_TRY(auto inner, json_array(entry, "points", where));
        if (inner->empty()) return input_error("there is no point", json_path(where, "points"));
        Stand stand;
        stand.id = id;
        stand.used = std::erase(options.exclude, id) == 0;
        for (std::size_t k = 0; k < inner->size(); ++k) {
            SEAM_TRY(auto one,
                     point((*inner)[k], std::to_string(k + 1), json_path(json_path(where, "points"), k)));
            stand.points.push_back(std::move(one));
        }
        SEAM_TRY(const double lever, lever_of(entry, stand, where));
        stand.lever_mm = lever;
        stands.push_back(std::move(stand));
    }
    std::vector<std::pair<PlatePoint, int>> means;
    for (const Stand& stand : stands) {
        if (!stand.used) continue;
        for (const PlatePoint& p : stand.points) {
            auto same = std::find_if(means.begin(), means.end(),
                                     [&](const auto& m) { return m.first.plate.isApprox(p.plate, 1e-9); });
            if (same == means.end()) {
                means.emplace_back(p, 1);
                means.back().first.id = "corner " + std::to_string(means.size());
            } else {
                same->first.world = (same->first.world * same->second + p.world) / (same->second + 1);
                ++same->second;
            }
        }
    }
    const std::size_t single = points.size();
    for (auto& m : means) points.push_back(std::move(m.first));
    auto solved = calibrate_plate(points, options);
    if (!solved) return tl::unexpected(solved.error());
    const auto scatter = scatter_of(stands, solved->world_from_plate);
    const double stated = stated_sigma_mm(robot, stands), shown = scatter ? scatter->sigma_mm : 0;
    if (solved->status == PlateStatus::ok && std::max(shown, stated) > solved->sigma_mm) {
        const Verdict alone = solved->report.judgement.verdict;
        options.sigma_mm = std::max(shown, stated);
        solved = calibrate_plate(points, options);
        if (!solved) return tl::unexpected(solved.error());
        Judgement& judgement = solved->report.judgement;
        if (judgement.verdict != alone && shown >= stated)
            judgement = {
                judgement.verdict,
                Text("the robot's stands disagree by {:.3f} mm; {}", scatter->rms_mm, judgement.reason),
                "check the target's pitch, the calibration in use and the robot's poses, and measure from "
                "more stands"};
        else if (judgement.verdict != alone)
            judgement = {
                judgement.verdict,
                Text("the robot comes back within {:.3f} mm only; {}", robot.sigma_mm, judgement.reason),
                "measure from more stands"};
    }

    CalibrationSolution solution;
    json& result = solution.document;
    const bool ok = solved->status == PlateStatus::ok;
    result["status"] = std::string(name_of(solved->status));
    result["world_from_plate"] = ok ? pose_json(solved->world_from_plate) : json(nullptr);
    result["rms_mm"] = ok ? number_json(solved->rms_mm) : json(nullptr);
    result["sigma"] = ok ? pose_sigma_json(solved->world_from_plate, solved->covariance) : json(nullptr);
    if (ok) {
        result["covariance_pose"] = matrix_json(solved->covariance);
        result["point_sigma_mm"] = number_json(solved->sigma_mm);
        result["scale"] = number_json(solved->scale);
        result["mirrored"] = solved->mirrored;
    }
    if (ok) solution.found = PlateInWorld{{solved->world_from_plate, solved->covariance}};
    CalibrationReport report = solved->report;
    if (!stands.empty()) {  // people left stands out, not means
        report.poses.resize(single);
        for (const Stand& stand : stands) {
            PoseResidual row;
            row.id = stand.id;
            row.used = stand.used;
            if (!stand.used) row.note = "excluded";
            if (ok)
                row.rms_mm = std::sqrt(squares_of(stand, solved->world_from_plate) /
                                       static_cast<double>(stand.points.size()));
            report.poses.push_back(std::move(row));
        }
    }
    solution.report = std::move(report);
    solution.notices = std::move(solved->notices);
    finish_document(solution);
    return solution;
}

json plate_example() {
    example::Dither dither;
    const Pose world_from_plate = example::base_from_target();
    json points = json::array();
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(200, 0, 0), Eigen::Vector3d(200, 150, 0),
          Eigen::Vector3d(0, 150, 0), Eigen::Vector3d(100, 75, 0), Eigen::Vector3d(60, 120, 0),
          Eigen::Vector3d(140, 30, 0)}) {
        const Eigen::Vector3d noise(dither(0.03), dither(0.03), dither(0.03));
        points.push_back({{"id", "P" + std::to_string(points.size() + 1)},
                          {"plate", example::vector3_json(p)},
                          {"world", example::vector3_json(world_from_plate * p + noise)}});
    }
    return {{"points", points}, {"sigma_mm", 0.03}};
}

}  // namespace

CalibrationMethod plate_method() {
    CalibrationMethod m;
    m.id = "plate";
    m.help = "Plate in the world from two point sets";
    m.usage = "points.json";
    m.layout = R"({"points":[{"id"?,"plate":[x,y,z],"world":[x,y,z]},..],"sigma_mm"?,
   "robot":{"sigma_mm","sigma_deg"?}?}   mm)";
    m.fields = {{"", {"points", "sigma_mm", "robot"}, {"board"}},
                {"points[]", {"id", "plate", "world", "points", "base_from_flange"}, {"size", "outline"}},
                {"points[].points[]", {"id", "plate", "world"}},
                robot_fields()};
    m.example = plate_example;
    m.solve = solve_plate;
    m.entries = "points";
    m.capture = CaptureKind::board_points;
    m.use = AnswerUse::record;
    m.fewest = 3;
    m.advised = 6;
    m.model = m.repeatability = true;
    m.settings = board_settings();
    m.title = "Plate in the world";
    m.why = "Finds where a plate stands, from points known on it and measured in the world.";
    m.need = {
        "A board on the plate and the calibrated sensor on the robot: every capture gives its outer "
        "corners.",
        "Or 6 or more points measured by robot tip, laser tracker or total station, from a file: far "
        "apart and not on one line."};
    m.file = "JSON with points on the plate and in the world";
    m.drawing = SetUpDrawing::plate_in_world;
    return m;
}

}  // namespace seamwright
