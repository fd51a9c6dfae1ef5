#pragma once
// What a project asks of the controller's program.

#include <string>
#include <vector>

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

// The other part types whose program for this robot has files of these names with other contents. Whichever is loaded last is
// the one that the controller holds: a part of another type is refused at the start of its measuring.
std::vector<std::string> types_with_these_files(const Project& project, const RobotId& robot_id,
                                                const std::string& brand, const ProgramRequest& request,
                                                const std::vector<ProgramFile>& files);

}  // namespace seamwright
