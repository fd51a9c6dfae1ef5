#include "projects/drift/drift_point.h"

#include <algorithm>
#include <set>

#include "projects/file/project_json.h"

namespace seamwright {
namespace {

// FNV-1a.
void add(std::uint32_t& mark, const std::string& text) {
    for (const char c : text) mark = (mark ^ static_cast<unsigned char>(c)) * 16777619u;
}

}  // namespace

const Spot* drift_spot(const Project& project, const std::string& id) {
    const auto it = std::find_if(project.spots.begin(), project.spots.end(),
                                 [&](const Spot& spot) { return spot.id == id; });
    return it == project.spots.end() ? nullptr : &*it;
}

bool is_drift_reference(const Project& project, const Spot& spot) {
    return project.drift &&
           std::ranges::find(project.drift->spot_ids, spot.id) != project.drift->spot_ids.end();
}

bool references_alone(const Project& project) {
    return project.regions.empty() && std::ranges::any_of(project.spots, &Spot::enabled) &&
           std::ranges::all_of(project.spots, [&](const Spot& spot) {
               return !spot.enabled || is_drift_reference(project, spot);
           });
}

std::uint32_t drift_mark(const Project& project, const DriftWatch& watch) {
    std::uint32_t mark = 2166136261u;
    for (const std::string& id : watch.spot_ids) {
        const Spot* spot = drift_spot(project, id);
        if (!spot) continue;
        // What the reference is, and where it was expected, changes nothing of what is measured.
        Spot measured = *spot;
        measured.reference_mm.setZero();
        measured.reference_profile = {};
        measured.reference_arrivals = 1;
        measured.reference_state = ReferenceState::measured;
        measured.curve.reset();
        measured.weights.setOnes();
        measured.required = measured.enabled = true;
        add(mark, to_json_document(measured, {}).dump());
        for (const SensorSetup& sensor : project.sensors)
            if (sensor.id == spot->sensor_id) add(mark, "\n" + sensor.calibration_id + "\n");
    }
    return mark;
}

std::optional<DriftPoint> drift_point(const Project& project, const DriftWatch& watch, const RunRecord& run) {
    if (watch.spot_ids.empty()) return std::nullopt;
    DriftPoint point;
    point.run = run.number;
    point.utc = run.started_utc;
    point.mark = drift_mark(project, watch);
    for (const std::string& id : watch.spot_ids) {
        const auto m = std::find_if(run.spots.begin(), run.spots.end(),
                                    [&](const SpotMeasurement& s) { return s.spot_id == id; });
        if (m == run.spots.end() || m->status != SpotStatus::measured) return std::nullopt;
        for (const int axis : {0, 2}) {
            point.values_mm.push_back(m->measured_mm[axis]);
            point.sigma_mm.push_back(m->sigma_mm);
        }
    }
    return point;
}

Expected<void> check_drift_watch(const Project& project, const DriftWatch& watch) {
    const Text where("drift watch");
    if (watch.spot_ids.empty())
        return input_error("it names no reference spot", where, "name one: drift FILE.seam set --spots W1");
    std::set<std::string> seen;
    for (const std::string& id : watch.spot_ids) {
        const Spot* spot = drift_spot(project, id);
        if (!spot) return input_error(Text("the project has no spot {}", id), where, "name one that it has");
        if (!seen.insert(id).second)
            return input_error(Text("spot {} is named twice", id), where, "name it once");
        if (!spot->enabled) return input_error(Text("spot {} is switched off", id), where, "switch it on");
        for (const Region& region : project.regions)
            if (std::find(region.spot_ids.begin(), region.spot_ids.end(), id) != region.spot_ids.end())
                return input_error(Text("spot {} is one of region {}: it moves with the part", id, region.id),
                                   where, "name spots on something that is fixed in the cell");
        const Spot* first = drift_spot(project, watch.spot_ids.front());
        if (spot->sensor_id != first->sensor_id || spot->robot_id != first->robot_id)
            return input_error(Text("spot {} is of another sensor or robot than spot {}", id, first->id),
                               where, "watch one sensor on one robot");
    }
    return {};
}

}  // namespace seamwright
