// seamwright measure-robot, measure-trigger: what the stated uncertainty rests on, measured instead of typed.

#include <fmt/format.h>

#include <filesystem>

#include "app/cli/command.h"
#include "app/cli/program_files.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "devices/registry.h"
#include "projects/acceptance/equipment/device_studies.h"
#include "projects/acceptance/pages/acceptance_page.h"

namespace seamwright::cli {
namespace {

struct DeviceStudyArguments {
    std::string file, robot, brand;
    std::filesystem::path program;
    bool dry_run = false, undo = false;
    MeasureRobotOptions on_robot;
    MeasureTriggerOptions on_trigger;
};

Expected<Station> connected_station(const std::string& file) {
    auto station = open_station(file, Deed::teach);
    if (!station) return station;
    SEAM_OK(station->connect());
    return station;
}

template <class Options>
void watch_over(Options& options, bool dry_run) {
    options.keep = !dry_run;
    options.cancel = stop_on_signal();
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
}

template <class Measured>
std::string text_of(const Measured& measured) {
    report::Page page(measured.source.file);
    add_chapter(page, Language::english, measured);
    return page.text();
}

Answer undone(const char* what) {
    Answer answer;
    answer.json = {{"status", "ok"}, {"undone", true}};
    answer.text = fmt::format("{}: what the newest study replaced is set again\n", what);
    return answer;
}

Expected<Answer> measure_robot_command(const DeviceStudyArguments& a) {
    if (a.undo) {
        SEAM_TRY(auto station, open_station(a.file, Deed::teach));
        SEAM_OK(undo_robot_study(station, a.robot));
        return undone("arrival covariance");
    }
    SEAM_TRY(auto station, connected_station(a.file));
    MeasureRobotOptions options = a.on_robot;
    watch_over(options, a.dry_run);
    SEAM_TRY(auto measured, measure_robot(station, options));
    Answer answer;
    answer.json = robot_study_json(measured);
    answer.text = text_of(measured);
    answer.text += a.dry_run
                       ? "dry run: nothing is set\n"
                       : fmt::format("arrival_covariance of robot {} is set; --undo sets back what it was\n",
                                     measured.returns.robot_id);
    return answer;
}

Expected<Answer> write_passes(const DeviceStudyArguments& a) {
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto request, trigger_program(project, a.on_trigger));
    SEAM_TRY(auto files, write_robot_program(a.brand, request));
    Answer answer;
    answer.json = {{"status", "ok"}, {"passes", request.moves.size()}};
    SEAM_OK(write_program_files(a.program, files, answer));
    return answer;
}

Expected<Answer> measure_trigger_command(const DeviceStudyArguments& a) {
    if (a.program.empty() != a.brand.empty())
        return usage_error("--program and --brand belong together", "measure-trigger", "give both");
    if (!a.program.empty()) return write_passes(a);
    if (a.undo) {
        SEAM_TRY(auto station, open_station(a.file, Deed::teach));
        SEAM_OK(undo_trigger_study(station));
        return undone("latency and jitter");
    }
    SEAM_TRY(auto station, connected_station(a.file));
    MeasureTriggerOptions options = a.on_trigger;
    watch_over(options, a.dry_run);
    SEAM_TRY(auto measured, measure_trigger(station, options));
    Answer answer;
    answer.json = trigger_study_json(measured);
    answer.text = text_of(measured);
    answer.exit_code = measured.study ? kExitOk : kExitVerdict;
    if (measured.study)
        answer.text += a.dry_run ? "dry run: nothing is set\n"
                                 : fmt::format(
                                       "trigger_latency_ms and jitter_mm of {} spots are set; --undo sets "
                                       "back what they were\n",
                                       measured.jitter_mm.size());
    return answer;
}

}  // namespace

void add_device_studies(CommandLine& line) {
    auto r = std::make_shared<DeviceStudyArguments>();
    CLI::App* robot = line.add("measure-robot",
                               "Repeatability RP of the robot after ISO 9283 from returns to spots, the "
                               "sensor's noise taken off, with "
                               "95 % limits. Sets the robot's arrival covariance in the project, with its "
                               "evidence. The robot goes to "
                               "the first spot's entry straight from where it stands, then between entry and "
                               "trigger as in teaching; "
                               "nothing is written to it.",
                               "seamwright measure-robot door_left.seam --spot S1 --spot S4 --returns 30");
    robot->add_option("file", r->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(robot);
    robot->add_option("--spot", r->on_robot.spot_ids,
                      "Return to this spot (repeatable); else to up to three that together see the most");
    robot->add_option("--returns", r->on_robot.returns, "To each spot")
        ->check(CLI::Range(kLeastReturns, 1000))
        ->capture_default_str();
    robot->add_option("--profiles", r->on_robot.profiles, "Standing at each return: the sensor's noise")
        ->check(CLI::Range(2, 100))
        ->capture_default_str();
    robot->add_flag("--dry-run", r->dry_run, "Measure and say, set and store nothing");
    auto* undo = robot->add_flag("--undo", r->undo, "Set back what the newest study replaced");
    robot->add_option("--robot", r->robot, "Whose study is undone, where there are several")
        ->type_name("ID")
        ->needs(undo);
    line.on(robot, [r] { return measure_robot_command(*r); });

    auto t = std::make_shared<DeviceStudyArguments>();
    CLI::App* trigger =
        line.add("measure-trigger",
                 "Latency and jitter of the trigger with 95 % limits, from passes over one spot at three or "
                 "more speeds in "
                 "both directions and passes that stop there. Sets the robot's latency and jitter_mm of the "
                 "spots of the "
                 "same robot and sensor, with its evidence. A contour along the travel shows nothing of it: "
                 "exit 1, and "
                 "the pass that would. Nothing is written to the robot.",
                 "seamwright measure-trigger door_left.seam --spot S1 --speeds 25,50,100 --travel-deg 45");
    trigger->add_option("file", t->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(trigger);
    trigger
        ->add_option("--spot", t->on_trigger.spot_id, "Passed over; else the one that sees its travel best")
        ->type_name("ID");
    trigger
        ->add_option("--speeds", t->on_trigger.speeds_mm_s,
                     "mm/s, three or more; else a quarter, a half and all of the spot's")
        ->delimiter(',')
        ->type_name("A,B,C");
    trigger->add_option("--passes", t->on_trigger.passes, "Each way at each speed")
        ->check(CLI::Range(2, 1000))
        ->capture_default_str();
    trigger
        ->add_option("--travel-deg", t->on_trigger.travel_deg,
                     "Travel turned from the sensor's Y towards its X; the way must be free")
        ->check(CLI::Range(-90.0, 90.0))
        ->capture_default_str();
    trigger
        ->add_option("--program", t->program,
                     "Write the controller's program of these passes instead, for robots that hold their own")
        ->type_name("DIR");
    trigger->add_option("--brand", t->brand, "Of --program, as in robot-program");
    trigger->add_flag("--dry-run", t->dry_run, "Measure and say, set and store nothing");
    trigger->add_flag("--undo", t->undo, "Set back what the newest study replaced");
    line.on(trigger, [t] { return measure_trigger_command(*t); });
}

}  // namespace seamwright::cli
