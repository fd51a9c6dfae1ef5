#include "widgets/dialogs/record_dialog.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QVBoxLayout>

#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr int kRecordDialogWidth = 520, kStatusEvery_ms = 500;
constexpr double kBytesOfMiB = 1 << 20;

}  // namespace

RecordDialog::RecordDialog(Desk& desk, QWidget* parent) : QDialog(parent), desk_(desk) {
    setObjectName("record_dialog");
    setWindowTitle(tr("Record what the devices deliver"));
    setMinimumWidth(kRecordDialogWidth);
    auto* box = new QVBoxLayout(this);
    box->addWidget(make_text(tr(
        "Live profiles, teaching and runs go into the recording too, as long as it goes on. It is replayed "
        "as a sensor and a robot, and a gap or a path is judged from it later.")));
    images_ = new QCheckBox(tr("Keep the raw images too"));
    images_->setObjectName("record_images");
    images_->setToolTip(tr("Of cameras: some MiB a frame; without them the profiles are kept"));
    images_->setMinimumHeight(style::kTargetPx);
    box->addWidget(images_);
    verdict_ = make_text({});
    verdict_->setObjectName("record_verdict");
    verdict_->setMinimumHeight(2 * verdict_->fontMetrics().lineSpacing());  // the table takes what it can get
    box->addWidget(verdict_);
    sources_ =
        make_table("record_sources", {tr("Device"), tr("Frames"), tr("Damaged"), tr("Lost"), tr("Dropped")},
                   tr("What is on the disk; dropped: the disk was too slow"));
    box->addWidget(sources_, 1);
    start_ = make_button("record_start", "save", tr("Record..."),
                         tr("Asks for a file; the devices connect anew"), [this] { ask_and_start(); });
    stop_ = make_button("record_stop", "stop", tr("Stop"), tr("Ends the recording; the devices connect anew"),
                        [this] { stop(); });
    box->addLayout(make_row({start_, stop_}));
    connect(&timer_, &QTimer::timeout, this, [this] { show_status(); });
    connect(&desk_, &Desk::opened, this, &QDialog::close);
    connect(this, &QDialog::finished, this, [this] { stop(); });
    stop_->setEnabled(false);
    set_verdict(*verdict_, tr("Nothing is recorded."), Tone::plain);
}

RecordDialog::~RecordDialog() {
    stop();
}

Expected<void> RecordDialog::start(const QString& file) {
    if (recorder_) return usage_error("a recording runs already", file_.toStdString(), "stop it first");
    RecorderOptions options;
    options.images = images_->isChecked();
    SEAM_TRY(auto recorder, Recorder::create(file.toStdString(), options));
    recorder_ = std::move(recorder);
    file_ = file;
    desk_.worker().record_to(recorder_);
    start_->setEnabled(false);
    images_->setEnabled(false);
    stop_->setEnabled(true);
    timer_.start(kStatusEvery_ms);
    show_status();
    return {};
}

void RecordDialog::stop() {
    if (!recorder_) return;
    timer_.stop();
    const auto finished = recorder_->finish();
    recorder_.reset();
    desk_.worker().record_to(nullptr);
    start_->setEnabled(true);
    images_->setEnabled(true);
    stop_->setEnabled(false);
    if (!finished)
        return set_verdict(*verdict_, shown_error(tr("The recording is not whole."), finished.error()),
                           Tone::alarm);
    show_counters(*finished);
    set_verdict(*verdict_,
                tr("Recorded in %1, %2 MiB")
                    .arg(file_, number(static_cast<double>(finished->bytes) / kBytesOfMiB, 1)),
                Tone::good);
}

void RecordDialog::show_status() {
    if (!recorder_) return;
    const RecorderStatus status = recorder_->status();
    if (status.failure) return stop();
    show_counters(status);
    set_verdict(*verdict_,
                tr("Recording into %1, %2 MiB")
                    .arg(file_, number(static_cast<double>(status.bytes) / kBytesOfMiB, 1)),
                Tone::attention);
}

void RecordDialog::show_counters(const RecorderStatus& status) {
    QVector<QStringList> rows;
    for (const auto& [name, c] : status.sources)
        rows.push_back({QString::fromStdString(name), QString::number(c.frames), QString::number(c.damaged),
                        QString::number(c.lost), QString::number(c.dropped)});
    set_rows(*sources_, rows);
}

void RecordDialog::ask_and_start() {
    const QString file = QFileDialog::getSaveFileName(
        this, tr("Recording"),
        QFileInfo(QString::fromStdString(desk_.path().string())).path() + "/recording.seam",
        tr("Recordings (*.seam)"), nullptr, QFileDialog::DontConfirmOverwrite);
    if (file.isEmpty()) return;
    if (const auto started = start(file); !started)
        set_verdict(*verdict_, shown_error(tr("Nothing is recorded."), started.error()), Tone::alarm);
}

}  // namespace seamwright
