#pragma once
// The frozen contour: pass entry -> trigger -> exit, verdict, accept.

#include <QDoubleSpinBox>
#include <memory>
#include <vector>

#include "widgets/pages/parts/spot_head.h"
#include "widgets/pages/parts/spot_tree.h"
#include "widgets/pages/parts/step_page.h"

namespace seamwright {

class AlignPage : public StepPage {
    Q_OBJECT
  public:
    AlignPage(Desk& desk, const Views& views);

  protected:
    void refresh() override;
    QWidget* due() override;
    void entered() override;

  private:
    const Spot* spot() const;
    // A recorded pass of this session, accepted or not.
    struct Recorded {
        JudgedPass pass;
        bool accepted = false;
    };
    Recorded* recorded();  // of the chosen spot as it stands; nullptr: none
    void do_deed(SpotDeed deed);
    void start();
    void judge(double jitter_mm);
    void show_result();
    void accept();
    void adopt();

    SpotHead* spot_head_;
    SpotTree* tree_;
    QDoubleSpinBox *step_, *tolerance_;
    QPushButton *start_, *accept_, *adopt_;
    QLabel *verdict_, *numbers_;
    std::vector<Recorded> passes_;  // the last one of each spot
    bool shown_ = false;            // one in the view
};

}  // namespace seamwright
