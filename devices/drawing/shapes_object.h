#pragma once
// What seamwright_shapes.so (core/loaded_object.h) hands out, which alone links OpenCASCADE: shape_reader.h and door_step.h.

#include "devices/drawing/drawing.h"

namespace seamwright::drawing {

inline constexpr const char* kShapes = "seamwright_shapes.so";

extern "C" {
void seamwright_read_step(std::span<const std::byte> bytes, const std::string& name,
                          const DrawingOptions& options, Expected<Drawing>& drawing);
void seamwright_read_iges(std::span<const std::byte> bytes, const std::string& name,
                          const DrawingOptions& options, Expected<Drawing>& drawing);
void seamwright_door_step(Expected<std::string>& text);
}

}  // namespace seamwright::drawing
