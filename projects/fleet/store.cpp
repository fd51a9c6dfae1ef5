#include "projects/fleet/store.h"

#include <fmt/format.h>

#include "projects/file/chain/sha256.h"
#include "projects/fleet/fleet_schema.h"

namespace seamwright::fleet {
namespace {

// The messages as rows.
constexpr const char* kRuns = R"sql(
INSERT INTO seamwright.run (uid, revision, station, setup, number, made_with, part, type, started, finished, cycle_ms, push,
    status, purpose, message_key, message)
SELECT decode(m.id, 'hex'), m.revision, $2, $3, m.number, m.made_with, m.part, m.type,
    timestamptz 'epoch' + m.started_ms * interval '1 millisecond',
    timestamptz 'epoch' + m.finished_ms * interval '1 millisecond', m.cycle_ms, m.push, m.status, m.purpose, m.message_key,
    m.message
FROM jsonb_to_recordset($1::jsonb) AS m(id text, revision bigint, number bigint, made_with bigint, part text, type text,
    started_ms bigint, finished_ms bigint, cycle_ms bigint, push boolean, status text, purpose smallint, message_key text,
    message text)
ON CONFLICT (uid) DO UPDATE SET revision = excluded.revision, finished = excluded.finished, cycle_ms = excluded.cycle_ms,
    part = excluded.part, status = excluded.status, purpose = excluded.purpose, message_key = excluded.message_key,
    message = excluded.message
WHERE run.revision < excluded.revision
RETURNING id)sql";

constexpr const char* kKeys = R"sql(
INSERT INTO seamwright.measurands (digest, keys)
SELECT DISTINCT ON (x.keys_id) decode(x.keys_id, 'hex'), x.keys
FROM jsonb_array_elements($1::jsonb) AS m,
    jsonb_to_recordset(m -> 'results') AS x(keys_id text, keys text[])
ON CONFLICT (digest) DO NOTHING)sql";

constexpr const char* kResults = R"sql(
INSERT INTO seamwright.result (run, position, station, started, type, production, panel, region, passed, status, used,
    numbers, sigma, measurands, vals)
SELECT r.id, x.position, r.station, r.started, r.type, (m ->> 'production')::boolean, x.panel, x.region, x.passed, x.status,
    x.used, x.numbers, x.sigma, k.id, x.vals
FROM jsonb_array_elements($1::jsonb) AS m
JOIN seamwright.run r ON r.uid = decode(m ->> 'id', 'hex') AND r.id = ANY ($2::bigint[])
CROSS JOIN LATERAL jsonb_to_recordset(m -> 'results') AS x(position int, panel boolean, region text, passed boolean,
    status text, used boolean, numbers float8[], sigma float8[], keys_id text, vals float8[])
JOIN seamwright.measurands k ON k.digest = decode(x.keys_id, 'hex'))sql";

constexpr const char* kRefusals = R"sql(
INSERT INTO seamwright.refusal (run, position, station, started, type, production, panel, region, pattern, english, body)
SELECT r.id, x.position, r.station, r.started, r.type, (m ->> 'production')::boolean, x.panel, x.region, x.pattern,
    x.english, x.body
FROM jsonb_array_elements($1::jsonb) AS m
JOIN seamwright.run r ON r.uid = decode(m ->> 'id', 'hex') AND r.id = ANY ($2::bigint[])
CROSS JOIN LATERAL jsonb_to_recordset(m -> 'refusals') AS x(position int, panel boolean, region text, pattern text,
    english text, body text))sql";

constexpr const char* kUnmeasured = R"sql(
INSERT INTO seamwright.unmeasured (run, position, station, started, type, production, spot, status)
SELECT r.id, x.position, r.station, r.started, r.type, (m ->> 'production')::boolean, x.spot, x.status
FROM jsonb_array_elements($1::jsonb) AS m
JOIN seamwright.run r ON r.uid = decode(m ->> 'id', 'hex') AND r.id = ANY ($2::bigint[])
CROSS JOIN LATERAL jsonb_to_recordset(m -> 'unmeasured') AS x(position int, spot text, status text))sql";

constexpr const char* kDays = R"sql(
INSERT INTO seamwright.station_day (station, day, done)
SELECT DISTINCT station, (started AT TIME ZONE 'UTC')::date, false FROM seamwright.run
WHERE id = ANY ($1::bigint[]) AND started IS NOT NULL
ON CONFLICT (station, day) DO UPDATE SET done = false)sql";

// The station's number; until the transaction ends nobody else publishes for it or closes its days.
int lock_station(pqxx::transaction_base& work, const std::string& name) {
    work.exec_params("INSERT INTO seamwright.station (name) VALUES ($1) ON CONFLICT (name) DO NOTHING", name);
    return work.exec_params1("SELECT id FROM seamwright.station WHERE name = $1 FOR NO KEY UPDATE", name)[0]
        .as<int>();
}

int setup_of(pqxx::transaction_base& work, const std::string& setup) {
    const std::string digest = hex(sha256(setup));
    work.exec_params(
        "INSERT INTO seamwright.setup (digest, body) VALUES (decode($1, 'hex'), $2) ON CONFLICT (digest) DO "
        "NOTHING",
        digest, setup);
    return work.exec_params1("SELECT id FROM seamwright.setup WHERE digest = decode($1, 'hex')", digest)[0]
        .as<int>();
}

void take_all(pqxx::connection& connection, const std::string& station, const std::string& setup,
              std::span<const Outgoing> batch) {
    std::string messages = "[";
    for (const Outgoing& out : batch) messages += (messages.size() > 1 ? "," : "") + out.message;
    messages += "]";
    pqxx::work work(connection);
    const int station_id = lock_station(work, station);
    const int setup_id = setup_of(work, setup);
    std::vector<std::int64_t> changed;
    for (const auto& row : work.exec_params(kRuns, messages, station_id, setup_id))
        changed.push_back(row[0].as<std::int64_t>());
    if (!changed.empty()) {
        const std::string ids = array_of(changed);
        for (const char* table : {"result", "refusal", "unmeasured"})
            work.exec_params(fmt::format("DELETE FROM seamwright.{} WHERE run = ANY ($1::bigint[])", table),
                             ids);
        work.exec_params(kKeys, messages);
        for (const char* insert : {kResults, kRefusals, kUnmeasured}) work.exec_params(insert, messages, ids);
        work.exec_params(kDays, ids);
    }
    work.exec_params("UPDATE seamwright.station SET published = now() WHERE id = $1", station_id);
    work.commit();
}

}  // namespace

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

Expected<Store> Store::connect(const FleetTarget& target) {
    SEAM_TRY(auto connection, fleet::connect(target));
    return guarded(target, [&]() -> Expected<Store> {
        {
            pqxx::nontransaction work(*connection);
            const auto version = schema_version(work);
            if (!version)
                return device_error("the database has no fleet", target.name(),
                                    "make it: seamwright fleet init --to URL");
            if (*version > fleet_schema_version())
                return device_error(Text("the fleet's schema has version {}, this program knows up to {}",
                                         *version, fleet_schema_version()),
                                    target.name(), "use a newer Seamwright");
            if (*version < fleet_schema_version())
                return device_error(Text("the fleet's schema has version {}, this program needs {}", *version,
                                         fleet_schema_version()),
                                    target.name(), "bring it up to date: seamwright fleet init --to URL");
            work.exec("SET TIME ZONE 'UTC'");
            work.exec("SET extra_float_digits = 1");
        }
        return Store(target, std::move(connection));
    });
}

Expected<Store::Taken> Store::take(const std::string& station, const std::string& setup,
                                   const std::vector<Outgoing>& batch) {
    Taken taken;
    // What the database refuses is found by halves, so that the rest of a batch does not wait for it.
    std::vector<std::pair<std::size_t, std::size_t>> parts{{0, batch.size()}};
    return guarded(target_, [&]() -> Expected<Taken> {
        while (!parts.empty()) {
            const auto [from, to] = parts.back();
            parts.pop_back();
            if (from == to) continue;
            try {
                take_all(*connection_, station, setup, std::span(batch).subspan(from, to - from));
                for (std::size_t i = from; i < to; ++i) taken.runs.push_back(batch[i].run);
            } catch (const std::exception& e) {
                if (!refuses_data(e)) throw;
                if (to - from == 1) {
                    taken.refused.emplace_back(batch[from].run.run, error_of(e, target_));
                    continue;
                }
                const std::size_t middle = from + (to - from) / 2;
                parts.emplace_back(middle, to);
                parts.emplace_back(from, middle);
            }
        }
        return std::move(taken);
    });
}

const char* counts_select() {
    return R"sql(
SELECT w.station, w.from_at, s.panel, s.region, s.type, count(*), count(*) FILTER (WHERE s.passed),
    count(*) FILTER (WHERE NOT s.passed AND s.status = 'over_limit'), count(*) FILTER (WHERE s.used)
FROM unnest($1::int[], $2::timestamptz[], $3::timestamptz[]) AS w(station, from_at, until_at)
JOIN seamwright.result s ON s.station = w.station AND s.started >= w.from_at AND s.started < w.until_at
WHERE s.production AND ($4::text = '' OR s.type = $4::text)
GROUP BY w.station, w.from_at, s.panel, s.region, s.type)sql";
}

const char* sums_select() {
    return R"sql(
SELECT station, from_at, panel, region, type, key, count(*)::float8, sum(x), sum(t), sum(x * x), sum(x * t), sum(t * t),
    count(px)::float8, coalesce(sum(x) FILTER (WHERE px IS NOT NULL), 0), coalesce(sum(px), 0),
    coalesce(sum(t) FILTER (WHERE px IS NOT NULL), 0), coalesce(sum(pt), 0), coalesce(sum(x * px), 0),
    coalesce(sum(x * pt), 0), coalesce(sum(t * px), 0), coalesce(sum(t * pt), 0), coalesce(sum(abs(x - px)), 0), min(x),
    max(x), sum(x) FILTER (WHERE px IS NULL), min(t), sum(x) FILTER (WHERE last), max(t)
FROM (
    SELECT station, from_at, panel, region, type, key, x, t, lag(x) OVER row AS px, lag(t) OVER row AS pt,
        lead(x) OVER row IS NULL AS last
    FROM (
        SELECT w.station, w.from_at, s.panel, s.region, s.type, u.key, u.x, s.run,
            extract(epoch FROM s.started - date_trunc('day', w.from_at))::float8 / 86400 AS t
        FROM unnest($1::int[], $2::timestamptz[], $3::timestamptz[]) AS w(station, from_at, until_at)
        JOIN seamwright.result s ON s.station = w.station AND s.started >= w.from_at AND s.started < w.until_at
        JOIN seamwright.measurands m ON m.id = s.measurands
        CROSS JOIN LATERAL unnest(s.vals, m.keys) AS u(x, key)
        WHERE s.production AND s.used AND u.x IS NOT NULL AND ($4::text = '' OR s.type = $4::text)
    ) AS one
    WINDOW row AS (PARTITION BY station, from_at, panel, region, type, key ORDER BY t, run)
) AS two
GROUP BY station, from_at, panel, region, type, key)sql";
}

Expected<void> Store::close_days(const std::string& station) {
    return guarded(target_, [&]() -> Expected<void> {
        std::vector<std::string> days;
        {
            pqxx::work work(*connection_);
            for (const auto& row :
                 work.exec_params("SELECT day FROM seamwright.station_day JOIN seamwright.station ON station "
                                  "= id WHERE name = $1 AND NOT "
                                  "done AND day < (SELECT max(day) FROM seamwright.station_day o WHERE "
                                  "o.station = station_day.station) "
                                  "ORDER BY day",
                                  station))
                days.push_back(row[0].c_str());
        }
        for (const std::string& day : days) {
            pqxx::work work(*connection_);
            const int id = lock_station(work, station);
            for (const char* table : {"day_counts", "day_sums"})
                work.exec_params(
                    fmt::format("DELETE FROM seamwright.{} WHERE station = $1 AND day = $2::date", table), id,
                    day);
            const std::string stations = array_of(std::vector<std::int64_t>{id});
            const std::string from = fmt::format("{{\"{} 00:00:00+00\"}}", day);
            const std::string until =
                work.exec_params1("SELECT ARRAY[(($1::date + 1)::timestamp AT TIME ZONE 'UTC')]::text",
                                  day)[0]
                    .c_str();
            work.exec_params(std::string("INSERT INTO seamwright.day_counts ") + counts_select(), stations,
                             from, until, "");
            work.exec_params(std::string("INSERT INTO seamwright.day_sums ") + sums_select(), stations, from,
                             until, "");
            work.exec_params(
                "UPDATE seamwright.station_day SET done = true WHERE station = $1 AND day = $2::date", id,
                day);
            work.commit();
        }
        return {};
    });
}

}  // namespace seamwright::fleet
