#pragma once
// A guided calibration, the same page for every method: prepare, capture, solve, verify, use. Driven by
// CalibrationDesk.

#include <QImage>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>
#include <map>

#include "core/ids.h"
#include "widgets/calibrate/coverage_view.h"
#include "widgets/calibrate/method_drawing.h"
#include "widgets/calibrate/target_view.h"
#include "widgets/desk/calibration_desk.h"
#include "widgets/desk/calibration_series.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"

namespace seamwright {

class GuidedPage : public QWidget {
    Q_OBJECT
  public:
    explicit GuidedPage(Desk& desk);

    CalibrationDesk& calibration() { return calibration_; }
    // What must stay in sight while the page scrolls: the stage, what was refused, progress and Cancel, and the one key
    // that leads on. Whoever shows the page places it above; it shows and hides with the page.
    QWidget* head() const { return head_; }
    bool begin(const MethodId& method, const SensorId& sensor, const RobotId& robot);

  signals:
    void left();  // back to the overview
    // Where the robot is to go next; nullopt: nowhere, or no calibration is shown.
    void proposed(std::optional<seamwright::Pose> base_from_flange);
    // What is being calibrated and how far it is, while the page is shown and something is left to do in it; else empty.
    void under_way(const QString& words);
    void connect_wanted();  // of all devices of the project

  protected:
    void showEvent(QShowEvent* event) override;
    void hideEvent(QHideEvent* event) override;

  private:
    void make_head();
    void make_prepare(QVBoxLayout& box);
    void make_capture(QVBoxLayout& box);
    void make_list(QVBoxLayout& box);
    void make_verdict(QVBoxLayout& box);
    void make_use(QVBoxLayout& box);

    void refresh();
    void refresh_who();
    void refresh_stage();
    QString missing() const;  // why nothing can be captured; empty: it can
    bool loaded() const;      // captures came from files
    void refresh_settings();
    void refresh_base();
    void refresh_table();
    void refresh_coverage();
    void refresh_next();
    void refresh_verdict();
    void refresh_convention();
    void refresh_use();
    void refresh_busy();
    void refresh_live();
    void ticked(QTableWidgetItem* item);
    std::string selected() const;
    const EntryPicture& picture(const SessionCapture& capture);
    QIcon thumbnail(const SessionCapture& capture);
    void load(bool folder);
    void set_target();
    void go_there();
    void leave();
    void mark_next();  // the one key of this page that leads on
    void lead();       // presses it
    void keep_focus(bool busy);
    void say(const QString& sentence);
    bool take_typed();  // false: a field of this page holds what it refused, which is said
    bool first_in_doubt() const;
    void show_target(bool target);  // before the simulated sensor, or its part again
    void state_repeatability();
    void propose(const std::optional<Pose>& base_from_flange);
    bool simulated_sensor() const;
    bool stored() const;
    std::optional<Pose> flange() const;
    bool done(const Expected<void>& result);

    Desk& desk_;
    CalibrationDesk calibration_;
    CalibrationSeries series_;
    QWidget* head_;
    QLabel *title_, *who_, *stage_, *why_, *need_, *base_, *said_;
    QPushButton *lead_, *leads_to_ = nullptr;  // in the head, and the key of the page that it presses
    QWidget* robot_holder_;
    ParameterEditor *robot_mm_, *robot_deg_;
    MethodDrawing* drawing_;
    PoseEditor* nominal_;
    QWidget *prepare_, *settings_holder_, *nominal_holder_, *capture_box_, *solve_box_, *verify_box_;
    QVBoxLayout* settings_box_;
    TargetView* target_;
    QPushButton *undo_, *redo_, *needs_, *capture_, *automatic_, *load_, *load_folder_, *set_target_,
        *go_there_, *capture_all_, *copy_next_, *connect_;
    QPushButton *detect_, *take_convention_, *verification_, *remove_, *solve_, *cancel_, *verify_, *use_,
        *keep_, *anew_;
    QLabel *convention_, *next_, *next_words_, *count_, *verdict_, *reason_, *verified_, *stands_, *compared_,
        *used_;
    QTableWidget *table_, *parameters_;
    CoverageView* coverage_;
    QProgressBar* progress_;
    std::string shown_method_;
    std::map<std::shared_ptr<const CalibrationCapture>, std::pair<EntryPicture, QIcon>> pictures_;
    std::optional<Pose> proposed_;
    bool needs_shown_ = true, target_set_ = false, focus_waits_ = false;
    QString under_way_;
};

}  // namespace seamwright
