// The contours that paths were corrected online by.

#include "devices/capture/capture.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {
namespace {
constexpr std::size_t kShortestHash = 8;  // of a hash that a person types
}

Expected<StoredGuide> ProjectFile::keep_guide(const std::string& name, const std::string& csv) {
    Database& db = impl_->db;
    if (csv.empty()) return input_error("the guide is empty", name);
    if (csv.size() > kLargestGuide)
        return input_error(Text("the guide is larger than {} MiB", kLargestGuide >> 20), name,
                           "take fewer points of it");
    const StoredGuide guide{utf8_text(name), csv, utc_now(), hex(sha256(csv))};
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_TRY(const auto known, guides());
    for (const StoredGuide& g : known)
        if (g.hash == guide.hash) return g;
    SEAM_TRY(auto s,
             db.prepare("INSERT INTO guides (hash, name, utc, csv, checksum) VALUES (?, ?, ?, ?, 0)"));
    s.bind(1, guide.hash);
    s.bind(2, guide.name);
    s.bind(3, guide.utc);
    s.bind(4, guide.csv);
    SEAM_OK(s.run());
    SEAM_OK(seal_row(db, "guides", "rowid", db.last_rowid()));
    SEAM_TRY(const Digest digest, row_digest(db, "guides", guide.hash));
    SEAM_OK(append_chain(db, impl_->name(), "guide", guide.hash, digest));
    SEAM_OK(transaction.commit());
    return guide;
}

Expected<std::vector<StoredGuide>> ProjectFile::guides() const {
    SEAM_OK(check_rows(impl_->db, "guides"));
    SEAM_TRY(auto s, impl_->db.prepare("SELECT name, csv, utc, hash FROM guides ORDER BY rowid"));
    std::vector<StoredGuide> list;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        list.push_back({row.text(0), row.text(1), row.text(2), row.text(3)});
        return {};
    }));
    return list;
}

Expected<StoredGuide> ProjectFile::load_guide(const std::string& called) const {
    SEAM_TRY(const auto list, guides());
    for (auto g = list.rbegin(); g != list.rend(); ++g)
        if (g->name == called || (called.size() >= kShortestHash && g->hash.starts_with(called))) return *g;
    return input_error(Text("the project has no guide \"{}\"", called), impl_->path.string(),
                       "list those that it has: seamwright follow FILE.seam --guides");
}

}  // namespace seamwright
