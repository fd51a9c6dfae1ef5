#pragma once
// How a recording's files are to be understood where they do not say it themselves: units, columns, the
// poses' form. As a whole in the settings of the replayed sensor and robot, under "layout":
//   {"unit","columns","poses","pose_convention","pose_unit","pose_angle","channel"}: texts, all optional;
//   "invalid": [heights, as the files write them, that stand for "no return"]; "flange_from_sensor", "flange_from_tool",
//   "base_from_user_frame": POSE.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "devices/exchange/image_file.h"
#include "devices/exchange/tables/pose_table.h"
#include "devices/exchange/tables/profile_layout.h"

namespace seamwright {

struct RecordedFrame;
struct Frame;

struct RecordingLayout {
    ProfileLayout profile;
    PoseLayout pose;
    std::string
        poses;  // table of all poses, absolute or in the folder; empty: poses.{csv,txt,dat,mod,ls,json} where
                // there is one, else a file beside each frame
    ImageChannel channel = ImageChannel::grey;
    // Points in space (PLY, PCD of a run's export) lie in the robot's base and are brought back into the
    // sensor's plane with it; absent: they are refused.
    std::optional<Pose> flange_from_sensor;
};

// Only what is set. Error (input): unknown fields or words.
nlohmann::json recording_layout_json(const RecordingLayout& layout);
Expected<RecordingLayout> parse_recording_layout(const nlohmann::json& json, const std::string& where);

// A recorded file into `frame`: profile or image. Pose and spot are set too. Error: that of the file.
Expected<void> read_recorded(const RecordedFrame& recorded, const RecordingLayout& layout, int bit_depth,
                             Frame& frame);

}  // namespace seamwright
