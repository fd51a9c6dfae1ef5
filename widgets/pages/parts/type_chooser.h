#pragma once
// Which of the project's part types is measured: a list that is there only where the project has types. The choice is
// Selection::part_type(), the same on every page.

#include <QComboBox>
#include <QWidget>

#include "widgets/desk/desk.h"

namespace seamwright {

class TypeChooser : public QWidget {
    Q_OBJECT
  public:
    explicit TypeChooser(Desk& desk, QWidget* parent = nullptr);

  private:
    void refresh();

    Desk& desk_;
    QComboBox* types_;
};

}  // namespace seamwright
