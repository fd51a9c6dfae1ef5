// The drift watch and its points.

#include <fmt/format.h>

#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {

Expected<std::int64_t> ProjectFile::append_drift_point(const DriftPoint& point) {
    Database& db = impl_->db;
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_TRY(auto text, row_text(point, "drift watch", kResult));
    SEAM_TRY(auto s, db.prepare("INSERT INTO drift_points (run, body) VALUES (?, ?)"));
    s.bind(1, point.run);
    s.bind(2, text);
    SEAM_OK(s.run());
    const std::int64_t id = db.last_rowid();
    SEAM_OK(seal_row(db, "drift_points", "id", id));
    SEAM_TRY(const Digest digest, row_digest(db, "drift_points", id));
    SEAM_OK(append_chain(db, impl_->name(), "drift point", fmt::format_int(id).c_str(), digest));
    SEAM_OK(transaction.commit());
    return id;
}

Expected<std::optional<DriftWatch>> ProjectFile::load_drift_watch() const {
    SEAM_OK(check_rows(impl_->db, "drift_watch"));
    SEAM_TRY(auto s, impl_->db.prepare("SELECT body FROM drift_watch ORDER BY position LIMIT 1"));
    std::optional<DriftWatch> watch;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        SEAM_TRY(watch, row_value<DriftWatch>(row.text(0), "drift watch", impl_->path.string(), kRow));
        return {};
    }));
    return watch;
}

Expected<std::vector<DriftPoint>> ProjectFile::drift_points(std::int64_t newest) const {
    SEAM_OK(check_rows(impl_->db, "drift_points"));
    SEAM_TRY(
        auto s,
        impl_->db.prepare(
            "SELECT id, body FROM drift_points WHERE id IN (SELECT id FROM drift_points ORDER BY id DESC "
            "LIMIT ?) OR json_extract(body, '$.step') ORDER BY id"));
    s.bind(1, newest > 0 ? newest : -1);
    std::vector<DriftPoint> points;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        SEAM_TRY(auto point, row_value<DriftPoint>(row.text(1), Text("drift point {}", row.integer(0)),
                                                   impl_->path.string(), kResult));
        point.id = row.integer(0);
        points.push_back(std::move(point));
        return {};
    }));
    return points;
}

}  // namespace seamwright
