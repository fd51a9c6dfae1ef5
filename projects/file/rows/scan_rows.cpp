// Scans that are kept with the project.

#include <algorithm>

#include "devices/capture/capture.h"
#include "projects/file/id_length.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {
namespace {

Error no_scan(const std::string& name, const std::string& path) {
    return Error{ErrorKind::input, Text("the project has no scan \"{}\"", name), path,
                 "list those that it has: seamwright scan FILE.seam --list"};
}

StoredScan scan_of_row(Statement& row) {
    return {row.text(0), row.text(1),    row.text(2),    row.text(3),
            row.text(4), row.integer(5), row.integer(6), {}};
}

}  // namespace

Expected<void> ProjectFile::append_scan(const StoredScan& scan) {
    Database& db = impl_->db;
    const std::string name = utf8_text(scan.name);
    if (name.empty() || is_too_long(name))
        return input_error(Text("a scan's name has 1 to {} signs", kLongestId), db.path(),
                           "give another name");
    if (scan.cloud_ply.empty()) return input_error("the scan has no cloud", name);
    if (scan.cloud_ply.size() > kLargestScan)
        return input_error(Text("the scan is larger than {} MiB", kLargestScan >> 20), name,
                           "thin it: --cell-mm 0.5");
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_TRY(auto known, scans());
    if (std::ranges::find(known, name, &StoredScan::name) != known.end())
        return input_error(Text("the project has a scan \"{}\" already", name), db.path(),
                           "give another name");
    SEAM_TRY(auto s,
             db.prepare("INSERT INTO scans (name, utc, sensor_id, robot_id, path, profiles, points, cloud, "
                        "checksum) VALUES (?, ?, ?, ?, ?, ?, ?, ?, 0)"));
    const std::string utc = scan.utc.empty() ? utc_now() : utf8_text(scan.utc),
                      sensor = utf8_text(scan.sensor_id), robot = utf8_text(scan.robot_id),
                      path = utf8_text(scan.path);
    s.bind(1, name);
    s.bind(2, utc);
    s.bind(3, sensor);
    s.bind(4, robot);
    s.bind(5, path);
    s.bind(6, scan.profiles);
    s.bind(7, scan.points);
    s.bind(8, std::span<const std::byte>(scan.cloud_ply));
    SEAM_OK(s.run());
    SEAM_OK(seal_row(db, "scans", "id", db.last_rowid()));
    SEAM_TRY(const Digest digest, row_digest(db, "scans", name));
    SEAM_OK(append_chain(db, impl_->name(), "scan", name, digest));
    return transaction.commit();
}

Expected<std::vector<StoredScan>> ProjectFile::scans() const {
    SEAM_TRY(auto s,
             impl_->db.prepare(
                 "SELECT name, utc, sensor_id, robot_id, path, profiles, points FROM scans ORDER BY id"));
    std::vector<StoredScan> list;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        list.push_back(scan_of_row(row));
        return {};
    }));
    return list;
}

Expected<StoredScan> ProjectFile::load_scan(const std::string& name) const {
    SEAM_OK(check_rows(impl_->db, "scans"));
    SEAM_TRY(auto s,
             impl_->db.prepare("SELECT name, utc, sensor_id, robot_id, path, profiles, points, cloud FROM "
                               "scans WHERE name = ?"));
    s.bind(1, name);
    std::vector<StoredScan> found;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        found.push_back(scan_of_row(row));
        const auto cloud = row.blob(7);
        found.back().cloud_ply.assign(cloud.begin(), cloud.end());
        return {};
    }));
    if (found.empty()) return tl::unexpected(no_scan(name, impl_->path.string()));
    return std::move(found.front());
}

Expected<void> ProjectFile::delete_scan(const std::string& name) {
    Database& db = impl_->db;
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_TRY(auto known, scans());
    if (std::ranges::find(known, name, &StoredScan::name) == known.end())
        return tl::unexpected(no_scan(name, impl_->path.string()));
    SEAM_OK(may(Deed::remove));
    SEAM_TRY(auto s, db.prepare("DELETE FROM scans WHERE name = ?"));
    s.bind(1, name);
    SEAM_OK(s.run());
    SEAM_OK(append_chain(db, impl_->name(), "scan", name, {}));
    return transaction.commit();
}

}  // namespace seamwright
