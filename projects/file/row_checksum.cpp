#include "projects/file/row_checksum.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>

namespace seamwright {
namespace {

constexpr std::array<ChecksummedTable, 28> kTables{{
    {"project", "name", "id, name, created_utc"},
    {"requirements", "id", "id, body"},
    {"part", "id", "id, body, mesh"},
    {"sensors", "id", "id, position, driver, body"},
    {"robots", "id", "id, position, driver, body"},
    {"calibrations", "id", "id, position, sensor_id, robot_id, created_utc, verdict, body"},
    {"spots", "id", "id, position, sensor_id, robot_id, body, reference_profile, template_profile"},
    {"regions", "id", "id, position, frame_name, body"},
    {"panel_jobs", "id", "id, position, frame_name, body"},
    {"line", "id", "id, position, protocol, body", 7},
    {"part_types", "id", "id, position, body", 8},
    {"run_types", "run", "run, type_id", 8},
    {"elastic", "id", "id, position, body", 9},
    {"drift_watch", "id", "id, position, body", 10},
    {"drift_points", "id", "id, run, body", 10},
    {"users", "id", "id, role, password, created_utc", 12},
    {"fixture", "id", "id, position, body", 12},
    {"scans", "name", "id, name, utc, sensor_id, robot_id, path, profiles, points, cloud", 10},
    {"guides", "hash", "hash, name, utc, csv", 14},
    {"setups", "id", "id, crc, body"},
    {"runs", "number", "number, part_id, started_utc, finished_utc, push, status, message, setup"},
    {"run_spots", "run", "run, position, spot_id, status, body"},
    {"run_regions", "run", "run, position, region_id, gate_passed, body"},
    {"run_panels", "run", "run, job_id, gate_passed, body"},
    {"events", "id", "id, utc, run, kind, subject, text"},
    {"evidence", "id", "id, utc, kind, subject, setup, body"},
    {"fleet", "id", "id, position, body", 15},
    {"outbox", "run", "run, revision, message", 13},
}};

const ChecksummedTable& table_of(std::string_view name) {
    const auto it = std::ranges::find(kTables, name, &ChecksummedTable::name);
    assert(it != kTables.end());
    return *it;
}

}  // namespace

std::span<const ChecksummedTable> checksummed_tables() {
    return kTables;
}

Expected<void> check_rows(Database& db, std::string_view table, const char* column, std::int64_t value) {
    const ChecksummedTable& t = table_of(table);
    SEAM_TRY(auto s, db.prepare(fmt::format(
                         "SELECT CAST({} AS TEXT) FROM {} WHERE {}checksum IS NOT row_checksum({}) LIMIT 1",
                         t.key, t.name, column ? fmt::format("{} = ? AND ", column) : "", t.columns)));
    if (column) s.bind(1, value);
    SEAM_TRY(auto row, s.step());
    if (!row) return {};
    const std::string where = fmt::format("{}: {} {}", db.path(), t.name, s.text(0));
    s.reset();
    return file_error("the checksum of an entry is wrong: the file is damaged", where,
                      "take the last good copy from the backup");
}

Expected<void> seal_row(Database& db, std::string_view table, const char* column, std::int64_t value) {
    const ChecksummedTable& t = table_of(table);
    SEAM_TRY(auto s, db.prepare(fmt::format("UPDATE {} SET checksum = row_checksum({}) WHERE {} = ?", t.name,
                                            t.columns, column)));
    s.bind(1, value);
    return s.run();
}

}  // namespace seamwright
