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

// "7x6" -> columns and rows; "chessboard" | "circles" | "charuco" -> pattern.
Expected<BoardSpec> parse_board(const std::string& counts, double pitch_mm, const std::string& pattern);

// Image files of a folder by name, the excluded ids (names without extension) left out. Error (file): no
// folder; (input): no image in it, an excluded id that is not there, two images of one name.
Expected<std::vector<std::filesystem::path>> plate_images(const std::filesystem::path& folder,
                                                          const std::vector<std::string>& exclude);

}  // namespace seamwright
