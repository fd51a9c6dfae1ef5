#include "app/studio/dialogs/sign_in_dialog.h"

#include <QApplication>
#include <QVBoxLayout>

#include "widgets/pages/parts/form.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {

QString role_name(Role role) {
    switch (role) {
        case Role::service:
            return SignInDialog::tr("service");
        case Role::operator_:
            return SignInDialog::tr("operator");
        case Role::engineer:
            return SignInDialog::tr("engineer");
        case Role::administrator:
            return SignInDialog::tr("administrator");
    }
    return {};
}

SignInDialog::SignInDialog(Desk& desk, QWidget* parent) : QDialog(parent), desk_(desk) {
    setObjectName("sign_in_dialog");
    setWindowTitle(tr("Sign in"));
    setMinimumWidth(360);
    auto* box = new QVBoxLayout(this);
    box->addWidget(make_text(
        tr("The project has users: to teach, to change limits and to push somebody signs in. To look "
           "at it and to measure nobody has to.")));
    name_ = new QComboBox;
    name_->setObjectName("sign_in_name");
    for (const User& u : desk_.users())
        if (u.role != Role::service) name_->addItem(QString::fromStdString(u.name));
    add_field(*box, tr("User"), name_, tr("Who works"));
    password_ = new QLineEdit;
    password_->setObjectName("sign_in_password");
    password_->setEchoMode(QLineEdit::Password);
    password_->setMaxLength(1024);
    add_field(*box, tr("Password"), password_,
              tr("After three wrong ones it takes a while until the next is looked at"));
    trouble_ = make_text({});
    trouble_->setObjectName("sign_in_trouble");
    trouble_->hide();
    box->addWidget(trouble_);
    auto* ok = make_button("sign_in_ok", "check", tr("Sign in"), tr("Takes a moment"), [this] { sign_in(); });
    ok->setDefault(true);
    box->addLayout(make_row({ok, make_button("sign_in_cancel", "stop", tr("Only look"), tr("Nobody signs in"),
                                             [this] { reject(); })}));
    password_->setFocus();
}

void SignInDialog::sign_in() {
    QApplication::setOverrideCursor(Qt::WaitCursor);
    auto done = desk_.sign_in(name_->currentText().toStdString(), password_->text().toStdString());
    QApplication::restoreOverrideCursor();
    password_->clear();
    if (done) return accept();
    trouble_->setText(shown_error(done.error()));
    trouble_->show();
    password_->setFocus();
}

}  // namespace seamwright
