#pragma once
// What a controller needs for kuka-rsi beside the measuring program: seamwright_rsi.src, the RSI context that
// it creates (NAME.rsi for RSI Visual and NAME.rsi.xml, which the controller loads; RSI 3 and 4) and the
// configuration of its object ETHERNET (NAME.xml). NAME is SeamwrightRsi, for "mode": "relative"
// SeamwrightRsiRelative. The files of resources/robot/kuka are loadable as they are; written, they hold the
// robot's settings: "listen" and "port", "sen_type", "mode" (HOLDON and RSI_ON), "reference" (RefCorrSys),
// "max_translation_mm" and "max_rotation_deg" as limits of POSCORR and POSCORRMON, "path_output" (101) and
// "release_output" (102), the two $OUT between program and context.

#include "devices/robot_program.h"

namespace seamwright {

// The measuring driver's program, with the settings in "measuring", and the files of RSI.
Expected<std::vector<ProgramFile>> write_rsi_program(const ProgramRequest& request);

}  // namespace seamwright
