#pragma once
// Names that no program of ours may bear: what the three robot languages reserve or define themselves, and
// what the modules of resources/robot define. Compared without case, as KRL and RAPID do.

#include <string>
#include <string_view>

#include "core/error.h"

namespace seamwright {

enum class RobotLanguage { krl, rapid, urscript };
std::string_view to_string(RobotLanguage language);  // "KRL", "RAPID", "URScript"

// Reserved, a predefined type, or a routine or value of the language's own.
bool is_robot_word(RobotLanguage language, std::string_view name);

// Error (input) unless `name` can name a program in every language: a letter, then letters, digits and _, at
// most 20; none of their words; none of our modules' names.
Expected<void> check_program_name(const std::string& name, const std::string& where);

}  // namespace seamwright
