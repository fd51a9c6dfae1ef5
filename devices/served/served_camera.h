#pragma once
// The simulated cell's camera on the wire: a GigE Vision camera on a loopback address that any client can
// open.
//
// The cell's rendered frames go out as they are measured in-process. The robot's triggers are the camera's
// Line1, a client's TriggerSoftware exposes at the robot's present pose, and free running does so at
// AcquisitionFrameRate. ExposureTime and Gain written by any client reach the cell. The sensor has the cell's
// width and height; formats are Mono8 and, with more than 8 bit, the cell's own depth unpacked and in both
// packings, and Mono16 (left-aligned, so that full scale is full scale). The time stamp is the instant of
// exposure on this host's steady clock (1 tick = 1 ns). See wire_camera.h for what the wire cannot do.
//
// Settings, all optional, with defaults:
//   {"address": "127.0.0.1" or "free" (wire_camera.h), "serial": the cell's, "packet_size": 7496,
//   "lost_packets_per_mille": 0,
//    "loss_seed": 1, "first_frame_id": 1}

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "devices/served/wire_camera.h"
#include "devices/simulated/cell.h"

namespace seamwright {

class ServedCamera {
  public:
    // The camera arms the cell while a client acquires: nothing else may take the cell's exposures meanwhile.
    static Expected<std::unique_ptr<ServedCamera>> open(std::shared_ptr<SimulatedCell> cell,
                                                        const nlohmann::json& settings);
    ~ServedCamera();  // within 200 ms

    WireCamera& wire();
    std::string address() const;  // where it was found free
    std::string serial() const;
    // For tests: every frame as it was handed to the wire, on the drawing thread.
    struct Served {
        std::uint64_t number = 0;  // of the exposure
        std::string spot_id;
        std::int64_t device_ns = 0;
        const std::vector<std::byte>* payload = nullptr;
    };
    void watch(std::function<void(const Served&)> watcher);

  private:
    struct Impl;
    explicit ServedCamera(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
