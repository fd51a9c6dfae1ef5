#pragma once
// What a region's correction is unsure by, across the bead where it is worst: a bar a contribution with its share, random and
// systematic apart, and what to mend.

#include <QLabel>

#include "projects/model/project.h"
#include "widgets/charts/share_bars.h"

namespace seamwright {

class BudgetPanel : public QWidget {
    Q_OBJECT
  public:
    explicit BudgetPanel(QWidget* parent = nullptr);
    // Of worst_budget(); nullptr: empty.
    void show_region(const Project& project, const Region* region);

  private:
    QLabel *said_, *mend_, *missing_;
    ShareBars* shares_;
};

}  // namespace seamwright
