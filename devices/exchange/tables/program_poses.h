#pragma once
// The taught points of a robot program as a table of poses, in the order of the file, named as they are there:
//     KUKA    E6POS and POS of a data list: DECL E6POS XP1={X 1250.0,Y -31.2,Z 840.0,A 90.0,B 0.0,C 180.0,S 2,T 35};
//             XP1 of an inline form is the point P1, whose FDAT says base and tool
//     ABB     robtargets of a module: CONST robtarget p10:=[[1250,-31.2,840],[0.5,0.5,-0.5,0.5],[0,0,0,0],[9E9,..]];
//     FANUC   /POS of an LS file: P[1:"S1"]{ GP1: UF : 0, UT : 1, ... X = 1.0 mm, ... R = 0.0 deg };
// Millimetres, degrees and the brand's rotation, as the file has them: of its tool in its base or user frame (ABB's are named
// where the robot moves, not here).

#include <optional>
#include <string>
#include <string_view>

#include "devices/exchange/tables/pose_table.h"

namespace seamwright {

// nullopt: not the text of such a program. Error (input) with the line: no point, joints alone, a number that is missing or
// none, a rotation that is none, a position beyond 100 m, a name given twice (KUKA, ABB), bases or tools that differ from point to
// point, a point that is cut short. `understood` names tool and frame.
std::optional<Expected<PoseTable>> parse_program_poses(std::string_view text, const std::string& where);

}  // namespace seamwright
