#include "projects/statistics/statistics_page.h"

namespace seamwright {
namespace {

Cell cell(const std::optional<double>& value) {
    return value ? Cell(*value) : Cell();
}
Cell cell(const std::optional<Index>& index, double Index::*value) {
    return index ? Cell((*index).*value) : Cell();
}
Cell cell(const std::optional<Index>& index, double Interval::*side) {
    return index ? Cell(index->limits.*side) : Cell();
}

Sheet summary_sheet(const Statistics& s, Language language) {
    const auto t = [&](const char* english) { return Cell(Text::chosen(english).in(language)); };
    Sheet sheet{Text("Summary").in(language), {}};
    std::vector<Cell> head{t("Region"),      t("Measurand"),   t("unit"),   std::string("n"),
                           t("Mean"),        std::string("s"), t("Lowest"), t("Highest"),
                           t("Lower limit"), t("Upper limit"), t("Beyond")};
    for (const std::string index : {"Pp", "Ppk", "Cp", "Cpk"}) {
        head.emplace_back(index);
        head.emplace_back(index + " 2.5 %");
        head.emplace_back(index + " 97.5 %");
    }
    for (const char* more : {"Correlation", "Normal (p)", "Alarms", "Trend per day", "Limit reached"})
        head.push_back(t(more));
    sheet.rows.push_back(std::move(head));
    for (const RegionStatistics& r : s.regions)
        for (const Characteristic& c : r.characteristics) {
            const ProcessSummary& m = c.summary;
            std::vector<Cell> row{r.id,
                                  c.name.in(language),
                                  std::string(c.unit),
                                  static_cast<double>(m.n),
                                  m.mean,
                                  m.s,
                                  m.lowest,
                                  m.highest,
                                  cell(c.limits.lower),
                                  cell(c.limits.upper),
                                  static_cast<double>(m.beyond)};
            for (const auto* index :
                 {&m.total.spread, &m.total.worst_side, &m.within.spread, &m.within.worst_side}) {
                row.push_back(cell(*index, &Index::value));
                row.push_back(cell(*index, &Interval::low));
                row.push_back(cell(*index, &Interval::high));
            }
            row.emplace_back(m.correlation);
            row.push_back(cell(m.normal_p));
            row.push_back(c.chart ? Cell(static_cast<double>(c.chart->alarms.size())) : Cell());
            row.push_back(c.trend ? Cell(c.trend->slope_per_day) : Cell());
            row.push_back(
                c.trend && c.trend->crossing
                    ? Cell(utc_text(static_cast<std::int64_t>(86400 * (s.production.runs[c.runs.back()].day +
                                                                       c.trend->crossing->days)))
                               .substr(0, 10))
                    : Cell());
            sheet.rows.push_back(std::move(row));
        }
    return sheet;
}

Sheet refusals_sheet(const Statistics& s, Language language) {
    const auto t = [&](const char* english) { return Cell(Text::chosen(english).in(language)); };
    Sheet sheet{Text("Refusals").in(language),
                {{t("Region"), t("Why it was refused"), t("How often"), t("Last (UTC)")}}};
    for (const RegionStatistics& r : s.regions)
        for (const RefusalReason& why : r.refusals)
            sheet.rows.push_back({r.id, why.said(language), static_cast<double>(why.count), why.last_utc});
    return sheet;
}

// A run a line; the places of a panel job may miss in some.
Sheet values_sheet(const Statistics& s, const RegionStatistics& r, Language language) {
    const auto t = [&](const char* english) { return Cell(Text::chosen(english).in(language)); };
    Sheet sheet{r.id, {{t("File"), t("Run"), t("Part"), t("Start (UTC)")}}};
    for (const Characteristic& c : r.characteristics) sheet.rows.front().emplace_back(c.key);
    std::vector<std::size_t> next(r.characteristics.size(), 0);
    for (std::size_t i = 0; i < s.production.runs.size(); ++i) {
        const ProductionRun& run = s.production.runs[i];
        std::vector<Cell> row{s.production.files[run.file].path.filename().string(),
                              static_cast<double>(run.values.number), run.values.part_id,
                              run.values.started_utc};
        bool any = false;
        for (std::size_t k = 0; k < r.characteristics.size(); ++k) {
            const Characteristic& c = r.characteristics[k];
            const bool has = next[k] < c.runs.size() && c.runs[next[k]] == i;
            row.push_back(has ? Cell(c.values[next[k]++]) : Cell());
            any = any || has;
        }
        if (any) sheet.rows.push_back(std::move(row));
    }
    return sheet;
}

}  // namespace

Workbook statistics_workbook(const Statistics& s, Language language) {
    Workbook book{{summary_sheet(s, language), refusals_sheet(s, language)}};
    for (const RegionStatistics& r : s.regions) book.sheets.push_back(values_sheet(s, r, language));
    return book;
}

std::vector<QdasStudy> statistics_qdas(const Statistics& s) {
    std::vector<QdasStudy> out;
    for (const RegionStatistics& r : s.regions)
        for (const Characteristic& c : r.characteristics) {
            if (!c.limits.lower || !c.limits.upper) continue;
            const Project& project = s.production.files[s.production.runs[c.runs.back()].file].project;
            QdasStudy q;
            q.part_number = project.name;
            q.part_name = project.part.name;
            if (!project.robots.empty()) {
                q.machine_number = project.robots.front().identity.serial;
                q.machine_name =
                    project.robots.front().identity.brand + " " + project.robots.front().identity.model;
            }
            q.characteristic_number = std::to_string(out.size() + 1);
            q.characteristic_name = r.id + " " + c.name.english();
            q.nominal_mm = c.nominal;
            q.lower_mm = *c.limits.lower;
            q.upper_mm = *c.limits.upper;
            q.unit = c.unit;
            for (std::size_t i = 0; i < c.values.size(); ++i) {
                const RunValues& run = s.production.runs[c.runs[i]].values;
                q.values.push_back(
                    {run.part_id, "", static_cast<long>(run.number), c.values[i], {}, run.started_utc});
            }
            out.push_back(std::move(q));
        }
    return out;
}

}  // namespace seamwright
