// What the page shows of a run, of all runs, and of a push before its answer.

#include "widgets/pages/run_page.h"

#include <fmt/format.h>

#include <QDateTime>
#include <QFileDialog>
#include <QHeaderView>
#include <cmath>
#include <set>

#include "devices/exchange/files.h"
#include "devices/exchange/tables/csv_table.h"
#include "projects/measure/measure.h"
#include "projects/proof/known_shift.h"
#include "widgets/into_view.h"
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

void RunPage::show_verdict(const RunRecord& r, const QStringList& left_out, Shown when) {
    const QString part = shown_part(r.part_id), why = shown(r.message);
    // What refuses or alarms says so by itself.
    const bool says_status = r.status == RunStatus::refused || r.status == RunStatus::alarm;
    QString text = says_status
                       ? tr("Run %1, part %2: %3").arg(r.number).arg(part, why)
                       : tr("Run %1, part %2: %3. %4").arg(r.number).arg(part, status_text(r.status), why);
    Tone tone = tone_of(r.status);
    if (!left_out.isEmpty()) {
        text += "\n" + tr("Left out, because they contradict the others: %1").arg(left_out.join(", "));
        if (tone == Tone::good) tone = Tone::attention;
    }
    if (when == Shown::earlier) {
        const QDateTime at = QDateTime::fromString(QString::fromStdString(r.started_utc), Qt::ISODateWithMs);
        text = tr("Shown: run %1 of %2").arg(r.number).arg(at.toLocalTime().toString("dd.MM. HH:mm")) + "\n" +
               text;
        if (tone == Tone::good) tone = Tone::plain;
    }
    set_verdict(*verdict_, text, tone);
}

void RunPage::show_run(std::shared_ptr<const RunRecord> run, Shown when) {
    shown_ = std::move(run);
    const RunRecord& r = *shown_;
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
    show_verdict(r, show_spots(r), when);
    emit run_shown(shown_);
}

QStringList RunPage::show_spots(const RunRecord& r) {
    QVector<QStringList> rows;
    std::vector<ResidualBar> bars;
    QStringList left_out;
    std::vector<int> contradict;  // rows
    for (const SpotMeasurement& m : r.spots) {
        const Spot* spot = find_spot(desk_.project(), m.spot_id);
        const bool ok = m.status == SpotStatus::measured;
        const Eigen::Vector3d d = spot && ok ? Eigen::Vector3d(m.measured_mm - spot->reference_mm)
                                             : Eigen::Vector3d::Constant(std::nan(""));
        // By any of its regions; the bar is that of the first.
        const SpotResidual *first = nullptr, *unused = nullptr;
        for (const RegionRecord& region : r.regions) {
            if (!region.correction) continue;
            for (const SpotResidual& s : region.correction->spots) {
                if (s.id != m.spot_id) continue;
                if (!first) first = &s;
                if (!s.used && !unused) unused = &s;
            }
        }
        const QString id = QString::fromStdString(m.spot_id);
        if (first) bars.push_back({id, first->residual_mm, m.sigma_mm, first->used});
        QString word = shown_word(to_string(m.status));
        if (unused) {
            word = tr("left out, contradicts by %1 mm").arg(number(unused->residual_mm.norm(), 2));
            left_out << id;
            contradict.push_back(static_cast<int>(rows.size()));
        }
        rows << QStringList{id, number(d.x(), 2), number(d.z(), 2),
                            m.message.empty() ? word : word + ": " + shown(m.message)};
    }
    set_rows(*spots_, rows);
    for (const int row : contradict)
        for (int column = 0; column < spots_->columnCount(); ++column)
            spots_->item(row, column)->setForeground(style::alarm(palette()));
    views_.residuals->set_data(bars);
    return left_out;
}

void RunPage::ask(const std::shared_ptr<const RunRecord>& judged) {
    show_run(judged, Shown::now);
    set_verdict(*verdict_,
                tr("Part %1 is measured and waits for your answer below.").arg(shown_part(judged->part_id)),
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
    QStringList names;
    for (const std::string& id : robots) names << QString::fromStdString(id);
    question_->setText(tr("These frames would be written. Nothing has been sent yet."));
    push_->setText(tr("Push %1 frames to %2").arg(judged->regions.size()).arg(names.join(", ")));
    push_->setAccessibleName(push_->text());
    set_asks(true);
    point_out();
}

void RunPage::show_history() {
    const auto runs = desk_.runs();
    summaries_.clear();
    if (runs) summaries_.assign(runs->rbegin(), runs->rend());
    QVector<QStringList> rows;
    for (const RunSummary& s : summaries_) {
        const QDateTime at = QDateTime::fromString(QString::fromStdString(s.started_utc), Qt::ISODateWithMs);
        rows << QStringList{QString::number(s.number), shown_part(s.part_id),
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
        if (!proofs.contains(s.number) && !is_part_of_proof(s.part_id)) charted_.push_back(s.number);
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
    views_.histogram->set_data(tr("Displacement, X Y Z"), QStringLiteral("mm"), series, limits);
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
