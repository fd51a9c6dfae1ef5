// {"size":[w,h],"lines":[[[u,v],..],..],"full"?} -> {"status","lens" (camera with f = half the
// diagonal),"centre_px","K1","K2" (px),
//     "straightness_before_px","straightness_after_px","corner_shift_px","corner_sigma_px",...}; lines are
//     excluded by number.

#include "core/calibration/lens/lens.h"

#include <charconv>

#include "devices/exchange/json_fields.h"
#include "projects/calibrate/input/entry.h"
#include "projects/calibrate/methods/example/example_cell.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/solution/camera_json.h"

namespace seamwright {
namespace {

using nlohmann::json;

Expected<CalibrationSolution> solve_lens(const json& data, const ExcludedIds& exclude) {
    SEAM_TRY(auto size, image_size_of(data, ""));
    SEAM_TRY(auto full, json_bool_or(data, "full", false, ""));
    SEAM_TRY(auto list, json_array(data, "lines", ""));
    LensData lens{size.first, size.second, {}};
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string where = json_path("lines", i);
        if (!(*list)[i].is_array())
            return input_error("this is not a list of points", where, "write [[u,v],..]");
        lens.lines.emplace_back();
        for (std::size_t k = 0; k < (*list)[i].size(); ++k) {
            SEAM_TRY(auto point, as_numbers((*list)[i][k], 2, json_path(where, k)));
            lens.lines.back().emplace_back(point[0], point[1]);
        }
    }
    LensOptions options;
    options.full = full;
    for (const auto& e : exclude) {
        int number = -1;
        const auto parsed = std::from_chars(e.data(), e.data() + e.size(), number);
        if (parsed.ec != std::errc() || parsed.ptr != e.data() + e.size())
            return input_error(Text("'{}' is no line number", e), "exclude", "lines count from 0");
        options.exclude.push_back(number);
    }
    SEAM_TRY(auto solved, calibrate_lens(lens, options));
    CalibrationSolution solution;
    json& result = solution.document;
    const bool known = solved.report.judgement.verdict != Verdict::undetermined;
    const auto given = [&](double v) { return known ? number_json(v) : json(nullptr); };
    result["status"] = known ? "ok" : "undetermined";
    result["lens"] = known ? camera_json(solved.lens) : json(nullptr);
    result["centre_px"] =
        known ? vector_json(Eigen::Vector2d(solved.lens.cx, solved.lens.cy)) : json(nullptr);
    result["K1"] = given(solved.k1_px);
    result["K2"] = given(solved.k2_px);
    result["straightness_before_px"] = number_json(solved.straightness_before_px);
    result["straightness_after_px"] = given(solved.straightness_after_px);
    result["point_noise_px"] = given(solved.point_noise_px);
    result["corner_shift_px"] = given(solved.corner_shift_px);
    result["corner_sigma_px"] = number_json(solved.corner_sigma_px);
    solution.report = std::move(solved.report);
    finish_document(solution);
    return solution;
}

json lens_example() {
    example::Dither dither;
    const CameraModel camera = example::camera();
    json lines = json::array();
    for (int n = 0; n < 12; ++n) {
        const double turn = n % 2 == 0 ? 0.08 * (n - 5) : kPi / 2 + 0.08 * (n - 6);
        const double offset = (n - 5.5) * 0.055;
        json line = json::array();
        for (int i = -30; i <= 30; ++i) {
            const Eigen::Vector3d p(offset * -std::sin(turn) + 0.014 * i * std::cos(turn),
                                    offset * std::cos(turn) + 0.014 * i * std::sin(turn), 1);
            const Eigen::Vector2d pixel = camera.project(p);
            if (!(pixel.x() > 0 && pixel.y() > 0 && pixel.x() < example::kWidth &&
                  pixel.y() < example::kHeight))
                continue;
            line.push_back(example::pair_json(pixel.x() + dither(example::kPixelNoise),
                                              pixel.y() + dither(example::kPixelNoise)));
        }
        lines.push_back(std::move(line));
    }
    return {{"size", {example::kWidth, example::kHeight}}, {"lines", lines}};
}

}  // namespace

CalibrationMethod lens_method() {
    CalibrationMethod m;
    m.id = "lens";
    m.help = "Distortion from straight laser lines on a plane";
    m.usage = "lines.json";
    m.layout = R"({"size":[W,H],"lines":[[[u,v],..],..],"full":false?}   px)";
    m.fields = {{"", {"size", "lines", "full"}}};
    m.example = lens_example;
    m.solve = solve_lens;
    m.entries = "lines";
    m.capture = CaptureKind::stripe_line;
    m.use = AnswerUse::record;
    m.fewest = 3;
    m.advised = 10;
    m.title = "Lens";
    m.why = "Checks the lens: straight laser lines on a plate must become straight.";
    m.need = {"A flat plate that fills the view.",
              "10 or more heights and tilts, so that the lines cross the picture everywhere."};
    m.file = "JSON with lines of pixels";
    m.drawing = SetUpDrawing::plane;
    return m;
}

}  // namespace seamwright
