#pragma once
// The project's calibrations as cards: method, verdict, age, which one is in use; and the methods that make
// one, each opening its guided page.

#include <QComboBox>

#include "widgets/pages/guided/guided_page.h"
#include "widgets/pages/parts/step_page.h"

namespace seamwright {

class CalibratePage : public StepPage {
    Q_OBJECT
  public:
    CalibratePage(Desk& desk, const Views& views);

  signals:
    // GuidedPage::under_way
    void under_way(const QString& words);
    void connect_wanted();  // GuidedPage::connect_wanted

  protected:
    void refresh() override;
    QWidget* due() override;
    void entered() override;

  private:
    void take_simulated();
    void begin(const std::string& method);
    void show_guided(bool guided);

    GuidedPage* guided_;
    QWidget* overview_;
    QComboBox *sensor_, *robot_;
    std::map<std::string, QPushButton*> begins_;
    QVBoxLayout* cards_;
    QWidget* simulated_ = nullptr;
    QWidget* first_begin_ = nullptr;
    std::vector<QLabel*> before_;  // of the methods that need the camera: what comes before them
    std::string shown_;
};

}  // namespace seamwright
