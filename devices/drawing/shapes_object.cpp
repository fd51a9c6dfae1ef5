#include "devices/drawing/shapes_object.h"

#include "devices/drawing/door_shape.h"
#include "devices/drawing/shape_reader.h"

namespace seamwright::drawing {

void seamwright_read_step(std::span<const std::byte> bytes, const std::string& name,
                          const DrawingOptions& options, Expected<Drawing>& drawing) {
    drawing = read_step(bytes, name, options);
}

void seamwright_read_iges(std::span<const std::byte> bytes, const std::string& name,
                          const DrawingOptions& options, Expected<Drawing>& drawing) {
    drawing = read_iges(bytes, name, options);
}

void seamwright_door_step(Expected<std::string>& text) {
    text = door_text();
}

}  // namespace seamwright::drawing
