#include "projects/panel/panel_job_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/file/project_json.h"
#include "projects/measure/fields.h"
#include "projects/station/check.h"

namespace seamwright {
namespace {

using nlohmann::json;

Expected<PanelSide> read_side(const json& spot, const std::string& key, const std::string& path) {
    SEAM_TRY(auto side, json_field(spot, key, path));
    const std::string where = json_path(path, key);
    SEAM_OK(only_fields(*side, {"reference", "measured"}, where));
    SEAM_TRY(auto reference, json_vector3(*side, "reference", where));
    SEAM_TRY(auto measured, json_vector3(*side, "measured", where));
    return PanelSide{reference, measured};
}

Expected<PanelSpot> read_spot(const json& spot, const std::string& path) {
    SEAM_OK(only_fields(
        spot, {"id", "gripper_from_sensor", "panel", "body", "weights", "sigma_mm", "surface_deg"}, path));
    PanelSpot s;
    SEAM_TRY(auto id, json_string(spot, "id", path));
    s.id = id;
    SEAM_TRY(auto pose, json_field(spot, "gripper_from_sensor", path));
    SEAM_TRY(auto parsed, parse_pose(*pose, json_path(path, "gripper_from_sensor")));
    s.gripper_from_sensor = parsed;
    SEAM_TRY(auto panel, read_side(spot, "panel", path));
    s.panel = panel;
    SEAM_TRY(auto body, read_side(spot, "body", path));
    s.body = body;
    if (spot.contains("weights")) {
        SEAM_TRY(auto weights, json_vector3(spot, "weights", path));
        s.weights = weights;
    }
    SEAM_TRY(auto sigma, json_number_or(spot, "sigma_mm", s.sigma_mm, path));
    s.sigma_mm = sigma;
    SEAM_TRY(auto surface, json_number_or(spot, "surface_deg", 0, path));
    s.surface_rad = rad_from_deg(surface);
    return s;
}

Expected<PanelMeasures> read_measures(const json& document) {
    SEAM_OK(only_fields(document, {"spots", "limits", "deviation"}, ""));
    SEAM_TRY(auto spots, json_array(document, "spots", ""));
    PanelMeasures measures;
    for (std::size_t i = 0; i < spots->size(); ++i) {
        SEAM_TRY(auto spot, read_spot((*spots)[i], json_path("spots", i)));
        measures.spots.push_back(std::move(spot));
    }
    if (document.contains("limits") && !document["limits"].is_null()) {
        const json& limits = document["limits"];
        SEAM_OK(only_fields(limits, {"translation_mm", "rotation_deg"}, "limits"));
        CorrectionLimits& to = measures.options.limits;
        SEAM_TRY(auto translation, json_number_or(limits, "translation_mm", to.translation_mm, "limits"));
        SEAM_TRY(auto rotation, json_number_or(limits, "rotation_deg", to.rotation_deg, "limits"));
        to = {translation, rotation};
    }
    if (document.contains("deviation")) {
        SEAM_TRY(auto word, json_string(document, "deviation", ""));
        SEAM_TRY(auto deviation, panel_deviation_from(word));
        measures.options.deviation = deviation;
    }
    return measures;
}

// The job in an export of a whole project.
Expected<PanelJob> exported_job(const json& project, const std::string& file) {
    const auto jobs = project.find("panel_jobs");
    if (jobs == project.end() || !jobs->is_array() || jobs->empty())
        return input_error("the exported project has no panel job", file, "choose the export of another one");
    if (jobs->size() > 1)
        return input_error("the exported project has several panel jobs", file,
                           "give the entry of one of them as a file of its own");
    return from_json_document<PanelJob>(jobs->front(), file + ": project.panel_jobs[0]");
}

}  // namespace

Expected<PanelDeviation> panel_deviation_from(const std::string& word) {
    const auto& fields = panel_fields();
    const auto& choices = std::find_if(fields.begin(), fields.end(), [](const Field<PanelJob>& f) {
                              return f.info.name == "deviation";
                          })->info.choices;
    const auto at = std::find(choices.begin(), choices.end(), word);
    if (at == choices.end())
        return usage_error(Text("\"{}\" is not one of {}", word, fmt::join(choices, ", ")), "deviation");
    return static_cast<PanelDeviation>(at - choices.begin());
}

Expected<std::variant<PanelMeasures, PanelJob>> read_panel_file(const std::filesystem::path& file) {
    SEAM_TRY(const json document, read_json_file(file));
    if (document.is_object() && document.contains("project") && document["project"].is_object()) {
        SEAM_TRY(auto job, exported_job(document["project"], file.string()));
        return job;
    }
    if (document.is_object() && document.contains("places")) {
        SEAM_TRY(auto job, from_json_document<PanelJob>(document, file.string()));
        return job;
    }
    SEAM_TRY(auto measures, read_measures(document));
    return measures;
}

Expected<PanelMeasures> read_panel_measures(const std::filesystem::path& file) {
    SEAM_TRY(auto read, read_panel_file(file));
    if (auto* measures = std::get_if<PanelMeasures>(&read)) return std::move(*measures);
    return input_error("this is a panel job without measures", file.string(),
                       "keep it in a project: seamwright panel FILE.seam --take JOB.json");
}

Expected<PanelJob> read_panel_job(const std::filesystem::path& file) {
    SEAM_TRY(auto read, read_panel_file(file));
    if (auto* job = std::get_if<PanelJob>(&read)) return std::move(*job);
    return input_error("these are measures, not a panel job for devices", file.string(),
                       "fit them by themselves: seamwright panel JOB.json");
}

Expected<Project> with_panel_job(Project project, PanelJob job) {
    if (job.id.empty()) return input_error("the panel job has no name", "", "give it an \"id\"");
    std::set<std::string> before;
    for (const Error& finding : check(project)) before.insert(finding.sentence());
    const auto at = std::find_if(project.panel_jobs.begin(), project.panel_jobs.end(),
                                 [&](const PanelJob& j) { return j.id == job.id; });
    if (at == project.panel_jobs.end())
        project.panel_jobs.push_back(std::move(job));
    else
        *at = std::move(job);
    std::vector<Error> findings = check(project);
    std::erase_if(findings, [&](const Error& finding) { return before.contains(finding.sentence()); });
    SEAM_OK(none_of_motion(findings));
    return project;
}

}  // namespace seamwright
