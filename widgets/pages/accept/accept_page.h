#pragma once
// The acceptance of the measuring process, study by study: what each needs, how far it is, what came of it, and the one
// deed that comes next; the requirements as undoable edits; offsets against a better instrument; the report. What is
// measured, judged and written is projects/acceptance/'s, as on the command line. Above it, always seen: the region, its
// tolerance, the verdict and the next deed.

#include <QComboBox>
#include <QFrame>
#include <QLineEdit>
#include <QSpinBox>

#include "widgets/desk/acceptance_desk.h"
#include "widgets/editors/parameter_editor.h"
#include "widgets/pages/parts/step_page.h"

namespace seamwright {

class AcceptPage : public StepPage {
    Q_OBJECT
  public:
    AcceptPage(Desk& desk, const Views& views);

  signals:
    void told(QString sentence);  // of what was done

  protected:
    void refresh() override;
    void entered() override;
    void resizeEvent(QResizeEvent* event) override;  // a table that is too wide is said otherwise

  private:
    void make_fixed_head();
    void make_studies();
    void make_requirements();
    void make_offsets();
    void make_exports();
    QSpinBox* count(const QString& name, int least, int most);
    void refresh_head();
    void refresh_list();
    void refresh_study();
    void refresh_requirements();
    void refresh_offsets();
    void enable();
    void draw();
    void draw_runs(const std::vector<StudyValue>& values, const QString& title, const TrendLimits& limits,
                   const TrendLimits& tolerance);
    void choose(AgendaStudy study);
    AgendaStudy chosen() const;
    const AgendaItem* item() const;
    QString deed_of(const AgendaItem& item) const;  // empty: there is none
    void do_deed(const AgendaItem& item, bool with_fields);
    LiveStudyOptions options_of(const AgendaItem& item, bool with_fields) const;
    void import(AgendaStudy study);
    void write_report();
    void write_values();

    AcceptanceDesk acceptance_;
    QComboBox* region_ = nullptr;
    QLabel *tolerance_ = nullptr, *verdict_ = nullptr;
    QPushButton* next_ = nullptr;
    QFrame* place_ = nullptr;
    QLabel* place_text_ = nullptr;

    QTableWidget* list_ = nullptr;
    QLabel *name_ = nullptr, *needs_ = nullptr, *finding_ = nullptr, *result_ = nullptr, *forecast_ = nullptr;
    QWidget *runs_row_ = nullptr, *parts_row_ = nullptr, *rehangs_row_ = nullptr, *travel_row_ = nullptr;
    QSpinBox *runs_ = nullptr, *rehangs_ = nullptr, *travel_ = nullptr;
    QLineEdit* parts_ = nullptr;
    QPushButton *deed_ = nullptr, *anew_ = nullptr, *charts_ = nullptr;
    std::optional<AgendaStudy> filled_;  // whose fields are shown

    QComboBox* variant_ = nullptr;
    std::vector<ParameterEditor*> requirements_;

    QTableWidget* offsets_ = nullptr;
    QPushButton *keep_ = nullptr, *act_ = nullptr, *off_ = nullptr;
    QComboBox* language_ = nullptr;
    QPushButton *report_ = nullptr, *values_ = nullptr;
};

}  // namespace seamwright
