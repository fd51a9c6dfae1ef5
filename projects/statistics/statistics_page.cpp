#include "projects/statistics/statistics_page.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "projects/report/svg_bars.h"

namespace seamwright {
namespace {

using report::Rows;

constexpr std::size_t kShownReasons = 12;

class Writer {
  public:
    Writer(const Statistics& s, Language language, report::Page& page)
        : s_(s), language_(language), page_(page) {}

    void write(const std::string& program) {
        summary();
        for (const RegionStatistics& r : s_.regions) region(r);
        if (s_.diagnosis) write_diagnosis(*s_.diagnosis, language_, page_);
        unmeasured();
        cycle();
        page_.heading(t("What to bear in mind"));
        for (const Text& caveat : s_.caveats) page_.paragraph(caveat.in(language_));
        page_.paragraph(
            t("Limits in brackets are of 95 % confidence. Pp and Ppk are of all that was delivered, Cp "
              "and Cpk of the scatter from part to part."));
        page_.paragraph(t("Made by {}.", program));
    }

  private:
    template <class... A>
    std::string t(const char* english, const A&... arguments) const {
        return Text::chosen(english, arguments...).in(language_);
    }
    static std::string number(double value, int decimals) {
        return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
    }
    static std::string index(const std::optional<Index>& i, bool limits = true) {
        if (!i) return "-";
        return limits ? fmt::format("{:.2f} ({:.2f}..{:.2f})", i->value, i->limits.low, i->limits.high)
                      : fmt::format("{:.2f}", i->value);
    }
    static std::string day_of(double day) { return utc_text(std::llround(86400 * day)).substr(0, 10); }

    void summary() {
        std::string names;
        for (const ProductionFile& f : s_.production.files)
            names += (names.empty() ? "" : ", ") + f.path.filename().string();
        if (s_.parts == 0) {
            page_.paragraph(t("{}: no run of production in this time.", names));
            return;
        }
        page_.paragraph(t("{}: {} parts from {} to {} (UTC).", names, s_.parts, s_.first_utc.substr(0, 16),
                          s_.last_utc.substr(0, 16)));
        Rows rows{{t("Outcome"), t("Parts"), t("Share (%)")}};
        for (std::size_t i = 0; i < s_.by_status.size(); ++i)
            if (s_.by_status[i] > 0)
                rows.push_back({Text(to_string(static_cast<RunStatus>(i)).data()).in(language_),
                                std::to_string(s_.by_status[i]),
                                number(100.0 * s_.by_status[i] / static_cast<double>(s_.parts), 2)});
        page_.table(rows);
        if (s_.by_type.empty()) return;
        Rows by_type{{t("Part type"), t("Parts"), t("Share (%)")}};
        for (const auto& [type, parts] : s_.by_type)
            by_type.push_back(
                {type, std::to_string(parts), number(100.0 * parts / static_cast<double>(s_.parts), 2)});
        page_.table(by_type);
    }

    void region(const RegionStatistics& r) {
        page_.heading(r.panel ? t("Panel job {}", r.id) : t("Region {}", r.id));
        page_.paragraph(r.panel ? t("{} parts, {} passed the gate, {} without a measurement afterwards.",
                                    r.runs, r.passed, r.left_out)
                                : t("{} parts, {} passed the gate, {} were over the limits, {} had no value.",
                                    r.runs, r.passed, r.over_limit, r.left_out));
        if (!r.characteristics.empty()) {
            Rows rows{{t("Measurand"), "n", t("Mean"), "s", t("Limits"), "Pp", "Ppk", "Cp", "Cpk",
                       t("Alarms 1 / 2..8"), t("Trend per day")}};
            for (const Characteristic& c : r.characteristics) rows.push_back(line(c));
            page_.table(rows);
        }
        for (const Characteristic& c : r.characteristics)
            if (!c.path_point || c.worst_point) characteristic(c);
        reasons(r);
    }

    std::string name_of(const Characteristic& c) const {
        return fmt::format("{}{} ({})", c.name.in(language_), c.worst_point ? ", " + t("worst point") : "",
                           c.unit == std::string("deg") ? "°" : c.unit);
    }

    std::vector<std::string> line(const Characteristic& c) const {
        const ProcessSummary& r = c.summary;
        const int decimals = c.unit == std::string("deg") ? 4 : 3;
        int beyond = 0, others = 0;
        if (c.chart)
            for (const StabilityAlarm& a : c.chart->alarms) ++(a.rule == 1 ? beyond : others);
        const auto limit = [](const std::optional<double>& v) {
            return v ? fmt::format("{:g}", *v) : std::string("-");
        };
        return {name_of(c),
                std::to_string(r.n),
                number(r.mean, decimals),
                number(r.s, decimals),
                c.limits.any() ? limit(c.limits.lower) + " .. " + limit(c.limits.upper) : "-",
                index(r.total.spread),
                index(r.total.worst_side),
                index(r.within.spread),
                index(r.within.worst_side),
                c.chart ? fmt::format("{} / {}", beyond, others) : "-",
                c.trend ? fmt::format("{:+.{}f}{}", c.trend->slope_per_day, decimals,
                                      c.trend->significant ? "" : " " + t("(chance)"))
                        : "-"};
    }

    void characteristic(const Characteristic& c) {
        page_.heading(name_of(c), 3);
        if (const auto& q = c.summary.by_quantiles)
            page_.paragraph(
                t("By quantiles: Pp {}, Ppk {}.", index(q->spread, false), index(q->worst_side, false)));
        if (c.trend && c.trend->significant) trend(c);
        for (const Text& caveat : c.caveats) page_.paragraph(t("Note: {}.", caveat));
        if (c.chart) alarms(c);
        page_.figures(statistics_plots(s_, c, language_));
    }

    void trend(const Characteristic& c) {
        const Trend& r = *c.trend;
        const double last = s_.production.runs[c.runs.back()].day;
        std::string text = t("Trend: {:+.4g} {} a day ({:+.4g} to {:+.4g}).", r.slope_per_day, c.unit,
                             r.slope_limits.low, r.slope_limits.high);
        if (const auto& x = r.crossing) {
            text += " ";
            text +=
                x->days < 0 ? t("The line has been beyond its limit {:g} {} since {}.", x->limit, c.unit,
                                day_of(last + x->days))
                : x->latest_days
                    ? t("It goes on so, and the line reaches the limit {:g} {} on {} (between {} and {}).",
                        x->limit, c.unit, day_of(last + x->days), day_of(last + x->earliest_days),
                        day_of(last + *x->latest_days))
                    : t("It goes on so, and the line reaches the limit {:g} {} on {} (not before {}).",
                        x->limit, c.unit, day_of(last + x->days), day_of(last + x->earliest_days));
        }
        page_.paragraph(text);
    }

    void alarms(const Characteristic& c) {
        std::map<int, int> by_rule;
        const StabilityAlarm* newest = nullptr;
        for (const StabilityAlarm& a : c.chart->alarms) {
            ++by_rule[a.rule];
            newest = &a;
        }
        if (!newest) return;
        std::string list;
        for (const auto& [rule, count] : by_rule)
            list += fmt::format("{}{}: {}", list.empty() ? "" : ", ", rule, count);
        const RunValues& run = s_.production.runs[c.runs[static_cast<std::size_t>(newest->run)]].values;
        page_.paragraph(t("Alarms by Nelson's rule: {}. The newest at run {}, part {}.", list, run.number,
                          run.part_id.empty() ? t("(no name)") : run.part_id));
    }

    void reasons(const RegionStatistics& r) {
        if (r.refusals.empty()) return;
        int all = 0, shown = 0;
        for (const RefusalReason& why : r.refusals) all += why.count;
        Rows rows{{t("Why it was refused"), t("How often"), t("Together (%)"), t("Last (UTC)")}};
        std::vector<report::ShareBar> bars;
        for (const RefusalReason& why : r.refusals) {
            if (bars.size() == kShownReasons) break;
            shown += why.count;
            rows.push_back({why.said(language_), std::to_string(why.count), number(100.0 * shown / all, 1),
                            why.last_utc.substr(0, 16)});
            bars.push_back({why.said(language_), 100.0 * why.count / all});
        }
        page_.heading(t("Refusals"), 3);
        page_.table(rows);
        page_.figure(report::svg_bars(t("Share of the refusals' reasons"), bars));
        if (r.refusals.size() > kShownReasons)
            page_.paragraph(t("{} rarer reasons are not shown.", r.refusals.size() - kShownReasons));
    }

    void unmeasured() {
        if (s_.unmeasured.empty()) return;
        page_.heading(t("Spots that were not measured"));
        Rows rows{{t("Spot"), t("Why"), t("How often")}};
        for (const UnmeasuredSpot& u : s_.unmeasured)
            rows.push_back(
                {u.spot_id, Text(to_string(u.status).data()).in(language_), std::to_string(u.count)});
        page_.table(rows);
    }

    void cycle() {
        if (!s_.cycle) return;
        const CycleTime& c = *s_.cycle;
        page_.heading(t("Cycle time"));
        page_.paragraph(
            t("From the start of a run to its end; of a pushed one the wait for the application to "
              "begin is in it."));
        page_.table({{t("Parts"), t("Mean (s)"), "s (s)", t("Median (s)"), "95 % (s)", t("Longest (s)"),
                      t("Start to start, median (s)")},
                     {std::to_string(c.n), number(c.mean_s, 2), number(c.s_s, 2), number(c.median_s, 2),
                      number(c.p95_s, 2), number(c.longest_s, 2), number(c.between_s, 1)}});
    }

    const Statistics& s_;
    Language language_;
    report::Page& page_;
};

}  // namespace

report::Page statistics_page(const Statistics& s, Language language, const std::string& program) {
    const std::string name =
        s.production.files.empty() ? std::string() : s.production.files.front().project.name;
    report::Page page(Text("Production statistics: {}", name).in(language), std::string(code_of(language)));
    Writer(s, language, page).write(program);
    return page;
}

}  // namespace seamwright
