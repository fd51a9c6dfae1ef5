// seamwright calibrate METHOD DATA: every calibration, from files.

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <optional>

#include "app/cli/arguments/board_argument.h"
#include "app/cli/command.h"
#include "app/cli/commands/calibrate/calibrate_live.h"
#include "app/cli/sign_in.h"
#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/lookup_table_file.h"
#include "projects/calibrate/detect_convention.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/calibrate/report_page.h"
#include "projects/calibrate/session/answer.h"
#include "projects/file/project_file.h"
#include "projects/file/stored_text.h"
#include "projects/measure/measure.h"
#include "projects/model/run.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct CalibrateArguments {
    BoardWords board;
    std::string data, report, project, sensor, table, example;
    ExcludedIds exclude;
    bool detect_convention = false;
    std::optional<double> robot_mm, robot_deg;
    std::vector<std::string> pose_convention;  // "CODE" or "LIST=CODE"
    LiveCalibrationArguments live;
};

Text where(const CalibrationMethod& method) {
    return Text("calibrate {}", method.id);
}

// Frame by frame, for a person who waits; nothing into a log.
void show_progress(int done, int total) {
    if (isatty(STDERR_FILENO))
        fmt::print(stderr, "\rimage {} of {}{}", done, total, done == total ? "\n" : "");
}

// What is solved: data, and who of them takes no part.
struct Given {
    json data;
    ExcludedIds exclude;
};

Expected<Given> read_data(const CalibrationMethod& method, const CalibrateArguments& a) {
    Given given{{}, a.exclude};
    const bool file = std::filesystem::is_regular_file(a.data) || a.data.ends_with(".json");
    const bool images = method.data_of_images && !file;
    if (images) {
        if (a.board.counts.empty() || !(a.board.pitch_mm > 0))
            return usage_error("images of a plate need --board COLUMNSxROWS and --pitch-mm", where(method));
        SEAM_TRY(auto data, method.data_of_images({a.data, a.board, a.exclude, show_progress}));
        given = {std::move(data), {}};
    } else {
        SEAM_TRY(auto data, read_json_file(a.data));
        given.data = std::move(data);
    }
    if (a.robot_mm)
        given.data["robot"] = {{"sigma_mm", *a.robot_mm}, {"sigma_deg", a.robot_deg.value_or(0.0)}};
    for (const std::string& said : a.pose_convention)
        SEAM_OK(say_convention(method.poses, said, where(method), given.data));
    return given;
}

// A poor table must not be taken for a good one because its file is there.
Expected<void> write_table(const std::string& path, CalibrationSolution& solution) {
    const auto* found = std::get_if<PixelTable>(&solution.found);
    if (path.empty() || !found || !serves(solution.verdict())) return {};
    SEAM_OK(write_lookup_table(path, found->table));
    solution.document["table_file"] = path;
    return {};
}

// Into the project: result and raw data, so that it can be solved again, with who and when. It is not put to
// use by that.
Expected<std::string> store(const CalibrateArguments& a, const CalibrationMethod& method, const Given& given,
                            const CalibrationSolution& solution) {
    SEAM_TRY(auto file, open_to_edit(a.project));
    SEAM_TRY(auto project, file.load());
    const auto sensor = std::find_if(project.sensors.begin(), project.sensors.end(),
                                     [&](const SensorSetup& s) { return s.id == a.sensor; });
    if (sensor == project.sensors.end())
        return usage_error(Text("the project has no sensor \"{}\"", a.sensor), "--sensor");
    const Calibration* base = nullptr;
    for (const Calibration& other : project.calibrations)
        if (other.id == sensor->calibration_id) base = &other;
    Calibration c;
    // What gives no model and no place on the flange is kept as a record.
    if (auto made = calibration_of_solution(method, given.data, given.exclude, solution, base))
        c = std::move(*made);
    c.id = fmt::format("{}-{}", method.id, project.calibrations.size() + 1);
    c.method = method.id;
    c.sensor_id = a.sensor;
    c.sensor_identity = sensor->identity;
    // A nozzle is its sensor's robot's.
    const RobotSetup* robot = c.nozzle && base ? find_robot(project, base->robot_id) : nullptr;
    if (!robot && !project.robots.empty()) robot = &project.robots.front();
    if (robot) {
        c.robot_id = robot->id;
        c.robot_identity = robot->identity;
    }
    c.created_utc = utc_now();
    c.source = std::filesystem::absolute(a.data).string();
    c.verdict = solution.verdict();
    c.raw = {{"data", given.data}, {"exclude", given.exclude}};
    c.result = solution.document;
    project.calibrations.push_back(c);
    SEAM_OK(file.save(project));
    return c.id;
}

// A parameter that was not solved for has no uncertainty of its own.
std::string sigma_text(const json& sigma) {
    if (!sigma.is_number()) return "";
    return sigma.get<double>() == 0 ? "fixed" : fmt::format("± {:.2g}", sigma.get<double>());
}

std::string text_of(const CalibrationMethod& method, const json& r) {
    std::string text = fmt::format("{}: {}. {}\n", method.id, r.value("verdict", ""), r.value("reason", ""));
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

// What the poses are written in, into the answer. Numbers that are no poses as given are an answer of their own
// where another convention fits; else `solution` stays the error it is.
Expected<std::string> detect(const CalibrationMethod& method, const Given& given,
                             Expected<CalibrationSolution>& solution) {
    auto convention = detect_pose_convention(method, given.data, given.exclude);
    if (!convention) return tl::unexpected(solution ? convention.error() : solution.error());
    if (!solution && convention->found.finding != ConventionFinding::named)
        return tl::unexpected(solution.error());
    if (!solution) {
        CalibrationSolution refused;
        refused.report.judgement.reason = solution.error().text();
        refused.document = {{"method", method.id}, {"status", "undetermined"}};
        put_judgement(refused.report.judgement, refused.document);
        solution = std::move(refused);
    }
    solution->document["convention"] = convention->result;
    Text line = convention->found.sentence;
    if (!convention->codes.empty()) {
        std::string options;
        for (const std::string& code : convention->codes) options += " --pose-convention " + code;
        line = Text("{}; take it with{}", line, options);
    }
    return "convention: " + line.english() + "\n";
}

// A poor answer from poses may come from how they are written.
void hint_at_convention(const CalibrationMethod& method, const Given& given, CalibrationSolution& solution) {
    const bool open = solution.verdict() == Verdict::undetermined && solution.degenerate.empty();
    if (!method.convention_fits || !(solution.verdict() == Verdict::poor || open)) return;
    const auto lists = written_poses(method.poses, given.data);
    if (!lists || lists->empty()) return;
    Text& cure = solution.report.judgement.cure;
    cure =
        joined(cure, "; ", "--detect-convention tells whether the poses are written in another convention");
    put_text(solution.document, "cure", cure);
}

Expected<Answer> write_example(const CalibrationMethod& method, const std::string& path) {
    SEAM_OK(write_text_file(path, method.example().dump(1) + "\n"));
    Answer answer;
    answer.json = {{"status", "ok"}, {"file", path}};
    answer.text =
        fmt::format("{} written; solve it with: seamwright calibrate {} {}\n", path, method.id, path);
    return answer;
}

Expected<void> check_arguments(const CalibrationMethod& method, const CalibrateArguments& a) {
    if (a.data.empty())
        return usage_error("the data are missing", where(method),
                           "give them, or see their layout with --help and --example FILE.json");
    if (a.live.live && a.robot_mm)
        return usage_error("--robot-mm is of data: --live takes what measure-robot found", where(method));
    if (a.live.live && (!a.project.empty() || !a.report.empty() || !a.table.empty() || a.detect_convention))
        return usage_error(
            "--live stores by itself: --store, --report, --table and --detect-convention are of data",
            where(method));
    if (!a.live.live && a.project.empty() != a.sensor.empty())
        return usage_error("--store and --sensor belong together", "calibrate");
    if (a.detect_convention && !method.convention_fits)
        return usage_error("its data leave no residual that a convention of poses shows in", where(method),
                           "ask of tcp-sphere, hand-eye or stripe-camera data of the same robot");
    return {};
}

Expected<Answer> calibrate(const CalibrationMethod& method, const CalibrateArguments& a) {
    if (!a.example.empty()) return write_example(method, a.example);
    SEAM_OK(check_arguments(method, a));
    if (a.live.live) {
        auto answer = calibrate_on_devices(method, a.data, a.sensor, a.live);
        if (answer) answer->text = text_of(method, answer->json) + answer->text;
        return answer;
    }
    SEAM_TRY(const auto given, read_data(method, a));
    auto solution = solve_calibration(method, given.data, given.exclude);
    std::string convention;
    if (a.detect_convention) {
        SEAM_TRY(auto said, detect(method, given, solution));
        convention = std::move(said);
    }
    if (!solution) return tl::unexpected(solution.error());
    if (!a.detect_convention) hint_at_convention(method, given, *solution);
    SEAM_OK(write_table(a.table, *solution));
    Answer answer;
    answer.json = solution->document;
    answer.exit_code = serves(solution->verdict()) ? kExitOk : kExitVerdict;
    answer.text = text_of(method, answer.json) + convention;
    if (!a.report.empty()) {
        if (auto written = write_text_file(a.report, calibration_report(method, given.data, *solution));
            !written)
            return tl::unexpected(written.error());
        answer.text += "report " + a.report + "\n";
    }
    if (!a.project.empty()) {
        SEAM_TRY(auto id, store(a, method, given, *solution));
        answer.json["stored_as"] = id;
        answer.text += fmt::format("stored in {} as {}\n", a.project, id);
    }
    return answer;
}

void add_method(CommandLine& line, CLI::App& group, const CalibrationMethod& method) {
    auto a = std::make_shared<CalibrateArguments>();
    CLI::App* command = line.add(group, method.id, method.help,
                                 fmt::format("seamwright calibrate {0} {1}\n  seamwright calibrate {0} "
                                             "--example {0}.json\nLayout of DATA.json (? = optional; POSE = "
                                             "{{\"xyz\":[mm],\"abc\":[deg]}} or "
                                             "{{\"matrix\":[16]}}):\n  {2}",
                                             method.id, method.usage, method.layout));
    const bool images = method.data_of_images != nullptr;
    command
        ->add_option("data", a->data,
                     images ? "Folder of images (with pose files), or JSON" : "The data (JSON)")
        ->type_name(images ? "DIR|DATA.json" : "DATA.json");
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
    add_sign_in(command);
    command->add_option("--sensor", a->sensor, "The project's sensor that was calibrated");
    command->add_flag("--detect-convention", a->detect_convention,
                      "Where the answer is poor: solve with the poses read in every convention, and say "
                      "whether one fits far better (nothing is taken)");
    if (!method.poses.empty())
        command
            ->add_option("--pose-convention", a->pose_convention,
                         "What the poses' numbers mean, e.g. euler-xyz-extrinsic,rad,m,inverse or quat-xyzw; "
                         "LIST=CODE of another list than base_from_flange; may be repeated")
            ->type_name("[LIST=]CODE");
    if (method.repeatability) {
        auto* mm =
            command
                ->add_option("--robot-mm", a->robot_mm,
                             "The robot's repeatability: one standard deviation of an arrival, an axis "
                             "(about a third of RP; instead of \"robot\" in the data)")
                ->type_name("MM");
        command->add_option("--robot-deg", a->robot_deg, "The same of its turn")->type_name("DEG")->needs(mm);
    }
    if (method.table)
        command->add_option("--table", a->table, "Where the table itself goes")->type_name("TABLE.lut");
    if (images) add_board_options(*command, a->board);
    if (method.capture != CaptureKind::files && method.capture != CaptureKind::touch)
        add_live_options(*command, method, a->live);
    line.on(command, [&method, a] { return calibrate(method, *a); });
}

}  // namespace

void add_calibrate(CommandLine& line) {
    CLI::App* group = line.group(
        "calibrate", "Solve a calibration from data: parameters, uncertainty, residual per pose, verdict.",
        "seamwright calibrate tcp-sphere sphere.json --json -\n"
        "  seamwright calibrate stripe-camera images --board 7x6 --pitch-mm 10 --report report.html\n"
        "  seamwright calibrate tcp-sphere door.seam --live --sensor A --set radius=25 --use");
    for (const CalibrationMethod& method : calibration_methods()) add_method(line, *group, method);
}

}  // namespace seamwright::cli
