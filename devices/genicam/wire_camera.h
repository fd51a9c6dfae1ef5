#pragma once
// A GigE Vision camera on a loopback address, served by Aravis' own camera simulator: what is pushed here
// goes out as GVSP frames to whatever client acquires. It knows nothing of what the frames show.
//
// How Aravis 0.8's simulator works, and what follows. One thread answers GVCP and sends frames. It sends when
// its frame period has gone by, whatever the trigger, and polls with a time-out of whole milliseconds: at
// periods above 1 ms a trigger waits for the period's end, below it the thread spins. So it runs here with a
// period of 1 us, and the drawing callback waits up to 1 ms for a frame: a frame that is pushed leaves at
// once, the thread sleeps meanwhile, and a GVCP command waits 1 ms at most while acquiring. When none came
// the callback switches the simulator's packet loss to 100 % for that round, so that nothing is sent, and
// gives the frame number back. Trigger mode and source, exposure, gain and frame rate are registers of ours
// (resources/camera/served-camera.xml) in the simulator's memory.
//
// Limits of the simulator, which are ours too: port 3956 only and one camera an address; an address must be
// that of an interface (127.0.0.1); no packet resend, no chunks, no events, no packet delay, GigE Vision 1
// frame numbers (16 bit); the first frame after AcquisitionStart leaves up to 100 ms late; it listens for
// discovery broadcasts of other interfaces' clients too, but answers from its own address only.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright {

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
    std::uint16_t first_frame_id = 1;                 // high ones show the wrap soon
    std::size_t queue = 8;                            // frames waiting for the wire; more are dropped
    // Range cameras: mm a step and at zero of A (x) and C (height); raw value of "no return".
    double a_scale_mm = 1, a_offset_mm = 0, c_scale_mm = 1, c_offset_mm = 0;
    bool invalid_flag = false;
    double invalid_value = 0;
};

enum class WireTrigger { free, software, line };
struct WireState {
    bool acquiring = false;
    int x = 0, y = 0, width = 0, height = 0;
    std::uint32_t pixel_format = 0;  // PFNC code
    double exposure_us = 0, gain_db = 0;
    WireTrigger trigger = WireTrigger::free;
    double frame_rate_hz = 0;  // 0: as fast as exposures allow
};

// What can go wrong with a frame on its way.
enum class WireFault { none, damaged, lost, late };

struct WireCounters {
    std::uint64_t sent = 0, dropped = 0, software_triggers = 0;
};

class WireCamera {
  public:
    // `software_trigger` is called on the wire thread at each TriggerSoftware command while acquiring; it
    // must be quick. Error (device): the address has no interface or its port 3956 is taken.
    static Expected<std::unique_ptr<WireCamera>> open(const WireCameraSettings& settings,
                                                      std::function<void()> software_trigger = {});
    ~WireCamera();  // within 150 ms

    // As the client set it. Any thread.
    WireState state() const;
    // Whether who draws takes triggers; clients see it (AcquisitionStatus) from the wire's next round on.
    // Not ready: what waits for the wire is thrown away.
    void set_ready(bool ready);
    // One frame of state()'s region and format for the wire, in order; false: not acquiring, of another size
    // than the region needs, or too many waiting (counted as dropped). `device_ns` becomes the time stamp.
    bool push(std::vector<std::byte> payload, std::int64_t device_ns);
    // The next frame that leaves: damaged loses some of its packets, lost all of them, late leaves `late_ms`
    // after its time.
    void fail_next(WireFault fault, int late_ms = 0);
    void set_lost_packets(double per_mille);
    WireCounters counters() const;
    std::string address() const;

  private:
    struct Impl;
    explicit WireCamera(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
