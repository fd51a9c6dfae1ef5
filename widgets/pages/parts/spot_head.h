#pragma once
// What stands above the pages of a spot and does not scroll: which spot, what is done of it, and the one deed that comes next.

#include <QLabel>
#include <QPushButton>
#include <QWidget>

#include "widgets/desk/desk.h"

namespace seamwright {

enum class SpotDeed {
    add,        // there is no spot yet
    choose,     // none is selected
    piece,      // the template's piece of contour
    reference,  // to be measured
    confirm,    // its reference is from the drawing
    pass,       // to be recorded and accepted
    accept,     // a recorded one that nobody has accepted yet
    next_spot,  // another one that is not done
    next_step   // all spots are done
};

// Of the spot with this id (none: empty) as project and evidence stand: a pass counts while it was accepted and the spot is
// as it was then.
SpotDeed next_deed(const Desk& desk, const std::string& spot_id);
// The first spot after it, in the project's order and round again, of which something is missing; nullptr: none.
const Spot* next_undone(const Desk& desk, const std::string& spot_id);

class SpotHead : public QWidget {
    Q_OBJECT
  public:
    explicit SpotHead(Desk& desk, QWidget* parent = nullptr);
    void refresh();
    // A pass of the spot was recorded that can be accepted.
    void set_pass_waits(bool waits);

  signals:
    void wanted(seamwright::SpotDeed deed);

  private:
    Desk& desk_;
    QLabel *name_, *state_;
    QPushButton *deed_, *go_;
    SpotDeed shown_ = SpotDeed::add;
    bool pass_waits_ = false;
};

}  // namespace seamwright
