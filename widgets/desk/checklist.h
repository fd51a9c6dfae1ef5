#pragma once
// The order of commissioning, derived from project and devices; nothing is ticked by hand. Exactly one step
// is next: the first that is not done, and measuring when all are.

#include <QCoreApplication>
#include <QString>
#include <array>
#include <string>
#include <vector>

#include "core/correction/correction.h"
#include "projects/project.h"
#include "projects/project_file.h"

namespace seamwright {

enum class Step { cell, calibrate, teach, align, regions, prove, run };
inline constexpr std::array<Step, 7> kSteps{Step::cell,    Step::calibrate, Step::teach, Step::align,
                                            Step::regions, Step::prove,     Step::run};

enum class StepStatus {
    done,
    next,     // the one to do
    blocked,  // waits for an earlier step
    stale     // was done, but what it rests on was changed since; waits its turn
};

struct StepState {
    Step step = Step::cell;
    StepStatus status = StepStatus::blocked;
    QString why;         // one sentence: what there is, what is missing, since when it is stale
    bool stale = false;  // also of the next step
};

// What the project alone does not tell.
struct DeskFacts {
    bool connected = false;
    std::vector<SensorIdentity>
        sensors;                      // as connected, in the project's order; empty serial = not connected
    int zero_shift_runs = 0;          // the newest unbroken row of them
    bool zero_shift_current = false;  // made with spots, regions and calibrations as they are
    bool zero_shift_ok = false;       // every one judged ok
    QString zero_shift_utc;
    int runs = 0;  // that were no zero shift
};
inline constexpr int kZeroShiftRuns = 3;
inline constexpr const char* kZeroShiftPrefix = "zero shift ";

std::array<StepState, 7> checklist(const Project& project, const DeskFacts& facts);
Step next_step(const std::array<StepState, 7>& steps);

// "Align" and "Align spot S4": the step's name, and the next-step line.
QString step_name(Step step);
QString status_word(StepStatus status);

// The options that plan and correction of a region share.
CorrectionOptions correction_options(const Region& region);

}  // namespace seamwright
