#pragma once
// Sensors, robots and the part: what there is, whether it answers, and its settings.

#include <QComboBox>
#include <QLineEdit>
#include <QPlainTextEdit>

#include "devices/genicam/genicam.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/editors/settings_editor.h"
#include "widgets/pages/parts/step_page.h"
#include "widgets/pages/parts/stripe_panel.h"

namespace seamwright {

class CellPage : public StepPage {
    Q_OBJECT
  public:
    CellPage(Desk& desk, const Views& views);

  protected:
    void refresh() override;
    QWidget* due() override;

  private:
    void add_device(bool sensor);
    void remove_device();
    void rename_device();
    void apply();
    void show_device();
    void show_setup(const std::string& driver, const nlohmann::json& settings, RobotMode mode);
    void show_table();
    void judge_settings();
    void show_parameters();
    void import_part();
    void place_part();
    void offer_cameras(const std::vector<DiscoveredCamera>& found);
    void take_camera(const DiscoveredCamera& camera);
    std::string free_sensor_id() const;
    bool sensor_chosen() const;
    std::string chosen() const;

    QTableWidget* devices_;
    QPushButton *connect_, *disconnect_, *remove_, *rename_, *apply_, *place_, *as_text_, *search_;
    QComboBox *driver_, *mode_, *unit_;
    SettingsEditor* form_;
    QPlainTextEdit* settings_;  // the same as text
    QLabel *settings_state_, *part_, *answers_;
    QWidget *mode_row_, *parameters_, *simulated_;
    QVBoxLayout* parameters_box_;
    PoseEditor* workobject_;
    StripePanel* stripe_;
    std::vector<ParameterEditor*> requirements_;
    const SettingTable* shown_table_ = nullptr;
    std::string shown_parameters_, shown_setup_;
    std::uint64_t placed_ = 0;
};

}  // namespace seamwright
