#pragma once
// Regions: which spots, what may move, limits, and what that will be able to tell.

#include <QCheckBox>
#include <QListWidget>
#include <array>

#include "widgets/editors/name_editor.h"
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
    QWidget* due() override;
    void entered() override;
    void hideEvent(QHideEvent* event) override;

  private:
    const Region* region() const;
    void show_plan(const Region& region);
    void add_region(std::vector<std::string> spot_ids);
    void take_encircled(const QStringList& ids);
    // The frame by 3-2-1 from places that are clicked on the part (core/geometry/three_two_one.h).
    void pick_frame();
    void picked(const Eigen::Vector3d& workobject_mm);
    void end_pick();
    void say_pick();
    QListWidget *list_, *spots_;
    QPushButton *proven_ = nullptr, *rename_, *remove_;
    QWidget* inspector_;
    std::array<QCheckBox*, 6> free_{};
    NameEditor* frame_;
    PoseEditor* frame_pose_;
    std::vector<ParameterEditor*> editors_;
    QLabel *verdict_, *advice_;
    QTableWidget* plan_;
    BudgetPanel* budget_;
    QLabel* pick_said_;
    bool picking_ = false;
    std::string picks_of_;  // the region of the project that the frame is picked for
    std::vector<Eigen::Vector3d> picks_;
    bool filling_ = false;
};

}  // namespace seamwright
