#pragma once
// The project: plain value types, everything the engineer sets up. Stored by project_file.h, run by
// station.h.
//
// Frames. base: the robot's; work object: the part as taught, base_from_workobject; flange; sensor. A spot's
// pose in the work object is derived: workobject_from_sensor = base_from_workobject^-1 * base_from_flange *
// flange_from_sensor.

#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/calibration/verdict.h"
#include "core/correction/correction.h"
#include "core/features/feature.h"
#include "core/geometry/pose.h"
#include "core/parameter.h"
#include "core/profile/filter.h"
#include "core/profile/sensor_model.h"
#include "core/profile/stripe/peaks.h"
#include "core/profile/stripe/stripe_light.h"
#include "core/text.h"
#include "core/value_type.h"
#include "devices/profile_source.h"
#include "devices/robot_link.h"
#include "projects/model/drift_watch.h"
#include "projects/model/elastic_modes.h"
#include "projects/model/fixture.h"
#include "projects/model/fleet_link.h"
#include "projects/model/panel_job.h"

namespace seamwright {

// A kind of part that comes down the line: door left, door right. It has spots, regions and with them references,
// limits and frames of its own; sensors, robots, calibrations and the work object's place are all types'. A run is of
// one type and measures its spots alone. A project without types is of one kind of part, as if it were its only type.
struct PartType {
    std::string id;    // "left", as robots, --type and stored runs say it
    std::string name;  // "door left", for people
    int number = 0;    // as a PLC says it, 1..65535; 0: it is known by its id alone
    bool operator==(const PartType&) const = default;
};

struct PartSetup {
    std::string name;                 // "door left"
    std::string mesh_source;          // where the mesh came from, for people
    std::vector<std::byte> mesh_ply;  // binary PLY, millimetres, work object frame; empty when there is none
    Pose base_from_workobject = Pose::Identity();
    // (rho, theta) of base_from_workobject Exp(rho, theta) that the path is laid in, along the work object's axes, mm and
    // rad: how well two robots' work objects agree. 0: the robot that measures also lays.
    Matrix6 workobject_covariance = Matrix6::Zero();
};

struct SensorSetup {
    SEAM_VALUE_TYPE(SensorSetup);
    std::string id;      // "A"
    std::string driver;  // registry name
    nlohmann::json settings = nlohmann::json::object();
    SensorIdentity identity;     // as last connected; empty serial = never
    PeakOptions peaks;           // image -> peaks
    FilterOptions filter;        // stripe model
    std::string calibration_id;  // the one in use; empty = none (then only finished profiles can be measured)
};

struct RobotSetup {
    SEAM_VALUE_TYPE(RobotSetup);
    std::string id;  // "R1"
    std::string driver;
    nlohmann::json settings = nlohmann::json::object();
    RobotIdentity identity;
    RobotMode required_mode =
        RobotMode::unknown;  // pushes are refused in any other; unknown = any but stopped/fault
    // Of base_from_flange as one arrival at a taught pose reaches it (tangent of pose.h, base's axes): what the
    // robot repeats, measured by measure_robot.h. 0: not stated, then Spot::sigma_mm holds it.
    Matrix6 arrival_covariance = Matrix6::Zero();
    // From the instant whose pose the controller tells with a trigger to the exposure, measured by
    // measure_trigger.h: the cut lies latency times speed further along the travel. 0: not stated.
    double trigger_latency_ms = 0;
    // Standard deviation of the share by which its speed at the spots differs from that of the teaching (override): 0.1 is a
    // tenth. With the latency it moves the cuts along the travel. 0: not stated.
    double speed_sigma = 0;
    // When it collided, as a person said, ISO 8601, oldest first. What was calibrated before the last one is stale.
    std::vector<std::string> collisions;
};

// The nozzle's tip on the flange as it was touched (core/calibration/nozzle/nozzle.h).
struct NozzleTip {
    Pose flange_from_nozzle = Pose::Identity();
    Eigen::Matrix3d covariance_mm2 = Eigen::Matrix3d::Zero();  // of the tip, flange
    double degrees = std::numeric_limits<double>::infinity();  // of freedom of it; infinite: stated
    double off_programmed_mm = 0;  // off the programmed tool, where that is beyond chance
};

// A calibration that turns a sensor's frames into millimetres on the flange; or, with `nozzle`, where the robot's nozzle
// is: the newest one of a robot that serves is in use (projects/measure/nozzle.h).
struct Calibration {
    SEAM_VALUE_TYPE(Calibration);
    std::string id;
    std::string method;  // "simulated truth", "tcp-sphere", "stripe-camera", "factory", ...
    std::string sensor_id, robot_id;
    SensorIdentity sensor_identity;  // compared before every push
    RobotIdentity robot_identity;
    std::string created_utc;           // ISO 8601
    Text source;                       // from which data
    std::optional<SensorModel> model;  // absent for sensors that deliver millimetres themselves
    Pose flange_from_sensor = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
    // Of the sensor's own millimetres: scale of x and z and shear of x against z, 1/1 (SensorPrior). 0: not stated.
    Eigen::Vector2d scale_sigma = Eigen::Vector2d::Zero();
    double shear_sigma = 0;
    Verdict verdict = Verdict::undetermined;
    std::optional<NozzleTip> nozzle;
    nlohmann::json raw =
        nlohmann::json::object();  // the data it was solved from, complete enough to solve again
    nlohmann::json result = nlohmann::json::object();
};

// Where a spot's reference comes from.
enum class ReferenceState {
    measured,      // on the part; or nowhere yet, then there is no reference_profile
    from_drawing,  // expected from the drawing, not confirmed: the spot is measured, but nothing is pushed by it
    from_type      // another part type's, copied with its spot: the same, until it is taught on this one
};
std::string_view to_string(ReferenceState state);  // "from_drawing"
Text name_of(ReferenceState state);                // "from the drawing, not confirmed"

// What a spot was made from that was taught on a drawing; stays with it when it is confirmed.
struct DrawingOrigin {
    std::string name;  // of the file
    std::uint64_t bytes = 0;
    std::uint32_t crc32 = 0;                                 // of these bytes
    std::string edge;                                        // "e12"
    double arc_mm = 0;                                       // along its chain of tangent edges
    Eigen::Vector3d reference_mm = Eigen::Vector3d::Zero();  // as drawn, sensor frame
};

// On a colour of paint that the line or `run --paint` names, a spot's own settings with these in their place.
struct PaintLight {
    std::string paint;         // "white", or the line's number
    ParameterValues settings;  // as in SpotLight
    bool operator==(const PaintLight&) const = default;
};

// What the sensor is set to while it cuts a spot (projects/station/light/spot_light.h). Empty: it stands as it does at its start.
struct SpotLight {
    // By the device's own names (ProfileSource::parameters()): "exposure_us", "gain_db", ... What is not named stands as
    // at the sensor's start.
    ParameterValues settings;
    // Exposures of the standing robot that are merged into one stripe line by line, ascending; empty: one exposure.
    std::vector<double> merge_us;
    // At run time the exposure follows the paint between these; 0, 0: it stays as set.
    double shortest_us = 0, longest_us = 0;
    std::vector<PaintLight> paints;
    bool follows_paint() const { return longest_us > 0; }
    bool empty() const { return settings.empty() && merge_us.empty() && !follows_paint() && paints.empty(); }
    bool operator==(const SpotLight&) const = default;
};

struct Spot {
    SEAM_VALUE_TYPE(Spot);
    std::string id;       // "S1", one of a kind in the project, whatever its type
    std::string type_id;  // the part type; empty: of a project without types
    std::string sensor_id, robot_id;
    bool enabled = true;
    bool required = true;                      // a region with a required spot missing is not pushed
    Pose base_from_flange = Pose::Identity();  // taught trigger pose
    // base_from_flange too: passed in this order on the way from the spot before to the entry. None:
    // straight.
    std::vector<Pose> via;
    double entry_mm = 20, exit_mm = 20;  // travel before and after the trigger, along the sensor's Y
    double speed_mm_s = 100;
    bool stop_at_trigger = false;
    FeatureRecipe feature;
    Eigen::Vector3d reference_mm = Eigen::Vector3d::Zero();  // sensor frame
    int reference_arrivals = 1;                              // of the robot, that reference_mm is the mean of
    Profile reference_profile;
    ReferenceState reference_state = ReferenceState::measured;
    std::optional<SeenLight> reference_light;  // that it was measured with; absent: nobody looked
    SpotLight light;
    std::optional<DrawingOrigin> drawn;
    Eigen::Vector3d weights = {1, 0, 1};
    double sigma_mm = 0.05;
    double jitter_mm = 3;  // half width of the jitter window
    std::optional<ContourCurve> curve;
};

// The PLC or broker of the line beside the station (devices/line/line_link.h); served by run --watch alone.
struct LineSetup {
    std::string id;  // "plc"
    std::string protocol;
    bool enabled = true;
    nlohmann::json settings = nlohmann::json::object();
    // The types that are measured here, as the line numbers them; none: all. A part of any other is refused.
    std::vector<int> part_types;
};

// What a person decided to take off a region's displacements: the offset against a better instrument (CMM,
// tracker). Every version stays; which one acts is in Region::offset_switches.
struct KeptOffset {
    int version = 0;  // 1, 2, ... in the region's order
    std::string utc;  // ISO 8601
    Text source;      // from which data
    // D acts as T(-offset) D: work object axes, mm, absolute (of a version found while another one acted, both).
    Eigen::Vector3d offset_mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_mm2 =
        Eigen::Matrix3d::Zero();  // of its estimate; systematic in all that it acts on
};

struct Region {
    SEAM_VALUE_TYPE(Region);
    std::string id;       // "R1"
    std::string type_id;  // as that of its spots
    std::vector<std::string> spot_ids;
    FreeDof free = kAllFree;
    CorrectionLimits limits{25.0, 3.0};
    double sigma_limit_mm = 0.1;  // worst direction at any of its spots; over this the gate refuses
    double sigma_limit_deg = 0.05;
    std::string frame_name;                   // on the controller
    Pose base_from_frame = Pose::Identity();  // taught, for the undisplaced part
    std::vector<KeptOffset> offsets;
    // The versions that acted one after the other, 0 for none; the last one acts. Empty: none ever did.
    std::vector<int> offset_switches;
};
// The one that acts; nullptr: none.
const KeptOffset* acting_offset(const Region& region);

// What the acceptance of the measuring process asks for (projects/acceptance/study/studies.h); the customer's, where he
// has a variant of his own. The defaults are AIAG MSA's and VDA 5's.
struct AcceptanceRequirements {
    double tolerance_mm = 0;              // T = USL - LSL of the bead across its path; 0: not stated yet
    double nominal_mm = 0;                // middle of the tolerance
    double cg_share = 0.2, cg_width = 6;  // Cg = share T / (width s): 0.2 and 6, 0.15 and 4, ...
    double cg = 1.33, cgk = 1.33;         // at least
    double grr_accepted_percent = 10, grr_refused_percent = 30;  // of the tolerance; between: conditional
    double ndc = 5;                                              // at least
    double system_percent = 15, process_percent = 30;            // Q of VDA 5, at most
    bool operator==(const AcceptanceRequirements&) const = default;
};

// What the work has to reach before it is handed over; the checklist (checklist.h) judges by it.
struct Requirements {
    // 3 sigma of a point of the path after correction, predicted and proven. The default is what an ordinary
    // robot repeats (thesis 5.1) and three times a region's sigma limit.
    double sigma3_mm = 0.3;
    double calibration_age_days = 365;  // an older calibration in use is stale
    double zero_shift_runs = 3;         // measurements of the unmoved part
    // The known shift must have been recovered up to here, at the middle of the spots.
    double known_shift_mm = 10, known_shift_deg = 1;
    // What is judged by it is no part of a run's setup: a run of another tolerance is the same process.
    AcceptanceRequirements acceptance;
};

struct Project {
    SEAM_VALUE_TYPE(Project);
    std::string name;
    Requirements requirements;
    PartSetup part;
    std::vector<PartType> part_types;
    std::vector<SensorSetup> sensors;
    std::vector<RobotSetup> robots;
    std::vector<Calibration> calibrations;
    std::vector<Spot> spots;
    std::vector<Region> regions;
    std::vector<PanelJob> panel_jobs;
    std::vector<LineSetup> line;  // no part of a run's setup: it measures nothing
    std::vector<RegionModes> elastic;
    std::optional<DriftWatch> drift;  // no part of a run's setup: the run says what acted
    std::optional<Fixture> fixture;   // no part of a run's setup: it measures nothing
    std::optional<FleetLink> fleet;   // no part of a run's setup: it measures nothing
};

// A region's modes; nullptr: none were learnt.
const RegionModes* modes_of(const Project& project, const std::string& region_id);

// The region's spots that are from the drawing and not confirmed, in its order; disabled ones too.
std::vector<std::string> unconfirmed_spots(const Project& project, const Region& region);

}  // namespace seamwright
