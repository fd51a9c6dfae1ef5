#pragma once
// What a part's type decides: which spots and regions of a project are measured, judged and pushed. All that runs a part
// works on the project of its type (of_type()), which knows nothing of the others; so no other type's region can reach a
// robot, and two types may push the same frame of a controller, one at a time.

#include <string>
#include <vector>

#include "core/error.h"
#include "projects/model/project.h"

namespace seamwright {

// The largest number of a type: what a PLC's register holds.
inline constexpr int kLargestTypeNumber = 65535;
// In bytes: what the register map of a robot or the name of its variable holds.
inline constexpr std::size_t kLongestTypeId = 16;

const PartType* find_type(const Project& project, const std::string& id);

// Error (input): an id that is none (kLongestTypeId letters, digits, '-', '_'; not digits alone, which are a number), a
// number out of range, two types of one id or number, a spot or region of a type that the project does not have, a spot in
// a region of another type. A spot or a region without a type in a project with types is none: it is not run, and
// check() finds it.
Expected<void> check_part_types(const Project& project);

// The type that is called: by its id, or by its number in decimal digits. Error (input) where the project has no such
// type, or where nothing is called in a project with types; and where one is called in a project without types.
// Nothing called in a project without types: "".
Expected<std::string> called_type(const Project& project, const std::string& id_or_number);

// The project with the spots, the regions and the entry of that type alone; a project without types as it is. What is
// measured with it refers to it as its setup, so that another type's edit leaves it as it was. `type_id` is one that the
// project has, or "" of a project without types.
Project of_type(const Project& project, const std::string& type_id);

// "left (door left)"; the id where there is no name.
std::string name_of(const PartType& type);

}  // namespace seamwright
