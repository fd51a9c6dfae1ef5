#pragma once
// Regions: which spots, what may move, limits, and what that will be able to tell.

#include <QCheckBox>
#include <QLineEdit>
#include <QListWidget>
#include <array>

#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/pages/parts/budget_panel.h"
#include "widgets/pages/parts/step_page.h"

namespace seamwright {

class RegionsPage : public StepPage {
    Q_OBJECT
  public:
    RegionsPage(Desk& desk, const Views& views);

  protected:
    void refresh() override;
    void entered() override;

  private:
    const Region* region() const;
    void show_plan(const Region& region);
    void add_region(std::vector<std::string> spot_ids);
    void take_encircled(const QStringList& ids);
    QListWidget *list_, *spots_;
    QPushButton *proven_ = nullptr, *rename_, *remove_;
    QWidget* inspector_;
    std::array<QCheckBox*, 6> free_{};
    QLineEdit* frame_;
    PoseEditor* frame_pose_;
    std::vector<ParameterEditor*> editors_;
    QLabel *verdict_, *advice_;
    QTableWidget* plan_;
    BudgetPanel* budget_;
    bool filling_ = false;
};

}  // namespace seamwright
