#pragma once
// Measuring, the results per region and spot, the push and its question, the history.

#include <QCheckBox>
#include <QLineEdit>
#include <QTimer>

#include "widgets/pages/parts/step_page.h"

namespace seamwright {

class RunPage : public StepPage {
    Q_OBJECT
  public:
    RunPage(Desk& desk, const Views& views);
    void measure(bool push);

  protected:
    void refresh() override;
    void entered() override;

  private:
    void show_run(std::shared_ptr<const RunRecord> run);
    void ask(const std::shared_ptr<const RunRecord>& judged);
    void answer(bool yes);
    void show_history();
    void export_csv();
    void compare();
    std::int64_t chosen() const;

    QLineEdit* part_;
    QCheckBox* images_;
    QPushButton *measure_, *measure_push_, *push_, *decline_, *open_, *delete_, *compare_, *export_;
    QLabel *verdict_, *gate_, *question_;
    QWidget* confirm_;
    QTableWidget *regions_, *spots_, *frames_, *history_, *differences_;
    std::shared_ptr<const RunRecord> shown_;
    std::vector<RunSummary> summaries_;
    std::vector<std::int64_t> charted_;  // runs of the trend, in its order
};

}  // namespace seamwright
