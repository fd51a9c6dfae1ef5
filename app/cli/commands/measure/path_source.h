#pragma once
// Where `path` takes its bead from: a table, a robot program, an edge of the drawing.

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "devices/drawing/edge_path.h"
#include "devices/exchange/tables/path_csv.h"
#include "devices/robot_path/robot_path.h"
#include "projects/measure/path.h"

namespace seamwright::cli {

struct PathSourceArguments {
    std::string path, brand, frame = "base";
    // Of programs
    std::string routine, lines, unit;
    std::vector<std::string> also, frame_poses;
    bool leave_out = false;
    double chord_mm = 0.05;
    // Of drawings
    std::string drawing, edge, drawing_unit;
    EdgePathOptions edge_options;
};

struct PathSource {
    ApplicationPath path;
    PathFrame frame = PathFrame::base;
    std::string brand;  // in whose notation it is; empty: in none's
    bool closed = false;
    std::optional<ProgramPath> program;
};

void add_path_source_options(CLI::App& command, PathSourceArguments& arguments);
// Error: what the readers refuse; (usage) neither path nor edge, options of the other's, a brand that must be said.
Expected<PathSource> read_path_source(const PathSourceArguments& arguments);

// What --look shows: every point, and every line with what became of it. It does not fail for lines that are not understood.
struct PathLook {
    nlohmann::json json;
    std::string text;
    bool whole = true;
};
Expected<PathLook> look_at_path(const PathSourceArguments& arguments);

}  // namespace seamwright::cli
