#pragma once
// The taught path of an application, from where it stands: a table, a robot program, an edge of the drawing.

#include <filesystem>
#include <optional>
#include <string>

#include "devices/drawing/edge_path.h"
#include "devices/exchange/tables/path_csv.h"
#include "devices/robot_path/robot_path.h"
#include "projects/measure/path.h"

namespace seamwright {

struct PathOrigin {
    std::filesystem::path file;  // table or robot program, told by its ending; empty: an edge of the drawing
    std::string brand;           // in whose notation a table is
    PathFrame frame = PathFrame::base;  // of the points; work object of a program: its own frame is that
    ProgramPathOptions program;
    bool leave_out = false;  // lines of the program that are not understood
    std::filesystem::path drawing;
    std::string edge;
    DrawingOptions drawing_options;
    EdgePathOptions edge_options;
};

struct PathSource {
    ApplicationPath path;
    PathFrame frame = PathFrame::base;  // an edge's is the work object
    std::string brand;                  // in whose notation it is; empty: in none's
    bool closed = false;
    std::optional<ProgramPath> program;
};

// Error: what the readers refuse.
Expected<PathSource> read_path_source(const PathOrigin& origin);

}  // namespace seamwright
