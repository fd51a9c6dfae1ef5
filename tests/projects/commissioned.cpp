#include "tests/projects/commissioned.h"

#include <algorithm>
#include <cmath>

#include "core/alignment/alignment.h"
#include "devices/simulated/scene/door.h"
#include "projects/measure/measure.h"
#include "projects/reuse/simulated_truth.h"
#include "projects/station/teach.h"

namespace seamwright {
namespace {

// The accepted points left of `to_mm`, as a window dragged over the live profile takes them.
Profile piece_of(const Profile& profile, double to_mm) {
    Profile piece;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        if (profile.segment[i] == kOutlier || profile.x_mm[i] > to_mm) continue;
        piece.x_mm.push_back(profile.x_mm[i]);
        piece.z_mm.push_back(profile.z_mm[i]);
        piece.segment.push_back(profile.segment[i]);
    }
    return piece;
}

}  // namespace

Expected<Project> bare_project(const nlohmann::json& settings) {
    auto cell = SimulatedCell::open(settings);
    if (!cell) return tl::unexpected(cell.error());
    Project p;
    p.name = "door";
    p.part.base_from_workobject = (*cell)->base_from_workobject();
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "simulated";
    sensor.settings = settings;
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "simulated";
    robot.settings = settings;
    sensor.identity = make_simulated_sensor(*cell)->identity();
    robot.identity = *make_simulated_robot(*cell)->identity();
    auto truth = simulated_truth(sensor, robot);
    if (!truth) return tl::unexpected(truth.error());
    sensor.calibration_id = truth->id;
    p.sensors = {sensor};
    p.robots = {robot};
    p.calibrations = {*truth};
    return p;
}

Expected<void> commission_spot(Station& station, const SimulatedCell& cell, const PlannedSpot& planned,
                               int turns) {
    Project project = station.project();
    Spot spot;
    spot.id = "S" + std::to_string(project.spots.size() + 1);
    spot.sensor_id = project.sensors[0].id;
    spot.robot_id = project.robots[0].id;
    spot.base_from_flange = cell.flange_for(default_door_spots()[planned.door].workobject_from_sensor);
    spot.feature.kind = "contour-end";
    spot.feature.parameters["side"] = 0;
    if (planned.by == TaughtBy::wide_template) {
        // Seen once by another feature, to have a profile to drag a window over.
        auto seen = teach_spot(station, spot, {1, {}, {}});
        if (!seen) return tl::unexpected(seen.error());
        const Profile& profile = seen->spot.reference_profile;
        double left = 1e9;
        for (std::size_t i = 0; i < profile.size(); ++i)
            if (profile.segment[i] != kOutlier) left = std::min(left, profile.x_mm[i]);
        spot.feature = {};
        spot.feature.kind = "template";
        spot.feature.template_profile = piece_of(profile, left + 42);
        const Profile& piece = spot.feature.template_profile;
        spot.feature.template_reference_mm = {piece.x_mm[piece.size() / 2], piece.z_mm[piece.size() / 2]};
    }
    for (int turn = 0; turn <= turns; ++turn) {
        auto taught = teach_spot(station, spot, {5, {}, {}});
        if (!taught) return tl::unexpected(taught.error());
        spot = taught->spot;
        auto pass = record_pass(station, spot, {2, {}, {}});
        if (!pass) return tl::unexpected(pass.error());
        AlignmentOptions options;
        options.jitter_mm = spot.jitter_mm;
        options.window_mm = std::max(spot.entry_mm, spot.exit_mm);
        options.reference_mm = Eigen::Vector2d(spot.reference_mm.x(), spot.reference_mm.z());
        const auto judged = check_alignment(pass->profiles, options);
        if (!judged) return tl::unexpected(judged.error());
        const auto curve = fit_contour_curve(pass->references);
        if (judged->status == AlignmentStatus::frozen && curve) {
            spot.curve = *curve;
            project.spots.push_back(spot);
            if (auto saved = station.edit(project); !saved) return saved;
            auto kept = station.file().append_evidence({0, {}, 0, frozen_contour(spot.id, *judged, options)},
                                                       project);
            if (!kept) return tl::unexpected(kept.error());
            return {};
        }
        spot = cured(spot, *judged, cell.flange_from_sensor());
    }
    return input_error("its contour does not stand still", "spot " + spot.id);
}

Expected<void> add_region(Station& station) {
    Project project = station.project();
    Region region;
    region.id = "Region1";
    region.frame_name = "BASE_Region1";
    region.base_from_frame = project.part.base_from_workobject;
    for (const Spot& spot : project.spots) region.spot_ids.push_back(spot.id);
    project.regions = {region};
    return station.edit(project);
}

}  // namespace seamwright
