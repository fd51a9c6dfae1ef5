#pragma once
// The simulated cell's sensor as a Gocator on the wire: control, data and ASCII ports on the loopback
// address.
//
// What a real one computes inside is done by the same code as for images: peaks, the stripe among them,
// through the sensor's own model, as a profile of points; what belongs to no stripe is no return. The ASCII
// port tells one point, X with id 0 and Z with id 1: the end of the contour at higher x, or INVALID. The
// robot's triggers are the digital input; a Trigger command exposes at the robot's present pose. Up to 16
// clients a port.
//
// Settings, all optional, with defaults: {"address": "127.0.0.1", "control_port": 3190, "data_port": 3196,
// "ascii_port": 8190 (each 0 = any free one), "serial": 12345, "format": "" (as in ascii_result.h),
// "start_ms": 0 (what it takes to start and to stop its job; a real one up to 15000)}

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>

#include "devices/simulated/cell.h"

namespace seamwright {

class ServedGocator {
  public:
    // The sensor arms the cell while it runs: nothing else may take the cell's exposures meanwhile.
    static Expected<std::unique_ptr<ServedGocator>> open(std::shared_ptr<SimulatedCell> cell,
                                                         const nlohmann::json& settings);
    ~ServedGocator();
    std::uint16_t control_port() const;
    std::uint16_t data_port() const;
    std::uint16_t ascii_port() const;
    // The next `frames` exposures are made and numbered, and not sent.
    void lose_next(int frames);
    // Closes all connections; clients may come again.
    void cut();

  private:
    struct Impl;
    explicit ServedGocator(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
