#pragma once
// What looks like markup is a name like others: "<b>x</b>" is shown as it is written. As an event filter of the application
// it sees every label, those of tips and message boxes too, before it is shown; one that is to be formatted says so itself
// (Qt::RichText) and escapes what it is given.

#include <QObject>

namespace seamwright {

class PlainWords : public QObject {
    Q_OBJECT
  public:
    using QObject::QObject;

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
};

}  // namespace seamwright
