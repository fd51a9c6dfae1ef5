#include "devices/robot_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "devices/robot_words.h"

namespace seamwright {

std::string program_signature(const std::vector<MeasuringMove>& moves) {
    std::uint64_t hash = 1469598103934665603u;  // FNV-1a
    const auto add = [&](std::string_view bytes) {
        for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
        hash = (hash ^ 0xffu) * 1099511628211u;  // ends the field
    };
    for (const MeasuringMove& move : moves) {
        add(move.spot_id);
        std::vector<const Pose*> poses = {&move.entry, &move.trigger, &move.exit};
        for (const Pose& pose : move.via) poses.push_back(&pose);
        for (const Pose* pose : poses) {
            // Entries of the rotation matrix in steps of the angle's: sin(1e-4 deg) = 1.7e-6.
            for (int i = 0; i < 3; ++i) add(fmt::format("{}", std::llround(pose->translation()[i] * 1e3)));
            for (int i = 0; i < 9; ++i)
                add(fmt::format("{}", std::llround(pose->linear().data()[i] / 1.7e-6)));
        }
        if (move.stand_s != kStand_s) add(fmt::format("stands {:.2f}", move.stand_s));
    }
    return fmt::format("SW-{:016X}", hash);
}

Expected<void> check_path_program(const PathProgramRequest& request) {
    const std::string& name = request.name;
    SEAM_OK(check_program_name(name, "name"));
    if (request.frame_from_tool.empty() || request.frame_from_tool.size() > kMostPathPoints)
        return input_error(Text("{} points make no path program", request.frame_from_tool.size()), name,
                           Text("give 1 to {}", kMostPathPoints));
    if (!(request.speed_mm_s > 0 && request.speed_mm_s <= 2000))
        return input_error(Text("{} mm/s is no speed of a path", request.speed_mm_s), name,
                           "give up to 2000 mm/s");
    if (!(request.rounding_mm >= 0 && request.rounding_mm <= 100))
        return input_error(Text("{} mm is no distance for rounding off", request.rounding_mm), name,
                           "give 0 to 100 mm");
    const auto bad = [](const Pose& pose) {
        return !pose.matrix().allFinite() || pose.translation().cwiseAbs().maxCoeff() > 1e5;
    };
    if (bad(request.base_from_frame) ||
        std::any_of(request.frame_from_tool.begin(), request.frame_from_tool.end(), bad))
        return input_error("a pose is not finite or beyond 100 m", name);
    return {};
}

std::string program_comment(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return text.substr(0, 79);
}

}  // namespace seamwright
