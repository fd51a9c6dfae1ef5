#pragma once
// A panel in its gripper on the desk (`panel`): measured, brought into the body in one step or by servoing, its sensitivity
// learnt; panel jobs taken from files and taught. Nothing moves before the question below the deeds is answered; what is
// learnt, taught or taken is an edit of the project that can be undone. What is shown goes when what it was measured with is
// changed; a project that is left closes it, and closing it ends what it began.

#include <QComboBox>
#include <QDialog>
#include <QFrame>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QScrollArea>
#include <QTableWidget>
#include <functional>
#include <memory>
#include <optional>

#include "projects/panel/panel_profiles.h"
#include "projects/panel/panel_servo.h"
#include "widgets/charts/heads_plot.h"
#include "widgets/charts/moves_plot.h"
#include "widgets/desk/desk.h"

namespace seamwright {

class PanelDialog : public QDialog {
    Q_OBJECT
  public:
    explicit PanelDialog(Desk& desk, QWidget* parent = nullptr);
    ~PanelDialog() override;

    // A panel job becomes the project's; measures of a panel are fitted and shown, and nothing is kept.
    void take_file(const QString& file);

  private:
    enum class Deed { none, measure, fit, servo, learn, teach };

    QLayout* make_head();
    QLayout* make_deeds();
    QFrame* make_question();
    QLayout* make_results();
    void listen();

    const PanelJob* job() const;
    void fill_jobs();
    void forget();         // what was measured
    void show_standing();  // deeds and words as the project, the devices and what is under way allow
    void show_deeds();
    void fit_question(bool asked);
    void show_sensitivity();
    QString next_words() const;  // what to do now
    QPushButton* next_deed() const;
    std::string basis() const;  // what a measurement rests on, as text

    void ask(const QString& question, const QString& yes, std::function<void(bool)> answer);
    void answer(bool yes);
    void begin(Deed deed);  // by the worker
    void ask_to_learn();
    void ask_to_teach();
    void ask_to_push(const RunRecord& judged);
    void take_run(std::shared_ptr<const MeasuredPanel> panel);
    void keep_learnt(const LearntPanel& learnt);
    void keep_taught(const PanelJob& taught);
    void fail(const QString& sentence);

    void show_record(const PanelRecord* record);  // at the places, its motion and moves; nullptr: none
    void show_profiles();

    Desk& desk_;
    QComboBox* job_;
    QLineEdit* part_;
    QPushButton *file_, *teach_, *measure_, *fit_, *servo_, *learn_, *cancel_, *yes_, *no_;
    QLabel *verdict_, *question_, *sensitivity_, *beside_;
    QProgressBar* progress_;
    QFrame* asking_;
    QScrollArea* question_area_;
    QTableWidget *places_, *motion_;
    HeadsPlot* heads_;
    MovesPlot* moves_;

    bool connected_ = false;     // when the words were chosen
    Deed waiting_ = Deed::none;  // for what this window asked for; what else is done is not its business
    std::function<void(bool)> answer_;
    std::shared_ptr<const MeasuredPanel> shown_;
    std::optional<PanelFit> from_file_;  // of measures in a file
    std::string basis_;                  // of what is shown, or under way
};

// In a person's words: what is measured at the places, and the motion.
namespace panel_words {

// Of the measures from a file, else of the job and, where there is one, the record.
QVector<QStringList> place_rows(const PanelJob* job, const PanelRecord* record, const PanelFit* from_file);
QStringList place_header();
QVector<QStringList> motion_rows(const PanelFit* fit, const PanelServo* servo);
// "moves the panel by 3.31 mm and turns it by 0.120 degrees (X +0.61  Y ..)"
QString motion_sentence(const Pose& motion);
QString servo_sentence(const PanelRecord& record);
QString sensitivity_sentence(const Project& project, const PanelJob& job, bool& attention);
QString status_word(ServoingStatus status);

}  // namespace panel_words

}  // namespace seamwright
