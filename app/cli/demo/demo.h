#pragma once
// The whole job on the simulated cell: calibrate the sensor, teach the door, then part after part measure,
// correct, push, and judge the pushed frames against where the part truly is. Nothing here knows the truth
// before that last step.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/alignment/alignment.h"
#include "core/calibration/calibration.h"
#include "devices/simulated/cell.h"
#include "projects/project.h"
#include "projects/run.h"

namespace seamwright::cli {

struct DemoOptions {
    std::filesystem::path folder = "demo";
    std::uint64_t seed = 1;
    int parts = 10;
    // Over loopback: the sensor as a GigE Vision camera at this address, the robot as a KUKA controller that
    // connects by EthernetKRL. In-process otherwise: the same cell without cables between.
    bool loopback = true;
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
    double truth_mm = 0;  // error of the calibrated chain at the working distance, against the cell
};

// From frames of a plate and of a sphere, starting from nothing but the sizes of both.
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

struct DemoOutcome {
    std::filesystem::path project_file, report_file;
    nlohmann::json cell;  // what noise and scatter the figures below hold for
    Project project;
    DemoCalibration calibration;
    std::vector<DemoTaughtSpot> taught;
    std::vector<RegionPlan> plans;      // one a region
    std::vector<RunRecord> zero_shift;  // the undisplaced part, three times
    std::vector<DemoPart> parts;
    double seconds = 0;
};

struct DemoStatistic {
    std::string region_id;
    double before_max_mm = 0, after_mean_mm = 0, after_three_sigma_mm = 0, after_max_mm = 0;
};
// Over the parts that were pushed; one row a region, then one for all ("all").
std::vector<DemoStatistic> statistics(const DemoOutcome& outcome,
                                      std::vector<DemoDeviation> DemoPart::*which);

Expected<DemoOutcome> run_demo(const DemoOptions& options,
                               const std::function<void(const std::string&)>& progress);

// Self-contained HTML.
std::string demo_report(const DemoOutcome& outcome);
// The plan view: door, spots, bead before and after (deviation magnified), as SVG.
std::string demo_picture(const DemoOutcome& outcome);

}  // namespace seamwright::cli
