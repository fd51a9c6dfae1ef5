#pragma once
// The simulated cell behind real protocols: its sensor as a GigE Vision camera or a Gocator, its robot behind
// the controllers of controller_drivers(), each on the loopback address. The demo, the tests and `seamwright
// sim-cell` measure over it as over a plant's cables.

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "devices/registry.h"
#include "devices/simulated/cell.h"

namespace seamwright {

class ServedCamera;
class ServedGocator;

struct ServedController {
    std::string name;  // of controller_drivers()
    nlohmann::json settings = nlohmann::json::object();
};

struct CellServerOptions {
    nlohmann::json cell = nlohmann::json::object();    // as documented in cell.h
    std::string camera_address;                        // empty = no camera, "free" = one that is found free
    nlohmann::json camera = nlohmann::json::object();  // further settings of served_camera.h
    nlohmann::json gocator;  // settings of served_gocator.h; null = none. Camera or Gocator, not both
    std::vector<ServedController> controllers;
    std::vector<MeasuringMove> program;  // the measuring program that the controllers hold
};

// Serves from start() to its destruction.
class CellServer {
  public:
    static Expected<CellServer> start(const CellServerOptions& options);
    // The same on a cell that is there already; options.cell is not looked at.
    static Expected<CellServer> start(const CellServerOptions& options,
                                      const std::shared_ptr<SimulatedCell>& cell);
    CellServer(CellServer&&) noexcept;
    CellServer& operator=(CellServer&&) noexcept;
    ~CellServer();

    SimulatedCell& cell() { return *cell_; }
    const std::string& camera_address() const { return camera_address_; }
    // The camera's cable: without it nothing answers at its address; back in, it stands there again as it was. What is asked
    // for already is done. Error (device): the address was taken meanwhile; usage: the cell has no camera.
    Expected<void> plug_camera(bool in);
    bool camera_plugged() const { return camera_ != nullptr; }
    const ServedGocator* gocator() const { return gocator_.get(); }  // nullptr = none
    using NamedController = std::pair<std::string, std::unique_ptr<SimulatedController>>;
    const std::vector<NamedController>& controllers() const { return controllers_; }

  private:
    CellServer() = default;
    std::shared_ptr<SimulatedCell> cell_;
    std::string camera_address_;
    nlohmann::json camera_settings_;
    std::unique_ptr<ServedCamera> camera_;
    std::unique_ptr<ServedGocator> gocator_;
    std::vector<NamedController> controllers_;
};

}  // namespace seamwright
