#include "devices/robot_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

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
        add(fmt::format("{:.4f} m/s", move.speed_mm_s / 1000));
        if (move.stop_at_trigger) add(fmt::format("stands {:.2f}", move.stand_s));
        for (const NumberedFrame& frame : move.frames)
            add(fmt::format("frame {} {}", frame.number, frame.name));
    }
    return fmt::format("SW-{:016X}", hash);
}

std::vector<const ApplicationFrame*> frames_by_number(const std::vector<ApplicationFrame>& frames) {
    std::vector<const ApplicationFrame*> by_number;
    for (const ApplicationFrame& frame : frames) {
        const std::size_t number =
            frame.number > 0 ? static_cast<std::size_t>(frame.number) : by_number.size() + 1;
        by_number.resize(std::max(number, by_number.size()));
        by_number[number - 1] = &frame;
    }
    return by_number;
}

std::vector<std::string> frame_constants(const std::vector<ApplicationFrame>& frames,
                                         const std::string& prefix, std::size_t longest,
                                         std::string_view module) {
    const auto letter = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    };
    const auto folded = [](std::string text) {
        for (char& c : text)
            if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
        return text;
    };
    std::set<std::string> taken;
    std::string word;
    for (const char c : module) {
        if (letter(c)) {
            word += c;
        } else if (!word.empty()) {
            taken.insert(folded(std::exchange(word, {})));
        }
    }
    std::vector<std::string> names;
    for (const ApplicationFrame& frame : frames) {
        std::string name = prefix + frame.name;
        std::replace_if(
            name.begin(), name.end(), [&](char c) { return !letter(c); }, '_');
        name.resize(std::min(name.size(), longest));
        const std::string stem = name;
        for (int i = 2; !taken.insert(folded(name)).second; ++i) {
            const std::string tail = fmt::format("_{}", i);
            name = stem.substr(0, longest - tail.size()) + tail;
        }
        names.push_back(name);
    }
    return names;
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
