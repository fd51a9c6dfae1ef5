#include "projects/calibrate/methods/other_units.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/notation.h"
#include "devices/exchange/pose_json.h"
#include "projects/file/stored_text.h"

namespace seamwright {
namespace {

using nlohmann::json;

// Largest coordinates for which a quantity is tried in a unit: beyond, it is none of a robot's cell.
struct Unit {
    const char* name;
    double in_mm, from, to;
};
constexpr std::array<Unit, 3> kUnits{
    {{"inches", 25.4, 0, 400}, {"metres", 1000, 0, 20}, {"micrometres", 0.001, 2000, 1e9}}};

// Every value at the place. `at`: what is left of it.
template <class Visit>
void visit_at(json& value, std::string_view at, const Visit& visit) {
    if (at.starts_with("[]")) {
        if (value.is_array())
            for (json& entry : value) visit_at(entry, at.substr(2), visit);
        return;
    }
    if (at.empty()) {
        if (!value.is_null()) visit(value);
        return;
    }
    if (!value.is_object()) return;
    if (at.front() == '.') at.remove_prefix(1);
    const std::string key(at.substr(0, at.find_first_of(".[")));
    if (const auto it = value.find(key); it != value.end()) visit_at(*it, at.substr(key.size()), visit);
}

json& pose_of_link(json& value) {
    return value.is_object() && value.contains("pose") ? value["pose"] : value;
}

void change_poses(json& data, const DataQuantity& which, const std::function<Pose(const Pose&)>& change) {
    visit_at(data, which.at, [&](json& value) {
        json& at = pose_of_link(value);
        if (const auto pose = parse_pose(at, "")) at = pose_json(change(*pose));
    });
}

void scale(json& value, double factor) {
    if (value.is_number()) value = value.get<double>() * factor;
    if (value.is_array())
        for (json& one : value) scale(one, factor);
}

double largest(const json& value) {
    if (value.is_number()) return std::abs(value.get<double>());
    double most = 0;
    if (value.is_array())
        for (const json& one : value) most = std::max(most, largest(one));
    return most;
}

std::vector<Pose> poses_of(json& data, const DataQuantity& which) {
    std::vector<Pose> poses;
    visit_at(data, which.at, [&](json& value) {
        if (const auto pose = parse_pose(pose_of_link(value), "")) poses.push_back(*pose);
    });
    return poses;
}

double largest_coordinate(json& data, const DataQuantity& which) {
    double most = 0;
    if (which.kind == QuantityKind::poses)
        for (const Pose& p : poses_of(data, which))
            most = std::max(most, p.translation().cwiseAbs().maxCoeff());
    else
        visit_at(data, which.at, [&](const json& value) { most = std::max(most, largest(value)); });
    return most;
}

// As KUKA A, B, C whose radians were read as degrees.
Pose from_radians(const Pose& pose) {
    const KukaAbc read = kuka_from_rotation(pose.linear());
    return make_pose(
        rotation_from_kuka({deg_from_rad(read.a_deg), deg_from_rad(read.b_deg), deg_from_rad(read.c_deg)}),
        pose.translation());
}

std::string name_of(const DataQuantity& which) {
    return which.at.substr(which.at.rfind('.') + 1);
}

bool without_its_poses(const CalibrationMethod& method, const CalibrationSolution& solution, json& data) {
    const auto* camera = std::get_if<CameraAndLaser>(&solution.found);
    return camera && method.capture == CaptureKind::board_and_stripe && !camera->flange_from_camera &&
           !poses_of(data, method.quantities.front()).empty();
}

}  // namespace

bool may_be_radians(const std::vector<Pose>& poses) {
    return !poses.empty() && std::all_of(poses.begin(), poses.end(), [](const Pose& pose) {
        const KukaAbc read = kuka_from_rotation(pose.linear());
        return std::max({std::abs(read.a_deg), std::abs(read.b_deg), std::abs(read.c_deg)}) <
               kHalfTurnOfRadians;
    });
}

Text other_unit(const CalibrationMethod& method, const json& data, const ExcludedIds& exclude) {
    const auto fits = [&](json changed) {
        const auto solved = method.solve(changed, exclude);
        return solved && serves(solved->verdict()) && !without_its_poses(method, *solved, changed);
    };
    json given = data, both = data;
    int small = 0;
    for (const DataQuantity& which : method.quantities) {
        if (which.kind != QuantityKind::poses || !may_be_radians(poses_of(given, which))) continue;
        json changed = data;
        change_poses(changed, which, from_radians);
        if (fits(std::move(changed)))
            return Text("the angles of {} are radians: write degrees", name_of(which));
        change_poses(both, which, from_radians);
        ++small;
    }
    if (small == 2 && fits(std::move(both))) return "the angles of both lists are radians: write degrees";
    for (const DataQuantity& which : method.quantities) {
        const double most = largest_coordinate(given, which);
        for (const Unit& unit : kUnits) {
            if (!(most > unit.from && most < unit.to)) continue;
            json changed = data;
            if (which.kind == QuantityKind::poses)
                change_poses(changed, which, [&](Pose pose) {
                    pose.translation() *= unit.in_mm;
                    return pose;
                });
            else
                visit_at(changed, which.at, [&](json& value) { scale(value, unit.in_mm); });
            if (fits(std::move(changed)))
                return Text("the lengths of {} are {}: write millimetres", name_of(which), Text(unit.name));
        }
    }
    return {};
}

void name_other_unit(const CalibrationMethod& method, const json& data, const ExcludedIds& exclude,
                     Expected<CalibrationSolution>& solution) {
    if (method.quantities.empty()) return;
    if (!solution) {
        if (solution.error().kind != ErrorKind::input) return;
        if (Text unit = other_unit(method, data, exclude); !unit.empty())
            solution.error().mend = std::move(unit);
        return;
    }
    json given = data;
    const bool without = without_its_poses(method, *solution, given);
    if (serves(solution->verdict()) && !without) return;
    Text unit = other_unit(method, data, exclude);
    if (unit.empty()) return;
    Judgement& judgement = solution->report.judgement;
    if (serves(judgement.verdict)) judgement.verdict = Verdict::poor;
    judgement.cure = std::move(unit);
    put_judgement(judgement, solution->document);
}

}  // namespace seamwright
