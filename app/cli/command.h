#pragma once
// The frame that every command of `seamwright` hangs in. The contract (exit codes, --json, messages to
// stderr) is kept here once; a command only turns its arguments into an Answer.

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"

namespace seamwright::cli {

// Exit codes: 0 ok; 1 the job ran but its verdict is not ok; 2 usage or bad input; 3 device or file failure.
inline constexpr int kExitOk = 0, kExitVerdict = 1, kExitInput = 2, kExitDevice = 3;
int exit_code(ErrorKind kind);

struct Answer {
    nlohmann::json json;  // written where --json says
    std::string text;     // printed to stdout when --json is absent
    int exit_code = kExitOk;
};

class CommandLine {
  public:
    CommandLine();
    // A subcommand; `example` is shown at the foot of its --help.
    CLI::App* add(const std::string& name, const std::string& help, const std::string& example);
    // A word that has subcommands of its own, and such a subcommand.
    CLI::App* group(const std::string& name, const std::string& help, const std::string& example);
    CLI::App* add(CLI::App& group, const std::string& name, const std::string& help,
                  const std::string& example);
    // What runs when the subcommand was chosen.
    void on(CLI::App* command, std::function<Expected<Answer>()> action);
    // Parses, runs, writes the answer; returns the exit code.
    int run(int argc, char** argv);

  private:
    CLI::App app_;
    std::function<Expected<Answer>()> action_;
    std::string json_target_;
};

// One line each in main.cpp.
void add_correct(CommandLine& line);
void add_plan(CommandLine& line);
void add_panel(CommandLine& line);
void add_path(CommandLine& line);
void add_gap(CommandLine& line);
void add_double_head(CommandLine& line);
void add_evaluate(CommandLine& line);
void add_filter(CommandLine& line);
void add_feature(CommandLine& line);
void add_match(CommandLine& line);
void add_extract(CommandLine& line);
void add_track(CommandLine& line);
void add_resolution(CommandLine& line);
void add_align(CommandLine& line);
void add_calibrate(CommandLine& line);
void add_demo(CommandLine& line);
void add_project_commands(CommandLine& line);  // new, info, check, export, mirror
void add_type(CommandLine& line);
void add_user(CommandLine& line);
void add_audit(CommandLine& line);
void add_diagnose(CommandLine& line);
void add_import(CommandLine& line);
void add_drawing(CommandLine& line);
void add_propose(CommandLine& line);
void add_confirm(CommandLine& line);
void add_run(CommandLine& line);
void add_follow(CommandLine& line);
void add_service(CommandLine& line);
void add_record(CommandLine& line);
void add_expose(CommandLine& line);
void add_teach(CommandLine& line);
void add_pass(CommandLine& line);
void add_stripe(CommandLine& line);
void add_proof(CommandLine& line);  // zero-shift, known-shift
void add_budget(CommandLine& line);
void add_collision(CommandLine& line);
void add_use(CommandLine& line);
void add_plate_pose(CommandLine& line);
void add_hand_over(CommandLine& line);  // report, reteach
void add_acceptance(CommandLine& line);
void add_statistics(CommandLine& line);
void add_fleet(CommandLine& line);
void add_modes(CommandLine& line);
void add_drift(CommandLine& line);
void add_device_studies(CommandLine& line);  // measure-robot, measure-trigger
void add_scan(CommandLine& line);
void add_fit(CommandLine& line);
void add_replay(CommandLine& line);
void add_devices(CommandLine& line);
void add_line(CommandLine& line);
void add_sim_cell(CommandLine& line);
void add_robot_program(CommandLine& line);

}  // namespace seamwright::cli
