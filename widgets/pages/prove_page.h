#pragma once
// Zero shift: the unmoved part measured N times must read zero.

#include <QComboBox>
#include <QSpinBox>

#include "widgets/pages/step_page.h"

namespace seamwright {

class ProvePage : public StepPage {
    Q_OBJECT
  public:
    ProvePage(Desk& desk, const Views& views);

  protected:
    void refresh() override;
    void entered() override;

  private:
    QSpinBox* count_;
    QComboBox* region_;
    QPushButton* start_;
    QLabel* verdict_;
    QTableWidget* table_;
    QString shown_;
};

}  // namespace seamwright
