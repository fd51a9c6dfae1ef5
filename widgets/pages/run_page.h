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
    // A push waits for an answer here.
    bool asks() const { return asks_; }
    void point_out() override;  // the question, while it asks

  signals:
    void asks_changed();

  protected:
    void refresh() override;
    void entered() override;
    QWidget* due() override { return measure_; }
    bool eventFilter(QObject* watched, QEvent* event) override;

  private:
    // Of a measurement that was asked for here, or of one of the history, which says so.
    enum class Shown { now, earlier };
    void show_run(std::shared_ptr<const RunRecord> run, Shown when);
    void show_number(std::int64_t number);  // of the history
    void show_verdict(const RunRecord& run, const QStringList& left_out, Shown when);
    QStringList show_spots(const RunRecord& run);  // ids of those that a correction left out
    void show_nothing(const QString& verdict, Tone tone);
    void begin();  // of a job: what is shown is of no part any more
    void ended();  // without a run
    void set_asks(bool asks);
    void fit_question();  // wholly in the view, whose table scrolls
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
    enum class Job { none, measuring, failed } job_ = Job::none;
    bool asks_ = false;
    bool voided_ = false;  // the question, by an edit
};

}  // namespace seamwright
