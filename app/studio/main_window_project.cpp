// The window's project: made, opened, saved, written and read as other files, dropped upon it, left.

#include <QApplication>
#include <QCloseEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QMessageBox>
#include <QMimeData>
#include <QPointer>
#include <QPushButton>

#include "app/studio/dialogs/reuse_dialogs.h"
#include "app/studio/main_window.h"
#include "app/studio/studio.h"
#include "devices/exchange/json_fields.h"
#include "projects/hand_over/hand_over.h"
#include "projects/reuse/exchange.h"
#include "widgets/editors/leave_field.h"
#include "widgets/pages/run_page.h"
#include "widgets/print/pdf.h"
#include "widgets/shown_text.h"

namespace seamwright {

bool MainWindow::may_leave() {
    if (!take_typed() || !may_cancel()) return false;
    if (!desk_.modified()) return true;
    QMessageBox box(
        QMessageBox::Question, tr("Unsaved edits"),
        tr("%1 has unsaved edits.").arg(QFileInfo(QString::fromStdString(desk_.path().string())).fileName()),
        QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, this);
    box.setObjectName("unsaved_question");
    const int answer = box.exec();
    if (answer == QMessageBox::Save) return save();
    return answer == QMessageBox::Discard;
}

// Whoever closes the project cancels what runs: that happens with the project's end, so that a way back from the questions
// that follow leaves it running.
bool MainWindow::may_cancel() {
    if (!desk_.worker().losable()) return true;
    QMessageBox box(
        QMessageBox::Question, tr("A job is running"),
        run_page_->asks()
            ? tr("A push waits for your answer. When the project is closed, nothing is pushed.")
            : tr("A job is running. When the project is closed, it is cancelled and what it has measured "
                 "so far may be lost."),
        QMessageBox::NoButton, this);
    box.setObjectName("running_question");
    QPushButton* cancel = box.addButton(tr("Cancel the job and close"), QMessageBox::DestructiveRole);
    cancel->setObjectName("cancel_and_close");
    QPushButton* stay = box.addButton(tr("Stay"), QMessageBox::RejectRole);
    stay->setObjectName("stay");
    box.setDefaultButton(stay);
    box.setEscapeButton(stay);
    box.exec();
    return box.clickedButton() == cancel;
}

// What is typed counts before the project is saved, left or connected. False: it is refused where it stands, and stays.
bool MainWindow::take_typed() {
    if (!leave_field(*this)) {
        tell(tr("A value is refused: mend it, or press Esc in its field."));
        return false;
    }
    for (StepPage* page : step_pages_) {
        const QString why = page->take_typed();
        if (why.isEmpty()) continue;
        show_step(page->step());
        tell(why);
        return false;
    }
    return true;
}

// Empty: nothing may be written. The dialog asks about a file of the name that was typed, not about the one with the ending.
QString MainWindow::project_to_write(const QString& title, const QString& suggestion) {
    QString file = QFileDialog::getSaveFileName(this, title, suggestion, tr("Seamwright projects (*.seam)"));
    if (file.isEmpty() || file.endsWith(".seam", Qt::CaseInsensitive)) return file;
    file += ".seam";
    const bool replace =
        !QFileInfo::exists(file) ||
        QMessageBox::question(this, title,
                              tr("%1 is there already. Replace it and all that it holds?").arg(file),
                              QMessageBox::Yes | QMessageBox::No, QMessageBox::No) == QMessageBox::Yes;
    return replace ? file : QString();
}

bool MainWindow::save() {
    if (!take_typed()) return false;
    if (auto saved = desk_.save(); !saved) {
        tell(shown_error(tr("The project was not saved."), saved.error()));
        return false;
    }
    return true;
}

void MainWindow::new_project() {
    if (!may_leave()) return;
    const QString file = project_to_write(tr("New project"), studio_.data_folder() + "/project.seam");
    if (!file.isEmpty()) studio_.create(file);
}

void MainWindow::open_project() {
    if (!may_leave()) return;
    const QString file =
        QFileDialog::getOpenFileName(this, tr("Open project"), {}, tr("Seamwright projects (*.seam)"));
    if (!file.isEmpty()) studio_.open(file);
}

void MainWindow::save_as() {
    if (!take_typed()) return;
    const QString file = project_to_write(tr("Save as"), QString::fromStdString(desk_.path().string()));
    if (file.isEmpty()) return;
    if (auto saved = desk_.save_as(file.toStdString()); !saved)
        tell(shown_error(tr("The project was not saved."), saved.error()));
}

void MainWindow::export_project() {
    const QString file =
        QFileDialog::getSaveFileName(this, tr("Export project"), "project.json", tr("JSON (*.json)"));
    if (file.isEmpty()) return;
    if (auto written = write_text_file(file.toStdString(),
                                       seamwright::export_project(desk_.project(), true).dump(2) + "\n");
        !written)
        tell(shown_error(tr("The file was not written."), written.error()));
}

void MainWindow::import_project() {
    if (!may_leave()) return;
    const QString from = QFileDialog::getOpenFileName(this, tr("Import project"), {}, tr("JSON (*.json)"));
    if (from.isEmpty()) return;
    const auto json = read_json_file(from.toStdString());
    if (!json) return tell(shown_error(tr("Nothing was imported."), json.error()));
    auto project = seamwright::import_project(*json, from.toStdString());
    if (!project) return tell(shown_error(tr("Nothing was imported."), project.error()));
    const QString file = project_to_write(tr("Save the imported project as"), {});
    if (file.isEmpty()) return;
    if (auto made = desk_.create(file.toStdString(), *project); !made)
        tell(shown_error(tr("The project was not made."), made.error()));
}

void MainWindow::make_report() {
    const QFileInfo project(QString::fromStdString(desk_.path().string()));
    const QString file = QFileDialog::getSaveFileName(
        this, tr("Hand-over report"), project.path() + "/" + project.completeBaseName() + ".pdf",
        tr("PDF (*.pdf);;HTML (*.html)"));
    if (file.isEmpty()) return;
    HandOverOptions options;
    options.language = desk_.language();
    auto page = hand_over_report(desk_.file(), desk_.project(), desk_.facts(), options);
    if (!page) return tell(shown_error(tr("There is no report."), page.error()));
    const auto written = file.endsWith(".html", Qt::CaseInsensitive)
                             ? write_text_file(file.toStdString(), page->html())
                             : write_pdf(*page, file.toStdString());
    if (!written) return tell(shown_error(tr("The file was not written."), written.error()));
    desk_.note(EventKind::note, "report", "hand-over report written to " + file.toStdString());
    tell_done(tr("The report is in %1").arg(file));
}

void MainWindow::mirror_project() {
    if (!may_leave()) return;
    MirrorDialog dialog(this);
    if (dialog.exec() != QDialog::Accepted) return;
    auto mirrored = mirrored_project(desk_.project(), dialog.plane());
    if (!mirrored) return tell(shown_error(mirrored.error()));
    const QFileInfo project(QString::fromStdString(desk_.path().string()));
    const QString file =
        project_to_write(tr("Save the mirrored project as"),
                         project.path() + "/" + project.completeBaseName() + "_mirrored.seam");
    if (file.isEmpty()) return;
    if (file == project.filePath()) return tell(tr("Choose another name: the original stays."));
    mirrored->name = QFileInfo(file).completeBaseName().toStdString();
    if (auto made = desk_.create(file.toStdString(), *mirrored); !made)
        return tell(shown_error(tr("The project was not made."), made.error()));
    tell_done(
        tr("This is the mirrored clone. Drive its spots slowly once, and teach their references again."));
}

void MainWindow::reteach() {
    ExchangeDialog dialog(desk_.project(), this);
    if (dialog.exec() != QDialog::Accepted) return;
    const auto moved = desk_.reteach(dialog.exchange());
    if (!moved) return tell(shown_error(moved.error()));
    show_step(Step::prove);
    tell_done(tr("%1 spots were led along. Drive each slowly once, then repeat the zero shift.")
                  .arg(moved->size()));
}

void MainWindow::closeEvent(QCloseEvent* event) {
    if (!may_leave()) {
        event->ignore();
        return;
    }
    remember();
    desk_.close();
    event->accept();
    QApplication::quit();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    for (const QUrl& url : event->mimeData()->urls()) {
        const QString ending = QFileInfo(url.toLocalFile()).suffix().toLower();
        if (QStringList{"seam", "stl", "ply", "obj"}.contains(ending)) event->acceptProposedAction();
    }
}

void MainWindow::dropEvent(QDropEvent* event) {
    for (const QUrl& url : event->mimeData()->urls()) {
        const QString file = url.toLocalFile();
        if (file.endsWith(".seam", Qt::CaseInsensitive)) {
            if (may_leave()) studio_.open(file);
            return;
        }
        desk_.import_part(file.toStdString(), "", [window = QPointer(this)](const Expected<void>& imported) {
            if (window && !imported) window->tell(shown_error(tr("Nothing was imported."), imported.error()));
        });
    }
}

}  // namespace seamwright
