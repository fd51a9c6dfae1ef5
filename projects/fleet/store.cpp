#include "projects/fleet/store.h"

#include <fmt/format.h>

#include "projects/file/chain/sha256.h"
#include "projects/fleet/fleet_schema.h"
#include "projects/fleet/sums.h"

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

// The station's number; until the transaction ends nobody else publishes for it, or for another one that has some of these runs.
int lock_station(pqxx::transaction_base& work, const std::string& name, const std::string& messages) {
    work.exec_params("INSERT INTO seamwright.station (name) VALUES ($1) ON CONFLICT (name) DO NOTHING", name);
    // In the order of their numbers, so that two never wait for each other.
    const auto rows = work.exec_params(
        "SELECT id, name = $1 FROM seamwright.station WHERE name = $1 OR id IN (SELECT station FROM "
        "seamwright.run WHERE uid IN (SELECT decode(m ->> 'id', 'hex') FROM jsonb_array_elements($2::jsonb) "
        "AS m)) "
        "ORDER BY id FOR NO KEY UPDATE",
        name, messages);
    for (const auto& row : rows)
        if (row[1].as<bool>()) return row[0].as<int>();
    return 0;  // never: the row is there
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

// Error: no fleet, or one of another version than this program's.
Expected<void> check_version(pqxx::transaction_base& work, const FleetTarget& target) {
    const auto version = schema_version(work);
    if (!version)
        return device_error("the database has no fleet", target.name(),
                            "make it: seamwright fleet init --to URL");
    if (*version > fleet_schema_version())
        return device_error(Text("the fleet's schema has version {}, this program knows up to {}", *version,
                                 fleet_schema_version()),
                            target.name(), "use a newer Seamwright");
    if (*version < fleet_schema_version())
        return device_error(Text("the fleet's schema has version {}, this program needs {}", *version,
                                 fleet_schema_version()),
                            target.name(), "bring it up to date: seamwright fleet init --to URL");
    return {};
}

Expected<void> take_all(pqxx::connection& connection, const FleetTarget& target, const std::string& station,
                        const std::string& setup, std::span<const Outgoing> batch) {
    std::string messages = "[";
    for (const Outgoing& out : batch) messages += (messages.size() > 1 ? "," : "") + out.message;
    messages += "]";
    pqxx::work work(connection);
    SEAM_OK(check_version(work, target));  // it may have become another one since the connection was made
    const int station_id = lock_station(work, station, messages);
    const int setup_id = setup_of(work, setup);
    std::vector<std::int64_t> changed;
    for (const auto& row : work.exec_params(kRuns, messages, station_id, setup_id))
        changed.push_back(row[0].as<std::int64_t>());
    if (!changed.empty()) {
        const std::string ids = array_of(changed);
        // A run that another station's copy of the file brought in the meantime.
        work.exec_params(
            "SELECT id FROM seamwright.station WHERE id IN (SELECT station FROM seamwright.run WHERE id = "
            "ANY "
            "($1::bigint[])) ORDER BY id FOR NO KEY UPDATE",
            ids);
        for (const char* table : {"result", "refusal", "unmeasured"})
            work.exec_params(fmt::format("DELETE FROM seamwright.{} WHERE run = ANY ($1::bigint[])", table),
                             ids);
        work.exec_params(kKeys, messages);
        for (const char* insert : {kResults, kRefusals, kUnmeasured}) work.exec_params(insert, messages, ids);
        update_sums(work, ids);
    }
    work.exec_params("UPDATE seamwright.station SET published = now() WHERE id = $1", station_id);
    work.commit();
    return {};
}

}  // namespace

Expected<Store> Store::connect(const FleetTarget& target) {
    SEAM_TRY(auto connection, fleet::connect(target));
    return guarded(target, [&]() -> Expected<Store> {
        {
            pqxx::nontransaction work(*connection);
            SEAM_OK(check_version(work, target));
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
                SEAM_OK(take_all(*connection_, target_, station, setup,
                                 std::span(batch).subspan(from, to - from)));
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

}  // namespace seamwright::fleet
