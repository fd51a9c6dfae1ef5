#include "widgets/dialogs/gap_dialog.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QMessageBox>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "devices/exchange/files.h"
#include "projects/panel/gap_report.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

constexpr int kGapDialogWidth = 620;
constexpr double kLeastStep_mm = 0.05, kMostStep_mm = 50;

QString word_of(GapVerdict verdict) {
    switch (verdict) {
        case GapVerdict::passes:
            return GapDialog::tr("passes");
        case GapVerdict::doubtful:
            return GapDialog::tr("doubtful");
        case GapVerdict::too_narrow:
            return GapDialog::tr("too narrow");
        case GapVerdict::closed:
            return GapDialog::tr("closed");
        case GapVerdict::not_measured:
            return GapDialog::tr("not measured");
    }
    return {};
}

}  // namespace

GapDialog::GapDialog(Desk& desk, QWidget* parent) : QDialog(parent), desk_(desk) {
    setObjectName("gap_dialog");
    setWindowTitle(tr("Gap along a path"));
    setMinimumWidth(kGapDialogWidth);
    auto* box = new QVBoxLayout(this);
    const auto number_field = [&](const char* name, const QString& label, const QString& tip, double least,
                                  double most, double value) {
        auto* field = new NumberBox;
        field->setObjectName(QString::fromLatin1(name));
        field->setRange(least, most);
        field->setDecimals(2);
        field->setValue(value);
        field->setSuffix(tr(" mm"));
        add_field(*box, label, field, tip);
        return field;
    };
    spots_ = new QLineEdit;
    spots_->setObjectName("gap_spots");
    add_field(*box, tr("Along the spots"), spots_,
              tr("In this order, straight from one to the next: S1, S2, S3"));
    step_ = number_field("gap_step", tr("Step"), tr("Of the sensor's travel between two profiles"),
                         kLeastStep_mm, kMostStep_mm, DrivenGapPass{}.step_mm);
    drive_ =
        make_button("gap_drive", "play", tr("Drive along the gap..."),
                    tr("The robot stops at every step; asks before it moves"), [this] { ask_and_drive(); });
    box->addLayout(make_row({drive_, make_button("gap_recording", "open", tr("From a recording..."),
                                                 tr("A capture that was recorded while the robot travelled"),
                                                 [this] { choose_recording(); })}));
    nozzle_ = number_field("gap_nozzle", tr("Nozzle"), tr("Its width where it enters the gap"), 0, 100,
                           options_.nozzle_mm);
    clearance_ = number_field("gap_clearance", tr("Clearance"), tr("What must be left on either side"), 0,
                              100, options_.clearance_mm);
    reference_ = new QComboBox;
    reference_->setObjectName("gap_reference");
    reference_->addItems({tr("left"), tr("right")});
    add_field(*box, tr("Flush against the part on the"), reference_, tr("Whose surface is the reference"));
    verdict_ = make_text({});
    verdict_->setObjectName("gap_verdict");
    verdict_->setMinimumHeight(2 * verdict_->fontMetrics().lineSpacing());  // the plot takes what it can get
    box->addWidget(verdict_);
    plot_ = new GapPlot;
    plot_->setObjectName("gap_plot");
    box->addWidget(plot_, 2);
    stretches_ = make_table("gap_stretches",
                            {tr("Where"), tr("Verdict"), tr("From, mm"), tr("To, mm"), tr("Narrowest, mm")},
                            tr("Where the nozzle does not pass"));
    box->addWidget(stretches_, 1);
    write_ =
        make_button("gap_write", "export", tr("Write..."),
                    tr("The report (.html) or every point as a table (.csv)"), [this] { choose_output(); });
    box->addLayout(make_row(
        {write_, make_button("gap_close", "stop", tr("Close"), tr("Nothing is kept"), [this] { close(); })}));
    for (NumberBox* field : {nozzle_, clearance_})
        connect(field, &QDoubleSpinBox::valueChanged, this, [this] { judge(); });
    connect(reference_, &QComboBox::currentIndexChanged, this, [this] { judge(); });
    connect(&desk_, &Desk::opened, this, &QDialog::close);
    connect(&desk_.worker(), &StationWorker::gap_passed, this, [this](std::shared_ptr<const GapPass> pass) {
        waiting_ = false;
        pass_ = std::move(pass);
        judge();
    });
    connect(&desk_.worker(), &StationWorker::failed, this, [this](const QString& sentence) {
        if (std::exchange(waiting_, false)) set_verdict(*verdict_, sentence, Tone::alarm);
    });
    connect(&desk_.worker(), &StationWorker::busy_changed, this,
            [this](bool busy) { drive_->setEnabled(!busy); });
    connect(&desk_.worker(), &StationWorker::progressed, this, [this](int done, int total, const QString&) {
        if (waiting_) set_verdict(*verdict_, tr("%1 of %2 profiles").arg(done).arg(total), Tone::plain);
    });
    fill_spots();
    judge();
}

// The enabled spots of the first spot's sensor, in their order.
void GapDialog::fill_spots() {
    QStringList ids;
    const Spot* first = nullptr;
    for (const Spot& s : desk_.project().spots) {
        if (!s.enabled) continue;
        if (!first) first = &s;
        if (s.sensor_id == first->sensor_id && s.robot_id == first->robot_id)
            ids << QString::fromStdString(s.id);
    }
    spots_->setText(ids.join(", "));
}

DrivenGapPass GapDialog::driven() const {
    DrivenGapPass pass;
    for (const QString& id : spots_->text().split(',', Qt::SkipEmptyParts))
        pass.spot_ids.push_back(id.trimmed().toStdString());
    pass.step_mm = step_->value();
    return pass;
}

void GapDialog::drive() {
    waiting_ = true;
    desk_.worker().drive_gap(driven());
}

void GapDialog::ask_and_drive() {
    if (const QString why = take_refused_number(*this); !why.isEmpty())
        return set_verdict(*verdict_, why, Tone::attention);
    if (QMessageBox::question(this, windowTitle(),
                              tr("The robot now drives along %1. Is its way free?").arg(spots_->text())) ==
        QMessageBox::Yes)
        drive();
}

void GapDialog::take_recording(const QString& file) {
    waiting_ = true;
    desk_.worker().read_gap(file.toStdString(), {});
}

void GapDialog::choose_recording() {
    const QString file = QFileDialog::getOpenFileName(
        this, tr("Recording"), QFileInfo(QString::fromStdString(desk_.path().string())).path(),
        tr("Recordings (*.seam);;All files (*)"));
    if (!file.isEmpty()) take_recording(file);
}

void GapDialog::judge() {
    check_.reset();
    write_->setEnabled(false);
    stretches_->setRowCount(0);
    options_.nozzle_mm = nozzle_->value();
    options_.clearance_mm = clearance_->value();
    options_.gauge.reference = reference_->currentIndex() == 0 ? GapFlushSettings::Reference::left
                                                               : GapFlushSettings::Reference::right;
    if (!pass_) {
        plot_->set_scan(nullptr, options_.need_mm());
        return set_verdict(*verdict_, tr("Drive along the gap, or choose a recording."), Tone::plain);
    }
    auto checked = check_gap(desk_.project(), *pass_, options_);
    if (!checked) {
        plot_->set_scan(nullptr, options_.need_mm());
        return set_verdict(*verdict_, shown_error(checked.error()), Tone::attention);
    }
    check_ = std::move(*checked);
    const GapScan& scan = check_->scan;
    plot_->set_scan(&scan, options_.need_mm());
    write_->setEnabled(true);
    QVector<QStringList> rows;
    for (const GapStretch& s : scan.stretches)
        rows.push_back({shown(check_->where((s.from_mm + s.to_mm) / 2)), word_of(s.verdict),
                        number(s.from_mm, 1), number(s.to_mm, 1),
                        has_width(s.verdict) ? number(s.narrowest_mm, 3) : QString("-")});
    set_rows(*stretches_, rows);
    if (scan.measured == 0)
        return set_verdict(*verdict_, tr("None of %1 profiles shows the gap.").arg(scan.points.size()),
                           Tone::alarm);
    const QString said =
        tr("%1 of %2 profiles measured along %3 mm; gap %4 to %5 mm, needed %6 mm with 3 sigma")
            .arg(scan.measured)
            .arg(scan.points.size())
            .arg(number(scan.length_mm, 1), number(scan.narrowest_mm, 3), number(scan.widest_mm, 3),
                 number(options_.need_mm(), 2));
    set_verdict(*verdict_,
                scan.passes() ? tr("The nozzle passes. %1").arg(said)
                              : tr("The nozzle does not pass everywhere. %1").arg(said),
                scan.passes() ? Tone::good : Tone::alarm);
}

Expected<void> GapDialog::write(const QString& file) const {
    if (!check_) return usage_error("there is no pass yet", "", "drive along the gap, or choose a recording");
    return write_text_file(file.toStdString(),
                           file.endsWith(".html", Qt::CaseInsensitive)
                               ? gap_page(*pass_, *check_, options_, desk_.project().name).html()
                               : gap_csv(check_->scan));
}

void GapDialog::choose_output() {
    const QString file = QFileDialog::getSaveFileName(
        this, tr("Gap along a path"),
        QFileInfo(QString::fromStdString(desk_.path().string())).path() + "/gap.html",
        tr("Report (*.html);;Points (*.csv)"));
    if (file.isEmpty()) return;
    if (const auto written = write(file); !written)
        return set_verdict(*verdict_, shown_error(tr("The file was not written."), written.error()),
                           Tone::alarm);
    set_verdict(*verdict_, tr("Written to %1").arg(file), Tone::good);
}

}  // namespace seamwright
