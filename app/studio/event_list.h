#pragma once
// The project's event log, newest first: refusals, pushes, alarms, devices.

#include <QTableWidget>

#include "widgets/desk/desk.h"

namespace seamwright {

class EventList : public QTableWidget {
    Q_OBJECT
  public:
    explicit EventList(Desk& desk);
    void refresh();

  protected:
    void showEvent(QShowEvent* event) override;

  private:
    static QString kind_text(EventKind kind);
    Desk& desk_;
};

}  // namespace seamwright
