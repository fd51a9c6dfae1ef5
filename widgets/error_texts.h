#pragma once
// Every sentence of an Error that the studio can show, in English; see error_texts.cpp.

#include <span>

namespace seamwright {

// Context "Errors" of the translation.
std::span<const char* const> error_texts();   // what is wrong and how to mend it
std::span<const char* const> error_places();  // where: "sensor %1"

}  // namespace seamwright
