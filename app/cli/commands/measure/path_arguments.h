#pragma once
// Where `path` takes its bead from, as it is said on the command line, and what --look shows of it.

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "projects/path/path_source.h"

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

void add_path_source_options(CLI::App& command, PathSourceArguments& arguments);
// Error (usage): neither path nor edge, both, a table without its notation, lines that are no range, frames without a name
// or a pose.
Expected<PathOrigin> path_origin(const PathSourceArguments& arguments);

// What --look shows: every point, and every line with what became of it. It does not fail for lines that are not understood.
struct PathLook {
    nlohmann::json json;
    std::string text;
    bool whole = true;
};
Expected<PathLook> look_at_path(const PathOrigin& origin);

}  // namespace seamwright::cli
