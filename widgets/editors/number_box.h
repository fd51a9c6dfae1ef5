#pragma once
// A spin box that writes numbers as the rest of the window and the robot do, with a point, and takes point
// and comma, whatever the language.

#include <QDoubleSpinBox>
#include <QRegularExpression>

#include "widgets/editors/parameter_editor.h"

namespace seamwright {

class NumberBox : public QDoubleSpinBox {
  public:
    using QDoubleSpinBox::QDoubleSpinBox;
    QString textFromValue(double value) const override { return text_from_number(value, decimals()); }
    double valueFromText(const QString& text) const override {
        return number_from_text(bare(text)).value_or(value());
    }
    QValidator::State validate(QString& text, int&) const override {
        static const QRegularExpression begun(R"(^[+-]?\d*[.,]?\d*$)");
        const auto number = number_from_text(bare(text));
        if (number && *number >= minimum() && *number <= maximum()) return QValidator::Acceptable;
        return begun.match(bare(text)).hasMatch() ? QValidator::Intermediate : QValidator::Invalid;
    }

  private:
    QString bare(QString text) const {
        if (text.endsWith(suffix())) text.chop(suffix().size());
        return text.trimmed();
    }
};

}  // namespace seamwright
