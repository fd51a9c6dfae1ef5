// seamwright panel: the gripper's motion that brings the panel into the body as taught, of a job's measures
// or run on a project's devices.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "app/cli/answers/result_json.h"
#include "app/cli/answers/run_text.h"
#include "app/cli/arguments/feature_setting.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "core/panel/panel_fit.h"
#include "devices/exchange/pose_json.h"
#include "devices/simulated/scene/random.h"
#include "projects/measure/fields.h"
#include "projects/measure/measure.h"
#include "projects/panel/panel_job_file.h"
#include "projects/panel/panel_sensitivity.h"
#include "projects/panel/panel_servo.h"
#include "projects/panel/panel_station.h"
#include "projects/reuse/simulated_truth.h"
#include "projects/station/check.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

// `deviation`, where given, stands above the file's.
Expected<Answer> panel(const std::string& file, const std::string& deviation) {
    SEAM_TRY(auto job, read_panel_measures(file));
    if (!deviation.empty()) {
        SEAM_TRY(auto asked, panel_deviation_from(deviation));
        job.options.deviation = asked;
    }
    SEAM_TRY(auto fit, fit_panel(job.spots, job.options));
    Answer answer;
    answer.json = panel_fit_json(fit);
    answer.text = panel_fit_text(fit);
    answer.exit_code = fit.status == CorrectionStatus::ok ? kExitOk : kExitVerdict;
    return answer;
}

// --- on a project's devices

struct PanelArguments {
    std::string file, job, part, deviation, take;
    bool push = false, dry_run = false, keep_images = false, simulated = false, servo = false, learn = false;
    ServoingOptions servoing = device_servoing();
    int hold_s = static_cast<int>(kHold.count() / 1000);
    int teach = 0;
    std::uint64_t seed = 1;
    std::vector<std::pair<std::string, std::string>> settings;
};

bool is_project(const PanelArguments& a) {
    if (a.simulated || std::filesystem::path(a.file).extension() == ".seam") return true;
    constexpr std::string_view kSqlite = "SQLite format 3";
    std::ifstream in(a.file, std::ios::binary);
    std::string head(kSqlite.size(), '\0');
    return in.read(head.data(), static_cast<std::streamsize>(head.size())) && head == kSqlite;
}

RunOptions run_options(const PanelArguments& a) {
    RunOptions options;
    options.part_id = a.part;
    options.push = a.push;
    options.keep_images = a.keep_images;
    options.hold = std::chrono::seconds(a.hold_s);
    options.cancel = stop_on_signal();
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
    return options;
}

// The job named, or the only one.
Expected<std::string> job_of(const Project& project, const PanelArguments& a) {
    if (!a.job.empty()) return a.job;
    if (project.panel_jobs.size() == 1) return project.panel_jobs.front().id;
    std::string names;
    for (const PanelJob& job : project.panel_jobs) names += (names.empty() ? "" : ", ") + job.id;
    if (names.empty())
        return input_error("the project has no panel job", a.file,
                           "take one from a file with --take, or see --simulated");
    return usage_error("the project has several panel jobs", a.file, Text("name one with --job: {}", names));
}

Expected<void> teach(Station& station, const std::string& id, const PanelArguments& a) {
    Project project = station.project();
    const auto job = std::find_if(project.panel_jobs.begin(), project.panel_jobs.end(),
                                  [&](const PanelJob& j) { return j.id == id; });
    if (job == project.panel_jobs.end()) return input_error(Text("there is no panel job \"{}\"", id), a.file);
    TeachOptions options;
    options.repeats = a.teach;
    options.cancel = stop_on_signal();
    options.progress = run_options(a).progress;
    SEAM_TRY(auto taught, teach_panel(station, *job, options));
    *job = std::move(taught);
    return station.edit(project);
}

// Limits and tolerances of the job, by name.
Expected<Answer> set(Station& station, const std::string& id, const PanelArguments& a) {
    Project project = station.project();
    const auto job = std::find_if(project.panel_jobs.begin(), project.panel_jobs.end(),
                                  [&](const PanelJob& j) { return j.id == id; });
    if (job == project.panel_jobs.end()) return input_error(Text("there is no panel job \"{}\"", id), a.file);
    for (const auto& [name, text] : a.settings) {
        std::string known;
        const Field<PanelJob>* field = nullptr;
        for (const Field<PanelJob>& f : panel_fields()) {
            known += (known.empty() ? "" : ", ") + f.info.name;
            if (f.info.name == name) field = &f;
        }
        if (!field)
            return usage_error(Text("a panel job has no setting \"{}\"", name), "--set",
                               Text("known are {}", known));
        SEAM_TRY(const auto value, setting_value(field->info, text));
        SEAM_OK(set_field(*job, name, value));
    }
    SEAM_OK(station.edit(project));
    Answer answer;
    answer.json = {{"status", "set"}, {"job", id}};
    for (const Field<PanelJob>& f : panel_fields()) {
        if (!f.info.choices.empty()) {
            const std::string& word = f.info.choices[static_cast<std::size_t>(f.get(*job))];
            answer.json["settings"][f.info.name] = word;
            answer.text += fmt::format("{:<22}{:>10}\n", f.info.name, word);
            continue;
        }
        answer.json["settings"][f.info.name] = f.get(*job);
        answer.text +=
            fmt::format("{:<22}{:10.{}f} {}\n", f.info.name, f.get(*job), f.info.decimals, f.info.unit);
    }
    return answer;
}

// A job from a file becomes the project's.
Expected<Answer> take(Station& station, const std::string& file) {
    SEAM_TRY(auto job, read_panel_job(file));
    Answer answer;
    answer.json = {{"status", "taken"}, {"job", job.id}, {"places", job.places.size()}};
    answer.text = fmt::format("panel job {} of {} places taken\n", job.id, job.places.size());
    SEAM_TRY(const auto project, with_panel_job(station.project(), std::move(job)));
    SEAM_OK(station.edit(project));
    return answer;
}

// Panel or body somewhere off: 3 mm across, as much within the opening as the gap leaves to both.
nlohmann::json somewhere(Random& random) {
    const double x = random.uniform(-0.5, 0.5), y = random.uniform(-0.5, 0.5), z = random.uniform(-3, 3);
    const double a = random.uniform(-8e-4, 8e-4), b = random.uniform(-8e-4, 8e-4),
                 c = random.uniform(-8e-4, 8e-4);
    return {{"displacement", pose_json(make_pose(rotation_exp({a, b, c}), {x, y, z}))}};
}

// The simulated gripper with its panel job, taught in zero position; then panel and body stand somewhere
// else.
Expected<void> make_simulated(const PanelArguments& a) {
    const json settings = {{"seed", a.seed}};
    SEAM_TRY(auto project, simulated_panel_project(settings));
    SEAM_TRY(auto file, ProjectFile::create(a.file, project));
    Station station(std::move(file), std::move(project));
    SEAM_OK(station.connect());
    PanelArguments teaching = a;
    if (teaching.teach == 0) teaching.teach = 5;
    SEAM_OK(teach(station, station.project().panel_jobs.front().id, teaching));
    station.disconnect();
    Project displaced = station.project();
    Random random(a.seed, 77);
    const json panel = somewhere(random), body = somewhere(random);
    for (SensorSetup& s : displaced.sensors) s.settings.update({{"panel", panel}, {"body", body}});
    for (RobotSetup& r : displaced.robots) r.settings.update({{"panel", panel}, {"body", body}});
    return station.edit(displaced);
}

// The sensitivity by known small moves, kept with the job.
Expected<Answer> learn(Station& station, const std::string& id, const PanelArguments& a) {
    SEAM_TRY(const auto learnt, learn_panel(station, id, a.servoing, run_options(a)));
    Answer answer;
    answer.json = {{"status", learnt.usable ? "learnt" : "ill_conditioned"},
                   {"job", id},
                   {"condition", std::isfinite(learnt.condition) ? json(learnt.condition) : json()},
                   {"condition_limit", a.servoing.condition_limit},
                   {"run", learnt.run.number}};
    if (!learnt.usable) {
        answer.text = fmt::format(
            "the sensitivity cannot be inverted (condition {:.3g}): measure at more places, in other "
            "directions\n",
            learnt.condition);
        answer.exit_code = kExitVerdict;
        return answer;
    }
    Project project = station.project();
    for (PanelJob& job : project.panel_jobs)
        if (job.id == id) job = learnt.job;
    SEAM_OK(station.edit(project));
    const PanelSensitivity& s = *learnt.job.sensitivity;
    SEAM_TRY(const auto beside, compare_sensitivity(project, learnt.job));
    answer.json["places"] = s.places;
    answer.json["sensitivity"] = s.rows;
    answer.json["beside_computed"] = {{"off_share", beside.off_share},
                                      {"largest_mm", beside.largest_mm},
                                      {"place", beside.place},
                                      {"value", beside.flush ? "flush" : "gap"}};
    answer.text = fmt::format(
        "sensitivity of {} values learnt by moves of {:g} mm and {:g} deg, condition {:.1f}; kept\n"
        "{:.1f} % off the computed one; most at place {}, {}: {:.3f} mm of a move\n",
        s.rows.size(), s.step_mm, s.step_deg, s.condition, 100 * beside.off_share, beside.place,
        beside.flush ? "flush" : "gap", beside.largest_mm);
    return answer;
}

Expected<Answer> servo_on_devices(Station& station, const std::string& id, const PanelArguments& a) {
    if (a.learn) {
        SEAM_TRY(auto learnt, learn(station, id, a));
        if (learnt.exit_code != kExitOk || !a.push) return learnt;
    }
    SEAM_TRY(auto record, servo_panel(station, id, a.servoing, run_options(a)));
    Answer answer;
    answer.json = run_json(record);
    answer.text = run_text(record);
    answer.exit_code = run_exit_code(record);
    return answer;
}

Expected<Answer> panel_on_devices(const PanelArguments& a) {
    if (a.learn && !a.servo)
        return usage_error("there is nothing to learn for", "--learn", "give --servo with it");
    if (a.servo && a.teach > 0 && !a.simulated)
        return usage_error("teaching and servoing are two things", "--servo", "teach first");
    if (a.simulated) SEAM_OK(make_simulated(a));
    const std::optional<Deed> deed = a.learn  ? std::optional(Deed::teach)
                                     : a.push ? std::optional(Deed::push)
                                              : std::nullopt;
    SEAM_TRY(auto station, open_station(a.file, deed));
    if (!a.take.empty()) return take(station, a.take);
    SEAM_TRY(auto id, job_of(station.project(), a));
    if (!a.settings.empty()) return set(station, id, a);
    if (const PanelJob* job = find_panel_job(station.project(), id); job && a.teach == 0)
        if (auto refused = refuse_unsafe(station, motion_findings(station.project(), *job, a.push)))
            return *refused;
    SEAM_OK(station.connect());
    Answer answer;
    if (a.teach > 0 && !a.simulated) {
        SEAM_OK(teach(station, id, a));
        json places = json::array();
        for (const PanelJob& job : station.project().panel_jobs) {
            if (job.id != id) continue;
            for (const PanelPlace& p : job.places) {
                places.push_back({{"id", p.id}, {"gap_mm", p.gap_mm}, {"flush_mm", p.flush_mm}});
                answer.text +=
                    fmt::format("place {:<6} gap {:8.3f}   flush {:+8.3f} mm\n", p.id, p.gap_mm, p.flush_mm);
            }
        }
        answer.json = {{"status", "taught"}, {"job", id}, {"places", places}};
        return answer;
    }
    if (a.servo) return servo_on_devices(station, id, a);
    SEAM_TRY(auto record, run_panel(station, id, run_options(a)));
    answer.json = run_json(record);
    answer.text = run_text(record);
    answer.exit_code = run_exit_code(record);
    return answer;
}

}  // namespace

void add_panel(CommandLine& line) {
    CLI::App* command = line.add(
        "panel",
        "Motion of the gripper that brings the panel into the body as taught, in a single step: of a job's "
        "measures,\n"
        "or, with a project, on its devices: measured, judged by the safety gate, with --push moved by the "
        "job's "
        "frame\n"
        "and measured again. The run is kept in the project.\n"
        "\"gripper_motion\" is G: base_from_gripper_new = base_from_gripper_old * G (in the gripper's own "
        "frame).\n"
        "G minimises the deviation of panel from body at the spots (4.29); \"single_step\" is B * P^-1 of "
        "the\n"
        "separate fits of body and panel; they agree when nothing is deformed. A spot that contradicts the\n"
        "others (a bent panel) has its deviation shared out over all spots (best fit), or is left out:\n"
        "--deviation, \"deviation\" in JOB.json, or the job's setting of that name in a project.\n"
        "Per spot, what is left off after the motion, now minus taught: residual_mm = panel relative to body "
        "in the\n"
        "sensor frame; gap_mm > 0 = too wide (along the surface); flush_mm > 0 = the panel stands too proud "
        "of "
        "the body\n"
        "(across it). The body is the reference side; surface_deg (default 0) turns its surface from +x "
        "towards +z.",
        "seamwright panel job.json --json -\n"
        "  seamwright panel fender.seam --part CAR-0815 --push\n"
        "  seamwright panel try.seam --simulated --push\n"
        "  seamwright panel try.seam --simulated --servo --learn --push\n"
        "  seamwright panel fender.seam --servo --learn; seamwright panel fender.seam --servo --part "
        "CAR-0815 --push\n"
        "  seamwright panel fender.seam --set gap_tolerance_mm 0.3 --set flush_tolerance_mm 0.2\n"
        "  seamwright panel fender.seam --set deviation leave_out\n"
        "  seamwright panel fender.seam --take job_of_export.json\n"
        "  job.json: "
        "{\"spots\":[{\"id\":\"S1\",\"gripper_from_sensor\":{\"xyz\":[500,0,900],\"abc\":[0,0,0]},\n"
        "             \"panel\":{\"reference\":[0,0,0],\"measured\":[0.3,0,0.1]},\n"
        "             \"body\":{\"reference\":[4,0,0],\"measured\":[4.2,0,-0.1]},\n"
        "             \"weights\":[1,0,1],\"sigma_mm\":0.05}, ...],\n"
        "             \"limits\":{\"translation_mm\":25,\"rotation_deg\":3},\"deviation\":\"share\"}");
    auto a = std::make_shared<PanelArguments>();
    command->add_option("job", a->file, "The job's measures (JSON), or a project")
        ->required()
        ->type_name("JOB.json|FILE.seam");
    command->add_option("--job", a->job, "Which panel job of the project (default: the only one)");
    command->add_option("--part", a->part, "Name of the panel in the gripper");
    auto* push = command->add_flag(
        "--push", a->push,
        "Write the frame that moves the panel, if the safety gate passes it, and measure again");
    auto* servo =
        command->add_flag("--servo", a->servo,
                          "In several moves by the learnt sensitivity, each through the gate; the answer has "
                          "the single step beside it");
    auto* learn = command->add_flag(
        "--learn", a->learn,
        "Learn the sensitivity by twelve small moves through the gate, and keep it with the "
        "job");
    learn->needs(servo);
    command->add_option("--step-mm", a->servoing.step_mm, "Of the moves that learn")
        ->needs(learn)
        ->capture_default_str();
    command->add_option("--step-deg", a->servoing.step_deg, "Of the turns that learn")
        ->needs(learn)
        ->capture_default_str();
    command->add_option("--moves", a->servoing.max_moves, "Most moves of a panel")
        ->needs(servo)
        ->check(CLI::Range(1, 50))
        ->capture_default_str();
    command->add_option("--gain", a->servoing.gain, "Share of the computed motion that a move makes")
        ->needs(servo)
        ->check(CLI::Range(0.1, 1.0))
        ->capture_default_str();
    command->add_flag("--dry-run", a->dry_run, "Everything but writing (the default)")->excludes(push);
    command
        ->add_option(
            "--hold", a->hold_s,
            "With --push: seconds for the application to begin with the panel in place; 0: not waited "
            "for")
        ->needs(push)
        ->check(CLI::Range(0, 86400))
        ->capture_default_str();
    command->add_flag("--keep-images", a->keep_images, "Keep the raw images with the run");
    command
        ->add_option("--teach", a->teach,
                     "Instead of a run: the panel is in its zero position, measure it so often and keep that")
        ->check(CLI::Range(1, 1000))
        ->excludes(push);
    auto* settings = command->add_option("--set", a->settings,
                                         "Instead of a run: a limit or tolerance of the job, e.g. "
                                         "gap_tolerance_mm 0.3");
    settings->type_name("NAME VALUE")->excludes(push)->excludes(command->get_option("--teach"));
    command
        ->add_option(
            "--take", a->take,
            "Instead of a run: this panel job becomes the project's, as an entry of \"panel_jobs\" in an "
            "export, or an export that holds one")
        ->type_name("JOB.json")
        ->excludes(push)
        ->excludes(command->get_option("--teach"))
        ->excludes(settings)
        ->excludes(servo);
    command->add_option(
        "--deviation", a->deviation,
        "With JOB.json: of a spot that contradicts the others, \"share\" out its deviation (best "
        "fit, the default) or \"leave_out\" the spot");
    auto* simulated =
        command->add_flag("--simulated", a->simulated,
                          "Make FILE.seam first: a simulated gripper, taught, then panel and body displaced");
    command->add_option("--seed", a->seed, "With --simulated: every random number follows from it")
        ->needs(simulated);
    settings->excludes(simulated);
    add_sign_in(command);
    line.on(command, [a]() -> Expected<Answer> {
        if (is_project(*a)) {
            if (!a->deviation.empty())
                return usage_error("a project keeps what becomes of a deviation in its panel job",
                                   "--deviation", Text("give --set deviation {}", a->deviation));
            return panel_on_devices(*a);
        }
        if (!a->settings.empty()) return usage_error("--set is for a project's panel job", a->file);
        if (!a->take.empty()) return usage_error("--take is for a project", a->file);
        return panel(a->file, a->deviation);
    });
}

}  // namespace seamwright::cli
