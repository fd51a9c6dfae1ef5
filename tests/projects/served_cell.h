#pragma once
// A taught door project whose sensor and robot stand behind real protocols on the loopback address.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

#include "devices/capture/capture.h"
#include "devices/cell_server.h"
#include "devices/exchange/pose_json.h"
#include "devices/net/socket.h"
#include "devices/served/wire_camera.h"
#include "devices/simulated/scene/door.h"
#include "projects/station/acquire.h"
#include "projects/station/station.h"
#include "projects/station/teach.h"

namespace seamwright {

struct ServedCell {
    std::shared_ptr<SimulatedCell> cell;
    CellServerOptions sensor_options, robot_options;
    std::optional<CellServer> sensor, robot;  // each may be taken away and started again by its options
    std::optional<Station> station;
    SimulatedController& controller() { return *robot->controllers().front().second; }
};

struct ServedCellOptions {
    std::string driver = "kuka-eki";
    int width = 640, height = 512;
    double time_scale = 40;             // the robot's pace: about 40 ms from spot to spot
    double lost_packets_per_mille = 0;  // after teaching
    bool gocator = false;               // the sensor is a Gocator, not a GigE Vision camera
};

// Calibrated with the cell's truth, taught on the undisplaced door; one region "all" of the default door's
// spots.
Expected<ServedCell> serve_cell(const ServedCellOptions& options, const std::filesystem::path& file);

}  // namespace seamwright
