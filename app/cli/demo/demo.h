#pragma once
// The whole job on the simulated cell: calibrate the sensor, teach the door, then part after part measure,
// correct, push, and judge the pushed frames against where the part truly is. Nothing here knows the truth
// before that last step.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/alignment/alignment.h"
#include "core/calibration/calibration.h"
#include "devices/simulated/cell.h"
#include "projects/confirm/confirm.h"
#include "projects/model/project.h"
#include "projects/model/run.h"
#include "projects/placing/propose.h"

namespace seamwright::cli {

// A source of error that can be taken out of the cell, to see what the others bring (sweep, below).
enum class DemoSource {
    calibration,    // the sensor's true model and place in place of a calibration
    noise,          // shot and read noise, speckle, stray reflections, dark patches
    repeatability,  // of the robot's arrivals
    jitter,         // of the trigger
    bend            // of the part
};
inline constexpr std::array kDemoSources = {DemoSource::calibration, DemoSource::noise,
                                            DemoSource::repeatability, DemoSource::jitter, DemoSource::bend};
std::string_view to_string(DemoSource source);

struct DemoOptions {
    std::filesystem::path folder = "demo";
    std::uint64_t seed = 1;
    int parts = 10;
    std::set<DemoSource> without;
    // Over loopback: the sensor as a GigE Vision camera at this address, the robot as a KUKA controller that
    // connects by EthernetKRL. In-process otherwise: the same cell without cables between.
    bool loopback = true;
    bool offline = true;                  // the chapter from the drawing
    std::string camera_address = "free";  // 127.0.0.1, else another of 127.0.0.0/8 that is free
    int robot_port = 0;                   // 0: 54600, else another that is free
};

// One calibration step as the report shows it.
struct DemoCalibrationStep {
    std::string name;  // "stripe-camera"
    CalibrationReport report;
    std::string summary;  // one line of figures
};

struct DemoCalibration {
    Calibration calibration;  // goes into the project
    std::vector<DemoCalibrationStep> steps;
    int looks_again = 0;  // frames taken once more, because a solution left them out
    double truth_mm = 0;  // error of the calibrated chain at the working distance, against the cell
};

// From frames of a plate and of a sphere, starting from nothing but the sizes of both. What a solution leaves
// out is looked at once more, as a person would.
Expected<DemoCalibration> calibrate_demo_sensor(SimulatedCell& cell, ProfileSource& sensor, RobotLink& robot);

// Where a point of the taught path should be and where the pushed frame puts it, base frame, along-edge part
// left out.
struct DemoDeviation {
    std::string region_id;
    double arc_mm = 0;                                    // along the bead path, or the spot's index
    Eigen::Vector2d before_mm = Eigen::Vector2d::Zero();  // across the edge, and height
    Eigen::Vector2d after_mm = Eigen::Vector2d::Zero();
};

struct DemoPart {
    PartState truth;
    RunRecord run;
    std::vector<DemoDeviation> spots, path;
    bool pushed() const { return run.status == RunStatus::ok; }  // else the robot lays no bead on it
};

struct DemoTaughtSpot {
    std::string id;
    Eigen::Vector2d spread_mm = Eigen::Vector2d::Zero();
    AlignmentResult alignment;
    AlignmentOptions judged_by;
};

// The same region without a person at the part: from the drawing, proposed, confirmed, the same parts.
struct DemoOffline {
    std::filesystem::path project_file;
    std::string region_id, edge;
    Proposal proposal;    // of as many spots as the hand-made region has
    PlacedSet hand;       // the hand-made spots by the same measure
    Text refused_before;  // what the gate said to the unconfirmed region
    Confirmation confirmation;
    std::vector<DemoPart> parts;  // empty where the confirmation was refused
    double seconds = 0;
};

struct DemoOutcome {
    std::filesystem::path project_file, report_file;
    nlohmann::json cell;  // what noise and scatter the figures below hold for
    Project project;
    DemoCalibration calibration;
    std::vector<DemoTaughtSpot> taught;
    std::vector<RegionPlan> plans;      // one a region
    std::vector<RunRecord> zero_shift;  // the undisplaced part, three times
    std::vector<DemoPart> parts;
    std::optional<DemoOffline> offline;
    double seconds = 0;
};

struct DemoStatistic {
    std::string region_id;
    double before_max_mm = 0, after_mean_mm = 0, after_three_sigma_mm = 0, after_max_mm = 0;
};
// Across the edge and in height alike.
struct DeviationTally {
    double before_max_mm = 0, after_max_mm = 0, n = 0, sum = 0, squares = 0;
    void add(const DemoDeviation& deviation);
    DemoStatistic statistic(const std::string& region_id) const;
};
// Adds the parts that were pushed; one tally a region, then one for all ("all").
void add(const DemoOutcome& outcome, std::vector<DemoDeviation> DemoPart::*which,
         std::vector<std::pair<std::string, DeviationTally>>& tallies);
std::vector<DemoStatistic> statistics(const DemoOutcome& outcome,
                                      std::vector<DemoDeviation> DemoPart::*which);
// Of one region of some parts, the pushed ones.
DemoStatistic statistic_of(const std::vector<DemoPart>& parts, const std::string& region_id,
                           std::vector<DemoDeviation> DemoPart::*which);

Expected<DemoOutcome> run_demo(const DemoOptions& options,
                               const std::function<void(const std::string&)>& progress);

// The demo over many seeds, in-process: what one seed ended with. `parts` of 0 calibrates alone.
struct SweepRow {
    std::uint64_t seed = 0;
    std::string outcome;  // "ok", "refused" (a part was not pushed), "failed" (no further than the reason)
    std::string reason;   // of the first refusal, or the error
    int pushed = 0;
    std::optional<Verdict> calibration_verdict;  // none where it failed
    double calibration_error_mm = 0;
    int looks_again = 0;              // frames that the calibrations took once more
    std::vector<DemoStatistic> path;  // one row a region, then "all"; empty when nothing was pushed
    double seconds = 0;
};
struct DemoSweep {
    std::vector<SweepRow> rows;
    std::vector<DemoStatistic> pooled;  // over all pushed parts of all seeds
};
// Overwrites the project file in options.folder with every seed. `each` hears of a row when it is done.
DemoSweep sweep_demo(DemoOptions options, std::uint64_t first, std::uint64_t last,
                     const std::function<void(const SweepRow&)>& each);

// Self-contained HTML.
std::string demo_report(const DemoOutcome& outcome);
// The plan view: door, spots, bead before and after (deviation magnified), as SVG.
std::string demo_picture(const DemoOutcome& outcome);

}  // namespace seamwright::cli
