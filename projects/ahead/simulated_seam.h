#pragma once
// Online correction on the simulated cell: its door, its sensor before the tool, and a controller with RSI or EGM that
// runs along the sealing bead in its real cycle, over UDP on the loopback address. For `follow --simulate` and tests.
//
// The tool's tip is programmed along the bead of the door's upper side; the sensor stands `look_ahead_mm` farther along
// the chord, and the controller carries it with the corrected tool. Spots and guide are taught on the undisplaced door.
// Noise is the camera's (devices/simulated/cell.h) and the scatter of arrivals at the spots; the path itself is run
// without scatter.

#include <filesystem>
#include <functional>
#include <memory>

#include "core/evaluation/statistics.h"
#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"
#include "projects/ahead/follow.h"

namespace seamwright {

struct SimulatedSeamOptions {
    std::string driver = "kuka-rsi";  // or "abb-egm"
    int cycle_ms = 4;
    std::uint64_t seed = 1;
    double speed_mm_s = 40, length_mm = 240, look_ahead_mm = 60;
    // Instead of the cell's own sensor; it delivers finished profiles.
    std::function<std::unique_ptr<ProfileSource>(const std::shared_ptr<SimulatedCell>&)> sensor = {};
    // Between the two, where packets get lost: given the controller's port, answers the one that it is to send to.
    std::function<std::uint16_t(std::uint16_t link_port)> wire = {};
    // Further settings of the controller and of the robot's link.
    nlohmann::json controller = nlohmann::json::object(), link = nlohmann::json::object();
};

// One cycle of the controller.
struct SeamSample {
    Pose programmed = Pose::Identity(), corrected = Pose::Identity();  // base_from_tcp
};

class SimulatedSeam {
  public:
    // Makes the project at `file`, teaches spots and guide, and connects. Error: what any of that refuses.
    static Expected<std::unique_ptr<SimulatedSeam>> make(const SimulatedSeamOptions& options,
                                                         const std::filesystem::path& file);
    ~SimulatedSeam();

    SimulatedCell& cell() { return *cell_; }
    Station& station() { return *station_; }
    SimulatedController& controller() { return *controller_; }
    FollowOptions follow() const { return follow_; }
    std::vector<SeamSample> history() const;  // of all cycles
    std::uint64_t stops() const;              // of the controller by itself

  private:
    SimulatedSeam() = default;
    std::shared_ptr<SimulatedCell> cell_;
    std::unique_ptr<SimulatedController> controller_;
    std::optional<Station> station_;  // goes first
    FollowOptions follow_;
    SimulatedSeamOptions options_;
};

// The tool's tip against the true bead of the part as it is, across the path and in height, mm; all cycles of the
// longest stretch that was travelled without standing, but its first `run_in_mm`.
struct SeamWay {
    Summary error;        // both coordinates pooled
    double worst_mm = 0;  // length of the two
};
struct SeamErrors {
    SeamWay without, frame, online;  // as programmed; with the frame alone (base_from_moved); as it was
    double travelled_mm = 0;
    std::size_t cycles = 0;
};
SeamErrors judge_seam(SimulatedSeam& seam, const Pose& base_from_moved, double run_in_mm = 30);

}  // namespace seamwright
