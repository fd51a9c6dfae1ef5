#pragma once
// The interface of every sensor: a source of frames (images of the stripe, or finished profiles).

#include <chrono>
#include <memory>
#include <string>

#include "core/parameter.h"
#include "devices/frame.h"

namespace seamwright {

// Compared with the identity stored in a calibration before anything is pushed.
struct SensorIdentity {
    std::string driver;  // registry name: "simulated", "replay", "genicam", ...
    std::string vendor, model, serial;
    bool operator==(const SensorIdentity&) const = default;
};

struct SourceCounters {
    std::uint64_t completed = 0, damaged = 0, underrun = 0, missing_packets = 0;
    std::uint64_t late = 0;            // came when their turn was over; delivered, never measured
    std::uint64_t lost = 0;            // numbers missing in the sequence: no packet of them came
    std::uint64_t resent_packets = 0;  // asked for again, and came
    std::uint64_t reconnects = 0;
};

// One thread owns the control calls; wait_next() and latest() may be called from another. After start()
// frames arrive until stop(); in triggered mode only after trigger() or a hardware trigger.
class ProfileSource {
  public:
    virtual ~ProfileSource() = default;
    virtual SensorIdentity identity() const = 0;
    virtual Expected<void> start() = 0;
    virtual void stop() = 0;
    // From any thread: a start() or a reconnection that waits for the device ends with an Error at once, also
    // one that begins before the next stop(). For drivers whose device may take longer than a person waits.
    virtual void give_up() {}
    // Software trigger: one frame follows. `spot_id` is carried through to Frame::spot_id.
    virtual Expected<void> trigger(const std::string& spot_id) = 0;
    // "All": the next frame in order, for runs and recorders. Silence is an Error (kind device) after
    // `timeout`; the end of a recording is an Error with ErrorCode::end_of_recording.
    virtual Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) = 0;
    // "Newest": for screens; nullptr before the first frame. Never blocks.
    virtual FramePtr latest() const = 0;
    virtual SourceCounters counters() const = 0;
    // Settings such as exposure_us, gain_db, frame_rate_hz; the list is the device's own.
    virtual std::vector<ParameterInfo> parameters() const = 0;
    virtual Expected<double> get(const std::string& parameter) const = 0;
    virtual Expected<void> set(const std::string& parameter, double value) = 0;
    // Whether the device is there, of one that is connected and not started: a station that waits for a part asks now and then.
    // Error (kind device): it has gone; start() tries again. Takes no longer than one answer of it. Drivers without a device
    // of their own leave it.
    virtual Expected<void> answers() { return {}; }
};
inline constexpr const char* kEndOfRecording = "the recording has ended";

}  // namespace seamwright
