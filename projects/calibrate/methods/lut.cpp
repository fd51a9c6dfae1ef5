#include "core/calibration/table/lookup_table_calibration.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/lookup_table_file.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {

using nlohmann::json;

Expected<CalibrateOutcome> calibrate_lut_json(const json& data, const std::vector<std::string>& exclude,
                                              const std::string& table_path) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate lut --help");
    auto size_field = json_field(data, "size", "");
    if (!size_field) return tl::unexpected(size_field.error());
    auto size = as_numbers(**size_field, 2, "size");
    if (!size) return tl::unexpected(size.error());
    if (!((*size)[0] >= 1 && (*size)[1] >= 1 && (*size)[0] <= 1e5 && (*size)[1] <= 1e5))
        return input_error("this is no image size", "size", "give [width, height] in pixels");
    LookupTableOptions options;
    options.exclude = exclude;
    if (data.contains("step_px")) {
        auto step = json_number(data, "step_px", "");
        if (!step) return tl::unexpected(step.error());
        if (!(*step > 0)) return input_error("the step is not above 0", "step_px", "give e.g. 8");
        options.step_px = *step;
    }
    auto list = json_array(data, "pairs", "");
    if (!list) return tl::unexpected(list.error());
    std::vector<LaserPair> pairs;
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        const json& entry = (**list)[i];
        const std::string where = json_path("pairs", i);
        auto id = entry_id(entry, i, where);
        if (!id) return tl::unexpected(id.error());
        auto pixel = json_vector2(entry, "pixel", where);
        if (!pixel) return tl::unexpected(pixel.error());
        auto laser = json_vector2(entry, "laser", where);
        if (!laser) return tl::unexpected(laser.error());
        pairs.push_back({*id, *pixel, *laser});
    }
    auto solved =
        calibrate_lookup_table(static_cast<int>((*size)[0]), static_cast<int>((*size)[1]), pairs, options);
    if (!solved) return tl::unexpected(solved.error());
    CalibrateOutcome outcome;
    json& result = outcome.result;
    const bool known = solved->report.judgement.verdict != Verdict::undetermined;
    const auto given = [&](double v) { return known ? number_json(v) : json(nullptr); };
    result["method"] = "lut";
    result["status"] = known ? "ok" : "undetermined";
    const LookupTable& t = solved->table;
    result["table"] =
        known ? json{{"u0", t.u0},           {"v0", t.v0},     {"step_u", t.step_u},    {"step_v", t.step_v},
                     {"columns", t.columns}, {"rows", t.rows}, {"holes", solved->holes}}
              : json(nullptr);
    result["covered_share"] = given(solved->covered_share);
    result["forward_rms_mm"] = given(solved->forward_rms_mm);
    result["forward_max_mm"] = given(solved->forward_max_mm);
    result["backward_rms_px"] = given(solved->backward_rms_px);
    result["backward_max_px"] = given(solved->backward_max_px);
    result["unsupported_pairs"] = known ? json(solved->unsupported_pairs) : json(nullptr);
    result["noise_px"] = given(solved->noise_px);
    result["noise_mm"] = given(solved->noise_mm);
    result["interpolation_mm"] = given(solved->interpolation_mm);
    result["sigma"] = known ? json{{"rms_mm", number_json(solved->map_sigma_mm)},
                                   {"worst_mm", number_json(solved->map_sigma_worst_mm)}}
                            : json(nullptr);
    json wrong = json::array();
    for (std::size_t i = 0; known && i < pairs.size(); ++i) {
        const auto& pose = solved->report.poses[i];
        if (!pose.used && pose.note != "excluded") wrong.push_back(pose.id);
    }
    result["wrong_pairs"] = std::move(wrong);
    add_report(solved->report, result);
    result["table_file"] = nullptr;
    outcome.exit_code = exit_code_for(solved->report.judgement.verdict);
    // A poor table must not be taken for a good one because its file is there.
    if (!table_path.empty() && outcome.exit_code == 0) {
        if (auto ok = write_lookup_table(table_path, t); !ok) return tl::unexpected(ok.error());
        result["table_file"] = table_path;
    }
    return outcome;
}

}  // namespace seamwright
