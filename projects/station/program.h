#pragma once
// What a project asks of the controller's program.

#include <string>

#include "core/ids.h"
#include "devices/robot_program.h"
#include "projects/model/project.h"

namespace seamwright {

// The enabled spots of a robot as moves, and the frames of the regions that they correct. `robot_id` may be
// empty when the project has one robot, `part_type` (id or number) where it has no part types: the program is of one type,
// and says so with its start signal. Error (input): no such robot, a type that called_type() refuses, no enabled spot, a
// frame without name, one name for two regions, what motion_findings() finds.
Expected<ProgramRequest> program_request(const Project& project, const RobotId& robot_id,
                                         const PartTypeId& part_type = {});

}  // namespace seamwright
