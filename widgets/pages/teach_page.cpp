#include "widgets/pages/teach_page.h"

#include <cmath>

#include "core/features/kinds/feature_registry.h"
#include "projects/measure/fields.h"
#include "projects/measure/measure.h"
#include "widgets/pages/parts/rename_dialog.h"
#include "widgets/pages/teach_live.h"
#include "widgets/shown_text.h"
#include "widgets/words.h"

namespace seamwright {

TeachPage::TeachPage(Desk& desk, const Views& views)
    : StepPage(desk, views, Step::teach,
               tr("Jog the sensor over the contour, take the pose, point at the feature, measure its "
                  "reference.")) {
    make_fixed_head();
    make_list();
    inspector_ = new QWidget;
    auto* in = new QVBoxLayout(inspector_);
    in->setContentsMargins(0, 0, 0, 0);
    box().addWidget(inspector_);
    make_switches(*in);
    make_pose(*in);
    make_via_points(*in);
    make_devices(*in);
    make_feature(*in);
    light_ = new SpotLightPanel(desk_);
    in->addWidget(light_);
    connect(light_, &SpotLightPanel::refused, this,
            [this](const Error& error) { done(tl::unexpected(error)); });
    make_reference(*in);
    make_fields(*in);
    box().addStretch(1);
    listen_to_profile();
    connect(&desk_.worker(), &StationWorker::taught, this,
            [this](const std::shared_ptr<const TaughtSpot>& taught) { take_reference(*taught); });
    connect(&desk_.worker(), &StationWorker::confirmed, this,
            [this](const std::shared_ptr<const Confirmation>& found) { take_confirmed(*found); });
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (!isVisible()) return;
        measure_->setEnabled(desk_.station().connected && spot());
        confirm_->setEnabled(desk_.station().connected && spot());
    });
}

void TeachPage::do_deed(SpotDeed deed) {
    switch (deed) {
        case SpotDeed::add:
            return add_spot();
        case SpotDeed::choose:
            return desk_.selection().select_spot(desk_.project().spots.front().id);
        case SpotDeed::piece:
            return window_->click();
        case SpotDeed::reference:
            return measure_->click();
        case SpotDeed::confirm:
            return confirm_->click();
        case SpotDeed::pass:
        case SpotDeed::accept:
            return emit step_wanted(Step::align);
        case SpotDeed::next_spot:
            return desk_.selection().select_spot(next_undone(desk_, desk_.selection().spot())->id);
        case SpotDeed::next_step:
            return emit step_wanted(Step::regions);
    }
}

void TeachPage::listen_to_profile() {
    connect(views_.profile, &ProfilePlot::point_picked, this, [this](const QPointF& p) {
        if (isVisible()) picked(p);
    });
    connect(views_.profile, &ProfilePlot::window_dragged, this, [this](const QRectF& w) {
        if (isVisible()) take_template(w);
    });
    connect(views_.profile, &ProfilePlot::reference_clicked, this, [this](const QPointF& p) {
        if (isVisible()) take_landmark(p);
    });
}

void TeachPage::take_reference(const TaughtSpot& taught) {
    const Spot* s = find_spot(desk_.project(), taught.spot.id);
    if (!s) return;
    const auto after = with_taught(*s, taught);
    if (!after) {
        done(tl::unexpected(after.error()));
        return;
    }
    if (done_or_shown(desk_.edit(*after, tr("reference")))) {
        spread_of_ = *after;
        spread_->setText(tr("Spread of %1 measurements: x %2 mm, z %3 mm (1 sigma); %4 left out")
                             .arg(taught.measurements.size())
                             .arg(number(taught.spread_mm.x(), 4), number(taught.spread_mm.y(), 4))
                             .arg(taught.left_out));
    }
}

void TeachPage::take_confirmed(const Confirmation& found) {
    if (!found.ok) {
        const SpotConfirmation& refused = found.spots.front();
        done(input_error(refused.reason, Text("spot {}", refused.spot_id),
                         "compare the drawing with the part, or teach the spot by hand"));
        return;
    }
    for (const SpotConfirmation& c : found.spots) {
        const Spot *is = find_spot(desk_.project(), c.spot_id), *made = find_spot(found.project, c.spot_id);
        if (!is || is->reference_state != ReferenceState::from_drawing || !is->drawn ||
            is->drawn->reference_mm != made->drawn->reference_mm) {
            done(input_error("it was changed while it was confirmed", Text("spot {}", c.spot_id),
                             "confirm it again"));
            return;
        }
        // Only what was measured: weights and limits may have been edited meanwhile.
        Spot after = *is;
        after.feature = made->feature;
        after.reference_mm = made->reference_mm;
        after.reference_profile = made->reference_profile;
        after.reference_arrivals = made->reference_arrivals;
        after.reference_state = made->reference_state;
        if (!done_or_shown(desk_.edit(after, tr("confirmed on the part")))) return;
        spread_of_ = after;
        spread_->setText(tr("Shift against the drawing: x %1 mm, z %2 mm")
                             .arg(number(c.shift_mm.x(), 3), number(c.shift_mm.y(), 3)));
    }
}

void TeachPage::entered() {
    views_.raise(views_.profile);
    views_.raise(views_.scene);
}

void TeachPage::hideEvent(QHideEvent* event) {
    views_.profile->set_tool(ProfilePlot::Tool::inspect);
    StepPage::hideEvent(event);
}

const Spot* TeachPage::spot() const {
    return find_spot(desk_.project(), desk_.selection().spot());
}

QWidget* TeachPage::due() {
    return spot_head_->findChild<QWidget*>("head_deed");
}

void TeachPage::refresh() {
    tree_->refresh();
    spot_head_->refresh();
    const Spot* s = spot();
    const bool connected = desk_.station().connected;
    inspector_->setVisible(s != nullptr);
    // The spread belongs to the measurement of this reference, at this pose.
    if (!s || s->id != spread_of_.id || s->reference_mm != spread_of_.reference_mm ||
        !measured_alike(*s, spread_of_))
        spread_->clear();
    for (QPushButton* b : {duplicate_, rename_, up_, down_, remove_}) b->setEnabled(s);
    measure_->setEnabled(s && connected);
    if (!s) return;
    enabled_->setChecked(s->enabled);
    required_->setChecked(s->required);
    stop_->setChecked(s->stop_at_trigger);
    if (const RobotSetup* r = find_robot(desk_.project(), s->robot_id);
        r && !pose_->isAncestorOf(focusWidget()))
        pose_->set_notation(notation_of_brand(r->identity.brand));
    pose_->refresh(s->base_from_flange, subject(s->id));
    take_->setEnabled(connected);
    go_->setEnabled(desk_.can_move(s->robot_id));
    add_via_->setEnabled(connected);
    const int row = via_->currentRow();
    via_->clear();
    for (const Pose& via : s->via)
        via_->addItem(QStringLiteral("%1  X %2  Y %3  Z %4")
                          .arg(via_->count() + 1)
                          .arg(number(via.translation().x(), 1), number(via.translation().y(), 1),
                               number(via.translation().z(), 1)));
    via_->setCurrentRow(std::min(row, via_->count() - 1));
    via_->setVisible(via_->count() > 0);
    remove_via_->setEnabled(via_->currentRow() >= 0);
    sensor_->clear();
    robot_->clear();
    for (const SensorSetup& x : desk_.project().sensors) sensor_->addItem(QString::fromStdString(x.id));
    for (const RobotSetup& x : desk_.project().robots) robot_->addItem(QString::fromStdString(x.id));
    sensor_->setCurrentText(QString::fromStdString(s->sensor_id));
    robot_->setCurrentText(QString::fromStdString(s->robot_id));
    kind_->setCurrentIndex(kind_->findData(QString::fromStdString(s->feature.kind)));
    if (const FeatureKind* kind = feature_kind(s->feature.kind))
        kind_help_->setText(shown(Text::chosen(kind->help)));
    window_->setVisible(s->feature.kind == "template");
    pick_->setVisible(s->feature.kind != "template");
    click_->setVisible(s->feature.kind == "template");
    if (isVisible() && s->feature.kind != "template") forget_tool();
    light_->refresh(s);
    show_parameters(*s);
    confirm_->setVisible(s->reference_state == ReferenceState::from_drawing &&
                         s->reference_profile.size() > 0);
    confirm_->setEnabled(connected);
    reference_->setText(s->reference_profile.size() == 0 ? tr("Not measured yet.")
                        : s->reference_state == ReferenceState::from_type
                            ? tr("Another part type's: measure it on a part of this type.")
                        : s->reference_state == ReferenceState::from_drawing
                            ? tr("x %1   z %2 mm in the sensor, from drawing %3, not confirmed")
                                  .arg(number(s->reference_mm.x(), 3), number(s->reference_mm.z(), 3),
                                       QString::fromStdString(s->drawn ? s->drawn->name : std::string()))
                            : tr("x %1   z %2 mm in the sensor; %3 points of contour kept")
                                  .arg(number(s->reference_mm.x(), 3), number(s->reference_mm.z(), 3))
                                  .arg(s->reference_profile.size()));
    for (std::size_t i = 0; i < field_editors_.size(); ++i)
        field_editors_[i]->refresh(spot_fields()[i].get(*s), subject(s->id));
}

void TeachPage::show_parameters(const Spot& s) {
    const FeatureKind* kind = feature_kind(s.feature.kind);
    if (!kind) return;
    if (shown_kind_ != s.feature.kind) {
        shown_kind_ = s.feature.kind;
        for (ParameterEditor* e : parameter_editors_) delete e;  // at once: the page takes its new length
        parameter_editors_.clear();
        QWidget* before = click_;
        for (const ParameterInfo& info : kind->parameters) {
            auto* editor = new ParameterEditor(info);
            connect(editor, &ParameterEditor::committed, this, [this, name = info.name](double value) {
                if (!spot()) return;
                Spot after = *spot();
                after.feature.parameters[name] = value;
                change(after, QString::fromStdString(name));
            });
            parameter_editors_.push_back(editor);
            parameters_->addWidget(editor);
            setTabOrder(before, editor);
            before = editor;
        }
    }
    for (ParameterEditor* e : parameter_editors_)
        e->refresh(parameter(s.feature.parameters, kind->parameters, e->info().name), subject(s.id));
}

void TeachPage::forget_tool() {
    const auto tool = views_.profile->tool();
    if (tool == ProfilePlot::Tool::window || tool == ProfilePlot::Tool::reference)
        views_.profile->set_tool(ProfilePlot::Tool::inspect);
}

bool TeachPage::change(const Spot& after, const QString& what) {
    return done_or_shown(desk_.edit(with_reference_of(*spot(), after), what));
}

void TeachPage::add_spot() {
    const Project& p = desk_.project();
    if (p.sensors.empty() || p.robots.empty()) {
        done(usage_error("a spot needs a sensor and a robot", "step Cell", "add them first"));
        return;
    }
    Spot s;
    s.id = desk_.free_id<Spot>("S");
    s.sensor_id = p.sensors.front().id;
    s.robot_id = p.robots.front().id;
    if (const Spot* like = spot()) {
        s.sensor_id = like->sensor_id;
        s.robot_id = like->robot_id;
        s.base_from_flange = like->base_from_flange;
    }
    for (const RobotState& r : desk_.station().robots)
        if (r.id == s.robot_id && r.base_from_flange) s.base_from_flange = *r.base_from_flange;
    const std::string id = s.id;
    if (done_or_shown(desk_.add(std::move(s)))) desk_.selection().select_spot(id);
}

void TeachPage::duplicate_spot() {
    if (!spot()) return;
    Spot s = *spot();
    s.id = desk_.free_id<Spot>("S");
    const std::string id = s.id;
    const int at = index_of<Spot>(desk_.project(), spot()->id) + 1;
    if (done_or_shown(desk_.add(std::move(s), at))) desk_.selection().select_spot(id);
}

void TeachPage::rename_spot() {
    if (!spot()) return;
    ask_name(this, tr("Rename spot"), spot()->id,
             [this, from = spot()->id](const std::string& to) { return desk_.rename<Spot>(from, to); });
}

std::optional<Pose> TeachPage::present_pose() {
    for (const RobotState& r : desk_.station().robots)
        if (r.id == spot()->robot_id && r.base_from_flange) return r.base_from_flange;
    done(device_error("the robot tells no pose", Text("robot {}", spot()->robot_id),
                      "connect it, or type the pose"));
    return std::nullopt;
}

void TeachPage::take_pose() {
    if (!spot()) return;
    const auto pose = present_pose();
    if (!pose) return;
    Spot s = *spot();
    s.base_from_flange = *pose;
    change(s, tr("pose"));
}

void TeachPage::add_via() {
    if (!spot()) return;
    const auto pose = present_pose();
    if (!pose) return;
    Spot s = *spot();
    const int at = via_->currentRow() < 0 ? static_cast<int>(s.via.size()) : via_->currentRow() + 1;
    s.via.insert(s.via.begin() + at, *pose);
    if (done_or_shown(desk_.edit(s, tr("via points")))) via_->setCurrentRow(at);
}

void TeachPage::set_kind(const QString& kind) {
    if (!spot()) return;
    Spot s = *spot();
    s.feature.kind = kind.toStdString();
    s.feature.parameters.clear();
    change(s, tr("feature"));
}

// The nearer end of the contour decides the side; other kinds have no choice to make here.
void TeachPage::picked(const QPointF& point) {
    const Spot* s = spot();
    if (!s) return;
    if (s->feature.kind != "contour-end" && s->feature.kind != "corner") return;
    const auto live = [&]() -> Expected<std::shared_ptr<const LiveSnapshot>> {
        SEAM_OK(stands_at(desk_, *s));
        return live_profile(desk_, s->sensor_id);
    }();
    if (!live) {
        done(tl::unexpected(live.error()));
        return;
    }
    const auto& snapshot = *live;
    Spot after = *s;
    if (s->feature.kind == "contour-end") {
        double left = std::numeric_limits<double>::infinity(), right = -left;
        for (std::size_t i = 0; i < snapshot->profile.size(); ++i) {
            if (snapshot->profile.segment[i] == kOutlier) continue;
            left = std::min(left, snapshot->profile.x_mm[i]);
            right = std::max(right, snapshot->profile.x_mm[i]);
        }
        after.feature.parameters["side"] = std::abs(point.x() - left) <= std::abs(point.x() - right) ? 0 : 1;
    } else {
        // Lines to both sides of the place that was pointed at.
        after.feature.parameters["split"] = 1;
        after.feature.parameters["left_to_mm"] = point.x() - 0.5;
        after.feature.parameters["right_from_mm"] = point.x() + 0.5;
        after.feature.parameters["left_from_mm"] = point.x() - 15;
        after.feature.parameters["right_to_mm"] = point.x() + 15;
    }
    change(after, tr("feature"));
}

void TeachPage::take_template(const QRectF& window) {
    const Spot* s = spot();
    if (!s || s->feature.kind != "template") return;
    const auto dragged = [&]() -> Expected<Spot> {
        SEAM_TRY(const auto live, live_profile(desk_, s->sensor_id));
        SEAM_OK(stands_at(desk_, *s));
        return with_template(*s, live->profile,
                             Eigen::AlignedBox2d(Eigen::Vector2d(window.left(), window.top()),
                                                 Eigen::Vector2d(window.right(), window.bottom())));
    };
    const auto after = dragged();
    if (!after) {
        done(tl::unexpected(after.error()));
        return;
    }
    change(*after, tr("template"));
    views_.profile->set_tool(ProfilePlot::Tool::inspect);
}

// A new landmark is another feature: what was measured of the old one goes with the edit.
void TeachPage::take_landmark(const QPointF& point) {
    const Spot* s = spot();
    if (!s || s->feature.kind != "template") return;
    const auto clicked = [&]() -> Expected<Spot> {
        SEAM_TRY(const auto live, live_profile(desk_, s->sensor_id));
        SEAM_OK(stands_at(desk_, *s));
        return with_landmark(*s, live->profile, {point.x(), point.y()});
    };
    const auto after = clicked();
    if (!after) {
        done(tl::unexpected(after.error()));
        return;
    }
    if (change(*after, tr("reference point"))) views_.profile->set_tool(ProfilePlot::Tool::inspect);
}

}  // namespace seamwright
