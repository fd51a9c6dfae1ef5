#include "widgets/pages/parts/spot_head.h"

#include <algorithm>

#include "projects/measure/measure.h"
#include "projects/measure/reference_feature.h"
#include "projects/proof/checklist.h"
#include "widgets/menu_signs.h"
#include "widgets/pages/parts/form.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

bool is_done(const Desk& desk, const Spot& s) {
    return !s.enabled || (!taught_open(desk.project(), s) && !frozen_open(desk.project(), desk.facts(), s));
}

}  // namespace

SpotDeed next_deed(const Desk& desk, const std::string& spot_id) {
    const Project& project = desk.project();
    if (project.spots.empty()) return SpotDeed::add;
    const Spot* s = find_spot(project, spot_id);
    if (!s) return SpotDeed::choose;
    if (!is_done(desk, *s)) {
        if (s->feature.kind == "template" && s->feature.template_profile.size() == 0) return SpotDeed::piece;
        if (s->reference_profile.size() == 0 || s->reference_state == ReferenceState::from_type ||
            (s->reference_state == ReferenceState::measured && reference_beside_mm(project, *s) > 0))
            return SpotDeed::reference;
        return s->reference_state == ReferenceState::from_drawing ? SpotDeed::confirm : SpotDeed::pass;
    }
    return next_undone(desk, spot_id) ? SpotDeed::next_spot : SpotDeed::next_step;
}

const Spot* next_undone(const Desk& desk, const std::string& spot_id) {
    const Project& project = desk.project();
    const auto at = std::find_if(project.spots.begin(), project.spots.end(),
                                 [&](const Spot& s) { return s.id == spot_id; });
    const auto missing = [&](const Spot& s) { return !is_done(desk, s); };
    auto found = std::find_if(at == project.spots.end() ? at : std::next(at), project.spots.end(), missing);
    if (found == project.spots.end()) found = std::find_if(project.spots.begin(), at, missing);
    return found == at || found == project.spots.end() ? nullptr : &*found;
}

SpotHead::SpotHead(Desk& desk, QWidget* parent) : QWidget(parent), desk_(desk) {
    auto* words = new QVBoxLayout(this);
    words->setContentsMargins(0, 0, 0, 0);
    name_ = make_heading({});
    name_->setObjectName("head_spot");
    state_ = make_text({});
    state_->setObjectName("head_state");
    words->addWidget(name_);
    words->addWidget(state_);
    go_ = make_button("head_go", "shift", tr("Go there"),
                      tr("Moves the robot straight to the spot: look whether the way is free"), [this] {
                          if (const Spot* s = find_spot(desk_.project(), desk_.selection().spot()))
                              desk_.go_to(s->robot_id, s->base_from_flange);
                      });
    deed_ = make_button("head_deed", "next", {}, tr("What comes next of this spot"),
                        [this] { emit wanted(shown_); });
    words->addLayout(make_row({deed_, go_}));
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (isVisible()) refresh();
    });
    connect(&desk_.worker(), &StationWorker::busy_changed, this, [this] {
        if (isVisible()) refresh();
    });
}

void SpotHead::set_pass_waits(bool waits) {
    if (waits == pass_waits_) return;
    pass_waits_ = waits;
    refresh();
}

void SpotHead::refresh() {
    const Project& project = desk_.project();
    const Spot* s = find_spot(project, desk_.selection().spot());
    const bool connected = desk_.station().connected, busy = desk_.worker().busy();
    go_->setVisible(s);
    go_->setEnabled(s && desk_.can_move(s->robot_id) && !busy);
    shown_ = next_deed(desk_, desk_.selection().spot());
    if (shown_ == SpotDeed::pass && pass_waits_) shown_ = SpotDeed::accept;
    name_->setText(s ? tr("Spot %1").arg(QString::fromStdString(s->id)) : tr("No spot"));
    bool may = !busy;
    switch (shown_) {
        case SpotDeed::add:
            state_->setText(tr("Jog the sensor over the contour, then add a spot there."));
            deed_->setText(tr("Add spot"));
            may = may && connected;
            break;
        case SpotDeed::choose:
            state_->setText(tr("Choose one in the list."));
            deed_->setText(tr("First spot"));
            break;
        case SpotDeed::piece:
            state_->setText(
                tr("Drag a window over the contour in the live profile: it becomes the template."));
            deed_->setText(tr("Drag template"));
            may = may && connected;
            break;
        case SpotDeed::reference:
            state_->setText(!connected ? tr("Its reference is not measured yet: connect the devices first.")
                            : s->reference_profile.size() > 0 &&
                                    s->reference_state == ReferenceState::measured
                                ? tr("Its reference does not lie at its feature: measure it again.")
                                : tr("Its reference is not measured yet."));
            deed_->setText(tr("Measure reference"));
            may = may && connected;
            break;
        case SpotDeed::confirm:
            state_->setText(connected ? tr("From the drawing: nothing is pushed by it yet.")
                                      : tr("From the drawing: connect, then confirm it."));
            deed_->setText(tr("Confirm"));
            may = may && connected;
            break;
        case SpotDeed::pass:
            state_->setText(tr("Its reference is measured, its pass is not."));
            deed_->setText(tr("Run entry -> exit"));
            may = may && connected;
            break;
        case SpotDeed::accept:
            state_->setText(tr("Its pass is recorded, not accepted."));
            deed_->setText(tr("Accept"));
            break;
        case SpotDeed::next_spot:
            state_->setText(tr("Taught and aligned."));
            deed_->setText(with_signs(
                tr("Next: spot %1")
                    .arg(QString::fromStdString(next_undone(desk_, desk_.selection().spot())->id))));
            break;
        case SpotDeed::next_step:
            state_->setText(tr("All spots are taught and aligned."));
            deed_->setText(tr("Next: regions"));
            break;
    }
    deed_->setEnabled(may);
}

}  // namespace seamwright
