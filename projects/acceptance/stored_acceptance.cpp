#include "projects/acceptance/stored_acceptance.h"

#include <algorithm>

#include "projects/acceptance/equipment/device_studies.h"
#include "projects/acceptance/pages/acceptance_page.h"
#include "projects/acceptance/study/stored_values.h"

namespace seamwright {
namespace {

Expected<const Region*> region_in(const Project& project, const std::string& id) {
    if (project.regions.empty()) return input_error("the project has no region", project.name);
    if (id.empty() && project.regions.size() > 1)
        return usage_error(Text("the project has {} regions", project.regions.size()), project.name,
                           "choose one");
    for (const Region& region : project.regions)
        if (id.empty() || region.id == id) return &region;
    return usage_error(Text("there is no region \"{}\"", id), project.name);
}

Expected<Acceptance> studies_of(const ProjectFile& file, const Project& project, StoredAcceptance& stored,
                                const AcceptanceExtras& extras) {
    if (stored.settings.tolerance_mm == 0)
        return input_error("the tolerance is not stated", {}, "state the customer's T = USL - LSL");
    SEAM_TRY(auto values, stored_values(file, project, stored.region_id));
    if (!extras.references.empty()) add_references(values.values, extras.references);
    stored.settings.part = values.reference_part;
    return judge_acceptance(std::move(values.values), std::move(values.source), stored.settings, kStudies);
}

}  // namespace

Expected<StoredAcceptance> stored_acceptance(const ProjectFile& file, const Project& project,
                                             const std::string& region_id, const AcceptanceExtras& extras) {
    SEAM_TRY(auto region, region_in(project, region_id));
    StoredAcceptance stored;
    stored.region_id = region->id;
    require(stored.settings, project.requirements.acceptance);
    if (auto studies = studies_of(file, project, stored, extras); studies)
        stored.studies = std::move(*studies);
    else if (studies.error().kind == ErrorKind::file)
        return tl::unexpected(studies.error());
    else
        stored.lacking = studies.error();
    if (stored.studies && stored.studies->source.forecast)
        stored.forecast = stored.studies->source.forecast;
    else if (auto forecast = forecast_studies(project, *region))
        stored.forecast = *forecast;
    SEAM_TRY(auto robot, stored_robot_study(file, {}, &project));
    stored.robot = std::move(robot);
    SEAM_TRY(auto trigger, stored_trigger_study(file, &project));
    stored.trigger = std::move(trigger);
    if (!extras.sensor_data.is_null()) {
        if (auto sensor = sensor_check(extras.sensor_data, extras.sensor_data_from, &project))
            stored.sensor = std::move(*sensor);
        else
            stored.sensor_lacking = sensor.error();
    }
    return stored;
}

void add_chapters(report::Page& page, Language language, const StoredAcceptance& stored, int level) {
    if (stored.studies)
        add_chapters(page, language, *stored.studies, level);
    else if (stored.lacking)
        page.verdict(Text("not made").in(language), report::Tone::attention,
                     stored.lacking->text().in(language));
    if (stored.robot) add_chapter(page, language, *stored.robot, level);
    if (stored.trigger) add_chapter(page, language, *stored.trigger, level);
    if (stored.sensor) add_chapter(page, language, *stored.sensor, level);
    if (stored.studies) add_studies_not_done(page, language, *stored.studies, level);
}

report::Page acceptance_page(const StoredAcceptance& stored, const std::string& file, Language language,
                             const std::string& program) {
    report::Page page = begin_acceptance_page(file, language, {}, program);
    add_chapters(page, language, stored);
    add_signatures(page, language, stored.studies ? &*stored.studies : nullptr);
    return page;
}

QdasStudy qdas_study(const Acceptance& a) {
    const StudySource& s = a.source;
    QdasStudy q;
    q.part_number = s.part_name.empty() ? s.file : s.part_name;
    q.part_name = s.part_name;
    q.machine_number = s.robot_serial;
    q.machine_name = s.robot;
    q.gauge_number = s.sensor_serial;
    q.gauge_name = s.sensor;
    q.characteristic_number = "1";
    q.characteristic_name = s.measurand.empty() ? "deviation across the bead"
                                                : fmt::format("deviation across the bead, {}{}",
                                                              s.measurand.in(Language::english),
                                                              s.simulated ? " (simulated)" : "");
    q.nominal_mm = a.settings.nominal_mm;
    q.lower_mm = q.nominal_mm - a.settings.tolerance_mm / 2;
    q.upper_mm = q.nominal_mm + a.settings.tolerance_mm / 2;
    q.values = a.values.all();
    return q;
}

}  // namespace seamwright
