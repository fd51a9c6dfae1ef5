#pragma once
// A pass through a spot on the project's devices: what `pass` and `align --live` have in common.

#include <optional>
#include <string>

#include "app/cli/command.h"
#include "projects/model/users.h"
#include "projects/station/teach.h"

namespace seamwright::cli {

struct LivePass {
    std::string file, spot, out;  // out: the pass as SEQ.csv of `align`; empty: nowhere
    double step_mm = PassOptions{}.step_mm;
    std::optional<double> jitter_mm, tolerance_mm, window_mm;  // else the spot's, or the usual
    std::optional<Eigen::Vector2d> reference_mm;
};

// What becomes of a judged pass.
enum class PassDeed { record, accept, adopt };

// Drives the pass, judges it and does what is asked for; exit code 1 where the contour does not stand still. Error: no
// such spot, a device, no profile seen, what may not be done.
Expected<Answer> pass_on_devices(const LivePass& asked, PassDeed deed);

}  // namespace seamwright::cli
