#pragma once
// Spots in measuring order and regions with their spots; follows and sets the selection.

#include <QTreeWidget>

#include "widgets/desk/desk.h"

namespace seamwright {

class SpotTree : public QTreeWidget {
    Q_OBJECT
  public:
    explicit SpotTree(Desk& desk, QWidget* parent = nullptr);
    void refresh();
    bool on_spot() const;  // the marked row is a spot's

  private:
    Desk& desk_;
    bool filling_ = false;
};

}  // namespace seamwright
