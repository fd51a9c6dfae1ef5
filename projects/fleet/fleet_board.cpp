#include "projects/fleet/fleet_board.h"

#include <fmt/format.h>

#include <condition_variable>

#include "devices/capture/capture.h"
#include "projects/fleet/store.h"
#include "projects/report/html.h"
#include "projects/report/metrics.h"

namespace seamwright {
namespace {

using fleet::kUtc;
using fleet::whole;
using nlohmann::json;

constexpr int kShownParts = 30;

// Columns from `c` on: utc, part, type, status, message, number, cycle_ms.
FleetPart part_of(const std::string& station, const pqxx::row& row, int c) {
    return {station,
            row[c].c_str(),
            row[c + 1].c_str(),
            row[c + 2].c_str(),
            row[c + 3].c_str(),
            row[c + 4].c_str(),
            whole(row[c + 5]),
            static_cast<double>(whole(row[c + 6])) / 1e3};
}

json part_json(const FleetPart& p) {
    return {{"utc", p.utc},       {"station", p.station}, {"part", p.part}, {"type", p.type},
            {"status", p.status}, {"message", p.message}, {"run", p.run},   {"seconds", p.seconds}};
}

std::string share(std::int64_t some, std::int64_t all) {
    return all > 0 ? fmt::format("{:.2f}", 100.0 * static_cast<double>(some) / static_cast<double>(all))
                   : "-";
}

}  // namespace

Expected<FleetStanding> fleet_standing(const FleetTarget& target, int newest_parts) {
    SEAM_TRY(auto store, fleet::Store::connect(target));
    return fleet::guarded(target, [&]() -> Expected<FleetStanding> {
        pqxx::nontransaction work(store.connection());
        const std::string newest = fmt::format(
            "coalesce(to_char(started, {}), '') AS utc, part, type, status, message, number, cycle_ms", kUtc);
        FleetStanding out;
        for (const auto& row : work.exec(fmt::format(
                 "SELECT s.name, coalesce(to_char(s.published, {}), ''), coalesce(c.runs, 0), "
                 "coalesce(c.parts, 0), "
                 "coalesce(c.ok, 0), coalesce(c.refused, 0), l.* FROM seamwright.station s LEFT JOIN "
                 "(SELECT station, sum(runs) AS runs, sum(runs) FILTER (WHERE p) AS parts, sum(runs) FILTER "
                 "(WHERE p AND "
                 "status = 'ok') AS ok, sum(runs) FILTER (WHERE p AND status = 'refused') AS refused FROM "
                 "(SELECT "
                 "station, status, runs, purpose = 0 AND status NOT IN ('cancelled', 'interrupted') AS p "
                 "FROM "
                 "seamwright.day_runs) AS r GROUP BY station) AS c ON "
                 "c.station = s.id LEFT JOIN LATERAL (SELECT {} FROM seamwright.run r WHERE r.station = s.id "
                 "ORDER BY started "
                 "DESC NULLS LAST LIMIT 1) AS l ON true ORDER BY s.name",
                 kUtc, newest))) {
            FleetStation s;
            s.name = row[0].c_str();
            s.published_utc = row[1].c_str();
            s.runs = whole(row[2]);
            s.parts = whole(row[3]);
            s.ok = whole(row[4]);
            s.refused = whole(row[5]);
            if (s.runs > 0) s.last = part_of(s.name, row, 6);
            out.stations.push_back(std::move(s));
        }
        if (newest_parts <= 0) return out;
        for (const auto& row :
             work.exec_params(fmt::format("SELECT s.name, l.* FROM seamwright.station s CROSS JOIN LATERAL "
                                          "(SELECT {} FROM seamwright.run r "
                                          "WHERE r.station = s.id AND started IS NOT NULL ORDER BY started "
                                          "DESC NULLS LAST LIMIT $1) AS l ORDER BY "
                                          "l.utc DESC LIMIT $1",
                                          newest),
                              newest_parts))
            out.parts.push_back(part_of(row[0].c_str(), row, 1));
        return out;
    });
}

json fleet_json(const FleetView& v) {
    json out = {{"fleet", v.fleet},
                {"asked_utc", v.asked_utc},
                {"trouble", v.trouble.empty() ? json() : json(v.trouble)},
                {"stations", json::array()}};
    for (const FleetStation& s : v.standing.stations)
        out["stations"].push_back({{"station", s.name},
                                   {"published_utc", s.published_utc},
                                   {"runs", s.runs},
                                   {"parts", s.parts},
                                   {"ok", s.ok},
                                   {"refused", s.refused},
                                   {"last", s.last ? part_json(*s.last) : json()}});
    return out;
}

json fleet_parts_json(const FleetView& v) {
    json list = json::array();
    for (const FleetPart& p : v.standing.parts) list.push_back(part_json(p));
    return list;
}

std::string fleet_metrics(const FleetView& v) {
    report::Metrics m;
    m.head("seamwright_fleet_up", "gauge", "1 while the fleet's database answers.");
    m.value("seamwright_fleet_up", v.trouble.empty() && !v.asked_utc.empty());
    const auto each = [&](const char* name, const char* help, std::int64_t FleetStation::*count) {
        m.head(name, "counter", help);
        for (const FleetStation& s : v.standing.stations)
            m.value(fmt::format("{}{{station=\"{}\"}}", name, report::Metrics::label(s.name)),
                    static_cast<double>(s.*count));
    };
    each("seamwright_fleet_parts_total", "Parts of production.", &FleetStation::parts);
    each("seamwright_fleet_ok_total", "Parts that were corrected.", &FleetStation::ok);
    each("seamwright_fleet_refused_total", "Parts that were refused.", &FleetStation::refused);
    return m.text();
}

std::string fleet_page(const FleetView& v, Language language) {
    const auto t = [&](const char* english, const auto&... arguments) {
        return Text::chosen(english, arguments...).in(language);
    };
    report::Page page(t("Fleet"), std::string(code_of(language)));
    if (!v.trouble.empty())
        page.verdict(t("not asked"), report::Tone::alarm, v.trouble.in(language));
    else if (v.asked_utc.empty())
        page.verdict(t("not asked"), report::Tone::attention);
    else
        page.verdict(t("{} stations", v.standing.stations.size()), report::Tone::good,
                     t("As of {} (UTC).", v.asked_utc.substr(0, 19)));
    report::Rows rows{{t("Station"), t("Parts"), t("Good (%)"), t("Refused (%)"), t("Last part"),
                       t("Time (UTC)"), t("Outcome"), t("Published (UTC)")}};
    for (const FleetStation& s : v.standing.stations) {
        const FleetPart last = s.last.value_or(FleetPart{});
        rows.push_back({s.name, std::to_string(s.parts), share(s.ok, s.parts), share(s.refused, s.parts),
                        last.part, last.utc.substr(0, 19), Text::chosen(last.status).in(language),
                        s.published_utc.substr(0, 19)});
    }
    if (rows.size() > 1) page.table(rows);
    page.heading(t("Last parts"));
    report::Rows parts{
        {t("Time (UTC)"), t("Station"), t("Part"), t("Run"), t("Outcome"), t("Seconds"), t("Message")}};
    for (const FleetPart& p : v.standing.parts)
        parts.push_back({p.utc.substr(0, 19), p.station, p.part, std::to_string(p.run),
                         Text::chosen(p.status).in(language), fmt::format("{:.1f}", p.seconds), p.message});
    if (parts.size() > 1)
        page.table(parts);
    else
        page.paragraph(t("None yet."));
    page.paragraph(fmt::format("{} · {} · {}", v.program, v.fleet, v.now_utc));
    return page.html_again_after(5);
}

FleetBoard::FleetBoard(FleetTarget target, std::string program, std::chrono::milliseconds every)
    : target_(std::move(target)), every_(every) {
    view_.fleet = target_.name();
    view_.program = std::move(program);
    thread_ = std::jthread([this](const std::stop_token& stop) { ask(stop); });
}

FleetView FleetBoard::view() const {
    const std::lock_guard lock(mutex_);
    FleetView view = view_;
    view.now_utc = utc_now();
    return view;
}

void FleetBoard::ask(const std::stop_token& stop) {
    std::condition_variable_any wake;
    std::mutex waiting;
    while (!stop.stop_requested()) {
        auto standing = fleet_standing(target_, kShownParts);
        {
            const std::lock_guard lock(mutex_);
            view_.trouble = standing ? Text() : standing.error().text();
            if (standing) {
                view_.standing = std::move(*standing);
                view_.asked_utc = utc_now();
            }
        }
        std::unique_lock lock(waiting);
        wake.wait_for(lock, stop, every_, [] { return false; });
    }
}

}  // namespace seamwright
