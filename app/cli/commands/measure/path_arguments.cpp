#include "app/cli/commands/measure/path_arguments.h"

#include <fmt/format.h>

#include <charconv>

#include "app/cli/arguments/pose_argument.h"
#include "app/cli/signal_watch.h"
#include "core/geometry/notation.h"
#include "core/profile/units.h"
#include "devices/exchange/pose_json.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

Expected<void> parse_lines(const std::string& text, ProgramPathOptions& options) {
    if (text.empty()) return {};
    const auto dots = text.find("..");
    const auto number = [&](std::string_view s, int& n) {
        const auto [end, problem] = std::from_chars(s.data(), s.data() + s.size(), n);
        return problem == std::errc() && end == s.data() + s.size() && n >= 1;
    };
    const std::string_view all = text;
    if (dots == std::string::npos || !number(all.substr(0, dots), options.first_line) ||
        !number(all.substr(dots + 2), options.last_line) || options.last_line < options.first_line)
        return usage_error(Text("--lines \"{}\" is no range", text), "",
                           "give the first and the last, 20..85");
    return {};
}

json point_json(std::size_t number, const Pose& pose, const std::string& frame) {
    return {{"point", number}, {"frame", frame}, {"pose", pose_json(pose)}};
}
std::string numbers(const Pose& pose) {
    const KukaAbc abc = kuka_from_rotation(pose.linear());
    const Eigen::Vector3d& t = pose.translation();
    const auto shown = [](double v) { return std::abs(v) < 5e-4 ? 0 : v; };  // no -0.000
    return fmt::format("{:>10.3f} {:>10.3f} {:>10.3f} {:>9.3f} {:>8.3f} {:>9.3f}", shown(t.x()), shown(t.y()),
                       shown(t.z()), shown(abc.a_deg), shown(abc.b_deg), shown(abc.c_deg));
}
constexpr const char* kNumbersHead = "      x mm       y mm       z mm     A deg    B deg     C deg";

PathLook look_at_program(const ProgramPath& program) {
    PathLook look;
    json points = json::array(), lines = json::array(), remarks = json::array();
    std::string table;
    std::size_t number = 0;
    for (const ProgramPoint& p : program.points) {
        const std::string frame = p.frame.empty() ? "base" : p.frame;
        json one = point_json(++number, p.frame_from_tool, frame);
        one["line"] = p.line;
        one["file"] = p.file;
        one["name"] = p.name;
        one["motion"] = to_string(p.motion);
        one["base_from_tool"] =
            p.base_from_frame ? pose_json(*p.base_from_frame * p.frame_from_tool) : json();
        points.push_back(std::move(one));
        if (program.points.size() <= 400 || number <= 200 || number + 200 > program.points.size())
            table += fmt::format("{:>6} {:>6}  {:<9} {} {:<16} {}\n", number, p.line, to_string(p.motion),
                                 numbers(p.frame_from_tool), p.name, frame);
        else if (number == 201)
            table += fmt::format("   ... {} more; all with --json\n", program.points.size() - 400);
    }
    std::string notes;
    std::map<LineKind, int> counts;
    for (const ProgramLine& l : program.lines) {
        ++counts[l.kind];
        lines.push_back({{"file", l.file},
                         {"line", l.line},
                         {"text", l.text},
                         {"what", to_string(l.kind)},
                         {"why", l.why.empty() ? json() : json(l.why)},
                         {"points", l.points}});
        const bool told = l.kind == LineKind::not_understood || l.kind == LineKind::left_out ||
                          (l.kind == LineKind::passed_over && !l.why.empty());
        if (told)
            notes += fmt::format("  {}, line {}: {}: {}{}\n", l.file, l.line, to_string(l.kind), l.text,
                                 l.why.empty() ? "" : fmt::format("  ({})", l.why));
    }
    for (const Text& r : program.remarks) remarks.push_back(r);
    look.whole = counts[LineKind::not_understood] == 0;
    look.json = {{"status", look.whole ? "ok" : "not understood"},
                 {"language", to_string(program.language)},
                 {"routine", program.routine},
                 {"tools", program.tools},
                 {"unknown_frames", program.unknown_frames()},
                 {"points", points},
                 {"lines", lines},
                 {"remarks", remarks}};
    look.text =
        fmt::format("{}, routine {}: {} points\n point   line  motion    {} name             frame\n{}",
                    to_string(program.language), program.routine, program.points.size(), kNumbersHead, table);
    for (const std::string& tool : program.tools)
        if (!tool.empty()) look.text += fmt::format("tool: {}\n", tool);
    for (const std::string& frame : program.unknown_frames())
        look.text += fmt::format(
            "frame {} is not in the program: --with FILE, --frame-pose or --frame workobject\n", frame);
    look.text += "lines:";
    for (const auto& [kind, count] : counts) look.text += fmt::format(" {} {},", count, to_string(kind));
    look.text.back() = '\n';
    look.text += notes;
    for (const Text& r : program.remarks) look.text += r.english() + "\n";
    return look;
}

}  // namespace

void add_path_source_options(CLI::App& command, PathSourceArguments& a) {
    command
        .add_option("--path", a.path,
                    "Taught path: a table (.csv, one point a row) or a robot program (KRL .src, RAPID .mod, "
                    "FANUC .ls, "
                    "URScript .script, APT .apt .cl)")
        ->type_name("FILE");
    command
        .add_option("--frame", a.frame,
                    "What the points are expressed in; of a program: its own frame is the work object")
        ->check(CLI::IsMember({"base", "workobject"}))
        ->capture_default_str();
    command
        .add_option("--routine", a.routine, "Of a program: which; else the one that moves and no other calls")
        ->type_name("NAME");
    command.add_option("--with", a.also, "Further files of the program: $config.dat, modules")
        ->type_name("FILE")
        ->allow_extra_args(false);
    command
        .add_option("--frame-pose", a.frame_poses,
                    "Where a frame is that the program only names: base_from_frame")
        ->type_name("NAME=POSE")
        ->allow_extra_args(false);
    command.add_option("--lines", a.lines, "Of the program: only the points of these")->type_name("20..85");
    command.add_option("--unit", a.unit, "Of APT without UNITS")->check(CLI::IsMember({"mm", "in", "m"}));
    command.add_flag("--leave-out", a.leave_out, "Without the lines of the program that are not understood");
    command
        .add_option("--chord-mm", a.chord_mm,
                    "How far a circle's or an edge's arc may lie off the path's straight pieces")
        ->check(CLI::Range(1e-3, 10.0))
        ->capture_default_str();
    command.add_option("--drawing", a.drawing, "The path follows an edge of it; it lies in the work object")
        ->type_name("FILE.step");
    command.add_option("--edge", a.edge, "Which edge")->type_name("ID");
    command.add_option("--drawing-unit", a.drawing_unit, "Of a mesh: mm or m")
        ->check(CLI::IsMember({"mm", "m"}));
    command.add_flag("--chain", a.edge_options.chain, "The whole chain of tangent edges that it lies in");
    command.add_flag("--reversed", a.edge_options.reversed, "Against the drawing's direction");
    command
        .add_option("--offset-mm", a.edge_options.offset_mm,
                    "Beside the edge, on the face to the left of the travel; negative: right")
        ->check(CLI::Range(-1000.0, 1000.0))
        ->capture_default_str();
    command.add_option("--stand-off-mm", a.edge_options.stand_off_mm, "The tool's distance from the part")
        ->check(CLI::Range(-1000.0, 1000.0))
        ->capture_default_str();
    command.add_option("--step-mm", a.edge_options.step_mm, "Between points on straight pieces of the edge")
        ->check(CLI::Range(0.05, 1000.0))
        ->capture_default_str();
}

Expected<PathOrigin> path_origin(const PathSourceArguments& a) {
    if (!a.path.empty() && !a.edge.empty())
        return usage_error("a path comes from --path or from --edge, not from both");
    if (a.path.empty() && (a.drawing.empty() || a.edge.empty()))
        return usage_error("a path from the drawing wants --drawing and --edge", "", "or give --path");
    if (!a.path.empty() && !program_language_of(a.path) && a.brand.empty())
        return usage_error("a table does not say in whose notation it is", a.path,
                           "say --brand kuka, abb or ur");
    PathOrigin origin;
    origin.file = a.path;
    origin.brand = a.brand;
    origin.frame = a.frame == "base" ? PathFrame::base : PathFrame::workobject;
    origin.leave_out = a.leave_out;
    ProgramPathOptions& program = origin.program;
    program.routine = a.routine;
    program.chord_mm = a.chord_mm;
    for (const std::string& file : a.also) program.also.emplace_back(file);
    SEAM_OK(parse_lines(a.lines, program));
    if (!a.unit.empty()) program.unit_mm = a.unit == "in" ? 25.4 : a.unit == "m" ? 1000 : 1;
    for (const std::string& given : a.frame_poses) {
        const auto equals = given.find('=');
        if (equals == std::string::npos || equals == 0)
            return usage_error(Text("--frame-pose \"{}\" names no frame", given), "",
                               R"(give NAME=POSE, as 'UF 1={"xyz":[..],"abc":[..]}')");
        SEAM_TRY(const auto pose, read_pose_argument(given.substr(equals + 1), given.substr(0, equals)));
        program.frames[given.substr(0, equals)] = pose;
    }
    origin.drawing = a.drawing;
    origin.edge = a.edge;
    origin.drawing_options.unit = a.drawing_unit;
    origin.drawing_options.chord_mm = a.chord_mm;
    origin.drawing_options.cancel = stop_on_signal();
    origin.edge_options = a.edge_options;
    return origin;
}

Expected<PathLook> look_at_path(const PathOrigin& origin) {
    if (!origin.file.empty() && program_language_of(origin.file)) {
        SEAM_TRY(const auto program, read_program_path(origin.file, origin.program));
        return look_at_program(program);
    }
    SEAM_TRY(const auto source, read_path_source(origin));
    PathLook look;
    json points = json::array();
    std::size_t number = 0;
    const std::string frame = source.frame == PathFrame::base ? "base" : "workobject";
    look.text = fmt::format("{} points in {}{}\n point {}\n", source.path.points.size(), frame,
                            source.closed ? ", closed" : "", kNumbersHead);
    for (const ApplicationPoint& p : source.path.points) {
        json one = point_json(++number, p.frame_from_tool, frame);
        if (source.path.regions_named) one["region"] = p.region_id;
        points.push_back(std::move(one));
        look.text += fmt::format("{:>6} {} {}\n", number, numbers(p.frame_from_tool), p.region_id);
    }
    look.json = {{"status", "ok"}, {"closed", source.closed}, {"points", points}};
    return look;
}

}  // namespace seamwright::cli
