#pragma once
// STEP and IGES by OpenCASCADE; nobody but shapes_object.cpp calls it.

#include "devices/drawing/drawing.h"

namespace seamwright::drawing {

// `bytes` are the file's; `name` is for sentences. Every exception of OpenCASCADE ends here.
Expected<Drawing> read_step(std::span<const std::byte> bytes, const std::string& name,
                            const DrawingOptions& options);
Expected<Drawing> read_iges(std::span<const std::byte> bytes, const std::string& name,
                            const DrawingOptions& options);

}  // namespace seamwright::drawing
