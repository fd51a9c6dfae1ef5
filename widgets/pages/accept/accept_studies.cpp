// What the page of the acceptance shows of the agenda, the studies and their charts.

#include <QHeaderView>
#include <QResizeEvent>
#include <QTextDocument>
#include <QTextOption>
#include <cmath>

#include "projects/acceptance/equipment/device_studies.h"
#include "projects/acceptance/pages/acceptance_page.h"
#include "projects/measure/fields.h"
#include "widgets/pages/accept/accept_page.h"
#include "widgets/shown_text.h"
#include "widgets/style.h"

namespace seamwright {
namespace {

QString q(const std::string& text) {
    return QString::fromStdString(text);
}

Tone tone_of_verdict(AcceptanceVerdict verdict) {
    const report::Tone tone = tone_of(verdict);
    return tone == report::Tone::good    ? Tone::good
           : tone == report::Tone::alarm ? Tone::alarm
                                         : Tone::attention;
}

QString cell(const report::Block& b, std::size_t row, std::size_t column) {
    return q(b.rows[row][column]).toHtmlEscaped();
}

QString as_table(const report::Block& b) {
    const std::vector<bool> numeric = report::numeric_columns(b.rows);
    QString html = QStringLiteral("<table width=\"100%\" cellspacing=\"0\" cellpadding=\"3\">");
    for (std::size_t r = 0; r < b.rows.size(); ++r) {
        html += QStringLiteral("<tr>");
        for (std::size_t c = 0; c < b.rows[r].size(); ++c) {
            const bool number = c < numeric.size() && numeric[c];
            const QString side = number ? QStringLiteral("right") : QStringLiteral("left");
            if (r == 0)
                html += QStringLiteral("<th align=\"%1\">%2</th>").arg(side, cell(b, r, c));
            else  // a line may end behind the point of a number
                html += QStringLiteral("<td align=\"%1\" style=\"white-space:%3\">%2</td>")
                            .arg(side, cell(b, r, c),
                                 number ? QStringLiteral("nowrap") : QStringLiteral("normal"));
        }
        html += QStringLiteral("</tr>");
    }
    return html + QStringLiteral("</table>");
}

// "Cg: value 1.42, from 1.1", a paragraph a row.
QString as_lines(const report::Block& b) {
    QString html;
    for (std::size_t r = 1; r < b.rows.size(); ++r) {
        QStringList values;
        for (std::size_t c = 1; c < b.rows[r].size(); ++c) {
            if (b.rows[r][c].empty()) continue;
            const QString name = c < b.rows[0].size() ? cell(b, 0, c) : QString();
            values
                << QStringLiteral("%1 <span style=\"white-space:nowrap\">%2</span>").arg(name, cell(b, r, c));
        }
        html += QStringLiteral("<p><b>%1</b>: %2</p>").arg(cell(b, r, 0), values.join(QStringLiteral(", ")));
    }
    return html;
}

// As a label breaks its lines.
bool fits(const QString& html, int width_px, const QFont& font) {
    QTextDocument document;
    document.setDefaultFont(font);
    document.setDocumentMargin(0);
    QTextOption words;
    words.setWrapMode(QTextOption::WordWrap);
    document.setDefaultTextOption(words);
    document.setHtml(html);
    document.setTextWidth(width_px);
    return document.size().width() <= width_px + 1;
}

// The report's own blocks, without title and plots, as a label of that width shows them.
QString rich(const report::Page& page, int width_px, const QFont& font) {
    QString html;
    for (const report::Block& b : page.blocks()) {
        const QString text = q(b.text).toHtmlEscaped();
        switch (b.kind) {
            case report::Block::Kind::paragraph:
                html += QStringLiteral("<p>%1</p>").arg(text);
                break;
            case report::Block::Kind::verdict:
                html += QStringLiteral("<p><b>%1</b> %2</p>").arg(q(b.word).toHtmlEscaped(), text);
                break;
            case report::Block::Kind::table: {
                if (!text.isEmpty()) html += QStringLiteral("<p><b>%1</b></p>").arg(text);
                const QString table = as_table(b);
                html += fits(table, width_px, font) ? table : as_lines(b);
                break;
            }
            default:
                break;
        }
    }
    return html;
}

std::optional<Study> judged_study(AgendaStudy study) {
    switch (study) {
        case AgendaStudy::type1:
            return Study::type1;
        case AgendaStudy::type3:
            return Study::type3;
        case AgendaStudy::linearity:
            return Study::linearity;
        case AgendaStudy::stability:
            return Study::stability;
        case AgendaStudy::correlation:
            return Study::correlation;
        case AgendaStudy::vda5:
            return Study::vda5;
        default:
            return std::nullopt;
    }
}

void fit_height(QTableWidget& table) {
    int height = table.horizontalHeader()->height() + 2 * table.frameWidth();
    for (int r = 0; r < table.rowCount(); ++r) height += table.rowHeight(r);
    table.setFixedHeight(height);
}

}  // namespace

AgendaStudy AcceptPage::chosen() const {
    const int row = list_->currentRow();
    return kAgenda[static_cast<std::size_t>(row < 0 ? static_cast<int>(AgendaStudy::type1) : row)];
}

void AcceptPage::choose(AgendaStudy study) {
    list_->setCurrentCell(static_cast<int>(study), 0);
}

const AgendaItem* AcceptPage::item() const {
    const Agenda* agenda = acceptance_.agenda();
    return agenda ? &agenda->of(chosen()) : nullptr;
}

void AcceptPage::resizeEvent(QResizeEvent* event) {
    StepPage::resizeEvent(event);
    if (isVisible() && event->size().width() != event->oldSize().width()) refresh_study();
}

void AcceptPage::entered() {
    views_.raise(views_.trend);
}

void AcceptPage::refresh() {
    acceptance_.look();
    const QSignalBlocker quiet(region_);
    region_->clear();
    for (const Region& r : desk_.project().regions) region_->addItem(q(r.id));
    region_->setCurrentText(q(acceptance_.region()));
    refresh_head();
    refresh_list();
    refresh_study();
    refresh_requirements();
    refresh_offsets();
    enable();
    draw();
}

void AcceptPage::refresh_head() {
    const AcceptanceRequirements& r = desk_.project().requirements.acceptance;
    const double low = r.nominal_mm - r.tolerance_mm / 2, high = r.nominal_mm + r.tolerance_mm / 2;
    tolerance_->setText(r.tolerance_mm > 0
                            ? tr("Tolerance T %1 mm, %2 to %3 mm")
                                  .arg(number(r.tolerance_mm, 3), number(low, 3), number(high, 3))
                            : tr("The tolerance is not stated yet"));
    const StoredAcceptance* stored = acceptance_.stored();
    const Agenda* agenda = acceptance_.agenda();
    if (stored && stored->studies) {
        const AcceptanceVerdict verdict = stored->studies->verdict();
        QString text = shown(name_of(verdict));
        if (stored->studies->source.simulated) text = tr("%1, simulated").arg(text);
        QStringList by;  // whose it is, where it is not good
        if (verdict != AcceptanceVerdict::ok && agenda)
            for (const AgendaItem& at : agenda->items)
                if (at.verdict == verdict) by << shown(name_of(at.study));
        if (!by.isEmpty()) text = tr("%1: %2").arg(text, by.join(QStringLiteral(", ")));
        set_verdict(*verdict_, text, tone_of_verdict(verdict));
    } else {
        set_verdict(*verdict_,
                    stored && stored->lacking       ? shown(stored->lacking->text())
                    : acceptance_.trouble().empty() ? tr("looking at the stored runs")
                                                    : shown(acceptance_.trouble()),
                    Tone::plain);
    }
    verdict_->setVisible(r.tolerance_mm > 0);
    if (r.tolerance_mm == 0)
        next_->setText(tr("Next: state the tolerance"));
    else if (agenda && agenda->next)
        next_->setText(
            tr("Next: %1, %2").arg(shown(name_of(*agenda->next)), deed_of(agenda->of(*agenda->next))));
    else
        next_->setText(tr("Next: write the report..."));
    next_->setAccessibleName(next_->text());
}

void AcceptPage::refresh_list() {
    const Agenda* agenda = acceptance_.agenda();
    QVector<QStringList> rows;
    for (const AgendaStudy study : kAgenda) {
        QStringList row{shown(name_of(study)), {}, {}};
        if (agenda) {
            const AgendaItem& at = agenda->of(study);
            row[1] = at.state == AgendaItem::State::done        ? tr("done")
                     : at.state == AgendaItem::State::not_begun ? tr("not begun")
                     : at.progress && !at.progress->complete()
                         ? tr("%1 of %2 runs").arg(at.progress->made()).arg(at.progress->wanted())
                         : tr("begun");
            if (at.verdict) row[2] = shown(name_of(*at.verdict));
        }
        rows << row;
    }
    set_rows(*list_, rows);
    fit_height(*list_);
}

QString AcceptPage::deed_of(const AgendaItem& at) const {
    switch (at.study) {
        case AgendaStudy::robot:
        case AgendaStudy::trigger:
            return tr("measure");
        case AgendaStudy::sensor:
            return tr("import JSON...");
        case AgendaStudy::correlation:
            return tr("import CSV...");
        case AgendaStudy::linearity:
            return tr("go to Prove");
        case AgendaStudy::vda5:
            return {};
        default:
            break;
    }
    if (at.progress && !at.progress->complete() && at.progress->made() > 0)
        return tr("go on with run %1 of %2").arg(at.progress->made() + 1).arg(at.progress->wanted());
    const int all =
        at.proposed.runs * at.proposed.rehangs * std::max<int>(1, static_cast<int>(at.proposed.parts.size()));
    return tr("measure %1 runs").arg(all);
}

void AcceptPage::refresh_study() {
    const AgendaStudy study = chosen();
    const AgendaItem* at = item();
    name_->setText(shown(name_of(study)));
    needs_->setText(at ? shown(at->needs) : QString());
    const StoredAcceptance* stored = acceptance_.stored();
    QString finding = at ? shown(at->finding) : QString();
    const auto judged = judged_study(study);
    if (finding.isEmpty() && judged && stored && stored->studies)
        if (const auto why = stored->studies->not_done.find(*judged); why != stored->studies->not_done.end())
            finding = shown(why->second.text());
    set_verdict(*finding_, finding, Tone::plain);
    finding_->setVisible(!finding.isEmpty());

    const bool live = live_study_of(study).has_value(), parts = study == AgendaStudy::type3;
    runs_row_->setVisible(live);
    parts_row_->setVisible(parts);
    rehangs_row_->setVisible(parts);
    travel_row_->setVisible(study == AgendaStudy::trigger);
    if (at && live && filled_ != study) {  // not over what a person is typing
        filled_ = study;
        runs_->setValue(at->proposed.runs);
        rehangs_->setValue(at->proposed.rehangs);
        QStringList names;
        for (const std::string& part : at->proposed.parts) names << q(part);
        parts_->setText(names.join(QStringLiteral(", ")));
    }
    const QString deed = at ? deed_of(*at) : QString();
    deed_->setVisible(!deed.isEmpty());
    deed_->setText(live && !(at && at->progress && !at->progress->complete()) ? tr("Measure")
                   : deed.isEmpty()                                           ? deed
                                    : deed.left(1).toUpper() + deed.mid(1));
    deed_->setAccessibleName(deed_->text());
    anew_->setVisible(live && at && at->progress && at->progress->made() > 0);
    charts_->setVisible(judged && study != AgendaStudy::vda5);

    report::Page page(std::string(), std::string(code_of(desk_.language())));
    report::Page forecast(std::string(), page.language());
    if (stored && judged && stored->studies) {
        add_chapter(page, desk_.language(), *stored->studies, *judged);
        if (study == AgendaStudy::type1 || study == AgendaStudy::type3)
            add_forecast_chapter(forecast, desk_.language(), *stored->studies);
    }
    if (stored && study == AgendaStudy::robot && stored->robot)
        add_chapter(page, desk_.language(), *stored->robot);
    if (stored && study == AgendaStudy::trigger && stored->trigger)
        add_chapter(page, desk_.language(), *stored->trigger);
    if (stored && study == AgendaStudy::sensor && stored->sensor)
        add_chapter(page, desk_.language(), *stored->sensor);
    const int width_px = name_->width();
    const QString result = rich(page, width_px, result_->font()),
                  predicted = rich(forecast, width_px, forecast_->font());
    result_->setText(result);
    result_->setVisible(!result.isEmpty());
    if (!predicted.isEmpty())
        forecast_->setText(
            QStringLiteral("<p><b>%1</b></p>%2").arg(tr("Forecast and measurement"), predicted));
    else if (stored && stored->forecast && stored->settings.tolerance_mm > 0 &&
             (study == AgendaStudy::type1 || study == AgendaStudy::type3))
        forecast_->setText(tr("<p><b>Forecast</b>: Cg %1, %GRR %2</p>")
                               .arg(number(predicted_cg(*stored->forecast, stored->settings), 2),
                                    number(predicted_grr_percent(*stored->forecast, stored->settings), 1)));
    else
        forecast_->clear();
    forecast_->setVisible(!forecast_->text().isEmpty());
}

void AcceptPage::refresh_requirements() {
    const AcceptanceRequirements& r = desk_.project().requirements.acceptance;
    for (std::size_t i = 0; i < requirements_.size(); ++i)
        requirements_[i]->refresh(acceptance_fields()[i].get(r), subject());
    int variant = variant_->count() - 1;
    for (int i = 0; i + 1 < variant_->count(); ++i)
        if (variant_->itemText(i) == tr("Cg = %1 T / (%2 s)").arg(r.cg_share).arg(r.cg_width)) variant = i;
    variant_->setCurrentIndex(variant);
}

void AcceptPage::refresh_offsets() {
    const int at = index_of<Region>(desk_.project(), acceptance_.region());
    QVector<QStringList> rows;
    if (at >= 0) {
        const Region& region = desk_.project().regions[static_cast<std::size_t>(at)];
        const KeptOffset* acting = acting_offset(region);
        for (const KeptOffset& kept : region.offsets)
            rows << QStringList{QString::number(kept.version), &kept == acting ? tr("acts") : tr("off"),
                                number(kept.offset_mm.x(), 3) + "  " + number(kept.offset_mm.y(), 3) + "  " +
                                    number(kept.offset_mm.z(), 3),
                                shown(kept.source)};
    }
    set_rows(*offsets_, rows);
    if (offsets_->currentRow() < 0 && !rows.isEmpty())
        offsets_->setCurrentCell(static_cast<int>(rows.size()) - 1, 0);
    fit_height(*offsets_);
    offsets_->setVisible(!rows.isEmpty());
    act_->setVisible(!rows.isEmpty());
    off_->setVisible(!rows.isEmpty());
}

void AcceptPage::enable() {
    const bool busy = desk_.worker().busy(), free = desk_.station().connected && !busy;
    const auto measured = [](AgendaStudy study) {
        return live_study_of(study) || study == AgendaStudy::robot || study == AgendaStudy::trigger;
    };
    const Agenda* agenda = acceptance_.agenda();
    const bool stated = desk_.project().requirements.acceptance.tolerance_mm > 0;
    next_->setEnabled(agenda && !busy && (!stated || !agenda->next || free || !measured(*agenda->next)));
    deed_->setEnabled(agenda && !busy && (free || !measured(chosen())));
    anew_->setEnabled(agenda && free);
    const StoredAcceptance* stored = acceptance_.stored();
    keep_->setEnabled(!busy && stored && stored->studies && stored->studies->correlation.has_value());
    report_->setEnabled(!busy && stored && stored->anything());
    values_->setEnabled(!busy && stored && stored->studies.has_value());
    const QTableWidgetItem* state = offsets_->item(offsets_->currentRow(), 1);
    bool acts = false;
    for (int r = 0; r < offsets_->rowCount(); ++r) acts = acts || offsets_->item(r, 1)->text() == tr("acts");
    act_->setEnabled(!busy && state && state->text() != tr("acts"));
    off_->setEnabled(!busy && acts);
}

void AcceptPage::draw_runs(const std::vector<StudyValue>& values, const QString& title,
                           const TrendLimits& limits, const TrendLimits& tolerance) {
    std::vector<QString> labels;
    TrendSeries series{tr("value"), {}};
    for (const StudyValue& v : values) {
        labels.push_back(shown_part(v.part) + QChar(' ') + QString::number(v.run));
        series.values.push_back(v.value_mm);
    }
    views_.trend->set_data(title, QStringLiteral("mm"), labels, {series}, limits);
    views_.histogram->set_data(title, QStringLiteral("mm"), series.values, tolerance, false);
}

void AcceptPage::draw() {
    const StoredAcceptance* stored = acceptance_.stored();
    if (!isVisible() || !stored || desk_.worker().busy()) return;
    const AgendaStudy study = chosen();
    const QString title = shown(name_of(study));
    if (!stored->studies) return draw_runs({}, title, {}, {});
    const Acceptance& a = *stored->studies;
    if (study == AgendaStudy::type1 && a.type1) {
        const double half = a.settings.share * a.settings.tolerance_mm / 2;
        const AcceptanceSettings& s = a.settings;
        return draw_runs(a.type1_values, title, {a.type1->reference_mm - half, a.type1->reference_mm + half},
                         {s.nominal_mm - s.tolerance_mm / 2, s.nominal_mm + s.tolerance_mm / 2});
    }
    if (study == AgendaStudy::type3 && a.type3) return draw_runs(a.type3_values, title, {}, {});
    if (study == AgendaStudy::stability && a.stability) {
        std::vector<QString> labels;
        for (std::size_t i = 0; i < a.stability->means_mm.size(); ++i)
            labels.push_back(QString::number(i + 1));
        views_.histogram->set_data(title, QStringLiteral("mm"), a.stability->means_mm, {}, false);
        return views_.trend->set_data(title, QStringLiteral("mm"), labels,
                                      {{tr("mean"), a.stability->means_mm}},
                                      {a.stability->mean_chart.low, a.stability->mean_chart.high});
    }
    std::vector<StudyValue> deviations;
    if (study == AgendaStudy::linearity && a.linearity)
        deviations = a.values.linearity;
    else if (study == AgendaStudy::correlation && a.correlation)
        deviations = a.values.correlation;
    else
        return draw_runs({}, title, {}, {});  // not another page's
    std::erase_if(deviations, [](const StudyValue& v) { return !v.reference_mm; });
    for (StudyValue& v : deviations) v.value_mm -= *v.reference_mm;
    draw_runs(deviations, title, {}, {});
}

}  // namespace seamwright
