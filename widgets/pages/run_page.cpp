#include "widgets/pages/run_page.h"

#include <fmt/format.h>

#include <QDateTime>
#include <QFileDialog>
#include <QHeaderView>
#include <QMessageBox>
#include <cmath>
#include <set>

#include "devices/exchange/files.h"
#include "devices/exchange/tables/csv_table.h"
#include "projects/measure/measure.h"
#include "projects/proof/zero_shift.h"
#include "widgets/into_view.h"
#include "widgets/pages/parts/type_chooser.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"
#include "widgets/words.h"

namespace seamwright {
namespace {

constexpr auto kCharted = std::size_t{100};  // newest runs in the chart

QString status_text(RunStatus status) {
    switch (status) {
        case RunStatus::ok:
            return RunPage::tr("ok");
        case RunStatus::refused:
            return RunPage::tr("refused");
        case RunStatus::alarm:
            return RunPage::tr("ALARM");
        case RunStatus::device:
            return RunPage::tr("device failed");
        case RunStatus::cancelled:
            return RunPage::tr("cancelled");
        case RunStatus::interrupted:
            return RunPage::tr("interrupted");
        case RunStatus::pushed:
            return RunPage::tr("pushed, outcome not recorded");
        case RunStatus::not_taken:
            return RunPage::tr("not taken, nothing is released");
    }
    return {};
}

QString release_text(Release release) {
    switch (release) {
        case Release::taken:
            return RunPage::tr("the application runs in the frame");
        case Release::given:
            return RunPage::tr("released, whether the application began is not known");
        case Release::not_taken:
        case Release::withdrawn:
            return RunPage::tr("not released");
        case Release::none:
            break;
    }
    return {};
}

Tone tone_of(RunStatus status) {
    return status == RunStatus::ok          ? Tone::good
           : status == RunStatus::cancelled ? Tone::plain
           : status == RunStatus::refused || status == RunStatus::not_taken || status == RunStatus::pushed
               ? Tone::attention
               : Tone::alarm;
}

}  // namespace

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
    frames_->setMinimumHeight(200);
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
            if (auto run = desk_.run(summaries_[static_cast<std::size_t>(row)].number))
                show_run(std::make_shared<const RunRecord>(std::move(*run)));
    });
    box().addWidget(history_);
    open_ = make_button("open_run", "open", tr("Show"),
                        tr("Shows the chosen run above (Enter, double click)"), [this] {
                            if (auto run = desk_.run(chosen()))
                                show_run(std::make_shared<const RunRecord>(std::move(*run)));
                        });
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

    connect(&desk_.worker(), &StationWorker::measured, this, &RunPage::show_run);
    connect(&desk_.worker(), &StationWorker::confirm_push, this, &RunPage::ask);
    connect(&desk_.worker(), &StationWorker::busy_changed, this, [this](bool busy) {
        if (!busy) confirm_->hide();
        measure_->setEnabled(!busy && desk_.station().connected);
        measure_push_->setEnabled(!busy && desk_.station().connected);
    });
    connect(&desk_, &Desk::station_changed, this, [this] {
        const bool free = desk_.station().connected && !desk_.worker().busy();
        measure_->setEnabled(free);
        measure_push_->setEnabled(free);
    });
    connect(views_.trend, &TrendChart::part_opened, this, [this](int index) {
        if (!isVisible() || index < 0 || index >= static_cast<int>(charted_.size())) return;
        if (auto run = desk_.run(charted_[static_cast<std::size_t>(index)]))
            show_run(std::make_shared<const RunRecord>(std::move(*run)));
    });
    connect(&desk_, &Desk::opened, this, [this] {
        shown_.reset();
        confirm_->hide();
        differences_->hide();
    });
}

void RunPage::entered() {
    views_.raise(views_.residuals);
    views_.raise(views_.scene);
}

void RunPage::measure(bool push) {
    if (!desk_.station().connected || desk_.worker().busy()) return;
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
    if (!shown_ && !summaries_.empty()) {
        if (auto run = desk_.run(summaries_.front().number))
            show_run(std::make_shared<const RunRecord>(std::move(*run)));
    } else if (!shown_) {
        set_verdict(*verdict_, tr("Nothing was measured yet."), Tone::plain);
        gate_->clear();
        for (QTableWidget* t : {regions_, spots_}) set_rows(*t, {});
    }
}

void RunPage::show_run(std::shared_ptr<const RunRecord> run) {
    shown_ = std::move(run);
    const RunRecord& r = *shown_;
    const QString part = QString::fromStdString(r.part_id), why = shown(r.message);
    // What refuses or alarms says so by itself.
    const bool says_status = r.status == RunStatus::refused || r.status == RunStatus::alarm;
    set_verdict(*verdict_,
                says_status
                    ? tr("Run %1, part %2: %3").arg(r.number).arg(part, why)
                    : tr("Run %1, part %2: %3. %4").arg(r.number).arg(part, status_text(r.status), why),
                tone_of(r.status));
    QVector<QStringList> rows;
    QStringList refusals;
    for (const RegionRecord& region : r.regions) {
        QString push = shown_word(to_string(region.push.status));
        if (region.push.release != Release::none) push += "\n" + release_text(region.push.release);
        const auto head = [&](const QString& verdict) {
            return QString::fromStdString(region.region_id) + "\n" + verdict + "\n" + push;
        };
        QStringList row;
        if (region.correction) {
            const auto v = six(region.correction->displacement.workobject_from_movedworkobject);
            QStringList moves, turns;
            for (std::size_t k = 0; k < 6; ++k) {
                const double sigma = k < 3 ? region.correction->sigma_xyz_mm[static_cast<int>(k)]
                                           : region.correction->sigma_abc_deg[static_cast<int>(k) - 3];
                const int decimals = k < 3 ? 2 : 3;
                // Of what is not determined there is no number.
                (k < 3 ? moves : turns) << (std::isfinite(sigma) ? tr("%1 ± %2").arg(number(v[k], decimals),
                                                                                     number(sigma, decimals))
                                                                 : QStringLiteral("-"));
            }
            const RegionCorrection& c = *region.correction;
            row << head(region.gate_passed ? tr("passed the gate")
                                           : tr("%1, refused").arg(shown_word(to_string(c.status)))) +
                       QChar('\n') + tr("random %1").arg(number(c.sigma_random.xyz_mm.maxCoeff(), 3)) +
                       QChar('\n') + tr("systematic %1").arg(number(c.sigma_systematic.xyz_mm.maxCoeff(), 3))
                << moves.join("\n") << turns.join("\n");
        } else {
            row << head(tr("not solved")) << QStringLiteral("-") << QStringLiteral("-");
        }
        rows << row;
        for (const Text& reason : region.refusals)
            refusals << tr("%1: %2").arg(QString::fromStdString(region.region_id), shown(reason));
    }
    set_rows(*regions_, rows);
    set_verdict(*gate_,
                refusals.isEmpty() ? tr("Safety gate: every region passes.")
                                   : tr("Safety gate refuses: %1").arg(refusals.join("; ")),
                refusals.isEmpty() ? Tone::plain : Tone::attention);
    rows.clear();
    std::vector<ResidualBar> bars;
    for (const SpotMeasurement& m : r.spots) {
        const Spot* spot = find_spot(desk_.project(), m.spot_id);
        const bool ok = m.status == SpotStatus::measured;
        const Eigen::Vector3d d = spot && ok ? Eigen::Vector3d(m.measured_mm - spot->reference_mm)
                                             : Eigen::Vector3d::Constant(std::nan(""));
        const QString word = shown_word(to_string(m.status));
        rows << QStringList{QString::fromStdString(m.spot_id), number(d.x(), 2), number(d.z(), 2),
                            m.message.empty() ? word : word + ": " + shown(m.message)};
        for (const RegionRecord& region : r.regions) {
            if (!region.correction) continue;
            bool found = false;
            for (const SpotResidual& s : region.correction->spots)
                if (s.id == m.spot_id && !found) {
                    bars.push_back({QString::fromStdString(s.id), s.residual_mm, m.sigma_mm, s.used});
                    found = true;
                }
            if (found) break;
        }
    }
    set_rows(*spots_, rows);
    views_.residuals->set_data(bars);
    emit run_shown(shown_);
}

void RunPage::ask(const std::shared_ptr<const RunRecord>& judged) {
    show_run(judged);
    set_verdict(*verdict_,
                tr("Part %1 is measured and waits for your answer below.")
                    .arg(QString::fromStdString(judged->part_id)),
                Tone::attention);
    QVector<QStringList> rows;
    std::set<std::string> robots;
    for (const RegionRecord& region : judged->regions) {
        const int at = index_of<Region>(desk_.project(), region.region_id);
        if (at >= 0) {
            const Region& r = desk_.project().regions[static_cast<std::size_t>(at)];
            rows << QStringList{tr("%1 now").arg(QString::fromStdString(r.frame_name)),
                                frame_text(region.push.before, "\n")};
            rows << QStringList{tr("%1 new").arg(QString::fromStdString(r.frame_name)),
                                frame_text(region.base_from_frame, "\n")};
            if (!r.spot_ids.empty())
                if (const Spot* s = find_spot(desk_.project(), r.spot_ids.front()))
                    robots.insert(s->robot_id);
        }
    }
    set_rows(*frames_, rows);
    frames_->setMinimumHeight(frames_->verticalHeader()->length() + frames_->horizontalHeader()->height() +
                              8);
    QStringList names;
    for (const std::string& id : robots) names << QString::fromStdString(id);
    question_->setText(tr("These frames would be written. Nothing has been sent yet."));
    push_->setText(tr("Push %1 frames to %2").arg(judged->regions.size()).arg(names.join(", ")));
    push_->setAccessibleName(push_->text());
    confirm_->show();
    bring_into_view(confirm_);
    decline_->setFocus();
}

void RunPage::answer(bool yes) {
    confirm_->hide();
    desk_.worker().answer_push(yes);
}

void RunPage::show_history() {
    const auto runs = desk_.runs();
    summaries_.clear();
    if (runs) summaries_.assign(runs->rbegin(), runs->rend());
    QVector<QStringList> rows;
    for (const RunSummary& s : summaries_) {
        const QDateTime at = QDateTime::fromString(QString::fromStdString(s.started_utc), Qt::ISODateWithMs);
        rows << QStringList{QString::number(s.number), QString::fromStdString(s.part_id),
                            at.toLocalTime().toString("dd.MM. HH:mm"),
                            s.push && s.status == RunStatus::ok ? tr("ok, pushed") : status_text(s.status)};
    }
    set_rows(*history_, rows);
    for (QPushButton* b : {open_, compare_, export_, delete_}) b->setEnabled(!summaries_.empty());
    if (!isVisible()) return;
    // The region's displacement over the last parts.
    const std::string id = desk_.selection().region();
    std::vector<QString> labels;
    std::vector<TrendSeries> series{{tr("X"), {}}, {tr("Y"), {}}, {tr("Z"), {}}};
    TrendLimits limits;
    const int at = index_of<Region>(desk_.project(), id);
    if (at >= 0) {
        const double most = desk_.project().regions[static_cast<std::size_t>(at)].limits.translation_mm;
        if (std::isfinite(most)) limits = {-most, most};
    }
    // A proof's shifts are made on purpose and say nothing of how the parts come.
    const auto proofs = proof_runs(desk_.facts().evidence);
    charted_.clear();
    for (const RunSummary& s : summaries_) {
        if (charted_.size() == kCharted) break;
        if (!proofs.contains(s.number) && !s.part_id.starts_with(kZeroShiftPrefix))
            charted_.push_back(s.number);
    }
    std::reverse(charted_.begin(), charted_.end());
    int refused = 0;
    for (const std::int64_t number : charted_) {
        auto run = desk_.run(number);
        refused += run && run->status == RunStatus::refused;
        labels.push_back(QString::number(number));
        Eigen::Vector3d t = Eigen::Vector3d::Constant(std::nan(""));
        if (run)
            for (const RegionRecord& r : run->regions)
                if (r.region_id == id && r.correction)
                    t = r.correction->displacement.workobject_from_movedworkobject.translation();
        for (int k = 0; k < 3; ++k) series[static_cast<std::size_t>(k)].values.push_back(t[k]);
    }
    QString title = tr("Displacement of region %1").arg(QString::fromStdString(id));
    if (refused > 0) title += "   " + tr("%n refused", nullptr, refused);
    views_.trend->set_data(title, QStringLiteral("mm"), labels, series, limits);
    std::vector<double> all;
    for (const TrendSeries& s : series) all.insert(all.end(), s.values.begin(), s.values.end());
    views_.histogram->set_data(tr("Displacement, X Y Z"), QStringLiteral("mm"), all, limits);
}

void RunPage::compare() {
    auto other = desk_.run(chosen());
    if (!other || !shown_) return;
    QVector<QStringList> rows;
    for (const RegionRecord& a : shown_->regions)
        for (const RegionRecord& b : other->regions) {
            if (a.region_id != b.region_id || !a.correction || !b.correction) continue;
            const auto x = six(a.correction->displacement.workobject_from_movedworkobject),
                       y = six(b.correction->displacement.workobject_from_movedworkobject);
            QStringList mm, deg;
            for (std::size_t k = 0; k < 3; ++k)
                mm << number(y[k] - x[k], 3), deg << number(y[k + 3] - x[k + 3], 4);
            rows << QStringList{QString::fromStdString(a.region_id), mm.join("\n"), deg.join("\n")};
        }
    differences_->setHorizontalHeaderLabels(
        {tr("Region"), tr("Run %1 - %2: X Y Z mm").arg(other->number).arg(shown_->number), tr("A B C deg")});
    set_rows(*differences_, rows);
    differences_->show();
}

void RunPage::export_csv() {
    const QString file =
        QFileDialog::getSaveFileName(this, tr("Export CSV"), QStringLiteral("runs.csv"), tr("CSV (*.csv)"));
    if (file.isEmpty()) return;
    std::string text =
        "run,part,started_utc,push,status,region,region_status,x_mm,y_mm,z_mm,a_deg,b_deg,c_deg,sigma_x_mm,"
        "sigma_y_mm,"
        "sigma_z_mm,sigma_a_deg,sigma_b_deg,sigma_c_deg,gate_passed,push_status\n";
    for (auto it = summaries_.rbegin(); it != summaries_.rend(); ++it) {
        auto run = desk_.run(it->number);
        if (!run) {
            done(tl::unexpected(run.error()));
            return;
        }
        for (const RegionRecord& r : run->regions) {
            text +=
                fmt::format("{},{},{},{},{},{},{}", run->number, csv::field(run->part_id), run->started_utc,
                            run->push ? 1 : 0, to_string(run->status), csv::field(r.region_id),
                            r.correction ? to_string(r.correction->status) : std::string_view("not_solved"));
            if (r.correction) {
                for (double v : six(r.correction->displacement.workobject_from_movedworkobject))
                    text += fmt::format(",{}", v);
                for (int k = 0; k < 3; ++k) text += fmt::format(",{}", r.correction->sigma_xyz_mm[k]);
                for (int k = 0; k < 3; ++k) text += fmt::format(",{}", r.correction->sigma_abc_deg[k]);
            } else {
                text += ",,,,,,,,,,,,";
            }
            text += fmt::format(",{},{}\n", r.gate_passed ? 1 : 0, to_string(r.push.status));
        }
    }
    done(write_text_file(file.toStdString(), text));
}

}  // namespace seamwright
