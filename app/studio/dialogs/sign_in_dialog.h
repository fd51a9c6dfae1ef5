#pragma once
// Who works: a user and his password. Stays until it fits or is put away; a project may be looked at without.

#include <QComboBox>
#include <QDialog>
#include <QLabel>
#include <QLineEdit>

#include "widgets/desk/desk.h"

namespace seamwright {

QString role_name(Role role);

class SignInDialog : public QDialog {
    Q_OBJECT
  public:
    explicit SignInDialog(Desk& desk, QWidget* parent = nullptr);

  private:
    void sign_in();
    Desk& desk_;
    QComboBox* name_;
    QLineEdit* password_;
    QLabel* trouble_;
};

}  // namespace seamwright
