#pragma once
// Finding a calibration plate in a grey image: chessboard corners, circle grids (all dots alike, or one
// bigger dot in a corner as orientation mark), ChArUco. Pixel centres lie on whole numbers. Made for
// under-exposed plates beside a saturated laser stripe: contrast is stretched on what is not saturated, the
// stripe and its halo are painted over, and several detectors and scales are tried, the first complete board
// wins.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/profile/stripe_image.h"

namespace seamwright {

enum class BoardPattern { chessboard, circles, charuco };

// chessboard: columns x rows inner corners, pitch = edge of a square. circles: columns x rows dots, pitch =
// distance of neighbours. charuco: columns x rows squares, pitch = edge of a square, markers of marker_mm
// from the predefined ArUco dictionary (OpenCV's number; 0 = 4x4_50).
struct BoardSpec {
    BoardPattern pattern = BoardPattern::chessboard;
    int columns = 0, rows = 0;
    double pitch_mm = 0;
    double marker_mm = 0;
    int dictionary = 0;
};

// Error: counts below 3 or above 200, pitch not positive or beyond 1 m; a pitch below 0.2 mm is taken for
// metres and said so.
Expected<void> validate(const BoardSpec& spec);

// Target frame: origin at point (0, 0), x along the columns, y along the rows, z = 0 and into the plate
// (right-handed), the points in the order of `index` = row * columns + column.
struct FoundBoard {
    std::vector<Eigen::Vector2d> pixel;
    std::vector<Eigen::Vector3d> object_mm;
    std::vector<int> index;
    // Turns of the plate that look alike in an image: 1 = none, 2 = half turns, 4 = quarter turns.
    int symmetry = 1;
    std::string detector;  // which attempt found it
};

// `thorough` is for images that nobody can take again: a chessboard that is cut off may cost a minute.
// `quick` is for a person who stands at the camera and can move the board or the lamp: a moment when the
// board is there, a second or two at 1.3 megapixels when it is not.
enum class BoardEffort { thorough, quick };

// nullopt: no complete board (ChArUco: fewer than 6 corners). Never throws; damaged images are "not found".
std::optional<FoundBoard> find_board(const StripeImage& image, const BoardSpec& spec,
                                     BoardEffort effort = BoardEffort::thorough);

// The same board with its indices turned by `quarter_turns` quarter turns (only half turns when columns !=
// rows): the alternative reading of a symmetric board.
FoundBoard turned(const FoundBoard& board, const BoardSpec& spec, int quarter_turns);

// Polygon (pixel) of the printed board with its outer ring of squares, by the board's homography.
std::vector<Eigen::Vector2d> outline(const FoundBoard& board, const BoardSpec& spec);

}  // namespace seamwright
