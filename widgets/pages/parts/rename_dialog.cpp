#include "widgets/pages/parts/rename_dialog.h"

#include <QCoreApplication>
#include <QDialog>
#include <QLineEdit>
#include <QRegularExpression>
#include <QVBoxLayout>
#include <algorithm>

#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

struct RenameDialog {
    Q_DECLARE_TR_FUNCTIONS(RenameDialog)
};

// A name without blanks does not wrap.
void show_whole(QDialog& dialog, const QLabel& sentence) {
    int word_px = 0;
    for (const QString& word : sentence.text().split(QRegularExpression("\\s")))
        word_px = std::max(word_px, sentence.fontMetrics().horizontalAdvance(word));
    const QMargins edges = dialog.layout()->contentsMargins();
    dialog.layout()->activate();
    const int width = std::max(dialog.width(), word_px + edges.left() + edges.right() + 4);
    dialog.resize(width, std::max(dialog.layout()->totalHeightForWidth(width),
                                  dialog.layout()->totalSizeHint().height()));
}

}  // namespace

void ask_name(QWidget* parent, const QString& title, const std::string& name,
              const std::function<Expected<void>(const std::string& name)>& take) {
    auto* dialog = new QDialog(parent->window());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setObjectName("rename_dialog");
    dialog->setWindowTitle(title);
    dialog->setMinimumWidth(360);
    auto* box = new QVBoxLayout(dialog);
    auto* line = new QLineEdit(QString::fromStdString(name));
    line->setObjectName("new_name");
    line->selectAll();
    add_field(*box, RenameDialog::tr("New name"), line, RenameDialog::tr("At most 64 signs, of its own"));
    auto* refused = make_text({});
    refused->setObjectName("rename_refused");
    refused->hide();
    box->addWidget(refused);
    auto* ok = make_button("rename_ok", "check", RenameDialog::tr("Rename"),
                           RenameDialog::tr("Undo brings the old name back"), [=] {
                               const auto taken = take(line->text().trimmed().toStdString());
                               if (taken) return dialog->accept();
                               set_verdict(*refused, shown_error(taken.error()), Tone::alarm);
                               refused->show();
                               show_whole(*dialog, *refused);
                               line->setFocus();
                           });
    ok->setDefault(true);
    box->addLayout(
        make_row({ok, make_button("rename_cancel", "stop", RenameDialog::tr("Cancel"),
                                  RenameDialog::tr("The name stays"), [=] { dialog->reject(); })}));
    line->setFocus();
    dialog->open();
}

}  // namespace seamwright
