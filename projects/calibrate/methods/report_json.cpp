#include <cmath>

#include "core/geometry/notation.h"
#include "devices/exchange/json_fields.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/file/stored_text.h"

namespace seamwright {

using nlohmann::json;

int exit_code_for(Verdict verdict) {
    return serves(verdict) ? 0 : 1;
}

Verdict verdict_of(const json& result) {
    const auto word = result.find("verdict");
    if (word == result.end() || !word->is_string()) return Verdict::undetermined;
    return verdict_from(word->get<std::string>()).value_or(Verdict::undetermined);
}

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

void add_report(const CalibrationReport& report, json& result) {
    result["verdict"] = std::string(name_of(report.judgement.verdict));
    put_text(result, "reason", report.judgement.reason);
    put_text(result, "cure", report.judgement.cure);
    json parameters = json::array();
    for (const auto& p : report.parameters)
        parameters.push_back({{"name", p.name},
                              {"value", number_json(p.value)},
                              {"unit", p.unit},
                              {"sigma", number_json(p.sigma)}});
    result["parameters"] = std::move(parameters);
    result["covariance"] = matrix_json(report.covariance);
    json correlations = json::array();
    for (const auto& c : report.correlations)
        correlations.push_back(
            {{"first", c.first}, {"second", c.second}, {"correlation", number_json(c.correlation)}});
    result["correlations"] = std::move(correlations);
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
    result["per_pose"] = std::move(poses);
    const auto& h = report.hold_out;
    result["hold_out"] = {{"folds", h.folds},
                          {"left_out", h.left_out},
                          {"rms_mm", number_json(h.rms_mm)},
                          {"max_mm", number_json(h.max_mm)},
                          {"rms_deg", number_json(h.rms_deg)},
                          {"rms_px", number_json(h.rms_px)}};
}

json pose_sigma_json(const Pose& pose, const Matrix6& covariance) {
    const Eigen::Matrix3d jacobian = kuka_jacobian(pose.linear());
    const Eigen::Matrix3d angles = jacobian * covariance.bottomRightCorner<3, 3>() * jacobian.transpose();
    const Eigen::Vector3d xyz = covariance.topLeftCorner<3, 3>().diagonal().cwiseMax(0).cwiseSqrt();
    const Eigen::Vector3d abc = angles.diagonal().cwiseMax(0).cwiseSqrt() * (180 / kPi);
    return {{"xyz_mm", vector_json(xyz)}, {"abc_deg", vector_json(abc)}};
}

Expected<std::string> entry_id(const json& entry, std::size_t index, const std::string& where) {
    if (!entry.is_object()) return input_error("this is not an object", where);
    const auto it = entry.find("id");
    if (it == entry.end()) return std::to_string(index);
    if (it->is_string()) return it->get<std::string>();
    if (it->is_number()) return it->dump();
    return input_error("the id is neither text nor number", json_path(where, "id"));
}

}  // namespace seamwright
