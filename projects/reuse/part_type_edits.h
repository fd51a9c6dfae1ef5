#pragma once
// What a person does with the part types of a project. Each is the project as it will be: an editor makes it one
// undoable step, a command saves it. What a type is: projects/model/part_types.h.

#include <string>
#include <vector>

#include "core/error.h"
#include "projects/model/project.h"

namespace seamwright {

// A new type. The first one of a project owns what the project holds: until now it was of one kind of part. Error
// (input): check_part_types().
Expected<Project> add_part_type(const Project& project, const PartType& type);

// `type` with the spots and regions of the type `from`: recipes, poses, limits, weights, frames by the same names on the
// controller. Ids are made of those there, "S1" or "S1-left" becomes "S1-right". References are
// ReferenceState::from_type, which the gate refuses until each is taught on a part of the new type; contour curves and
// kept offsets stay behind, they were measured on the other part. Error (input): `from` is unknown,
// check_part_types().
Expected<Project> clone_part_type(const Project& project, const std::string& from, const PartType& type);

// Without the type and, `with_spots`, its spots and regions. Error (input): it is unknown, or it has some and they are not
// to go. Of the last type they stay: the project is of one kind of part again.
Expected<Project> remove_part_type(const Project& project, const std::string& id, bool with_spots);

// Regions, with their spots, and spots that are of no type become the type's. Error (input): the type or an id is
// unknown, one is of a type already.
Expected<Project> take_into_part_type(const Project& project, const std::string& type,
                                      const std::vector<std::string>& ids);

// What differs between two types. Spots and regions are paired by their ids without the type's, as a clone names them.
struct PartTypeDifference {
    std::string what;     // "spot S1", "region R1"
    std::string field;    // as in the project's JSON; "" where one type alone has it
    nlohmann::json a, b;  // null where it has none
};
Expected<std::vector<PartTypeDifference>> compare_part_types(const Project& project, const std::string& a,
                                                             const std::string& b);

}  // namespace seamwright
