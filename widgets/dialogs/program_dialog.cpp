#include "widgets/dialogs/program_dialog.h"

#include <QFileDialog>
#include <QFileInfo>
#include <QVBoxLayout>
#include <algorithm>

#include "devices/registry.h"
#include "projects/measure/measure.h"
#include "projects/station/program.h"
#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

constexpr int kProgramDialogWidth = 520;

Expected<ProgramRequest> request_of(const Project& project, const QComboBox& robot, const QComboBox& type) {
    return program_request(project, RobotId(robot.currentText().toStdString()),
                           PartTypeId(type.currentText().toStdString()));
}

}  // namespace

ProgramDialog::ProgramDialog(Desk& desk, QWidget* parent) : QDialog(parent), desk_(desk) {
    setObjectName("program_dialog");
    setWindowTitle(tr("Program for the robot's controller"));
    setMinimumWidth(kProgramDialogWidth);
    auto* box = new QVBoxLayout(this);
    box->addWidget(
        make_text(tr("The module that talks to Seamwright, the measuring program with entry, trigger and "
                     "exit of every spot, "
                     "and the application's frames. Drive it slowly once before it runs by itself.")));
    const auto combo = [&](const char* name, const QString& label, const QString& tip) {
        auto* c = new QComboBox;
        c->setObjectName(QString::fromLatin1(name));
        add_field(*box, label, c, tip);
        return c;
    };
    robot_ = combo("program_robot", tr("Robot"), tr("Whose program it is"));
    type_ = combo("program_type", tr("Part type"),
                  tr("Its spots; the program says the type with its start signal"));
    brand_ = combo("program_brand", tr("Controller"), tr("For which controller the files are"));
    for (const ProgramWriter& writer : program_writers())
        brand_->addItem(QString::fromUtf8(writer.name.data(), static_cast<int>(writer.name.size())));
    moves_ = make_table("program_moves", {tr("Spot"), tr("Via points"), tr("Speed, mm/s")},
                        tr("In the order of measuring"));
    box->addWidget(moves_, 1);
    verdict_ = make_text({});
    verdict_->setObjectName("program_verdict");
    verdict_->setMinimumHeight(2 * verdict_->fontMetrics().lineSpacing());  // the table takes what it can get
    box->addWidget(verdict_);
    write_ = make_button("program_write", "export", tr("Write the files..."),
                         tr("Asks for a folder; nothing is sent to the robot"), [this] { choose_folder(); });
    box->addLayout(make_row({write_, make_button("program_close", "stop", tr("Close"),
                                                 tr("Nothing more is written"), [this] { close(); })}));
    fill();
    choose_brand();
    connect(robot_, &QComboBox::currentIndexChanged, this, [this] { choose_brand(); });
    for (QComboBox* c : {robot_, type_, brand_})
        connect(c, &QComboBox::currentIndexChanged, this, [this] { show_request(); });
    connect(&desk_, &Desk::opened, this, &QDialog::close);
    connect(&desk_, &Desk::project_changed, this, [this] { fill(); });
}

void ProgramDialog::fill() {
    filling_ = true;
    const Project& p = desk_.project();
    const auto refill = [](QComboBox& combo, const QStringList& ids) {
        const QString chosen = combo.currentText();
        combo.clear();
        combo.addItems(ids);
        combo.setCurrentIndex(std::max(0, combo.findText(chosen)));
        combo.setEnabled(ids.size() > 1);
    };
    QStringList robots, types;
    for (const RobotSetup& r : p.robots) robots << QString::fromStdString(r.id);
    for (const PartType& t : p.part_types) types << QString::fromStdString(t.id);
    refill(*robot_, robots);
    refill(*type_, types);
    filling_ = false;
    show_request();
}

// The one that the robot's driver names: "kuka" of "kuka" and of "kuka-rsi".
void ProgramDialog::choose_brand() {
    if (filling_) return;
    const RobotSetup* robot = find_robot(desk_.project(), robot_->currentText().toStdString());
    for (int i = 0; robot && i < brand_->count(); ++i)
        if (QString::fromStdString(robot->driver).startsWith(brand_->itemText(i))) brand_->setCurrentIndex(i);
}

void ProgramDialog::show_request() {
    if (filling_) return;
    const auto request = request_of(desk_.project(), *robot_, *type_);
    const auto files = request ? write_robot_program(brand_->currentText().toStdString(), *request)
                               : Expected<std::vector<ProgramFile>>(tl::unexpected(request.error()));
    write_->setEnabled(files.has_value());
    QVector<QStringList> rows;
    if (request)
        for (const MeasuringMove& m : request->moves)
            rows.push_back(
                {QString::fromStdString(m.spot_id), QString::number(m.via.size()), number(m.speed_mm_s, 0)});
    set_rows(*moves_, rows);
    if (!files) return set_verdict(*verdict_, shown_error(files.error()), Tone::attention);
    QStringList names;
    for (const ProgramFile& f : *files) names << QString::fromStdString(f.name);
    const QString holds = tr("%1 spots, %2 frames: %3")
                              .arg(request->moves.size())
                              .arg(request->frames.size())
                              .arg(names.join(", "));
    const QString clash = said_of_same_files(*request, *files);
    set_verdict(*verdict_, clash.isEmpty() ? holds : QStringLiteral("%1. %2").arg(holds, clash),
                clash.isEmpty() ? Tone::good : Tone::attention);
}

// Of the part types whose files have the same names; empty: none.
QString ProgramDialog::said_of_same_files(const ProgramRequest& request,
                                          const std::vector<ProgramFile>& files) const {
    QStringList types;
    for (const std::string& type :
         types_with_these_files(desk_.project(), RobotId(robot_->currentText().toStdString()),
                                brand_->currentText().toStdString(), request, files))
        types << QString::fromStdString(type);
    if (types.isEmpty()) return {};
    return tr("The files of part type %1 have the same names: a controller holds the program of one type, "
              "the one that was loaded last, and parts of the others are refused at their start. Write each "
              "type into a "
              "folder of its own, and load the one that comes.")
        .arg(types.join(QStringLiteral(", ")));
}

Expected<std::vector<std::filesystem::path>> ProgramDialog::write_into(const QString& folder) {
    SEAM_TRY(const auto request, request_of(desk_.project(), *robot_, *type_));
    SEAM_TRY(const auto files, write_robot_program(brand_->currentText().toStdString(), request));
    same_files_ = said_of_same_files(request, files);
    return write_program_files(folder.toStdString(), files);
}

void ProgramDialog::choose_folder() {
    const QString folder = QFileDialog::getExistingDirectory(
        this, tr("Folder of the program"), QFileInfo(QString::fromStdString(desk_.path().string())).path());
    if (folder.isEmpty()) return;
    const auto written = write_into(folder);
    if (!written)
        return set_verdict(*verdict_, shown_error(tr("The program was not written."), written.error()),
                           Tone::alarm);
    const QString done = tr("%1 files written to %2").arg(written->size()).arg(folder);
    set_verdict(*verdict_, same_files_.isEmpty() ? done : QStringLiteral("%1. %2").arg(done, same_files_),
                same_files_.isEmpty() ? Tone::good : Tone::attention);
}

}  // namespace seamwright
