#pragma once
// What the operating system says of a call that failed, from its number (errno): in the language of who reads it, for the
// numbers that files and connections give. In English it is strerror()'s word; of another number it is that in every language.

#include <system_error>

#include "core/text.h"

namespace seamwright {

Text system_text(int number);
// Of another category than the system's: its own words.
Text system_text(const std::error_code& error);

}  // namespace seamwright
