#include "widgets/editors/name_editor.h"

#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QVBoxLayout>

#include "widgets/into_view.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {

NameEditor::NameEditor(const QString& name, const QString& tip, Take take, QWidget* parent)
    : QWidget(parent), take_(std::move(take)), line_(new QLineEdit(this)), problem_(new QLabel(this)) {
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(2);
    column->addWidget(line_);
    column->addWidget(problem_);
    line_->setMinimumHeight(style::kTargetPx);
    line_->setAccessibleName(name);
    line_->setToolTip(tip);
    line_->installEventFilter(this);
    setFocusProxy(line_);
    problem_->setWordWrap(true);
    problem_->setAccessibleName(tr("Why the name is refused"));
    problem_->hide();
    connect(line_, &QLineEdit::editingFinished, this, &NameEditor::take_typed);
}

bool NameEditor::refused() const {
    return !problem_->isHidden();
}

void NameEditor::show_held() {
    const QString text = QString::fromStdString(held_);
    if (line_->text() != text) line_->setText(text);
    line_->setModified(false);
    problem_->hide();
}

void NameEditor::refresh(const std::string& name, const std::string& of) {
    const bool typing = line_->isModified() && of_ == of;
    held_ = name;
    of_ = of;
    if (!typing) show_held();
}

void NameEditor::take_typed() {
    if (!line_->isModified()) return;
    const std::string name = line_->text().trimmed().toStdString();
    if (const auto taken = take_(name); !taken) {
        problem_->setText(tr("refused: %1").arg(shown_error(taken.error())));
        QPalette red = problem_->palette();
        red.setColor(QPalette::WindowText, style::alarm(palette()));
        problem_->setPalette(red);
        problem_->show();
        bring_into_view(problem_);
        return;
    }
    held_ = name;
    show_held();
}

bool NameEditor::eventFilter(QObject* watched, QEvent* event) {
    if (watched == line_ && event->type() == QEvent::KeyPress &&
        static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape && line_->isModified()) {
        show_held();
        return true;
    }
    return QWidget::eventFilter(watched, event);
}

}  // namespace seamwright
