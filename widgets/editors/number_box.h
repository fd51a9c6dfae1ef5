#pragma once
// A spin box that writes numbers as the rest of the window and the robot do, with a point, and takes point
// and comma, whatever the language.
//
// What is typed counts on Enter or on leaving the field, as a whole: every sign gets in, and what is no number within
// the range is refused in words below the field, where the value from before comes back.

#include <QDoubleSpinBox>
#include <QLabel>

#include "widgets/editors/parameter_editor.h"

namespace seamwright {

class NumberBox : public QDoubleSpinBox {
  public:
    explicit NumberBox(QWidget* parent = nullptr);
    QString textFromValue(double value) const override { return text_from_number(value, decimals()); }
    double valueFromText(const QString& text) const override;
    QValidator::State validate(QString& text, int&) const override;
    void fixup(QString&) const override {}  // Qt's takes the points of a German number out: 0.05 were 5
    QString reason() const;  // why the last one that was typed is refused; empty when it was taken
    // The same before a deed that goes by the number, once: whoever asks again has been told. What is still being typed counts.
    QString take_reason();

  protected:
    void keyPressEvent(QKeyEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void hideEvent(QHideEvent* event) override;

  private:
    QString bare(QString text) const;
    void look();  // at what was typed, before it is taken
    void say(const QString& reason);
    QLabel* said_ = nullptr;  // below the field, once something was refused
    QString reason_;
};

// Why the deed is not begun: the first box within `whole` that has refused what was typed says it, once. Empty: none has.
QString take_refused_number(const QWidget& whole);

}  // namespace seamwright
