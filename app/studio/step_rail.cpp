#include "app/studio/step_rail.h"

#include <QVBoxLayout>

#include "widgets/pages/parts/form.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr int kWide_px = 164, kNarrow_px = 72;
constexpr double kSmall = 0.8;  // of the narrow rail's words

}  // namespace

QString step_icon(Step step) {
    static const std::array<QString, kSteps.size()> names{"sensor",  "calibrate", "target", "align",
                                                          "regions", "prove",     "accept", "measure"};
    return names[static_cast<std::size_t>(step)];
}

StepRail::StepRail(Desk& desk) : desk_(desk) {
    auto* box = new QVBoxLayout(this);
    box->setContentsMargins(4, 8, 4, 4);
    box->setSpacing(2);
    for (const Step step : kSteps) {
        const auto i = static_cast<std::size_t>(step);
        buttons_[i] = make_button("rail", step_icon(step), QString(), step_name(step),
                                  [this, step] { emit step_chosen(step); });
        buttons_[i]->setAccessibleName(step_name(step));
        buttons_[i]->setCheckable(true);
        buttons_[i]->setAutoExclusive(true);
        buttons_[i]->setMinimumHeight(38);
        states_[i] = new QLabel;
        states_[i]->setWordWrap(true);
        box->addWidget(buttons_[i]);
        box->addWidget(states_[i]);
    }
    box->addStretch(1);
    connect(&desk_, &Desk::checklist_changed, this, &StepRail::refresh);
    set_narrow(false);
}

void StepRail::set_narrow(bool narrow) {
    if (narrow == narrow_) return;
    narrow_ = narrow;
    setFixedWidth(narrow ? kNarrow_px : kWide_px);
    for (const Step step : kSteps) {
        const auto i = static_cast<std::size_t>(step);
        buttons_[i]->setText(narrow ? QString::number(i + 1) : tr("%1 %2").arg(i + 1).arg(step_name(step)));
        states_[i]->setContentsMargins(narrow ? 4 : 34, 0, 0, narrow ? 2 : 6);
        QFont small = font();
        if (narrow) small.setPointSizeF(small.pointSizeF() * kSmall);
        states_[i]->setFont(small);
    }
    refresh();
}

void StepRail::show_step(Step step) {
    buttons_[static_cast<std::size_t>(step)]->setChecked(true);
}

void StepRail::refresh() {
    for (const StepState& s : desk_.steps()) {
        const auto i = static_cast<std::size_t>(s.step);
        const bool stale = s.stale && s.status == StepStatus::next;
        const QString sign = s.status == StepStatus::done    ? QStringLiteral("✓")
                             : s.status == StepStatus::next  ? QStringLiteral("➜")
                             : s.status == StepStatus::stale ? QStringLiteral("!")
                                                             : QString();
        const QString word = stale ? tr("next, stale") : status_word(s.status);
        states_[i]->setAccessibleName(QStringLiteral("%1: %2").arg(step_name(s.step), word));
        set_verdict(*states_[i], (sign + ' ' + word).trimmed(),
                    s.status == StepStatus::done             ? Tone::good
                    : s.status == StepStatus::stale || stale ? Tone::attention
                                                             : Tone::plain);
        buttons_[i]->setToolTip(tr("%1: %2. %3").arg(step_name(s.step), status_word(s.status), s.why));
        buttons_[i]->setAccessibleDescription(buttons_[i]->toolTip());
    }
}

}  // namespace seamwright
