#pragma once
// The checklist as navigation: the steps, each with its state in words, one of them next.

#include <QLabel>
#include <QPushButton>
#include <QWidget>
#include <array>

#include "widgets/desk/desk.h"

namespace seamwright {

class StepRail : public QWidget {
    Q_OBJECT
  public:
    explicit StepRail(Desk& desk);
    void show_step(Step step);
    // Of a small window: numbers alone, the steps' names in the tips and their states in small type; the views have the
    // room.
    void set_narrow(bool narrow);

  signals:
    void step_chosen(seamwright::Step step);

  private:
    void refresh();
    Desk& desk_;
    bool narrow_ = true;
    std::array<QPushButton*, kSteps.size()> buttons_{};
    std::array<QLabel*, kSteps.size()> states_{};
};

QString step_icon(Step step);

}  // namespace seamwright
