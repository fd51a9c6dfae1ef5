#include <fmt/format.h>

#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {

Expected<std::int64_t> insert_event(Database& db, const std::string& person, const EventRecord& event,
                                    std::int64_t run) {
    SEAM_TRY(auto s, db.prepare("INSERT INTO events (utc, run, kind, subject, text) VALUES (?, ?, ?, ?, ?)"));
    s.bind(1, event.utc.empty() ? utc_now() : utf8_text(event.utc));
    s.bind(2, run);
    s.bind(3, to_string(event.kind));
    s.bind(4, utf8_text(event.subject));
    s.bind(5, stored_text(event.text));
    SEAM_OK(s.run());
    const std::int64_t id = db.last_rowid();
    SEAM_OK(seal_row(db, "events", "id", id));
    SEAM_TRY(const Digest digest, row_digest(db, "events", id));
    SEAM_OK(append_chain(db, person, "event", fmt::format_int(id).c_str(), digest));
    return id;
}

Expected<std::int64_t> ProjectFile::append_event(const EventRecord& event) {
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_TRY(const std::int64_t id, append_event_row(event));
    SEAM_OK(transaction.commit());
    return id;
}

Expected<std::int64_t> ProjectFile::append_event_row(const EventRecord& event) {
    return insert_event(impl_->db, impl_->name(), event, event.run);
}

Expected<std::vector<EventRecord>> ProjectFile::events(std::int64_t run) const {
    SEAM_OK(check_rows(impl_->db, "events", run ? "run" : nullptr, run));
    SEAM_TRY(auto s, impl_->db.prepare(fmt::format(
                         "SELECT id, utc, run, kind, subject, text, ifnull((SELECT person FROM chain WHERE "
                         "chain.kind = 'event' AND chain.subject = CAST(events.id AS TEXT)), '') FROM events "
                         "{}ORDER BY id",
                         run ? "WHERE run = ? " : "")));
    if (run) s.bind(1, run);
    std::vector<EventRecord> list;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        EventRecord event;
        event.id = row.integer(0);
        event.utc = row.text(1);
        event.run = row.integer(2);
        const auto kind = event_kind_from(row.text(3));
        if (!kind) return file_error("an event has an unknown kind", impl_->path.string());
        event.kind = *kind;
        event.subject = row.text(4);
        event.text = text_from_stored(row.text(5));
        event.person = row.text(6);
        list.push_back(std::move(event));
        return {};
    }));
    return list;
}

Expected<std::vector<StoredEvent>> ProjectFile::stored_events() const {
    SEAM_TRY(auto s, impl_->db.prepare("SELECT id, run, utc, kind, subject, text FROM events ORDER BY id"));
    std::vector<StoredEvent> list;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        list.push_back({row.integer(0), row.integer(1), row.text(2), row.text(3), row.text(4), row.text(5)});
        return {};
    }));
    return list;
}

}  // namespace seamwright
