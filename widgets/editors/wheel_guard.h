#pragma once
// The wheel scrolls; it does not change a value in passing. As an event filter of the application it sees every
// box: a number, a choice or a slider takes the wheel while it has the keyboard's focus and leaves it to the
// form around it otherwise, and does not take the focus by it.

#include <QObject>

namespace seamwright {

class WheelGuard : public QObject {
    Q_OBJECT
  public:
    using QObject::QObject;

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
};

}  // namespace seamwright
