#pragma once
// OpenCASCADE's shape as a drawing: its faces tessellated, its edges sampled. Private to shape_reader.cpp.

#include <TopoDS_Shape.hxx>
#include <string>

#include "devices/drawing/drawing.h"

namespace seamwright::drawing {

// Error (file): no face, none that could be tessellated, a point too far off; cancelled.
Expected<Drawing> drawing_of(const TopoDS_Shape& shape, const std::string& name,
                             const DrawingOptions& options);

}  // namespace seamwright::drawing
