#include "projects/calibrate/detect_convention.h"

#include "projects/file/stored_text.h"

namespace seamwright {
namespace {

using nlohmann::json;
json reading_json(const PoseReading& reading, const std::vector<WrittenPoses>& lists) {
    json conventions = json::object();
    for (std::size_t l = 0; l < lists.size(); ++l)
        conventions[lists[l].name] = code_of(reading.conventions[l]);
    json one{{"conventions", conventions}, {"residual_mm", nullptr}, {"verdict", nullptr}};
    put_text(one, "words", words_of(reading, lists));
    if (reading.fit) {
        one["residual_mm"] = number_json(reading.fit->residual_mm);
        one["verdict"] = std::string(name_of(reading.fit->verdict));
    }
    return one;
}

}  // namespace

Expected<ConventionAnswer> detect_pose_convention(const CalibrationMethod& method, const json& data,
                                                  const ExcludedIds& exclude) {
    const Text where("calibrate {}", method.id);
    if (!method.convention_fits)
        return usage_error("its data leave no residual that a convention of poses shows in", where,
                           "ask of tcp-sphere, hand-eye or stripe-camera data of the same robot");
    SEAM_OK(check_fields(method, data));
    SEAM_TRY(const auto lists, written_poses(method.poses, data));
    if (lists.empty()) return input_error("there are no poses", where, "leave --detect-convention out");
    SEAM_TRY(const auto fits, method.convention_fits(data, exclude));
    ConventionAnswer answer;
    answer.found = detect_convention(lists, fits.fit, fits.screen);
    const DetectedConvention& found = answer.found;
    const auto optional = [&](const std::optional<PoseReading>& reading) {
        return reading ? reading_json(*reading, lists) : json(nullptr);
    };
    json& r = answer.result;
    r = {{"verdict", std::string(name_of(found.finding))},
         {"tried", found.tried},
         {"as_given", reading_json(found.as_given, lists)},
         {"best", optional(found.best)},
         {"second", optional(found.second)},
         {"equal_poses", found.equal_poses},
         {"ratio", found.second ? number_json(found.ratio) : json(nullptr)},
         {"limit", found.limit > 0 ? number_json(found.limit) : json(nullptr)},
         {"offer", nullptr}};
    put_text(r, "sentence", found.sentence);
    if (found.finding == ConventionFinding::named) {
        answer.offer = json::object();
        if (const auto said = data.find("pose_convention"); said != data.end() && said->is_object())
            answer.offer = *said;
        for (std::size_t l = 0; l < lists.size(); ++l) {
            if (found.best->conventions[l] == lists[l].as_given) continue;
            const std::string code = code_of(found.best->conventions[l]);
            answer.offer[lists[l].name] = code;
            answer.codes.push_back(lists[l].name + "=" + code);
        }
        r["offer"] = answer.offer;
    }
    return answer;
}

}  // namespace seamwright
