#include "projects/fleet/fleet_schema.h"

#include <array>

#include "projects/fleet/connection.h"
#include "projects/fleet/sums.h"

namespace seamwright {
namespace {

constexpr const char* kVersion1 = R"sql(
CREATE TABLE seamwright.station (
    id int GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    name text NOT NULL UNIQUE,
    published timestamptz
);
CREATE TABLE seamwright.setup (
    id int GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    digest bytea NOT NULL UNIQUE,
    body text NOT NULL
);
CREATE TABLE seamwright.measurands (
    id int GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    digest bytea NOT NULL UNIQUE,
    keys text[] NOT NULL
);
CREATE TABLE seamwright.run (
    id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    uid bytea NOT NULL UNIQUE CHECK (octet_length(uid) = 32),
    revision bigint NOT NULL,
    station int NOT NULL REFERENCES seamwright.station,
    setup int NOT NULL REFERENCES seamwright.setup,
    number bigint NOT NULL,
    made_with bigint NOT NULL,
    part text NOT NULL,
    type text NOT NULL,
    started timestamptz,
    finished timestamptz,
    cycle_ms bigint,
    push boolean NOT NULL,
    status text NOT NULL,
    purpose smallint NOT NULL,
    message_key text NOT NULL,
    message text NOT NULL,
    published timestamptz NOT NULL DEFAULT now()
);
CREATE INDEX run_by_time ON seamwright.run (station, started DESC);
CREATE TABLE seamwright.result (
    run bigint NOT NULL REFERENCES seamwright.run ON DELETE CASCADE,
    position int NOT NULL,
    station int NOT NULL,
    started timestamptz,
    type text NOT NULL,
    production boolean NOT NULL,
    panel boolean NOT NULL,
    region text NOT NULL,
    passed boolean NOT NULL,
    status text,
    used boolean NOT NULL,
    numbers float8[],
    sigma float8[],
    measurands int NOT NULL REFERENCES seamwright.measurands,
    vals float8[] NOT NULL,
    PRIMARY KEY (run, position)
);
COMMENT ON COLUMN seamwright.result.numbers IS 'displacement: X Y Z (mm), A B C (degree)';
COMMENT ON COLUMN seamwright.result.sigma IS 'standard deviations of numbers';
CREATE INDEX result_by_time ON seamwright.result (station, started);
CREATE INDEX result_newest ON seamwright.result (panel, region, started DESC, run DESC) WHERE used AND production;
CREATE TABLE seamwright.refusal (
    run bigint NOT NULL REFERENCES seamwright.run ON DELETE CASCADE,
    position int NOT NULL,
    station int NOT NULL,
    started timestamptz,
    type text NOT NULL,
    production boolean NOT NULL,
    panel boolean NOT NULL,
    region text NOT NULL,
    pattern text NOT NULL,
    english text NOT NULL,
    body text NOT NULL,
    PRIMARY KEY (run, position)
);
CREATE TABLE seamwright.unmeasured (
    run bigint NOT NULL REFERENCES seamwright.run ON DELETE CASCADE,
    position int NOT NULL,
    station int NOT NULL,
    started timestamptz,
    type text NOT NULL,
    production boolean NOT NULL,
    spot text NOT NULL,
    status text NOT NULL,
    PRIMARY KEY (run, position)
);
CREATE TABLE seamwright.station_day (
    station int NOT NULL REFERENCES seamwright.station,
    day date NOT NULL,
    done boolean NOT NULL,
    PRIMARY KEY (station, day)
);
CREATE TABLE seamwright.day_counts (
    station int NOT NULL,
    day date NOT NULL,
    panel boolean NOT NULL,
    region text NOT NULL,
    type text NOT NULL,
    runs bigint NOT NULL,
    passed bigint NOT NULL,
    over_limit bigint NOT NULL,
    used bigint NOT NULL,
    PRIMARY KEY (station, day, panel, region, type)
);
CREATE TABLE seamwright.day_sums (
    station int NOT NULL,
    day date NOT NULL,
    panel boolean NOT NULL,
    region text NOT NULL,
    type text NOT NULL,
    key text NOT NULL,
    n float8 NOT NULL, sx float8, st float8, sxx float8, sxt float8, stt float8,
    pn float8, px float8, px0 float8, pt float8, pt0 float8, pxx float8, pxt float8, ptx float8, ptt float8,
    ranges float8, lowest float8, highest float8,
    first_x float8, first_t float8, last_x float8, last_t float8,
    PRIMARY KEY (station, day, panel, region, type, key)
);
)sql";

// Sums by the hour and kept up to date with every run, where there were those of closed days.
constexpr const char* kVersion2 = R"sql(
DROP TABLE seamwright.station_day;
DROP INDEX seamwright.run_by_time;
CREATE INDEX run_newest ON seamwright.run (station, started DESC NULLS LAST);
CREATE INDEX refusal_by_time ON seamwright.refusal (station, started);
CREATE INDEX unmeasured_by_time ON seamwright.unmeasured (station, started);
CREATE TABLE seamwright.hour_counts (
    station int NOT NULL,
    hour timestamptz NOT NULL,
    panel boolean NOT NULL,
    region text NOT NULL,
    type text NOT NULL,
    runs bigint NOT NULL,
    passed bigint NOT NULL,
    over_limit bigint NOT NULL,
    used bigint NOT NULL,
    PRIMARY KEY (station, hour, panel, region, type)
);
CREATE TABLE seamwright.hour_sums (
    station int NOT NULL,
    hour timestamptz NOT NULL,
    panel boolean NOT NULL,
    region text NOT NULL,
    type text NOT NULL,
    key text NOT NULL,
    n float8 NOT NULL, sx float8, st float8, sxx float8, sxt float8, stt float8,
    pn float8, px float8, px0 float8, pt float8, pt0 float8, pxx float8, pxt float8, ptx float8, ptt float8,
    ranges float8, lowest float8, highest float8,
    first_x float8, first_t float8, last_x float8, last_t float8,
    vals float8[] NOT NULL,
    PRIMARY KEY (station, panel, region, type, key, hour)
);
CREATE INDEX hour_sums_by_hour ON seamwright.hour_sums (station, hour);
COMMENT ON COLUMN seamwright.hour_sums.vals IS 'the values in ascending order';
CREATE TABLE seamwright.day_runs (
    station int NOT NULL,
    day date NOT NULL,
    type text NOT NULL,
    status text NOT NULL,
    purpose smallint NOT NULL,
    made_with bigint NOT NULL,
    runs bigint NOT NULL,
    first timestamptz,
    last timestamptz
);
COMMENT ON COLUMN seamwright.day_runs.day IS '-infinity: runs without a time';
CREATE INDEX day_runs_by_day ON seamwright.day_runs (station, day);
CREATE TABLE seamwright.day_cycles (
    station int NOT NULL,
    day date NOT NULL,
    type text NOT NULL,
    class bigint NOT NULL,
    runs bigint NOT NULL,
    seconds float8 NOT NULL,
    squares float8 NOT NULL,
    longest bigint NOT NULL
);
COMMENT ON COLUMN seamwright.day_cycles.class IS 'milliseconds to three digits';
CREATE INDEX day_cycles_by_day ON seamwright.day_cycles (station, day);
CREATE TABLE seamwright.day_refusals (
    station int NOT NULL,
    day date NOT NULL,
    type text NOT NULL,
    panel boolean NOT NULL,
    region text NOT NULL,
    pattern text NOT NULL,
    refusals bigint NOT NULL,
    first timestamptz NOT NULL,
    last timestamptz NOT NULL,
    body text NOT NULL
);
CREATE INDEX day_refusals_by_day ON seamwright.day_refusals (station, day);
CREATE TABLE seamwright.day_unmeasured (
    station int NOT NULL,
    day date NOT NULL,
    type text NOT NULL,
    spot text NOT NULL,
    status text NOT NULL,
    spots bigint NOT NULL,
    first timestamptz NOT NULL
);
CREATE INDEX day_unmeasured_by_day ON seamwright.day_unmeasured (station, day);
)sql";

constexpr std::array<const char*, 2> kMigrations{kVersion1, kVersion2};
// The newest version after which the sums have to be made anew of the runs.
constexpr int kSumsChanged = 2;
constexpr const char* kLock = "SELECT pg_advisory_xact_lock(8314875026138661223)";  // any number, ours alone

}  // namespace

int fleet_schema_version() {
    return static_cast<int>(kMigrations.size());
}

Expected<FleetInit> init_fleet(const FleetTarget& target) {
    SEAM_TRY(auto connection, fleet::connect(target));
    return fleet::guarded(target, [&]() -> Expected<FleetInit> {
        pqxx::work work(*connection);
        work.exec(kLock);
        FleetInit out;
        out.before = fleet::schema_version(work).value_or(0);
        out.version = fleet_schema_version();
        if (out.before > out.version)
            return device_error(Text("the fleet's schema has version {}, this program knows up to {}",
                                     out.before, out.version),
                                target.name(), "use a newer Seamwright");
        if (out.before == out.version) return out;
        work.exec("SET LOCAL client_min_messages = warning");
        work.exec("CREATE SCHEMA IF NOT EXISTS seamwright");
        work.exec(
            "CREATE TABLE IF NOT EXISTS seamwright.migration (version int PRIMARY KEY, applied timestamptz "
            "NOT "
            "NULL DEFAULT now())");
        // Whoever publishes looks at the version first, and goes on with the one there was or waits for the other.
        work.exec("LOCK TABLE seamwright.migration IN ACCESS EXCLUSIVE MODE");
        for (int version = out.before + 1; version <= out.version; ++version) {
            work.exec(kMigrations[static_cast<std::size_t>(version - 1)]);
            work.exec_params("INSERT INTO seamwright.migration (version) VALUES ($1)", version);
        }
        if (out.before < kSumsChanged) fleet::rebuild_sums(work);
        work.commit();
        return out;
    });
}

}  // namespace seamwright
