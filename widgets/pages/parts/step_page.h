#pragma once
// What every step's page has: its heading, what the step is for, its state of the checklist, and refreshing
// only while it is seen.

#include <QLabel>
#include <QProgressBar>
#include <QVBoxLayout>
#include <QWidget>

#include "widgets/desk/desk.h"
#include "widgets/pages/parts/form.h"
#include "widgets/pages/parts/views.h"

namespace seamwright {

class StepPage : public QWidget {
    Q_OBJECT
  public:
    StepPage(Desk& desk, const Views& views, Step step, const QString& purpose);
    Step step() const { return step_; }
    // What stays above the page while it scrolls; nullptr: nothing.
    QWidget* head() const { return head_; }
    // Brings the control into view that the step's open item is done with, and gives it the focus.
    virtual void point_out();
    // Before the project is saved, left or connected: what was typed here and waits for a key of the page counts. Empty, or
    // why it is refused.
    virtual QString take_typed();

  signals:
    void step_wanted(seamwright::Step step);
    void run_shown(std::shared_ptr<const seamwright::RunRecord> run);  // a page shows this run: for the scene

  protected:
    // Fills the page from the desk. Called when shown and whenever the desk or the selection changed.
    virtual void refresh() = 0;
    virtual void entered() {}
    // The control that the step's open item is done with; nullptr: none alone.
    virtual QWidget* due() { return nullptr; }
    void showEvent(QShowEvent* event) override;
    QVBoxLayout& box() { return *box_; }
    // Makes the head, with title and state in it; for what a page adds there.
    QVBoxLayout& make_head();
    // Says an edit's Error in the window's message line; true when there was none.
    bool done(const Expected<void>& result);
    // The same, and what was ticked or chosen shows again what is.
    bool done_or_shown(const Expected<void>& result);
    // Before a motion: false, and said, where a page holds what it has refused, so that the robot would go by another number
    // than the one that stands there.
    bool all_is_taken();
    // A part's name in the window's language, where no person gave it: "run 3", "zero shift 1".
    static QString shown_part(const std::string& id);
    // "Y +5 mm and +0.5 deg".
    static QString shown_shift(QString name);
    // What an editor's refresh() is about: the open project, or a part of it.
    std::string subject(const std::string& id = {}) const { return desk_.path().string() + '\n' + id; }
    // Start, cancel, and how far it is; shown while the worker is busy.
    QWidget* make_progress();

    Desk& desk_;
    const Views& views_;

  private:
    void later();
    void fit_head();
    void let_edit();  // only a project that is there
    QString point_at(QWidget& refused) const;
    Step step_;
    QVBoxLayout* box_;
    QLabel *title_, *state_;
    QWidget* head_ = nullptr;
    bool due_ = false;
};

}  // namespace seamwright
