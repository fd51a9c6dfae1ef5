#include <charconv>

#include "core/calibration/camera/lens.h"
#include "devices/exchange/json_fields.h"
#include "projects/calibrate/methods/camera_json.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {

using nlohmann::json;

Expected<CalibrateOutcome> calibrate_lens_json(const json& data, const std::vector<std::string>& exclude) {
    if (!data.is_object())
        return input_error("the data is not a JSON object", "", "see calibrate lens --help");
    auto size_field = json_field(data, "size", "");
    if (!size_field) return tl::unexpected(size_field.error());
    auto size = as_numbers(**size_field, 2, "size");
    if (!size) return tl::unexpected(size.error());
    if ((*size)[0] < 1 || (*size)[1] < 1 || (*size)[0] > 1e5 || (*size)[1] > 1e5)
        return input_error("this is no image size", "size", "give [width, height] in pixels");
    auto full = json_bool_or(data, "full", false, "");
    if (!full) return tl::unexpected(full.error());
    auto list = json_array(data, "lines", "");
    if (!list) return tl::unexpected(list.error());
    LensData lens{static_cast<int>((*size)[0]), static_cast<int>((*size)[1]), {}};
    for (std::size_t i = 0; i < (*list)->size(); ++i) {
        const std::string where = json_path("lines", i);
        if (!(**list)[i].is_array())
            return input_error("this is not a list of points", where, "write [[u,v],..]");
        lens.lines.emplace_back();
        for (std::size_t k = 0; k < (**list)[i].size(); ++k) {
            auto point = as_numbers((**list)[i][k], 2, json_path(where, k));
            if (!point) return tl::unexpected(point.error());
            lens.lines.back().emplace_back((*point)[0], (*point)[1]);
        }
    }
    LensOptions options;
    options.full = *full;
    for (const auto& e : exclude) {
        int number = -1;
        const auto parsed = std::from_chars(e.data(), e.data() + e.size(), number);
        if (parsed.ec != std::errc() || parsed.ptr != e.data() + e.size())
            return input_error(Text("'{}' is no line number", e), "exclude", "lines count from 0");
        options.exclude.push_back(number);
    }
    auto solved = calibrate_lens(lens, options);
    if (!solved) return tl::unexpected(solved.error());
    CalibrateOutcome outcome;
    json& result = outcome.result;
    const bool known = solved->report.judgement.verdict != Verdict::undetermined;
    const auto given = [&](double v) { return known ? number_json(v) : json(nullptr); };
    result["method"] = "lens";
    result["status"] = known ? "ok" : "undetermined";
    result["lens"] = known ? camera_json(solved->lens) : json(nullptr);
    result["centre_px"] =
        known ? vector_json(Eigen::Vector2d(solved->lens.cx, solved->lens.cy)) : json(nullptr);
    result["K1"] = given(solved->k1_px);
    result["K2"] = given(solved->k2_px);
    result["straightness_before_px"] = number_json(solved->straightness_before_px);
    result["straightness_after_px"] = given(solved->straightness_after_px);
    result["corner_shift_px"] = given(solved->corner_shift_px);
    result["corner_sigma_px"] = number_json(solved->corner_sigma_px);
    add_report(solved->report, result);
    if (!known)
        for (auto& p : result["parameters"]) p["value"] = p["sigma"] = nullptr;
    outcome.exit_code = exit_code_for(solved->report.judgement.verdict);
    return outcome;
}

}  // namespace seamwright
