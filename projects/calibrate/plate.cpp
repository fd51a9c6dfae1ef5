#include "core/calibration/plate.h"

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods.h"

namespace seamwright {

using nlohmann::json;

Expected<CalibrateOutcome> calibrate_plate_json(const json& data, const std::vector<std::string>& exclude) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate plate --help");
    PlateOptions options;
    options.exclude = exclude;
    if (data.contains("sigma_mm") && !data["sigma_mm"].is_null()) {
        auto sigma = json_number(data, "sigma_mm", "");
        if (!sigma) return tl::unexpected(sigma.error());
        options.sigma_mm = *sigma;
    }
    auto list = json_array(data, "points", "");
    if (!list) return tl::unexpected(list.error());
    std::vector<PlatePoint> points;
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        const json& entry = (**list)[i];
        const std::string where = json_path("points", i);
        auto id = entry_id(entry, i, where);
        if (!id) return tl::unexpected(id.error());
        auto plate = json_vector3(entry, "plate", where);
        if (!plate) return tl::unexpected(plate.error());
        auto world = json_vector3(entry, "world", where);
        if (!world) return tl::unexpected(world.error());
        points.push_back({*id, *plate, *world});
    }
    auto solved = calibrate_plate(points, options);
    if (!solved) return tl::unexpected(solved.error());

    CalibrateOutcome outcome;
    json& result = outcome.result;
    const bool ok = solved->status == PlateStatus::ok;
    result["method"] = "plate";
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
    result["notices"] = solved->notices;
    add_report(solved->report, result);
    outcome.exit_code = exit_code_for(solved->report.judgement.verdict);
    return outcome;
}

}  // namespace seamwright
