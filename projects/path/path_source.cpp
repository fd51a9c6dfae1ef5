#include "projects/path/path_source.h"

namespace seamwright {
namespace {

Expected<PathSource> from_drawing(const PathOrigin& o) {
    SEAM_TRY(const auto drawing, read_drawing(o.drawing, o.drawing_options));
    SEAM_TRY(const auto edge, edge_path(drawing, o.edge, o.edge_options));
    PathSource source;
    source.frame = PathFrame::workobject;
    source.closed = edge.closed;
    for (const Pose& pose : edge.drawing_from_tool) source.path.points.push_back({pose, {}});
    return source;
}

Expected<PathSource> from_table(const PathOrigin& o) {
    SEAM_TRY(const auto notation, path_notation_from(o.brand));
    PathSource source;
    SEAM_TRY(source.path, read_path_csv(o.file, notation));
    source.frame = o.frame;
    source.brand = o.brand;
    return source;
}

}  // namespace

Expected<PathSource> read_path_source(const PathOrigin& o) {
    if (o.file.empty()) return from_drawing(o);
    if (!program_language_of(o.file)) return from_table(o);
    PathSource source;
    SEAM_TRY(source.program, read_program_path(o.file, o.program));
    source.frame = o.frame;
    SEAM_TRY(source.path,
             application_path(*source.program, source.frame == PathFrame::workobject, o.leave_out));
    source.brand = std::string(brand_of(source.program->language));
    return source;
}

}  // namespace seamwright
