#include "core/calibration/stripe/laser_plane.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/methods/camera_json.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {

using nlohmann::json;

Expected<CalibrateOutcome> calibrate_laser_plane_json(const json& data,
                                                      const std::vector<std::string>& exclude) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate laser-plane --help");
    auto camera_field = json_field(data, "camera", "");
    if (!camera_field) return tl::unexpected(camera_field.error());
    auto camera = parse_camera(**camera_field, "camera");
    if (!camera) return tl::unexpected(camera.error());
    auto list = json_array(data, "pairs", "");
    if (!list) return tl::unexpected(list.error());
    std::vector<LaserPair> pairs;
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        const json& entry = (**list)[i];
        const std::string where = json_path("pairs", i);
        LaserPair pair;
        auto id = entry_id(entry, i, where);
        if (!id) return tl::unexpected(id.error());
        auto pixel = json_vector2(entry, "pixel", where);
        if (!pixel) return tl::unexpected(pixel.error());
        auto laser = json_vector2(entry, "laser", where);
        if (!laser) return tl::unexpected(laser.error());
        pairs.push_back({*id, *pixel, *laser});
    }
    auto solved = calibrate_laser_plane(*camera, pairs, exclude);
    if (!solved) return tl::unexpected(solved.error());
    CalibrateOutcome outcome;
    json& result = outcome.result;
    const bool known = solved->report.judgement.verdict != Verdict::undetermined;
    result["method"] = "laser-plane";
    result["status"] = known ? "ok" : "undetermined";
    result["camera_from_laser"] = known ? pose_json(solved->camera_from_laser) : json(nullptr);
    result["rms_px"] = known ? number_json(solved->rms_px) : json(nullptr);
    result["sigma"] = known ? pose_sigma_json(solved->camera_from_laser, solved->covariance) : json(nullptr);
    result["covariance_pose"] = known ? matrix_json(solved->covariance) : json(nullptr);
    add_report(solved->report, result);
    outcome.exit_code = exit_code_for(solved->report.judgement.verdict);
    return outcome;
}

}  // namespace seamwright
