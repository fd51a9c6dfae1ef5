#include "widgets/dialogs/path_dialog.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QVBoxLayout>
#include <algorithm>

#include "devices/registry.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

constexpr int kPathDialogWidth = 560;
constexpr double kFastest_mm_s = 2000;

ScenePath scene_path(const CorrectedByRun& corrected) {
    ScenePath path;
    path.closed = corrected.closed;
    for (const PathCorrection& p : corrected.answer.corrected.points) {
        path.before_mm.push_back(taught_mm(p));
        path.after_mm.push_back(p.workobject_from_tool.translation());
        path.sigma_mm.push_back(p.sigma_mm);
    }
    return path;
}

}  // namespace

PathDialog::PathDialog(Desk& desk, SceneView& scene, QWidget* parent)
    : QDialog(parent), desk_(desk), scene_(scene) {
    setObjectName("path_dialog");
    setWindowTitle(tr("Path corrected by a run"));
    setMinimumWidth(kPathDialogWidth);
    auto* box = new QVBoxLayout(this);
    const auto combo = [&](const char* name, const QStringList& words, const QString& label,
                           const QString& tip) {
        auto* c = new QComboBox;
        c->setObjectName(QString::fromLatin1(name));
        c->addItems(words);
        add_field(*box, label, c, tip);
        connect(c, &QComboBox::currentIndexChanged, this, [this] { correct(); });
        return c;
    };
    const auto check = [&](const char* name, const QString& text, const QString& tip) {
        auto* c = new QCheckBox(text);
        c->setObjectName(QString::fromLatin1(name));
        c->setToolTip(tip);
        c->setMinimumHeight(style::kTargetPx);
        box->addWidget(c);
        connect(c, &QCheckBox::toggled, this, [this] { correct(); });
        return c;
    };
    file_ = new QLineEdit;
    file_->setObjectName("path_file");
    file_->setReadOnly(true);
    add_field(*box, tr("Taught path"), file_, tr("A table or a robot program"));
    box->addLayout(
        make_row({make_button("path_choose", "open", tr("Choose the path..."),
                              tr("A table (.csv) or a robot program: KRL, RAPID, FANUC, URScript, APT"),
                              [this] { choose_file(); })}));
    notation_ = combo("path_notation", {}, tr("Written as"), tr("In whose notation a table's poses are"));
    for (const std::string_view brand : kPathNotations)
        notation_->addItem(QString::fromUtf8(brand.data(), static_cast<int>(brand.size())));
    frame_ = combo("path_frame", {tr("the robot's base"), tr("the work object")}, tr("Points are in"),
                   tr("Of a program: its own frame is the work object"));
    run_ = combo("path_run", {}, tr("Corrected by"), tr("The run whose displacements move the path"));
    closed_ =
        check("path_closed", tr("The path goes on from its last point to its first"), tr("A closed bead"));
    leave_out_ = check("path_leave_out", tr("Without the lines that are not understood"),
                       tr("Of a program; the path then has gaps there"));
    verdict_ = make_text({});
    verdict_->setObjectName("path_verdict");
    verdict_->setMinimumHeight(2 * verdict_->fontMetrics().lineSpacing());  // the table takes what it can get
    verdict_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
    box->addWidget(verdict_);
    regions_ =
        make_table("path_regions", {tr("Region"), tr("Points"), tr("In transitions"), tr("Refused because")},
                   tr("What each region does to the path"));
    box->addWidget(regions_, 1);
    remarks_ = make_text({});
    remarks_->setObjectName("path_remarks");
    box->addWidget(remarks_);
    brand_ = new QComboBox;
    brand_->setObjectName("path_brand");
    for (const std::string_view brand : kPathNotations)
        brand_->addItem(QString::fromUtf8(brand.data(), static_cast<int>(brand.size())));
    add_field(*box, tr("Program for"), brand_, tr("The robot that runs it"));
    speed_ = new NumberBox;
    speed_->setObjectName("path_speed");
    speed_->setRange(0.1, kFastest_mm_s);
    speed_->setValue(PathProgramWords{}.speed_mm_s);
    speed_->setSuffix(tr(" mm/s"));
    add_field(*box, tr("Speed"), speed_, tr("Of the program"));
    name_ = new QLineEdit(QString::fromStdString(PathProgramWords{}.name));
    name_->setObjectName("path_name");
    add_field(*box, tr("Name"), name_, tr("Of files and program"));
    write_ = make_button("path_write", "export", tr("Write the program..."),
                         tr("Asks for a folder; nothing is sent to the robot"), [this] { choose_folder(); });
    box->addLayout(make_row({write_, make_button("path_close", "stop", tr("Close"),
                                                 tr("The path leaves the scene"), [this] { close(); })}));
    connect(&desk_, &Desk::opened, this, &QDialog::close);
    connect(&desk_, &Desk::runs_changed, this, [this] {
        fill_runs();
        correct();
    });
    fill_runs();
    correct();
}

PathDialog::~PathDialog() {
    scene_.set_path({});
}

void PathDialog::fill_runs() {
    filling_ = true;
    const QVariant chosen = run_->currentData();
    run_->clear();
    if (const auto runs = desk_.runs())
        for (auto r = runs->rbegin(); r != runs->rend(); ++r)  // the newest first
            run_->addItem(
                tr("run %1: %2, %3")
                    .arg(r->number)
                    .arg(QString::fromStdString(r->part_id), QString::fromStdString(r->started_utc)),
                QVariant::fromValue<qlonglong>(r->number));
    run_->setCurrentIndex(std::max(0, run_->findData(chosen)));
    filling_ = false;
}

PathOrigin PathDialog::origin() const {
    PathOrigin origin;
    origin.file = file_->text().toStdString();
    origin.brand = notation_->currentText().toStdString();
    origin.frame = frame_->currentIndex() == 0 ? PathFrame::base : PathFrame::workobject;
    origin.leave_out = leave_out_->isChecked();
    return origin;
}

void PathDialog::correct() {
    if (filling_) return;
    corrected_.reset();
    regions_->setRowCount(0);
    remarks_->clear();
    const bool program = program_language_of(file_->text().toStdString()).has_value();
    notation_->setEnabled(!program);
    leave_out_->setEnabled(program);
    if (file_->text().isEmpty()) {
        set_verdict(*verdict_, tr("Choose the path as it was taught."), Tone::plain);
    } else if (run_->count() == 0) {
        set_verdict(*verdict_, tr("There is no run yet: measure a part first."), Tone::attention);
    } else {
        const auto source = read_path_source(origin());
        PathBlendOptions blend;
        blend.closed = closed_->isChecked();
        auto corrected = source
                             ? correct_by_run(desk_.file(), run_->currentData().toLongLong(), *source, blend)
                             : Expected<CorrectedByRun>(tl::unexpected(source.error()));
        if (!corrected) {
            set_verdict(*verdict_, shown_error(corrected.error()), Tone::attention);
        } else {
            corrected_ = std::move(*corrected);
            if (source->program)
                for (const Text& remark : source->program->remarks)
                    corrected_->answer.corrected.remarks.push_back(remark);
        }
    }
    show_answer();
}

void PathDialog::show_answer() {
    const bool may_run = corrected_ && corrected_->answer.ok();
    write_->setEnabled(may_run);
    if (!corrected_) return scene_.set_path({});
    const PathAnswer& answer = corrected_->answer;
    const PathFigures figures = figures_of(answer);
    const QString said = tr("%1 points on %2 mm, moved by up to %3 mm, 3 sigma at most %4 mm")
                             .arg(answer.corrected.points.size())
                             .arg(number(answer.corrected.length_mm, 0), number(figures.largest_shift_mm, 2),
                                  number(3 * figures.largest_sigma_mm, 3));
    set_verdict(*verdict_, may_run ? said : tr("Refused, nothing is written: %1").arg(said),
                may_run ? Tone::good : Tone::alarm);
    QVector<QStringList> rows;
    const auto refusal = [&](const std::string& id) {
        for (const PathRefusal& r : answer.refusals)
            if (r.region_id == id) return shown(r.reason);
        return QString();
    };
    for (const PathRegionFigures& r : figures.regions)
        rows.push_back({QString::fromStdString(r.id), QString::number(r.points), QString::number(r.blended),
                        refusal(r.id)});
    set_rows(*regions_, rows);
    QStringList remarks;
    for (const Text& r : answer.corrected.remarks) remarks << shown(r);
    remarks_->setText(remarks.join('\n'));
    scene_.set_path(scene_path(*corrected_));
}

void PathDialog::take_file(const QString& file) {
    file_->setText(file);
    if (const auto language = program_language_of(file.toStdString()))
        if (const std::string_view brand = brand_of(*language); !brand.empty())
            brand_->setCurrentText(QString::fromUtf8(brand.data(), static_cast<int>(brand.size())));
    correct();
}

void PathDialog::choose_file() {
    const QString file = QFileDialog::getOpenFileName(
        this, tr("Taught path"), QFileInfo(QString::fromStdString(desk_.path().string())).path(),
        tr("Paths (*.csv *.src *.mod *.sys *.prg *.ls *.script *.urscript *.apt *.cl *.cls);;All files (*)"));
    if (!file.isEmpty()) take_file(file);
}

Expected<std::vector<std::filesystem::path>> PathDialog::write_into(const QString& folder) {
    if (!corrected_ || !corrected_->answer.ok())
        return usage_error("there is no path that may be run", "",
                           "choose a path and a run that corrects it");
    const PathProgramWords words{name_->text().toStdString(), speed_->value(),
                                 PathProgramWords{}.rounding_mm};
    SEAM_TRY(const auto files, corrected_path_files(*corrected_, brand_->currentText().toStdString(), words));
    return write_program_files(folder.toStdString(), files);
}

void PathDialog::choose_folder() {
    if (const QString why = take_refused_number(*this); !why.isEmpty())
        return set_verdict(*verdict_, why, Tone::attention);
    const QString folder = QFileDialog::getExistingDirectory(
        this, tr("Folder of the program"), QFileInfo(QString::fromStdString(desk_.path().string())).path());
    if (folder.isEmpty()) return;
    const auto written = write_into(folder);
    if (!written)
        return set_verdict(*verdict_, shown_error(tr("The program was not written."), written.error()),
                           Tone::alarm);
    QStringList names;
    for (const auto& file : *written) names << QString::fromStdString(file.filename().string());
    set_verdict(*verdict_, tr("%1 written to %2").arg(names.join(", "), folder), Tone::good);
}

}  // namespace seamwright
