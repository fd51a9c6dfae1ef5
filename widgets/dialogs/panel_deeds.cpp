// What the panel's window does: files taken, questions asked, deeds begun and ended.

#include <utility>
#include <variant>

#include "projects/panel/panel_job_file.h"
#include "widgets/dialogs/panel_dialog.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

constexpr int kTeachRepeats = 5;

}  // namespace

void PanelDialog::take_file(const QString& file) {
    auto read = read_panel_file(file.toStdString());
    if (!read) return set_verdict(*verdict_, shown_error(read.error()), Tone::alarm);
    forget();
    if (auto* measures = std::get_if<PanelMeasures>(&*read)) {
        auto fitted = fit_panel(measures->spots, measures->options);
        show_standing();
        if (!fitted) return set_verdict(*verdict_, shown_error(fitted.error()), Tone::alarm);
        from_file_ = std::move(*fitted);
        basis_ = basis();
        show_standing();
        return;
    }
    const auto& taken = std::get<PanelJob>(*read);
    const QString id = QString::fromStdString(taken.id);
    auto with = with_panel_job(desk_.project(), taken);
    const auto kept =
        with ? desk_.edit_project([&](Project& p) { p = std::move(*with); }, tr("Take panel job %1").arg(id))
             : Expected<void>(tl::unexpected(with.error()));
    if (!kept)
        return set_verdict(*verdict_, shown_error(tr("The panel job was not taken."), kept.error()),
                           Tone::alarm);
    job_->setCurrentIndex(job_->findData(id));
    show_standing();
}

void PanelDialog::ask(const QString& question, const QString& yes, std::function<void(bool)> answer) {
    answer_ = std::move(answer);
    question_->setText(question);
    yes_->setText(yes);
    yes_->setAccessibleName(yes);
    asking_->show();
    show_deeds();
    no_->setFocus();
}

void PanelDialog::answer(bool yes) {
    asking_->hide();
    if (auto told = std::exchange(answer_, nullptr)) told(yes);
    show_deeds();
}

void PanelDialog::begin(Deed deed) {
    const PanelJob* chosen = job();
    if (!chosen) return;
    forget();
    waiting_ = deed;
    basis_ = basis();
    progress_->setRange(0, deed == Deed::learn ? kLearningMoves : 0);
    progress_->setValue(0);
    if (deed == Deed::learn) {
        desk_.worker().learn_panel(chosen->id);
    } else if (deed == Deed::teach) {
        desk_.worker().teach_panel(chosen->id, kTeachRepeats);
    } else {
        PanelOrder order;
        order.job_id = chosen->id;
        order.part_id = part_->text().trimmed().toStdString();
        order.push = deed != Deed::measure;
        order.servo = deed == Deed::servo;
        desk_.worker().fit_panel(order);
    }
    show_standing();
}

void PanelDialog::ask_to_learn() {
    const PanelJob* chosen = job();
    if (!chosen) return;
    const ServoingOptions steps = device_servoing();
    ask(tr("%1 makes %2 small moves with the panel, %3 mm and %4 degrees to either side, and goes back. Is "
           "its way free?")
            .arg(QString::fromStdString(chosen->robot_id))
            .arg(kLearningMoves)
            .arg(number(steps.step_mm, 2), number(steps.step_deg, 2)),
        tr("Learn with %1").arg(QString::fromStdString(chosen->robot_id)), [this](bool yes) {
            if (yes) begin(Deed::learn);
        });
}

void PanelDialog::ask_to_teach() {
    const PanelJob* chosen = job();
    if (!chosen) return;
    ask(tr("%1 goes to the measuring position of %2. What is measured there becomes the taught gap and "
           "flush: the panel must be in its "
           "zero position. Is it, and is the way free?")
            .arg(QString::fromStdString(chosen->robot_id), QString::fromStdString(chosen->id)),
        tr("Teach %1").arg(QString::fromStdString(chosen->id)), [this](bool yes) {
            if (yes) begin(Deed::teach);
        });
}

void PanelDialog::ask_to_push(const RunRecord& judged) {
    // Whoever hears a question answers it: the worker waits for that.
    if (waiting_ == Deed::none || !judged.panel) return desk_.worker().answer_push(false);
    const PanelRecord& record = *judged.panel;
    const QString frame = QString::fromStdString(record.push.frame_name);
    const QString frames =
        tr("%1 now  %2\n%1 new  %3")
            .arg(frame, frame_text(record.push.before), frame_text(record.base_from_frame));
    QString question;
    if (record.servo)
        question = tr("The first move takes %1. There are up to %2 of them, each judged by the gate.")
                       .arg(panel_words::motion_sentence(record.servo->motion))
                       .arg(device_servoing().max_moves);
    else if (record.fit)
        question = tr("This moves %1.").arg(panel_words::motion_sentence(record.fit->gripper_motion));
    ask(question + "\n" + frames + "\n" + tr("Nothing has been sent yet."),
        tr("Push %1 to %2")
            .arg(frame,
                 [&] {
                     const PanelJob* chosen = job();
                     return chosen ? QString::fromStdString(chosen->robot_id) : QString();
                 }()),
        [this](bool yes) { desk_.worker().answer_push(yes); });
    show_record(&record);
    set_verdict(*verdict_, tr("The panel is measured and waits for your answer below."), Tone::attention);
}

void PanelDialog::take_run(std::shared_ptr<const MeasuredPanel> panel) {
    if (std::exchange(waiting_, Deed::none) == Deed::none) return;
    asking_->hide();
    answer_ = nullptr;
    const std::string before = std::exchange(basis_, basis());
    const bool stale = before != basis_;
    if (!stale) shown_ = std::move(panel);
    show_standing();
    if (stale)
        set_verdict(*verdict_, tr("The project was changed meanwhile: measure again."), Tone::attention);
}

void PanelDialog::keep_learnt(const LearntPanel& learnt) {
    if (std::exchange(waiting_, Deed::none) == Deed::none) return;
    if (!learnt.usable) {
        show_standing();
        return set_verdict(
            *verdict_,
            tr("The sensitivity cannot be inverted (condition %1): measure at more places, in other "
               "directions. Nothing was kept.")
                .arg(number(learnt.condition, 0)),
            Tone::alarm);
    }
    const auto kept = desk_.edit_project(
        [&](Project& p) {
            for (PanelJob& one : p.panel_jobs)
                if (one.id == learnt.job.id) one.sensitivity = learnt.job.sensitivity;
        },
        tr("Learn the sensitivity of %1").arg(QString::fromStdString(learnt.job.id)));
    show_standing();
    if (!kept)
        set_verdict(*verdict_, shown_error(tr("The sensitivity was not kept."), kept.error()), Tone::alarm);
    else
        set_verdict(*verdict_, tr("The sensitivity is learnt; the frame is as it was."), Tone::good);
}

void PanelDialog::keep_taught(const PanelJob& taught) {
    if (std::exchange(waiting_, Deed::none) == Deed::none) return;
    const auto kept = desk_.edit_project(
        [&](Project& p) {
            for (PanelJob& one : p.panel_jobs)
                if (one.id == taught.id) one = taught;
        },
        tr("Teach panel job %1").arg(QString::fromStdString(taught.id)));
    show_standing();
    if (!kept)
        set_verdict(*verdict_, shown_error(tr("The panel was not taught."), kept.error()), Tone::alarm);
}

void PanelDialog::fail(const QString& sentence) {
    if (std::exchange(waiting_, Deed::none) == Deed::none) return;
    basis_ = basis();
    asking_->hide();
    answer_ = nullptr;
    show_standing();
    set_verdict(*verdict_, sentence, Tone::alarm);
}

}  // namespace seamwright
