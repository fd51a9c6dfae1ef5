#pragma once
// What is proven before the first part: the unmoved part reads zero, known shifts are recovered, a run
// without the screen ends ok; and the whole checklist of commissioning with its evidence.

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFrame>
#include <QSpinBox>

#include "widgets/pages/parts/budget_panel.h"
#include "widgets/pages/parts/step_page.h"

namespace seamwright {

class ProvePage : public StepPage {
    Q_OBJECT
  public:
    ProvePage(Desk& desk, const Views& views);

  signals:
    void report_wanted();

  protected:
    void refresh() override;
    QWidget* due() override;
    void entered() override;

  private:
    void make_checklist();
    void make_zero_shift();
    void make_known_shift();
    void refresh_checklist();
    void refresh_zero_shift();
    void refresh_known_shift();
    void show_item();
    QWidget* control_of(CheckStep item);
    void ask_to_place(const QString& name, const Pose& base_from_shiftedbase);
    void draw_zero_shift(const ZeroShift& zero);
    void draw_known_shift(const KnownShift& proof);
    QDoubleSpinBox* spin(const QString& name, double value, double maximum, int decimals,
                         const QString& unit);

    QTableWidget* checklist_ = nullptr;
    QLabel* finding_ = nullptr;
    QPushButton* open_ = nullptr;
    QSpinBox* count_ = nullptr;
    QComboBox* region_ = nullptr;
    QPushButton *start_zero_ = nullptr, *start_known_ = nullptr;
    QLabel *zero_verdict_ = nullptr, *known_verdict_ = nullptr;
    QTableWidget *zero_table_ = nullptr, *known_table_ = nullptr;
    BudgetPanel* budget_ = nullptr;
    QComboBox* by_ = nullptr;
    QDoubleSpinBox *range_mm_ = nullptr, *step_mm_ = nullptr, *range_deg_ = nullptr, *step_deg_ = nullptr;
    QFrame* place_ = nullptr;
    QLabel* place_text_ = nullptr;
    bool show_known_ = false;  // in the charts, instead of the zero shift
};

}  // namespace seamwright
