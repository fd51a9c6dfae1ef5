#pragma once
// Commissioning without a screen: what a person does at the pages, with the functions that the pages call, on
// the simulated door.

#include <filesystem>
#include <string>
#include <vector>

#include "devices/simulated/cell.h"
#include "projects/station/station.h"

namespace seamwright {

enum class TaughtBy { contour_end, wide_template };
struct PlannedSpot {
    std::size_t door = 0;  // of default_door_spots()
    TaughtBy by = TaughtBy::contour_end;
};

// Empty but for part, sensor, robot and the cell's own calibration.
Expected<Project> bare_project(const nlohmann::json& settings);

// Adds the spot, takes its pose, teaches it by feature and measures its reference; passes it entry -> exit,
// turns it as the verdict says and measures again until the contour is frozen (at most `turns` times); keeps
// pass and curve as evidence. Error: a device, or it never froze.
Expected<void> commission_spot(Station& station, const SimulatedCell& cell, const PlannedSpot& planned,
                               int turns = 4);

// One region of all spots.
Expected<void> add_region(Station& station);

}  // namespace seamwright
