#pragma once
// Parts that the simulation puts in, for a study on a simulated cell: each displaced as its name draws it, by up to
// kPartMm and kPartDeg each way, and each time it is hung by a fixture's scatter of kRehangMm and kRehangDeg (standard
// deviations) more. The cell is opened anew for each, with noise of its own, so that no part repeats another one's. The
// project keeps its settings: the runs are of one setup.

#include <map>
#include <string>

#include "projects/station/station.h"

namespace seamwright {

inline constexpr double kPartMm = 2, kPartDeg = 0.2, kRehangMm = 0.01, kRehangDeg = 0.001;

class SimulatedParts {
  public:
    // Every device of the project is simulated.
    static bool possible(const Project& project);
    explicit SimulatedParts(Station& station) : station_(station) {}
    SimulatedParts(const SimulatedParts&) = delete;
    SimulatedParts& operator=(const SimulatedParts&) = delete;
    ~SimulatedParts();  // the devices as the project has them
    // An empty part: the one of the project, where it lies. Error (device): as Station::connect().
    Expected<void> put(const std::string& part, int rehang);

  private:
    Station& station_;
    std::map<std::string, Pose> stood_;  // the robots, before: opened anew they have not been anywhere
    bool put_ = false;
};

}  // namespace seamwright
