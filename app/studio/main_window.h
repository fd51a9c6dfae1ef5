#pragma once
// Rail and step page on the left, views as docks on the right, status below; see the pages for what they do.

#include <QDialog>
#include <QDockWidget>
#include <QLabel>
#include <QMainWindow>
#include <QStackedWidget>
#include <QTimer>
#include <array>
#include <map>

#include "app/studio/step_rail.h"
#include "widgets/pages/parts/views.h"

namespace seamwright {

class Studio;
class StepPage;
class RunPage;
class ManualWindow;
class PageArea;

class MainWindow : public QMainWindow {
    Q_OBJECT
  public:
    explicit MainWindow(Studio& studio);
    ~MainWindow() override;

    void show_step(Step step);
    // Shows the next step, and once more when the devices have connected: an opened project begins where its
    // work goes on.
    void begin_at_next();
    Step step() const { return step_; }
    const Views& views() const { return views_; }
    void remember();                      // layout into the settings
    void toggle_full(QDockWidget* dock);  // one view alone, and back
    QList<QAction*> all_actions() const;  // what the palette lists
    bool may_leave();                     // asks about running work and unsaved edits
    // Whoever touches neither mouse nor keyboard for so long is signed out; 0: never.
    int sign_out_minutes() const;

  protected:
    void closeEvent(QCloseEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    bool focusNextPrevChild(bool next) override;
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dropEvent(QDropEvent* event) override;
    bool eventFilter(QObject* object, QEvent* event) override;

  private:
    QAction* action(const QString& name, const QString& icon_name, const QString& text,
                    const QKeySequence& keys, const std::function<void()>& run);
    void make_actions();  // main_window_actions.cpp
    void let_act();       // what needs a project, where there is one
    void make_file_menu();
    void make_edit_menu();
    void make_steps_menu();
    void make_measure_menu();
    void make_view_menu();
    void make_help_menu();
    void make_bar();
    void make_docks();
    void make_central();
    void make_status();
    QDockWidget* add_dock(const QString& name, const QString& title, QWidget* view);
    void refresh_title();
    void refresh_status();
    void refresh_devices();
    void refresh_next();
    void tell(const QString& sentence);       // of what went wrong
    void tell_done(const QString& sentence);  // of what was done
    void show_message(const QString& sentence, const char* tone);
    void place_message();
    bool push_waits() const;  // for an answer on a page that is not shown
    void go_on();             // to the next step, or on its page to what is to be done there
    void lead_to(Step step);
    bool may_cancel();
    bool take_typed();
    QString project_to_write(const QString& title, const QString& suggestion);
    void new_project();
    void open_project();
    void save_as();
    void export_project();
    void import_project();
    void make_report();
    void show_dialog(const QString& name,
                     const std::function<QDialog*()>& make);  // beside the window, once of a name
    void mirror_project();
    void reteach();
    void show_manual(const QString& page);
    void ask_who();
    void set_sign_out();
    void refresh_person();
    bool save();

    Studio& studio_;
    Desk& desk_;
    Views views_;
    ViewFeeder* feeder_ = nullptr;
    StepRail* rail_ = nullptr;
    QStackedWidget* pages_ = nullptr;
    RunPage* run_page_ = nullptr;
    QList<StepPage*> step_pages_;     // in the order of kSteps
    ManualWindow* manual_ = nullptr;  // once it was asked for
    QPushButton* next_ = nullptr;
    QString calibrating_;  // what a guided calibration says that it is at; empty: none is shown
    QFrame* trouble_ = nullptr;
    QLabel* trouble_text_ = nullptr;
    QLabel *sensors_ = nullptr, *robots_ = nullptr, *push_ = nullptr, *events_ = nullptr, *saved_ = nullptr,
           *person_ = nullptr;
    QMenu* recent_ = nullptr;
    QList<QAction*> in_bar_;  // beside the menus: save, undo, redo, all actions, language, theme
    QList<QDockWidget*> docks_;
    QByteArray before_full_;
    QDockWidget* full_ = nullptr;
    Step step_ = Step::cell;
    bool beginning_ = false;
    QTimer devices_timer_;
    QTimer idle_timer_;
    QAction *sign_in_ = nullptr, *sign_out_ = nullptr;
    QByteArray default_layout_;
    QList<PageArea*> page_areas_;
};

}  // namespace seamwright
