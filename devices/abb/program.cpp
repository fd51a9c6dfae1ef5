// RAPID of a project.

#include "devices/abb/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "abb_resources.h"
#include "core/geometry/notation.h"
#include "devices/abb/egm.h"
#include "devices/abb/rapid.h"
#include "devices/abb/rapid_message.h"
#include "devices/exchange/settings.h"
#include "devices/robot_words.h"

namespace seamwright {
namespace {

constexpr std::size_t kMostSpots = 64, kMostFrames = 32;  // arrays of the modules
constexpr double kFastest_mm_s = 2000;
constexpr int kEgmSample_ms = 4;

std::string rapid_pose(const Pose& pose) {
    const Eigen::Vector3d& t = pose.translation();
    const AbbQuaternion q = abb_from_rotation(pose.linear());
    return fmt::format("[{:.4f},{:.4f},{:.4f}],[{:.8f},{:.8f},{:.8f},{:.8f}]", t.x(), t.y(), t.z(), q.w, q.x,
                       q.y, q.z);
}

std::string robtarget(const std::string& name, const Pose& pose) {
    return fmt::format(
        "    LOCAL CONST robtarget {}:=\n        [{},\n        "
        "[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];\n",
        name, rapid_pose(pose));
}

std::string folded(std::string name) {  // RAPID does not tell capital letters apart
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    return name;
}

constexpr std::string_view kPathName =
    "seamwright_path";  // no module's of ours; a path's where nobody says another

// The module's names begin with sw or with s and the spot's number; what RAPID defines by number.
bool is_taken_name(const std::string& name) {
    const std::string text = folded(name);
    const bool numbered = (text[0] == 'v' || text[0] == 'z') && text.size() > 1 &&
                          text.find_first_not_of("0123456789", 1) == std::string::npos;
    const bool spot =
        text[0] == 's' && text.size() > 3 && std::isdigit(static_cast<unsigned char>(text[1])) != 0;
    return is_robot_word(RobotLanguage::rapid, name) || numbered || spot || text.starts_with("sw") ||
           text.starts_with("err_") || text.starts_with("op_") ||
           (text.starts_with("seamwright") && text != kPathName);
}

Expected<void> check_name(const std::string& name, const char* what, const Text& where) {
    if (!abb::is_rapid_identifier(name))
        return input_error(Text("\"{}\" is no name of a {}", name, what), where,
                           "use a letter, then letters, digits and _, at most 32 characters");
    if (is_taken_name(name))
        return input_error(Text("\"{}\" is a word of RAPID itself or of Seamwright's modules", name), where,
                           "choose another name");
    return {};
}

// What the moves carry: the load of a tool that the controller has, or numbers.
struct Load {
    std::string tool;
    bool stated = false;
    double mass_kg = 0.001;
    Eigen::Vector3d centre_mm{0, 0, 0.001}, inertia_kgm2{0, 0, 0};
};
Expected<Load> load_from(const nlohmann::json& settings) {
    Load load;
    SettingsReader f(settings, "settings", abb_rapid_settings(), UnknownSettings::passed_over);
    f.text("tool", load.tool);
    bool numbers = false;
    f.object("load", [&](SettingsReader& r) {
        numbers = true;
        r.number("mass_kg", load.mass_kg);
        for (auto [key, value] : {std::pair<const char*, Eigen::Vector3d*>{"centre_mm", &load.centre_mm},
                                  {"inertia_kgm2", &load.inertia_kgm2}}) {
            if (r.failed() || !r.json().contains(key)) continue;
            auto read = json_vector3(r.json(), key, "settings.load");
            r.keep(read ? Expected<void>() : tl::make_unexpected(read.error()));
            if (read) *value = *read;
        }
    });
    if (f.failed()) return tl::unexpected(f.error());
    load.stated = numbers || !load.tool.empty();
    if (!load.tool.empty() && numbers)
        return input_error("the load is that of a tool or given in numbers", "settings",
                           "give \"tool\" or \"load\"");
    if (load.inertia_kgm2.minCoeff() < 0 || load.centre_mm.cwiseAbs().maxCoeff() > 1e4)
        return input_error("a load of this centre or inertia cannot be", "settings.load");
    if (!load.tool.empty()) SEAM_OK(check_name(load.tool, "tool", "settings.tool"));
    return load;
}

std::string load_lines(const Load& load) {
    const auto& c = load.centre_mm;
    const auto& i = load.inertia_kgm2;
    return fmt::format(
        "    ! The flange as tool, and what hangs on it{}\n    PERS tooldata "
        "swTool:=[TRUE,[[0,0,0],[1,0,0,0]],\n        "
        "[{:.3f},[{:.3f},{:.3f},{:.3f}],[1,0,0,0],{:.5f},{:.5f},{:.5f}]];\n",
        !load.stated        ? ": not stated, give the robot's setting \"tool\" or \"load\""
        : load.tool.empty() ? ""
                            : ": see SW_Load",
        load.mass_kg, c.x(), c.y(), c.z(), i.x(), i.y(), i.z());
}

Expected<void> check_pose(const Pose& pose, const Text& where) {
    if (pose.matrix().allFinite() && pose.translation().cwiseAbs().maxCoeff() <= 1e5) return {};
    return input_error("a pose is not finite or beyond 100 m", where);
}

std::string plain(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return text.substr(0, 60);
}

std::string filled(std::string_view text, const std::vector<std::pair<std::string, std::string>>& values) {
    std::string out(text);
    for (const auto& [name, value] : values)
        if (const std::size_t at = out.find("@" + name + "@"); at != std::string::npos)
            out.replace(at, name.size() + 2, value);
    return out;
}

// The measuring driver's program, with the settings in "measuring", and the module of EGM.
Expected<std::vector<ProgramFile>> write_egm_program(const ProgramRequest& request) {
    int cycle_ms = 0;
    SettingsReader f(request.settings, "settings", abb_egm_settings(), UnknownSettings::passed_over);
    f.whole("cycle_ms", cycle_ms);
    if (f.failed()) return tl::unexpected(f.error());
    if (cycle_ms % kEgmSample_ms != 0)
        return input_error(Text("EGM has no sample rate of {} ms", cycle_ms), "settings.cycle_ms",
                           "give a multiple of 4");
    ProgramRequest measuring = request;
    measuring.driver.clear();
    measuring.settings = nlohmann::json::object();
    if (request.settings.contains("measuring") && request.settings["measuring"].is_object())
        measuring.settings = request.settings["measuring"].value("settings", nlohmann::json::object());
    auto files = write_abb_program(measuring);
    if (!files) return files;
    std::string text(resources::SeamwrightEgm_mod);
    constexpr std::string_view kRate = "SampleRate:=48";
    text.replace(text.find(kRate), kRate.size(), fmt::format("SampleRate:={}", cycle_ms));
    files->push_back({"SeamwrightEgm.mod", text});
    return files;
}

}  // namespace

Expected<std::vector<ProgramFile>> write_abb_program(const ProgramRequest& request) {
    if (request.driver == "abb-egm") return write_egm_program(request);
    if (request.moves.size() > kMostSpots)
        return input_error(Text("{} spots are more than the module holds", request.moves.size()),
                           request.project, Text("measure at most {} in one program", kMostSpots));
    if (request.frames.size() > kMostFrames)
        return input_error(Text("{} frames are more than the module holds", request.frames.size()),
                           request.project, Text("give at most {}", kMostFrames));
    std::string address = "192.168.125.1";
    int port = 1025;
    SettingsReader f(request.settings, "settings", abb_rapid_settings(), UnknownSettings::passed_over);
    f.text("address", address);
    f.whole("port", port);
    if (f.failed()) return tl::unexpected(f.error());
    SEAM_TRY(const auto load, load_from(request.settings));
    if (address.empty() || address.find_first_not_of("0123456789.") != std::string::npos)
        return input_error(Text("\"{}\" is no address", address), "settings.address",
                           "give it as four numbers");

    std::string targets, names, passes;
    int n = 0;
    for (const MeasuringMove& move : request.moves) {
        const Text where("spot {}", move.spot_id);
        if (!abb::is_spot_name(move.spot_id))
            return input_error(Text("\"{}\" cannot be written in RAPID", move.spot_id), where,
                               "use at most 32 characters without blanks, quotes and backslashes");
        if (!(move.speed_mm_s > 0 && move.speed_mm_s <= kFastest_mm_s))
            return input_error(Text("{} mm/s is no speed for measuring", move.speed_mm_s), where,
                               "give up to 2000 mm/s");
        std::vector<const Pose*> poses = {&move.entry, &move.trigger, &move.exit};
        for (const Pose& pose : move.via) poses.push_back(&pose);
        for (const Pose* pose : poses) SEAM_OK(check_pose(*pose, where));
        const std::string point = fmt::format("s{:02}", ++n);
        targets += fmt::format("    ! spot {}\n", move.spot_id) + robtarget(point + "_entry", move.entry) +
                   robtarget(point + "_spot", move.trigger) + robtarget(point + "_exit", move.exit) +
                   fmt::format("    LOCAL CONST speeddata {}_speed:=[{:.3f},100,5000,1000];\n", point,
                               move.speed_mm_s);
        for (std::size_t i = 0; i < move.via.size(); ++i) {
            const std::string via = fmt::format("{}_via{}", point, i + 1);
            targets += robtarget(via, move.via[i]);
            passes += fmt::format("        SW_Via {};\n", via);
        }
        names += fmt::format("{}\"{}\"", n == 1 ? "" : n % 4 == 1 ? ",\n        " : ",", move.spot_id);
        if (move.stop_at_trigger && move.stand_s != kStand_s)
            passes += fmt::format("        swStand:={:.3g};\n", move.stand_s);
        passes += fmt::format("        SW_Pass {},{}_entry,{}_spot,{}_exit,{}_speed,{};\n", n, point, point,
                              point, point, move.stop_at_trigger ? "TRUE" : "FALSE");
    }
    for (std::size_t i = request.moves.size(); i < kMostSpots; ++i)
        names += i == 0 ? "\"\"" : i % 16 == 0 ? ",\n        \"\"" : ",\"\"";
    std::string objects;
    std::set<std::string> known;
    for (const ApplicationFrame& frame : request.frames) {
        const Text where("frame of region {}", frame.region_id);
        SEAM_OK(check_name(frame.name, "work object", where));
        if (!known.insert(folded(frame.name)).second)
            return input_error(Text("two regions have the work object \"{}\"", frame.name), where,
                               "name one of them otherwise");
        SEAM_OK(check_pose(frame.base_from_frame, where));
        objects += fmt::format(
            "    ! region {}\n    PERS wobjdata {}:=[FALSE,TRUE,\"\",[[0,0,0],[1,0,0,0]],\n        [{}]];\n",
            plain(frame.region_id), frame.name, rapid_pose(frame.base_from_frame));
    }
    const std::string spots = fmt::format(
        "MODULE SeamwrightSpots\n    ! Measuring program of {}\n    PERS string swSignature:=\"{}\";\n    "
        "! The part type that it measures, told with the call for a part\n    PERS string swType:=\"{}\";\n  "
        "  "
        "PERS num "
        "swCount:={};\n    PERS string swSpotName{{64}}:=[\n        {}];\n{}{}{}\n    PROC SW_Load()\n{}    "
        "ENDPROC\n\n"
        "    PROC SW_Spots()\n{}    ENDPROC\nENDMODULE\n",
        plain(request.project), program_signature(request.moves), plain(request.part_type),
        request.moves.size(), names, load_lines(load), objects, targets,
        !load.stated
            ? "        TPWrite \"Seamwright: the load is not stated, the moves run as without one\";\n"
        : load.tool.empty() ? std::string()
                            : fmt::format("        swTool.tload:={}.tload;\n", load.tool),
        passes);
    return std::vector<ProgramFile>{
        {"SeamwrightServer.mod",
         filled(resources::SeamwrightServer_mod, {{"ADDRESS", address}, {"PORT", std::to_string(port)}})},
        {"Seamwright.mod", std::string(resources::Seamwright_mod)},
        {"SeamwrightSpots.mod", spots}};
}

Expected<std::vector<ProgramFile>> write_abb_path(const PathProgramRequest& request) {
    SEAM_OK(check_path_program(request));
    SEAM_OK(check_name(request.name, "program", "name"));
    static const std::set<std::string> own = {"frame", "speed", "rounding",
                                              "point", "tool",  "i"};  // of the module
    if (own.count(folded(request.name)) > 0)
        return input_error(Text("\"{}\" is a word of RAPID itself or of Seamwright's modules", request.name),
                           "name", "choose another name");
    const std::size_t count = request.frame_from_tool.size();
    std::string points;
    for (std::size_t i = 0; i < count; ++i)
        points += fmt::format("        [{},[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]]{}\n",
                              rapid_pose(request.frame_from_tool[i]), i + 1 < count ? "," : "];");
    const double zone = request.rounding_mm;
    const std::string rounding = zone > 0
                                     ? fmt::format("[FALSE,{0:.2f},{1:.2f},{1:.2f},{2:.3f},{1:.2f},{2:.3f}]",
                                                   zone, 1.5 * zone, 0.15 * zone)
                                     : "[FALSE,0.3,0.3,0.3,0.03,0.3,0.03]";
    // A loop of RAPID counts down where it begins above its end: a single point has none.
    const std::string loop = count < 2 ? std::string()
                                       : fmt::format(
                                             "        FOR i FROM 1 TO {} DO\n            MoveL "
                                             "point{{i}},speed,rounding,tool\\WObj:=frame;\n        ENDFOR\n",
                                             count - 1);
    const std::string text = fmt::format(
        "MODULE {0}\n    ! {1}\n    LOCAL PERS wobjdata frame:=[FALSE,TRUE,\"\",[{2}],\n        "
        "[[0,0,0],[1,0,0,0]]];\n    LOCAL CONST speeddata speed:=[{3:.3f},100,5000,1000];\n    LOCAL CONST "
        "zonedata rounding:={4};\n    LOCAL CONST robtarget point{{{5}}}:=[\n{6}    ! bring the robot before "
        "the first point\n    PROC {0}_run(PERS tooldata tool)\n        ConfL\\Off;\n{7}        MoveL "
        "point{{{5}}},speed,fine,tool\\WObj:=frame;\n        ConfL\\On;\n    ENDPROC\nENDMODULE\n",
        request.name, program_comment(request.comment), rapid_pose(request.base_from_frame),
        request.speed_mm_s, rounding, count, points, loop);
    return std::vector<ProgramFile>{{request.name + ".mod", text}};
}

}  // namespace seamwright
