#include "widgets/pages/regions_page.h"

#include <cmath>

#include "core/geometry/three_two_one.h"
#include "projects/measure/fields.h"
#include "projects/measure/measure.h"
#include "projects/proof/forecast.h"
#include "projects/proof/known_shift.h"
#include "projects/station/check.h"
#include "widgets/editors/list_habits.h"
#include "widgets/pages/parts/rename_dialog.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {

RegionsPage::RegionsPage(Desk& desk, const Views& views)
    : StepPage(desk, views, Step::regions,
               tr("A region is what moves as one piece: its spots tell where it has gone, its frame is what "
                  "the robot "
                  "gets.")) {
    list_ = new QListWidget;
    list_->setObjectName("regions");
    list_->setAccessibleName(tr("Regions"));
    list_->setToolTip(tr("The project's regions"));
    list_->setMaximumHeight(140);
    connect(list_, &QListWidget::currentTextChanged, this, [this](const QString& id) {
        if (!filling_ && !id.isEmpty()) desk_.selection().select_region(id.toStdString());
    });
    box().addWidget(list_);
    rename_ = make_button("rename_region", "rename", tr("Rename"), tr("Another name for the region"), [this] {
        if (!region()) return;
        ask_name(this, tr("Rename region"), region()->id, [this, from = region()->id](const std::string& to) {
            return desk_.rename<Region>(from, to);
        });
    });
    remove_ = make_button("remove_region", "remove", tr("Remove"), tr("Take the region out; its spots stay"),
                          [this] {
                              if (region()) done_or_shown(desk_.remove<Region>(region()->id));
                          });
    box().addLayout(make_row(
        {make_button("add_region", "add", tr("Add region"), tr("A further region"),
                     [this] { add_region({}); }),
         make_button(
             "encircle", "pick", tr("Encircle spots"),
             tr("Draw a line around spots in the 3D view: they become the chosen region's, or a region of "
                "their own where none is chosen. The right mouse button does the same at any time."),
             [this] {
                 views_.raise(views_.scene);
                 views_.scene->begin_lasso();
             }),
         rename_, remove_}));
    connect(views.scene, &SceneView::spots_encircled, this, [this](const QStringList& ids) {
        if (isVisible()) take_encircled(ids);
    });
    add_list_deed(*list_, *rename_, Qt::Key_F2);
    add_list_deed(*list_, *remove_, QKeySequence::Delete);
    inspector_ = new QWidget;
    auto* in = new QVBoxLayout(inspector_);
    in->setContentsMargins(0, 0, 0, 0);
    box().addWidget(inspector_);

    verdict_ = make_text({});
    verdict_->setObjectName("plan_verdict");
    in->addWidget(verdict_);
    plan_ = make_table("plan", {tr("Direction"), tr("Free"), tr("Predicted 3 sigma")},
                       tr("What the region will be able to tell"));
    plan_->setMinimumHeight(7 * style::kTargetPx);
    in->addWidget(plan_);
    advice_ = make_text({});
    advice_->setObjectName("plan_advice");
    in->addWidget(advice_);

    in->addWidget(make_heading(tr("What makes it uncertain")));
    budget_ = new BudgetPanel;
    in->addWidget(budget_);

    in->addWidget(make_heading(tr("Spots of the region")));
    spots_ = new QListWidget;
    spots_->setObjectName("region_spots");
    spots_->setAccessibleName(tr("Spots of the region"));
    spots_->setToolTip(tr("Ticked spots belong to the region; a spot may belong to several"));
    spots_->setMinimumHeight(180);
    connect(spots_, &QListWidget::itemChanged, this, [this](QListWidgetItem* item) {
        if (filling_ || !region()) return;
        Region r = *region();
        const std::string id = item->data(Qt::UserRole).toString().toStdString();
        std::erase(r.spot_ids, id);
        if (item->checkState() == Qt::Checked) {  // in the order of measuring
            r.spot_ids.push_back(id);
            std::sort(r.spot_ids.begin(), r.spot_ids.end(), [&](const std::string& a, const std::string& b) {
                return index_of<Spot>(desk_.project(), a) < index_of<Spot>(desk_.project(), b);
            });
        }
        done_or_shown(desk_.edit(r, tr("spots")));
    });
    connect(spots_, &QListWidget::currentItemChanged, this, [this](const QListWidgetItem* item) {
        if (!filling_ && item)
            desk_.selection().select_spot(item->data(Qt::UserRole).toString().toStdString());
    });
    in->addWidget(spots_);

    in->addWidget(make_heading(tr("Free degrees of freedom (work object)")));
    const QStringList names{tr("X"), tr("Y"), tr("Z"), tr("A about Z"), tr("B about Y"), tr("C about X")};
    auto* grid = new QGridLayout;
    for (int i = 0; i < 6; ++i) {
        auto* b = new QCheckBox(names[i]);
        b->setObjectName(QStringLiteral("free_%1").arg(i));
        b->setToolTip(tr("Ticked: the correction may move this way. Not ticked: exactly 0"));
        b->setMinimumHeight(style::kTargetPx);
        connect(b, &QCheckBox::clicked, this, [this, i](bool on) {
            if (!region()) return;
            Region r = *region();
            r.free[static_cast<std::size_t>(i)] = on;
            done_or_shown(desk_.edit(r, tr("degrees of freedom")));
        });
        free_[static_cast<std::size_t>(i)] = b;
        grid->addWidget(b, i / 3, i % 3);
    }
    in->addLayout(grid);

    in->addWidget(make_heading(tr("Frame on the controller")));
    const QString frame_tip = tr("As the controller calls the base or work object that the path runs in");
    frame_ = new NameEditor(tr("Name"), frame_tip, [this](const std::string& name) -> Expected<void> {
        if (!region()) return {};
        Region r = *region();
        r.frame_name = name;
        return desk_.edit(r, tr("frame"));
    });
    frame_->line().setObjectName("frame_name");
    add_field(*in, tr("Name"), frame_, frame_tip);
    frame_pose_ = new PoseEditor;
    frame_pose_->setObjectName("frame_pose");
    frame_pose_->setAccessibleName(tr("Frame as taught"));
    frame_pose_->setToolTip(tr("base_from_frame for the undisplaced part"));
    connect(frame_pose_, &PoseEditor::committed, this, [this] {
        if (!region()) return;
        Region r = *region();
        r.base_from_frame = frame_pose_->pose();
        done_or_shown(desk_.edit(r, tr("frame")));
    });
    in->addWidget(frame_pose_);

    in->addLayout(
        make_row({make_button("pick_frame", "pick", tr("Pick 3-2-1 on the part"),
                              tr("Six clicks on the part in 3D: three on a plane, two along X, one for the "
                                 "origin; the frame goes there"),
                              [this] { pick_frame(); })}));
    pick_said_ = make_text({});
    pick_said_->setObjectName("pick_said");
    in->addWidget(pick_said_);
    connect(views.scene, &SceneView::part_picked, this, [this](double x, double y, double z) {
        if (isVisible()) picked({x, y, z});
    });

    in->addWidget(make_heading(tr("Limits")));
    for (const Field<Region>& f : region_fields()) {
        auto* editor = new ParameterEditor(f.info);
        connect(editor, &ParameterEditor::committed, this, [this, name = f.info.name](double value) {
            if (region()) done_or_shown(desk_.set_region_field(RegionId(region()->id), name, value));
        });
        editors_.push_back(editor);
        in->addWidget(editor);
    }
    proven_ = make_button("limits_as_proven", "check", tr("As proven"),
                          tr("Lets through what the known shift has proven, and no more"), [this] {
                              const Evidence* e = newest<KnownShift>(desk_.facts());
                              if (!region() || !e) return;
                              Region r = *region();
                              r.limits = proven_limits(std::get<KnownShift>(e->what));
                              r.sigma_limit_mm =
                                  std::min(r.sigma_limit_mm, desk_.project().requirements.sigma3_mm / 3);
                              done_or_shown(desk_.edit(r, tr("limits")));
                          });
    in->addLayout(make_row({proven_}));
    box().addStretch(1);
}

void RegionsPage::add_region(std::vector<std::string> spot_ids) {
    Region r;
    r.id = desk_.free_id<Region>("Region");
    r.frame_name = "BASE_" + r.id;
    for (int n = 2; !frame_of_its_own(desk_.project(), r); ++n)
        r.frame_name = "BASE_" + r.id + "_" + std::to_string(n);
    r.base_from_frame = desk_.project().part.base_from_workobject;
    r.spot_ids = std::move(spot_ids);
    const std::string id = r.id;
    if (done_or_shown(desk_.add(r))) desk_.selection().select_region(id);
}

void RegionsPage::take_encircled(const QStringList& ids) {
    if (ids.isEmpty()) return;
    std::vector<std::string> spots;
    for (const QString& id : ids) spots.push_back(id.toStdString());
    if (!region()) return add_region(std::move(spots));
    Region r = *region();
    r.spot_ids = std::move(spots);
    done_or_shown(desk_.edit(r, tr("spots")));
}

void RegionsPage::pick_frame() {
    if (picking_) return end_pick();
    if (!region()) return;
    picking_ = true;
    picks_of_ = subject(region()->id);
    views_.raise(views_.scene);
    say_pick();
}

void RegionsPage::end_pick() {
    picking_ = false;
    picks_.clear();
    views_.scene->set_picks(picks_);
    say_pick();
}

// Half of a frame is nothing to come back to, and the next clicks may be meant for something else.
void RegionsPage::hideEvent(QHideEvent* event) {
    if (picking_) end_pick();
    StepPage::hideEvent(event);
}

void RegionsPage::say_pick() {
    if (!picking_) return pick_said_->clear();
    if (desk_.project().part.mesh_ply.empty())
        return set_verdict(*pick_said_, tr("There is no part to click on: step 1, Cell, imports its mesh."),
                           Tone::attention);
    const std::size_t n = picks_.size();
    const QString what =
        n < 3   ? tr("click point %1 of 3 of the plane, counter-clockwise seen from above").arg(n + 1)
        : n < 5 ? tr("click point %1 of 2 along X").arg(n - 2)
                : tr("click the point beside which the origin lies");
    set_verdict(*pick_said_, tr("Frame by 3-2-1: %1.").arg(what), Tone::plain);
}

void RegionsPage::picked(const Eigen::Vector3d& workobject_mm) {
    if (!picking_ || !region() || subject(region()->id) != picks_of_) return;
    picks_.push_back(workobject_mm);
    views_.scene->set_picks(picks_);
    say_pick();
    constexpr std::size_t kPicks = 6;
    if (picks_.size() < kPicks) return;
    const auto frame =
        frame_by_three_two_one({picks_[0], picks_[1], picks_[2]}, {picks_[3], picks_[4]}, picks_[5]);
    end_pick();
    if (!frame) return set_verdict(*pick_said_, shown_error(frame.error()), Tone::attention);
    Region r = *region();
    r.base_from_frame = desk_.project().part.base_from_workobject * *frame;
    if (done_or_shown(desk_.edit(r, tr("frame"))))
        set_verdict(*pick_said_, tr("The frame stands where it was picked; undo brings the old one back."),
                    Tone::good);
}

void RegionsPage::entered() {
    views_.raise(views_.scene);
}

const Region* RegionsPage::region() const {
    const int at = index_of<Region>(desk_.project(), desk_.selection().region());
    return at < 0 ? nullptr : &desk_.project().regions[static_cast<std::size_t>(at)];
}

QWidget* RegionsPage::due() {
    const std::vector<Region>& regions = desk_.project().regions;
    if (regions.empty()) return findChild<QWidget*>("add_region");
    const auto bare =
        std::find_if(regions.begin(), regions.end(), [](const Region& r) { return r.spot_ids.empty(); });
    if (bare == regions.end() || spots_->count() == 0) return list_;
    desk_.selection().select_region(bare->id);
    refresh();
    if (spots_->currentRow() < 0) {
        const QSignalBlocker quiet(spots_);
        spots_->setCurrentRow(0);
    }
    return spots_;
}

void RegionsPage::refresh() {
    filling_ = true;
    const Project& p = desk_.project();
    list_->clear();
    for (const Region& r : p.regions) {
        auto* item = new QListWidgetItem(QString::fromStdString(r.id), list_);
        item->setSizeHint({0, style::kTargetPx});
        if (r.id == desk_.selection().region()) list_->setCurrentItem(item);
    }
    const Region* r = region();
    if (picking_ && (!r || subject(r->id) != picks_of_)) end_pick();
    inspector_->setVisible(r);
    rename_->setEnabled(r);
    remove_->setEnabled(r);
    proven_->setEnabled(r && newest<KnownShift>(desk_.facts()));
    if (r) {
        const int scroll = spots_->currentRow();
        spots_->clear();
        for (const Spot& s : p.spots) {
            const QString id = QString::fromStdString(s.id);
            const bool drawn = s.reference_state == ReferenceState::from_drawing;
            auto* item =
                new QListWidgetItem(drawn ? tr("%1 (from the drawing, not confirmed)").arg(id)
                                    : s.reference_state == ReferenceState::from_type
                                        ? tr("%1 (of another part type, not taught on this one)").arg(id)
                                        : id,
                                    spots_);
            item->setData(Qt::UserRole, id);
            item->setSizeHint({0, style::kTargetPx});
            item->setFlags(item->flags() | Qt::ItemIsUserCheckable);
            const bool in = std::find(r->spot_ids.begin(), r->spot_ids.end(), s.id) != r->spot_ids.end();
            item->setCheckState(in ? Qt::Checked : Qt::Unchecked);
        }
        if (scroll >= 0) spots_->setCurrentRow(scroll);
        for (std::size_t i = 0; i < 6; ++i) free_[i]->setChecked(r->free[i]);
        frame_->refresh(r->frame_name, subject(r->id));
        frame_pose_->refresh(r->base_from_frame, subject(r->id));
        for (std::size_t i = 0; i < editors_.size(); ++i)
            editors_[i]->refresh(region_fields()[i].get(*r), subject(r->id));
        show_plan(*r);
        budget_->show_region(p, r->spot_ids.empty() ? nullptr : r);
    }
    filling_ = false;
}

void RegionsPage::show_plan(const Region& r) {
    if (r.spot_ids.empty()) {
        set_verdict(*verdict_, tr("No spot is ticked below: tick those that move with this region."),
                    Tone::attention);
        set_rows(*plan_, {});
        advice_->clear();
        return;
    }
    const auto forecast = forecast_region(desk_.project(), r);
    if (!forecast) {
        set_verdict(*verdict_, shown(forecast.error().what), Tone::attention);
        set_rows(*plan_, {});
        advice_->clear();
        return;
    }
    const RegionPlan* plan = &forecast->plan;
    const Requirements& need = desk_.project().requirements;
    if (plan->status != CorrectionStatus::ok)
        set_verdict(*verdict_,
                    tr("under-determined: %1")
                        .arg(shown(plan->unobservable.empty() ? plan->weakest : plan->unobservable.front())),
                    Tone::alarm);
    else
        set_verdict(
            *verdict_,
            (forecast->enough() ? tr("observable: 3 sigma %1 mm at spot %2, %3 mm required")
                                : tr("not sure enough: 3 sigma %1 mm at spot %2, %3 mm required"))
                    .arg(number(3 * forecast->sigma_mm, 3), QString::fromStdString(forecast->worst_spot),
                         number(3 * forecast->wanted_mm, 3)) +
                "\n" +
                tr("for parts displaced by up to %1 mm and %2 deg")
                    .arg(number(need.known_shift_mm, 1), number(need.known_shift_deg, 2)),
            forecast->enough() ? Tone::good : Tone::attention);
    const QStringList names{tr("X"), tr("Y"), tr("Z"), tr("A about Z"), tr("B about Y"), tr("C about X")};
    QVector<QStringList> rows;
    for (int i = 0; i < 6; ++i) {
        const bool free = r.free[static_cast<std::size_t>(i)];
        const double sigma = i < 3 ? plan->sigma_xyz_mm[i] : plan->sigma_abc_deg[i - 3];
        rows << QStringList{names[i], free ? tr("yes") : tr("no"),
                            !free ? tr("exactly 0")
                            : !std::isfinite(sigma)
                                ? tr("not observed")
                                : number(3 * sigma, i < 3 ? 3 : 4) +
                                      (i < 3 ? QStringLiteral(" mm") : QChar(0x20) + shown_word("deg"))};
    }
    set_rows(*plan_, rows);
    QString text;
    if (plan->status != CorrectionStatus::ok) text = shown(plan->advice);
    constexpr std::size_t kMostCures = 3;
    for (std::size_t i = 0; i < std::min(kMostCures, forecast->cures.size()); ++i) {
        const Cure& cure = forecast->cures[i];
        text +=
            (i ? QStringLiteral("\n") : QString()) +
            tr("3 sigma %1 mm: %2")
                .arg(number(3 * cure.sigma_mm, 3), QString::fromStdString(cure.what.in(desk_.language())));
    }
    if (plan->status == CorrectionStatus::ok && !text.isEmpty())
        text = (forecast->enough() ? tr("Surer still would be:") : tr("To cure, the most effective first:")) +
               "\n" + text;
    if (!plan->uncontrolled.empty()) {
        QStringList ids;
        for (const std::string& id : plan->uncontrolled) ids << QString::fromStdString(id);
        text += (text.isEmpty() ? QString() : QStringLiteral("\n")) +
                tr("A wrong measure of %1 mm could not be found at: %2")
                    .arg(kFindableErrorMm)
                    .arg(ids.join(", "));
    }
    advice_->setText(text);
}

}  // namespace seamwright
