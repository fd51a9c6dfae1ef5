// What was proven, with the setup it was proven with.

#include <fmt/format.h>

#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {

Expected<std::int64_t> ProjectFile::append_evidence(const Evidence& evidence, const Project& setup) {
    // A run without a screen is noted by itself; what else is proven is the work of who sets the cell up.
    if (!std::holds_alternative<HeadlessRun>(evidence.what)) SEAM_OK(may(Deed::teach));
    SEAM_TRY(auto with, RunSetup::of(setup));
    Database& db = impl_->db;
    SEAM_TRY(auto transaction, Transaction::begin(db));
    auto setup_number = setup_id(with);
    if (!setup_number) return setup_number;
    const std::string kind(kind_of(evidence));
    SEAM_TRY(auto text,
             std::visit([&](const auto& what) { return row_text(what, "evidence: " + kind, kResult); },
                        evidence.what));
    SEAM_TRY(auto s,
             db.prepare("INSERT INTO evidence (utc, kind, subject, setup, body) VALUES (?, ?, ?, ?, ?)"));
    const auto* frozen = std::get_if<FrozenContour>(&evidence.what);
    const auto* passes = std::get_if<TriggerPasses>(&evidence.what);
    const auto* returns = std::get_if<RobotReturns>(&evidence.what);
    const auto* plan = std::get_if<StudyPlan>(&evidence.what);
    s.bind(1, evidence.utc.empty() ? utc_now() : utf8_text(evidence.utc));
    s.bind(2, kind);
    s.bind(3, frozen    ? utf8_text(frozen->spot_id)
              : passes  ? utf8_text(passes->spot_id)
              : returns ? utf8_text(returns->robot_id)
              : plan    ? utf8_text(plan->region_id)
                        : std::string());
    s.bind(4, *setup_number);
    s.bind(5, text);
    SEAM_OK(s.run());
    const std::int64_t id = db.last_rowid();
    SEAM_OK(seal_row(db, "evidence", "id", id));
    SEAM_TRY(const Digest digest, row_digest(db, "evidence", id));
    SEAM_OK(append_chain(db, impl_->name(), "evidence", fmt::format_int(id).c_str(), digest, kind));
    SEAM_OK(transaction.commit());
    return id;
}

Expected<std::vector<Evidence>> ProjectFile::evidence(std::int64_t after) const {
    SEAM_OK(check_rows(impl_->db, "evidence"));
    SEAM_TRY(auto s,
             impl_->db.prepare("SELECT id, utc, kind, setup, body FROM evidence WHERE id > ? ORDER BY id"));
    s.bind(1, after);
    std::vector<Evidence> list;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        Evidence e;
        e.id = row.integer(0);
        e.utc = row.text(1);
        e.setup = row.integer(3);
        const std::string kind = row.text(2), body = row.text(4);
        const Text where("evidence {}", e.id);
        const auto read_as = [&]<class T>(T*) -> Expected<void> {
            SEAM_TRY(auto value, row_value<T>(body, where, impl_->path.string(), kResult));
            e.what = std::move(value);
            return {};
        };
        Expected<void> done = kind == kFrozenContour   ? read_as(static_cast<FrozenContour*>(nullptr))
                              : kind == kZeroShift     ? read_as(static_cast<ZeroShift*>(nullptr))
                              : kind == kKnownShift    ? read_as(static_cast<KnownShift*>(nullptr))
                              : kind == kHeadlessRun   ? read_as(static_cast<HeadlessRun*>(nullptr))
                              : kind == kRobotReturns  ? read_as(static_cast<RobotReturns*>(nullptr))
                              : kind == kTriggerPasses ? read_as(static_cast<TriggerPasses*>(nullptr))
                              : kind == kStudyPlan     ? read_as(static_cast<StudyPlan*>(nullptr))
                                                       : file_error("an evidence is of unknown kind",
                                                                    joined(impl_->path.string(), ": ", where));
        if (done) list.push_back(std::move(e));
        return done;
    }));
    return list;
}

}  // namespace seamwright
