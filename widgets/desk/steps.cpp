#include "widgets/desk/steps.h"

#include <QCoreApplication>

namespace seamwright {
namespace {

struct Checklist {
    Q_DECLARE_TR_FUNCTIONS(Checklist)
};

}  // namespace

Step step_of(CheckStep item) {
    switch (item) {
        case CheckStep::sensors:
        case CheckStep::robots:
            return Step::cell;
        case CheckStep::calibrations:
            return Step::calibrate;
        case CheckStep::taught:
            return Step::teach;
        case CheckStep::frozen:
            return Step::align;
        case CheckStep::observable:
            return Step::regions;
        case CheckStep::zero_shift:
        case CheckStep::known_shift:
        case CheckStep::limits:
        case CheckStep::headless:
            break;
    }
    return Step::prove;
}

// Limits are judged when the known shift is proven, but set at the regions.
Step page_of(CheckStep item) {
    return item == CheckStep::limits ? Step::regions : step_of(item);
}

StepStates steps_of(const std::vector<CheckItem>& items, Language language) {
    StepStates steps;
    bool found = false;
    QString before;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        StepState& state = steps[i];
        state.step = kSteps[i];
        const CheckItem* open = nullptr;
        QStringList there_is;
        for (const CheckItem& item : items) {
            if (step_of(item.step) != state.step) continue;
            there_is << QString::fromStdString(item.why.in(language));
            if (!open && !item.done()) open = &item;
        }
        state.stale = open && open->status == CheckStatus::stale;
        if (state.step == Step::run)
            state.why = Checklist::tr("measure the next part");
        else if (state.step == Step::accept)
            state.why = Checklist::tr("the studies that a customer asks for before the release");
        else if (open)
            state.why = QString::fromStdString(open->why.in(language));
        else
            state.why = there_is.join("; ");
        if (state.step == Step::accept && !found) {
            state.status = StepStatus::offered;
        } else if (state.step == Step::accept) {
            state.why = Checklist::tr("first: %1").arg(before);
        } else if (state.step != Step::run && !open) {
            state.status = StepStatus::done;
        } else if (!found) {
            state.status = StepStatus::next;
            found = true;
            before = step_name(state.step);
        } else {
            state.status = state.stale ? StepStatus::stale : StepStatus::blocked;
            if (!state.stale) state.why = Checklist::tr("first: %1").arg(before);
        }
    }
    return steps;
}

Step next_step(const StepStates& steps) {
    for (const StepState& s : steps)
        if (s.status == StepStatus::next) return s.step;
    return Step::run;
}

QString step_name(Step step) {
    switch (step) {
        case Step::cell:
            return Checklist::tr("Cell");
        case Step::calibrate:
            return Checklist::tr("Calibrate");
        case Step::teach:
            return Checklist::tr("Teach");
        case Step::align:
            return Checklist::tr("Align");
        case Step::regions:
            return Checklist::tr("Regions");
        case Step::prove:
            return Checklist::tr("Prove");
        case Step::accept:
            return Checklist::tr("Accept");
        case Step::run:
            return Checklist::tr("Run");
    }
    return {};
}

QString status_word(StepStatus status) {
    switch (status) {
        case StepStatus::done:
            return Checklist::tr("done");
        case StepStatus::next:
            return Checklist::tr("next");
        case StepStatus::blocked:
            return Checklist::tr("waits");
        case StepStatus::stale:
            return Checklist::tr("stale");
        case StepStatus::offered:
            return Checklist::tr("on request");
    }
    return {};
}

}  // namespace seamwright
