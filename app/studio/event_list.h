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
    Desk& desk_;
};

}  // namespace seamwright
