#include "app/studio/main_window.h"

#include <QAction>
#include <QCloseEvent>
#include <QDateTime>
#include <QFileDialog>
#include <QFileInfo>
#include <QFrame>
#include <QHBoxLayout>
#include <QInputDialog>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QPointer>
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
#include "app/studio/reuse_dialogs.h"
#include "app/studio/sign_in_dialog.h"
#include "app/studio/studio.h"
#include "devices/exchange/json_fields.h"
#include "projects/hand_over/hand_over.h"
#include "projects/reuse/exchange.h"
#include "widgets/jog/jog_panel.h"
#include "widgets/pages/accept/accept_page.h"
#include "widgets/pages/align_page.h"
#include "widgets/pages/calibrate_page.h"
#include "widgets/pages/cell_page.h"
#include "widgets/pages/prove_page.h"
#include "widgets/pages/regions_page.h"
#include "widgets/pages/run_page.h"
#include "widgets/pages/teach_page.h"
#include "widgets/print/pdf.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

constexpr int kPageWidth = 440, kPageRoom_px = 120, kPageEdge_px = 12;
constexpr QSize kFirstSize(1440, 900), kSmallestSize(1180, 660);  // logical pixels
constexpr int kWideRail_px = 1280;  // of the window, in which the steps have words
// What the live profile keeps of the window's height, whatever stands below it.
constexpr double kProfileShare = 0.35;
constexpr int kLowerView_px = 160;     // of a view below it, at least
constexpr int kReadablePlot_px = 300;  // in which an axis' label has room
constexpr int kLayoutVersion = 2;
constexpr int kDevices_ms = 250;
constexpr std::chrono::milliseconds kRobotStale{3000};
constexpr int kNextMargin_px = 64;  // icon and padding of the next-step button

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
    // A push that waits for its answer is shown wherever one is.
    connect(&desk_.worker(), &StationWorker::confirm_push, this, [this] { show_step(Step::run); });

    const QSize free = screen()->availableSize();
    setMinimumSize(kSmallestSize.boundedTo(free));
    resize(kFirstSize.boundedTo(free));
    resizeDocks({docks_[0], docks_[2]}, {430, 430}, Qt::Vertical);
    default_layout_ = saveState(kLayoutVersion);
    QSettings& s = studio_.settings();
    if (s.contains("geometry")) restoreGeometry(s.value("geometry").toByteArray());
    if (s.contains("layout")) restoreState(s.value("layout").toByteArray(), kLayoutVersion);
    refresh_title();
    refresh_next();
    refresh_status();
    refresh_person();
}

MainWindow::~MainWindow() = default;

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
    charts->setMinimumHeight(kReadablePlot_px);
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
    pages_->setMinimumWidth(kPageWidth);
    run_page_ = new RunPage(desk_, views_);
    auto* prove = new ProvePage(desk_, views_);
    connect(prove, &ProvePage::report_wanted, this, &MainWindow::make_report);
    auto* accept = new AcceptPage(desk_, views_);
    connect(accept, &AcceptPage::told, this, &MainWindow::tell_done);
    const std::initializer_list<StepPage*> pages{new CellPage(desk_, views_),
                                                 new CalibratePage(desk_, views_),
                                                 new TeachPage(desk_, views_),
                                                 new AlignPage(desk_, views_),
                                                 new RegionsPage(desk_, views_),
                                                 prove,
                                                 accept,
                                                 run_page_};
    for (StepPage* page : pages) {
        connect(page, &StepPage::step_wanted, this, &MainWindow::show_step);
        auto* scroll = new QScrollArea;
        scroll->setWidgetResizable(true);
        scroll->setFrameShape(QFrame::NoFrame);
        scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
        scroll->setFocusPolicy(Qt::NoFocus);
        scroll->setWidget(page);
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

    trouble_ = new QFrame;
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
    next_ = make_button("next_step", "next", {}, tr("Go to the next step"),
                        [this] { show_step(next_step(desk_.steps())); });
    auto* box = new QVBoxLayout(central);
    box->setContentsMargins(4, 0, 0, 4);
    box->addWidget(trouble_);
    box->addLayout(columns, 1);
    box->addWidget(next_);
    setCentralWidget(central);
}

void MainWindow::make_status() {
    const auto label = [this](const QString& name, const QString& tip) {
        auto* l = new QLabel;
        l->setObjectName(name);
        l->setToolTip(tip);
        l->setContentsMargins(8, 0, 8, 0);
        return l;
    };
    sensors_ = label("status_sensors", tr("Sensors: state, rate, dropped frames"));
    robots_ = label("status_robots", tr("Robots: mode and state"));
    push_ = label("status_push", tr("The last push"));
    events_ = label("status_events", tr("Alarms and refusals in the event log"));
    saved_ = label("status_saved", tr("Whether edits are saved"));
    person_ = label("status_person", tr("Who is signed in"));
    for (QLabel* l : {sensors_, robots_, push_, events_}) statusBar()->addWidget(l);
    statusBar()->addPermanentWidget(person_);
    statusBar()->addPermanentWidget(saved_);
    statusBar()->setSizeGripEnabled(false);
}

void MainWindow::show_step(Step step) {
    beginning_ = false;  // whoever has chosen a step stays there
    step_ = step;
    pages_->setCurrentIndex(static_cast<int>(step));
    rail_->show_step(step);
}

void MainWindow::begin_at_next() {
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
    centralWidget()->setMaximumWidth(rail_->width() + kPageWidth + (narrow ? kPageEdge_px : kPageRoom_px));
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

// Broken at blanks, so that a button shows all of it.
static QString wrapped(const QString& text, const QFontMetrics& font, int width_px) {
    QString out, line;
    for (const QString& word : text.split(' ')) {
        const QString longer = line.isEmpty() ? word : line + ' ' + word;
        if (!line.isEmpty() && font.horizontalAdvance(longer) > width_px) {
            out += line + '\n';
            line = word;
        } else {
            line = longer;
        }
    }
    return out + line;
}

void MainWindow::refresh_next() {
    for (const StepState& s : desk_.steps())
        if (s.status == StepStatus::next) {
            const QString text = tr("Next: %1 - %2").arg(step_name(s.step), s.why);
            next_->setText(wrapped(text, next_->fontMetrics(), next_->width() - kNextMargin_px));
            next_->setMinimumHeight(std::max(style::kTargetPx, next_->sizeHint().height()));  // all its lines
            next_->setAccessibleName(text);
            next_->setToolTip(text);
        }
}

// What is not renewed is not called ok: a sensor by the age of its newest frame, a robot by the age of what it
// said last (a run asks it without telling here).
void MainWindow::refresh_devices() {
    QStringList sensors, robots;
    const auto seconds = [](auto age) {
        return static_cast<int>(std::chrono::duration_cast<std::chrono::seconds>(age).count());
    };
    for (const SensorState& s : desk_.station().sensors) {
        const QString id = QString::fromStdString(s.id);
        const auto old = desk_.live().age(s.id);
        if (old && *old > kStale)
            sensors << tr("sensor %1 no frame since %2 s").arg(id).arg(seconds(*old));
        else if (!s.trouble.empty() || !old)
            sensors << tr("sensor %1 no frame").arg(id);
        else
            sensors << tr("sensor %1 ok %2 /s, %3 dropped")
                           .arg(id)
                           .arg(std::lround(desk_.live().rate_hz(s.id)))
                           .arg(s.counters.damaged + s.counters.underrun);
    }
    const auto asked = std::chrono::steady_clock::now() - desk_.station().asked;
    const bool old = asked > kRobotStale && !desk_.worker().busy();
    for (const RobotState& r : desk_.station().robots) {
        const QString id = QString::fromStdString(r.id);
        robots << (!r.trouble.empty() ? tr("robot %1 silent").arg(id)
                   : old              ? tr("robot %1 no answer since %2 s").arg(id).arg(seconds(asked))
                                      : tr("robot %1 %2 ok").arg(id, shown_word(to_string(r.mode))));
    }
    if (!desk_.station().connected) {
        sensors = {tr("not connected")};
        robots.clear();
    }
    sensors_->setText(sensors.join("   "));
    robots_->setText(robots.join("   "));
}

void MainWindow::refresh_status() {
    refresh_devices();
    QString push;
    if (const auto runs = desk_.runs())
        for (auto it = runs->rbegin(); it != runs->rend() && push.isEmpty(); ++it)
            if (it->push && it->status == RunStatus::ok)
                push = tr("last push %1, run %2 verified")
                           .arg(QDateTime::fromString(QString::fromStdString(it->finished_utc),
                                                      Qt::ISODateWithMs)
                                    .toLocalTime()
                                    .toString("HH:mm"))
                           .arg(it->number);
    push_->setText(push.isEmpty() ? tr("nothing pushed") : push);
}

void MainWindow::tell(const QString& sentence) {
    show_message(sentence, "alarm");
}

void MainWindow::tell_done(const QString& sentence) {
    show_message(sentence, "plain");
}

void MainWindow::show_message(const QString& sentence, const char* tone) {
    trouble_text_->setText(sentence);
    trouble_->setProperty("tone", tone);
    trouble_->style()->unpolish(trouble_);
    trouble_->style()->polish(trouble_);
    trouble_->show();
}

void MainWindow::ask_who() {
    if (!desk_.asks_who())
        return tell(tr("The project has no users: nobody is asked. \"seamwright user add\" adds one."));
    if (findChild<SignInDialog*>()) return;
    auto* dialog = new SignInDialog(desk_, this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->open();
}

void MainWindow::refresh_person() {
    const auto& person = desk_.person();
    const bool asks = desk_.asks_who();
    person_->setVisible(asks);
    person_->setText(
        person ? QStringLiteral("%1, %2").arg(QString::fromStdString(person->name), role_name(person->role))
               : tr("nobody signed in"));
    sign_in_->setEnabled(asks);
    sign_out_->setEnabled(person.has_value());
    if (person && sign_out_minutes() > 0)
        idle_timer_.start(sign_out_minutes() * 60'000);
    else
        idle_timer_.stop();
}

int MainWindow::sign_out_minutes() const {
    return studio_.settings().value("sign_out_minutes", 10).toInt();
}

void MainWindow::set_sign_out() {
    bool given = false;
    const int minutes = QInputDialog::getInt(this, tr("Sign out by itself"),
                                             tr("Minutes without mouse and keyboard; 0: never"),
                                             sign_out_minutes(), 0, 24 * 60, 1, &given);
    if (!given) return;
    studio_.settings().setValue("sign_out_minutes", minutes);
    refresh_person();
}

bool MainWindow::eventFilter(QObject* object, QEvent* event) {
    switch (event->type()) {
        case QEvent::KeyPress:
        case QEvent::MouseButtonPress:
        case QEvent::MouseMove:
        case QEvent::Wheel:
            if (idle_timer_.isActive()) idle_timer_.start();
            break;
        default:
            break;
    }
    return QMainWindow::eventFilter(object, event);
}

bool MainWindow::may_leave() {
    if (!desk_.modified()) return true;
    QMessageBox box(
        QMessageBox::Question, tr("Unsaved edits"),
        tr("%1 has unsaved edits.").arg(QFileInfo(QString::fromStdString(desk_.path().string())).fileName()),
        QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, this);
    box.setObjectName("unsaved_question");
    const int answer = box.exec();
    if (answer == QMessageBox::Save) return save();
    return answer == QMessageBox::Discard;
}

bool MainWindow::save() {
    if (auto saved = desk_.save(); !saved) {
        tell(shown_error(tr("The project was not saved."), saved.error()));
        return false;
    }
    return true;
}

void MainWindow::new_project() {
    if (!may_leave()) return;
    const QString file = QFileDialog::getSaveFileName(
        this, tr("New project"), studio_.data_folder() + "/project.seam", tr("Seamwright projects (*.seam)"));
    if (!file.isEmpty()) studio_.create(file.endsWith(".seam") ? file : file + ".seam");
}

void MainWindow::open_project() {
    if (!may_leave()) return;
    const QString file =
        QFileDialog::getOpenFileName(this, tr("Open project"), {}, tr("Seamwright projects (*.seam)"));
    if (!file.isEmpty()) studio_.open(file);
}

void MainWindow::save_as() {
    const QString file =
        QFileDialog::getSaveFileName(this, tr("Save as"), QString::fromStdString(desk_.path().string()),
                                     tr("Seamwright projects (*.seam)"));
    if (file.isEmpty()) return;
    if (auto saved = desk_.save_as(file.toStdString()); !saved)
        tell(shown_error(tr("The project was not saved."), saved.error()));
}

void MainWindow::export_project() {
    const QString file =
        QFileDialog::getSaveFileName(this, tr("Export project"), "project.json", tr("JSON (*.json)"));
    if (file.isEmpty()) return;
    if (auto written = write_text_file(file.toStdString(),
                                       seamwright::export_project(desk_.project(), true).dump(2) + "\n");
        !written)
        tell(shown_error(tr("The file was not written."), written.error()));
}

void MainWindow::import_project() {
    if (!may_leave()) return;
    const QString from = QFileDialog::getOpenFileName(this, tr("Import project"), {}, tr("JSON (*.json)"));
    if (from.isEmpty()) return;
    const auto json = read_json_file(from.toStdString());
    if (!json) return tell(shown_error(tr("Nothing was imported."), json.error()));
    auto project = seamwright::import_project(*json, from.toStdString());
    if (!project) return tell(shown_error(tr("Nothing was imported."), project.error()));
    const QString file = QFileDialog::getSaveFileName(this, tr("Save the imported project as"), {},
                                                      tr("Seamwright projects (*.seam)"));
    if (file.isEmpty()) return;
    if (auto made = desk_.create(file.toStdString(), *project); !made)
        tell(shown_error(tr("The project was not made."), made.error()));
}

void MainWindow::make_report() {
    if (!desk_.is_open()) return tell(tr("No project is open."));
    const QFileInfo project(QString::fromStdString(desk_.path().string()));
    const QString file = QFileDialog::getSaveFileName(
        this, tr("Hand-over report"), project.path() + "/" + project.completeBaseName() + ".pdf",
        tr("PDF (*.pdf);;HTML (*.html)"));
    if (file.isEmpty()) return;
    HandOverOptions options;
    options.language = desk_.language();
    auto page = hand_over_report(desk_.file(), desk_.project(), desk_.facts(), options);
    if (!page) return tell(shown_error(tr("There is no report."), page.error()));
    const auto written = file.endsWith(".html", Qt::CaseInsensitive)
                             ? write_text_file(file.toStdString(), page->html())
                             : write_pdf(*page, file.toStdString());
    if (!written) return tell(shown_error(tr("The file was not written."), written.error()));
    desk_.note(EventKind::note, "report", "hand-over report written to " + file.toStdString());
    tell_done(tr("The report is in %1").arg(file));
}

void MainWindow::show_dialog(const QString& name, const std::function<QDialog*()>& make) {
    if (!desk_.is_open()) return tell(tr("No project is open."));
    auto* dialog = findChild<QDialog*>(name);
    if (!dialog) {
        dialog = make();
        dialog->setAttribute(Qt::WA_DeleteOnClose);
    }
    dialog->show();
    dialog->raise();
    dialog->activateWindow();
}

void MainWindow::mirror_project() {
    if (!desk_.is_open()) return tell(tr("No project is open."));
    if (!may_leave()) return;
    MirrorDialog dialog(this);
    if (dialog.exec() != QDialog::Accepted) return;
    auto mirrored = mirrored_project(desk_.project(), dialog.plane());
    if (!mirrored) return tell(shown_error(mirrored.error()));
    const QFileInfo project(QString::fromStdString(desk_.path().string()));
    QString file =
        QFileDialog::getSaveFileName(this, tr("Save the mirrored project as"),
                                     project.path() + "/" + project.completeBaseName() + "_mirrored.seam",
                                     tr("Seamwright projects (*.seam)"));
    if (file.isEmpty()) return;
    if (!file.endsWith(".seam")) file += ".seam";
    if (file == project.filePath()) return tell(tr("Choose another name: the original stays."));
    mirrored->name = QFileInfo(file).completeBaseName().toStdString();
    if (auto made = desk_.create(file.toStdString(), *mirrored); !made)
        return tell(shown_error(tr("The project was not made."), made.error()));
    tell_done(
        tr("This is the mirrored clone. Drive its spots slowly once, and teach their references again."));
}

void MainWindow::reteach() {
    if (!desk_.is_open()) return tell(tr("No project is open."));
    ExchangeDialog dialog(desk_.project(), this);
    if (dialog.exec() != QDialog::Accepted) return;
    const auto moved = desk_.reteach(dialog.exchange());
    if (!moved) return tell(shown_error(moved.error()));
    show_step(Step::prove);
    tell_done(tr("%1 spots were led along. Drive each slowly once, then repeat the zero shift.")
                  .arg(moved->size()));
}

void MainWindow::closeEvent(QCloseEvent* event) {
    if (!may_leave()) {
        event->ignore();
        return;
    }
    remember();
    desk_.close();
    event->accept();
    QApplication::quit();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    for (const QUrl& url : event->mimeData()->urls()) {
        const QString ending = QFileInfo(url.toLocalFile()).suffix().toLower();
        if (QStringList{"seam", "stl", "ply", "obj"}.contains(ending)) event->acceptProposedAction();
    }
}

void MainWindow::dropEvent(QDropEvent* event) {
    for (const QUrl& url : event->mimeData()->urls()) {
        const QString file = url.toLocalFile();
        if (file.endsWith(".seam", Qt::CaseInsensitive)) {
            if (may_leave()) studio_.open(file);
            return;
        }
        desk_.import_part(file.toStdString(), "", [window = QPointer(this)](const Expected<void>& imported) {
            if (window && !imported) window->tell(shown_error(tr("Nothing was imported."), imported.error()));
        });
    }
}

}  // namespace seamwright
