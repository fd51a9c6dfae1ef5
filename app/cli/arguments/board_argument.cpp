#include "app/cli/arguments/board_argument.h"

namespace seamwright::cli {

void add_board_options(CLI::App& command, BoardWords& board) {
    command
        .add_option("--board", board.counts,
                    "Inner corners (chessboard), dots (circles), squares (charuco) or tags (aprilgrid)")
        ->type_name("7x6");
    command.add_option("--pitch-mm", board.pitch_mm, "Pitch of the board");
    command.add_option("--pattern", board.pattern, "chessboard, circles, charuco or aprilgrid")
        ->check(CLI::IsMember({"chessboard", "circles", "charuco", "aprilgrid"}))
        ->capture_default_str();
    command.add_option("--marker-mm", board.marker_mm,
                       "Edge of a marker (charuco; else found from the pictures) or a tag (aprilgrid)");
    command.add_option("--dictionary", board.dictionary,
                       "Of the markers, by OpenCV's name, e.g. 5x5_100; else the family that fits is found");
    command
        .add_option("--legacy-pattern", board.legacy,
                    "yes: charuco of an even number of rows as OpenCV drew it before 4.6; else what fits")
        ->check(CLI::IsMember({"yes", "no"}));
}

}  // namespace seamwright::cli
