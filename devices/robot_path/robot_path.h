#pragma once
// The path in a robot program: KRL (.src with its .dat), RAPID (.mod .sys .prg), FANUC TP (.ls), URScript (.script .urscript)
// and APT / CL data (.apt .cl .cls .aptsource .ncl).
//
// The program is read as it would run, statement by statement: frames and tools that it sets or names ($BASE, \WObj,
// UF, p[]), data lists and arrays, offsets and relative moves, loops whose bounds it says, routines of its own. What it
// asks of the cell (inputs, positions taken while it runs) it does not say. Nothing is left out in silence: every line has
// a note, and a motion whose pose is not known is LineKind::not_understood; a path with one has a gap.
//
// Points are what the program names; of circles also samples between them, so that the straight line from one to the next
// lies within chord_mm of the arc, the orientation turned evenly from start to end. Splines are their points alone: the curve
// between them is the controller's own. Joint values are no pose without the robot's kinematics: before the first and
// behind the last motion of the path they are the way to and from it (LineKind::left_out), between them a gap.
//
// Frames. Points are in the frame that was active. Where the program says what it is, base_from_frame is known (ABB's wobj0,
// FANUC's UF 0 and UR's base are the robot's base; KRL's $BASE before it is set is taken for it, with a remark); else the frame has
// its name alone ("BASE_DATA[3]", "UF 1", "wobj1"), and who asks for the path must know it (PathFrames).
//
// APT has no rotation about the tool's axis: x is laid along the travel, z into the part (against the axis it names).
//
// Sources: KUKA "Operating and Programming Instructions for System Integrators" (KSS 8) and "Expert Programming"; ABB
// "Technical reference manual RAPID Instructions, Functions and Data types"; FANUC "KAREL / TP Operations"; Universal Robots "The
// URScript Programming Language"; ISO 4343.

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"
#include "core/text.h"
#include "devices/exchange/tables/path_csv.h"

namespace seamwright {

enum class ProgramLanguage { krl, rapid, fanuc, urscript, apt };
std::string_view to_string(ProgramLanguage language);  // "KRL", ...
// By the name's ending, whatever its case; nullopt: it is none of a robot program.
std::optional<ProgramLanguage> program_language_of(const std::filesystem::path& path);
// The brand whose notation the language is: kuka, abb, ur; empty: of none that this program writes.
std::string_view brand_of(ProgramLanguage language);

enum class ProgramMotion { joint, linear, circular, spline };
std::string_view to_string(ProgramMotion motion);

struct ProgramPoint {
    int line = 0;
    std::string file;  // where the line is, without folder
    std::string name;  // "XP3", "p10{2}", "P[3]"; empty: written where it is used, or a sample of a circle
    ProgramMotion motion = ProgramMotion::linear;
    std::string frame;  // name of its frame; empty: the robot's base
    std::optional<Pose> base_from_frame = Pose::Identity();
    Pose frame_from_tool = Pose::Identity();
};

enum class LineKind {
    point,           // a motion whose points are in the path
    understood,      // sets something that the path rests on, or orders the program
    passed_over,     // moves nothing: outputs, waits, speeds, calls of programs that the file does not hold
    left_out,        // a motion to joint values before or behind the path
    not_reached,     // of a routine that the path does not run through
    not_understood,  // a motion, or what could be one
};
std::string_view to_string(LineKind kind);  // "not understood"

struct ProgramLine {
    std::string file;
    int line = 0;
    std::string text;  // as written, without what stands about it
    LineKind kind = LineKind::not_reached;
    Text why;        // empty: its kind says all
    int points = 0;  // that come from it
};

struct ProgramPath {
    ProgramLanguage language = ProgramLanguage::krl;
    std::string routine;  // which was read
    std::vector<std::string>
        tools;  // of its points, as the program names them, each change anew; empty name: it says none
    std::vector<ProgramPoint> points;
    std::vector<ProgramLine> lines;  // in the order of the files
    std::vector<Text> remarks;       // what was taken for granted
    std::size_t count(LineKind kind) const;
    // Names of the frames that it does not say, in order of their first point.
    std::vector<std::string> unknown_frames() const;
};

struct ProgramPathOptions {
    std::string routine;                              // empty: the one that moves and is called by no other
    std::vector<std::filesystem::path> also;          // further files of the program: $config.dat, modules
    std::map<std::string, Pose, std::less<>> frames;  // base_from_frame by name, as the program says it
    double chord_mm = 0.05;                           // of circles
    double unit_mm = 0;                               // of APT without UNITS; 0: refused
    int first_line = 0, last_line = 0;  // of the file: points of other lines are left out; 0: all
};

// Error (file): missing, too large, another ending; (input): not the language that its ending says, no motion, several routines that
// could be meant (named), a routine that is not there, a program without end, more than kPathPointLimit points.
Expected<ProgramPath> read_program_path(const std::filesystem::path& path,
                                        const ProgramPathOptions& options = {});
// The same from texts: the program first, then what belongs to it; names decide the language.
struct ProgramText {
    std::string name, text;
};
Expected<ProgramPath> parse_program_path(const std::vector<ProgramText>& files,
                                         const ProgramPathOptions& options = {});

// As `path` takes it: in the robot's base, or, with `in_own_frame`, in the program's frame as it is. `leave_out`: without the lines
// that are not understood. Error (input): such lines (the first is named), fewer than 2 points, a frame that the program does not say, in its
// own frame more than one, tools that change on the way.
Expected<ApplicationPath> application_path(const ProgramPath& program, bool in_own_frame,
                                           bool leave_out = false);

}  // namespace seamwright
