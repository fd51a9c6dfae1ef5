#include "widgets/pages/run_page.h"

#include <QHeaderView>
#include <QMessageBox>
#include <algorithm>
#include <utility>

#include "widgets/into_view.h"
#include "widgets/pages/parts/type_chooser.h"
#include "widgets/style.h"

namespace seamwright {

RunPage::RunPage(Desk& desk, const Views& views)
    : StepPage(desk, views, Step::run,
               tr("Measure the part, look at the result, push the corrected frames.")) {
    measure_ =
        make_button("measure", "measure", tr("Measure"),
                    tr("Measures and judges; nothing is written to the robot"), [this] { measure(false); });
    measure_push_ = make_button("measure_push", "push", tr("Measure, then push..."),
                                tr("Measures, shows what would be written, and asks before it is pushed"),
                                [this] { measure(true); });
    for (QPushButton* b : {measure_, measure_push_}) {
        b->setMinimumHeight(44);
        QFont font = b->font();
        font.setBold(true);
        b->setFont(font);
    }
    QVBoxLayout& head = make_head();
    head.addLayout(make_row({measure_, measure_push_}));
    head.addWidget(make_progress());
    verdict_ = make_text({});
    verdict_->setObjectName("run_verdict");
    head.addWidget(verdict_);
    box().addWidget(new TypeChooser(desk));
    part_ = new QLineEdit;
    part_->setObjectName("part_id");
    part_->setPlaceholderText(tr("run number"));
    add_field(box(), tr("Part"), part_,
              tr("Identity of the part that stands there; empty: the run's number"));
    images_ = new QCheckBox(tr("Keep raw images"));
    images_->setObjectName("keep_images");
    images_->setToolTip(tr("Camera images are stored with the run, beside the profiles"));
    images_->setMinimumHeight(style::kTargetPx);
    box().addWidget(images_);
    confirm_ = new QWidget;
    confirm_->setObjectName("confirm");
    auto* ask_box = new QVBoxLayout(confirm_);
    ask_box->setContentsMargins(0, 0, 0, 0);
    question_ = make_text({});
    ask_box->addWidget(question_);
    frames_ = make_table("push_frames", {tr("Frame"), tr("X Y Z mm  A B C deg")},
                         tr("What would be written, and what stands there"));
    ask_box->addWidget(frames_);
    push_ = make_button("push", "push", tr("Push"),
                        tr("Writes these frames to the robot, reads them back and compares"),
                        [this] { answer(true); });
    push_->setMinimumHeight(44);
    decline_ = make_button("decline", "stop", tr("Do not push"), tr("Nothing is written; the run is kept"),
                           [this] { answer(false); });
    decline_->setMinimumHeight(44);
    ask_box->addLayout(make_row({push_, decline_}));
    confirm_->hide();
    box().addWidget(confirm_);

    gate_ = make_text({});
    gate_->setObjectName("gate");
    box().addWidget(gate_);
    regions_ = make_table("run_regions", {tr("Region, verdict"), tr("X Y Z mm"), tr("A B C deg")},
                          tr("Displacement per region with its sigma, and what was written"));
    regions_->setMinimumHeight(6 * style::kTargetPx);
    // As high as its rows are: the page scrolls, a table within it would show one region and a half.
    connect(regions_->verticalHeader(), &QHeaderView::sectionResized, regions_, [this] {
        constexpr int kMost_px = 20 * style::kTargetPx;
        const int all = regions_->verticalHeader()->length() + regions_->horizontalHeader()->height() + 8;
        regions_->setMinimumHeight(std::clamp(all, 6 * style::kTargetPx, kMost_px));
    });
    // The words wrap, the numbers do not.
    regions_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
    regions_->horizontalHeader()->setSectionResizeMode(2, QHeaderView::ResizeToContents);
    box().addWidget(regions_);
    spots_ = make_table("run_spots", {tr("Spot"), tr("dx mm"), tr("dz mm"), tr("Verdict")},
                        tr("What every spot measured against its reference"));
    spots_->setMinimumHeight(8 * style::kTargetPx);
    connect(spots_, &QTableWidget::currentCellChanged, this, [this](int row) {
        if (row >= 0 && spots_->item(row, 0))
            desk_.selection().select_spot(spots_->item(row, 0)->text().toStdString());
    });
    connect(regions_, &QTableWidget::currentCellChanged, this, [this](int row) {
        if (row >= 0 && shown_ && row < static_cast<int>(shown_->regions.size()))
            desk_.selection().select_region(shown_->regions[static_cast<std::size_t>(row)].region_id);
    });
    box().addWidget(spots_);

    box().addWidget(make_heading(tr("History")));
    history_ = make_table("history", {tr("Run"), tr("Part"), tr("When"), tr("Status")},
                          tr("All runs of the project, newest first"));
    history_->setMinimumHeight(8 * style::kTargetPx);
    // A part of a proof has a long name: that one wraps.
    history_->horizontalHeader()->setSectionResizeMode(1, QHeaderView::Stretch);
    history_->horizontalHeader()->setSectionResizeMode(3, QHeaderView::ResizeToContents);
    connect(history_, &QTableWidget::cellActivated, this, [this](int row) {
        if (row >= 0 && row < static_cast<int>(summaries_.size()))
            show_number(summaries_[static_cast<std::size_t>(row)].number);
    });
    box().addWidget(history_);
    open_ =
        make_button("open_run", "open", tr("Show"), tr("Shows the chosen run above (Enter, double click)"),
                    [this] { show_number(chosen()); });
    compare_ = make_button("compare_runs", "compare", tr("Compare"),
                           tr("The chosen run beside the one shown above"), [this] { compare(); });
    export_ = make_button("export_csv", "export", tr("Export CSV..."), tr("All runs: one line a region"),
                          [this] { export_csv(); });
    delete_ = make_button(
        "delete_run", "remove", tr("Delete..."), tr("Deletes the chosen run with its raw data"), [this] {
            const auto number = chosen();
            if (number <= 0) return;
            // Raw data do not come back: the one place where a question stands before a deletion.
            if (QMessageBox::question(
                    this, tr("Delete run"),
                    tr("Delete run %1 with its raw data? This cannot be undone.").arg(number)) ==
                QMessageBox::Yes)
                done(desk_.delete_run(number));
        });
    box().addLayout(make_row({open_, compare_}));
    box().addLayout(make_row({export_, delete_}));
    differences_ = make_table("differences", {tr("Region"), tr("Difference X Y Z mm"), tr("A B C deg")},
                              tr("Second run minus first"));
    differences_->setMinimumHeight(5 * style::kTargetPx);
    differences_->hide();
    box().addWidget(differences_);
    box().addStretch(1);

    connect(&desk_.worker(), &StationWorker::measured, this, [this](std::shared_ptr<const RunRecord> run) {
        job_ = Job::none;
        show_run(std::move(run), Shown::now);
        if (std::exchange(voided_, false))
            set_verdict(*verdict_,
                        tr("The project was changed while the push waited for an answer: nothing was pushed. "
                           "Measure again."),
                        Tone::attention);
    });
    connect(&desk_.worker(), &StationWorker::confirm_push, this, &RunPage::ask);
    connect(&desk_.worker(), &StationWorker::failed, this, [this] {
        if (job_ == Job::measuring) ended();
    });
    connect(&desk_.worker(), &StationWorker::busy_changed, this, [this](bool busy) {
        if (!busy) set_asks(false);
        if (!busy && job_ == Job::measuring && !desk_.worker().busy()) ended();
        measure_->setEnabled(!busy && desk_.station().connected);
        measure_push_->setEnabled(!busy && desk_.station().connected);
    });
    // What is asked for was judged with the project as it was.
    connect(&desk_, &Desk::project_changed, this, [this] {
        if (!asks_) return;
        voided_ = true;
        answer(false);
    });
    connect(&desk_, &Desk::station_changed, this, [this] {
        const bool free = desk_.station().connected && !desk_.worker().busy();
        measure_->setEnabled(free);
        measure_push_->setEnabled(free);
    });
    connect(views_.trend, &TrendChart::part_opened, this, [this](int index) {
        if (!isVisible() || index < 0 || index >= static_cast<int>(charted_.size())) return;
        show_number(charted_[static_cast<std::size_t>(index)]);
    });
    connect(&desk_, &Desk::opened, this, [this] {
        shown_.reset();
        job_ = Job::none;
        voided_ = false;
        set_asks(false);
        differences_->hide();
    });
}

void RunPage::set_asks(bool asks) {
    confirm_->setVisible(asks);
    if (asks_ == asks) return;
    asks_ = asks;
    if (asks && parentWidget()) parentWidget()->installEventFilter(this);
    emit asks_changed();
}

void RunPage::entered() {
    views_.raise(views_.residuals);
    views_.raise(views_.scene);
    if (asks_) point_out();
}

void RunPage::point_out() {
    if (!asks_) return StepPage::point_out();
    fit_question();
    bring_into_view(confirm_);
    decline_->setFocus(Qt::TabFocusReason);
}

void RunPage::fit_question() {
    constexpr int kLeastTable_px = 3 * style::kTargetPx, kEdges_px = 12;
    const QWidget* view = parentWidget();
    if (!view || !asks_) return;
    const int all = frames_->verticalHeader()->length() + frames_->horizontalHeader()->height() + 8;
    frames_->setFixedHeight(kLeastTable_px);
    confirm_->layout()->activate();
    const int width = box().contentsRect().width();
    const int beside = confirm_->layout()->totalHeightForWidth(width) - kLeastTable_px;
    frames_->setFixedHeight(
        std::clamp(view->height() - beside - kEdges_px, kLeastTable_px, std::max(kLeastTable_px, all)));
}

// The words above it may take more lines once they are there.
bool RunPage::eventFilter(QObject* watched, QEvent* event) {
    if (asks_ && watched == parentWidget() && event->type() == QEvent::Resize) {
        fit_question();
        bring_into_view(confirm_);
    }
    return StepPage::eventFilter(watched, event);
}

void RunPage::measure(bool push) {
    if (!desk_.station().connected || desk_.worker().busy() || !all_is_taken()) return;
    begin();
    desk_.worker().measure(part_->text().trimmed().toStdString(), push, images_->isChecked(),
                           desk_.selection().part_type());
}

std::int64_t RunPage::chosen() const {
    const int row = history_->currentRow();
    return row < 0 || row >= static_cast<int>(summaries_.size())
               ? 0
               : summaries_[static_cast<std::size_t>(row)].number;
}

void RunPage::refresh() {
    measure_->setEnabled(desk_.station().connected && !desk_.worker().busy());
    measure_push_->setEnabled(desk_.station().connected && !desk_.worker().busy());
    show_history();
    if (shown_ || job_ != Job::none) return;
    if (!summaries_.empty())
        show_number(summaries_.front().number);
    else
        show_nothing(tr("Nothing was measured yet."), Tone::plain);
}

void RunPage::begin() {
    job_ = Job::measuring;
    voided_ = false;
    show_nothing(tr("Measuring ..."), Tone::plain);
}

void RunPage::ended() {
    job_ = Job::failed;
    show_nothing(tr("Not measured."), Tone::attention);
}

void RunPage::show_nothing(const QString& verdict, Tone tone) {
    shown_.reset();
    set_verdict(*verdict_, verdict, tone);
    gate_->clear();
    for (QTableWidget* t : {regions_, spots_}) set_rows(*t, {});
    views_.residuals->set_data({});
    emit run_shown(nullptr);
}

void RunPage::show_number(std::int64_t number) {
    if (job_ == Job::measuring) return;
    if (auto run = desk_.run(number))
        show_run(std::make_shared<const RunRecord>(std::move(*run)), Shown::earlier);
}

void RunPage::answer(bool yes) {
    set_asks(false);
    const QString edited = yes ? desk_.edited_elsewhere() : QString();
    if (!edited.isEmpty())
        emit desk_.trouble(tr("%1: nothing was pushed. Open the project again.").arg(edited));
    desk_.worker().answer_push(yes && edited.isEmpty());
}

}  // namespace seamwright
