#include "app/studio/main_window.h"

#include <QAction>
#include <QFileInfo>
#include <QFrame>
#include <QHBoxLayout>
#include <QMenuBar>
#include <QScreen>
#include <QScrollArea>
#include <QSettings>
#include <QStatusBar>
#include <QTimer>
#include <QToolBar>
#include <QToolButton>
#include <algorithm>
#include <cmath>

#include "app/studio/event_list.h"
#include "app/studio/page_area.h"
#include "app/studio/studio.h"
#include "widgets/jog/jog_panel.h"
#include "widgets/pages/accept/accept_page.h"
#include "widgets/pages/align_page.h"
#include "widgets/pages/calibrate_page.h"
#include "widgets/pages/cell_page.h"
#include "widgets/pages/prove_page.h"
#include "widgets/pages/regions_page.h"
#include "widgets/pages/run_page.h"
#include "widgets/pages/teach_page.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr int kPageWidth = 440, kPageRoom_px = 120, kPageEdge_px = 12;
constexpr QSize kFirstSize(1440, 900), kSmallestSize(1180, 660);  // logical pixels
constexpr QSize kFrame_px(8, 40);   // of the window manager's, which the screen must hold too
constexpr int kWideRail_px = 1200;  // of the window, in which the steps have their names
constexpr int kRoomy_px = 1280;     // in which the page may be wider than it must
// What the live profile keeps of the window's height, whatever stands below it.
constexpr double kProfileShare = 0.35;
constexpr int kLowerView_px = 160;      // of a view below it, at least
constexpr int kReadablePlot_px = 300;   // in which an axis' label has room
constexpr int kHistogramWords_px = 60;  // of a histogram of three series: a line each
constexpr int kLayoutVersion = 2;
constexpr int kDevices_ms = 250;

// A dock's head: name, full, float. A double click makes the dock full.
class DockTitle : public QWidget {
  public:
    DockTitle(QDockWidget* dock, const std::function<void()>& full, const QString& full_tip,
              const QString& float_tip)
        : QWidget(dock), full_(full) {
        auto* row = new QHBoxLayout(this);
        row->setContentsMargins(8, 0, 2, 0);
        row->setSpacing(2);
        auto* name = new QLabel(dock->windowTitle());
        QFont font = name->font();
        font.setBold(true);
        name->setFont(font);
        row->addWidget(name, 1);
        auto* whole = make_button("dock_full", "window", {}, full_tip, full);
        auto* loose = make_button("dock_float", "export", {}, float_tip,
                                  [dock] { dock->setFloating(!dock->isFloating()); });
        for (QPushButton* b : {whole, loose}) {
            b->setFlat(true);
            b->setFixedSize(style::kTargetPx, style::kTargetPx);
            b->setStyleSheet("padding: 0");
            row->addWidget(b);
        }
    }

  protected:
    void mouseDoubleClickEvent(QMouseEvent*) override { full_(); }

  private:
    std::function<void()> full_;
};

// Docks behind others in a tab group lie outside of the window, visible to Qt.
bool stands_within(const QMainWindow& window, const QDockWidget& dock) {
    return dock.window() == &window && dock.isVisible() &&
           window.rect().intersects(QRect(dock.mapTo(&window, QPoint()), dock.size()));
}

// What does not fit below the live profile of a small window is scrolled to.
QScrollArea* scrolled(QWidget* view) {
    auto* area = new QScrollArea;
    area->setWidget(view);
    area->setWidgetResizable(true);
    area->setFrameShape(QFrame::NoFrame);
    area->setFocusPolicy(Qt::NoFocus);
    area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    area->setMinimumHeight(kLowerView_px);
    return area;
}

}  // namespace

MainWindow::MainWindow(Studio& studio) : studio_(studio), desk_(studio.desk()) {
    setObjectName("main_window");
    setAcceptDrops(true);
    setDockOptions(AllowNestedDocks | AllowTabbedDocks | AnimatedDocks);
    setTabPosition(Qt::RightDockWidgetArea, QTabWidget::South);
    make_docks();
    make_central();
    make_actions();
    make_status();
    feeder_ = new ViewFeeder(desk_, views_, this);
    connect(run_page_, &StepPage::run_shown, this,
            [this](const std::shared_ptr<const RunRecord>& run) { feeder_->show_run(run.get()); });

    connect(&desk_, &Desk::modified_changed, this, &MainWindow::refresh_title);
    connect(&desk_, &Desk::opened, this, [this] {
        refresh_title();
        let_act();
        trouble_->hide();
    });
    connect(&desk_, &Desk::person_changed, this, &MainWindow::refresh_person);
    connect(&desk_, &Desk::opened, this, [this] {
        if (desk_.asks_who() && !desk_.person()) QTimer::singleShot(0, this, &MainWindow::ask_who);
    });
    idle_timer_.setSingleShot(true);
    connect(&idle_timer_, &QTimer::timeout, this, [this] {
        if (!desk_.person()) return;
        desk_.sign_out(Text("signed out: nobody worked for {} minutes", sign_out_minutes()));
        tell_done(tr("Signed out: nobody worked for %1 minutes.").arg(sign_out_minutes()));
    });
    qApp->installEventFilter(this);
    connect(&desk_, &Desk::trouble, this, &MainWindow::tell);
    connect(&desk_, &Desk::project_changed, this, [this] {
        if (trouble_->property("tone") == "alarm") trouble_->hide();  // an edit has succeeded since
    });
    connect(&desk_, &Desk::checklist_changed, this, [this] {
        refresh_next();
        if (!beginning_ || !desk_.station().connected) return;
        show_step(next_step(desk_.steps()));
    });
    connect(&desk_, &Desk::station_changed, this, &MainWindow::refresh_devices);
    connect(&devices_timer_, &QTimer::timeout, this, &MainWindow::refresh_devices);
    devices_timer_.start(kDevices_ms);
    connect(&desk_, &Desk::runs_changed, this, &MainWindow::refresh_status);
    connect(&desk_, &Desk::events_changed, this, &MainWindow::refresh_status);
    connect(&desk_, &Desk::recovery_written, this, [this] {
        saved_->setText(desk_.modified() ? tr("autosaved %1").arg(QTime::currentTime().toString("HH:mm:ss"))
                                         : QString());
    });
    connect(&desk_, &Desk::modified_changed, this, [this](bool modified) {
        if (!modified) saved_->setText(tr("saved"));
    });
    connect(&desk_.worker(), &StationWorker::busy_changed, this, [this](bool busy) {
        if (!busy && trouble_->property("until_idle").toBool()) trouble_->hide();
    });
    // A push that waits for its answer is shown wherever one is.
    connect(&desk_.worker(), &StationWorker::confirm_push, this, [this] { show_step(Step::run); });

    const QSize free = screen()->availableSize();
    setMinimumSize(kSmallestSize.boundedTo(free));
    resize(kFirstSize.boundedTo(free - kFrame_px));
    resizeDocks({docks_[0], docks_[2]}, {430, 430}, Qt::Vertical);
    default_layout_ = saveState(kLayoutVersion);
    QSettings& s = studio_.settings();
    if (s.contains("geometry")) restoreGeometry(s.value("geometry").toByteArray());
    if (s.contains("layout")) restoreState(s.value("layout").toByteArray(), kLayoutVersion);
    refresh_title();
    let_act();
    refresh_next();
    refresh_status();
    refresh_person();
}

// Pages that are hidden say so: while the window is still whole.
MainWindow::~MainWindow() {
    hide();
}

QDockWidget* MainWindow::add_dock(const QString& name, const QString& title, QWidget* view) {
    auto* dock = new QDockWidget(title, this);
    dock->setObjectName(name);
    dock->setWidget(view);
    dock->setTitleBarWidget(new DockTitle(
        dock, [this, dock] { toggle_full(dock); }, tr("This view alone, and back (F11)"),
        tr("In a window of its own, and back")));
    connect(dock, &QDockWidget::visibilityChanged, this, [this](bool shown) {
        if (shown && feeder_) QTimer::singleShot(0, feeder_, &ViewFeeder::show_latest);
    });
    docks_ << dock;
    return dock;
}

void MainWindow::make_docks() {
    views_.profile = new ProfilePlot;
    views_.camera = new CameraView;
    views_.scene = new SceneView;
    views_.align = new AlignView;
    views_.residuals = new ResidualBars;
    views_.trend = new TrendChart;
    views_.histogram = new Histogram;
    auto* charts = new QWidget;
    auto* chart_box = new QVBoxLayout(charts);
    chart_box->setContentsMargins(0, 0, 0, 0);
    charts->setFocusProxy(views_.trend);
    charts->setMinimumHeight(kReadablePlot_px + kHistogramWords_px);
    views_.residuals->setMinimumHeight(kReadablePlot_px);
    chart_box->addWidget(views_.trend, 3);
    chart_box->addWidget(views_.histogram, 2);

    QDockWidget* profile = add_dock("dock_profile", tr("Live profile"), views_.profile);
    QDockWidget* camera = add_dock("dock_camera", tr("Camera image"), views_.camera);
    QDockWidget* scene = add_dock("dock_scene", tr("Part in 3D"), views_.scene);
    QDockWidget* align = add_dock("dock_align", tr("Frozen contour"), views_.align);
    QDockWidget* residuals = add_dock("dock_residuals", tr("Residuals"), scrolled(views_.residuals));
    QDockWidget* trend = add_dock("dock_charts", tr("Charts"), scrolled(charts));
    QDockWidget* events = add_dock("dock_events", tr("Events"), new EventList(desk_));
    views_.jog = new JogPanel(desk_);
    QDockWidget* jog = add_dock("dock_jog", tr("Jog"), scrolled(views_.jog));
    connect(&desk_, &Desk::attendance_wanted, this, [this] { views_.raise(views_.jog); });
    addDockWidget(Qt::RightDockWidgetArea, profile);
    tabifyDockWidget(profile, camera);
    addDockWidget(Qt::RightDockWidgetArea, scene);
    for (QDockWidget* d : {align, residuals, trend, events, jog}) tabifyDockWidget(scene, d);
    jog->hide();  // until it is asked for
    profile->raise();
    scene->raise();
    views_.raise = [this](QWidget* view) {
        for (QDockWidget* d : docks_)
            if (d->widget() == view || d->isAncestorOf(view)) {
                d->show();
                d->raise();
            }
    };
}

void MainWindow::make_central() {
    auto* central = new QWidget;
    auto* columns = new QHBoxLayout;
    columns->setContentsMargins(0, 0, 0, 0);
    columns->setSpacing(0);
    rail_ = new StepRail(desk_);
    columns->addWidget(rail_);
    pages_ = new QStackedWidget;
    pages_->setObjectName("pages");
    pages_->setMinimumWidth(kPageWidth);
    run_page_ = new RunPage(desk_, views_);
    auto* prove = new ProvePage(desk_, views_);
    connect(prove, &ProvePage::report_wanted, this, &MainWindow::make_report);
    auto* accept = new AcceptPage(desk_, views_);
    connect(accept, &AcceptPage::told, this, &MainWindow::tell_done);
    auto* calibrate = new CalibratePage(desk_, views_);
    connect(calibrate, &CalibratePage::under_way, this, [this](const QString& words) {
        calibrating_ = words;
        refresh_next();
    });
    connect(calibrate, &CalibratePage::connect_wanted, this, [this] {
        if (take_typed()) desk_.worker().connect_devices();
    });
    const std::initializer_list<StepPage*> pages{new CellPage(desk_, views_),
                                                 calibrate,
                                                 new TeachPage(desk_, views_),
                                                 new AlignPage(desk_, views_),
                                                 new RegionsPage(desk_, views_),
                                                 prove,
                                                 accept,
                                                 run_page_};
    for (StepPage* page : pages) {
        step_pages_ << page;
        connect(page, &StepPage::step_wanted, this, &MainWindow::lead_to);
        auto* scroll = new PageArea(page);
        page_areas_ << scroll;
        if (!page->head()) {
            pages_->addWidget(scroll);
            continue;
        }
        auto* with_head = new QWidget;
        auto* box = new QVBoxLayout(with_head);
        box->setContentsMargins(0, 0, 0, 0);
        box->setSpacing(0);
        box->addWidget(page->head());
        box->addWidget(scroll, 1);
        pages_->addWidget(with_head);
    }
    columns->addWidget(pages_, 1);
    connect(rail_, &StepRail::step_chosen, this, &MainWindow::show_step);

    // Over the page's lower end: nothing moves from under the pointer when it comes or goes, and what it covers can be scrolled
    // above it.
    trouble_ = new QFrame(central);
    trouble_->setObjectName("trouble");
    auto* trouble_row = new QHBoxLayout(trouble_);
    trouble_row->setContentsMargins(10, 4, 4, 4);
    trouble_text_ = make_text({});
    trouble_text_->setObjectName("trouble_text");
    trouble_row->addWidget(trouble_text_, 1);
    trouble_row->addWidget(make_button("dismiss", "check", tr("Understood"),
                                       tr("Puts the message away; the event log keeps it"),
                                       [this] { trouble_->hide(); }));
    trouble_->hide();
    next_ = make_button("next_step", "next", {}, tr("Go to the next step"), [this] { go_on(); });
    connect(run_page_, &RunPage::asks_changed, this, &MainWindow::refresh_next);
    auto* box = new QVBoxLayout(central);
    box->setContentsMargins(4, 0, 0, 4);
    box->addLayout(columns, 1);
    box->addWidget(next_);
    setCentralWidget(central);
}

void MainWindow::show_step(Step step) {
    if (step != step_ && !beginning_) trouble_->hide();  // it was about the step that is left
    beginning_ = false;                                  // whoever has chosen a step stays there
    step_ = step;
    pages_->setCurrentIndex(static_cast<int>(step));
    rail_->show_step(step);
    refresh_next();
}

void MainWindow::go_on() {
    if (!desk_.is_open()) return open_project();
    lead_to(run_page_->asks() ? Step::run : next_step(desk_.steps()));
}

void MainWindow::lead_to(Step step) {
    if (step != step_) return show_step(step);
    step_pages_[static_cast<int>(step)]->point_out();
}

bool MainWindow::push_waits() const {
    return run_page_->asks() && step_ != Step::run;
}

void MainWindow::begin_at_next() {
    beginning_ = true;
    show_step(next_step(desk_.steps()));
    beginning_ = true;
}

void MainWindow::toggle_full(QDockWidget* dock) {
    if (full_) {
        full_ = nullptr;
        centralWidget()->show();
        restoreState(before_full_, kLayoutVersion);
        return;
    }
    before_full_ = saveState(kLayoutVersion);
    full_ = dock;
    for (QDockWidget* d : docks_)
        if (d != dock) d->hide();
    centralWidget()->hide();
    dock->show();
}

QList<QAction*> MainWindow::all_actions() const {
    QList<QAction*> list;
    for (QAction* a : actions())
        if (!a->text().isEmpty() && !a->isSeparator()) list << a;
    return list;
}

void MainWindow::remember() {
    if (full_) toggle_full(full_);
    studio_.settings().setValue("geometry", saveGeometry());
    studio_.settings().setValue("layout", saveState(kLayoutVersion));
}

void MainWindow::refresh_title() {
    const QString file = QFileInfo(QString::fromStdString(desk_.path().string())).fileName();
    setWindowTitle(tr("%1[*] - Seamwright").arg(file.isEmpty() ? tr("no project") : file));
    setWindowModified(desk_.modified());
}

void MainWindow::resizeEvent(QResizeEvent* event) {
    QMainWindow::resizeEvent(event);
    const bool narrow = width() < kWideRail_px;
    rail_->set_narrow(narrow);
    centralWidget()->setMaximumWidth(rail_->width() + kPageWidth +
                                     (width() < kRoomy_px ? kPageEdge_px : kPageRoom_px));
    views_.profile->setMinimumHeight(static_cast<int>(kProfileShare * height()));
    // The new height was shared out while the profile still asked for its part of the old one.
    QTimer::singleShot(0, this, [this] {
        const auto crushed = [this](const QDockWidget* d) {
            return stands_within(*this, *d) && d->height() < d->minimumSizeHint().height();
        };
        if (std::any_of(docks_.begin(), docks_.end(), crushed))
            resizeDocks({docks_[0], docks_[2]}, {views_.profile->minimumHeight(), height()}, Qt::Vertical);
    });
    QTimer::singleShot(0, this, &MainWindow::refresh_next);  // when its button has the new width
}

// The focus passes by what stands behind other docks.
bool MainWindow::focusNextPrevChild(bool next) {
    const auto unseen = [this](const QWidget* w) {
        return w && w->window() == this &&
               std::any_of(docks_.begin(), docks_.end(), [&](const QDockWidget* d) {
                   return d->isAncestorOf(w) && !stands_within(*this, *d);
               });
    };
    const QWidget* first = nullptr;
    while (QMainWindow::focusNextPrevChild(next)) {
        const QWidget* now = focusWidget();
        if (!unseen(now)) return true;
        if (now == first) break;  // nothing else takes it
        if (!first) first = now;
    }
    return false;
}

void MainWindow::show_dialog(const QString& name, const std::function<QDialog*()>& make) {
    auto* dialog = findChild<QDialog*>(name);
    if (!dialog) {
        dialog = make();
        dialog->setAttribute(Qt::WA_DeleteOnClose);
    }
    dialog->show();
    dialog->raise();
    dialog->activateWindow();
}

}  // namespace seamwright
