#include "projects/file/chain/chain.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <map>

#include "devices/capture/capture.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {
namespace {

constexpr std::string_view kProject = "project", kUser = "user", kRun = "run", kCaptures = "captures",
                           kEvent = "event", kEvents = "events";
constexpr const char* kMend =
    "take the last good copy from the backup, or hold the last audit's export against it";

// A table each row of which has entries of its own.
struct ChainedTable {
    const char* table;
    std::string_view kind;
};
constexpr std::array<ChainedTable, 5> kByRow{{{"setups", "setup"},
                                              {"evidence", "evidence"},
                                              {"drift_points", "drift point"},
                                              {"scans", "scan"},
                                              {"guides", "guide"}}};
// What is of one run, and the order of its rows.
struct OfRun {
    const char *table, *key, *order;
};
constexpr std::array<OfRun, 5> kOfRun{{{"runs", "number", "number"},
                                       {"run_types", "run", "run"},
                                       {"run_spots", "run", "position"},
                                       {"run_regions", "run", "position"},
                                       {"run_panels", "run", "run"}}};

const ChecksummedTable& columns_of(std::string_view table) {
    const auto tables = checksummed_tables();
    const auto it = std::ranges::find_if(tables, [&](const auto& t) { return t.name == table; });
    assert(it != tables.end());
    return *it;
}

// The key of project, requirements and part is their only row's number.
const char* key_of(std::string_view table) {
    return table == "project" ? "id" : columns_of(table).key;
}

template <class Id>
Expected<Digest> digest_of_row(Database& db, std::string_view table, Id id) {
    SEAM_TRY(auto s, db.prepare(fmt::format("SELECT {} FROM {} WHERE {} = ?", columns_of(table).columns,
                                            table, key_of(table))));
    s.bind(1, id);
    SEAM_TRY(auto row, s.step());
    if (!row) return file_error("an entry of the project file is missing", Text("{}: {}", db.path(), table));
    std::string encoding;
    append_netstring(encoding, table);
    s.append_netstrings(0, encoding);
    s.reset();
    return sha256(encoding);
}

// Calls `tell` with the key, as text, and the digest of every row.
template <class Tell>
Expected<void> every_row(Database& db, std::string_view table, Tell tell) {
    SEAM_TRY(auto s, db.prepare(fmt::format("SELECT CAST({0} AS TEXT), {1} FROM {2} ORDER BY {0}",
                                            key_of(table), columns_of(table).columns, table)));
    return for_each_row(s, [&](Statement& row) -> Expected<void> {
        std::string encoding;
        append_netstring(encoding, table);
        const std::string key = row.text(0);
        row.append_netstrings(1, encoding);
        return tell(key, sha256(encoding));
    });
}

std::string subject_of(std::string_view table, const std::string& key) {
    return fmt::format("{} {}", table, key);
}

Expected<Digest> digest_of_events(Database& db, std::int64_t last) {
    SEAM_TRY(auto s, db.prepare(fmt::format("SELECT {} FROM events WHERE id <= ? ORDER BY id",
                                            columns_of("events").columns)));
    s.bind(1, last);
    Sha256 all;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        std::string encoding;
        append_netstring(encoding, "events");
        row.append_netstrings(0, encoding);
        all.add(encoding);
        return {};
    }));
    return all.finish();
}

ChainEntry entry_of(Statement& row) {
    return {row.integer(0), row.text(1),      row.text(2), row.text(3),
            row.text(4),    hex(row.blob(5)), row.text(6), hex(row.blob(7))};
}
constexpr const char* kEntryColumns = "number, utc, person, kind, subject, digest, note, hash";

Text named(const ChainEntry& e) {
    return Text("entry {} of the chain ({}, {} {})", e.number, e.utc, e.kind, e.subject);
}

Error wrong_link(Database& db, const ChainEntry& e) {
    return file_error(Text("{} does not follow from the one before: the file was changed by another program",
                           named(e)),
                      db.path(), kMend)
        .value();
}

// The number of a run or an event in a subject; 0: none.
std::int64_t number_in(const std::string& subject) {
    std::int64_t number = 0;
    std::from_chars(subject.data(), subject.data() + subject.size(), number);
    return number;
}

// The last entries of a kind, by subject: their numbers and digests.
struct LastEntry {
    std::int64_t number = 0;
    std::optional<Digest> digest;  // none: gone
};
using LastEntries = std::map<std::string, LastEntry>;

Expected<Error> not_as(Database& db, const std::string& what, const LastEntry* last) {
    if (!last)
        return file_error(
                   Text("{} is in no entry of the chain: the file was changed by another program", what),
                   db.path(), kMend)
            .value();
    SEAM_TRY(auto s, db.prepare(fmt::format("SELECT {} FROM chain WHERE number = ?", kEntryColumns)));
    s.bind(1, last->number);
    SEAM_TRY(auto row, s.step());
    const Text entry = row ? named(entry_of(s)) : Text("entry {} of the chain", last->number);
    s.reset();
    return file_error(Text("{} is not as {} says: the file was changed by another program", what, entry),
                      db.path(), kMend)
        .value();
}

Expected<LastEntries> last_entries(Database& db, std::string_view kind) {
    SEAM_TRY(auto s,
             db.prepare("SELECT number, subject, digest FROM chain WHERE number IN (SELECT max(number) "
                        "FROM chain WHERE kind = ? GROUP BY subject)"));
    s.bind(1, kind);
    LastEntries last;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        LastEntry e{row.integer(0), std::nullopt};
        if (const auto bytes = row.blob(2); !bytes.empty()) {
            e.digest.emplace();
            std::copy_n(bytes.begin(), std::min(bytes.size(), e.digest->size()), e.digest->begin());
        }
        last.emplace(row.text(1), e);
        return {};
    }));
    return last;
}

// What is in the table and in the last entries has to be the same.
Expected<void> compare(Database& db, LastEntries last, const std::map<std::string, Digest>& found,
                       std::vector<Error>& findings, std::string_view called) {
    const auto add = [&](const std::string& subject, const LastEntry* entry) -> Expected<void> {
        SEAM_TRY(auto error,
                 not_as(db, called.empty() ? subject : fmt::format("{} {}", called, subject), entry));
        findings.push_back(std::move(error));
        return {};
    };
    for (const auto& [subject, digest] : found) {
        const auto it = last.find(subject);
        const bool known = it != last.end() && it->second.digest;
        if (!known || *it->second.digest != digest) SEAM_OK(add(subject, known ? &it->second : nullptr));
        if (it != last.end()) last.erase(it);
    }
    for (const auto& [subject, entry] : last)
        if (entry.digest) SEAM_OK(add(subject, &entry));
    return {};
}

using Found = std::map<std::string, Digest>;

Expected<Found> found_in_project(Database& db) {
    Found found;
    for (const char* table : kProjectTables)
        SEAM_OK(every_row(db, table, [&](const std::string& key, const Digest& digest) -> Expected<void> {
            found.emplace(subject_of(table, key), digest);
            return {};
        }));
    return found;
}
Expected<Found> found_in(Database& db, std::string_view table) {
    Found found;
    SEAM_OK(every_row(db, table, [&](const std::string& key, const Digest& digest) -> Expected<void> {
        found.emplace(key, digest);
        return {};
    }));
    return found;
}

Expected<std::vector<Error>> project_and_users(Database& db) {
    std::vector<Error> findings;
    SEAM_TRY(const auto project, found_in_project(db));
    SEAM_TRY(auto said, last_entries(db, kProject));
    SEAM_OK(compare(db, std::move(said), project, findings, ""));
    SEAM_TRY(const auto users, found_in(db, "users"));
    SEAM_TRY(auto said_of_users, last_entries(db, kUser));
    SEAM_OK(compare(db, std::move(said_of_users), users, findings, kUser));
    return findings;
}

// From the entry `from` on.
Expected<std::optional<Error>> links_from(Database& db, std::int64_t from) {
    SEAM_TRY(auto s, db.prepare(fmt::format("SELECT {} FROM chain WHERE number >= ? ORDER BY number",
                                            kEntryColumns)));
    s.bind(1, from);
    std::optional<Error> wrong;
    std::string before;
    std::int64_t number = from;
    bool first = from > 1;  // its own predecessor is not looked at
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        if (wrong) return {};
        const ChainEntry e = entry_of(row);
        if (e.number != number || (!first && hex(sha256(chain_encoding(e, before))) != e.hash))
            wrong = wrong_link(db, e);
        first = false;
        ++number;
        before = e.hash;
        return {};
    }));
    if (!wrong && number == from)
        return file_error("the chain of the project file is gone: the file was changed by another program",
                          db.path(), kMend)
            .value();
    return wrong;
}

}  // namespace

std::string chain_encoding(const ChainEntry& e, const std::string& hash_before) {
    std::string out;
    append_netstring(out, "seamwright chain 1");
    append_netstring(out, hash_before);
    append_netstring(out, fmt::format_int(e.number).c_str());
    for (const std::string* field : {&e.utc, &e.person, &e.kind, &e.subject, &e.digest, &e.note})
        append_netstring(out, *field);
    return out;
}

Expected<void> append_chain(Database& db, const std::string& person, std::string_view kind,
                            std::string_view subject, std::span<const std::byte> digest,
                            std::string_view note) {
    ChainEntry e{1,           utc_now(),         person, std::string(kind), std::string(subject),
                 hex(digest), std::string(note), {}};
    std::string before;
    SEAM_TRY(auto last, db.prepare("SELECT number, hash FROM chain ORDER BY number DESC LIMIT 1"));
    SEAM_TRY(auto row, last.step());
    if (row) {
        e.number = last.integer(0) + 1;
        before = hex(last.blob(1));
        last.reset();
    }
    const Digest hash = sha256(chain_encoding(e, before));
    SEAM_TRY(auto s, db.prepare("INSERT INTO chain (number, utc, person, kind, subject, digest, note, hash) "
                                "VALUES (?, ?, ?, ?, ?, ?, ?, ?)"));
    s.bind(1, e.number);
    s.bind(2, e.utc);
    s.bind(3, e.person);
    s.bind(4, e.kind);
    s.bind(5, e.subject);
    s.bind(6, digest);
    s.bind(7, e.note);
    s.bind(8, std::span<const std::byte>(hash));
    return s.run();
}

Expected<void> begin_chain(Database& db, std::int32_t from_version) {
    if (sodium_init() < 0) return file_error("the computer gives no random numbers", db.path());
    Digest random;
    randombytes_buf(random.data(), random.size());
    SEAM_OK(append_chain(db, {}, "begin", {}, random,
                         from_version > 0 ? fmt::format("version {}", from_version) : "new"));
    const auto add = [&](std::string_view kind, const std::string& subject, const Digest& digest) {
        return append_chain(db, {}, kind, subject, digest);
    };
    SEAM_TRY(const std::int64_t version, db.integer("PRAGMA user_version"));
    for (const char* table : kProjectTables) {
        if (columns_of(table).since > version) continue;  // a later migration makes it, empty
        SEAM_OK(every_row(db, table, [&](const std::string& key, const Digest& digest) {
            return add(kProject, subject_of(table, key), digest);
        }));
    }
    for (const ChainedTable& t : kByRow) {
        if (columns_of(t.table).since > version) continue;
        SEAM_OK(every_row(db, t.table, [&](const std::string& key, const Digest& digest) {
            return add(t.kind, key, digest);
        }));
    }
    SEAM_TRY(auto runs, db.prepare("SELECT number FROM runs ORDER BY number"));
    SEAM_OK(for_each_row(runs, [&](Statement& row) -> Expected<void> {
        const std::int64_t number = row.integer(0);
        SEAM_TRY(const Digest digest, run_digest(db, number));
        return add(kRun, std::to_string(number), digest);
    }));
    SEAM_TRY(const std::int64_t last, db.integer("SELECT ifnull(max(id), 0) FROM events"));
    if (last == 0) return {};
    SEAM_TRY(const Digest events, digest_of_events(db, last));
    return add(kEvents, std::to_string(last), events);
}

Expected<Digest> row_digest(Database& db, std::string_view table, std::string_view id) {
    return digest_of_row(db, table, id);
}
Expected<Digest> row_digest(Database& db, std::string_view table, std::int64_t id) {
    return digest_of_row(db, table, id);
}

Expected<Digest> run_digest(Database& db, std::int64_t number) {
    Sha256 all;
    for (const OfRun& part : kOfRun) {
        SEAM_TRY(auto s,
                 db.prepare(fmt::format("SELECT {} FROM {} WHERE {} = ? ORDER BY {}",
                                        columns_of(part.table).columns, part.table, part.key, part.order)));
        s.bind(1, number);
        SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
            std::string encoding;
            append_netstring(encoding, part.table);
            row.append_netstrings(0, encoding);
            all.add(encoding);
            return {};
        }));
    }
    return all.finish();
}

Digest blob_row_digest(std::string_view table, std::span<const std::int64_t> numbers,
                       std::span<const std::byte> data) {
    Sha256 all;
    std::string front;
    append_netstring(front, table);
    for (const std::int64_t number : numbers) append_netstring(front, fmt::format_int(number).c_str());
    all.add(front + fmt::format("{}:", data.size()));
    all.add(data);
    all.add(std::string_view(","));
    return all.finish();
}

Digest captures_digest(std::span<const Digest> captures, std::span<const Digest> images) {
    std::string list;
    for (const auto& part : {captures, images})
        for (const Digest& digest : part) append_netstring(list, hex(digest));
    return sha256(list);
}

Expected<Digest> stored_captures_digest(Database& db, std::int64_t run) {
    std::vector<Digest> captures, images;
    const auto read = [&](const char* sql, const char* table, std::size_t numbers,
                          std::vector<Digest>& into) -> Expected<void> {
        SEAM_TRY(auto s, db.prepare(sql));
        s.bind(1, run);
        return for_each_row(s, [&](Statement& row) -> Expected<void> {
            std::vector<std::int64_t> in_front(numbers);
            for (std::size_t i = 0; i < numbers; ++i) in_front[i] = row.integer(static_cast<int>(i));
            into.push_back(blob_row_digest(table, in_front, row.blob(static_cast<int>(numbers))));
            return {};
        });
    };
    SEAM_OK(read("SELECT run, chunk, captures, data FROM captures WHERE run = ? ORDER BY chunk", "captures",
                 3, captures));
    SEAM_OK(
        read("SELECT run, capture, width, height, bit_depth, data FROM images WHERE run = ? ORDER BY "
             "capture",
             "images", 5, images));
    return captures_digest(captures, images);
}

Expected<std::string> chain_identity(Database& db) {
    SEAM_TRY(auto s, db.prepare("SELECT hash FROM chain WHERE number = 1"));
    SEAM_TRY(auto row, s.step());
    if (!row)
        return file_error("the chain of the project file is gone: the file was changed by another program",
                          db.path(), kMend);
    const std::string identity = hex(s.blob(0));
    s.reset();
    return identity;
}

Expected<std::optional<Error>> chain_trouble(Database& db) {
    SEAM_TRY(const std::int64_t last, db.integer("SELECT ifnull(max(number), 0) FROM chain"));
    SEAM_TRY(auto wrong, links_from(db, std::max<std::int64_t>(last - 1, 1)));
    if (wrong) return wrong;
    SEAM_TRY(auto findings, project_and_users(db));
    if (findings.empty()) return std::optional<Error>();
    return std::optional<Error>(std::move(findings.front()));
}

Expected<std::optional<Error>> check_links(Database& db) {
    return links_from(db, 1);
}

Expected<std::vector<Error>> check_chain(Database& db) {
    std::vector<Error> findings;
    SEAM_TRY(auto wrong, links_from(db, 1));
    if (wrong) findings.push_back(std::move(*wrong));
    const auto add = [&](std::vector<Error> more) {
        for (Error& e : more) findings.push_back(std::move(e));
    };
    SEAM_TRY(auto project, project_and_users(db));
    add(std::move(project));
    for (const ChainedTable& t : kByRow) {
        SEAM_TRY(const auto found, found_in(db, t.table));
        SEAM_TRY(auto said, last_entries(db, t.kind));
        SEAM_OK(compare(db, std::move(said), found, findings, t.kind));
    }

    SEAM_TRY(auto numbers, db.prepare("SELECT number FROM runs ORDER BY number"));
    Found runs;
    SEAM_OK(for_each_row(numbers, [&](Statement& row) -> Expected<void> {
        const std::int64_t number = row.integer(0);
        SEAM_TRY(const Digest digest, run_digest(db, number));
        runs.emplace(std::to_string(number), digest);
        return {};
    }));
    SEAM_TRY(auto said_of_runs, last_entries(db, kRun));
    SEAM_OK(compare(db, std::move(said_of_runs), runs, findings, kRun));
    SEAM_TRY(const auto captures, last_entries(db, kCaptures));
    for (const auto& [run, entry] : captures) {
        if (!runs.count(run)) continue;
        SEAM_TRY(const Digest digest, stored_captures_digest(db, number_in(run)));
        if (digest == entry.digest) continue;
        SEAM_TRY(auto error, not_as(db, fmt::format("raw data of run {}", run), &entry));
        findings.push_back(std::move(error));
    }

    // Events of before the chain have one entry together.
    SEAM_TRY(const auto older, last_entries(db, kEvents));
    std::int64_t chained_after = 0;
    for (const auto& [last, entry] : older) {
        chained_after = std::max<std::int64_t>(chained_after, number_in(last));
        SEAM_TRY(const Digest digest, digest_of_events(db, number_in(last)));
        if (digest == entry.digest) continue;
        SEAM_TRY(auto error, not_as(db, fmt::format("events up to {}", last), &entry));
        findings.push_back(std::move(error));
    }
    SEAM_TRY(auto events, found_in(db, "events"));
    std::erase_if(events, [&](const auto& e) { return number_in(e.first) <= chained_after; });
    SEAM_TRY(auto said_of_events, last_entries(db, kEvent));
    SEAM_OK(compare(db, std::move(said_of_events), events, findings, kEvent));
    return findings;
}

}  // namespace seamwright
