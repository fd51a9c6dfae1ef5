#include "projects/calibrate/input/hand_eye_data.h"

#include <algorithm>
#include <cmath>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"

namespace seamwright {

using nlohmann::json;

Expected<HandEyeData> parse_hand_eye_data(const json& data) {
    SEAM_TRY(auto mount_name, json_string(data, "mount", ""));
    const auto mount = mount_named(mount_name);
    if (!mount)
        return input_error(Text("the mount '{}' is unknown", mount_name), "mount",
                           "write eye_in_hand or eye_to_hand");
    SEAM_TRY(auto list, json_array(data, "pairs", ""));
    SEAM_TRY(const auto robot, repeatability_of(data));
    HandEyeData set{*mount, {}, robot};
    for (std::size_t i = 0; i < list->size(); ++i) {
        const json& entry = (*list)[i];
        const std::string where = json_path("pairs", i);
        HandEyePair pair;
        SEAM_TRY(auto id, entry_id(entry, i, where));
        pair.id = id;
        for (auto [key, target] : {std::pair{"base_from_flange", &pair.base_from_flange},
                                   std::pair{"camera_from_target", &pair.camera_from_target}}) {
            SEAM_TRY(auto field, json_field(entry, key, where));
            SEAM_TRY(auto pose, parse_pose(*field, json_path(where, key)));
            *target = pose;
        }
        set.pairs.push_back(std::move(pair));
    }
    return set;
}

namespace {
// Residuals below these are exact: two readings then tie.
constexpr double kExactPose_mm = 0.02, kExactPose_rad = 2e-4;
}  // namespace

// Millimetres and radians have a variance each: their geometric mean has the tails of one of 3 n - 6 degrees at most.
std::optional<ConventionFit> convention_fit(Mount mount, const std::vector<HandEyePair>& pairs,
                                            const std::vector<std::string>& exclude) {
    const auto solved = calibrate_hand_eye(mount, pairs, exclude);
    if (!solved) return std::nullopt;
    return ConventionFit{
        std::max(kExactPose_mm, solved->sigma_mm) * std::max(kExactPose_rad, rad_from_deg(solved->sigma_deg)),
        std::max(1.0, 3.0 * solved->pairs_used - 6), solved->rms_mm, solved->fits,
        solved->report.judgement.verdict};
}

}  // namespace seamwright
