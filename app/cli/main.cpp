#include "app/cli/command.h"

int main(int argc, char** argv) {
    using namespace seamwright::cli;
    CommandLine line;
    add_demo(line);
    add_project_commands(line);
    add_type(line);
    add_user(line);
    add_audit(line);
    add_import(line);
    add_drawing(line);
    add_propose(line);
    add_confirm(line);
    add_run(line);
    add_service(line);
    add_record(line);
    add_expose(line);
    add_proof(line);
    add_budget(line);
    add_hand_over(line);
    add_acceptance(line);
    add_statistics(line);
    add_diagnose(line);
    add_modes(line);
    add_drift(line);
    add_device_studies(line);
    add_scan(line);
    add_fit(line);
    add_replay(line);
    add_correct(line);
    add_plan(line);
    add_panel(line);
    add_path(line);
    add_gap(line);
    add_evaluate(line);
    add_filter(line);
    add_feature(line);
    add_match(line);
    add_extract(line);
    add_align(line);
    add_calibrate(line);
    add_collision(line);
    add_devices(line);
    add_line(line);
    add_sim_cell(line);
    add_robot_program(line);
    return line.run(argc, argv);
}
