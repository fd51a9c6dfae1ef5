#include "app/studio/demo_project.h"

#include "core/features/kinds/feature_registry.h"
#include "devices/exchange/pose_json.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/scene/door.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/measure/measure.h"
#include "projects/reuse/simulated_truth.h"

namespace seamwright {
namespace {

constexpr const char* kSensor = "A";
constexpr const char* kRobot = "R1";
constexpr double kTravelMm = 20;

// The door's edge as a function of the sensor's travel: where the edge crosses the planes y = const.
Expected<ContourCurve> edge_curve(const DoorSpot& spot) {
    const Pose sensor_from_workobject = spot.workobject_from_sensor.inverse();
    double nearest = 0, best = std::numeric_limits<double>::infinity();
    const Eigen::Vector3d origin = spot.workobject_from_sensor * spot.edge_mm;
    for (double s = 0; s < door_edge_length_mm(); s += 1) {
        const double d = (door_edge(s).point_mm - origin).norm();
        if (d < best) best = d, nearest = s;
    }
    std::vector<TravelPoint> points;
    for (double s = nearest - kTravelMm; s <= nearest + kTravelMm; s += 1) {
        const DoorEdge edge = door_edge(s);
        const Eigen::Vector3d p = sensor_from_workobject * (edge.point_mm + edge.up * 1.5);
        points.push_back({p.y(), p.x(), p.z()});
    }
    return fit_contour_curve(points);
}

}  // namespace

Expected<Project> demo_project() {
    nlohmann::json settings = {{"seed", 1}};
    for (const DoorRegion& region : default_door_regions())
        settings["robot"]["frames"]["BASE_" + region.id] =
            pose_json(default_cell_settings().base_from_workobject);
    SEAM_TRY(const std::shared_ptr<SimulatedCell> cell, SimulatedCell::open(settings));
    const auto sensor = make_simulated_sensor(cell);
    const auto robot = make_simulated_robot(cell);
    SEAM_TRY(auto robot_identity, robot->identity());

    Project p;
    p.name = "Demo: door left";
    p.part = {"door left", "simulated door", ply_bytes(cell->part_mesh()), cell->base_from_workobject()};
    SensorSetup a;
    a.id = kSensor;
    a.driver = "simulated";
    a.settings = settings;
    a.identity = sensor->identity();
    p.sensors = {a};
    RobotSetup r;
    r.id = kRobot;
    r.driver = "simulated";
    r.settings = settings;
    r.identity = robot_identity;
    r.required_mode = RobotMode::automatic;
    p.robots = {r};
    SEAM_TRY(auto truth, simulated_truth(a, r));
    p.sensors[0].calibration_id = truth.id;
    p.calibrations = {truth};
    const Calibration& c = p.calibrations.front();

    StripePeaks peaks;
    Capture capture;
    Text reason;
    Frame frame;
    std::uint64_t number = 0;
    for (const DoorSpot& door : default_door_spots()) {
        Spot s;
        s.id = door.id;
        s.sensor_id = kSensor;
        s.robot_id = kRobot;
        s.base_from_flange = cell->flange_for(door.workobject_from_sensor);
        s.entry_mm = std::min(door.entry_mm, kTravelMm);
        s.exit_mm = std::min(door.exit_mm, kTravelMm);
        s.sigma_mm = 0.04;
        s.feature.kind = "contour-end";
        s.feature.parameters = {{"side", 0.0}};
        frame.sequence = ++number;
        cell->render(s.base_from_flange, number, frame);
        if (capture_frame(frame, a.peaks, &*c.model, peaks, capture, reason) != SpotStatus::measured)
            return device_error(Text("the simulated sensor sees no stripe: {}", reason),
                                Text("spot {}", s.id));
        SEAM_OK(track_capture(capture, a.filter, s.reference_profile));
        SEAM_TRY(auto finder, make_feature_finder(s.feature));
        const Feature edge = finder->find(s.reference_profile);
        if (edge.status != FeatureStatus::ok)
            return input_error(Text("the edge is not found: {}", edge.message), Text("spot {}", s.id));
        // Around the hem as template, the edge as its landmark.
        s.reference_mm = {edge.point_mm.x(), 0, edge.point_mm.y()};
        s.feature.kind = "template";
        s.feature.parameters = {{"window_dx_mm", 20}, {"window_dz_mm", 20}, {"window_dphi_deg", 5}};
        s.feature.template_reference_mm = edge.point_mm;
        Profile& piece = s.feature.template_profile;
        for (std::size_t i = 0; i < s.reference_profile.size(); ++i) {
            const double x = s.reference_profile.x_mm[i];
            if (!(x >= edge.point_mm.x() - 1 && x <= edge.point_mm.x() + 40) ||
                s.reference_profile.segment[i] == kOutlier)
                continue;
            piece.x_mm.push_back(x);
            piece.z_mm.push_back(s.reference_profile.z_mm[i]);
            if (!s.reference_profile.intensity.empty())
                piece.intensity.push_back(s.reference_profile.intensity[i]);
            piece.segment.push_back(s.reference_profile.segment[i]);
        }
        SEAM_TRY(auto curve, edge_curve(door));
        s.curve = curve;
        p.spots.push_back(std::move(s));
    }
    for (const DoorRegion& door : default_door_regions()) {
        Region region;
        region.id = door.id;
        region.spot_ids = door.spot_ids;
        region.frame_name = "BASE_" + door.id;
        region.base_from_frame = p.part.base_from_workobject;
        p.regions.push_back(std::move(region));
    }
    return p;
}

}  // namespace seamwright
