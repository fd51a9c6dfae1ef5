#include "projects/fleet/fleet_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/geometry/notation.h"
#include "projects/file/project_json.h"
#include "projects/file/stored_text.h"
#include "projects/fleet/message.h"
#include "projects/fleet/spans.h"
#include "projects/fleet/store.h"
#include "projects/fleet/sums.h"

namespace seamwright {
namespace {

using fleet::array_of;
using fleet::kUtc;
using fleet::number;
using fleet::whole;

int count(const pqxx::field& field) {
    return static_cast<int>(whole(field));
}
bool yes(const pqxx::field& field) {
    return field.c_str()[0] == 't';
}
// "{1.5,NULL,-2}"
std::vector<double> numbers_of(const pqxx::field& field) {
    std::vector<double> out;
    const char* at = field.c_str();
    const char* const end = at + field.size();
    if (at < end && *at == '{') ++at;
    while (at < end) {
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error == std::errc()) {
            out.push_back(value);
            at = next;
        } else {
            if (*at == 'N') out.push_back(std::numeric_limits<double>::quiet_NaN());
            at = std::find(at, end, ',');
        }
        ++at;
    }
    return out;
}

// Of "2024-05-01 06:00:00+00", since 1970.
double day_of(const pqxx::field& field) {
    const auto ms = utc_milliseconds(std::string(field.c_str()).substr(0, 10) + "T00:00:00Z");
    return static_cast<double>(ms.value_or(0)) / 86400e3;
}

struct Key {
    bool panel = false;
    std::string region, key, station, type;
    auto operator<=>(const Key&) const = default;  // NOLINT(modernize-use-nullptr): no pointer is in it
};

// A day, an hour or what a time cuts of one, in which values may lie beyond limits.
struct Window {
    std::int64_t station = 0;
    std::string type, from;
    enum { rows, hour, day } sums = rows;
    double lowest = 0, highest = 0;
};

// What one query of sums_select() or day_sums says, in its columns from `c` on.
RowSums sums_of(const pqxx::row& row, int c) {
    const auto at = [&](int k) { return number(row[c + k]); };
    RowSums s;
    s.own << at(0), at(1), at(2), at(1), at(3), at(4), at(2), at(4), at(5);
    // Rows: the later one's 1, x, t; columns: the earlier one's.
    s.pairs << at(6), at(8), at(10), at(7), at(11), at(12), at(9), at(13), at(14);
    s.ranges = at(15);
    s.lowest = at(16);
    s.highest = at(17);
    s.first = {1, at(18), at(19)};
    s.last = {1, at(20), at(21)};
    return s;
}

class Reader {
  public:
    Reader(pqxx::transaction_base& work, const FleetStatisticsOptions& options)
        : work_(work), options_(options), runs_(options.statistics.runs) {}

    Expected<Statistics> read() {
        SEAM_TRY(spans_, fleet::spans_of(runs_.since_utc, runs_.until_utc));
        SEAM_OK(stations());
        counts();
        sums();
        runs();
        refusals();
        unmeasured();
        newest();
        totals_.beyond = [this](const std::string& id, bool panel, const std::string& key,
                                const ProcessLimits& limits) { return beyond(id, panel, key, limits); };
        return statistics_of(std::move(production_), options_.statistics, &totals_);
    }

  private:
    // The stations that are wanted, with the setup of their newest run; who published last comes last, and says the limits.
    Expected<void> stations() {
        std::vector<std::string> unknown = options_.stations, known;
        for (const auto& row : work_.exec(
                 "SELECT s.id, s.name, u.body FROM seamwright.station s CROSS JOIN LATERAL (SELECT setup, "
                 "started FROM "
                 "seamwright.run r WHERE r.station = s.id ORDER BY started DESC NULLS LAST LIMIT 1) AS last "
                 "JOIN "
                 "seamwright.setup u ON u.id = last.setup ORDER BY last.started NULLS FIRST, s.name")) {
            const std::string name = row[1].c_str();
            known.push_back(name);
            std::erase(unknown, name);
            if (!options_.stations.empty() &&
                std::ranges::find(options_.stations, name) == options_.stations.end())
                continue;
            SEAM_TRY(auto setup, fleet_setup_from(row[2].c_str(), "station " + name));
            place_[whole(row[0])] = production_.files.size();
            ids_.push_back(whole(row[0]));
            production_.files.push_back({name, std::move(setup.project), std::move(setup.path_points)});
        }
        if (!unknown.empty()) {
            std::string list;
            for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
            return usage_error(Text("there is no station \"{}\"", unknown.front()), "--station",
                               Text("there are: {}", list));
        }
        return {};
    }

    // The stations' windows as the arrays of a query.
    struct Windows {
        std::string stations, from, until;
    };
    Windows windows(const std::vector<fleet::Span>& spans) const {
        std::vector<std::int64_t> stations;
        std::vector<std::string> from, until;
        for (const std::int64_t id : ids_)
            for (const fleet::Span& span : spans) {
                stations.push_back(id);
                from.push_back(fleet::time_text(span.from));
                until.push_back(fleet::time_text(span.until));
            }
        return {array_of(stations), array_of(from), array_of(until)};
    }

    // A query of the whole days' sums (kOfDays) and of the rows of the rest (in_windows).
    pqxx::result ask(const std::string& sql) {
        const Windows rest = windows(spans_.rest_of_days);
        return work_.exec_params(sql, array_of(ids_), spans_.first_day, spans_.end_day, runs_.type_id,
                                 rest.stations, rest.from, rest.until);
    }
    static constexpr const char* kOfDays =
        "station = ANY ($1::int[]) AND day >= $2::date AND day < $3::date AND isfinite(day) AND ($4::text = "
        "'' OR "
        "type = $4::text)";
    // Rows x of a table in the windows; "LATERAL ... OFFSET 0" has each of them looked up in the index.
    static std::string in_windows(const char* table) {
        return fmt::format(
            "unnest($5::int[], $6::timestamptz[], $7::timestamptz[]) AS w(station, from_at, until_at) CROSS "
            "JOIN "
            "LATERAL (SELECT * FROM seamwright.{} x WHERE x.station = w.station AND x.started >= w.from_at "
            "AND "
            "x.started < w.until_at AND ($4::text = '' OR x.type = $4::text) OFFSET 0) AS x",
            table);
    }

    // A query of rows alone, for what is of the newest.
    template <class... More>
    pqxx::result ask_rows(const std::string& sql, const More&... more) {
        return work_.exec_params(sql, array_of(ids_), runs_.since_utc, runs_.until_utc, runs_.type_id,
                                 more...);
    }
    static std::string in_time(const char* more) {
        return fmt::format(
            "station = ANY ($1::int[]) AND started IS NOT NULL AND ($2::text = '' OR started >= "
            "$2::text::timestamptz) AND ($3::text = '' OR started < $3::text::timestamptz) AND ($4::text = "
            "'' OR "
            "type = $4::text) AND {}",
            more);
    }

    // The sums of whole days, of whole hours beside them, and of the rows beside those.
    struct Summed {
        pqxx::result rows;
        decltype(Window::sums) sums;
    };
    std::vector<Summed> summed(const std::string& columns, const std::string& table,
                               const std::string& select) {
        const Windows hours = windows(spans_.hours), rest = windows(spans_.rest_of_hours);
        std::vector<Summed> out;
        out.push_back({work_.exec_params(
                           fmt::format("SELECT station, day::timestamp AT TIME ZONE 'UTC', panel, region, "
                                       "type, {} FROM seamwright.day_{} WHERE {}",
                                       columns, table, kOfDays),
                           array_of(ids_), spans_.first_day, spans_.end_day, runs_.type_id),
                       Window::day});
        const std::string of_hours = fmt::format(R"sql(
SELECT x.station, x.hour, x.panel, x.region, x.type, {}
FROM unnest($1::int[], $2::timestamptz[], $3::timestamptz[]) AS w(station, from_at, until_at)
CROSS JOIN LATERAL (SELECT * FROM seamwright.hour_{} x WHERE x.station = w.station AND x.hour >= w.from_at AND
    x.hour < w.until_at AND ($4::text = '' OR x.type = $4::text) OFFSET 0) AS x)sql",
                                                 columns, table);
        if (!spans_.hours.empty())
            out.push_back(
                {work_.exec_params(of_hours, hours.stations, hours.from, hours.until, runs_.type_id),
                 Window::hour});
        if (!spans_.rest_of_hours.empty())
            out.push_back({work_.exec_params(select, rest.stations, rest.from, rest.until, runs_.type_id),
                           Window::rows});
        return out;
    }

    RegionTotals& totals(bool panel, const std::string& region) {
        return (panel ? totals_.panels : totals_.regions)[region];
    }

    void counts() {
        for (const Summed& part : summed("runs, passed, over_limit, used", "counts", fleet::counts_select()))
            for (const auto& row : part.rows) {
                RegionTotals& r = totals(yes(row[2]), row[3].c_str());
                r.runs += count(row[5]);
                r.passed += count(row[6]);
                r.over_limit += count(row[7]);
                r.left_out += count(row[5]) - count(row[8]);
            }
    }

    // In each station the days follow each other; stations, and types that share a region, do not.
    void sums() {
        std::map<Key, std::vector<RowSums>> rows;
        std::optional<double> origin;
        for (const Summed& part : summed(fleet::kSumColumns, "sums", fleet::sums_select()))
            for (const auto& row : part.rows) {
                const double day = day_of(row[1]);
                if (!origin) origin = day;
                const RowSums sums = sums_of(row, 6);
                const Key key{yes(row[2]), row[3].c_str(), row[5].c_str(), row[0].c_str(), row[4].c_str()};
                rows[key].push_back(sums.later_by(day - *origin));
                windows_[{key.panel, key.region, key.key, {}, {}}].push_back(
                    {whole(row[0]), key.type, row[1].c_str(), part.sums, sums.lowest, sums.highest});
            }
        for (auto& [key, days] : rows) {
            std::ranges::sort(days, {}, [](const RowSums& day) { return day.first.z(); });
            RowSums one;
            for (const RowSums& day : days) one.go_on(day);
            totals(key.panel, key.region).sums[key.key].join(one);
        }
    }

    void runs() {
        std::set<std::pair<std::int64_t, std::int64_t>> setups;  // of a station
        const std::string sql = fmt::format(R"sql(
SELECT status, type, purpose, sum(runs), to_char(min(first), {0}), to_char(max(last), {0}), station, made_with
FROM (SELECT status, type, purpose, station, made_with, runs, first, last FROM seamwright.day_runs WHERE {1}
      UNION ALL SELECT x.status, x.type, x.purpose, x.station, x.made_with, 1, x.started, x.started FROM {2}) AS r
GROUP BY status, type, purpose, station, made_with)sql",
                                            kUtc, kOfDays, in_windows("run"));
        for (const auto& row : ask(sql)) {
            const int n = count(row[3]);
            const auto purpose = static_cast<RunPurpose>(whole(row[2]));
            const auto status = run_status_from(row[0].c_str());
            if (purpose == RunPurpose::proof)
                production_.proofs += n;
            else if (purpose == RunPurpose::study)
                production_.studies += n;
            else if (!status || *status == RunStatus::cancelled || *status == RunStatus::interrupted)
                production_.unfinished += n;
            else {
                totals_.parts += static_cast<std::size_t>(n);
                totals_.by_status[static_cast<std::size_t>(*status)] += n;
                if (row[1].size() > 0) totals_.by_type[row[1].c_str()] += n;
                const std::string first = row[4].c_str(), last = row[5].c_str();
                if (totals_.first_utc.empty() || first < totals_.first_utc) totals_.first_utc = first;
                totals_.last_utc = std::max(totals_.last_utc, last);
                setups.emplace(whole(row[6]), whole(row[7]));
            }
        }
        production_.setups = setups.size();
        cycle();
        if (!totals_.cycle) return;
        // From start to start of the newest parts of each station.
        for (const auto& row : ask_rows(fmt::format(
                 "SELECT percentile_disc(0.5) WITHIN GROUP (ORDER BY gap) FROM (SELECT extract(epoch FROM "
                 "started - "
                 "lag(started) OVER (PARTITION BY station ORDER BY started))::float8 AS gap FROM "
                 "unnest($1::int[]) AS "
                 "s(id) CROSS JOIN LATERAL (SELECT station, started FROM seamwright.run WHERE station = s.id "
                 "AND {} "
                 "ORDER BY started DESC NULLS LAST LIMIT {}) AS r) AS g",
                 in_time("purpose = 0 AND status NOT IN ('cancelled', 'interrupted')"), kNewestParts)))
            totals_.cycle->between_s = number(row[0]);
    }

    // By classes of three digits: mean, scatter and the longest are those of all runs, a quantile is the mean of its class.
    void cycle() {
        struct Class {
            std::int64_t runs;
            double mean_s;
        };
        std::vector<Class> classes;
        CycleTime c;
        double sum = 0, squares = 0;
        std::int64_t n = 0;
        const std::string sql = fmt::format(R"sql(
SELECT class, sum(runs), sum(seconds), sum(squares), max(longest)
FROM (SELECT class, runs, seconds, squares, longest FROM seamwright.day_cycles WHERE {}
      UNION ALL SELECT {}, 1, x.cycle_ms / 1e3::float8, (x.cycle_ms / 1e3::float8) ^ 2, x.cycle_ms FROM {}
      WHERE x.cycle_ms IS NOT NULL AND x.purpose = 0 AND x.status NOT IN ('cancelled', 'interrupted')) AS r
GROUP BY class ORDER BY class)sql",
                                            kOfDays, fleet::cycle_class("x.cycle_ms"), in_windows("run"));
        for (const auto& row : ask(sql)) {
            classes.push_back({whole(row[1]), number(row[2]) / static_cast<double>(whole(row[1]))});
            n += whole(row[1]);
            sum += number(row[2]);
            squares += number(row[3]);
            c.longest_s = static_cast<double>(whole(row[4])) / 1e3;
        }
        if (n == 0) return;
        const auto runs = static_cast<double>(n);
        c.n = static_cast<int>(n);
        c.mean_s = sum / runs;
        if (n > 1) c.s_s = std::sqrt(std::max(0.0, squares - runs * c.mean_s * c.mean_s) / (runs - 1));
        std::int64_t below = 0;
        const std::int64_t last = n - 1, middle = last / 2, high = (95 * last + 99) / 100;
        for (const Class& of : classes) {
            if (below <= middle && middle < below + of.runs) c.median_s = of.mean_s;
            if (below <= high && high < below + of.runs) c.p95_s = of.mean_s;
            below += of.runs;
        }
        totals_.cycle = c;
    }

    void refusals() {
        const std::string sql = fmt::format(R"sql(
SELECT panel, region, pattern, sum(n), to_char(max(last), {0}), (array_agg(body ORDER BY first))[1]
FROM (SELECT panel, region, pattern, refusals AS n, first, last, body FROM seamwright.day_refusals WHERE {1}
      UNION ALL SELECT x.panel, x.region, x.pattern, 1, x.started, x.started, x.body FROM {2} WHERE x.production) AS r
GROUP BY panel, region, pattern ORDER BY min(first))sql",
                                            kUtc, kOfDays, in_windows("refusal"));
        for (const auto& row : ask(sql))
            totals(yes(row[0]), row[1].c_str())
                .refusals.push_back(
                    {row[2].c_str(), text_from_stored(row[5].c_str()), count(row[3]), row[4].c_str()});
    }

    void unmeasured() {
        const std::string sql = fmt::format(R"sql(
SELECT spot, status, sum(n)
FROM (SELECT spot, status, spots AS n, first FROM seamwright.day_unmeasured WHERE {}
      UNION ALL SELECT x.spot, x.status, 1, x.started FROM {} WHERE x.production) AS r
GROUP BY spot, status ORDER BY min(first))sql",
                                            kOfDays, in_windows("unmeasured"));
        for (const auto& row : ask(sql))
            for (const SpotStatus s :
                 {SpotStatus::not_measured, SpotStatus::damaged_frame, SpotStatus::no_stripe,
                  SpotStatus::no_calibration, SpotStatus::no_feature})
                if (to_string(s) == row[1].c_str())
                    totals_.unmeasured.push_back({row[0].c_str(), s, count(row[2])});
    }

    // The runs that hold the newest values of every region and panel job.
    void newest() {
        std::map<std::int64_t, ProductionRun> runs;
        for (const bool panel : {false, true})
            for (const auto& [region, all] : panel ? totals_.panels : totals_.regions)
                if (all.runs > all.left_out) newest_of(panel, region, runs);
        for (auto& [id, run] : runs) production_.runs.push_back(std::move(run));
        std::ranges::stable_sort(production_.runs, {}, [](const ProductionRun& run) { return run.day; });
    }

    void newest_of(bool panel, const std::string& region, std::map<std::int64_t, ProductionRun>& runs) {
        for (const auto& row : ask_rows(
                 fmt::format(
                     "SELECT r.id, r.station, r.number, r.part, r.type, to_char(r.started, {0}), "
                     "coalesce(to_char(r.finished, {0}), ''), r.push, r.status, s.passed, s.numbers, s.vals, "
                     "CASE WHEN s.panel THEN to_jsonb(m.keys) END FROM (SELECT * FROM seamwright.result "
                     "WHERE panel = "
                     "$5 AND region = $6 AND used AND {1} ORDER BY started DESC, run DESC LIMIT {2}) AS s "
                     "JOIN "
                     "seamwright.run r ON r.id = s.run JOIN seamwright.measurands m ON m.id = s.measurands",
                     kUtc, in_time("production"), kNewestParts),
                 panel, region)) {
            ProductionRun& run = runs[whole(row[0])];
            RunValues& v = run.values;
            if (v.number == 0) {
                run.file = place_.at(whole(row[1]));
                v.number = whole(row[2]);
                v.part_id = row[3].c_str();
                v.type_id = row[4].c_str();
                v.started_utc = row[5].c_str();
                v.finished_utc = row[6].c_str();
                v.push = yes(row[7]);
                v.status = run_status_from(row[8].c_str()).value_or(RunStatus::interrupted);
                run.day = static_cast<double>(utc_milliseconds(v.started_utc).value_or(0)) / 86400e3;
            }
            if (panel)
                v.panel = panel_of(region, yes(row[9]), numbers_of(row[11]), row[12].c_str());
            else
                v.regions.push_back(region_of(region, yes(row[9]), numbers_of(row[10])));
        }
    }

    static RegionValue region_of(const std::string& id, bool passed, const std::vector<double>& six) {
        RegionValue r;
        r.region_id = id;
        r.gate_passed = passed;
        r.status = passed ? CorrectionStatus::ok : CorrectionStatus::over_limit;
        if (six.size() == 6)
            r.workobject_from_movedworkobject =
                make_pose(rotation_from_kuka({six[3], six[4], six[5]}), {six[0], six[1], six[2]});
        return r;
    }

    static PanelValue panel_of(const std::string& id, bool passed, const std::vector<double>& values,
                               const std::string& keys) {
        PanelValue p;
        p.job_id = id;
        p.gate_passed = passed;
        const auto list = nlohmann::json::parse(keys, nullptr, false);
        for (std::size_t i = 0; i + 1 < values.size() && i + 1 < list.size(); i += 2) {
            std::string place = list[i].get<std::string>();  // as place_key() makes it
            if (const std::string end = place_key("", true); place.ends_with(end))
                place.resize(place.size() - end.size());
            p.after.push_back({place, values[i], values[i + 1]});
        }
        return p;
    }

    // Only where something lies beyond: of days and hours by search in the hours' sorted values, of the rest in the rows.
    Expected<int> beyond(const std::string& id, bool panel, const std::string& key,
                         const ProcessLimits& limits) {
        const double lower = limits.lower.value_or(-kInfinity), upper = limits.upper.value_or(kInfinity);
        std::vector<std::int64_t> stations, row_stations;
        std::vector<std::string> types, from, until, row_types, row_from, row_until;
        for (const Window& w : windows_[{panel, id, key, {}, {}}]) {
            if (w.lowest >= lower && w.highest <= upper) continue;
            const bool rows = w.sums == Window::rows;
            (rows ? row_stations : stations).push_back(w.station);
            (rows ? row_types : types).push_back(w.type);
            (rows ? row_from : from).push_back(w.from);
            (rows ? row_until : until)
                .push_back(rows                     ? end_of(w)
                           : w.sums == Window::hour ? "1 hour"
                                                    : "1 day");
        }
        // width_bucket counts what is at most its number.
        const auto in_hours = work_.exec_params(
            R"sql(
SELECT coalesce(sum(width_bucket($8::float8, h.vals) + cardinality(h.vals) - width_bucket($9::float8, h.vals)), 0)
FROM unnest($1::int[], $2::text[], $3::timestamptz[], $4::interval[]) AS w(station, type, from_at, long)
CROSS JOIN LATERAL (SELECT * FROM seamwright.hour_sums h WHERE h.station = w.station AND h.panel = $5 AND h.region = $6 AND
    h.type = w.type AND h.key = $7 AND h.hour >= w.from_at AND h.hour < w.from_at + w.long OFFSET 0) AS h
WHERE h.lowest <= $8::float8 OR h.highest > $9::float8)sql",
            array_of(stations), array_of(types), array_of(from), array_of(until), panel, id, key,
            bound(std::nextafter(lower, -kInfinity)), bound(upper));
        const auto in_rows = work_.exec_params(
            R"sql(
SELECT count(*) FROM unnest($1::int[], $2::text[], $3::timestamptz[], $4::timestamptz[]) AS w(station, type, from_at, until_at)
CROSS JOIN LATERAL (SELECT * FROM seamwright.result s WHERE s.station = w.station AND s.type = w.type AND
    s.started >= w.from_at AND s.started < w.until_at AND s.panel = $5 AND s.region = $6 AND s.used AND s.production
    OFFSET 0) AS s
JOIN seamwright.measurands m ON m.id = s.measurands
CROSS JOIN LATERAL (SELECT s.vals[array_position(m.keys, $7)] AS x) AS v
WHERE x < $8::float8 OR x > $9::float8)sql",
            array_of(row_stations), array_of(row_types), array_of(row_from), array_of(row_until), panel, id,
            key, bound(lower), bound(upper));
        return count(in_hours[0][0]) + count(in_rows[0][0]);
    }
    static std::string bound(double limit) {
        return std::isfinite(limit) ? fmt::format("{}", limit) : limit > 0 ? "Infinity" : "-Infinity";
    }
    // Of a window that is no whole hour.
    std::string end_of(const Window& w) const {
        const auto from = utc_milliseconds(w.from.substr(0, 10) + "T" + w.from.substr(11, 8) + "Z");
        for (const fleet::Span& span : spans_.rest_of_hours)
            if (from && span.from / 1000 == *from / 1000) return fleet::time_text(span.until);
        return w.from;
    }

    pqxx::transaction_base& work_;
    const FleetStatisticsOptions& options_;
    const RunValuesWanted& runs_;
    Production production_;
    ProductionTotals totals_;
    std::map<std::int64_t, std::size_t> place_;  // in Production::files, by the station's number
    std::vector<std::int64_t> ids_;
    fleet::Spans spans_;
    std::map<Key, std::vector<Window>> windows_;  // by panel, region and key alone
};

}  // namespace

Expected<Statistics> fleet_statistics(const FleetTarget& target, const FleetStatisticsOptions& options) {
    SEAM_OK(check_statistics_options(options.statistics));
    SEAM_TRY(auto store, fleet::Store::connect(target));
    return fleet::guarded(target, [&]() -> Expected<Statistics> {
        // All queries see the same instant.
        pqxx::transaction<pqxx::isolation_level::repeatable_read, pqxx::readwrite_policy::read_only> work(
            store.connection());
        return Reader(work, options).read();
    });
}

}  // namespace seamwright
