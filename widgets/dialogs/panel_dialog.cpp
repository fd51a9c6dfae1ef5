#include "widgets/dialogs/panel_dialog.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QStyle>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "projects/file/project_json.h"
#include "projects/measure/measure.h"
#include "projects/panel/panel_station.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

constexpr int kPanelDialogWidth = 1180, kPlacesHeight = 210, kMotionWidth = 400;
constexpr int kPlacesBesideQuestion = 110, kLongestQuestion = 220;

Tone tone_of(RunStatus status) {
    switch (status) {
        case RunStatus::ok:
            return Tone::good;
        case RunStatus::alarm:
        case RunStatus::device:
            return Tone::alarm;
        default:
            return Tone::attention;
    }
}

}  // namespace

PanelDialog::PanelDialog(Desk& desk, QWidget* parent) : QDialog(parent), desk_(desk) {
    setObjectName("panel_dialog");
    setWindowTitle(tr("Fit a panel"));
    setMinimumWidth(kPanelDialogWidth);
    auto* box = new QVBoxLayout(this);
    box->addLayout(make_head());
    verdict_ = make_text({});
    verdict_->setObjectName("panel_verdict");
    verdict_->setMinimumHeight(2 * verdict_->fontMetrics().lineSpacing());
    verdict_->setAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    box->addWidget(verdict_);
    box->addLayout(make_deeds());
    places_ =
        make_table("panel_places", panel_words::place_header(),
                   tr("Gap and flush at each place, with one sigma; the chosen one's profiles are below"));
    places_->setMinimumHeight(kPlacesHeight);
    box->addWidget(places_, 1);
    box->addLayout(make_results(), 1);
    sensitivity_ = make_text({});
    sensitivity_->setObjectName("panel_sensitivity");
    box->addWidget(sensitivity_);
    connected_ = desk_.station().connected;
    listen();
    fill_jobs();
    show_standing();
}

PanelDialog::~PanelDialog() {
    if (waiting_ != Deed::none) desk_.worker().cancel();
}

QLayout* PanelDialog::make_head() {
    auto* row = new QHBoxLayout;
    const auto field = [&](const QString& label, QWidget* widget, const QString& tip, int stretch) {
        auto* name = new QLabel(label);
        name->setBuddy(widget);
        widget->setToolTip(tip);
        widget->setAccessibleName(label);
        widget->setMinimumHeight(style::kTargetPx);
        row->addWidget(name);
        row->addWidget(widget, stretch);
    };
    job_ = new QComboBox;
    job_->setObjectName("panel_job");
    field(tr("Panel job"), job_, tr("Of this project"), 2);
    part_ = new QLineEdit;
    part_->setObjectName("panel_part");
    part_->setPlaceholderText(tr("run number"));
    field(tr("Panel"), part_, tr("Its name in the runs; empty: the run's number"), 2);
    file_ = make_button(
        "panel_file", "open", tr("From a file..."),
        tr("A panel job (JSON) for this project, or measures of a panel to be fitted by themselves"), [this] {
            const QString file = QFileDialog::getOpenFileName(
                this, tr("Panel job"), QFileInfo(QString::fromStdString(desk_.path().string())).path(),
                tr("Panel jobs (*.json);;All files (*)"));
            if (!file.isEmpty()) take_file(file);
        });
    teach_ = make_button("panel_teach", "target", tr("Teach..."),
                         tr("The panel is in its zero position: gap and flush there become the taught ones"),
                         [this] { ask_to_teach(); });
    row->addWidget(file_);
    row->addWidget(teach_);
    return row;
}

QLayout* PanelDialog::make_deeds() {
    measure_ =
        make_button("panel_measure", "measure", tr("Measure"),
                    tr("Nothing is written, nothing is moved by it"), [this] { begin(Deed::measure); });
    fit_ = make_button("panel_fit", "push", tr("Fit in one step..."),
                       tr("Measures, asks, writes the frame through the safety gate and measures again"),
                       [this] { begin(Deed::fit); });
    servo_ = make_button(
        "panel_servo", "next", tr("Servo..."),
        tr("In several moves by the learnt sensitivity, each through the safety gate; asks first"),
        [this] { begin(Deed::servo); });
    learn_ = make_button("panel_learn", "calibrate", tr("Learn the sensitivity..."),
                         tr("Twelve small moves through the safety gate, for servoing; asks first"),
                         [this] { ask_to_learn(); });
    cancel_ = make_button("panel_cancel", "stop", tr("Cancel"),
                          tr("Ends it after the move under way; the first frame is written back"),
                          [this] { desk_.worker().cancel(); });
    progress_ = new QProgressBar;
    progress_->setObjectName("panel_progress");
    progress_->setAccessibleName(tr("Progress"));
    progress_->setMinimumHeight(style::kTargetPx);
    progress_->setFocusPolicy(Qt::NoFocus);
    progress_->setFormat(QStringLiteral("%v / %m"));
    auto* row = new QHBoxLayout;
    for (QPushButton* b : {measure_, fit_, servo_, learn_, cancel_}) row->addWidget(b);
    row->addWidget(progress_, 1);
    row->addWidget(make_button("panel_close", "remove", tr("Close"), tr("Ends what was begun here"),
                               [this] { close(); }));
    return row;
}

QFrame* PanelDialog::make_question() {
    asking_ = new QFrame;
    asking_->setObjectName("panel_asking");
    asking_->setFrameShape(QFrame::StyledPanel);
    auto* box = new QVBoxLayout(asking_);
    question_ = make_text({});
    question_->setObjectName("panel_question");
    // What is longer than its room is scrolled to; the keys never are.
    question_area_ = new QScrollArea;
    question_area_->setWidgetResizable(true);
    question_area_->setFrameShape(QFrame::NoFrame);
    question_area_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    question_area_->setFocusPolicy(Qt::NoFocus);
    question_area_->setWidget(question_);
    box->addWidget(question_area_, 1);
    yes_ = make_button("panel_yes", "push", tr("Yes"), tr("It is done"), [this] { answer(true); });
    no_ = make_button("panel_no", "stop", tr("No"), tr("Nothing is sent to the robot"),
                      [this] { answer(false); });
    box->addLayout(make_row({yes_, no_}));
    asking_->hide();
    return asking_;
}

QLayout* PanelDialog::make_results() {
    auto* row = new QHBoxLayout;
    motion_ = make_table("panel_motion", {tr("Gripper"), tr("One step"), tr("± sigma"), tr("Servoing")},
                         tr("The motion in the gripper's own frame, with one sigma"));
    motion_->setMinimumWidth(kMotionWidth);
    row->addWidget(motion_, 2);
    heads_ = new HeadsPlot;
    heads_->setObjectName("panel_heads");
    row->addWidget(heads_, 3);
    row->addWidget(make_question(), 6);
    auto* several = new QWidget;
    auto* right = new QVBoxLayout(several);
    right->setContentsMargins(0, 0, 0, 0);
    moves_ = new MovesPlot;
    moves_->setObjectName("panel_moves");
    right->addWidget(moves_, 1);
    beside_ = make_text({});
    beside_->setObjectName("panel_beside");
    right->addWidget(beside_);
    row->addWidget(several, 3);
    return row;
}

void PanelDialog::listen() {
    const StationWorker& worker = desk_.worker();
    connect(job_, &QComboBox::currentIndexChanged, this, [this] {
        forget();
        show_standing();
    });
    connect(places_, &QTableWidget::itemSelectionChanged, this, &PanelDialog::show_profiles);
    connect(this, &QDialog::finished, this, [this] {
        if (std::exchange(waiting_, Deed::none) != Deed::none) desk_.worker().cancel();
    });
    connect(&desk_, &Desk::opened, this, &QDialog::close);
    connect(&desk_, &Desk::station_changed, this, [this] {
        const bool connected = desk_.station().connected;
        if (std::exchange(connected_, connected) != connected && waiting_ == Deed::none)
            show_standing();
        else
            show_deeds();
    });
    connect(&desk_, &Desk::project_changed, this, [this] {
        fill_jobs();
        if (waiting_ != Deed::none) return;
        // What a deed said stays while nothing changes that it rests on.
        if (std::string now = basis(); now != basis_) {
            basis_ = std::move(now);
            forget();
            show_standing();
        } else {
            show_sensitivity();
            show_deeds();
        }
    });
    connect(&worker, &StationWorker::confirm_panel, this,
            [this](const std::shared_ptr<const RunRecord>& judged) { ask_to_push(*judged); });
    connect(&worker, &StationWorker::panel_moved, this,
            [this](const std::shared_ptr<const PanelRecord>& so_far, int moves) {
                if (waiting_ == Deed::none) return;
                if (waiting_ == Deed::learn) progress_->setValue(moves);
                show_record(&*so_far);
            });
    connect(&worker, &StationWorker::panel_measured, this, &PanelDialog::take_run);
    connect(&worker, &StationWorker::panel_learnt, this,
            [this](const std::shared_ptr<const LearntPanel>& learnt) { keep_learnt(*learnt); });
    connect(&worker, &StationWorker::panel_taught, this,
            [this](const std::shared_ptr<const PanelJob>& taught) { keep_taught(*taught); });
    connect(&worker, &StationWorker::failed, this, &PanelDialog::fail);
    connect(&worker, &StationWorker::progressed, this, [this](int done, int total, const QString& text) {
        if (waiting_ == Deed::none) return;
        if (waiting_ != Deed::learn) {
            progress_->setRange(0, std::max(1, total));
            progress_->setValue(done);
        }
        set_verdict(*verdict_, text, Tone::plain);
    });
    connect(&worker, &StationWorker::busy_changed, this, &PanelDialog::show_deeds);
}

const PanelJob* PanelDialog::job() const {
    return find_panel_job(desk_.project(), job_->currentData().toString().toStdString());
}

void PanelDialog::fill_jobs() {
    const QVariant chosen = job_->currentData();
    const QSignalBlocker quiet(job_);
    job_->clear();
    for (const PanelJob& one : desk_.project().panel_jobs) {
        const QString id = QString::fromStdString(one.id);
        job_->addItem(id, id);
    }
    job_->setCurrentIndex(job_->count() > 0 ? std::max(0, job_->findData(chosen)) : -1);
}

std::string PanelDialog::basis() const {
    const Project& project = desk_.project();
    Project rests_on;
    rests_on.sensors = project.sensors;
    rests_on.robots = project.robots;
    // Told by a device once it is asked, at any time.
    for (SensorSetup& sensor : rests_on.sensors) sensor.identity = {};
    for (RobotSetup& robot : rests_on.robots) robot.identity = {};
    rests_on.calibrations = project.calibrations;
    if (const PanelJob* chosen = job()) {
        rests_on.panel_jobs = {*chosen};
        rests_on.panel_jobs.front().sensitivity.reset();
    }
    return to_json_document(rests_on, {.profiles = false})
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void PanelDialog::forget() {
    shown_.reset();
    from_file_.reset();
}

QString PanelDialog::next_words() const {
    const PanelJob* chosen = job();
    if (!chosen)
        return tr(
            "This project has no panel job: take one from a file, as an entry of \"panel_jobs\" in an "
            "exported project.");
    if (!desk_.station().connected) return tr("Connect the devices first (F4).");
    if (!is_taught(*chosen)) return tr("Bring the panel into its zero position, then teach it.");
    return tr("Measure the panel: nothing is moved by that.");
}

QPushButton* PanelDialog::next_deed() const {
    const PanelJob* chosen = job();
    if (!chosen) return file_;
    if (!is_taught(*chosen)) return teach_;
    if (!shown_) return measure_;
    return !shown_->run.push && shown_->run.status == RunStatus::ok ? fit_ : measure_;
}

void PanelDialog::show_deeds() {
    const PanelJob* chosen = job();
    const bool asked = !asking_->isHidden();
    const bool free = waiting_ == Deed::none && !asked && !desk_.worker().busy();
    const bool ready = free && chosen && desk_.station().connected;
    const bool taught = chosen && is_taught(*chosen);
    job_->setEnabled(waiting_ == Deed::none && !asked);
    file_->setEnabled(free);
    teach_->setEnabled(ready);
    for (QPushButton* b : {measure_, fit_, learn_}) b->setEnabled(ready && taught);
    servo_->setEnabled(ready && taught && chosen->sensitivity);
    cancel_->setEnabled(waiting_ != Deed::none && !asked);
    progress_->setVisible(waiting_ != Deed::none && !asked);
    // The question takes the plots' place: what it is about stays in view.
    heads_->setVisible(!asked);
    moves_->parentWidget()->setVisible(!asked);
    fit_question(asked);
    const QPushButton* next = free ? next_deed() : nullptr;
    for (QPushButton* b : {file_, teach_, measure_, fit_}) {
        if (b == next) b->setDefault(true);
        if (b->property("next").toBool() == (b == next)) continue;
        b->setProperty("next", b == next);
        b->style()->unpolish(b);
        b->style()->polish(b);
    }
}

// The places give their room to what is asked; the window grows by what is still missing.
void PanelDialog::fit_question(bool asked) {
    places_->setMinimumHeight(asked ? kPlacesBesideQuestion : kPlacesHeight);
    if (!asked) return;
    layout()->activate();
    question_area_->setMinimumHeight(
        std::min(kLongestQuestion, question_->heightForWidth(question_area_->viewport()->width())));
}

void PanelDialog::show_standing() {
    show_record(shown_ ? &*shown_->run.panel : nullptr);
    show_profiles();
    show_sensitivity();
    show_deeds();
    if (waiting_ != Deed::none) return set_verdict(*verdict_, tr("Under way."), Tone::plain);
    if (from_file_)
        return set_verdict(*verdict_,
                           tr("Measures from a file: %1. %2 Nothing is kept, nothing moves.")
                               .arg(shown_word(to_string(from_file_->status)), shown(from_file_->message)),
                           from_file_->status == CorrectionStatus::ok ? Tone::good : Tone::attention);
    if (!shown_) return set_verdict(*verdict_, next_words(), job() ? Tone::plain : Tone::attention);
    const RunRecord& run = shown_->run;
    QString said = tr("Run %1, panel %2: %3.")
                       .arg(run.number)
                       .arg(QString::fromStdString(run.part_id), shown(run.message));
    const std::vector<Text>& refusals = run.panel->refusals;
    if (refusals.size() > 1)
        said += " " + tr("%n more reason(s), see the run.", nullptr, static_cast<int>(refusals.size()) - 1);
    set_verdict(*verdict_, said, tone_of(run.status));
}

void PanelDialog::show_record(const PanelRecord* record) {
    const PanelFit* from_file = from_file_ ? &*from_file_ : nullptr;
    const PanelFit* fit = from_file ? from_file : record && record->fit ? &*record->fit : nullptr;
    const PanelServo* servo = record && record->servo && waiting_ != Deed::learn ? &*record->servo : nullptr;
    set_rows(*places_, panel_words::place_rows(shown_ ? &shown_->job : job(), record, from_file));
    if (places_->rowCount() > 0 && places_->currentRow() < 0) places_->setCurrentCell(0, 0);
    set_rows(*motion_, panel_words::motion_rows(fit, servo));
    std::vector<double> rms;
    if (servo)
        for (const PanelServoMove& m : servo->moves) rms.push_back(m.rms_mm);
    moves_->set_moves(rms, device_servoing().stop_mm);
    beside_->setText(servo && shown_ ? panel_words::servo_sentence(*record) : QString());
    beside_->setVisible(!beside_->text().isEmpty());
}

void PanelDialog::show_profiles() {
    const QTableWidgetItem* chosen =
        places_->currentRow() >= 0 ? places_->item(places_->currentRow(), 0) : nullptr;
    const std::vector<PlaceProfiles> none;
    const auto& all = !shown_ ? none : shown_->after.empty() ? shown_->before : shown_->after;
    const auto at = std::find_if(all.begin(), all.end(), [&](const PlaceProfiles& p) {
        return chosen && chosen->text().toStdString() == p.place_id;
    });
    if (at == all.end()) return heads_->set_profiles({}, {}, {});
    QStringList names;
    for (const std::string& id : at->sensor_ids) names << QString::fromStdString(id);
    heads_->set_profiles(names, at->heads, at->merged, {at->middle_mm.x(), at->middle_mm.y()});
}

void PanelDialog::show_sensitivity() {
    const PanelJob* chosen = job();
    bool attention = false;
    set_verdict(*sensitivity_,
                chosen ? panel_words::sensitivity_sentence(desk_.project(), *chosen, attention) : QString(),
                Tone::plain);
    if (attention) set_verdict(*sensitivity_, sensitivity_->text(), Tone::attention);
}

}  // namespace seamwright
