#pragma once
// The path of a tool along an edge of the drawing, in the drawing's frame.
//
// On the edge the tool's z points into the part against the middle of the two faces' normals, x along the travel. With
// an offset the points lie beside it on one of its faces, `offset_mm` from it along the face (positive: on the face that lies
// left of the travel seen from outside, negative: right), and z points against that face's normal. The tool stands
// `stand_off_mm` off along -z. Faces are taken for flat over the offset.

#include "core/geometry/pose.h"
#include "devices/drawing/drawing.h"

namespace seamwright {

struct EdgePathOptions {
    double offset_mm = 0;     // up to 1000 either way
    double stand_off_mm = 0;  // -1000 to 1000
    double step_mm = 5;       // between points, 0.05 to 1000; curves have more, as the drawing was sampled
    bool chain = false;       // the whole chain of tangent edges that the edge lies in
    bool reversed = false;    // against the drawing's direction; left is left of the new one
};

struct EdgePath {
    std::vector<Pose> drawing_from_tool;
    bool closed = false;  // the last point is not the first one again: the path goes on to it
    double length_mm = 0;
};

// Error (input): no such edge, options out of range, an offset that a bend of the edge does not hold (the path would turn back).
Expected<EdgePath> edge_path(const Drawing& drawing, const std::string& edge, const EdgePathOptions& options);

}  // namespace seamwright
