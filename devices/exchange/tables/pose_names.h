#pragma once
// Which pose of a table belongs to which frame.
//
// A column names the poses where its cells are the frames' names, whatever its title: the file's name or its
// stem, in capitals or not, with blanks, a folder or another extension; or the number that the file's name ends
// in. Names go before numbers, and among equals a column whose title says that it names goes first.

#include <span>
#include <string>
#include <vector>

#include "devices/exchange/tables/pose_table.h"

namespace seamwright {

struct FramePoses {
    std::vector<Pose> poses;  // one a frame
    std::string
        understood;  // "named by the column "Punkt"", or by order, and then which frame takes which line
};

// By order only where no column can hold names, and then there must be as many of both. Error (input): two
// columns that name the poses differently; a column that names some frames and not others, or, where its title
// or its cells (a text of its own for every pose, no time of day) say that it names, none; a frame named twice.
Expected<FramePoses> poses_of_frames(const PoseTable& table, std::span<const std::string> frames,
                                     const std::string& where);

}  // namespace seamwright
