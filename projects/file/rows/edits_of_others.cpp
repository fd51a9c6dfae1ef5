// The project's rows as a ProjectFile first saw them, against those that other programs have changed since.

#include <algorithm>

#include "projects/file/project_file_detail.h"

namespace seamwright {
namespace {

Expected<std::map<std::string, std::int64_t>> checksums_of_project(Database& db) {
    std::map<std::string, std::int64_t> rows;
    for (const char* table : kProjectTables) {
        SEAM_TRY(auto s, db.prepare(fmt::format("SELECT CAST(id AS TEXT), checksum FROM {}", table)));
        SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
            rows[subject_of(table, row.text(0))] = row.integer(1);
            return {};
        }));
    }
    return rows;
}

std::vector<std::string> differing(const std::map<std::string, std::int64_t>& a,
                                   const std::map<std::string, std::int64_t>& b) {
    std::vector<std::string> subjects;
    for (const auto& [subject, sum] : a)
        if (const auto it = b.find(subject); it == b.end() || it->second != sum) subjects.push_back(subject);
    for (const auto& [subject, sum] : b)
        if (!a.count(subject)) subjects.push_back(subject);
    return subjects;
}

bool alike(const std::map<std::string, std::int64_t>& a, const std::map<std::string, std::int64_t>& b,
           const std::string& subject) {
    const auto x = a.find(subject), y = b.find(subject);
    return x == a.end() ? y == b.end() : y != b.end() && x->second == y->second;
}

Expected<std::string> last_hand(Database& db, const std::string& subject) {
    SEAM_TRY(auto s, db.prepare("SELECT person FROM chain WHERE kind = 'project' AND subject = ? "
                                "ORDER BY number DESC LIMIT 1"));
    s.bind(1, subject);
    SEAM_TRY(const auto row, s.step());
    std::string person = row ? s.text(0) : std::string();
    s.reset();
    return person;
}

}  // namespace

Expected<void> ProjectFile::Impl::see_project() const {
    SEAM_TRY(auto rows, checksums_of_project(db));
    SEAM_TRY(const auto looked, db.integer("SELECT ifnull(max(number), 0) FROM chain"));
    seen = SeenProject{std::move(rows), looked, false};
    return {};
}

// The chain is read from where it was read last: it grows with every run.
Expected<bool> ProjectFile::Impl::may_be_edited() const {
    if (!seen) return false;
    if (seen->edited) return true;
    SEAM_TRY(auto s, db.prepare("SELECT ifnull(max(number), 0), ifnull(max(kind = 'project'), 0) FROM chain "
                                "WHERE number > ?"));
    s.bind(1, seen->looked);
    SEAM_TRY(const auto row, s.step());
    if (row && s.integer(0) > seen->looked) {
        seen->looked = s.integer(0);
        seen->edited = s.integer(1) != 0;
    }
    s.reset();
    return seen->edited;
}

Expected<std::vector<EditOfOthers>> ProjectFile::edits_of_others() const {
    SEAM_TRY(const bool edited, impl_->may_be_edited());
    if (!edited) return std::vector<EditOfOthers>();
    SEAM_TRY(const auto now, checksums_of_project(impl_->db));
    std::vector<EditOfOthers> edits;
    for (const std::string& subject : differing(impl_->seen->rows, now)) {
        SEAM_TRY(auto person, last_hand(impl_->db, subject));
        edits.push_back(
            {subject.substr(0, subject.find(' ')), subject.substr(subject.find(' ') + 1), person});
    }
    return edits;
}

Text said_of(const EditOfOthers& edit) {
    const Text who = edit.person.empty() ? Text("another program") : Text(edit.person);
    return Text("{} {} was changed meanwhile by {}", edit.table, edit.id, who);
}

Expected<Project> ProjectFile::load_anew() {
    impl_->seen.reset();
    return load();
}

// What the project would make of the rows that others have changed is tried and taken back: a row that is still as it was
// seen is theirs, one that both made the same is nobody's, and one that both changed cannot be decided here.
Expected<std::set<std::string>> ProjectFile::rows_of_others(const Project& project) {
    std::set<std::string> theirs;
    SEAM_TRY(const bool edited, impl_->may_be_edited());
    if (!edited) return theirs;
    Database& db = impl_->db;
    SEAM_TRY(const auto now, checksums_of_project(db));
    const auto changed = differing(impl_->seen->rows, now);
    if (changed.empty()) return theirs;
    SEAM_OK(db.execute("SAVEPOINT trial"));
    SEAM_TRY(const auto tried, save_rows_of(db, project));
    SEAM_TRY(const auto wanted, checksums_of_project(db));
    SEAM_OK(db.execute("ROLLBACK TO trial; RELEASE trial"));
    for (const std::string& subject : changed) {
        if (alike(wanted, now, subject)) continue;
        if (alike(wanted, impl_->seen->rows, subject)) {
            theirs.insert(subject);
            continue;
        }
        SEAM_TRY(auto person, last_hand(db, subject));
        return input_error(
            said_of({subject.substr(0, subject.find(' ')), subject.substr(subject.find(' ') + 1), person}),
            impl_->path.string(), "open the project again, and make the change in it anew");
    }
    return theirs;
}

Expected<void> ProjectFile::see_saved(const std::vector<RowChange>& changes) {
    if (!impl_->seen) return {};
    SEAM_TRY(const auto now, checksums_of_project(impl_->db));
    for (const RowChange& change : changes) {
        const std::string subject = subject_of(change.table, change.id);
        if (const auto it = now.find(subject); it != now.end())
            impl_->seen->rows[subject] = it->second;
        else
            impl_->seen->rows.erase(subject);
    }
    SEAM_TRY(impl_->seen->looked, impl_->db.integer("SELECT ifnull(max(number), 0) FROM chain"));
    impl_->seen->edited = impl_->seen->rows != now;
    return {};
}

}  // namespace seamwright
