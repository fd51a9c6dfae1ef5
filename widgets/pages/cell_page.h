#pragma once
// Sensors, robots and the part: what there is, whether it answers, and its settings.

#include <QComboBox>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <array>
#include <optional>

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
    QString take_typed() override;

  protected:
    void refresh() override;
    QWidget* due() override;
    void keyPressEvent(QKeyEvent* event) override;

  private:
    void add_device(bool sensor);
    void remove_device();
    void rename_device();
    static constexpr std::array kModes{RobotMode::unknown, RobotMode::manual_reduced, RobotMode::manual_full,
                                       RobotMode::automatic, RobotMode::external};
    // A sensor's mode is RobotMode::unknown.
    struct Setup {
        bool sensor = false;
        std::string id, driver;
        nlohmann::json settings;
        RobotMode mode = RobotMode::unknown;
        bool operator==(const Setup&) const = default;
    };
    std::optional<Setup> stored(bool sensor, const std::string& id) const;  // in the project
    bool is_pending() const;  // the form has something that the project has not
    std::string driver() const;
    RobotMode mode() const;
    QString refusal() const;  // of what the form has; empty: none
    static QString not_taken(const QString& id, const QString& why);
    Expected<void> apply();  // of the device that is shown
    void show_refused();
    bool take_or_tell();
    void take_back();  // the form shows the project's again
    void connect_devices();
    void show_device();
    void show_setup(const Setup& setup);
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
    std::string shown_parameters_;
    std::optional<Setup> shown_;  // what the form was filled with
    std::uint64_t placed_ = 0;
};

}  // namespace seamwright
