#pragma once
// Servoing of a panel job on the station's devices (thesis 2.5.1; core/panel/servoing.h): the industrial way, in several
// moves by a learnt sensitivity matrix, beside the single step of panel_station.h.
//
// Values are gap and flush at every enabled place as the gauge finds them, set values the taught ones. Every move, when
// learning too, is a motion of the gripper from where it measured first, in its own frame; it is written as the job's
// frame by a pass of the safety gate, within the job's limits, read back, confirmed, and the robot's program is started
// once more to fire there. What goes wrong at any move takes the first frame back, as the single step does.
//
// Sigma of a servo's motion, which the gate judges: the values' own variances through the pseudo-inverse,
//     C = S+ diag(var of gap, flush, and the places' sigma) S+^T
// to first order. A learning step is a known motion, made as exactly as the robot arrives: twice the covariance of an
// arrival, or the places' sigma where that is not stated.

#include <functional>

#include "core/panel/servoing.h"
#include "projects/panel/panel_station.h"

namespace seamwright {

// Of the devices: steps within the gap of a body, few moves, and no growth of the deviations. A value's noise n leaves
// n / (sqrt(2) step) in its sensitivity: 2 % of 0.03 mm.
inline ServoingOptions device_servoing() {
    ServoingOptions options;
    options.step_mm = 1;
    options.step_deg = 0.1;
    options.max_moves = 8;
    options.diverged_at = 1.5;
    return options;
}

// Two a degree of freedom.
inline constexpr int kLearningMoves = 12;

// Called on the running thread where the panel was measured: after `moves` moves, 0 = where it came; `so_far` is not stored yet.
using PanelMoved = std::function<void(const PanelRecord& so_far, int moves)>;

struct LearntPanel {
    PanelJob job;  // with its sensitivity, where it is usable
    double condition = 0;
    bool usable = false;
    RunRecord run;  // of the learning: nothing is released, the frame is as before
};
// kLearningMoves known moves, with whatever panel and body stand there. Error: as run_panel(), a step that
// is not small (0.05 to 3 mm, 0.005 to 0.5 degrees), a move that was refused or failed.
Expected<LearntPanel> learn_panel(Station& station, const std::string& job_id,
                                  const ServoingOptions& servoing, const RunOptions& options,
                                  const PanelMoved& moved = {});

// One panel, as run_panel(): the record is in the file when this returns, PanelRecord::servo tells the moves and `fit` the
// single step beside them. Refused: the first move by the gate, a move that makes the deviations grow, values that stand
// still out of tolerance. A dry run says where the first move would lead. Error besides: the sensitivity is not learnt, or
// of other places; it is ill-conditioned.
Expected<RunRecord> servo_panel(Station& station, const std::string& job_id, const ServoingOptions& servoing,
                                const RunOptions& options, const PanelMoved& moved = {});

}  // namespace seamwright
