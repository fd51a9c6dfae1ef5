#include <cmath>

#include "projects/statistics/statistics_page.h"

namespace seamwright {
namespace {

using nlohmann::json;

// JSON knows no infinity.
json number(double value) {
    return std::isfinite(value) ? json(value) : json();
}
json number(const std::optional<double>& value) {
    return value ? number(*value) : json();
}
json pair(const Interval& limits) {
    return json::array({number(limits.low), number(limits.high)});
}

json index_json(const std::optional<Index>& index, bool limits = true) {
    if (!index) return {};
    json out = {{"value", number(index->value)}};
    if (limits) out["limits"] = pair(index->limits);
    return out;
}

json alarms_json(const Statistics& s, const Characteristic& c) {
    json list = json::array();
    for (const StabilityAlarm& a : c.chart->alarms) {
        // Subgroups name the number of their last value.
        const RunValues& run = s.production.runs[c.runs[static_cast<std::size_t>(a.run)]].values;
        list.push_back({{"rule", a.rule},
                        {"chart", a.spread ? "spread" : "mean"},
                        {"run", run.number},
                        {"part", run.part_id},
                        {"utc", run.started_utc}});
    }
    return list;
}

json chart_json(const Statistics& s, const Characteristic& c) {
    if (!c.chart) return {};
    json by_rule = json::object();
    for (const StabilityAlarm& a : c.chart->alarms) {
        json& count = by_rule[std::to_string(a.rule)];
        count = (count.is_null() ? 0 : count.get<int>()) + 1;
    }
    return {{"subgroup", c.chart->size},
            {"centre", c.chart->centre_mm},
            {"sigma", c.chart->sigma_mm},
            {"control_limits", pair(c.chart->mean_chart)},
            {"spread_limits", pair(c.chart->s_chart)},
            {"alarms_by_rule", by_rule},
            {"alarms", alarms_json(s, c)}};
}

json trend_json(const Statistics& s, const Characteristic& c) {
    if (!c.trend) return {};
    const Trend& t = *c.trend;
    json out = {
        {"slope_per_day", t.slope_per_day}, {"slope_limits", pair(t.slope_limits)}, {"level", t.level},
        {"span_days", t.span_days},         {"significant", t.significant},         {"crossing", nullptr}};
    if (!t.crossing) return out;
    const double last = s.production.runs[c.runs.back()].day;
    const auto date = [&](double days) {
        return utc_text(std::llround(86400 * (last + days))).substr(0, 10);
    };
    const Crossing& x = *t.crossing;
    out["crossing"] = {{"limit", x.limit},
                       {"days", x.days},
                       {"date", date(x.days)},
                       {"earliest", date(x.earliest_days)},
                       {"latest", x.latest_days ? json(date(*x.latest_days)) : json()}};
    return out;
}

json characteristic_json(const Statistics& s, const Characteristic& c) {
    const ProcessSummary& r = c.summary;
    json out = {{"id", c.key},
                {"name", c.name},
                {"unit", c.unit},
                {"worst_point", c.worst_point},
                {"n", r.n},
                {"mean", r.mean},
                {"mean_limits", pair(r.mean_limits)},
                {"s", r.s},
                {"sigma_within", r.sigma_within},
                {"median", r.median},
                {"lowest", r.lowest},
                {"highest", r.highest},
                {"limits", json::array({number(c.limits.lower), number(c.limits.upper)})},
                {"beyond", r.beyond},
                {"correlation", r.correlation},
                {"normal_p", number(r.normal_p)},
                {"pp", index_json(r.total.spread)},
                {"ppk", index_json(r.total.worst_side)},
                {"cp", index_json(r.within.spread)},
                {"cpk", index_json(r.within.worst_side)},
                {"by_quantiles", nullptr},
                {"chart", chart_json(s, c)},
                {"ewma", nullptr},
                {"trend", trend_json(s, c)},
                {"caveats", c.caveats}};
    if (c.values.size() < static_cast<std::size_t>(r.n)) out["newest"] = c.values.size();
    if (r.by_quantiles)
        out["by_quantiles"] = {{"pp", index_json(r.by_quantiles->spread, false)},
                               {"ppk", index_json(r.by_quantiles->worst_side, false)}};
    if (c.ewma) {
        json beyond = json::array();
        for (const std::size_t i : c.ewma->beyond)
            beyond.push_back(s.production.runs[c.runs[i]].values.number);
        out["ewma"] = {
            {"last", c.ewma->z.back()},
            {"limits", pair({r.mean - c.ewma->half_width.back(), r.mean + c.ewma->half_width.back()})},
            {"beyond", c.ewma->beyond.size()},
            {"beyond_now", !c.ewma->beyond.empty() && c.ewma->beyond.back() + 1 == c.values.size()},
            {"runs_beyond", std::move(beyond)}};
    }
    return out;
}

}  // namespace

nlohmann::json statistics_json(const Statistics& s) {
    json files = json::array(), regions = json::array(), unmeasured = json::array(), status = json::object();
    for (const ProductionFile& file : s.production.files) files.push_back(file.path.string());
    for (std::size_t i = 0; i < s.by_status.size(); ++i)
        if (s.by_status[i] > 0) status[std::string(to_string(static_cast<RunStatus>(i)))] = s.by_status[i];
    for (const RegionStatistics& r : s.regions) {
        json list = json::array(), refusals = json::array();
        for (const Characteristic& c : r.characteristics) list.push_back(characteristic_json(s, c));
        for (const RefusalReason& why : r.refusals)
            refusals.push_back({{"pattern", why.pattern},
                                {"count", why.count},
                                {"first", why.first},
                                {"last_utc", why.last_utc}});
        regions.push_back({{"id", r.id},
                           {"kind", r.panel ? "panel" : "region"},
                           {"runs", r.runs},
                           {"passed", r.passed},
                           {"over_limit", r.over_limit},
                           {"left_out", r.left_out},
                           {"characteristics", std::move(list)},
                           {"refusals", std::move(refusals)}});
    }
    for (const UnmeasuredSpot& u : s.unmeasured)
        unmeasured.push_back({{"spot", u.spot_id}, {"status", to_string(u.status)}, {"count", u.count}});
    json cycle;
    if (s.cycle)
        cycle = {{"n", s.cycle->n},
                 {"mean_s", s.cycle->mean_s},
                 {"s_s", s.cycle->s_s},
                 {"median_s", s.cycle->median_s},
                 {"p95_s", s.cycle->p95_s},
                 {"longest_s", s.cycle->longest_s},
                 {"median_between_starts_s", s.cycle->between_s}};
    const bool none = s.parts == 0;
    json out = {{"status", none ? "no_production" : "ok"},
                {"files", std::move(files)},
                {"first_utc", none ? json() : json(s.first_utc)},
                {"last_utc", none ? json() : json(s.last_utc)},
                {"runs", s.parts},
                {"by_status", std::move(status)},
                {"left_out",
                 {{"proofs", s.production.proofs},
                  {"studies", s.production.studies},
                  {"unfinished", s.production.unfinished}}},
                {"setups", s.production.setups},
                {"regions", std::move(regions)},
                {"unmeasured", std::move(unmeasured)},
                {"cycle", std::move(cycle)},
                {"caveats", s.caveats}};
    if (s.diagnosis) out["diagnosis"] = diagnosis_json(*s.diagnosis);
    if (!s.by_type.empty()) out["by_type"] = s.by_type;
    return out;
}

}  // namespace seamwright
