#include "app/cli/arguments/calibration_argument.h"

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/lookup_table_file.h"
#include "projects/calibrate/session/answer.h"
#include "projects/file/project_file.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

Calibration named_after(const std::string& path, Calibration made) {
    made.id = fs::path(path).stem().string();
    made.source = path;
    made.created_utc = utc_now();
    return made;
}

// A table says where pixels lie in the sensor's plane, and not how well; its verdict is that of the one who brings it.
Expected<Calibration> table_calibration(const std::string& path) {
    SEAM_TRY(auto table, read_lookup_table(path));
    Calibration c;
    c.method = "lut";
    c.verdict = Verdict::usable;
    c.model.emplace().table = std::move(table);
    return named_after(path, std::move(c));
}

}  // namespace

Expected<Calibration> read_calibration(const std::string& path, const std::string& id,
                                       const Calibration* base) {
    if (path.ends_with(".lut")) return table_calibration(path);
    if (path.ends_with(".json")) {
        SEAM_TRY(auto answer, read_json_file(path));
        const auto named = answer.find("method");
        const CalibrationMethod* method =
            named != answer.end() && named->is_string() ? find_method(named->get<std::string>()) : nullptr;
        auto solution = solution_from_document(answer);
        const bool turns = solution && (std::holds_alternative<CameraAndLaser>(solution->found) ||
                                        std::holds_alternative<SensorOnFlange>(solution->found));
        if (!method || !solution || (!turns && solution->verdict() != Verdict::undetermined))
            return input_error("is no answer of calibrate stripe-camera or tcp-sphere", path,
                               "give that, or a project that holds the calibration");
        auto made = calibration_of_solution(*method, json::object(), {}, *solution, base);
        if (!made) return made;
        return named_after(path, std::move(*made));
    }
    SEAM_TRY(auto file, ProjectFile::open(path, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    std::string there;
    std::vector<const Calibration*> fit;
    for (const Calibration& c : project.calibrations) {
        there += (there.empty() ? "" : ", ") + c.id;
        if (id.empty() ? c.method != "pixels" : c.id == id) fit.push_back(&c);
    }
    if (fit.size() == 1) return *fit.front();
    if (there.empty()) return input_error("the project holds no calibration", path);
    return input_error(id.empty()
                           ? fmt::format("the project holds {} calibrations that could be meant", fit.size())
                           : fmt::format("the project has no calibration \"{}\"", id),
                       path, Text("say which with --calibration-id: {}", there));
}

}  // namespace seamwright::cli
