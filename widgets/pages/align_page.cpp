#include "widgets/pages/align_page.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "projects/measure/measure.h"
#include "projects/proof/checklist.h"
#include "projects/station/teach.h"
#include "widgets/editors/number_box.h"
#include "widgets/shown_text.h"

namespace seamwright {

AlignPage::AlignPage(Desk& desk, const Views& views)
    : StepPage(desk, views, Step::align,
               tr("While the robot passes the spot along the contour, the profile should stand still. Then "
                  "trigger "
                  "jitter does no harm.")) {
    QVBoxLayout& head = make_head();
    spot_head_ = new SpotHead(desk);
    head.addWidget(spot_head_);
    head.addWidget(make_progress());
    connect(spot_head_, &SpotHead::wanted, this, &AlignPage::do_deed);
    tree_ = new SpotTree(desk);
    box().addWidget(tree_);
    const auto spin = [this](const QString& name, double low, double high, double value, int decimals,
                             const QString& label, const QString& tip) {
        auto* s = new NumberBox;
        s->setObjectName(name);
        s->setRange(low, high);
        s->setDecimals(decimals);
        s->setValue(value);
        s->setSuffix(QStringLiteral(" mm"));
        add_field(box(), label, s, tip);
        return s;
    };
    step_ = spin("pass_step", 0.1, 20, 2, 1, tr("Step of the pass"), tr("Travel between two profiles"));
    tolerance_ = spin("pass_tolerance", 0.001, 5, 0.05, 3, tr("Tolerance"),
                      tr("Error that the trigger jitter may cause at most"));
    start_ = make_button("start_pass", "play", tr("Run entry -> exit"),
                         tr("The robot goes along the contour and stops at every step; nothing is written"),
                         [this] { start(); });
    accept_ =
        make_button("accept_pass", "check", tr("Accept"),
                    tr("Keeps jitter window and the contour's curve with the spot"), [this] { accept(); });
    adopt_ = make_button(
        "adopt_pose", "rotate", tr("Adopt turned pose"),
        tr("Turns the taught pose about the reference point by the rotation that cures it; teach again then"),
        [this] { adopt(); });
    // Above the verdict, whose length changes: all three are in sight of a small window.
    box().addLayout(make_row({start_, accept_, adopt_}));
    verdict_ = make_text({});
    verdict_->setObjectName("align_verdict");
    QFont font = verdict_->font();
    font.setPointSizeF(font.pointSizeF() * 1.5);
    verdict_->setFont(font);
    box().addWidget(verdict_);
    numbers_ = make_text({});
    numbers_->setObjectName("align_numbers");
    box().addWidget(numbers_);
    box().addStretch(1);

    connect(&desk_.worker(), &StationWorker::passed, this,
            [this](const std::shared_ptr<const JudgedPass>& pass) {
                std::erase_if(passes_, [&](const Recorded& r) { return r.pass.spot.id == pass->spot.id; });
                passes_.push_back({*pass});
                show_result();
            });
    connect(views_.align, &AlignView::jitter_dragged, this, &AlignPage::judge);
    connect(tolerance_, &QDoubleSpinBox::editingFinished, this, [this] {
        if (const Recorded* r = recorded()) judge(r->pass.options.jitter_mm);
    });
    connect(&desk_, &Desk::opened, this, [this] { passes_.clear(); });
    connect(&desk_, &Desk::station_changed, this, [this] {
        if (isVisible()) start_->setEnabled(spot() && desk_.station().connected && !desk_.worker().busy());
    });
}

void AlignPage::entered() {
    views_.raise(views_.align);
}

const Spot* AlignPage::spot() const {
    return find_spot(desk_.project(), desk_.selection().spot());
}

AlignPage::Recorded* AlignPage::recorded() {
    const Spot* s = spot();
    if (!s) return nullptr;
    const auto of = [&](const auto& known_as) {
        const auto at = std::ranges::find_if(passes_, [&](const Recorded& r) {
            return known_as(r.pass.spot.id) && measured_alike(r.pass.spot, *s);
        });
        return at == passes_.end() ? nullptr : &*at;
    };
    if (Recorded* own = of([&](const std::string& id) { return id == s->id; })) return own;
    // A name that is nobody's any more: the spot was given another one.
    Recorded* former = of([&](const std::string& id) { return !find_spot(desk_.project(), id); });
    if (former) former->pass.spot.id = s->id;
    return former;
}

QWidget* AlignPage::due() {
    return spot_head_->findChild<QWidget*>("head_deed");
}

void AlignPage::refresh() {
    tree_->refresh();
    spot_head_->refresh();
    start_->setEnabled(spot() && desk_.station().connected);
    show_result();
}

void AlignPage::do_deed(SpotDeed deed) {
    switch (deed) {
        case SpotDeed::add:
        case SpotDeed::piece:
        case SpotDeed::reference:
        case SpotDeed::confirm:
            return emit step_wanted(Step::teach);
        case SpotDeed::choose:
            return desk_.selection().select_spot(desk_.project().spots.front().id);
        case SpotDeed::pass:
            return start();
        case SpotDeed::accept:
            return accept();
        case SpotDeed::next_spot:
            return desk_.selection().select_spot(next_undone(desk_, desk_.selection().spot())->id);
        case SpotDeed::next_step:
            return emit step_wanted(Step::regions);
    }
}

void AlignPage::start() {
    if (!spot() || !all_is_taken()) return;
    AlignmentOptions options = alignment_options(*spot());
    options.tolerance_mm = tolerance_->value();
    desk_.worker().record_pass(*spot(), step_->value(), options);
}

void AlignPage::judge(double jitter_mm) {
    Recorded* r = recorded();
    if (!r) return;
    r->pass.options.jitter_mm = jitter_mm;
    r->pass.options.tolerance_mm = tolerance_->value();
    if (auto judged = check_alignment(r->pass.pass.profiles, r->pass.options)) {
        r->pass.result = std::move(*judged);
        show_result();
    }
}

void AlignPage::show_result() {
    const Recorded* here = recorded();
    accept_->setEnabled(here && here->pass.acceptable());
    spot_head_->set_pass_waits(here && here->pass.acceptable() && !here->accepted);
    adopt_->setEnabled(here && here->pass.result.status == AlignmentStatus::drifting);
    if (!here) {
        // Its jitter is drawn before a pass is.
        const bool other_jitter = spot() && spot()->jitter_mm != views_.align->jitter_mm();
        if (other_jitter) views_.align->set_result({}, {}, alignment_options(*spot()));
        if (std::exchange(shown_, false) || other_jitter) views_.align->clear();
        const bool accepted = spot() && spot()->curve;
        set_verdict(*verdict_, accepted ? tr("edge recorded earlier") : tr("no pass recorded"), Tone::plain);
        numbers_->setText(spot() ? tr("Entry %1 mm, exit %2 mm, jitter ±%3 mm")
                                       .arg(number(spot()->entry_mm, 1), number(spot()->exit_mm, 1),
                                            number(spot()->jitter_mm, 2))
                                 : tr("Choose a spot."));
        return;
    }
    const JudgedPass& pass = here->pass;
    shown_ = true;
    const bool widened = widened_tolerance(desk_.project(), pass.options.tolerance_mm);
    views_.align->set_result(pass.pass.profiles, pass.result, pass.options, widened);
    const AlignmentResult& r = pass.result;
    switch (r.status) {
        case AlignmentStatus::frozen:
            if (widened)
                set_verdict(*verdict_, tr("frozen at a widened tolerance"), Tone::attention);
            else
                set_verdict(*verdict_, tr("FROZEN"), Tone::good);
            break;
        case AlignmentStatus::drifting:
            set_verdict(*verdict_, tr("DRIFTING"), Tone::alarm);
            break;
        case AlignmentStatus::shape_changes:
            set_verdict(*verdict_, tr("SHAPE CHANGES"), Tone::alarm);
            break;
        case AlignmentStatus::not_enough_profiles:
            set_verdict(*verdict_, tr("NOT ENOUGH PROFILES"), Tone::attention);
            break;
        case AlignmentStatus::undetermined:
            set_verdict(*verdict_, tr("UNDETERMINED"), Tone::attention);
            break;
    }
    QString text =
        tr("yaw %1 deg, pitch %2 deg, radius %3, expected error %4 mm")
            .arg(number(r.yaw_deg, 3), number(r.pitch_deg, 3),
                 std::isfinite(r.radius_mm) ? number(r.radius_mm, 0) + QStringLiteral(" mm") : tr("straight"),
                 number(r.expected_error_mm, 3));
    text += "\n" +
            tr("Tolerance %1 mm, required are %2 mm")
                .arg(number(pass.options.tolerance_mm, 3), number(desk_.project().requirements.sigma3_mm, 3));
    if (!pass.curve)
        text += "\n" + tr("The feature was found in too few profiles to learn the contour's curve.");
    if (!r.cure.empty()) text += "\n" + tr("To cure: %1").arg(shown(r.cure));
    numbers_->setText(text);
}

void AlignPage::accept() {
    const Recorded* r = recorded();
    if (!r) return;
    const auto after = with_pass(*spot(), r->pass);
    if (!after) {
        done(tl::unexpected(after.error()));
        return;
    }
    if (!done(desk_.edit(*after, tr("alignment")))) return;
    // The edit may have made the page anew.
    if (Recorded* now = recorded())
        now->accepted =
            done(desk_.record({0, {}, 0, frozen_contour(after->id, now->pass.result, now->pass.options)}));
    show_result();
}

void AlignPage::adopt() {
    const Spot* s = spot();
    const Recorded* r = recorded();
    if (!r) return;
    const Calibration* c = calibration_of(desk_.project(), *s);
    const Pose flange_from_sensor = c ? c->flange_from_sensor : Pose::Identity();
    const Spot after = cured(*s, r->pass.result, flange_from_sensor);
    if (done(desk_.edit(after, tr("pose")))) show_result();
}

}  // namespace seamwright
