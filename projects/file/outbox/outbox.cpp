#include "projects/file/outbox/outbox.h"

#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {

Expected<void> queue_run(Database& db, std::int64_t run) {
    SEAM_TRY(auto s, db.prepare("INSERT OR REPLACE INTO outbox (run, revision, message, checksum) "
                                "SELECT ?1, max(number), '', row_checksum(?1, max(number), '') FROM chain"));
    s.bind(1, run);
    return s.run();
}

Expected<void> forget_queued(Database& db, std::int64_t run) {
    SEAM_TRY(auto s, db.prepare("DELETE FROM outbox WHERE run = ? AND message = ''"));
    s.bind(1, run);
    return s.run();
}

Expected<std::int64_t> ProjectFile::queued() const {
    return impl_->db.integer("SELECT count(*) FROM outbox");
}

Expected<std::vector<QueuedRun>> ProjectFile::queued_runs(std::int64_t after_run, std::int64_t most) const {
    SEAM_TRY(auto s, impl_->db.prepare(
                         "SELECT run, revision, message, row_checksum(run, revision, message) IS checksum, "
                         "ifnull((SELECT lower(hex(hash)) FROM chain WHERE kind = 'run' AND subject = "
                         "CAST(outbox.run AS TEXT) ORDER BY chain.number LIMIT 1), '') "
                         "FROM outbox WHERE run > ? ORDER BY run LIMIT ?"));
    s.bind(1, after_run);
    s.bind(2, most);
    std::vector<QueuedRun> runs;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        QueuedRun run{row.integer(0), row.integer(1), row.text(4), row.text(2)};
        if (row.integer(3) == 0 || run.id.size() != 64)
            return file_error("an entry of the project file cannot be read",
                              Text("{}: outbox, run {}", impl_->path.string(), run.run),
                              "take the last good copy from the backup");
        runs.push_back(std::move(run));
        return {};
    }));
    return runs;
}

Expected<void> ProjectFile::keep_message(const QueuedRun& run, const std::string& message) {
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_TRY(auto s, impl_->db.prepare("UPDATE outbox SET message = ?3, checksum = row_checksum(?1, ?2, ?3) "
                                       "WHERE run = ?1 AND revision = ?2"));
    s.bind(1, run.run);
    s.bind(2, run.revision);
    s.bind(3, message);
    SEAM_OK(s.run());
    return transaction.commit();
}

Expected<void> ProjectFile::published(std::span<const QueuedRun> runs) {
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_TRY(auto s, impl_->db.prepare("DELETE FROM outbox WHERE run = ? AND revision = ?"));
    for (const QueuedRun& run : runs) {
        s.bind(1, run.run);
        s.bind(2, run.revision);
        SEAM_OK(s.run());
    }
    return transaction.commit();
}

}  // namespace seamwright
