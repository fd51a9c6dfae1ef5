#include "projects/fleet/sums.h"

#include <fmt/format.h>

#include <algorithm>

namespace seamwright::fleet {
namespace {

// Windows of time w and the rows in each: "LATERAL ... OFFSET 0" has every window looked up in the index, which the planner, who does
// not know that windows are narrow, would not do.

// One row a value; `more`: further columns of the sums. Squares that the database could not hold, of values that nothing measures,
// would refuse the run: one too small counts as 0, one too large not at all.
std::string sums_of_rows(const std::string& more) {
    return fmt::format(
        R"sql(
SELECT station, from_at, panel, region, type, key, count(*)::float8, sum(x), sum(t), sum(x * x), sum(x * t), sum(t * t),
    count(px)::float8, coalesce(sum(x) FILTER (WHERE px IS NOT NULL), 0), coalesce(sum(px), 0),
    coalesce(sum(t) FILTER (WHERE px IS NOT NULL), 0), coalesce(sum(pt), 0), coalesce(sum(x * px), 0),
    coalesce(sum(x * pt), 0), coalesce(sum(t * px), 0), coalesce(sum(t * pt), 0), coalesce(sum(abs(x - px)), 0), min(x),
    max(x), sum(x) FILTER (WHERE px IS NULL), min(t), sum(x) FILTER (WHERE last), max(t){}
FROM (
    SELECT station, from_at, panel, region, type, key, x, t, lag(x) OVER row AS px, lag(t) OVER row AS pt,
        lead(x) OVER row IS NULL AS last
    FROM (
        SELECT w.station, w.from_at, s.panel, s.region, s.type, u.key, s.run,
            CASE WHEN abs(u.x) < 1e-100 THEN 0 ELSE u.x END AS x,
            extract(epoch FROM s.started - date_trunc('day', w.from_at))::float8 / 86400 AS t
        FROM unnest($1::int[], $2::timestamptz[], $3::timestamptz[]) AS w(station, from_at, until_at)
        CROSS JOIN LATERAL (SELECT * FROM seamwright.result s WHERE s.station = w.station AND s.started >= w.from_at AND
    s.started < w.until_at OFFSET 0) AS s
        JOIN seamwright.measurands m ON m.id = s.measurands
        CROSS JOIN LATERAL unnest(s.vals, m.keys) AS u(x, key)
        WHERE s.production AND s.used AND abs(u.x) <= 1e100 AND ($4::text = '' OR s.type = $4::text)
    ) AS one
    WINDOW row AS (PARTITION BY station, from_at, panel, region, type, key ORDER BY t, run)
) AS two
GROUP BY station, from_at, panel, region, type, key)sql",
        more);
}

// Hours that follow each other, of whose neighbours the ends are two more: RowSums::go_on.
constexpr const char* kDaySums = R"sql(
INSERT INTO seamwright.day_sums (station, day, panel, region, type, key, n, sx, st, sxx, sxt, stt, pn, px, px0, pt, pt0, pxx, pxt,
    ptx, ptt, ranges, lowest, highest, first_x, first_t, last_x, last_t)
SELECT station, day, panel, region, type, key, sum(n), sum(sx), sum(st), sum(sxx), sum(sxt), sum(stt),
    sum(pn) + count(ex), sum(px) + coalesce(sum(first_x) FILTER (WHERE ex IS NOT NULL), 0), sum(px0) + coalesce(sum(ex), 0),
    sum(pt) + coalesce(sum(first_t) FILTER (WHERE ex IS NOT NULL), 0), sum(pt0) + coalesce(sum(et), 0),
    sum(pxx) + coalesce(sum(first_x * ex), 0), sum(pxt) + coalesce(sum(first_x * et), 0),
    sum(ptx) + coalesce(sum(first_t * ex), 0), sum(ptt) + coalesce(sum(first_t * et), 0),
    sum(ranges) + coalesce(sum(abs(first_x - ex)), 0), min(lowest), max(highest),
    sum(first_x) FILTER (WHERE ex IS NULL), min(first_t), sum(last_x) FILTER (WHERE last), max(last_t)
FROM (
    SELECT w.day, h.*, lag(h.last_x) OVER row AS ex, lag(h.last_t) OVER row AS et, lead(h.n) OVER row IS NULL AS last
    FROM unnest($1::int[], $2::date[]) AS w(station, day)
    CROSS JOIN LATERAL (SELECT * FROM seamwright.hour_sums h WHERE h.station = w.station AND h.hour >= w.day AND
    h.hour < w.day + 1 OFFSET 0) AS h
    WINDOW row AS (PARTITION BY h.station, w.day, h.panel, h.region, h.type, h.key ORDER BY h.hour)
) AS hours
GROUP BY station, day, panel, region, type, key)sql";

constexpr const char* kDayCounts = R"sql(
INSERT INTO seamwright.day_counts (station, day, panel, region, type, runs, passed, over_limit, used)
SELECT h.station, w.day, h.panel, h.region, h.type, sum(h.runs), sum(h.passed), sum(h.over_limit), sum(h.used)
FROM unnest($1::int[], $2::date[]) AS w(station, day)
CROSS JOIN LATERAL (SELECT * FROM seamwright.hour_counts h WHERE h.station = w.station AND h.hour >= w.day AND
    h.hour < w.day + 1 OFFSET 0) AS h
GROUP BY h.station, w.day, h.panel, h.region, h.type)sql";

// Runs without a time are those of the day -infinity.
constexpr const char* kDayRuns = R"sql(
INSERT INTO seamwright.day_runs (station, day, type, status, purpose, made_with, runs, first, last)
SELECT r.station, w.day, r.type, r.status, r.purpose, r.made_with, count(*), min(r.started), max(r.started)
FROM unnest($1::int[], $2::date[]) AS w(station, day)
CROSS JOIN LATERAL (SELECT * FROM seamwright.run r WHERE r.station = w.station AND r.started >= w.day AND
    r.started < w.day + 1 OFFSET 0) AS r
WHERE isfinite(w.day)
GROUP BY 1, 2, 3, 4, 5, 6
UNION ALL
SELECT r.station, w.day, r.type, r.status, r.purpose, r.made_with, count(*), NULL, NULL
FROM unnest($1::int[], $2::date[]) AS w(station, day) JOIN seamwright.run r ON r.station = w.station AND r.started IS NULL
WHERE NOT isfinite(w.day)
GROUP BY 1, 2, 3, 4, 5, 6)sql";

std::string day_cycles() {
    return fmt::format(R"sql(
INSERT INTO seamwright.day_cycles (station, day, type, class, runs, seconds, squares, longest)
SELECT r.station, w.day, r.type, {}, count(*), sum(r.cycle_ms / 1e3::float8), sum((r.cycle_ms / 1e3::float8) ^ 2), max(r.cycle_ms)
FROM unnest($1::int[], $2::date[]) AS w(station, day)
CROSS JOIN LATERAL (SELECT * FROM seamwright.run r WHERE r.station = w.station AND r.started >= w.day AND
    r.started < w.day + 1 OFFSET 0) AS r
WHERE r.cycle_ms IS NOT NULL AND r.purpose = 0 AND r.status NOT IN ('cancelled', 'interrupted') AND isfinite(w.day)
GROUP BY 1, 2, 3, 4)sql",
                       cycle_class("r.cycle_ms"));
}

constexpr const char* kDayRefusals = R"sql(
INSERT INTO seamwright.day_refusals (station, day, type, panel, region, pattern, refusals, first, last, body)
SELECT x.station, w.day, x.type, x.panel, x.region, x.pattern, count(*), min(x.started), max(x.started),
    (array_agg(x.body ORDER BY x.started, x.run))[1]
FROM unnest($1::int[], $2::date[]) AS w(station, day)
CROSS JOIN LATERAL (SELECT * FROM seamwright.refusal x WHERE x.station = w.station AND x.started >= w.day AND
    x.started < w.day + 1 OFFSET 0) AS x
WHERE x.production AND isfinite(w.day)
GROUP BY 1, 2, 3, 4, 5, 6)sql";

constexpr const char* kDayUnmeasured = R"sql(
INSERT INTO seamwright.day_unmeasured (station, day, type, spot, status, spots, first)
SELECT x.station, w.day, x.type, x.spot, x.status, count(*), min(x.started)
FROM unnest($1::int[], $2::date[]) AS w(station, day)
CROSS JOIN LATERAL (SELECT * FROM seamwright.unmeasured x WHERE x.station = w.station AND x.started >= w.day AND
    x.started < w.day + 1 OFFSET 0) AS x
WHERE x.production AND isfinite(w.day)
GROUP BY 1, 2, 3, 4, 5)sql";

// Columns: station, hour, the hour's end, day; hour and end are NULL of runs without a time.
void add_up(pqxx::transaction_base& work, const pqxx::result& hours) {
    std::vector<std::int64_t> stations, day_stations;
    std::vector<std::string> from, until, days;
    for (const auto& row : hours) {
        const auto station = row[0].as<std::int64_t>();
        if (!row[1].is_null()) {
            stations.push_back(station);
            from.emplace_back(row[1].c_str());
            until.emplace_back(row[2].c_str());
        }
        if (days.empty() || day_stations.back() != station || days.back() != row[3].c_str()) {
            day_stations.push_back(station);
            days.emplace_back(row[3].c_str());
        }
    }
    const std::string s = array_of(stations), f = array_of(from), u = array_of(until);
    const std::string ds = array_of(day_stations), d = array_of(days);
    for (const char* table : {"hour_counts", "hour_sums"})
        work.exec_params(
            fmt::format(
                "DELETE FROM seamwright.{} t USING unnest($1::int[], $2::timestamptz[]) AS w(station, "
                "hour) WHERE t.station = w.station AND t.hour = w.hour",
                table),
            s, f);
    work.exec_params("INSERT INTO seamwright.hour_counts " + counts_select(), s, f, u, "");
    work.exec_params("INSERT INTO seamwright.hour_sums " + sums_of_rows(", array_agg(x ORDER BY x)"), s, f, u,
                     "");
    for (const char* table :
         {"day_counts", "day_sums", "day_runs", "day_cycles", "day_refusals", "day_unmeasured"})
        work.exec_params(
            fmt::format("DELETE FROM seamwright.{} t USING unnest($1::int[], $2::date[]) AS w(station, day) "
                        "WHERE t.station = w.station AND t.day = w.day",
                        table),
            ds, d);
    for (const std::string& insert : {std::string(kDayCounts), std::string(kDaySums), std::string(kDayRuns),
                                      day_cycles(), std::string(kDayRefusals), std::string(kDayUnmeasured)})
        work.exec_params(insert, ds, d);
}

// Ordered by station and day.
std::string hours_select(const std::string& runs) {
    return fmt::format(
        "SELECT station, hour, hour + interval '1 hour', coalesce(hour::date, '-infinity') FROM (SELECT "
        "DISTINCT "
        "station, date_trunc('hour', started) AS hour FROM seamwright.run WHERE {}) AS h ORDER BY station, "
        "hour",
        runs);
}

}  // namespace

std::string cycle_class(const char* milliseconds) {
    return fmt::format("{0} - {0} % (10 ^ greatest(length({0}::text) - 3, 0))::bigint", milliseconds);
}

std::string counts_select() {
    return R"sql(
SELECT w.station, w.from_at, s.panel, s.region, s.type, count(*), count(*) FILTER (WHERE s.passed),
    count(*) FILTER (WHERE NOT s.passed AND s.status = 'over_limit'), count(*) FILTER (WHERE s.used)
FROM unnest($1::int[], $2::timestamptz[], $3::timestamptz[]) AS w(station, from_at, until_at)
CROSS JOIN LATERAL (SELECT * FROM seamwright.result s WHERE s.station = w.station AND s.started >= w.from_at AND
    s.started < w.until_at OFFSET 0) AS s
WHERE s.production AND ($4::text = '' OR s.type = $4::text)
GROUP BY w.station, w.from_at, s.panel, s.region, s.type)sql";
}

std::string sums_select() {
    return sums_of_rows("");
}

void update_sums(pqxx::transaction_base& work, const std::string& runs) {
    add_up(work, work.exec_params(hours_select("id = ANY ($1::bigint[])"), runs));
}

void rebuild_sums(pqxx::transaction_base& work) {
    work.exec("SET LOCAL TIME ZONE 'UTC'");
    work.exec("SET LOCAL work_mem = '64MB'");
    work.exec(
        "TRUNCATE seamwright.hour_counts, seamwright.hour_sums, seamwright.day_counts, seamwright.day_sums, "
        "seamwright.day_runs, seamwright.day_cycles, seamwright.day_refusals, seamwright.day_unmeasured");
    // A month of a station at a time, so that sorting fits into memory.
    for (const auto& row :
         work.exec("SELECT DISTINCT station, date_trunc('month', started) FROM seamwright.run ORDER BY 1, 2"))
        add_up(work, row[1].is_null()
                         ? work.exec_params(hours_select("station = $1 AND started IS NULL"),
                                            row[0].as<std::int64_t>())
                         : work.exec_params(
                               hours_select("station = $1 AND started >= $2::timestamptz AND started < "
                                            "$2::timestamptz + interval '1 month'"),
                               row[0].as<std::int64_t>(), row[1].c_str()));
}

std::string array_of(const std::vector<std::int64_t>& numbers) {
    std::string out = "{";
    for (const std::int64_t n : numbers) out += (out.size() > 1 ? "," : "") + std::to_string(n);
    return out + "}";
}

std::string array_of(const std::vector<std::string>& texts) {
    std::string out = "{";
    for (const std::string& text : texts) {
        out += out.size() > 1 ? ",\"" : "\"";
        for (const char c : text) {
            if (c == '"' || c == '\\') out += '\\';
            out += c;
        }
        out += '"';
    }
    return out + "}";
}

}  // namespace seamwright::fleet
