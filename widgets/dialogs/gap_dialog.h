#pragma once
// The gap check on the desk (`gap`): a pass along a gap, recorded or driven stop by stop along the taught spots, its width
// with 3 sigma over the path, and where the nozzle would not pass. What the nozzle needs is changed without measuring
// again. Keeps nothing in the project; a project that is left closes it.

#include <QComboBox>
#include <QDialog>
#include <QLabel>
#include <QLineEdit>
#include <QTableWidget>
#include <memory>
#include <optional>

#include "projects/panel/gap_check.h"
#include "widgets/charts/gap_plot.h"
#include "widgets/desk/desk.h"
#include "widgets/editors/number_box.h"

namespace seamwright {

class GapDialog : public QDialog {
    Q_OBJECT
  public:
    explicit GapDialog(Desk& desk, QWidget* parent = nullptr);

    void take_recording(const QString& file);
    void drive();  // along the spots that are named, as the button does once it was confirmed
    // Error: no pass yet, what the file system refuses. ".html": the report; else the points as a table.
    Expected<void> write(const QString& file) const;

  private:
    void fill_spots();
    void judge();
    void choose_recording();
    void ask_and_drive();
    void choose_output();
    DrivenGapPass driven() const;

    Desk& desk_;
    QLineEdit* spots_;
    QComboBox* reference_;
    NumberBox *step_, *nozzle_, *clearance_;
    QLabel* verdict_;
    GapPlot* plot_;
    QTableWidget* stretches_;
    QPushButton *drive_, *write_;
    std::shared_ptr<const GapPass> pass_;
    std::optional<GapCheck> check_;
    GapScanOptions options_;
    bool waiting_ = false;  // for a pass that this window asked for; what else is done is not its business
};

}  // namespace seamwright
