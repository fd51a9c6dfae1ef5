#pragma once
// How a table of poses is to be understood, on the command line: --pose-convention, --pose-unit, --pose-angle, and of what
// the poses are where not of the flange in the robot's base: --flange-from-tool, --base-from-user-frame.

#include <CLI/CLI.hpp>
#include <string>

#include "devices/exchange/tables/pose_table.h"

namespace seamwright::cli {

struct PoseTableArguments {
    std::string convention, unit, angle, flange_from_tool, base_from_user_frame;

    // Error: a pose that is none.
    Expected<PoseLayout> layout() const;
};

// `table`: the option that names the table, which these need; null: none.
void add_pose_table_options(CLI::App* command, PoseTableArguments& a, CLI::Option* table);

}  // namespace seamwright::cli
