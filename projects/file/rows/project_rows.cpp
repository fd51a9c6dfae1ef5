#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "devices/capture/profile_blob.h"
#include "projects/file/id_length.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"
#include "projects/model/part_types.h"

namespace seamwright {
namespace {

// An id that an older version let pass stays.
Expected<void> check_ids(Database& db, const char* table, const std::vector<std::string>& ids,
                         const char* kind) {
    std::set<std::string> seen;
    for (const std::string& id : ids) {
        if (is_too_long(id)) {
            SEAM_TRY(auto known, db.prepare(fmt::format("SELECT 1 FROM {} WHERE id = ?", table)));
            known.bind(1, id);
            SEAM_TRY(auto there, known.step());
            known.reset();
            if (!there)
                return input_error(Text("the id of a {} is longer than {} signs", kind, kLongestId),
                                   Text("{}...", utf8_text(id.substr(0, 32))), "give a shorter name");
        }
        if (id.empty()) return input_error(Text("a {} has no id", kind), {}, "give every one a name");
        if (!seen.insert(id).second)
            return input_error(Text("two {}s are called \"{}\"", kind, id), {}, "rename one");
    }
    return {};
}

template <class T>
std::vector<std::string> ids_of(const std::vector<T>& items) {
    std::vector<std::string> ids;
    for (const T& item : items) ids.push_back(item.id);
    return ids;
}

struct RowChanges {
    const std::set<std::string>& kept;
    std::vector<RowChange> made = {};
};

// Rows that are not in `ids` go.
Expected<void> delete_others(Database& db, const char* table, const std::vector<std::string>& ids,
                             RowChanges& changes) {
    SEAM_TRY(auto list, db.prepare(fmt::format("SELECT id FROM {}", table)));
    const std::set<std::string> keep(ids.begin(), ids.end());
    std::vector<std::string> gone;
    for (;;) {
        SEAM_TRY(auto row, list.step());
        if (!row) break;
        if (std::string id = list.text(0); !keep.count(id)) gone.push_back(std::move(id));
    }
    SEAM_TRY(auto remove, db.prepare(fmt::format("DELETE FROM {} WHERE id = ?", table)));
    for (const std::string& id : gone) {
        if (changes.kept.count(subject_of(table, id))) continue;
        remove.bind(1, id);
        SEAM_OK(remove.run());
        changes.made.push_back({table, id, true, {}});
    }
    return {};
}

std::string short_text(const nlohmann::json& value) {
    constexpr std::size_t kLongest = 60;
    const std::string text = dump_messages(value);
    return text.size() > kLongest ? utf8_text(text.substr(0, kLongest)) + "..." : text;
}

// What differs between two bodies, for people: "limits/translation_mm: 25.0 -> 10.0; ...".
std::string difference_of(const std::string& before, const std::string& after) {
    constexpr std::size_t kMost = 8;
    const auto old = parse_json(before, {}), made = parse_json(after, {});
    if (!old || !made) return {};
    std::vector<std::string> parts;
    const auto patch = nlohmann::json::diff(*old, *made);
    for (const auto& step : patch) {
        const std::string path = step.at("path").get<std::string>(), op = step.at("op").get<std::string>();
        if (parts.size() == kMost) {
            parts.push_back(fmt::format("and {} more", patch.size() - kMost));
            break;
        }
        const nlohmann::json::json_pointer at(path);
        const auto value = [&](const nlohmann::json& of) {
            return of.contains(at) ? short_text(of.at(at)) : std::string("none");
        };
        parts.push_back(fmt::format("{}: {} -> {}", path.empty() ? "all" : path.substr(1),
                                    op == "add" ? "none" : value(*old),
                                    op == "remove" ? "none" : short_text(step.at("value"))));
    }
    return fmt::format("{}", fmt::join(parts, "; "));
}

// Its row as it stands, where the table has bodies and it is there.
Expected<std::string> body_of(Database& db, const char* table, const std::string& id) {
    SEAM_TRY(auto s, db.prepare(fmt::format("SELECT body FROM {} WHERE id = ?", table)));
    s.bind(1, id);
    SEAM_TRY(auto row, s.step());
    std::string body = row ? s.text(0) : std::string();
    s.reset();
    return body;
}

// Runs a statement that writes the row `id` where it differs from what is stored, and says so.
template <class Run>
Expected<void> noting(Database& db, const char* table, const std::string& id, RowChanges& changes, Run run) {
    if (changes.kept.count(subject_of(table, id))) return {};
    const bool has_body = std::string_view(table) != "project";
    std::string before;
    if (has_body) {
        SEAM_TRY(before, body_of(db, table, id));
    }
    const auto count = sqlite3_total_changes(db.handle());
    SEAM_OK(run());
    if (sqlite3_total_changes(db.handle()) == count) return {};
    RowChange change{table, id, false, {}};
    if (!before.empty()) {
        SEAM_TRY(const auto after, body_of(db, table, id));
        change.note = difference_of(before, after);
    }
    changes.made.push_back(std::move(change));
    return {};
}

// Writes each row that differs from what is stored: `columns` after id and position.
template <class T, class Bind>
Expected<void> save_rows(Database& db, const char* table, const std::vector<std::string>& columns,
                         const std::vector<T>& items, RowChanges& changes, Bind bind) {
    SEAM_OK(delete_others(db, table, ids_of(items), changes));
    std::string names = "id, position", values = "?1, ?2", sets = "position = excluded.position",
                differs = "position IS NOT excluded.position";
    int number = 2;
    for (const std::string& c : columns) {
        names += ", " + c;
        values += fmt::format(", ?{}", ++number);
        sets += fmt::format(", {0} = excluded.{0}", c);
        differs += fmt::format(" OR {0} IS NOT excluded.{0}", c);
    }
    SEAM_TRY(auto s,
             db.prepare(fmt::format(
                 "INSERT INTO {0} ({1}, checksum) VALUES ({2}, row_checksum({2})) ON CONFLICT (id) DO UPDATE "
                 "SET {3}, checksum = excluded.checksum WHERE {4}",
                 table, names, values, sets, differs)));
    std::int64_t position = 0;
    for (const T& item : items) {
        s.bind(1, item.id);
        s.bind(2, position++);
        SEAM_OK(noting(db, table, item.id, changes, [&] { return bind(s, item); }));
    }
    return {};
}

template <class T>
Expected<void> load_rows(Database& db, const char* sql, const char* kind, std::vector<T>& items) {
    auto s = db.prepare(sql);  // id, body[, reference_profile, template_profile]
    if (!s) return tl::unexpected(s.error());
    return for_each_row(*s, [&](Statement& row) -> Expected<void> {
        const std::string id = row.text(0), where = fmt::format("{} {}", kind, id);
        auto value =
            row_value<T>(row.text(1), where, db.path(), std::is_same_v<T, PanelJob> ? kPanelRow : kRow);
        if (!value) return tl::unexpected(value.error());
        if (value->id != id)
            return file_error("an entry stands under another's id", db.path() + ": " + where);
        if constexpr (std::is_same_v<T, Spot>) {
            SEAM_TRY(auto reference, unpack_profile(row.blob(2), db.path() + ": " + where));
            SEAM_TRY(auto model, unpack_profile(row.blob(3), db.path() + ": " + where));
            value->reference_profile = std::move(reference);
            value->feature.template_profile = std::move(model);
        }
        items.push_back(std::move(*value));
        return {};
    });
}

// None or one.
template <class T>
std::vector<T> one_or_none(const std::optional<T>& thing) {
    return thing ? std::vector<T>{*thing} : std::vector<T>{};
}

Expected<void> check_all_ids(Database& db, const Project& project) {
    for (const auto& sound :
         {check_ids(db, "sensors", ids_of(project.sensors), "sensor"),
          check_ids(db, "robots", ids_of(project.robots), "robot"),
          check_ids(db, "calibrations", ids_of(project.calibrations), "calibration"),
          check_ids(db, "spots", ids_of(project.spots), "spot"),
          check_ids(db, "regions", ids_of(project.regions), "region"),
          check_ids(db, "panel_jobs", ids_of(project.panel_jobs), "panel job"),
          check_ids(db, "line", ids_of(project.line), "line link"),
          check_ids(db, "part_types", ids_of(project.part_types), "part type"),
          check_ids(db, "elastic", ids_of(project.elastic), "region with mode"),
          check_ids(db, "drift_watch", ids_of(one_or_none(project.drift)), "drift watch"),
          check_ids(db, "fixture", ids_of(one_or_none(project.fixture)), "fixture"),
          check_ids(db, "fleet", ids_of(one_or_none(project.fleet)), "fleet"), check_part_types(project)})
        if (!sound) return tl::unexpected(sound.error());
    return {};
}

// Of each there is one row.
Expected<void> save_project_and_part(Database& db, const Project& project, RowChanges& changes) {
    const char* name_row = R"(
        INSERT INTO project (id, name, created_utc, checksum) VALUES (1, ?1, ?2, row_checksum(1, ?1, ?2))
        ON CONFLICT (id) DO UPDATE SET name = excluded.name, checksum = row_checksum(id, excluded.name, created_utc)
        WHERE name IS NOT excluded.name)";
    SEAM_TRY(auto name, db.prepare(name_row));
    SEAM_OK(dump_document(project.name, "project name"));
    name.bind(1, project.name);
    name.bind(2, utc_now());
    SEAM_OK(noting(db, "project", "1", changes, [&] { return name.run(); }));

    const char* required_row = R"(
        INSERT INTO requirements (id, body, checksum) VALUES (1, ?1, row_checksum(1, ?1))
        ON CONFLICT (id) DO UPDATE SET body = excluded.body, checksum = excluded.checksum
        WHERE body IS NOT excluded.body)";
    SEAM_TRY(auto required, db.prepare(required_row));
    SEAM_TRY(auto required_text, row_text(project.requirements, "requirements", kRow));
    required.bind(1, required_text);
    SEAM_OK(noting(db, "requirements", "1", changes, [&] { return required.run(); }));

    const char* part_row = R"(
        INSERT INTO part (id, body, mesh, checksum) VALUES (1, ?1, ?2, row_checksum(1, ?1, ?2))
        ON CONFLICT (id) DO UPDATE SET body = excluded.body, mesh = excluded.mesh, checksum = excluded.checksum
        WHERE body IS NOT excluded.body OR mesh IS NOT excluded.mesh)";
    SEAM_TRY(auto part, db.prepare(part_row));
    SEAM_TRY(auto part_text, row_text(project.part, "part", kRow));
    part.bind(1, part_text);
    part.bind(2, std::span<const std::byte>(project.part.mesh_ply));
    SEAM_OK(noting(db, "part", "1", changes, [&] { return part.run(); }));
    return {};
}

Expected<void> save_devices(Database& db, const Project& project, RowChanges& changes) {
    const auto device = [](const char* kind) {
        return [kind](Statement& s, const auto& item) -> Expected<void> {
            SEAM_TRY(auto text, row_text(item, fmt::format("{} {}", kind, item.id), kRow));
            s.bind(3, item.driver);
            s.bind(4, text);
            return s.run();
        };
    };
    SEAM_OK(save_rows(db, "sensors", {"driver", "body"}, project.sensors, changes, device("sensor")));
    SEAM_OK(save_rows(db, "robots", {"driver", "body"}, project.robots, changes, device("robot")));
    SEAM_OK(save_rows(db, "calibrations", {"sensor_id", "robot_id", "created_utc", "verdict", "body"},
                      project.calibrations, changes,
                      [](Statement& s, const Calibration& c) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(c, "calibration " + c.id, kRow));
                          s.bind(3, c.sensor_id);
                          s.bind(4, c.robot_id);
                          s.bind(5, c.created_utc);
                          s.bind(6, std::string(name_of(c.verdict)));
                          s.bind(7, text);
                          return s.run();
                      }));
    return {};
}

Expected<void> save_spots(Database& db, const Project& project, RowChanges& changes) {
    SEAM_OK(save_rows(db, "spots", {"sensor_id", "robot_id", "body", "reference_profile", "template_profile"},
                      project.spots, changes, [](Statement& s, const Spot& spot) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(spot, "spot " + spot.id, kRow));
                          auto reference = pack_profile(spot.reference_profile);
                          auto model = pack_profile(spot.feature.template_profile);
                          for (const auto* blob : {&reference, &model})
                              if (!*blob) {
                                  Error error = blob->error();
                                  error.where = "spot " + spot.id;
                                  return tl::unexpected(error);
                              }
                          s.bind(3, spot.sensor_id);
                          s.bind(4, spot.robot_id);
                          s.bind(5, text);
                          s.bind(6, std::span<const std::byte>(*reference));
                          s.bind(7, std::span<const std::byte>(*model));
                          return s.run();
                      }));
    return {};
}

Expected<void> save_regions(Database& db, const Project& project, RowChanges& changes) {
    SEAM_OK(save_rows(db, "regions", {"frame_name", "body"}, project.regions, changes,
                      [](Statement& s, const Region& region) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(region, "region " + region.id, kRow));
                          s.bind(3, region.frame_name);
                          s.bind(4, text);
                          return s.run();
                      }));
    SEAM_OK(save_rows(db, "panel_jobs", {"frame_name", "body"}, project.panel_jobs, changes,
                      [](Statement& s, const PanelJob& job) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(job, "panel job " + job.id, kPanelRow));
                          s.bind(3, job.frame_name);
                          s.bind(4, text);
                          return s.run();
                      }));
    return {};
}

// What stands around spots and regions: part types, the line, how parts bend, the drift watch, the fixture, the fleet.
Expected<void> save_surroundings(Database& db, const Project& project, RowChanges& changes) {
    SEAM_OK(save_rows(db, "part_types", {"body"}, project.part_types, changes,
                      [](Statement& s, const PartType& type) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(type, "part type " + type.id, kRow));
                          s.bind(3, text);
                          return s.run();
                      }));
    SEAM_OK(save_rows(db, "line", {"protocol", "body"}, project.line, changes,
                      [](Statement& s, const LineSetup& link) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(link, "line link " + link.id, kRow));
                          s.bind(3, link.protocol);
                          s.bind(4, text);
                          return s.run();
                      }));
    SEAM_OK(save_rows(db, "elastic", {"body"}, project.elastic, changes,
                      [](Statement& s, const RegionModes& modes) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(modes, "modes of region " + modes.id, kRow));
                          s.bind(3, text);
                          return s.run();
                      }));
    SEAM_OK(save_rows(db, "drift_watch", {"body"}, one_or_none(project.drift), changes,
                      [](Statement& s, const DriftWatch& drift) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(drift, "drift watch", kRow));
                          s.bind(3, text);
                          return s.run();
                      }));
    SEAM_OK(save_rows(db, "fixture", {"body"}, one_or_none(project.fixture), changes,
                      [](Statement& s, const Fixture& fixture) -> Expected<void> {
                          SEAM_TRY(auto text, row_text(fixture, "fixture", kRow));
                          s.bind(3, text);
                          return s.run();
                      }));
    SEAM_OK(save_rows(db, "fleet", {"body"}, one_or_none(project.fleet), changes,
                      [](Statement& s, const FleetLink& fleet) -> Expected<void> {
                          if (has_password(fleet.address))
                              return input_error("a project is no place for a password, its file is copied",
                                                 "fleet", "leave it out and write it into ~/.pgpass");
                          SEAM_TRY(auto text, row_text(fleet, "fleet", kRow));
                          s.bind(3, text);
                          return s.run();
                      }));
    return {};
}

}  // namespace

Expected<std::vector<RowChange>> save_rows_of(Database& db, const Project& project,
                                              const std::set<std::string>& kept) {
    SEAM_OK(check_all_ids(db, project));
    RowChanges changes{kept};
    for (const auto save : {save_project_and_part, save_devices, save_spots, save_regions, save_surroundings})
        SEAM_OK(save(db, project, changes));
    return std::move(changes.made);
}

Expected<void> chain_changes(Database& db, const std::string& person, const std::vector<RowChange>& changes) {
    for (const RowChange& change : changes) {
        const std::string subject = subject_of(change.table, change.id);
        if (change.gone) {
            SEAM_OK(append_chain(db, person, "project", subject, {}, change.note));
            continue;
        }
        SEAM_TRY(const Digest digest, row_digest(db, change.table, change.id));
        SEAM_OK(append_chain(db, person, "project", subject, digest, change.note));
    }
    return {};
}

Expected<Project> load_rows_of(Database& db) {
    for (const char* table : kProjectTables) SEAM_OK(check_rows(db, table));
    Project project;
    std::vector<DriftWatch> drift;
    std::vector<Fixture> fixture;
    std::vector<FleetLink> fleet;
    SEAM_TRY(auto name, db.prepare("SELECT name FROM project"));
    SEAM_OK(for_each_row(name, [&](Statement& row) -> Expected<void> {
        project.name = row.text(0);
        return {};
    }));
    auto required = db.prepare("SELECT body FROM requirements");  // none in a file of an older version
    if (!required) return tl::unexpected(required.error());
    SEAM_OK(for_each_row(*required, [&](Statement& row) -> Expected<void> {
        SEAM_TRY(auto value, row_value<Requirements>(row.text(0), "requirements", db.path(), kRow));
        project.requirements = value;
        return {};
    }));
    SEAM_TRY(auto part, db.prepare("SELECT body, mesh FROM part"));
    SEAM_OK(for_each_row(part, [&](Statement& row) -> Expected<void> {
        SEAM_TRY(auto value, row_value<PartSetup>(row.text(0), "part", db.path(), kRow));
        project.part = std::move(value);
        const auto mesh = row.blob(1);
        project.part.mesh_ply.assign(mesh.begin(), mesh.end());
        return {};
    }));
    for (const auto& done :
         {load_rows(db, "SELECT id, body FROM sensors ORDER BY position", "sensor", project.sensors),
          load_rows(db, "SELECT id, body FROM robots ORDER BY position", "robot", project.robots),
          load_rows(db, "SELECT id, body FROM calibrations ORDER BY position", "calibration",
                    project.calibrations),
          load_rows(db, "SELECT id, body, reference_profile, template_profile FROM spots ORDER BY position",
                    "spot", project.spots),
          load_rows(db, "SELECT id, body FROM regions ORDER BY position", "region", project.regions),
          load_rows(db, "SELECT id, body FROM panel_jobs ORDER BY position", "panel job", project.panel_jobs),
          load_rows(db, "SELECT id, body FROM line ORDER BY position", "line link", project.line),
          load_rows(db, "SELECT id, body FROM part_types ORDER BY position", "part type", project.part_types),

          load_rows(db, "SELECT id, body FROM elastic ORDER BY position", "modes of region", project.elastic),
          load_rows(db, "SELECT id, body FROM drift_watch ORDER BY position LIMIT 1", "drift watch", drift),
          load_rows(db, "SELECT id, body FROM fixture ORDER BY position LIMIT 1", "fixture", fixture),
          load_rows(db, "SELECT id, body FROM fleet ORDER BY position LIMIT 1", "fleet", fleet)})
        if (!done) return tl::unexpected(done.error());
    if (!drift.empty()) project.drift = std::move(drift.front());
    if (!fixture.empty()) project.fixture = std::move(fixture.front());
    if (!fleet.empty()) project.fleet = std::move(fleet.front());
    return project;
}

}  // namespace seamwright
