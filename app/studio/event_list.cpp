#include "app/studio/event_list.h"

#include <QDateTime>
#include <QHeaderView>

#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr std::size_t kShown = 500;
}

QString EventList::kind_text(EventKind kind) {
    switch (kind) {
        case EventKind::note:
            return tr("note");
        case EventKind::refusal:
            return tr("refusal");
        case EventKind::push_attempt:
            return tr("push attempt");
        case EventKind::push:
            return tr("push");
        case EventKind::alarm:
            return tr("ALARM");
        case EventKind::device:
            return tr("device");
    }
    return {};
}

EventList::EventList(Desk& desk) : QTableWidget(0, 5), desk_(desk) {
    setObjectName("events");
    setAccessibleName(tr("Event log"));
    setToolTip(tr("What happened, newest first"));
    setHorizontalHeaderLabels({tr("When"), tr("Kind"), tr("Subject"), tr("Person"), tr("Text")});
    setEditTriggers(QAbstractItemView::NoEditTriggers);
    setSelectionBehavior(QAbstractItemView::SelectRows);
    setTabKeyNavigation(false);
    setShowGrid(false);
    verticalHeader()->hide();
    verticalHeader()->setDefaultSectionSize(style::kTargetPx - 4);
    horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    horizontalHeader()->setStretchLastSection(true);
    connect(&desk_, &Desk::events_changed, this, [this] {
        if (isVisible()) refresh();
    });
}

void EventList::showEvent(QShowEvent* event) {
    QTableWidget::showEvent(event);
    refresh();
}

void EventList::refresh() {
    const auto events = desk_.events();
    if (!events) return;
    const std::size_t n = std::min(events->size(), kShown);
    setRowCount(static_cast<int>(n));
    for (std::size_t i = 0; i < n; ++i) {
        const EventRecord& e = (*events)[events->size() - 1 - i];
        const QDateTime at = QDateTime::fromString(QString::fromStdString(e.utc), Qt::ISODateWithMs);
        const QStringList row{at.toLocalTime().toString("dd.MM. HH:mm:ss"), kind_text(e.kind),
                              QString::fromStdString(e.subject), QString::fromStdString(e.person),
                              shown(e.text)};
        for (int c = 0; c < 5; ++c) {
            auto* item = new QTableWidgetItem(row[c]);
            item->setToolTip(row[c]);
            if (e.kind == EventKind::alarm) item->setForeground(style::alarm(palette()));
            setItem(static_cast<int>(i), c, item);
        }
    }
}

}  // namespace seamwright
