#pragma once
// Folders of plate images, as the camera and stripe-camera commands read them.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/calibration/board/board.h"
#include "core/error.h"

namespace seamwright {

// Called after each image of a folder.
using ReadProgress = std::function<void(int done, int total)>;

// A board in words, as a person gives it.
struct BoardWords {
    std::string counts;  // "7x6": columns x rows
    double pitch_mm = 0;
    std::string pattern = "chessboard";  // name_of(BoardPattern)
    double marker_mm = 0;                // 0: not given
    std::string dictionary = {};         // "4x4_50", ...; empty: what fits
    std::string legacy = {};             // "yes", "no"; empty: what fits
};
Expected<BoardSpec> parse_board(const BoardWords& words);

// Image files of a folder by name, the excluded ids (names without extension) left out. Error (file): no
// folder; (input): no image in it, an excluded id that is not there, two images of one name.
Expected<std::vector<std::filesystem::path>> plate_images(const std::filesystem::path& folder,
                                                          const std::vector<std::string>& exclude);

}  // namespace seamwright
