// What runs, what can be pressed meanwhile, and the one key that leads on.

#include <algorithm>
#include <utility>

#include "projects/calibrate/session/guide.h"
#include "projects/measure/measure.h"
#include "widgets/pages/guided/guided_page.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"

namespace seamwright {

void GuidedPage::refresh_busy() {
    if (!calibration_.is_open()) return;
    const CalibrationSession& s = calibration_.session();
    const bool running = series_.running(), busy = calibration_.busy() || running;
    if (running) {
        const int taken = static_cast<int>(s.state().captures.size());
        progress_->setRange(0, series_.wanted());
        progress_->setValue(std::min(taken, series_.wanted()));
        progress_->setFormat(tr("Capture %1 of %2").arg(taken + 1).arg(series_.wanted()));
    } else if (busy && progress_->format() != calibration_.doing()) {
        progress_->setRange(0, 0);
        progress_->setFormat(calibration_.doing());
    }
    if (!busy) progress_->setFormat({});
    if (busy) {
        progress_->show();
        cancel_->show();
        keep_focus(true);
    }
    const bool connected = desk_.station().connected;
    for (QPushButton* b : {capture_, verify_}) b->setEnabled(!busy && connected);
    capture_all_->setEnabled(!busy && connected);
    capture_all_->setText(series_.extends() ? tr("%n more pose(s)", "", series_.more()) : tr("Capture all"));
    for (QPushButton* b : {automatic_, set_target_, go_there_}) b->setEnabled(connected && !running);
    connect_->setVisible(!connected);
    connect_->setEnabled(!busy && !desk_.worker().busy() && !desk_.project().sensors.empty());
    for (QPushButton* b : {load_, load_folder_}) b->setEnabled(!busy);
    solve_->setEnabled(!busy && s.solving_captures() >= s.method().fewest);
    const bool chosen = !selected().empty();
    verification_->setEnabled(chosen);
    remove_->setEnabled(chosen);
    for (const SessionCapture& c : s.state().captures)
        if (c.taken->id == selected())
            verification_->setText(c.verification ? tr("Solve with it") : tr("Keep for verification"));
    const bool ready =
        !busy && (s.stage() == SessionStage::use || (s.stage() == SessionStage::used && !stored()));
    use_->setEnabled(ready);
    keep_->setEnabled(ready);
    mark_next();
    if (busy) return;
    keep_focus(false);  // before what has it is hidden
    progress_->hide();
    cancel_->hide();
}

// A key that is pressed is disabled while its deed runs, and the focus would wander to whatever comes after it: it goes to
// Cancel, and then to what comes next.
void GuidedPage::keep_focus(bool busy) {
    const QWidget* focus = window()->focusWidget();
    const bool deed = focus && (focus == lead_ || focus == capture_ || focus == capture_all_ ||
                                focus == verify_ || focus == solve_);
    if (busy && deed) {
        focus_waits_ = true;
        cancel_->setFocus();
    } else if (!busy && std::exchange(focus_waits_, false) && (!focus || focus == cancel_)) {
        if (leads_to_) lead_->setFocus();
    }
}

QString GuidedPage::missing() const {
    const CalibrationSession& s = calibration_.session();
    if (!find_sensor(desk_.project(), s.sensor_id()))
        return tr("Sensor %1 is not in the project any more, by this name. Undo that in the project "
                  "(Ctrl+Z), or go back "
                  "to all methods.")
            .arg(QString::fromStdString(s.sensor_id()));
    if (s.method().robot && !find_robot(desk_.project(), s.robot_id()))
        return s.robot_id().empty()
                   ? tr("This method needs a robot, and the project has none: add one on the step Cell.")
                   : tr("Robot %1 is not in the project any more, by this name. Undo that in the project "
                        "(Ctrl+Z), or go "
                        "back to all methods.")
                         .arg(QString::fromStdString(s.robot_id()));
    if (s.method().capture == CaptureKind::files || desk_.station().connected) return {};
    return tr(
        "The devices are not connected: connect them to capture, or load from files what was captured.");
}

bool GuidedPage::loaded() const {
    const auto& captures = calibration_.session().state().captures;
    return std::any_of(captures.begin(), captures.end(),
                       [](const SessionCapture& c) { return c.taken->origin != "live"; });
}

void GuidedPage::mark_next() {
    const CalibrationSession& s = calibration_.session();
    const bool live = s.method().capture != CaptureKind::files && desk_.station().connected;
    // A simulated target is set up before anything can be captured; where the desk moves the robot, all captures are one
    // deed.
    const auto take = [&](QPushButton* capture) {
        if (s.method().capture == CaptureKind::files || (!live && loaded())) return load_;
        if (!live) return connect_;
        if (s.method().capture == CaptureKind::touch) return capture;
        if (simulated_sensor() && !target_set_) return set_target_;
        return capture_all_->isVisibleTo(this) ? capture_all_ : capture;
    };
    leads_to_ = nullptr;
    switch (s.stage()) {
        case SessionStage::prepare:
        case SessionStage::capture:
            leads_to_ = take(capture_);
            break;
        case SessionStage::solve:
            leads_to_ = solve_;
            break;
        case SessionStage::verify:
            leads_to_ = live ? take(verify_) : verification_;
            break;
        case SessionStage::use:
            leads_to_ = s.method().use == AnswerUse::sensor ? use_ : keep_;
            break;
        case SessionStage::used:
            if (!stored()) leads_to_ = s.method().use == AnswerUse::sensor ? use_ : keep_;  // undone
            break;
    }
    const bool busy = calibration_.busy() || series_.running();
    lead_->setVisible(leads_to_ && !busy);
    if (leads_to_) {
        lead_->setText(leads_to_->text());
        lead_->setIcon(leads_to_->icon());
        lead_->setToolTip(leads_to_->toolTip());
        lead_->setAccessibleName(leads_to_->text());
        lead_->setEnabled(leads_to_->isEnabled() || leads_to_ == verification_);
    }
    const QString words = leads_to_ && isVisible()
                              ? tr("%1: %2").arg(shown(s.method().title), stage_->accessibleDescription())
                              : QString();
    if (std::exchange(under_way_, words) != words) emit under_way(words);
}

void GuidedPage::lead() {
    if (!leads_to_ || !calibration_.is_open()) return;
    if (leads_to_ != verification_ || !selected().empty()) return leads_to_->click();
    // Without a pose chosen the newest is kept back.
    const auto ids = to_keep_back(calibration_.session(), calibration_.session().verification_captures() + 1);
    if (ids.empty()) return say(tr("Every capture is needed to solve with: take or load more."));
    for (const std::string& id : ids) done(calibration_.set_verification(id, true));
}

void GuidedPage::state_repeatability() {
    if (calibration_.is_open())
        done(calibration_.state_repeatability(robot_mm_->value(), robot_deg_->value()));
}

}  // namespace seamwright
