#include "devices/drawing/door_step.h"

#include "core/loaded_object.h"
#include "devices/drawing/shapes_object.h"

namespace seamwright {

Expected<std::string> door_step() {
    SEAM_TRY(const auto make, loaded_function<decltype(drawing::seamwright_door_step)>(
                                  drawing::kShapes, "seamwright_door_step"));
    Expected<std::string> text;
    make(text);
    return text;
}

}  // namespace seamwright
