// What the page is made of.

#include "core/features/kinds/feature_registry.h"
#include "projects/measure/fields.h"
#include "widgets/editors/list_habits.h"
#include "widgets/pages/teach_page.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {

void TeachPage::make_fixed_head() {
    QVBoxLayout& head = make_head();
    spot_head_ = new SpotHead(desk_);
    head.addWidget(spot_head_);
    head.addWidget(make_progress());
    connect(spot_head_, &SpotHead::wanted, this, &TeachPage::do_deed);
}

void TeachPage::make_list() {
    tree_ = new SpotTree(desk_);
    box().addWidget(tree_);
    duplicate_ = make_button("duplicate_spot", "copy", tr("Duplicate"), tr("The same spot once more"),
                             [this] { duplicate_spot(); });
    rename_ = make_button("rename_spot", "rename", tr("Rename"), tr("Another name for the spot"),
                          [this] { rename_spot(); });
    up_ = make_button("spot_up", "up", tr("Up"), tr("Measure it one earlier"), [this] {
        if (spot())
            done_or_shown(desk_.move<Spot>(spot()->id, index_of<Spot>(desk_.project(), spot()->id) - 1));
    });
    down_ = make_button("spot_down", "down", tr("Down"), tr("Measure it one later"), [this] {
        if (spot())
            done_or_shown(desk_.move<Spot>(spot()->id, index_of<Spot>(desk_.project(), spot()->id) + 1));
    });
    remove_ = make_button("remove_spot", "remove", tr("Remove"), tr("Take the spot out; undo brings it back"),
                          [this] {
                              if (spot()) done_or_shown(desk_.remove<Spot>(spot()->id));
                          });
    box().addLayout(
        make_row({make_button("add_spot", "add", tr("Add spot"), tr("A new spot at the robot's present pose"),
                              [this] { add_spot(); }),
                  duplicate_, rename_}));
    box().addLayout(make_row({up_, down_, remove_}));
    const auto on_spot = [this] { return tree_->on_spot(); };
    add_list_deed(*tree_, *rename_, Qt::Key_F2, on_spot);
    add_list_deed(*tree_, *duplicate_, {}, on_spot);
    add_list_deed(*tree_, *remove_, QKeySequence::Delete, on_spot);
}

void TeachPage::make_switches(QVBoxLayout& in) {
    enabled_ = new QCheckBox(tr("Enabled"));
    enabled_->setObjectName("spot_enabled");
    enabled_->setToolTip(tr("A disabled spot is not measured"));
    required_ = new QCheckBox(tr("Required"));
    required_->setObjectName("spot_required");
    required_->setToolTip(tr("Nothing is pushed when a required spot was not measured"));
    for (QCheckBox* b : {enabled_, required_}) b->setMinimumHeight(style::kTargetPx);
    connect(enabled_, &QCheckBox::clicked, this, [this](bool on) {
        if (spot()) done_or_shown(desk_.set_spot_enabled(spot()->id, on));
    });
    connect(required_, &QCheckBox::clicked, this, [this](bool on) {
        if (!spot()) return;
        Spot s = *spot();
        s.required = on;
        done_or_shown(desk_.edit(s, tr("required")));
    });
    in.addLayout(make_row({enabled_, required_}));
    stop_ = new QCheckBox(tr("Stand still at the trigger"));
    stop_->setObjectName("spot_stop");
    stop_->setToolTip(
        tr("The robot stops, measures and goes on: no trigger jitter, but it costs time. Write the robot's "
           "program anew after a change."));
    stop_->setMinimumHeight(style::kTargetPx);
    connect(stop_, &QCheckBox::clicked, this, [this](bool on) {
        if (!spot()) return;
        Spot s = *spot();
        s.stop_at_trigger = on;
        done_or_shown(desk_.edit(s, tr("stand still at the trigger")));
    });
    in.addLayout(make_row({stop_}));
}

void TeachPage::make_pose(QVBoxLayout& in) {
    in.addWidget(make_heading(tr("Pose of the flange at the trigger")));
    pose_ = new PoseEditor;
    pose_->setObjectName("spot_pose");
    pose_->setAccessibleName(tr("Pose of the flange at the trigger"));
    pose_->setToolTip(
        tr("base_from_flange, in the notation of the robot's brand; paste a whole pose into any field"));
    in.addWidget(pose_);
    connect(pose_, &PoseEditor::committed, this, [this] {
        if (!spot()) return;
        Spot s = *spot();
        s.base_from_flange = pose_->pose();
        change(s, tr("pose"));
    });
    take_ = make_button("take_pose", "robot", tr("Take from the robot"),
                        tr("The pose where the robot stands now"), [this] { take_pose(); });
    go_ = make_button("go_there", "shift", tr("Go there"),
                      tr("Moves the robot straight to the spot: look whether the way is free"), [this] {
                          if (spot() && all_is_taken())
                              desk_.go_to(spot()->robot_id, spot()->base_from_flange);
                      });
    in.addLayout(make_row({take_, go_,
                           make_button("open_jog", "robot", tr("Jog"), tr("Move the robot by hand (F8)"),
                                       [this] { views_.raise(views_.jog); })}));
}

void TeachPage::make_via_points(QVBoxLayout& in) {
    in.addWidget(make_heading(tr("Via points")));
    via_ = new QListWidget;
    via_->setObjectName("spot_via");
    via_->setAccessibleName(tr("Via points"));
    via_->setToolTip(
        tr("Passed in this order on the way from the spot before. Write the robot's program anew after a "
           "change."));
    via_->setMaximumHeight(3 * style::kTargetPx);
    in.addWidget(via_);
    add_via_ = make_button("add_via", "add", tr("Add here"),
                           tr("The pose where the robot stands now, behind the selected via point"),
                           [this] { add_via(); });
    remove_via_ = make_button("remove_via", "remove", tr("Remove point"),
                              tr("Take the selected via point out; undo brings it back"), [this] {
                                  const int row = via_->currentRow();
                                  if (!spot() || row < 0) return;
                                  Spot s = *spot();
                                  s.via.erase(s.via.begin() + row);
                                  done_or_shown(desk_.edit(s, tr("via points")));
                              });
    in.addLayout(make_row({add_via_, remove_via_}));
    connect(via_, &QListWidget::currentRowChanged, this,
            [this](int row) { remove_via_->setEnabled(row >= 0); });
}

void TeachPage::make_devices(QVBoxLayout& in) {
    sensor_ = new QComboBox;
    sensor_->setObjectName("spot_sensor");
    add_field(in, tr("Sensor"), sensor_, tr("The sensor that looks at the spot"));
    robot_ = new QComboBox;
    robot_->setObjectName("spot_robot");
    add_field(in, tr("Robot"), robot_, tr("The robot that carries the sensor"));
    connect(sensor_, &QComboBox::textActivated, this, [this](const QString& id) {
        if (!spot()) return;
        Spot s = *spot();
        s.sensor_id = id.toStdString();
        change(s, tr("sensor"));
    });
    connect(robot_, &QComboBox::textActivated, this, [this](const QString& id) {
        if (!spot()) return;
        Spot s = *spot();
        s.robot_id = id.toStdString();
        change(s, tr("robot"));
    });
}

void TeachPage::make_feature(QVBoxLayout& in) {
    in.addWidget(make_heading(tr("Feature of the contour")));
    kind_ = new QComboBox;
    kind_->setObjectName("feature_kind");
    for (const FeatureKind& k : feature_kinds())
        kind_->addItem(shown_word(k.name), QString::fromStdString(std::string(k.name)));
    add_field(in, tr("Kind"), kind_, tr("Which point of the contour is measured"));
    connect(kind_, &QComboBox::activated, this,
            [this](int row) { set_kind(kind_->itemData(row).toString()); });
    kind_help_ = make_text({});
    in.addWidget(kind_help_);
    pick_ = make_button("pick", "pick", tr("Point at it"),
                        tr("Click the contour in the live profile, where the feature is"), [this] {
                            views_.profile->set_tool(ProfilePlot::Tool::inspect);
                            views_.raise(views_.profile);
                            views_.profile->setFocus();
                        });
    window_ =
        make_button("template_window", "window", tr("Drag template"),
                    tr("Drag a window in the live profile: the contour inside becomes the template"), [this] {
                        views_.profile->set_tool(ProfilePlot::Tool::window);
                        views_.raise(views_.profile);
                        views_.profile->setFocus();
                    });
    click_ =
        make_button("reference_click", "target", tr("Reference by click"),
                    tr("Click the template's reference point in the live profile; it need not lie on the "
                       "contour. Measure the reference anew then."),
                    [this] {
                        views_.profile->set_tool(ProfilePlot::Tool::reference);
                        views_.raise(views_.profile);
                        views_.profile->setFocus();
                    });
    in.addLayout(make_row({pick_, window_}));
    in.addLayout(make_row({click_}));
    parameters_ = new QVBoxLayout;
    in.addLayout(parameters_);
}

void TeachPage::make_reference(QVBoxLayout& in) {
    in.addWidget(make_heading(tr("Reference")));
    reference_ = make_text({});
    reference_->setObjectName("reference");
    in.addWidget(reference_);
    repeats_ = new QSpinBox;
    repeats_->setObjectName("repeats");
    repeats_->setRange(1, 1000);
    repeats_->setValue(TeachOptions().repeats);
    add_field(in, tr("Repeats"), repeats_, tr("How often the reference is measured"));
    measure_ =
        make_button("measure_reference", "measure", tr("Measure reference"),
                    tr("The robot stands still at the spot and measures; mean and spread are shown"), [this] {
                        if (spot() && all_is_taken()) desk_.worker().teach(*spot(), repeats_->value());
                    });
    confirm_ = make_button(
        "confirm_spot", "check", tr("Confirm"),
        tr("The robot measures the spot from the drawing on the part; where it is plausible, what was "
           "measured becomes its reference"),
        [this] {
            if (spot() && all_is_taken()) desk_.worker().confirm(spot()->id);
        });
    in.addLayout(make_row({measure_, confirm_}));
    spread_ = make_text({});
    spread_->setObjectName("spread");
    in.addWidget(spread_);
}

void TeachPage::make_fields(QVBoxLayout& in) {
    in.addWidget(make_heading(tr("Pass, weights and noise")));
    fields_ = new QVBoxLayout;
    in.addLayout(fields_);
    for (const Field<Spot>& f : spot_fields()) {
        auto* editor = new ParameterEditor(f.info);
        connect(editor, &ParameterEditor::committed, this, [this, name = f.info.name](double value) {
            if (spot()) done_or_shown(desk_.set_spot_field(SpotId(spot()->id), name, value));
        });
        field_editors_.push_back(editor);
        fields_->addWidget(editor);
    }
}

}  // namespace seamwright
