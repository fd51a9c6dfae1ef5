#pragma once
// The numbers of poses before they are poses: their form, their units, and what refuses them. What pose_table.h and
// json_poses.h have in common.

#include <string>
#include <vector>

#include "devices/exchange/tables/pose_table.h"

namespace seamwright {

struct WrittenRow {
    std::string at;
    // 3 of the position, then those of the rotation; or 12 or 16 of a matrix.
    std::vector<double> numbers;
};

struct PoseForm {
    std::string convention;  // of kPoseConventions; empty: not known
    double mm = 0;           // of a unit of length; 0: not known
    double rad = 0;          // of a unit of angle; 0: not known
};

// What the person says. Error (usage): words that are none.
Expected<PoseForm> pose_form(const PoseLayout& layout);
// Error (input), by the option's name: the person says another than the file's notation, so that it could not act.
Expected<void> check_said(const PoseLayout& layout, const WrittenNotation& notation,
                          const std::string& where);
// Error (input): rows of `width` numbers are no pose of that form, or several.
Expected<void> check_width(PoseForm& form, std::size_t width, const std::string& where);
// Units that nobody named: usual ones. Error (input): the numbers speak against them.
Expected<void> settle_units(PoseForm& form, const std::vector<WrittenRow>& rows, const std::string& where);
// Error (input): a rotation that is none, a position beyond 100 m.
Expected<Pose> pose_of(const PoseForm& form, const WrittenRow& row);
// From the tool in the frame that the layout names to the flange in the robot's base.
Pose brought_to_flange(const Pose& pose, const PoseLayout& layout);

}  // namespace seamwright
