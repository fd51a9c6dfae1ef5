#pragma once
// The project's calibrations as cards: method, verdict, age, which one is in use, and the command that makes
// one.

#include <QComboBox>

#include "widgets/pages/step_page.h"

namespace seamwright {

class CalibratePage : public StepPage {
    Q_OBJECT
  public:
    CalibratePage(Desk& desk, const Views& views);

  protected:
    void refresh() override;

  private:
    void take_simulated();

    QVBoxLayout* cards_;
    QWidget* simulated_ = nullptr;
    std::string shown_;
};

}  // namespace seamwright
