// Whether a file is whole: its chain, its pages, its tables, and everything that it holds read once.

#include <set>

#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"
#include "projects/file/schema.h"

namespace seamwright {

Expected<std::vector<ChainEntry>> ProjectFile::chain(std::int64_t after, std::int64_t most) const {
    SEAM_TRY(auto s,
             impl_->db.prepare("SELECT number, utc, person, kind, subject, digest, note, hash FROM chain "
                               "WHERE number > ? ORDER BY number LIMIT ?"));
    s.bind(1, after);
    s.bind(2, most > 0 ? most : -1);
    std::vector<ChainEntry> entries;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        entries.push_back({row.integer(0), row.text(1), row.text(2), row.text(3), row.text(4),
                           hex(row.blob(5)), row.text(6), hex(row.blob(7))});
        return {};
    }));
    return entries;
}

Expected<std::vector<Error>> ProjectFile::check_chain() const {
    return seamwright::check_chain(impl_->db);
}

std::vector<Error> ProjectFile::check() const {
    std::vector<Error> findings;
    Database& db = impl_->db;
    if (auto chained = check_chain(); !chained)
        findings.push_back(chained.error());
    else
        findings = std::move(*chained);
    auto integrity = db.prepare("PRAGMA integrity_check(20)");
    if (!integrity) return {integrity.error()};
    auto read = for_each_row(*integrity, [&](Statement& row) -> Expected<void> {
        if (const std::string line = row.text(0); line != "ok")
            findings.push_back(Error{ErrorKind::file, line, impl_->path.string(),
                                     "take the last good copy from the backup"});
        return {};
    });
    if (!read) findings.push_back(read.error());
    if (auto structure = check_structure(db, current_version()); !structure)
        findings.push_back(structure.error());
    if (auto project = load(); !project) findings.push_back(project.error());
    if (auto all = events(); !all) findings.push_back(all.error());
    std::set<std::int64_t> setups;
    const auto check_setup = [&](std::int64_t number) {
        if (!setups.insert(number).second) return;
        if (auto setup = load_setup(number); !setup) findings.push_back(setup.error());
    };
    if (auto proven = evidence(); !proven)
        findings.push_back(proven.error());
    else
        for (const Evidence& e : *proven) check_setup(e.setup);
    if (auto points = drift_points(); !points) findings.push_back(points.error());
    for (const char* table : {"scans", "guides"})
        if (auto kept = check_rows(db, table); !kept) findings.push_back(kept.error());
    auto list = runs();
    if (!list) {
        findings.push_back(list.error());
        return findings;
    }
    for (const RunSummary& run : *list) {
        if (auto record = load_run(run.number); !record) findings.push_back(record.error());
        check_setup(run.setup);
    }
    return findings;
}

}  // namespace seamwright
