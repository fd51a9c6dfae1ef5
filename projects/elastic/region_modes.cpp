#include "projects/elastic/region_modes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/elastic/bead_shape.h"

namespace seamwright {
namespace {

constexpr int kFolds = 5;

// Rows of the shapes, without one spot where `left_out` names it.
Expected<std::vector<ElasticRow>> rows_of(const StoredShapes& shapes, const std::vector<ElasticSpot>& spots,
                                          const std::vector<std::string>& parts, int fold,
                                          const std::string& left_out) {
    std::vector<ElasticRow> rows;
    for (const StoredShape& shape : shapes.shapes) {
        const auto part = std::ranges::find(parts, shape.run.part_id) - parts.begin();
        if (fold >= 0 && part % kFolds == fold) continue;
        std::vector<SpotObservation> seen = shape.observations;
        std::erase_if(seen, [&](const SpotObservation& o) { return o.id == left_out; });
        auto row = elastic_row(spots, seen, shapes.options, shape.displacement);
        if (!row) continue;  // too few spots without this one
        row->id = "run " + std::to_string(shape.run.run);
        row->part_id = shape.run.part_id;
        rows.push_back(std::move(*row));
    }
    return rows;
}

std::vector<std::string> parts_of(const StoredShapes& shapes) {
    std::vector<std::string> parts;
    for (const StoredShape& s : shapes.shapes)
        if (std::ranges::find(parts, s.run.part_id) == parts.end()) parts.push_back(s.run.part_id);
    return parts;
}

struct Predictions {
    std::vector<double> rigid, elastic;
    double stated = 0;
    int count = 0, acted = 0, inside = 0, judged = 0;
};

// How far a spot's measure lies from where D and the shape put it, along the directions that it tells.
// `noise_factor`: its scatter over its stated sigma, as learnt.
void predict(const SpotObservation& spot, double noise_factor, const ElasticCorrection& joint,
             const RegionCorrection& rigid, const BeadShape& shape, Predictions& out) {
    const BeadPlace place{spot.workobject_from_sensor * spot.reference_mm, 0};
    const BeadPoint point = bead_point(joint, shape, place);
    const Pose& d = joint.correction.displacement.workobject_from_movedworkobject;
    const Eigen::Vector3d measured = spot.workobject_from_sensor * spot.measured_mm;
    const Eigen::Vector3d of_rigid =
        rigid.displacement.workobject_from_movedworkobject.inverse() * measured - place.place_mm;
    const Eigen::Vector3d of_joint = d.inverse() * (measured - point.place_mm + d.translation());
    for (int i = 0; i < 3; ++i) {
        if (!(spot.weights[i] > 0)) continue;
        const Eigen::Vector3d axis = spot.workobject_from_sensor.linear().col(i);
        const Eigen::Vector3d moved = d.linear() * axis;
        out.rigid.push_back(axis.dot(of_rigid));
        out.elastic.push_back(axis.dot(of_joint));
        double noise = spot.sigma_mm * spot.sigma_mm;
        if (spot.covariance_mm2 && i != 1) noise = (*spot.covariance_mm2)(i / 2, i / 2);
        const double variance = moved.dot(point.covariance_mm2 * moved) + noise_factor * noise_factor * noise;
        out.stated += variance;
        if (!joint.acted) continue;
        ++out.judged;
        out.inside += std::abs(out.elastic.back()) < 1.96 * std::sqrt(variance);
    }
    ++out.count;
    out.acted += joint.acted;
}

}  // namespace

Expected<RegionModes> learn_region(const StoredShapes& shapes, const std::string& now_utc) {
    RegionModes out;
    out.id = shapes.region_id;
    out.learnt_utc = now_utc;
    SEAM_TRY(const auto rows, rows_of(shapes, shapes.spots, parts_of(shapes), -1, {}));
    SEAM_TRY(out.modes, learn_modes(shapes.spots, rows));
    for (const StoredShape& s : shapes.shapes) out.learnt_from.push_back(s.run);
    return out;
}

void put_modes(Project& project, RegionModes modes) {
    for (RegionModes& old : project.elastic)
        if (old.id == modes.id) {
            old = std::move(modes);
            return;
        }
    project.elastic.push_back(std::move(modes));
}

Expected<void> switch_modes(Project& project, const std::string& region, bool on, double most_added_mm,
                            const std::string& now_utc) {
    const Text where("region {}: modes", region);
    for (RegionModes& modes : project.elastic) {
        if (modes.id != region) continue;
        if (modes.on == on)
            return input_error(on ? Text("they are on already") : Text("they are off already"), where);
        if (on && modes.modes.modes.empty())
            return input_error("the learning found no mode, there is nothing to switch on", where,
                               "learn again from more parts");
        if (on) SEAM_OK(check_modes(modes.modes));
        modes.on = on;
        modes.switched_utc = now_utc;
        if (on) modes.most_added_mm = most_added_mm;
        return {};
    }
    return input_error("none were learnt", where, "learn them first: modes FILE.seam learn");
}

Expected<ModesComparison> compare_region(const StoredShapes& shapes) {
    ModesComparison out;
    out.region_id = shapes.region_id;
    const std::vector<std::string> parts = parts_of(shapes);
    out.parts = static_cast<int>(parts.size());
    SEAM_TRY(const auto all, rows_of(shapes, shapes.spots, parts, -1, {}));
    SEAM_TRY(const ElasticModes learnt, learn_modes(shapes.spots, all));
    out.modes = static_cast<int>(learnt.modes.size());
    LearnOptions decided;
    // As many as all parts together asked for.
    decided.most_modes = out.modes;
    decided.gain_sigmas = decided.least_gain = -std::numeric_limits<double>::max();
    decided.fewest_parts = 2;
    Predictions found;
    for (const ElasticSpot& left_out : shapes.spots) {
        const auto of_all = std::ranges::find(learnt.spots, left_out.id, &ElasticSpot::id);
        const double noise_factor = std::max(1.0, learnt.noise_factor * of_all->noise_factor);
        std::vector<ElasticSpot> spots = shapes.spots;
        std::erase_if(spots, [&](const ElasticSpot& s) { return s.id == left_out.id; });
        std::vector<BeadPlace> places;
        for (const ElasticSpot& s : spots) places.push_back({s.place_mm(), 0});
        for (int fold = 0; fold < kFolds; ++fold) {
            SEAM_TRY(const auto rows, rows_of(shapes, spots, parts, fold, left_out.id));
            if (rows.empty()) continue;
            SEAM_TRY(const ElasticModes modes, learn_modes(spots, rows, decided));
            auto shape = BeadShape::make(modes, places, {});
            if (!shape) continue;
            for (const StoredShape& part : shapes.shapes) {
                if ((std::ranges::find(parts, part.run.part_id) - parts.begin()) % kFolds != fold) continue;
                std::vector<SpotObservation> seen = part.observations;
                const auto at = std::ranges::find(seen, left_out.id, &SpotObservation::id);
                if (at == seen.end()) continue;
                const SpotObservation spot = *at;
                seen.erase(at);
                const auto rigid = solve_region(seen, shapes.options);
                const auto joint = solve_elastic(seen, shapes.options, modes);
                if (!rigid || !joint || rigid->status != CorrectionStatus::ok) continue;
                predict(spot, noise_factor, *joint, *rigid, *shape, found);
            }
        }
    }
    if (found.count == 0)
        return input_error("no spot can be predicted from the others", Text("region {}", shapes.region_id),
                           "measure more parts, or add spots");
    out.predictions = found.count;
    out.acted = found.acted;
    out.rigid = summarise(found.rigid);
    out.elastic = summarise(found.elastic);
    out.stated_three_sigma = 3 * std::sqrt(found.stated / static_cast<double>(found.elastic.size()));
    out.inside = found.judged > 0 ? static_cast<double>(found.inside) / found.judged : 1;
    return out;
}

}  // namespace seamwright
