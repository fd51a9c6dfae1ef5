#include "widgets/editors/number_box.h"

#include <QKeyEvent>
#include <QLineEdit>
#include <algorithm>
#include <utility>

#include "widgets/style.h"

namespace seamwright {

NumberBox::NumberBox(QWidget* parent) : QDoubleSpinBox(parent) {
    // Of "1e300" the 1 alone would be taken on the way.
    setKeyboardTracking(false);
    connect(lineEdit(), &QLineEdit::textEdited, this, [this] { say({}); });
    connect(this, &QDoubleSpinBox::valueChanged, this, [this] { say({}); });
}

double NumberBox::valueFromText(const QString& text) const {
    return number_from_text(bare(text)).value_or(value());
}

QValidator::State NumberBox::validate(QString& text, int&) const {
    const auto number = number_from_text(bare(text));
    return number && *number >= minimum() && *number <= maximum() ? QValidator::Acceptable
                                                                  : QValidator::Intermediate;
}

QString NumberBox::reason() const {
    return reason_;
}

QString NumberBox::take_reason() {
    if (hasFocus()) {
        look();
        const QString why = reason_;
        interpretText();
        say(why);
    }
    return std::exchange(reason_, {});
}

QString take_refused_number(const QWidget& whole) {
    for (QDoubleSpinBox* spin : whole.findChildren<QDoubleSpinBox*>())
        if (auto* box = dynamic_cast<NumberBox*>(spin); box && box->isVisibleTo(&whole))
            if (const QString why = box->take_reason(); !why.isEmpty())
                return ParameterEditor::tr("%1 Nothing was begun: press again to go on with it.").arg(why);
    return {};
}

QString NumberBox::bare(QString text) const {
    if (text.endsWith(suffix())) text.chop(suffix().size());
    return text.trimmed();
}

void NumberBox::look() {
    const QString typed = bare(lineEdit()->text());
    const auto number = number_from_text(typed);
    if (number && *number >= minimum() && *number <= maximum()) return;
    const QString why =
        number ? ParameterEditor::tr("outside %1")
                     .arg(textFromValue(minimum()) + " .. " + textFromValue(maximum()) + suffix())
               : ParameterEditor::tr("not a number");
    say(ParameterEditor::tr("\"%1\" is refused: %2. %3 stays.")
            .arg(typed.left(kTypedSigns), why, textFromValue(value()) + suffix()));
}

void NumberBox::say(const QString& reason) {
    reason_ = reason;
    if (reason.isEmpty()) {
        if (said_) said_->hide();
        return;
    }
    if (!parentWidget()) return;
    if (!said_) {
        said_ = new QLabel(parentWidget());
        said_->setObjectName("number_refused");
        said_->setWordWrap(true);
        said_->setAutoFillBackground(true);
        said_->setBackgroundRole(QPalette::Base);
        said_->setContentsMargins(6, 2, 6, 2);
        connect(this, &QObject::destroyed, said_, &QObject::deleteLater);
    }
    QPalette red = said_->palette();
    red.setColor(QPalette::WindowText, style::alarm(palette()));
    said_->setPalette(red);
    said_->setText(reason);
    const int height = said_->heightForWidth(width());
    const bool below = y() + this->height() + height <= parentWidget()->height();
    said_->setGeometry(x(), below ? y() + this->height() : std::max(0, y() - height), width(), height);
    said_->raise();
    said_->show();
}

void NumberBox::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter) look();
    QDoubleSpinBox::keyPressEvent(event);
}

void NumberBox::focusOutEvent(QFocusEvent* event) {
    look();
    QDoubleSpinBox::focusOutEvent(event);
}

void NumberBox::hideEvent(QHideEvent* event) {
    say({});
    QDoubleSpinBox::hideEvent(event);
}

}  // namespace seamwright
