#include "projects/reuse/exchange.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "devices/exchange/files.h"
#include "devices/exchange/image_file.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/point_table.h"
#include "devices/exchange/tables/profile_csv.h"
#include "projects/file/project_json.h"
#include "projects/measure/measure.h"
#include "projects/panel/panel_measure.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "seamwright-project";
constexpr int kVersion = 1;

// A spot's id as a file name that every system takes, unique within `taken`.
std::string file_stem(const std::string& id, std::set<std::string>& taken) {
    std::string stem;
    for (const char c : id) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           c == '-' || c == '_';
        stem += plain ? c : '_';
    }
    if (stem.empty()) stem = "spot";
    stem.resize(std::min<std::size_t>(stem.size(), 100));  // a file's name holds 255 bytes
    std::string unique = stem;
    for (int i = 2; !taken.insert(unique).second; ++i) unique = fmt::format("{}_{}", stem, i);
    return unique;
}

std::string ply_text(const std::vector<Eigen::Vector3d>& points) {
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\ncomment {}\nelement vertex {}\nproperty double x\nproperty double y\n"
        "property double z\nend_header\n",
        kInBaseMark, points.size());
    for (const auto& p : points) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    return text;
}

std::string pcd_text(const std::vector<Eigen::Vector3d>& points) {
    std::string text = fmt::format(
        "# .PCD v0.7 - {1}\nVERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\n"
        "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA ascii\n",
        points.size(), kInBaseMark);
    for (const auto& p : points) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
    return text;
}

}  // namespace

nlohmann::json export_project(const Project& project, bool with_profiles) {
    return {{"format", kFormat},
            {"version", kVersion},
            {"project", to_json_document(project, {.profiles = with_profiles, .rigid_poses = true})}};
}

Expected<nlohmann::json> export_file(const ProjectFile& file, bool with_profiles) {
    SEAM_TRY(auto project, file.load());
    nlohmann::json document = export_project(project, with_profiles);
    SEAM_TRY(auto runs, file.runs());
    nlohmann::json list = nlohmann::json::array();
    for (const RunSummary& summary : runs) {
        SEAM_TRY(auto run, file.load_run(summary.number, false));
        nlohmann::json spots = nlohmann::json::array(), regions = nlohmann::json::array();
        for (const SpotMeasurement& m : run.spots)
            spots.push_back(
                to_json_document(m, {.profiles = false, .rigid_poses = false, .patterns = false}));
        for (const RegionRecord& r : run.regions)
            regions.push_back(
                to_json_document(r, {.profiles = false, .rigid_poses = false, .patterns = false}));
        list.push_back({{"number", run.number},
                        {"part_id", run.part_id},
                        {"started_utc", run.started_utc},
                        {"finished_utc", run.finished_utc},
                        {"push", run.push},
                        {"status", to_string(run.status)},
                        {"message", run.message.english()},
                        {"captures", summary.captures},
                        {"spots", spots},
                        {"regions", regions}});
        if (run.panel)
            list.back()["panel"] =
                to_json_document(*run.panel, {.profiles = false, .rigid_poses = false, .patterns = false});
    }
    document["runs"] = std::move(list);
    SEAM_TRY(auto events, file.events());
    nlohmann::json log = nlohmann::json::array();
    for (const EventRecord& e : events)
        log.push_back({{"id", e.id},
                       {"utc", e.utc},
                       {"run", e.run},
                       {"kind", to_string(e.kind)},
                       {"subject", e.subject},
                       {"text", e.text}});
    document["events"] = std::move(log);
    return document;
}

Expected<Project> import_project(const nlohmann::json& document, const std::string& where) {
    if (!document.is_object())
        return input_error("this is no exported project", where, "give what `seamwright export` wrote");
    const auto format = document.find("format"), version = document.find("version"),
               project = document.find("project");
    if (format == document.end() || *format != kFormat || project == document.end())
        return input_error("this is no exported project", where, "give what `seamwright export` wrote");
    if (version == document.end() || !version->is_number_integer() || *version < 1)
        return input_error("the export has no version", where);
    if (*version > kVersion)
        return input_error(Text("the export is newer than this program (version {})", version->dump()), where,
                           "import it with a newer Seamwright");
    return from_json_document<Project>(*project, where.empty() ? "project" : where + ": project");
}

Expected<std::vector<fs::path>> export_profiles(const ProjectFile& file, std::int64_t run_number,
                                                ProfileFormat format, const fs::path& folder) {
    SEAM_TRY(auto run, file.load_run(run_number));
    SEAM_TRY(auto setup, file.load_run_setup(run_number));
    std::error_code code;
    fs::create_directories(folder, code);
    if (!fs::is_directory(folder, code))
        return file_error("the folder cannot be made", folder.string(), "check its name and permissions");
    std::vector<fs::path> files;
    std::set<std::string> taken;
    const auto write = [&](const fs::path& path, const std::string& text) -> Expected<void> {
        auto done = write_text_file(path, text);
        if (done) files.push_back(path);
        return done;
    };
    const auto put = [&](const std::string& id, const Profile& profile, const Pose& base_from_flange,
                         const Calibration* calibration) -> Expected<void> {
        if (profile.size() == 0) return {};
        const fs::path stem = folder / file_stem(id, taken);
        if (format == ProfileFormat::csv) {
            SEAM_OK(write(fs::path(stem) += ".csv", profile_csv(profile)));
            return write(fs::path(stem) += ".json", pose_json(base_from_flange).dump(1) + "\n");
        }
        const Pose base_from_sensor =
            base_from_flange * (calibration ? calibration->flange_from_sensor : Pose::Identity());
        std::vector<Eigen::Vector3d> points;
        for (std::size_t i = 0; i < profile.size(); ++i)
            if (std::isfinite(profile.x_mm[i]) && std::isfinite(profile.z_mm[i]) &&
                profile.segment[i] != kOutlier)
                points.push_back(base_from_sensor * Eigen::Vector3d(profile.x_mm[i], 0, profile.z_mm[i]));
        const bool ply = format == ProfileFormat::ply;
        return write(fs::path(stem) += (ply ? ".ply" : ".pcd"), ply ? ply_text(points) : pcd_text(points));
    };
    const auto capture_of = [&](int at) {
        return at >= 0 && static_cast<std::size_t>(at) < run.captures.size()
                   ? &run.captures[static_cast<std::size_t>(at)]
                   : nullptr;
    };
    for (const SpotMeasurement& m : run.spots) {
        const Capture* capture = capture_of(m.capture);
        if (!capture) continue;
        SEAM_TRY(auto measurer, SpotMeasurer::make(setup, m.spot_id));
        measurer.measure(*capture);
        SEAM_OK(put(m.spot_id, measurer.profile(),
                    capture->base_from_flange.value_or(measurer.spot().base_from_flange),
                    calibration_of(setup, measurer.spot())));
    }
    const PanelJob* job = run.panel ? find_panel_job(setup, run.panel->job_id) : nullptr;
    for (const bool before : {true, false}) {
        if (!job) break;
        for (const PanelMeasurement& m : before ? run.panel->before : run.panel->after) {
            const auto place = std::find_if(job->places.begin(), job->places.end(),
                                            [&](const PanelPlace& p) { return p.id == m.place_id; });
            const Capture* first = capture_of(m.capture);
            if (!first || place == job->places.end()) continue;
            SEAM_TRY(auto measurer, PanelMeasurer::make(setup, *job, *place));
            measurer.measure(*first, capture_of(m.second_capture));
            const Pose& stood = before ? run.panel->base_from_gripper : run.panel->base_from_moved_gripper;
            for (int head = 0; head < measurer.heads(); ++head) {
                const std::string& sensor = head == 0 ? place->sensor_id : place->second_sensor_id;
                SEAM_OK(put(fmt::format("{}_{}", sensor, before ? "before" : "after"),
                            measurer.head_profile(head), first->base_from_flange.value_or(stood),
                            calibration_of(setup, sensor)));
            }
        }
    }
    return files;
}

}  // namespace seamwright
