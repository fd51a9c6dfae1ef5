#include "widgets/editors/list_habits.h"

#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QContextMenuEvent>
#include <QHeaderView>
#include <QKeyEvent>
#include <QMenu>
#include <QRegularExpression>
#include <QTableView>
#include <QTreeView>
#include <algorithm>

namespace seamwright {
namespace {

bool is_hidden(const QAbstractItemView& view, int column) {
    if (const auto* table = qobject_cast<const QTableView*>(&view)) return table->isColumnHidden(column);
    if (const auto* tree = qobject_cast<const QTreeView*>(&view)) return tree->isColumnHidden(column);
    return false;
}

// The list that a mouse or key event goes to; a choice's popup is none.
QAbstractItemView* list_of(QObject* object) {
    auto* view = qobject_cast<QAbstractItemView*>(object);
    if (!view && object->parent()) {
        auto* parent = qobject_cast<QAbstractItemView*>(object->parent());
        if (parent && parent->viewport() == object) view = parent;
    }
    if (!view || qobject_cast<QHeaderView*>(view) || view->window()->windowType() == Qt::Popup)
        return nullptr;
    return view;
}

void copy(const QAbstractItemView& view) {
    if (const QString rows = chosen_rows(view); !rows.isEmpty()) QApplication::clipboard()->setText(rows);
}

void show_menu(QAbstractItemView& view, const QPoint& at) {
    auto* menu = new QMenu(&view);
    menu->setObjectName("list_menu");
    menu->setAttribute(Qt::WA_DeleteOnClose);
    for (QAction* deed : view.actions()) menu->addAction(deed);
    QAction* copied = menu->addAction(ListHabits::tr("Copy rows"), &view, [&view] { copy(view); });
    copied->setShortcut(QKeySequence::Copy);
    copied->setEnabled(view.selectionModel() && view.selectionModel()->hasSelection());
    menu->popup(at);
}

}  // namespace

QString chosen_rows(const QAbstractItemView& view) {
    if (!view.selectionModel()) return {};
    QModelIndexList firsts;  // of each row, once
    for (const QModelIndex& index : view.selectionModel()->selectedIndexes())
        if (const QModelIndex first = index.siblingAtColumn(0); !firsts.contains(first)) firsts << first;
    std::ranges::sort(firsts, {}, [&](const QModelIndex& index) { return view.visualRect(index).top(); });
    QStringList lines;
    for (const QModelIndex& first : firsts) {
        QStringList cells;
        for (int c = 0; c < view.model()->columnCount(first.parent()); ++c)
            if (!is_hidden(view, c)) {
                QString cell = first.siblingAtColumn(c).data().toString();
                cells << cell.replace(QRegularExpression(QStringLiteral("[\\t\\r\\n]+")),
                                      QStringLiteral(" "));
            }
        lines << cells.join('\t');
    }
    return lines.join('\n');
}

void add_list_deed(QAbstractItemView& view, QPushButton& button, const QKeySequence& key,
                   std::function<bool()> applies) {
    auto* deed = new QAction(button.icon(), button.text(), &view);
    deed->setToolTip(button.toolTip());
    deed->setShortcut(key);
    deed->setShortcutContext(Qt::WidgetShortcut);
    QObject::connect(deed, &QAction::triggered, &button, [&button, applies = std::move(applies)] {
        if (!applies || applies()) button.click();
    });
    view.addAction(deed);
}

bool ListHabits::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::KeyPress && static_cast<QKeyEvent*>(event)->matches(QKeySequence::Copy)) {
        if (const auto* view = list_of(watched)) {
            copy(*view);
            return true;
        }
    } else if (event->type() == QEvent::ContextMenu) {
        auto* view = list_of(watched);
        if (view && view->contextMenuPolicy() == Qt::DefaultContextMenu) {
            show_menu(*view, static_cast<QContextMenuEvent*>(event)->globalPos());
            return true;
        }
    }
    return QObject::eventFilter(watched, event);
}

}  // namespace seamwright
