#include "projects/acceptance/stored_acceptance.h"
#include "projects/hand_over/hand_over_detail.h"

namespace seamwright {
namespace {

void offsets_table(HandOverWriter& w) {
    report::Rows rows{{w.t("Region"), w.t("Version"), w.t("State"), "X mm", "Y mm", "Z mm", w.t("Source")}};
    for (const Region& region : w.project.regions)
        for (const KeptOffset& kept : region.offsets) {
            const KeptOffset* acting = acting_offset(region);
            rows.push_back({region.id, std::to_string(kept.version),
                            &kept == acting ? w.t("acts") : w.t("off"), w.number(kept.offset_mm.x(), 4),
                            w.number(kept.offset_mm.y(), 4), w.number(kept.offset_mm.z(), 4),
                            kept.source.in(w.options.language)});
        }
    if (rows.size() > 1) w.page.table(rows, w.t("Kept offsets"));
}

}  // namespace

Expected<void> acceptance_chapter(HandOverWriter& w, const ProjectFile& file) {
    std::vector<StoredAcceptance> regions;
    bool any = w.project.requirements.acceptance.tolerance_mm > 0;
    for (const Region& region : w.project.regions) {
        SEAM_TRY(auto stored, stored_acceptance(file, w.project, region.id));
        if (!regions.empty()) {  // robot and trigger are the cell's, not a region's
            stored.robot.reset();
            stored.trigger.reset();
        }
        any = any || stored.anything();
        regions.push_back(std::move(stored));
    }
    if (!any || regions.empty()) {
        w.page.heading(w.t("Acceptance of the measuring process"));
        w.page.paragraph(w.t("No tolerance is stated, and no study was made."));
        regions.clear();
    }
    for (const StoredAcceptance& stored : regions) {
        w.page.heading(w.t("Acceptance of the measuring process: region {}", stored.region_id));
        add_chapters(w.page, w.options.language, stored, 3);
    }
    offsets_table(w);
    return {};
}

}  // namespace seamwright
