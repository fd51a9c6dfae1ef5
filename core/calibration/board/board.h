#pragma once
// Finding a calibration plate in a grey image: chessboard corners, circle grids (all dots alike, or one
// bigger dot in a corner as orientation mark), ChArUco. Pixel centres lie on whole numbers. Made for
// under-exposed plates beside a saturated laser stripe.
//
// A chessboard's corners are saddle points strung to a lattice at several scales (board_checker.h), measured in
// the picture as taken by a model of two crossing edges; those under a stripe, a glint or a thing in front of the
// board are left out. For the others contrast is stretched on what is not saturated and the stripe and its halo
// are painted over.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/profile/stripe/stripe_image.h"
#include "core/text.h"

namespace seamwright {

enum class BoardPattern { chessboard, circles, charuco, aprilgrid };

// chessboard: columns x rows inner corners, pitch = edge of a square. circles: columns x rows dots, pitch =
// distance of neighbours. charuco: columns x rows squares, pitch = edge of a square. aprilgrid: columns x rows tags
// (numbered from the lower left one on, rows upwards, with the small squares between their corners), pitch = distance
// of neighbouring tags.
struct BoardSpec {
    BoardPattern pattern = BoardPattern::chessboard;
    int columns = 0, rows = 0;
    double pitch_mm = 0;
    double marker_mm = 0;  // edge of a marker or tag; 0 (charuco alone): found from the picture
    int dictionary = -1;   // OpenCV's number of a predefined one; -1: the family that fits is found
    // charuco of an even number of rows as OpenCV drew it before 4.6; unset: what fits
    std::optional<bool> legacy = {};
};

std::string_view name_of(BoardPattern pattern);  // "chessboard"
std::optional<BoardPattern> board_pattern_named(const std::string& name);

// Points along the columns and the rows, and where one is in the target frame.
int board_columns(const BoardSpec& spec);
int board_rows(const BoardSpec& spec);
Eigen::Vector3d board_point(const BoardSpec& spec, int index);

// "4x4_50", "DICT_5X5_100", "apriltag_36h11", ...: OpenCV's number; nullopt: there is no such dictionary.
std::optional<int> dictionary_named(const std::string& name);
std::vector<std::string> dictionary_names();

// Error: counts below 3 or above 200, pitch not positive or beyond 1 m; a pitch below 0.2 mm is taken for
// metres and said so.
Expected<void> validate(const BoardSpec& spec);

// Target frame: origin at point (0, 0), x along the columns, y along the rows, z = 0 and into the plate
// (right-handed), the points in the order of `index` = row * board_columns() + column.
struct FoundBoard {
    std::vector<Eigen::Vector2d> pixel;
    std::vector<Eigen::Vector3d> object_mm;
    std::vector<int> index;
    // Turns of the plate that look alike in an image: 1 = none, 2 = half turns, 4 = quarter turns.
    int symmetry = 1;
    std::string detector;  // which attempt found it
};

// Inner corners of a chessboard.
struct BoardCount {
    int columns = 0, rows = 0;
};

// What a picture shows in place of the chessboard asked for.
struct BoardMiss {
    // A whole board of another size is seen; its longer side as in the spec.
    std::optional<BoardCount> counted;
    bool several = false;  // not taken: more than one board of that size is seen
};
struct BoardSearch {
    std::optional<FoundBoard> board;
    BoardMiss miss;
};

// No board: none of that size, or not enough of it. A chessboard is taken with 45 % of its corners (7 at least)
// where each of its sides is seen to end, so that another size is out of the question; at the picture's rim one of
// two opposite sides may be cut off behind its last corners. Circle grids: all dots but a few beside the
// orientation mark; ChArUco and AprilGrid: four markers and 6 corners. Never throws; damaged images are "not found".
BoardSearch find_board(const StripeImage& image, const BoardSpec& spec);

// Why there is no board, and what to do about it.
Text why_missed(const BoardSpec& spec, const BoardMiss& miss);
Text cure_of(const BoardMiss& miss);

// The same board with its indices turned by `quarter_turns` quarter turns (only half turns when columns !=
// rows): the alternative reading of a symmetric board.
FoundBoard turned(const FoundBoard& board, const BoardSpec& spec, int quarter_turns);

// Polygon (pixel) of the printed board with its outer ring of squares, by the board's homography.
std::vector<Eigen::Vector2d> outline(const FoundBoard& board, const BoardSpec& spec);

}  // namespace seamwright
