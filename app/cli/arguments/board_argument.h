#pragma once
// A calibration board on the command line.

#include "app/cli/command.h"
#include "projects/calibrate/input/plate_images.h"

namespace seamwright::cli {

// --board, --pitch-mm, --pattern, --marker-mm, --dictionary, --legacy-pattern; parse_board() reads the words.
void add_board_options(CLI::App& command, BoardWords& board);

}  // namespace seamwright::cli
