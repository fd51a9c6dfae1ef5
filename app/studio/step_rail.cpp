#include "app/studio/step_rail.h"

#include <QVBoxLayout>

#include "widgets/pages/parts/form.h"
#include "widgets/style.h"

namespace seamwright {

QString step_icon(Step step) {
    static const std::array<QString, kSteps.size()> names{"sensor",  "calibrate", "target", "align",
                                                          "regions", "prove",     "accept", "measure"};
    return names[static_cast<std::size_t>(step)];
}

StepRail::StepRail(Desk& desk) : desk_(desk) {
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(4, 8, 4, 4);
    box->setSpacing(2);
    setFixedWidth(164);
    for (const Step step : kSteps) {
        const auto i = static_cast<std::size_t>(step);
        buttons_[i] = make_button("rail", step_icon(step), tr("%1 %2").arg(i + 1).arg(step_name(step)),
                                  step_name(step), [this, step] { emit step_chosen(step); });
        buttons_[i]->setCheckable(true);
        buttons_[i]->setAutoExclusive(true);
        buttons_[i]->setMinimumHeight(38);
        states_[i] = new QLabel;
        states_[i]->setContentsMargins(34, 0, 0, 6);
        box->addWidget(buttons_[i]);
        box->addWidget(states_[i]);
    }
    box->addStretch(1);
    connect(&desk_, &Desk::checklist_changed, this, &StepRail::refresh);
    refresh();
}

void StepRail::show_step(Step step) {
    buttons_[static_cast<std::size_t>(step)]->setChecked(true);
}

void StepRail::refresh() {
    for (const StepState& s : desk_.steps()) {
        const auto i = static_cast<std::size_t>(s.step);
        const bool stale = s.stale && s.status == StepStatus::next;
        const QString sign = s.status == StepStatus::done   ? QStringLiteral("✓ ")
                             : s.status == StepStatus::next ? QStringLiteral("➜ ")
                                                            : QString();
        set_verdict(*states_[i], sign + (stale ? tr("next, stale") : status_word(s.status)),
                    s.status == StepStatus::done             ? Tone::good
                    : s.status == StepStatus::stale || stale ? Tone::attention
                                                             : Tone::plain);
        buttons_[i]->setToolTip(tr("%1: %2. %3").arg(step_name(s.step), status_word(s.status), s.why));
        buttons_[i]->setAccessibleDescription(buttons_[i]->toolTip());
    }
}

}  // namespace seamwright
