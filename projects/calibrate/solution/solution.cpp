#include "projects/calibrate/solution/solution.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/geometry/notation.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/solution/camera_json.h"
#include "projects/file/stored_text.h"

namespace seamwright {

using nlohmann::json;

json number_json(double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
}

json vector_json(const Eigen::VectorXd& values) {
    json list = json::array();
    for (const double value : values) list.push_back(number_json(value));
    return list;
}

json matrix_json(const Eigen::MatrixXd& matrix) {
    json rows = json::array();
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back(vector_json(matrix.row(i).transpose()));
    return rows;
}

json pose_sigma_json(const Pose& pose, const Matrix6& covariance) {
    const Eigen::Matrix3d jacobian = kuka_jacobian(pose.linear());
    const Eigen::Matrix3d angles = jacobian * covariance.bottomRightCorner<3, 3>() * jacobian.transpose();
    const Eigen::Vector3d xyz = covariance.topLeftCorner<3, 3>().diagonal().cwiseMax(0).cwiseSqrt();
    const Eigen::Vector3d abc = angles.diagonal().cwiseMax(0).cwiseSqrt() * (180 / kPi);
    return {{"xyz_mm", vector_json(xyz)}, {"abc_deg", vector_json(abc)}};
}

void put_judgement(const Judgement& judgement, json& document) {
    document["verdict"] = std::string(name_of(judgement.verdict));
    put_text(document, "reason", judgement.reason);
    put_text(document, "cure", judgement.cure);
}

namespace {

void put_report(const CalibrationReport& report, json& document) {
    put_judgement(report.judgement, document);
    json parameters = json::array();
    for (const auto& p : report.parameters)
        parameters.push_back({{"name", p.name},
                              {"value", number_json(p.value)},
                              {"unit", p.unit},
                              {"sigma", number_json(p.sigma)}});
    document["parameters"] = std::move(parameters);
    document["covariance"] = matrix_json(report.covariance);
    json correlations = json::array();
    for (const auto& c : report.correlations)
        correlations.push_back(
            {{"first", c.first}, {"second", c.second}, {"correlation", number_json(c.correlation)}});
    document["correlations"] = std::move(correlations);
    json poses = json::array();
    for (const auto& p : report.poses) {
        poses.push_back({{"id", p.id},
                         {"rms_mm", number_json(p.rms_mm)},
                         {"deg", number_json(p.deg)},
                         {"rms_px", number_json(p.rms_px)},
                         {"used", p.used},
                         {"contradicts", p.contradicts}});
        put_text(poses.back(), "note", p.note);
    }
    document["per_pose"] = std::move(poses);
    const auto& h = report.hold_out;
    document["hold_out"] = {{"folds", h.folds},
                            {"left_out", h.left_out},
                            {"rms_mm", number_json(h.rms_mm)},
                            {"max_mm", number_json(h.max_mm)},
                            {"rms_deg", number_json(h.rms_deg)},
                            {"rms_px", number_json(h.rms_px)}};
}

// Fields of another type count as absent: documents come from people and from disks.
template <class T>
T field_or(const json& entry, const char* key, T otherwise) {
    const auto it = entry.find(key);
    if (it == entry.end()) return otherwise;
    if constexpr (std::is_same_v<T, bool>)
        return it->is_boolean() ? it->get<bool>() : otherwise;
    else if constexpr (std::is_same_v<T, int>)
        return it->is_number_integer() ? static_cast<int>(std::clamp<std::int64_t>(
                                             it->get<std::int64_t>(), 0, std::numeric_limits<int>::max()))
                                       : otherwise;
    else
        return it->is_string() ? it->get<std::string>() : otherwise;
}
std::string word_or_none(const json& entry, const char* key) {
    return field_or<std::string>(entry, key, "");
}

double number_or_none(const json& entry, const char* key) {
    const auto it = entry.find(key);
    return it != entry.end() && it->is_number() ? it->get<double>()
                                                : std::numeric_limits<double>::quiet_NaN();
}

Judgement judgement_in(const json& document) {
    Judgement judgement;
    if (const auto word = document.find("verdict"); word != document.end() && word->is_string())
        judgement.verdict = verdict_from(word->get<std::string>()).value_or(Verdict::undetermined);
    judgement.reason = text_in(document, "reason");
    judgement.cure = text_in(document, "cure");
    return judgement;
}

CalibrationReport report_in(const json& document) {
    CalibrationReport report;
    report.judgement = judgement_in(document);
    const auto each = [&](const char* key, const auto& take) {
        if (const auto list = document.find(key); list != document.end() && list->is_array())
            for (const json& one : *list)
                if (one.is_object()) take(one);
    };
    each("parameters", [&](const json& p) {
        report.parameters.push_back({word_or_none(p, "name"), number_or_none(p, "value"),
                                     word_or_none(p, "unit"), number_or_none(p, "sigma")});
    });
    each("correlations", [&](const json& c) {
        report.correlations.push_back(
            {word_or_none(c, "first"), word_or_none(c, "second"), number_or_none(c, "correlation")});
    });
    each("per_pose", [&](const json& p) {
        PoseResidual one;
        one.id = word_or_none(p, "id");
        one.rms_mm = number_or_none(p, "rms_mm");
        one.deg = number_or_none(p, "deg");
        one.rms_px = number_or_none(p, "rms_px");
        one.used = field_or(p, "used", true);
        one.contradicts = field_or(p, "contradicts", false);
        one.note = text_in(p, "note");
        report.poses.push_back(std::move(one));
    });
    if (const auto h = document.find("hold_out"); h != document.end() && h->is_object())
        report.hold_out = {field_or(*h, "folds", 0),      field_or(*h, "left_out", 0),
                           number_or_none(*h, "rms_mm"),  number_or_none(*h, "max_mm"),
                           number_or_none(*h, "rms_deg"), number_or_none(*h, "rms_px")};
    return report;
}

// Of a document of a person's own: what is no 6 x 6 counts as absent.
Matrix6 covariance_in(const json& holder, const char* key) {
    Matrix6 m = Matrix6::Zero();
    const auto it = holder.find(key);
    if (it == holder.end() || !it->is_array() || it->size() != 6) return m;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < 6; ++k)
            if ((*it)[i].is_array() && (*it)[i].size() == 6 && (*it)[i][k].is_number())
                m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = (*it)[i][k].get<double>();
    return m;
}

bool holds(const json& document, const char* key) {
    const auto it = document.find(key);
    return it != document.end() && it->is_object();
}

Expected<UncertainPose> uncertain_in(const json& holder, const char* key, const char* covariance) {
    SEAM_TRY(auto pose, parse_pose(holder.at(key), key));
    return UncertainPose{pose, covariance_in(holder, covariance)};
}

Expected<CalibrationFinding> chains_in(const json& list) {
    SensorChains found;
    for (const json& one : list) {
        if (!one.is_object()) return input_error("this is no chain of a sensor", "sensors");
        SensorChains::Chain chain{word_or_none(one, "id"), std::nullopt, judgement_in(one)};
        if (holds(one, "reference_from_laser")) {
            SEAM_TRY(auto pose, uncertain_in(one, "reference_from_laser", "covariance"));
            chain.reference_from_laser = pose;
        }
        found.chains.push_back(std::move(chain));
    }
    return found;
}

// What was found shows in the fields that are there, whatever method wrote them.
Expected<CalibrationFinding> finding_in(const json& document) {
    if (const auto sensors = document.find("sensors"); sensors != document.end() && sensors->is_array())
        return chains_in(*sensors);
    if (holds(document, "camera")) {
        CameraAndLaser found;
        SEAM_TRY(auto camera, parse_camera(document["camera"], "camera"));
        found.camera = camera;
        if (holds(document, "camera_from_laser")) {
            SEAM_TRY(auto laser, parse_pose(document["camera_from_laser"], "camera_from_laser"));
            found.camera_from_laser = laser;
        }
        if (holds(document, "hand_eye") && holds(document["hand_eye"], "flange_from_camera")) {
            SEAM_TRY(auto flange,
                     uncertain_in(document["hand_eye"], "flange_from_camera", "covariance_pose"));
            found.flange_from_camera = flange;
        }
        return found;
    }
    CalibrationFinding found;
    const auto take = [&](const char* key, auto finding) -> Expected<bool> {
        if (!holds(document, key)) return false;
        SEAM_TRY(auto pose, uncertain_in(document, key, "covariance_pose"));
        found = finding(pose);
        return true;
    };
    for (const auto& taken :
         {take("flange_from_sensor", [](const UncertainPose& p) { return SensorOnFlange{p}; }),
          take("flange_from_camera", [](const UncertainPose& p) { return CameraOnFlange{p}; }),
          take("base_from_camera", [](const UncertainPose& p) { return CameraBesideRobot{p}; }),
          take("world_from_plate", [](const UncertainPose& p) { return PlateInWorld{p}; }),
          take("flange_from_nozzle", [&](const UncertainPose& p) {
              const double degrees = number_or_none(document, "degrees"),
                           off = number_or_none(document, "off_programmed_mm");
              return NozzleOnFlange{p, degrees >= 1 ? degrees : std::numeric_limits<double>::infinity(),
                                    off > 0 ? off : 0};
          })})
        if (!taken) return tl::unexpected(taken.error());
    return found;
}

}  // namespace

void finish_document(CalibrationSolution& solution) {
    json& d = solution.document;
    put_report(solution.report, d);
    if (solution.verdict() == Verdict::undetermined)
        for (json& p : d["parameters"]) p["value"] = p["sigma"] = nullptr;
    put_texts(d, "notices", solution.notices);
    put_texts(d, "degenerate", solution.degenerate);
}

void put_scale(const FieldScale& scale, CalibrationSolution& solution) {
    if (scale.scale_sigma.isZero(0) && scale.shear_sigma == 0) return;
    solution.scale = scale;
    solution.document["scale_sigma"] = {scale.scale_sigma.x(), scale.scale_sigma.y()};
    solution.document["shear_sigma"] = scale.shear_sigma;
    if (scale.shown) solution.document["scale_shown"] = true;
}

namespace {

std::optional<FieldScale> scale_in(const json& document) {
    const auto scale = document.find("scale_sigma");
    const double shear = number_or_none(document, "shear_sigma");
    if (scale == document.end() || !scale->is_array() || scale->size() != 2 || !(*scale)[0].is_number() ||
        !(*scale)[1].is_number())
        return std::nullopt;
    const FieldScale found{{(*scale)[0].get<double>(), (*scale)[1].get<double>()},
                           shear,
                           document.value("scale_shown", json()) == json(true)};
    constexpr double kMost = 0.1;
    const bool sound = found.scale_sigma.minCoeff() >= 0 && found.scale_sigma.maxCoeff() <= kMost &&
                       shear >= 0 && shear <= kMost;
    return sound ? std::optional(found) : std::nullopt;
}

}  // namespace

Expected<CalibrationSolution> solution_from_document(const json& document) {
    if (!document.is_object()) return input_error("this is no answer of a calibration", "");
    CalibrationSolution solution;
    solution.report = report_in(document);
    solution.notices = texts_in(document, "notices");
    solution.degenerate = texts_in(document, "degenerate");
    if (const auto list = document.find("proposals"); list != document.end() && list->is_array())
        for (const json& p : *list) {
            SEAM_TRY(auto pose,
                     parse_pose(p.is_object() ? p.value("base_from_flange", json()) : json(), "proposals"));
            solution.proposals.push_back({text_in(p, "words"), pose, number_or_none(p, "sigma_mm")});
        }
    SEAM_TRY(auto found, finding_in(document));
    solution.found = std::move(found);
    solution.scale = scale_in(document);
    solution.document = document;
    return solution;
}

}  // namespace seamwright
