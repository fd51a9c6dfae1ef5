// URScript of a project.

#include "devices/ur/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <map>

#include "devices/exchange/settings.h"
#include "devices/ur/module.h"
#include "devices/ur/rtde.h"
#include "ur_resources.h"

namespace seamwright {
namespace {

constexpr double kFastest_m_s = 2.0;
constexpr std::size_t kLongestName = 40;
constexpr double kMostBlend_mm = 20, kLeastBlend_mm = 1;  // at points on the way

// How far before the middle of three points the robot may begin to round it off: blends that overlap are
// refused by the controller.
double blend_mm(double most, const Pose& before, const Pose& at, const Pose& after) {
    return std::min({most, 0.4 * distance_mm(before, at), 0.4 * distance_mm(at, after)});
}

std::string script_pose(const Pose& pose) {
    const auto v = ur::ur_pose(pose);
    return fmt::format("p[{:.7f}, {:.7f}, {:.7f}, {:.8f}, {:.8f}, {:.8f}]", v[0], v[1], v[2], v[3], v[4],
                       v[5]);
}

Expected<void> check_pose(const Pose& pose, const Text& where) {
    if (pose.matrix().allFinite() && pose.translation().cwiseAbs().maxCoeff() <= 1e5) return {};
    return input_error("a pose is not finite or beyond 100 m", where);
}

// `text` with its @NAME@ replaced, in one pass: what is put in may hold such signs itself.
std::string filled(std::string_view text, const std::map<std::string, std::string, std::less<>>& values) {
    std::string out;
    while (!text.empty()) {
        const std::size_t at = text.find('@');
        out += text.substr(0, at);
        if (at == std::string_view::npos) break;
        text.remove_prefix(at + 1);
        const std::size_t end = text.find('@');
        const auto value = values.find(text.substr(0, end));
        assert(end != std::string_view::npos && value != values.end());  // our own file
        out += value->second;
        text.remove_prefix(end + 1);
    }
    return out;
}

}  // namespace

Expected<std::vector<ProgramFile>> write_ur_program(const ProgramRequest& request) {
    if (request.moves.size() > ur::kMostSpots)
        return input_error(Text("{} spots are more than the module holds", request.moves.size()),
                           request.project, Text("measure at most {} in one program", ur::kMostSpots));
    const auto by_number = frames_by_number(request.frames);
    if (by_number.size() > ur::kMostFrames)
        return input_error(Text("{} frames are more than the module holds", by_number.size()),
                           request.project, Text("give at most {}", ur::kMostFrames));
    int first = ur::kFirstRegister, output = 0;
    SettingsReader f(request.settings, "settings", ur_rtde_settings(), UnknownSettings::passed_over);
    f.whole("first_register", first);
    f.whole("trigger_output", output);
    if (f.failed()) return tl::unexpected(f.error());

    std::string passes;
    int n = 0;
    const Pose* last = nullptr;  // where the robot comes from; unknown before the first spot
    for (const MeasuringMove& move : request.moves) {
        const Text where("spot {}", move.spot_id);
        if (!(move.speed_mm_s > 0 && move.speed_mm_s <= 1000 * kFastest_m_s))
            return input_error(Text("{} mm/s is no speed for measuring", move.speed_mm_s), where,
                               "give up to 2000 mm/s");
        for (const Pose* pose : {&move.entry, &move.trigger, &move.exit}) SEAM_OK(check_pose(*pose, where));
        passes += fmt::format("    # spot {}\n", program_comment(move.spot_id));
        for (std::size_t i = 0; i < move.via.size(); ++i) {
            const Pose& at = move.via[i];
            SEAM_OK(check_pose(at, where));
            double blend = last ? blend_mm(kMostBlend_mm, *last, at,
                                           i + 1 < move.via.size() ? move.via[i + 1] : move.entry)
                                : 0;
            if (blend < kLeastBlend_mm) blend = 0;
            passes +=
                fmt::format("    movel({}, a=1.2, v=sw_travel, r={:.5f})\n", script_pose(at), blend / 1000);
            last = &at;
        }
        if (move.stop_at_trigger && move.stand_s != kStand_s)
            passes += fmt::format("    sw_stand = {:.3g}\n", move.stand_s);
        // The speed is kept over the spot.
        passes += fmt::format("    sw_pass({}, {}, {}, {}, {:.4f}, {:.5f}, {})\n", ++n,
                              script_pose(move.entry), script_pose(move.trigger), script_pose(move.exit),
                              move.speed_mm_s / 1000, blend_mm(2, move.entry, move.trigger, move.exit) / 1000,
                              move.stop_at_trigger ? "True" : "False");
        last = &move.exit;
    }
    std::map<std::int32_t, std::string> names = {{0, ""}};  // of a number that no frame has
    std::vector<std::string> numbers, frames;
    std::string list;
    const auto constants = frame_constants(request.frames, "sw_", kLongestName, resources::seamwright_script);
    for (const ApplicationFrame* numbered : by_number) {
        if (!numbered) {
            numbers.emplace_back("0");
            frames.push_back(script_pose(Pose::Identity()));
            continue;
        }
        const ApplicationFrame& frame = *numbered;
        const Text where("frame of region {}", frame.region_id);
        SEAM_OK(check_pose(frame.base_from_frame, where));
        const auto [at, fresh] = names.emplace(ur::frame_number(frame.name), frame.name);
        if (!fresh)
            return input_error(
                Text("\"{}\" and \"{}\" are one frame to the controller", at->second, frame.name), where,
                "name one of them otherwise");
        numbers.push_back(std::to_string(at->first));
        frames.push_back(script_pose(frame.base_from_frame));
        const std::string& constant = constants[static_cast<std::size_t>(numbered - request.frames.data())];
        list += fmt::format("# sw_activate({0}): region {1}, frame {2}\nglobal {0} = {3}\n", constant,
                            program_comment(frame.region_id), program_comment(frame.name), frames.size());
    }
    const std::size_t count = frames.size();
    if (count == 0) numbers = {"0"}, frames = {script_pose(Pose::Identity())};  // URScript has no empty list
    const auto [high, low] = ur::signature_numbers(program_signature(request.moves));
    const std::vector<std::string> spots(std::max<std::size_t>(1, request.moves.size()),
                                         "p[0, 0, 0, 0, 0, 0]");
    const std::string project = fmt::format(
        "# project {}\n{}global sw_type = \"{}\"\nglobal sw_signature_high = {}\nglobal sw_signature_low = "
        "{}\nglobal sw_frame_count "
        "= {}\n"
        "global sw_spot_count = {}\n"
        "global sw_names = [{}]\nglobal sw_frames = [{}]\nglobal sw_spot_at = [{}]\n",
        program_comment(request.project), list, request.part_type, high, low, count, n,
        fmt::join(numbers, ", "), fmt::join(frames, ", "), fmt::join(spots, ", "));
    return std::vector<ProgramFile>{
        {"seamwright.script",
         filled(resources::seamwright_script, {{"ALPHABET", std::string(ur::part_alphabet())},
                                               {"FIRST", std::to_string(first)},
                                               {"TRIGGER_OUT", std::to_string(output)},
                                               {"PROJECT", project},
                                               {"PASSES", passes},
                                               {"MODULE", std::to_string(ur::kModuleVersion)}})}};
}

Expected<std::vector<ProgramFile>> write_ur_path(const PathProgramRequest& request) {
    SEAM_OK(check_path_program(request));
    const std::vector<Pose>& points = request.frame_from_tool;
    std::string text = fmt::format(
        "# {}\n# the TCP is the caller's; bring the robot before the first point\n"
        "def {}():\n  local sw_path_frame = {}\n  local sw_path_speed = {:.4f}\n",
        program_comment(request.comment), request.name, script_pose(request.base_from_frame),
        request.speed_mm_s / 1000);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double radius = i > 0 && i + 1 < points.size()
                                  ? blend_mm(request.rounding_mm, points[i - 1], points[i], points[i + 1])
                                  : 0;
        text += fmt::format("  movel(pose_trans(sw_path_frame, {}), a=1.2, v=sw_path_speed, r={:.5f})\n",
                            script_pose(points[i]), radius / 1000);
    }
    return std::vector<ProgramFile>{{request.name + ".script", text + "end\n"}};
}

}  // namespace seamwright
