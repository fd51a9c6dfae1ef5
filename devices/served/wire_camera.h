#pragma once
// A GigE Vision camera on an address of this host: what is pushed here goes out as GVSP frames to whatever
// client acquires. It knows nothing of what the frames show.
//
// The bootstrap and image registers are those of Aravis' fake camera (a memory, no more), the wire is
// gige_server.h. Trigger mode and source, exposure, gain and frame rate are registers of ours
// (resources/camera/served-camera.xml) in that memory. A frame that is pushed leaves at once, a software
// trigger is told within its command.
//
// Limits: one camera an address, whose port 3956 the standard fixes, and those of gige_server.h; no chunks,
// no packet delay.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright {

// As an address: 127.0.0.1 where its port is free, else any address of the loopback range that is.
inline constexpr const char* kFreeAddress = "free";

struct WireCameraSettings {
    std::string address = "127.0.0.1";
    std::string serial = "SIM-1";  // 1 to 15 signs
    std::string model = "Simulated stripe camera";
    int width = 1280, height = 1024;                  // of the sensor, px
    std::vector<std::string> pixel_formats{"Mono8"};  // offered (PFNC names); the first is set
    double exposure_us = 1000, gain_db = 0;           // as it wakes up
    int packet_size = 7496;                           // bytes, IP header included
    double lost_packets_per_mille = 0;                // of stream packets
    std::uint32_t loss_seed = 1;                      // of which packets get lost
    std::uint16_t first_frame_id = 1;                 // of every stream; high ones show the wrap soon
    std::size_t queue = 8;                            // frames waiting for the wire; more are dropped
    // Range cameras: mm a step and at zero of A (x) and C (height); raw value of "no return".
    double a_scale_mm = 1, a_offset_mm = 0, c_scale_mm = 1, c_offset_mm = 0;
    bool invalid_flag = false;
    double invalid_value = 0;
};

enum class WireTrigger { free, software, line };
struct WireState {
    bool acquiring = false;
    std::uint64_t acquisition =
        0;  // how many have begun: what was exposed in an earlier one is no frame of this
    int x = 0, y = 0, width = 0, height = 0;
    std::uint32_t pixel_format = 0;  // PFNC code
    double exposure_us = 0, gain_db = 0;
    WireTrigger trigger = WireTrigger::free;
    double frame_rate_hz = 0;  // 0: as fast as exposures allow
};

// What can go wrong with a frame on its way; moved: it shows the sensor from another row on.
enum class WireFault { none, damaged, lost, late, moved };

struct WireCounters {
    std::uint64_t sent = 0, dropped = 0, software_triggers = 0;
};

class WireCamera {
  public:
    // `software_trigger` is called on the server's thread at each TriggerSoftware command while acquiring; it
    // must be quick. Error (device): the address is not this host's or its port 3956 is taken.
    static Expected<std::unique_ptr<WireCamera>> open(const WireCameraSettings& settings,
                                                      std::function<void()> software_trigger = {});
    ~WireCamera();  // within 60 ms

    // As the client set it. Any thread.
    WireState state() const;
    // Whether who draws takes triggers; clients see it (AcquisitionStatus).
    // Not ready: what waits for the wire is thrown away.
    void set_ready(bool ready);
    // One frame of state()'s region and format for the wire, in order; false: not acquiring, of another size
    // than the region needs, of an acquisition that has ended, or too many waiting (counted as dropped). `device_ns` becomes
    // the time stamp. `acquisition`: of the exposure; 0: the one that runs.
    bool push(std::vector<std::byte> payload, std::int64_t device_ns, std::uint64_t acquisition = 0);
    // The next frame that leaves: damaged loses some of its packets, lost all of them, late leaves `late_ms`
    // after its time.
    void fail_next(WireFault fault, int late_ms = 0);
    void set_lost_packets(double per_mille);
    WireCounters counters() const;
    std::string address() const;  // where it was found free

  private:
    struct Impl;
    explicit WireCamera(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
