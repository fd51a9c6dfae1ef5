#include <QMenuBar>
#include <QMessageBox>
#include <QSettings>
#include <QToolBar>
#include <QToolButton>

#include "app/manual/manual.h"
#include "app/manual/manual_window.h"
#include "app/studio/dialogs/about.h"
#include "app/studio/dialogs/command_palette.h"
#include "app/studio/main_window.h"
#include "app/studio/studio.h"
#include "widgets/dialogs/gap_dialog.h"
#include "widgets/dialogs/panel_dialog.h"
#include "widgets/dialogs/path_dialog.h"
#include "widgets/dialogs/place_dialog.h"
#include "widgets/dialogs/program_dialog.h"
#include "widgets/dialogs/record_dialog.h"
#include "widgets/menu_signs.h"
#include "widgets/pages/run_page.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

// What there is to do only where a project is open.
constexpr const char* kOfProject[] = {"save",
                                      "save_as",
                                      "export_json",
                                      "report",
                                      "corrected_path",
                                      "spots_from_drawing",
                                      "robot_program",
                                      "mirror",
                                      "reteach",
                                      "connect_all",
                                      "disconnect_all",
                                      "measure_now",
                                      "measure_and_push",
                                      "gap_check",
                                      "panel_fit_dialog",
                                      "record_session"};

}  // namespace

QAction* MainWindow::action(const QString& name, const QString& icon_name, const QString& text,
                            const QKeySequence& keys, const std::function<void()>& run) {
    auto* a = new QAction(text, this);
    a->setObjectName(name);
    if (!icon_name.isEmpty()) a->setIcon(icon(icon_name, palette()));
    if (!keys.isEmpty()) a->setShortcut(keys);
    const QString plain = without_marks(text);
    a->setToolTip(keys.isEmpty()
                      ? plain
                      : plain + QStringLiteral("  (") + keys.toString(QKeySequence::NativeText) + ")");
    connect(a, &QAction::triggered, this, run);
    addAction(a);
    return a;
}

void MainWindow::let_act() {
    for (const char* name : kOfProject) findChild<QAction*>(name)->setEnabled(desk_.is_open());
}

void MainWindow::make_actions() {
    make_file_menu();
    make_edit_menu();
    make_steps_menu();
    make_measure_menu();
    make_view_menu();
    make_help_menu();
    make_bar();
}

void MainWindow::make_file_menu() {
    auto* file = menuBar()->addMenu(tr("&File"));
    file->addAction(
        action("new", "new", tr("&New project..."), QKeySequence::New, [this] { new_project(); }));
    file->addAction(action("open", "open", tr("&Open..."), QKeySequence::Open, [this] { open_project(); }));
    recent_ = file->addMenu(tr("Recent"));
    connect(recent_, &QMenu::aboutToShow, this, [this] {
        recent_->clear();
        for (const QString& path : studio_.recent())
            recent_->addAction(with_signs(path), this, [this, path] {
                if (may_leave()) studio_.open(path);
            });
    });
    auto* save_action = action("save", "save", tr("&Save"), QKeySequence::Save, [this] { save(); });
    file->addAction(save_action);
    file->addAction(
        action("save_as", "save", tr("Save &as..."), QKeySequence("Ctrl+Shift+S"), [this] { save_as(); }));
    file->addSeparator();
    file->addAction(
        action("import_json", "import", tr("Import project (JSON)..."), {}, [this] { import_project(); }));
    file->addAction(
        action("export_json", "export", tr("Export project (JSON)..."), {}, [this] { export_project(); }));
    file->addSeparator();
    file->addAction(action("report", "export", tr("Hand-over report..."), QKeySequence("Ctrl+R"),
                           [this] { make_report(); }));
    file->addAction(
        action("corrected_path", "push", tr("Path corrected by a run..."), QKeySequence("Ctrl+P"), [this] {
            show_dialog("path_dialog", [this] { return new PathDialog(desk_, *views_.scene, this); });
        }));
    file->addAction(action(
        "spots_from_drawing", "teach", tr("Spots from the drawing..."), QKeySequence("Ctrl+D"), [this] {
            show_dialog("place_dialog", [this] { return new PlaceDialog(desk_, *views_.scene, this); });
            views_.raise(views_.scene);
        }));
    file->addAction(action("robot_program", "robot", tr("Program for the robot's controller..."), {}, [this] {
        show_dialog("program_dialog", [this] { return new ProgramDialog(desk_, this); });
    }));
    file->addAction(
        action("mirror", "regions", tr("Clone for the mirrored part..."), {}, [this] { mirror_project(); }));
    file->addAction(action("reteach", "calibrate", tr("After an exchange of sensor or robot..."), {},
                           [this] { reteach(); }));
    file->addSeparator();
    file->addAction(action("demo", "home", tr("Open the demo project"), {}, [this] {
        if (may_leave()) studio_.open_demo(false);
    }));
    file->addAction(action("fresh_demo", "home", tr("Start the demo project anew"), {}, [this] {
        if (may_leave() &&
            QMessageBox::question(this, tr("Demo project"),
                                  tr("Replace your demo project and its runs by a fresh one?"),
                                  QMessageBox::Yes | QMessageBox::No, QMessageBox::No) == QMessageBox::Yes)
            studio_.open_demo(true);
    }));
    file->addSeparator();
    sign_in_ = action("sign_in", "", tr("Sign in..."), QKeySequence("Ctrl+I"), [this] { ask_who(); });
    sign_out_ =
        action("sign_out", "", tr("Sign out"), QKeySequence("Ctrl+Shift+I"), [this] { desk_.sign_out(); });
    file->addAction(sign_in_);
    file->addAction(sign_out_);
    file->addAction(
        action("sign_out_after", "", tr("Sign out by itself..."), {}, [this] { set_sign_out(); }));
    file->addSeparator();
    file->addAction(action("quit", "", tr("&Quit"), QKeySequence::Quit, [this] { close(); }));
    in_bar_ << save_action;
}

void MainWindow::make_edit_menu() {
    auto* edit = menuBar()->addMenu(tr("&Edit"));
    QUndoStack& stack = desk_.undo_stack();
    QAction* undo = stack.createUndoAction(this, tr("Undo"));
    undo->setShortcut(QKeySequence::Undo);
    undo->setIcon(icon("undo", palette()));
    undo->setObjectName("undo");
    QAction* redo = stack.createRedoAction(this, tr("Redo"));
    redo->setShortcut(QKeySequence("Ctrl+Y"));
    redo->setIcon(icon("redo", palette()));
    redo->setObjectName("redo");
    for (QAction* a : {undo, redo}) {
        addAction(a);
        edit->addAction(a);
    }
    edit->addSeparator();
    QAction* palette_action =
        action("palette", "search", tr("All actions..."), QKeySequence("Ctrl+K"), [this] {
            auto* dialog = new CommandPalette(all_actions(), this);
            dialog->setAttribute(Qt::WA_DeleteOnClose);
            dialog->open();
        });
    edit->addAction(palette_action);
    in_bar_ << undo << redo << palette_action;
}

void MainWindow::make_steps_menu() {
    auto* steps = menuBar()->addMenu(tr("&Steps"));
    for (const Step step : kSteps)
        steps->addAction(action(QStringLiteral("step_%1").arg(static_cast<int>(step) + 1), step_icon(step),
                                tr("Step %1: %2").arg(static_cast<int>(step) + 1).arg(step_name(step)),
                                QKeySequence(QStringLiteral("Ctrl+%1").arg(static_cast<int>(step) + 1)),
                                [this, step] { show_step(step); }));
    steps->addAction(
        action("next", "next", tr("Go to the next step"), QKeySequence("Ctrl+Return"), [this] { go_on(); }));
}

void MainWindow::make_measure_menu() {
    auto* run = menuBar()->addMenu(tr("&Measure"));
    run->addAction(action("connect_all", "plug", tr("Connect devices"), QKeySequence("F4"), [this] {
        if (take_typed()) desk_.worker().connect_devices();
    }));
    run->addAction(action("disconnect_all", "unplug", tr("Disconnect devices"), QKeySequence("Shift+F4"),
                          [this] { desk_.worker().disconnect_devices(); }));
    run->addAction(action("measure_now", "measure", tr("Measure"), QKeySequence("F5"), [this] {
        show_step(Step::run);
        run_page_->measure(false);
    }));
    run->addAction(
        action("measure_and_push", "push", tr("Measure, then push..."), QKeySequence("F6"), [this] {
            show_step(Step::run);
            run_page_->measure(true);
        }));
    run->addAction(action("gap_check", "measure", tr("Gap along a path..."), {}, [this] {
        show_dialog("gap_dialog", [this] { return new GapDialog(desk_, this); });
    }));
    run->addAction(action("panel_fit_dialog", "part", tr("Fit a panel..."), {}, [this] {
        show_dialog("panel_dialog", [this] { return new PanelDialog(desk_, this); });
    }));
    run->addAction(action("record_session", "save", tr("Record what the devices deliver..."), {}, [this] {
        show_dialog("record_dialog", [this] { return new RecordDialog(desk_, this); });
    }));
    run->addAction(action("jog", "robot", tr("Move the robot by hand"), QKeySequence("F8"),
                          [this] { views_.raise(views_.jog); }));
    run->addAction(action("cancel_work", "stop", tr("Cancel the measuring"), QKeySequence("Ctrl+."),
                          [this] { desk_.worker().cancel(); }));
}

void MainWindow::make_view_menu() {
    auto* view = menuBar()->addMenu(tr("&View"));
    int key = 1;
    for (QDockWidget* dock : docks_)
        view->addAction(action("show_" + dock->objectName(), "", tr("Show %1").arg(dock->windowTitle()),
                               QKeySequence(QStringLiteral("Alt+%1").arg(key++)), [dock] {
                                   dock->show();
                                   dock->raise();
                                   dock->widget()->setFocus();
                               }));
    view->addAction(action("full", "window", tr("One view alone, and back"), QKeySequence("F11"), [this] {
        QDockWidget* focused = docks_.front();
        for (QDockWidget* dock : docks_)
            if (dock->isAncestorOf(focusWidget())) focused = dock;
        toggle_full(full_ ? full_ : focused);
    }));
    view->addAction(action("freeze", "stop", tr("Freeze the live profile, and go on"),
                           QKeySequence("Ctrl+Space"),
                           [this] { views_.profile->set_frozen(!views_.profile->frozen()); }));
    view->addAction(action("reset_layout", "home", tr("Docks as at first"), {}, [this] {
        if (full_) toggle_full(full_);
        restoreState(default_layout_, kLayoutVersion);
    }));
    view->addSeparator();
    // The window is built anew, and with it would go what a running job asks.
    const auto may_build = [this] {
        const bool busy = desk_.worker().busy();
        if (busy) {
            tell(tr("A job is running: end it first, the window is built anew for this."));
            trouble_->setProperty("until_idle", true);
        }
        return !busy && take_typed();
    };
    QAction* language =
        action("language", "language", tr("Deutsch"), QKeySequence("Ctrl+L"), [this, may_build] {
            if (!may_build()) return;
            // After this signal has returned.
            QMetaObject::invokeMethod(
                &studio_, [&s = studio_] { s.set_language(s.language() == "de" ? "en" : "de"); },
                Qt::QueuedConnection);
        });
    QAction* theme =
        action("theme", "theme", studio_.dark() ? tr("Light theme") : tr("Dark theme"),
               QKeySequence("Ctrl+T"), [this, may_build] {
                   if (!may_build()) return;
                   QMetaObject::invokeMethod(
                       &studio_, [&s = studio_] { s.set_dark(!s.dark()); }, Qt::QueuedConnection);
               });
    view->addAction(language);
    view->addAction(theme);
    in_bar_ << language << theme;
}

void MainWindow::make_help_menu() {
    auto* help = menuBar()->addMenu(tr("&Help"));
    help->addAction(action("manual", "", tr("Manual of this page"), QKeySequence::HelpContents,
                           [this] { show_manual(manual_page_of(step_)); }));
    auto* pages = help->addMenu(tr("Manual"));
    for (const QString& page : manual_pages())
        pages->addAction(action("manual_" + page, "",
                                tr("Manual: %1").arg(manual_title(page, studio_.language())), {},
                                [this, page] { show_manual(page); }));
    help->addSeparator();
    help->addAction(in_bar_[3]);
    help->addAction(action("about", "", tr("About Seamwright"), {}, [this] { show_about(this); }));
}

void MainWindow::show_manual(const QString& page) {
    if (!manual_) manual_ = new ManualWindow(studio_.language(), this);
    manual_->show_page(page);
    manual_->show();
    manual_->raise();
    manual_->activateWindow();
}

void MainWindow::make_bar() {
    auto* bar = addToolBar(tr("Tools"));
    bar->setObjectName("tools");
    bar->setMovable(false);
    bar->setIconSize({20, 20});
    bar->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    menuBar()->setCornerWidget(bar, Qt::TopRightCorner);
    for (QAction* a : in_bar_) bar->addAction(a);
    in_bar_[1]->setPriority(QAction::LowPriority);
    in_bar_[2]->setPriority(QAction::LowPriority);
    for (auto* b : bar->findChildren<QToolButton*>())
        b->setAccessibleName(b->text().isEmpty() ? tr("More") : b->text());
    for (auto* b : bar->findChildren<QToolButton*>())
        if (b->toolTip().isEmpty()) b->setToolTip(tr("More"));
}

}  // namespace seamwright
