// seamwright calibrate METHOD DATA: every calibration, from files.

#include <fmt/format.h>

#include <filesystem>
#include <functional>

#include "app/cli/command.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "projects/calibrate/detect_convention.h"
#include "projects/calibrate/example.h"
#include "projects/calibrate/input/pose_lists.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/methods/stripe_frames.h"
#include "projects/calibrate/report_page.h"
#include "projects/calibrate/session/answer.h"
#include "projects/file/project_file.h"
#include "projects/file/stored_text.h"
#include "projects/model/run.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;
using Exclude = std::vector<std::string>;

struct CalibrateArguments {
    std::string data, board, pattern = "chessboard", report, project, sensor, table, example;
    double pitch_mm = 0;
    Exclude exclude;
    bool detect_convention = false;
    std::vector<std::string> pose_convention;  // "CODE" or "LIST=CODE"
};

using FromJson = Expected<CalibrateOutcome> (*)(const json&, const Exclude&);

struct Method {
    const char* name;
    const char* help;
    FromJson from_json;
    bool images;  // DATA may be a folder of images
    const char* example;
};

const Method kMethods[] = {
    {"lens", "Distortion from straight laser lines on a plane", calibrate_lens_json, false, "lines.json"},
    {"camera", "Intrinsics from views of a plate", calibrate_camera_json, true,
     "images --board 9x6 --pitch-mm 25"},
    {"laser-plane", "Laser plane in the camera from a triangular body's apexes", calibrate_laser_plane_json,
     false, "pairs.json"},
    {"lut", "Look-up table pixel to millimetre from known target positions",
     [](const json& data, const Exclude& exclude) { return calibrate_lut_json(data, exclude); }, false,
     "pairs.json --table table.lut"},
    {"tcp-sphere", "Sensor on the flange from profiles of one sphere", calibrate_tcp_sphere_json, false,
     "sphere.json --exclude P3"},
    {"plate", "Plate in the world from two point sets", calibrate_plate_json, false, "points.json"},
    {"static", "One-shot chain world - plate - camera - laser for several sensors", calibrate_static_json,
     false, "chain.json"},
    {"hand-eye", "Camera on the flange, or beside the robot", calibrate_hand_eye_json, false, "pairs.json"},
    {"stripe-camera", "Intrinsics, laser plane and hand-eye from images of a board and the stripe",
     calibrate_stripe_camera_json, true, "images --board 7x6 --pitch-mm 10 --report report.html"},
    {"drift", "Does a stored calibration still hold", check_drift_json, false, "measured.json"},
};

Expected<void> say_conventions(const Method& method, const CalibrateArguments& a, json& data) {
    for (const std::string& said : a.pose_convention)
        if (auto ok = say_convention(method.name, said, data); !ok) return ok;
    return {};
}

// Leaves in `exclude` what is to be left out of `data`.
Expected<CalibrateOutcome> solve(const Method& method, const CalibrateArguments& a, json& data,
                                 Exclude& exclude) {
    const bool stripe = method.from_json == calibrate_stripe_camera_json;
    if (method.images && (std::filesystem::is_directory(a.data) || (stripe && !a.data.ends_with(".json")))) {
        if (a.board.empty() || !(a.pitch_mm > 0))
            return usage_error("images of a plate need --board COLUMNSxROWS and --pitch-mm",
                               Text("calibrate {}", method.name));
        if (stripe && (a.detect_convention || !a.pose_convention.empty())) {
            auto frames = stripe_folder_data(a.data, a.board, a.pitch_mm, a.exclude);
            if (!frames) return tl::unexpected(frames.error());
            data = std::move(*frames);
            exclude.clear();
            if (auto ok = say_conventions(method, a, data); !ok) return tl::unexpected(ok.error());
            return method.from_json(data, exclude);
        }
        data = {{"folder", std::filesystem::absolute(a.data).string()},
                {"board", a.board},
                {"pitch_mm", a.pitch_mm},
                {"pattern", a.pattern}};
        return stripe ? calibrate_stripe_camera_folder(a.data, a.board, a.pitch_mm, a.exclude)
                      : calibrate_camera_folder(a.data, a.board, a.pitch_mm, a.pattern, a.exclude);
    }
    auto read = read_json_file(a.data);
    if (!read) return tl::unexpected(read.error());
    data = std::move(*read);
    if (auto ok = say_conventions(method, a, data); !ok) return tl::unexpected(ok.error());
    if (!a.table.empty()) return calibrate_lut_json(data, a.exclude, a.table);
    return method.from_json(data, a.exclude);
}

// Into the project: result and raw data, so that it can be solved again, with who and when. It is not put to
// use by that.
Expected<std::string> store(const CalibrateArguments& a, const Method& method, const json& data,
                            const json& result) {
    auto file = ProjectFile::open(a.project);
    if (!file) return tl::unexpected(file.error());
    auto project = file->load();
    if (!project) return tl::unexpected(project.error());
    const auto sensor = std::find_if(project->sensors.begin(), project->sensors.end(),
                                     [&](const SensorSetup& s) { return s.id == a.sensor; });
    if (sensor == project->sensors.end())
        return usage_error(Text("the project has no sensor \"{}\"", a.sensor), "--sensor");
    const Calibration* base = nullptr;
    for (const Calibration& other : project->calibrations)
        if (other.id == sensor->calibration_id) base = &other;
    Calibration c;
    // What gives no model and no place on the flange is kept as a record.
    if (const CalibrationMethod* guided = find_method(method.name))
        if (auto made = calibration_of_result(*guided, data, a.exclude, result, base)) c = std::move(*made);
    c.id = fmt::format("{}-{}", method.name, project->calibrations.size() + 1);
    c.method = method.name;
    c.sensor_id = a.sensor;
    c.sensor_identity = sensor->identity;
    if (!project->robots.empty()) {
        c.robot_id = project->robots.front().id;
        c.robot_identity = project->robots.front().identity;
    }
    c.created_utc = utc_now();
    c.source = std::filesystem::absolute(a.data).string();
    c.verdict = verdict_of(result);
    c.raw = {{"data", data}, {"exclude", a.exclude}};
    c.result = result;
    project->calibrations.push_back(c);
    if (auto saved = file->save(*project); !saved) return tl::unexpected(saved.error());
    return c.id;
}

// A parameter that was not solved for has no uncertainty of its own.
std::string sigma_text(const json& sigma) {
    if (!sigma.is_number()) return "";
    return sigma.get<double>() == 0 ? "fixed" : fmt::format("± {:.2g}", sigma.get<double>());
}

std::string text_of(const Method& method, const json& r) {
    std::string text =
        fmt::format("{}: {}. {}\n", method.name, r.value("verdict", ""), r.value("reason", ""));
    if (!r.value("cure", "").empty()) text += "cure: " + r.value("cure", "") + "\n";
    for (const json& p : r.value("parameters", json::array()))
        if (p["value"].is_number())
            text +=
                fmt::format("  {:<12} {:>14.6g} {} {}\n", p["name"].get<std::string>(),
                            p["value"].get<double>(), sigma_text(p["sigma"]), p["unit"].get<std::string>());
    if (const auto plane = r.find("laser_plane"); plane != r.end() && plane->is_object()) {
        const json& n = (*plane)["normal"];
        text +=
            fmt::format("  laser plane in the camera: normal {:.5f}, {:.5f}, {:.5f}, distance {:.3f} mm\n",
                        n[0].get<double>(), n[1].get<double>(), n[2].get<double>(),
                        (*plane)["distance_mm"].get<double>());
    }
    for (const json& p : r.value("per_pose", json::array())) {
        text += "  " + p["id"].get<std::string>();
        for (const char* key : {"rms_mm", "deg", "rms_px"})
            if (p[key].is_number()) text += fmt::format("  {} {:.4f}", key, p[key].get<double>());
        if (!p.value("used", true)) text += "  left out";
        if (!p.value("note", "").empty()) text += "  " + p.value("note", "");
        text += "\n";
    }
    for (const json& n : r.value("notices", json::array())) text += "note: " + n.get<std::string>() + "\n";
    return text;
}

// What the poses are written in, into the result. Numbers that are no poses as given are an answer of their own
// where another convention fits; else `outcome` stays the error it is.
Expected<std::string> detect(const Method& method, const json& data, const Exclude& exclude,
                             Expected<CalibrateOutcome>& outcome) {
    auto convention = detect_pose_convention(method.name, data, exclude);
    if (!convention) return tl::unexpected(outcome ? convention.error() : outcome.error());
    if (!outcome && convention->found.finding != ConventionFinding::named)
        return tl::unexpected(outcome.error());
    if (!outcome) {
        const Text reason = outcome.error().text();
        CalibrateOutcome refused;
        refused.result = {{"method", method.name}, {"status", "undetermined"}, {"verdict", "undetermined"}};
        put_text(refused.result, "reason", reason);
        refused.exit_code = kExitVerdict;
        outcome = std::move(refused);
    }
    outcome->result["convention"] = convention->result;
    Text line = convention->found.sentence;
    if (!convention->codes.empty()) {
        std::string options;
        for (const std::string& code : convention->codes) options += " --pose-convention " + code;
        line = Text("{}; take it with{}", line, options);
    }
    return "convention: " + line.english() + "\n";
}

// A poor answer from poses may come from how they are written.
void hint_at_convention(const Method& method, const json& data, json& result) {
    const Verdict verdict = verdict_of(result);
    const bool open = verdict == Verdict::undetermined && result.value("degenerate", json::array()).empty();
    if (!can_detect_convention(method.name) || !(verdict == Verdict::poor || open)) return;
    const auto lists = written_poses(method.name, data);
    if ((!lists || lists->empty()) && result.value("poses", 0) == 0) return;
    put_text(result, "cure",
             joined(text_in(result, "cure"), "; ",
                    "--detect-convention tells whether the poses are written in another convention"));
}

Expected<Answer> calibrate(const Method& method, const CalibrateArguments& a) {
    if (!a.example.empty()) {
        auto data = calibration_example(method.name);
        if (!data) return tl::unexpected(data.error());
        if (auto written = write_text_file(a.example, data->dump(1) + "\n"); !written)
            return tl::unexpected(written.error());
        Answer answer;
        answer.json = {{"status", "ok"}, {"file", a.example}};
        answer.text = fmt::format("{} written; solve it with: seamwright calibrate {} {}\n", a.example,
                                  method.name, a.example);
        return answer;
    }
    if (a.data.empty())
        return usage_error("the data are missing", Text("calibrate {}", method.name),
                           "give them, or see their layout with --help and --example FILE.json");
    if (a.project.empty() != a.sensor.empty())
        return usage_error("--store and --sensor belong together", "calibrate");
    if (a.detect_convention && !can_detect_convention(method.name))
        return usage_error("its data leave no residual that a convention of poses shows in",
                           Text("calibrate {}", method.name),
                           "ask of tcp-sphere, hand-eye or stripe-camera data of the same robot");
    json data;
    Exclude exclude = a.exclude;
    auto outcome = solve(method, a, data, exclude);
    std::string convention;
    if (a.detect_convention && !data.is_null()) {
        auto said = detect(method, data, exclude, outcome);
        if (!said) return tl::unexpected(said.error());
        convention = std::move(*said);
    }
    if (!outcome) return tl::unexpected(outcome.error());
    if (!a.detect_convention) hint_at_convention(method, data, outcome->result);
    Answer answer;
    answer.json = std::move(outcome->result);
    answer.exit_code = outcome->exit_code;
    answer.text = text_of(method, answer.json) + convention;
    if (!a.report.empty()) {
        if (auto written = write_text_file(a.report, calibration_report(method.name, data, answer.json));
            !written)
            return tl::unexpected(written.error());
        answer.text += "report " + a.report + "\n";
    }
    if (!a.project.empty()) {
        auto id = store(a, method, data, answer.json);
        if (!id) return tl::unexpected(id.error());
        answer.json["stored_as"] = *id;
        answer.text += fmt::format("stored in {} as {}\n", a.project, *id);
    }
    return answer;
}

}  // namespace

void add_calibrate(CommandLine& line) {
    CLI::App* group = line.group(
        "calibrate", "Solve a calibration from data: parameters, uncertainty, residual per pose, verdict.",
        "seamwright calibrate tcp-sphere sphere.json --json -\n"
        "  seamwright calibrate stripe-camera images --board 7x6 --pitch-mm 10 --report report.html");
    for (const Method& method : kMethods) {
        auto a = std::make_shared<CalibrateArguments>();
        CLI::App* command =
            line.add(*group, method.name, method.help,
                     fmt::format("seamwright calibrate {0} {1}\n  seamwright calibrate {0} "
                                 "--example {0}.json\nLayout of DATA.json (? = optional; POSE = "
                                 "{{\"xyz\":[mm],\"abc\":[deg]}} or "
                                 "{{\"matrix\":[16]}}):\n  {2}",
                                 method.name, method.example, calibration_layout(method.name)));
        command
            ->add_option("data", a->data,
                         method.images ? "Folder of images (with pose files), or JSON" : "The data (JSON)")
            ->type_name(method.images ? "DIR|DATA.json" : "DATA.json");
        command
            ->add_option("--example", a->example,
                         "Write data as this method takes them, to look at and to try, and solve nothing")
            ->type_name("FILE.json");
        command->add_option("--exclude", a->exclude, "Leave these poses out of the solution")
            ->delimiter(',')
            ->type_name("ID,..");
        command->add_option("--report", a->report, "Residuals, coverage and pose geometry as a page")
            ->type_name("FILE.html");
        command->add_option("--store", a->project, "Keep result and data in this project")
            ->type_name("FILE.seam");
        command->add_option("--sensor", a->sensor, "The project's sensor that was calibrated");
        command->add_flag("--detect-convention", a->detect_convention,
                          "Where the answer is poor: solve with the poses read in every convention, and say "
                          "whether one fits far better (nothing is taken)");
        if (!pose_lists_of(method.name).empty())
            command
                ->add_option(
                    "--pose-convention", a->pose_convention,
                    "What the poses' numbers mean, e.g. euler-xyz-extrinsic,rad,m,inverse or quat-xyzw; "
                    "LIST=CODE of another list than base_from_flange; may be repeated")
                ->type_name("[LIST=]CODE");
        if (method.name == std::string("lut"))
            command->add_option("--table", a->table, "Where the table itself goes")->type_name("TABLE.lut");
        if (method.images) {
            command
                ->add_option("--board", a->board,
                             "Inner corners (chessboard), dots (circles) or squares (charuco)")
                ->type_name("7x6");
            command->add_option("--pitch-mm", a->pitch_mm, "Pitch of the board");
            if (method.from_json != calibrate_stripe_camera_json)
                command->add_option("--pattern", a->pattern, "chessboard, circles or charuco")
                    ->check(CLI::IsMember({"chessboard", "circles", "charuco"}))
                    ->capture_default_str();
        }
        line.on(command, [&method, a] { return calibrate(method, *a); });
    }
}

}  // namespace seamwright::cli
