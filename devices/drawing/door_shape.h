#pragma once
// The text of door_step.h, by OpenCASCADE; nobody but shapes_object.cpp calls it.

#include <string>

#include "core/error.h"

namespace seamwright::drawing {

Expected<std::string> door_text();

}  // namespace seamwright::drawing
