#pragma once
// Spots: where the robot stands, which feature of the contour, its reference.

#include <QCheckBox>
#include <QComboBox>
#include <QListWidget>
#include <QSpinBox>
#include <optional>

#include "widgets/editors/parameter_editor.h"
#include "widgets/editors/pose_editor.h"
#include "widgets/pages/parts/spot_head.h"
#include "widgets/pages/parts/spot_light_panel.h"
#include "widgets/pages/parts/spot_tree.h"
#include "widgets/pages/parts/step_page.h"

namespace seamwright {

class TeachPage : public StepPage {
    Q_OBJECT
  public:
    TeachPage(Desk& desk, const Views& views);

  protected:
    void refresh() override;
    QWidget* due() override;
    void entered() override;
    void hideEvent(QHideEvent* event) override;

  private:
    void make_fixed_head();
    void do_deed(SpotDeed deed);
    void make_list();
    void make_switches(QVBoxLayout& in);
    void make_pose(QVBoxLayout& in);
    void make_via_points(QVBoxLayout& in);
    void make_devices(QVBoxLayout& in);
    void make_feature(QVBoxLayout& in);
    void make_reference(QVBoxLayout& in);
    void make_fields(QVBoxLayout& in);
    void listen_to_profile();
    void take_reference(const TaughtSpot& taught);
    void take_confirmed(const Confirmation& found);

    const Spot* spot() const;
    // What was measured with another pose, sensor, robot or feature goes with the edit.
    bool change(const Spot& after, const QString& what);
    void add_spot();
    void duplicate_spot();
    void rename_spot();
    std::optional<Pose> present_pose();  // of the spot's robot; says why there is none
    void take_pose();
    void add_via();
    void set_kind(const QString& kind);
    void picked(const QPointF& point_mm);
    void take_template(const QRectF& window_mm);
    void take_landmark(const QPointF& point_mm);
    void forget_tool();  // a template's, in the live profile
    void show_parameters(const Spot& spot);

    SpotHead* spot_head_;
    SpotTree* tree_;
    QPushButton *duplicate_, *rename_, *up_, *down_, *remove_, *take_, *go_, *measure_, *confirm_;
    QPushButton *pick_, *window_, *click_;
    QCheckBox *enabled_, *required_, *stop_;
    PoseEditor* pose_;
    QListWidget* via_;
    QPushButton *add_via_, *remove_via_;
    QComboBox *sensor_, *robot_, *kind_;
    QLabel *kind_help_, *reference_, *spread_;
    Spot spread_of_;  // as it was when measured
    QSpinBox* repeats_;
    SpotLightPanel* light_;
    QVBoxLayout *parameters_, *fields_;
    QWidget* inspector_;
    std::string shown_kind_;
    std::vector<ParameterEditor*> parameter_editors_, field_editors_;
};

}  // namespace seamwright
