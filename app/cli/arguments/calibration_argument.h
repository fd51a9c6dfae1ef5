#pragma once
// A calibration on the command line: one of a project, what `calibrate` answered, or a table that it wrote.

#include <string>

#include "projects/model/project.h"

namespace seamwright::cli {

// FILE.seam: the calibration named, or the only one that turns pixels into millimetres; JSON: the answer of a method
// whose solution turns them, with what it did not find from `base` (nullptr: none); .lut: a table. Its id, where the
// file has none, is the file's name. Error: the file's, no such calibration, several that could be meant, an answer that
// no sensor could measure with.
Expected<Calibration> read_calibration(const std::string& path, const std::string& id,
                                       const Calibration* base = nullptr);

}  // namespace seamwright::cli
