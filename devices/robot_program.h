#pragma once
// What a brand's generator makes of a project: the measuring program and the application frames, as files for
// the controller.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "devices/robot_link.h"

namespace seamwright {

struct ApplicationFrame {
    std::string region_id;
    std::string name;  // on the controller, as RobotLink::write_frame wants it
    Pose base_from_frame = Pose::Identity();
    int number = 0;  // by which the program knows it, from 1; 0: the next
};

struct ProgramRequest {
    std::string project;
    std::vector<MeasuringMove> moves;  // in the order of measuring
    std::vector<ApplicationFrame> frames;
    nlohmann::json settings = nlohmann::json::object();  // of the project's robot: addresses, ports, numbers
    std::string driver = {};                             // of the project's robot
    std::string part_type =
        {};  // id of the part type whose moves these are, told with the start signal; empty: none
};

struct ProgramFile {
    std::string name;  // without folder
    std::string text;
};

// A path of linear motions, to be called by the application with its own tool active.
struct PathProgramRequest {
    std::string name = "seamwright_path";     // of the program and its file
    std::string comment;                      // one line: what it is
    Pose base_from_frame = Pose::Identity();  // the points' frame
    std::vector<Pose> frame_from_tool;        // in the order of the path
    double speed_mm_s = 100;
    double rounding_mm =
        2;  // how far from a point the robot may begin to round it off; 0 = exactly through it
};
// Error (input): a name that check_program_name refuses (robot_words.h), no point or more than
// kMostPathPoints, poses that are not finite or beyond 100 m, a speed over 2 m/s.
inline constexpr std::size_t kMostPathPoints = 5000;
Expected<void> check_path_program(const PathProgramRequest& request);
// `text` as a comment may hold it: one line of ASCII.
std::string program_comment(std::string text);

// The frames by their numbers: the first is number 1, nullptr a number that no frame has.
std::vector<const ApplicationFrame*> frames_by_number(const std::vector<ApplicationFrame>& frames);
// A name for the number of each frame, of letters, digits and _: `prefix` and the frame's, at most `longest` signs. None is
// that of another or a word of `module`, capitals or not.
std::vector<std::string> frame_constants(const std::vector<ApplicationFrame>& frames,
                                         const std::string& prefix, std::size_t longest,
                                         std::string_view module);

// Tells one measuring program from another: names, order, via points and poses (to 0.001 mm and 0.0001
// degree) of its spots, their speed (to 0.1 mm/s), where the robot stands at them, and the numbers and names of the frames that
// they are measured for, as "SW-" and 16 hexadecimal digits. The controller holds the one of its program and
// compares it at the start of measuring.
std::string program_signature(const std::vector<MeasuringMove>& moves);

}  // namespace seamwright
