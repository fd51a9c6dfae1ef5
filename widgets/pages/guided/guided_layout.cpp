// The parts of a guided page, from top to bottom.

#include <QClipboard>
#include <QGuiApplication>
#include <QHeaderView>
#include <QShortcut>

#include "widgets/pages/guided/guided_page.h"
#include "widgets/pages/parts/form.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

constexpr int kTableHeight = 250, kParametersHeight = 190, kNameWidth = 130;

QWidget* holder(QVBoxLayout& box, QVBoxLayout*& inside) {
    auto* widget = new QWidget;
    inside = new QVBoxLayout(widget);
    inside->setContentsMargins(0, 0, 0, 0);
    inside->setSpacing(6);
    box.addWidget(widget);
    return widget;
}

}  // namespace

void GuidedPage::make_head() {
    head_ = new QWidget(this);
    auto* head = new QVBoxLayout(head_);
    head->setContentsMargins(0, 0, 0, 0);
    head->setSpacing(6);
    undo_ = make_button("calibration_undo", "undo", {}, tr("Undo the last change of this calibration"),
                        [this] { calibration_.undo_stack().undo(); });
    redo_ =
        make_button("calibration_redo", "redo", {}, tr("Redo"), [this] { calibration_.undo_stack().redo(); });
    connect(&calibration_.undo_stack(), &QUndoStack::canUndoChanged, undo_, &QWidget::setEnabled);
    connect(&calibration_.undo_stack(), &QUndoStack::canRedoChanged, redo_, &QWidget::setEnabled);
    undo_->setEnabled(false);
    redo_->setEnabled(false);
    auto* back = make_button("calibration_back", "up", tr("All methods"),
                             tr("Back to the list; everything captured is kept"), [this] { leave(); });
    needs_ = make_button("calibration_needs", "search", tr("What I need"),
                         tr("Shows or hides what this method is for and what it needs"), [this] {
                             needs_shown_ = !prepare_->isVisible();
                             prepare_->setVisible(needs_shown_);
                         });
    head->addLayout(make_row({back, needs_, undo_, redo_}));
    title_ = make_heading({});
    title_->setObjectName("guided_title");
    head->addWidget(title_);
    stage_ = make_text({});
    stage_->setObjectName("calibration_stage");
    stage_->setTextFormat(Qt::RichText);
    head->addWidget(stage_);
    said_ = make_text({});
    said_->setObjectName("calibration_said");
    said_->hide();
    head->addWidget(said_);
    progress_ = new QProgressBar;
    progress_->setObjectName("calibration_progress");
    progress_->setAccessibleName(tr("Progress"));
    progress_->setToolTip(tr("How far reading and solving are"));
    progress_->setMinimumHeight(style::kTargetPx);
    cancel_ = make_button("calibration_cancel", "stop", tr("Cancel"),
                          tr("Stops what runs; captures are kept. A motion under way is done, none follows."),
                          [this] {
                              series_.stop();
                              calibration_.cancel();
                          });
    lead_ = make_button("calibration_lead", "next", {}, {}, [this] { lead(); });
    lead_->setProperty("next", true);
    auto* row = new QHBoxLayout;
    row->addWidget(lead_);
    row->addWidget(progress_, 1);
    row->addWidget(cancel_);
    head->addLayout(row);
    head_->hide();
}

void GuidedPage::make_prepare(QVBoxLayout& box) {
    QVBoxLayout* inside = nullptr;
    who_ = make_text({});
    who_->setObjectName("calibration_who");
    box.addWidget(who_);
    prepare_ = holder(box, inside);
    auto* row = new QHBoxLayout;
    drawing_ = new MethodDrawing;
    row->addWidget(drawing_, 0, Qt::AlignTop);
    auto* words = new QVBoxLayout;
    why_ = make_text({});
    need_ = make_text({});
    words->addWidget(why_);
    words->addWidget(need_);
    words->addStretch(1);
    row->addLayout(words, 1);
    inside->addLayout(row);
    QVBoxLayout* mounting = nullptr;
    nominal_holder_ = holder(*inside, mounting);
    mounting->addWidget(make_heading(tr("Mounting from the drawing (flange_from_sensor)")));
    nominal_ = new PoseEditor;
    nominal_->setObjectName("calibration_nominal");
    nominal_->setToolTip(tr("Roughly is enough: it leads to the next poses and tells mirrored axes"));
    connect(nominal_, &PoseEditor::committed, this,
            [this] { done(calibration_.set_nominal_mounting(nominal_->pose())); });
    mounting->addWidget(nominal_);
    settings_holder_ = holder(box, settings_box_);
    base_ = make_text({});
    box.addWidget(base_);
}

void GuidedPage::make_capture(QVBoxLayout& box) {
    QVBoxLayout* inside = nullptr;
    capture_box_ = holder(box, inside);
    inside->addWidget(make_heading(tr("Capture")));
    target_ = new TargetView;
    inside->addWidget(target_);
    capture_ = make_button("calibration_capture", "target", tr("Capture"),
                           tr("Takes picture and robot pose; the robot must stand still"), [this] {
                               if (take_typed()) calibration_.capture(false);
                           });
    automatic_ =
        make_button("calibration_automatic", "play", tr("By itself"),
                    tr("Captures whenever the robot has stood still for half a second at a new place"),
                    [this] { calibration_.set_automatic(automatic_->isChecked()); });
    automatic_->setCheckable(true);
    capture_all_ = make_button(
        "calibration_all", "play", tr("Capture all"),
        tr("Sends the robot straight to one proposed pose after the other and captures there: look "
           "whether the ways are free"),
        [this] {
            if (!take_typed()) return;
            calibration_.set_automatic(false);
            series_.start();
        });
    connect_ = make_button("calibration_connect", "plug", tr("Connect"),
                           tr("Open all sensors and robots of the project"), [this] {
                               said_->hide();
                               emit connect_wanted();
                           });
    inside->addLayout(make_row({connect_, capture_all_, capture_}));
    set_target_ =
        make_button("calibration_set_target", "target", tr("Set up the target"),
                    tr("Puts this method's target before the simulated sensor"), [this] { set_target(); });
    go_there_ = make_button("calibration_go", "robot", tr("Go there"),
                            tr("Moves the robot straight to the next pose: look whether the way is free"),
                            [this] { go_there(); });
    next_ = make_text({});
    next_->setObjectName("calibration_next");
    next_words_ = make_text({});
    copy_next_ =
        make_button("calibration_copy_next", "copy", tr("Copy"), tr("Puts the next pose into the clipboard"),
                    [this] { QGuiApplication::clipboard()->setText(next_->property("pose").toString()); });
    inside->addWidget(next_);
    inside->addWidget(next_words_);
    inside->addLayout(make_row({copy_next_, set_target_, go_there_, automatic_}));
    load_ = make_button("calibration_load", "import", tr("Load from files"),
                        tr("Takes captures from files instead of the live sensor"), [this] { load(false); });
    load_folder_ = make_button("calibration_load_folder", "open", tr("Load images"),
                               tr("Takes captures from a folder of images with their pose files"),
                               [this] { load(true); });
    box.addLayout(make_row({load_, load_folder_}));
}

void GuidedPage::make_list(QVBoxLayout& box) {
    count_ = make_heading({});
    count_->setObjectName("calibration_count");
    box.addWidget(count_);
    table_ =
        make_table("captures", {tr("Pose"), tr("mm"), tr("deg"), tr("px"), tr("State")},
                   tr("Captures with their residual; take the tick away to leave one out and solve again"));
    table_->setIconSize(QSize(64, 44));
    table_->verticalHeader()->setDefaultSectionSize(48);
    table_->setFixedHeight(kTableHeight);
    table_->horizontalHeader()->setStretchLastSection(true);
    table_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Interactive);
    table_->setColumnWidth(0, kNameWidth);
    connect(table_, &QTableWidget::itemChanged, this, &GuidedPage::ticked);
    connect(table_, &QTableWidget::currentCellChanged, this, [this](int row, int, int before, int) {
        if (row == before || !calibration_.is_open()) return;
        refresh_coverage();
        refresh_busy();
    });
    box.addWidget(table_);
    verification_ =
        make_button("calibration_mark", "prove", tr("Keep for verification"),
                    tr("The chosen pose judges the solution instead of taking part in it"), [this] {
                        for (const SessionCapture& c : calibration_.session().state().captures)
                            if (c.taken->id == selected()) {
                                done(calibration_.set_verification(c.taken->id, !c.verification));
                                return;
                            }
                    });
    remove_ =
        make_button("calibration_remove", "remove", tr("Remove"), tr("Takes the chosen pose off the list"),
                    [this] { done(calibration_.remove(selected())); });
    box.addLayout(make_row({verification_, remove_}));
    auto* erase = new QShortcut(QKeySequence::Delete, table_);
    erase->setContext(Qt::WidgetShortcut);
    connect(erase, &QShortcut::activated, remove_, &QPushButton::click);
    coverage_ = new CoverageView;
    box.addWidget(coverage_);
}

void GuidedPage::make_verdict(QVBoxLayout& box) {
    QVBoxLayout* inside = nullptr;
    solve_box_ = holder(box, inside);
    inside->addWidget(make_heading(tr("Solution")));
    verdict_ = make_text({});
    verdict_->setObjectName("calibration_verdict");
    reason_ = make_text({});
    reason_->setObjectName("calibration_reason");
    inside->addWidget(verdict_);
    inside->addWidget(reason_);
    QVBoxLayout* robot = nullptr;
    robot_holder_ = holder(*inside, robot);
    robot->addWidget(
        make_text(tr("The robot's repeatability, one standard deviation of an arrival in each "
                     "axis: about a third of the RP of its data sheet. 0: not stated.")));
    const auto editor = [&](const char* name, const QString& label, const char* unit, double most,
                            int decimals) {
        ParameterInfo info;
        info.name = name;
        info.unit = unit;
        info.maximum = most;
        info.decimals = decimals;
        auto* e = new ParameterEditor(info);
        e->setObjectName(QString("calibration_") + name);
        e->set_name(label);
        connect(e, &ParameterEditor::committed, this, &GuidedPage::state_repeatability);
        robot->addWidget(e);
        return e;
    };
    robot_mm_ = editor("robot_mm", tr("Repeatability of its place"), "mm", 10, 3);
    robot_deg_ = editor("robot_deg", tr("Repeatability of its turn"), "deg", 5, 4);
    solve_ =
        make_button("calibration_solve", "measure", tr("Solve"), tr("Solves with the ticked poses"), [this] {
            if (take_typed()) calibration_.solve();
        });
    detect_ = make_button(
        "detect_convention", "search", tr("Which convention?"),
        tr("Tries the poses in every convention of angles, units, order and direction; changes nothing"),
        [this] {
            said_->hide();
            calibration_.detect_convention();
        });
    take_convention_ =
        make_button("take_convention", "check", tr("Read them so"),
                    tr("Reads all poses of this session in the convention found; undo takes it back"),
                    [this] { done(calibration_.take_convention()); });
    inside->addLayout(make_row({solve_, detect_}));
    convention_ = make_text({});
    convention_->setObjectName("calibration_convention");
    inside->addWidget(convention_);
    inside->addLayout(make_row({take_convention_}));
    parameters_ = make_table("calibration_parameters", {tr("Parameter"), tr("Value"), tr("1 sigma")},
                             tr("What was found, and how sure it is"));
    parameters_->setFixedHeight(kParametersHeight);
    parameters_->verticalHeader()->setDefaultSectionSize(26);
    inside->addWidget(parameters_);
}

void GuidedPage::make_use(QVBoxLayout& box) {
    QVBoxLayout* inside = nullptr;
    verify_box_ = holder(box, inside);
    inside->addWidget(make_heading(tr("Verification")));
    verified_ = make_text({});
    verified_->setObjectName("calibration_verified");
    inside->addWidget(verified_);
    verify_ = make_button("calibration_verify", "prove", tr("Capture for verification"),
                          tr("A pose that takes no part in the solution judges it"), [this] {
                              if (take_typed()) calibration_.capture(true);
                          });
    inside->addLayout(make_row({verify_}));
    stands_ = make_text({});
    stands_->setObjectName("calibration_stands");
    box.addWidget(stands_);
    compared_ = make_text({});
    compared_->setObjectName("calibration_compared");
    used_ = make_text({});
    used_->setObjectName("calibration_used");
    box.addWidget(compared_);
    box.addWidget(used_);
    use_ = make_button("calibration_use", "check", tr("Use this calibration"),
                       tr("Measure with it from now on; the one before stays selectable"), [this] {
                           if (take_typed()) done(calibration_.finish(true));
                       });
    keep_ = make_button("calibration_keep", "save", tr("Keep beside"),
                        tr("Puts it into the project without using it"), [this] {
                            if (take_typed()) done(calibration_.finish(false));
                        });
    anew_ = make_button("calibration_anew", "new", tr("Begin anew"),
                        tr("Puts these captures aside, on disk, and begins with none; undo brings them back"),
                        [this] { done(calibration_.begin_anew()); });
    box.addLayout(make_row({use_, keep_}));
    box.addLayout(make_row({anew_}));
}

}  // namespace seamwright
