// KRL of a project: the fixed module of resources/robot/kuka and the spots.

#include <fmt/format.h>

#include <algorithm>

#include "core/geometry/notation.h"
#include "devices/exchange/settings.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/program.h"
#include "devices/kuka/rsi_program.h"
#include "kuka_resources.h"

namespace seamwright {
namespace {

constexpr std::size_t kMostSpots = 64, kMostFrames = 32, kLongestName = 79;  // arrays of seamwright.dat
constexpr std::size_t kLongestKrlName = 24;
constexpr const char* kNoFrame = "-";  // the name of a number that no frame has
constexpr double kFastestCp = 2.0;     // m/s

Expected<void> krl_text(const std::string& text, const std::string& where) {
    const bool plain = std::all_of(text.begin(), text.end(),
                                   [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; });
    if (text.empty() || text.size() > kLongestName || !plain)
        return input_error(Text("\"{}\" cannot be written in KRL", text), where,
                           "use 1 to 79 plain letters, digits and signs without quotes");
    return {};
}

std::string krl_frame(const Pose& pose) {
    const KukaAbc abc = kuka_from_rotation(pose.linear());
    const Eigen::Vector3d& p = pose.translation();
    return fmt::format("{{X {:.4f},Y {:.4f},Z {:.4f},A {:.5f},B {:.5f},C {:.5f}}}", p.x(), p.y(), p.z(),
                       abc.a_deg, abc.b_deg, abc.c_deg);
}

std::string xml_text(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    return out;
}

std::string filled(std::string_view text, const std::vector<std::pair<std::string, std::string>>& values) {
    std::string out(text);
    for (const auto& [name, value] : values)
        for (std::size_t at; (at = out.find("@" + name + "@")) != std::string::npos;)
            out.replace(at, name.size() + 2, value);
    return out;
}

}  // namespace

const SettingTable& kuka_program_settings() {
    static const SettingTable table = {
        entry::whole("trigger_output", 1, 1, 8192, "output that fires the sensor, for the program"),
        entry::whole("flag_alive", 1, 1, 1024, "flag of EthernetKRL's connection, for the program"),
        entry::whole("flag_command", 2, 1, 1024, "flag of EthernetKRL's commands, for the program")};
    return table;
}

Expected<std::vector<ProgramFile>> write_kuka_program(const ProgramRequest& request) {
    if (request.driver == "kuka-rsi") return write_rsi_program(request);
    if (request.moves.size() > kMostSpots)
        return input_error(Text("{} spots are more than the module holds", request.moves.size()),
                           request.project, Text("measure at most {} in one program", kMostSpots));
    const auto frames = frames_by_number(request.frames);
    if (frames.size() > kMostFrames)
        return input_error(Text("{} frames are more than the module holds", frames.size()), request.project,
                           Text("give at most {}", kMostFrames));
    std::string listen;
    int port = 0, output = 0, alive = 0, command = 0;
    SettingsReader f(request.settings, "settings", kuka_eki_settings(), UnknownSettings::passed_over);
    f.text("listen", listen);
    f.whole("port", port);
    f.whole("trigger_output", output);
    f.whole("flag_alive", alive);
    f.whole("flag_command", command);
    if (f.failed()) return tl::unexpected(f.error());

    if (port == 0)
        return input_error("a controller connects to no port 0", "settings.port", "give 1 to 65535");
    if (listen == "0.0.0.0" || listen.empty() || listen.find_first_not_of("0123456789.") != std::string::npos)
        return input_error(Text("\"{}\" is no address that a controller connects to", listen),
                           "settings.listen", "give this computer's address in the robot's network");
    if (alive == command)
        return input_error("flag_alive and flag_command are one flag", "settings", "give two");

    std::string data = "DEFDAT SEAMWRIGHT_SPOTS PUBLIC\n", setup, path;
    int n = 0;
    for (const MeasuringMove& move : request.moves) {
        ++n;
        SEAM_OK(krl_text(move.spot_id, "spot"));
        const double cp = move.speed_mm_s / 1000;
        if (!(cp > 0 && cp <= kFastestCp))
            return input_error(Text("{} mm/s is no speed for measuring", move.speed_mm_s),
                               Text("spot {}", move.spot_id), "give up to 2000 mm/s");
        std::vector<const Pose*> poses = {&move.entry, &move.trigger, &move.exit};
        for (const Pose& via : move.via) poses.push_back(&via);
        for (const Pose* pose : poses)
            if (!pose->matrix().allFinite() || pose->translation().cwiseAbs().maxCoeff() > 1e5)
                return input_error("a pose is not finite or beyond 100 m", Text("spot {}", move.spot_id));
        const std::string point = fmt::format("XSW_{:03}", n);
        data += fmt::format(
            "; spot {}\nDECL FRAME {}_ENTRY={}\nDECL FRAME {}_SPOT={}\nDECL FRAME {}_EXIT={}\n", move.spot_id,
            point, krl_frame(move.entry), point, krl_frame(move.trigger), point, krl_frame(move.exit));
        setup += fmt::format("SW_SPOT[{},]=\"{}\"\n", n, move.spot_id);
        path += fmt::format("; spot {}\n$VEL.CP=SW_TRAVEL\n", move.spot_id);
        for (std::size_t i = 0; i < move.via.size(); ++i) {
            data += fmt::format("DECL FRAME {}_VIA{}={}\n", point, i + 1, krl_frame(move.via[i]));
            path += fmt::format("LIN {}_VIA{} C_DIS\n", point, i + 1);
        }
        path += fmt::format("LIN {}_ENTRY C_DIS\n$VEL.CP={:.4f}\n", point, cp);
        if (move.stop_at_trigger)
            path += fmt::format(
                "LIN {0}_SPOT\nWAIT SEC 0.3\nPULSE($OUT[SW_TRIGGER_OUT],TRUE,0.02)\n"
                "SW_FIRE({1},{0}_SPOT)\nWAIT SEC {2:.3g}\n",
                point, n, move.stand_s);
        else
            path += fmt::format(
                "TRIGGER WHEN PATH=0 DELAY=0 DO PULSE($OUT[SW_TRIGGER_OUT],TRUE,0.02)\n"
                "TRIGGER WHEN PATH=0 DELAY=0 DO SW_FIRE({1},{0}_SPOT) PRIO=-1\n"
                "LIN {0}_SPOT C_DIS\n",
                point, n);
        path += fmt::format("LIN {}_EXIT C_DIS\n", point);
    }
    data += "DECL REAL SW_TRAVEL=0.25\n";
    const auto constants =
        frame_constants(request.frames, "SW_", kLongestKrlName,
                        std::string(resources::seamwright_dat) + std::string(resources::seamwright_src) +
                            std::string(resources::seamwright_sub_sub) + " SW_SETUP SW_TRAVEL ");
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const std::size_t k = i + 1;
        if (!frames[i]) {
            setup += fmt::format("; no region of this program\nSW_NAME[{},]=\"{}\"\n", k, kNoFrame);
            continue;
        }
        const ApplicationFrame& frame = *frames[i];
        SEAM_OK(krl_text(frame.name, "frame of region " + frame.region_id));
        if (frame.name == kNoFrame)
            return input_error(Text("\"{}\" cannot be written in KRL", frame.name),
                               Text("region {}", frame.region_id), "choose another name");
        const std::string& constant = constants[static_cast<std::size_t>(frames[i] - request.frames.data())];
        data += fmt::format("DECL GLOBAL CONST INT {}={}\n", constant, k);
        setup += fmt::format(
            "; region {}: SW_ACTIVATE({}) before its path\nSW_NAME[{},]=\"{}\"\nSW_FRAME[{}]={}\n",
            program_comment(frame.region_id), constant, k, frame.name, k, krl_frame(frame.base_from_frame));
    }
    data += "ENDDAT\n";
    if (!request.part_type.empty()) SEAM_OK(krl_text(request.part_type, "part type"));
    if (!request.part_type.empty()) setup += fmt::format("SW_TYPE[]=\"{}\"\n", request.part_type);
    const std::string signature = program_signature(request.moves);
    setup += fmt::format("SW_FRAMES={}\nSW_SIGNATURE[]=\"{}\"\n", frames.size(), signature);
    const std::string program =
        "&ACCESS RVO1\n&COMMENT Measuring program of " + program_comment(request.project).substr(0, 60) +
        "\nDEF SEAMWRIGHT_SPOTS()\nIF NOT StrComp(SW_SIGNATURE[],\"" + signature +
        "\",#CASE_SENS) THEN\n   SW_SETUP()\nENDIF\nSW_BEGIN_PART()\nBAS(#INITMOV,0)\n"
        "; the points are poses of the flange in the robot's base; the application sets its $TOOL again\n"
        "$IPO_MODE=#BASE\n$BASE=$NULLFRAME\n$TOOL=$NULLFRAME\n$APO.CDIS=5\n" +
        path +
        "WAIT SEC 0\nSW_END_PART(20.0)\nEND\n\n"
        "; Taught frames and names: call it once at the start of the application program.\nGLOBAL DEF "
        "SW_SETUP()\n" +
        setup + "END\n";
    const std::vector<std::pair<std::string, std::string>> values = {
        {"ADDRESS", xml_text(listen)},
        {"PORT", std::to_string(port)},
        {"TRIGGER_OUT", std::to_string(output)},
        {"FLAG_ALIVE", std::to_string(alive)},
        {"FLAG_COMMAND", std::to_string(command)}};
    return std::vector<ProgramFile>{{"Seamwright.xml", filled(resources::Seamwright_xml, values)},
                                    {"seamwright.dat", filled(resources::seamwright_dat, values)},
                                    {"seamwright.src", std::string(resources::seamwright_src)},
                                    {"seamwright_sub.sub", std::string(resources::seamwright_sub_sub)},
                                    {"seamwright_spots.dat", data},
                                    {"seamwright_spots.src", program}};
}

Expected<std::vector<ProgramFile>> write_kuka_path(const PathProgramRequest& request) {
    SEAM_OK(check_path_program(request));
    std::string text = fmt::format(
        "&ACCESS RVO1\n&COMMENT {}\nDEF {}()\n; poses of the caller's $TOOL; bring the robot before the "
        "first "
        "point\n$BASE={}\n$VEL.CP={:.4f}\n$APO.CDIS={:.2f}\n",
        program_comment(request.comment).substr(0, 60), request.name, krl_frame(request.base_from_frame),
        request.speed_mm_s / 1000, request.rounding_mm);
    for (std::size_t i = 0; i < request.frame_from_tool.size(); ++i)
        text +=
            fmt::format("LIN {}{}\n", krl_frame(request.frame_from_tool[i]),
                        request.rounding_mm > 0 && i + 1 < request.frame_from_tool.size() ? " C_DIS" : "");
    return std::vector<ProgramFile>{{request.name + ".src", text + "END\n"}};
}

}  // namespace seamwright
