// {"size":[w,h],"step_px"?,"pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]}],"robot":{"sigma_mm","sigma_deg"?,"lever_mm"?}?} ->
// {"status","table":{"u0","v0","step_u","step_v","columns","rows","holes"},"covered_share","forward_rms_mm",
//     "forward_max_mm","backward_rms_px","backward_max_px","unsupported_pairs","noise_px","noise_mm",
//     "interpolation_mm","sigma":{"rms_mm","worst_mm"},"wrong_pairs":[id,..],"table_file",...}
// "table_file": where the command line wrote the table (devices/exchange/lookup_table_file.h), else null.

#include "core/calibration/table/lookup_table_calibration.h"
#include "devices/exchange/json_fields.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/input/laser_pairs.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"

namespace seamwright {
namespace {

using nlohmann::json;

Expected<CalibrationSolution> solve_lut(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto size, image_size_of(data, ""));
    LookupTableOptions options;
    options.exclude = exclude;
    if (data.contains("step_px")) {
        SEAM_TRY(auto step, json_number(data, "step_px", ""));
        if (!(step > 0)) return input_error("the step is not above 0", "step_px", "give e.g. 8");
        options.step_px = step;
    }
    SEAM_TRY(auto pairs, parse_laser_pairs(data));
    SEAM_TRY(options.place_sigma_mm, place_sigma_of(data));
    SEAM_TRY(auto solved, calibrate_lookup_table(size.first, size.second, pairs, options));

    CalibrationSolution solution;
    json& result = solution.document;
    const bool known = solved.report.judgement.verdict != Verdict::undetermined;
    const auto given = [&](double v) { return known ? number_json(v) : json(nullptr); };
    result["status"] = known ? "ok" : "undetermined";
    const LookupTable& t = solved.table;
    result["table"] =
        known ? json{{"u0", t.u0},           {"v0", t.v0},     {"step_u", t.step_u},   {"step_v", t.step_v},
                     {"columns", t.columns}, {"rows", t.rows}, {"holes", solved.holes}}
              : json(nullptr);
    result["covered_share"] = given(solved.covered_share);
    result["forward_rms_mm"] = given(solved.forward_rms_mm);
    result["forward_max_mm"] = given(solved.forward_max_mm);
    result["backward_rms_px"] = given(solved.backward_rms_px);
    result["backward_max_px"] = given(solved.backward_max_px);
    result["unsupported_pairs"] = known ? json(solved.unsupported_pairs) : json(nullptr);
    result["noise_px"] = given(solved.noise_px);
    result["noise_mm"] = given(solved.noise_mm);
    result["interpolation_mm"] = given(solved.interpolation_mm);
    result["sigma"] = known ? json{{"rms_mm", number_json(solved.map_sigma_mm)},
                                   {"worst_mm", number_json(solved.map_sigma_worst_mm)}}
                            : json(nullptr);
    json wrong = json::array();
    for (std::size_t i = 0; known && i < pairs.size(); ++i) {
        const auto& pose = solved.report.poses[i];
        if (!pose.used && pose.note != "excluded") wrong.push_back(pose.id);
    }
    result["wrong_pairs"] = std::move(wrong);
    result["table_file"] = nullptr;
    if (known) {
        solution.found = PixelTable{std::move(solved.table)};
        std::vector<Eigen::Vector2d> places;  // x and z of each in turn
        const auto& parameters = solved.report.parameters;
        for (std::size_t i = 0; i + 1 < parameters.size(); i += 2)
            places.emplace_back(parameters[i].value, parameters[i + 1].value);
        put_scale(field_scale(places, solved.report.covariance), solution);
    }
    solution.report = std::move(solved.report);
    finish_document(solution);
    return solution;
}

Expected<json> prepare_lut(json settings, const Calibration* base, const std::vector<Calibration>&) {
    return base ? with_lever(std::move(settings), base->flange_from_sensor) : settings;
}

json lut_example() {
    return {{"size", {example::kWidth, example::kHeight}}, {"pairs", example::laser_pairs()}};
}

}  // namespace

CalibrationMethod lut_method() {
    CalibrationMethod m;
    m.id = "lut";
    m.help = "Look-up table pixel to millimetre from known target positions";
    m.usage = "pairs.json --table table.lut";
    m.layout = R"({"size":[W,H],"step_px"?,"pairs":[{"id"?,"pixel":[u,v],"laser":[x,z]},..],
   "robot":{"sigma_mm","sigma_deg"?,"lever_mm"?}?}   px, mm)";
    m.fields = {{"", {"size", "step_px", "pairs", "robot"}, {"anchor"}},
                {"pairs[]", {"id", "pixel", "laser"}, {"flanks"}},
                {"robot", {"sigma_mm", "sigma_deg", "lever_mm"}}};
    m.example = lut_example;
    m.table = m.repeatability = true;
    m.prepare = prepare_lut;
    m.solve = solve_lut;
    m.entries = "pairs";
    m.capture = CaptureKind::apex;
    m.fewest = 9;
    m.advised = 25;
    m.title = "Look-up table";
    m.why = "Maps pixels to millimetres directly, from a target at known places.";
    m.need = {
        "A triangular body square to the sensor, and the robot that shifts the sensor along its own X "
        "and Z alone; or pairs measured on a stage, from a file.",
        "25 or more places over the whole field; what lies outside is not measured later."};
    m.file = "JSON with pairs of pixel and known place";
    m.drawing = SetUpDrawing::dotted_plane;
    return m;
}

}  // namespace seamwright
