#include "projects/elastic/stored_shapes.h"

#include <algorithm>
#include <map>

#include "projects/file/project_json.h"

namespace seamwright {
namespace {

// All that a spot's observation is made of, as text.
std::string taught_as(const Project& project, const Region& region) {
    nlohmann::json all = nlohmann::json::array();
    const ArchiveOptions exact{.profiles = false, .rigid_poses = false, .patterns = false};
    all.push_back(to_json_document(project.part, exact));
    for (const std::string& id : region.spot_ids) {
        const Spot* spot = find_spot(project, id);
        if (!spot || !spot->enabled) continue;
        all.push_back(to_json_document(*spot, exact));
        if (const Calibration* c = calibration_of(project, *spot)) {
            Calibration slim = *c;
            slim.raw = slim.result = nlohmann::json::object();
            all.push_back(to_json_document(slim, exact));
        }
    }
    return all.dump();
}

Expected<const Region*> region_of(const Project& project, const std::string& id, const std::string& file) {
    if (project.regions.empty()) return input_error("the project has no region", file);
    if (id.empty() && project.regions.size() > 1)
        return usage_error(Text("the project has {} regions", project.regions.size()), file,
                           "name one with --region");
    for (const Region& region : project.regions)
        if (id.empty() || region.id == id) return &region;
    return usage_error(Text("there is no region \"{}\"", id), file);
}

// Spots of the region as observations name them; measured_mm is not looked at.
std::vector<ElasticSpot> spots_of(const Project& project, const Region& region) {
    std::vector<ElasticSpot> out;
    for (const std::string& id : region.spot_ids) {
        const Spot* spot = find_spot(project, id);
        const Calibration* c = spot && spot->enabled ? calibration_of(project, *spot) : nullptr;
        if (!c) continue;
        const SpotObservation o =
            observation(*spot, project.part.base_from_workobject, c->flange_from_sensor, SpotMeasurement{});
        out.push_back({id, o.workobject_from_sensor, o.reference_mm, o.weights});
    }
    return out;
}

}  // namespace

Expected<StoredShapes> stored_shapes(const ProjectFile& file, const std::string& region_id) {
    SEAM_TRY(const Project project, file.load());
    SEAM_TRY(const Region* const region, region_of(project, region_id, file.path().string()));
    StoredShapes out;
    out.region_id = region->id;
    out.spots = spots_of(project, *region);
    out.options = correction_options(project, *region);
    out.options.reject_outliers = false;
    out.options.limits = {};
    const std::string now = taught_as(project, *region);
    RegionCorrector corrector(project, *region);
    RegionSolver solver;
    RegionCorrection correction;
    std::map<std::int64_t, bool> same;
    SEAM_TRY(const auto runs, file.runs());
    for (const RunSummary& summary : runs) {
        if (summary.status == RunStatus::interrupted || summary.status == RunStatus::cancelled ||
            summary.status == RunStatus::device || summary.spots == 0)
            continue;
        auto known = same.find(summary.setup);
        if (known == same.end()) {
            SEAM_TRY(const Project then, file.load_setup(summary.setup));
            const auto at = std::ranges::find(then.regions, region->id, &Region::id);
            known =
                same.emplace(summary.setup, at != then.regions.end() && taught_as(then, *at) == now).first;
        }
        if (!known->second) {
            ++out.other_setup;
            continue;
        }
        SEAM_TRY(const RunRecord run, file.load_run(summary.number, false));
        StoredShape shape;
        shape.observations =
            region_observations(project, *region, without_drift(project, run.spots, acting_drift(run)));
        const auto rigid =
            shape.observations.empty() ? Expected<void>{} : corrector.correct(shape.observations, correction);
        const auto solved = shape.observations.empty() || !rigid
                                ? rigid
                                : solver.solve(shape.observations, out.options, correction);
        if (shape.observations.empty() || !solved || correction.status != CorrectionStatus::ok ||
            correction.redundancy < 1) {
            ++out.too_little;
            continue;
        }
        shape.displacement = correction.displacement;
        shape.run = {run.number, run.part_id.empty() ? "run " + std::to_string(run.number) : run.part_id,
                     run.started_utc};
        out.shapes.push_back(std::move(shape));
    }
    if (out.shapes.empty())
        return input_error(Text("no stored run tells how the parts of region {} bend", region->id),
                           file.path().string(), "measure parts with the spots as they are now; dry runs do");
    return out;
}

}  // namespace seamwright
