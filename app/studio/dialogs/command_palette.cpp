#include "app/studio/dialogs/command_palette.h"

#include <QKeyEvent>
#include <QTimer>
#include <QVBoxLayout>
#include <algorithm>

#include "widgets/menu_signs.h"
#include "widgets/style.h"

namespace seamwright {

int fuzzy_score(const QString& typed, const QString& text) {
    int score = 0, at = 0, run = 0;
    for (const QChar wanted : typed) {
        if (wanted.isSpace()) continue;
        int found = -1;
        for (int i = at; i < text.size(); ++i)
            if (text[i].toCaseFolded() == wanted.toCaseFolded()) {
                found = i;
                break;
            }
        if (found < 0) return -1;
        run = found == at ? run + 1 : 0;
        const bool begins = found == 0 || !text[found - 1].isLetterOrNumber();
        score += 1 + 3 * run + (begins ? 5 : 0);
        at = found + 1;
    }
    return score;
}

CommandPalette::CommandPalette(const QList<QAction*>& actions, QWidget* parent)
    : QDialog(parent), actions_(actions) {
    setWindowTitle(tr("All actions"));
    resize(560, 420);
    auto* box = new QVBoxLayout(this);
    input_ = new QLineEdit;
    input_->setObjectName("palette_input");
    input_->setPlaceholderText(tr("Type a few letters"));
    input_->setAccessibleName(tr("Search actions"));
    input_->setToolTip(tr("Letters in order; Enter runs the marked action"));
    list_ = new QListWidget;
    list_->setObjectName("palette_list");
    list_->setAccessibleName(tr("Actions found"));
    list_->setToolTip(tr("Enter or double click runs an action"));
    box->addWidget(input_);
    box->addWidget(list_);
    input_->installEventFilter(this);
    connect(input_, &QLineEdit::textChanged, this, &CommandPalette::fill);
    connect(input_, &QLineEdit::returnPressed, this, &CommandPalette::run);
    connect(list_, &QListWidget::itemActivated, this, &CommandPalette::run);
    fill({});
}

bool CommandPalette::eventFilter(QObject* watched, QEvent* event) {
    if (event->type() == QEvent::KeyPress) {
        const int key = static_cast<QKeyEvent*>(event)->key();
        if (key == Qt::Key_Down || key == Qt::Key_Up) {
            const int next = list_->currentRow() + (key == Qt::Key_Down ? 1 : -1);
            list_->setCurrentRow(std::clamp(next, 0, list_->count() - 1));
            return true;
        }
    }
    return QDialog::eventFilter(watched, event);
}

void CommandPalette::fill(const QString& typed) {
    std::vector<std::pair<int, QAction*>> hits;
    for (QAction* action : actions_) {
        const int score = fuzzy_score(typed, without_marks(action->text()));
        if (score >= 0) hits.emplace_back(score, action);
    }
    std::stable_sort(hits.begin(), hits.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    list_->clear();
    for (const auto& [score, action] : hits) {
        QString text = without_marks(action->text());
        if (!action->shortcut().isEmpty())
            text += QStringLiteral("    ") + action->shortcut().toString(QKeySequence::NativeText);
        auto* item = new QListWidgetItem(action->icon(), text, list_);
        item->setData(Qt::UserRole, QVariant::fromValue<void*>(action));
        item->setSizeHint({0, style::kTargetPx});
        if (!action->isEnabled()) item->setFlags(item->flags() & ~Qt::ItemIsEnabled);
    }
    list_->setCurrentRow(0);
}

void CommandPalette::run() {
    const QListWidgetItem* item = list_->currentItem();
    if (!item || !(item->flags() & Qt::ItemIsEnabled)) return;
    auto* action = static_cast<QAction*>(item->data(Qt::UserRole).value<void*>());
    accept();
    QTimer::singleShot(0, action, &QAction::trigger);
}

}  // namespace seamwright
