#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/pose_lists.h"
#include "projects/calibrate/methods/hand_eye_json.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/file/stored_text.h"

namespace seamwright {

using nlohmann::json;

Expected<HandEyeData> parse_hand_eye_data(const json& data) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate hand-eye --help");
    auto mount_name = json_string(data, "mount", "");
    if (!mount_name) return tl::unexpected(mount_name.error());
    const auto mount = mount_named(*mount_name);
    if (!mount)
        return input_error(Text("the mount '{}' is unknown", *mount_name), "mount",
                           "write eye_in_hand or eye_to_hand");
    auto list = json_array(data, "pairs", "");
    if (!list) return tl::unexpected(list.error());
    HandEyeData set{*mount, {}};
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        const json& entry = (**list)[i];
        const std::string where = json_path("pairs", i);
        HandEyePair pair;
        auto id = entry_id(entry, i, where);
        if (!id) return tl::unexpected(id.error());
        pair.id = *id;
        for (auto [key, target] : {std::pair{"base_from_flange", &pair.base_from_flange},
                                   std::pair{"camera_from_target", &pair.camera_from_target}}) {
            auto field = json_field(entry, key, where);
            if (!field) return tl::unexpected(field.error());
            auto pose = parse_pose(**field, json_path(where, key));
            if (!pose) return tl::unexpected(pose.error());
            *target = *pose;
        }
        set.pairs.push_back(std::move(pair));
    }
    return set;
}

Expected<CalibrateOutcome> calibrate_hand_eye_json(const json& data,
                                                   const std::vector<std::string>& exclude) {
    auto meant = with_usual_poses("hand-eye", data);
    if (!meant) return tl::unexpected(meant.error());
    auto set = parse_hand_eye_data(meant->data());
    if (!set) return tl::unexpected(set.error());
    auto solved = calibrate_hand_eye(set->mount, set->pairs, exclude);
    if (!solved) return tl::unexpected(solved.error());

    CalibrateOutcome outcome;
    json& result = outcome.result;
    const bool ok = solved->status == HandEyeStatus::ok;
    const bool in_hand = set->mount == Mount::eye_in_hand;
    result["method"] = "hand-eye";
    result["mount"] = std::string(name_of(set->mount));
    result["status"] = std::string(name_of(solved->status));
    result[in_hand ? "flange_from_camera" : "base_from_camera"] = ok ? pose_json(solved->x) : json(nullptr);
    result[in_hand ? "base_from_target" : "flange_from_target"] = ok ? pose_json(solved->y) : json(nullptr);
    result["rms_mm"] = ok ? number_json(solved->rms_mm) : json(nullptr);
    result["rms_deg"] = ok ? number_json(solved->rms_deg) : json(nullptr);
    result["sigma"] = ok ? pose_sigma_json(solved->x, solved->covariance_x) : json(nullptr);
    if (ok) {
        result["covariance_pose"] = matrix_json(solved->covariance_x);
        result["noise"] = {{"sigma_mm", solved->sigma_mm}, {"sigma_deg", solved->sigma_deg}};
    }
    result["start"] = solved->start;
    put_texts(result, "degenerate", solved->degenerate);
    put_texts(result, "notices", solved->notices);
    add_report(solved->report, result);
    meant->put(result);
    outcome.exit_code = exit_code_for(solved->report.judgement.verdict);
    return outcome;
}

}  // namespace seamwright
