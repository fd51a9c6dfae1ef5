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
#include "projects/fleet/store.h"

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
    auto operator<=>(const Key&) const = default;
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
    Reader(pqxx::transaction_base& work, const FleetTarget& target, const FleetStatisticsOptions& options)
        : work_(work), target_(target), options_(options), runs_(options.statistics.runs) {}

    Expected<Statistics> read() {
        SEAM_OK(stations());
        split_days();
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

    // What lies between $n and the one after it.
    std::string in_time(const char* column) const {
        return fmt::format(
            "{0} IS NOT NULL AND ($2::text = '' OR {0} >= $2::text::timestamptz) AND ($3::text = '' OR {0} < "
            "$3::text::timestamptz)",
            column);
    }
    // With $1 stations, $2 since, $3 until, $4 type.
    template <class... More>
    pqxx::result ask(const std::string& sql, const More&... more) {
        return work_.exec_params(sql, array_of(ids_), runs_.since_utc, runs_.until_utc, runs_.type_id,
                                 more...);
    }

    // Days whose sums are there and lie in the time as a whole; of all others the windows to be summed.
    void split_days() {
        for (const auto& row :
             ask("SELECT station, day, d.done AND ($2::text = '' OR day_from >= $2::text::timestamptz) AND "
                 "($3::text = '' OR "
                 "day_until <= $3::text::timestamptz), greatest(day_from, nullif($2::text, "
                 "'')::timestamptz), "
                 "least(day_until, nullif($3::text, '')::timestamptz) FROM (SELECT station, day, done, "
                 "day::timestamp AT "
                 "TIME ZONE 'UTC' AS day_from, (day + 1)::timestamp AT TIME ZONE 'UTC' AS day_until FROM "
                 "seamwright.station_day WHERE station = ANY ($1::int[])) AS d WHERE ($2::text = '' OR "
                 "day_until > "
                 "$2::text::timestamptz) AND ($3::text = '' OR day_from < $3::text::timestamptz) AND "
                 "$4::text IS NOT NULL "
                 "ORDER BY station, day")) {
            const std::int64_t station = whole(row[0]);
            if (yes(row[2])) {
                whole_stations_.push_back(station);
                whole_days_.emplace_back(row[1].c_str());
            } else {
                window_stations_.push_back(station);
                window_from_.emplace_back(row[3].c_str());
                window_until_.emplace_back(row[4].c_str());
            }
        }
    }

    pqxx::result of_days(const std::string& columns, const char* table) {
        return work_.exec_params(
            fmt::format(
                "SELECT t.station, t.day::timestamp AT TIME ZONE 'UTC', t.panel, t.region, t.type, {} FROM "
                "unnest($1::int[], $2::date[]) AS w(station, day) JOIN seamwright.{} t USING (station, day) "
                "WHERE "
                "$3::text = '' OR t.type = $3::text",
                columns, table),
            array_of(whole_stations_), array_of(whole_days_), runs_.type_id);
    }
    pqxx::result of_windows(const char* select) {
        return work_.exec_params(select, array_of(window_stations_), array_of(window_from_),
                                 array_of(window_until_), runs_.type_id);
    }

    RegionTotals& totals(bool panel, const std::string& region) {
        return (panel ? totals_.panels : totals_.regions)[region];
    }

    void counts() {
        for (const auto& result :
             {of_days("runs, passed, over_limit, used", "day_counts"), of_windows(fleet::counts_select())})
            for (const auto& row : result) {
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
        for (const auto& result : {of_days("key, n, sx, st, sxx, sxt, stt, pn, px, px0, pt, pt0, pxx, pxt, "
                                           "ptx, ptt, ranges, lowest, highest, "
                                           "first_x, first_t, last_x, last_t",
                                           "day_sums"),
                                   of_windows(fleet::sums_select())})
            for (const auto& row : result) {
                const double day = day_of(row[1]);
                if (!origin) origin = day;
                rows[{yes(row[2]), row[3].c_str(), row[5].c_str(), row[0].c_str(), row[4].c_str()}].push_back(
                    sums_of(row, 6).later_by(day - *origin));
            }
        for (auto& [key, days] : rows) {
            std::ranges::sort(days, {}, [](const RowSums& day) { return day.first.z(); });
            RowSums one;
            for (const RowSums& day : days) one.go_on(day);
            totals(key.panel, key.region).sums[key.key].join(one);
        }
    }

    void runs() {
        std::map<std::int64_t, std::int64_t> cycles;
        std::set<std::pair<std::int64_t, std::int64_t>> setups;  // of a station
        for (const auto& row :
             ask(fmt::format("SELECT status, type, purpose, count(*), "
                             "to_char(min(started), {0}), to_char(max(started), {0}), station, "
                             "made_with FROM seamwright.run WHERE station = ANY ($1::int[]) AND {1} "
                             "AND ($4::text = '' OR type = $4::text) GROUP BY status, type, purpose, "
                             "station, made_with",
                             kUtc, in_time("started")))) {
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
        const std::string production = fmt::format(
            "station = ANY ($1::int[]) AND {} AND ($4::text = '' OR type = $4::text) AND purpose = 0 AND "
            "status NOT IN "
            "('cancelled', 'interrupted')",
            in_time("started"));
        for (const auto& row :
             ask("SELECT cycle_ms, count(*) FROM seamwright.run WHERE cycle_ms IS NOT NULL AND " +
                 production + " GROUP BY cycle_ms ORDER BY cycle_ms"))
            cycles[whole(row[0])] = whole(row[1]);
        cycle(cycles);
        if (!totals_.cycle) return;
        // From start to start of the newest parts of each station.
        for (const auto& row : ask(fmt::format("SELECT percentile_disc(0.5) WITHIN GROUP (ORDER BY gap) FROM "
                                               "(SELECT extract(epoch FROM started - lag(started) "
                                               "OVER (PARTITION BY station ORDER BY started))::float8 AS gap "
                                               "FROM unnest($1::int[]) AS s(id) CROSS JOIN "
                                               "LATERAL (SELECT station, started FROM seamwright.run WHERE "
                                               "station = s.id AND {} ORDER BY started DESC LIMIT "
                                               "{}) AS r) AS g",
                                               production, kNewestParts)))
            totals_.cycle->between_s = number(row[0]);
    }

    // By how many runs each number of milliseconds was taken.
    void cycle(const std::map<std::int64_t, std::int64_t>& times) {
        CycleTime c;
        double sum = 0;
        std::int64_t n = 0;
        for (const auto& [ms, runs] : times) {
            n += runs;
            sum += static_cast<double>(ms * runs);
        }
        if (n == 0) return;
        c.n = static_cast<int>(n);
        c.mean_s = sum / static_cast<double>(n) / 1e3;
        double squares = 0;
        std::int64_t below = 0;
        const std::int64_t last = n - 1, middle = last / 2, high = (95 * last + 99) / 100;
        for (const auto& [ms, runs] : times) {
            const double s = static_cast<double>(ms) / 1e3;
            squares += static_cast<double>(runs) * (s - c.mean_s) * (s - c.mean_s);
            if (below <= middle && middle < below + runs) c.median_s = s;
            if (below <= high && high < below + runs) c.p95_s = s;
            below += runs;
            c.longest_s = s;
        }
        if (n > 1) c.s_s = std::sqrt(squares / static_cast<double>(n - 1));
        totals_.cycle = c;
    }

    std::string of_production() const {
        return fmt::format(
            "production AND station = ANY ($1::int[]) AND {} AND ($4::text = '' OR type = $4::text)",
            in_time("started"));
    }

    void refusals() {
        for (const auto& row : ask(fmt::format("SELECT panel, region, pattern, count(*), "
                                               "to_char(max(started), {}), (array_agg(body ORDER BY started, "
                                               "run))[1] FROM seamwright.refusal WHERE {} GROUP BY panel, "
                                               "region, pattern ORDER BY min(started)",
                                               kUtc, of_production())))
            totals(yes(row[0]), row[1].c_str())
                .refusals.push_back(
                    {row[2].c_str(), text_from_stored(row[5].c_str()), count(row[3]), row[4].c_str()});
    }

    void unmeasured() {
        for (const auto& row : ask("SELECT spot, status, count(*) FROM seamwright.unmeasured WHERE " +
                                   of_production() + " GROUP BY spot, status ORDER BY min(started)"))
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
        for (const auto& row :
             ask(fmt::format(
                     "SELECT r.id, r.station, r.number, r.part, r.type, to_char(r.started, {0}), "
                     "coalesce(to_char(r.finished, {0}), ''), r.push, r.status, s.passed, s.numbers, s.vals, "
                     "CASE WHEN s.panel THEN to_jsonb(m.keys) END FROM (SELECT * FROM seamwright.result "
                     "WHERE panel = "
                     "$5 AND region = $6 AND used AND {1} ORDER BY started DESC, run DESC LIMIT {2}) AS s "
                     "JOIN "
                     "seamwright.run r ON r.id = s.run JOIN seamwright.measurands m ON m.id = s.measurands",
                     kUtc, of_production(), kNewestParts),
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

    Expected<int> beyond(const std::string& id, bool panel, const std::string& key,
                         const ProcessLimits& limits) {
        const auto bound = [](const std::optional<double>& limit, const char* none) {
            return limit ? fmt::format("{}", *limit) : std::string(none);
        };
        const auto rows = ask(
            "SELECT count(*) FROM seamwright.result s JOIN seamwright.measurands m ON m.id = s.measurands "
            "CROSS JOIN LATERAL (SELECT s.vals[array_position(m.keys, $7)] AS x) AS v WHERE panel = $5 AND "
            "region = $6 AND used AND (x < $8::float8 OR x > $9::float8) AND " +
                of_production(),
            panel, id, key, bound(limits.lower, "-Infinity"), bound(limits.upper, "Infinity"));
        return count(rows[0][0]);
    }

    pqxx::transaction_base& work_;
    const FleetTarget& target_;
    const FleetStatisticsOptions& options_;
    const RunValuesWanted& runs_;
    Production production_;
    ProductionTotals totals_;
    std::map<std::int64_t, std::size_t> place_;  // in Production::files, by the station's number
    std::vector<std::int64_t> ids_, whole_stations_, window_stations_;
    std::vector<std::string> whole_days_, window_from_, window_until_;
};

}  // namespace

Expected<Statistics> fleet_statistics(const FleetTarget& target, const FleetStatisticsOptions& options) {
    SEAM_OK(check_statistics_options(options.statistics));
    SEAM_TRY(auto store, fleet::Store::connect(target));
    return fleet::guarded(target, [&]() -> Expected<Statistics> {
        // All queries see the same instant.
        pqxx::transaction<pqxx::isolation_level::repeatable_read, pqxx::readwrite_policy::read_only> work(
            store.connection());
        return Reader(work, target, options).read();
    });
}

}  // namespace seamwright
