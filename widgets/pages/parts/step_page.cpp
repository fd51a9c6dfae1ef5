#include "widgets/pages/parts/step_page.h"

#include <QRegularExpression>
#include <QTimer>

#include "projects/proof/known_shift.h"
#include "widgets/editors/leave_field.h"
#include "widgets/editors/number_box.h"
#include "widgets/into_view.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {

StepPage::StepPage(Desk& desk, const Views& views, Step step, const QString& purpose)
    : desk_(desk), views_(views), step_(step), box_(new QVBoxLayout(this)) {
    box_->setContentsMargins(12, 10, 12, 12);
    box_->setSpacing(8);
    title_ = new QLabel(step_name(step));
    QFont font = title_->font();
    font.setPointSizeF(font.pointSizeF() * 1.4);
    font.setBold(true);
    title_->setFont(font);
    title_->setObjectName("page_title");
    box_->addWidget(title_);
    box_->addWidget(make_text(purpose));
    state_ = make_text({});
    state_->setObjectName("page_state");
    box_->addWidget(state_);
    connect(&desk_, &Desk::project_changed, this, &StepPage::later);
    connect(&desk_, &Desk::checklist_changed, this, &StepPage::later);
    connect(&desk_, &Desk::runs_changed, this, &StepPage::later);
    connect(&desk_.selection(), &Selection::changed, this, &StepPage::later);
    connect(&desk_, &Desk::opened, this, &StepPage::let_edit);
    let_edit();
}

void StepPage::let_edit() {
    setEnabled(desk_.is_open());
    if (head_) head_->setEnabled(desk_.is_open());
}

QVBoxLayout& StepPage::make_head() {
    head_ = new QWidget;
    auto* box = new QVBoxLayout(head_);
    box->setContentsMargins(12, 10, 12, 6);
    box->setSpacing(6);
    box->addWidget(title_);
    box->addWidget(state_);
    let_edit();
    return *box;
}

void StepPage::point_out() {
    QWidget* control = due();
    if (!control || !control->isVisible()) control = state_;
    bring_into_view(control);
    control->setFocus(Qt::TabFocusReason);
}

void StepPage::showEvent(QShowEvent* event) {
    QWidget::showEvent(event);
    entered();
    later();
}

QString StepPage::take_typed() {
    QWidget* refused = refused_field(*this);
    return refused ? point_at(*refused) : QString();
}

QString StepPage::point_at(QWidget& refused) const {
    bring_into_view(&refused);
    refused.setFocus(Qt::OtherFocusReason);
    return tr("A value is refused: mend it, or press Esc in its field.");
}

// Several changes in one turn of the event loop are one refresh.
void StepPage::later() {
    if (due_ || !isVisible()) return;
    due_ = true;
    QTimer::singleShot(0, this, [this] {
        due_ = false;
        const StepState& s = desk_.steps()[static_cast<std::size_t>(step_)];
        const Tone tone = s.stale || !desk_.is_open()    ? Tone::attention
                          : s.status == StepStatus::done ? Tone::good
                          : s.status == StepStatus::next ? Tone::plain
                                                         : Tone::attention;
        const QString word = status_word(s.stale ? StepStatus::stale : s.status);
        set_verdict(*state_,
                    desk_.is_open() ? tr("%1: %2").arg(word, s.why)
                                    : tr("No project is open: open one or make a new one (menu File)."),
                    tone);
        refresh();
        fit_head();
    });
}

// Words that came while the page was being shown may be of more lines than it had room for.
void StepPage::fit_head() {
    if (!head_) return;
    for (QWidget* w : {head_, head_->parentWidget()})
        if (w && w->layout()) {
            w->updateGeometry();
            w->layout()->activate();
        }
}

bool StepPage::done(const Expected<void>& result) {
    if (!result) emit desk_.trouble(shown_error(result.error()));
    return result.has_value();
}

bool StepPage::all_is_taken() {
    for (StepPage* page : window()->findChildren<StepPage*>())
        if (QWidget* refused = refused_field(*page, false)) {
            if (page != this) emit step_wanted(page->step());
            emit desk_.trouble(page->point_at(*refused));
            return false;
        }
    const QString why = take_refused_number(*this);
    if (!why.isEmpty()) emit desk_.trouble(why);
    return why.isEmpty();
}

bool StepPage::done_or_shown(const Expected<void>& result) {
    if (!done(result)) later();
    return result.has_value();
}

QString StepPage::shown_part(const std::string& id) {
    static const QRegularExpression unnamed(QStringLiteral("^run (\\d+)$"));
    const QString name = QString::fromStdString(id);
    if (const auto match = unnamed.match(name); match.hasMatch()) return tr("run %1").arg(match.captured(1));
    const auto behind = [&](std::string_view prefix) {
        return name.mid(static_cast<qsizetype>(prefix.size()));
    };
    if (id.starts_with(kZeroShiftPrefix)) return tr("zero shift %1").arg(behind(kZeroShiftPrefix));
    if (id.starts_with(kKnownShiftPrefix))
        return tr("known shift %1").arg(shown_shift(behind(kKnownShiftPrefix)));
    return name;
}

QString StepPage::shown_shift(QString name) {
    return name.replace(QStringLiteral(" deg"), QChar(0x20) + shown_word("deg"))
        .replace(QStringLiteral(" and "), QChar(0x20) + tr("and") + QChar(0x20));
}

QWidget* StepPage::make_progress() {
    auto* holder = new QWidget;
    auto* row = new QHBoxLayout(holder);
    row->setContentsMargins(0, 0, 0, 0);
    auto* bar = new QProgressBar;
    bar->setObjectName("progress");
    bar->setAccessibleName(tr("Progress"));
    bar->setToolTip(tr("How far the measuring is"));
    bar->setMinimumHeight(style::kTargetPx);
    bar->setTextVisible(true);
    auto* cancel = make_button("cancel", "stop", tr("Cancel"), tr("Stop the measuring; nothing is pushed"),
                               [this] { desk_.worker().cancel(); });
    row->addWidget(bar, 1);
    row->addWidget(cancel);
    holder->setVisible(desk_.worker().busy());
    connect(&desk_.worker(), &StationWorker::busy_changed, holder,
            [holder, bar](bool busy, const QString& what) {
                holder->setVisible(busy);
                bar->setRange(0, 0);
                bar->setFormat(what);
            });
    connect(&desk_.worker(), &StationWorker::progressed, bar, [bar](int at, int total, const QString& text) {
        bar->setRange(0, std::max(1, total));
        bar->setValue(at);
        bar->setFormat(text);
    });
    return holder;
}

}  // namespace seamwright
