#pragma once
// The pages of the window as steps of the way: each gathers the items of the commissioning checklist
// (projects/proof/checklist.h) that are worked on there. Exactly one step is next: the first with an open
// item, and measuring when there is none. The acceptance is on the way where a customer asks for it: it is offered
// and never next.

#include <QString>
#include <array>
#include <vector>

#include "projects/proof/checklist.h"

namespace seamwright {

enum class Step { cell, calibrate, teach, align, regions, prove, accept, run };
inline constexpr std::array<Step, 8> kSteps{Step::cell,    Step::calibrate, Step::teach,  Step::align,
                                            Step::regions, Step::prove,     Step::accept, Step::run};
using StepStates = std::array<struct StepState, kSteps.size()>;

enum class StepStatus {
    done,
    next,     // the one to do
    blocked,  // waits for an earlier step
    stale,    // was done, but what it rests on was changed since; waits its turn
    offered   // may be done now, and need not
};

struct StepState {
    Step step = Step::cell;
    StepStatus status = StepStatus::blocked;
    QString why;         // one sentence: what there is, what is missing, since when it is stale
    bool stale = false;  // also of the next step
};

// Whose completion an item belongs to, and where it is worked on.
Step step_of(CheckStep item);
Step page_of(CheckStep item);

StepStates steps_of(const std::vector<CheckItem>& items, Language language);
Step next_step(const StepStates& steps);

// "Align": the step's name.
QString step_name(Step step);
QString status_word(StepStatus status);

}  // namespace seamwright
