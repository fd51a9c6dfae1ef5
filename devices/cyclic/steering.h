#pragma once
// What steers a correction while the path runs: an offset on top of the confirmed displacement, asked for in every
// cycle. The corrector brings it onto the path within its limits (trail.h) and leads it back with everything else.

#include <cstdint>
#include <memory>
#include <optional>

#include "core/text.h"
#include "devices/cyclic/protocol.h"

namespace seamwright {

// How far the application's path is that is corrected.
enum class PathPhase {
    none,     // no correction confirmed
    waiting,  // confirmed, the path stands
    running,
    over,  // it stood when the session ended, or the program says so
};

// Called on the thread that answers the robot, under its lock: no call waits, allocates, or calls back.
class PathSteering {
  public:
    virtual ~PathSteering() = default;
    // Each packet in order, old ones left out. `heard_ns`: when it came, steady clock.
    virtual void see(const CyclicPacket& packet, PathPhase phase, std::int64_t heard_ns) = 0;
    struct Wanted {
        Eigen::Vector3d offset_mm = Eigen::Vector3d::Zero();  // reference frame
        Eigen::Vector3d rate_mm_s = Eigen::Vector3d::Zero();  // its change along the running path
        std::optional<Text> alarm;  // the correction is led back, and the path stops
    };
    // The correction is led back, for whatever reason. It may allocate.
    virtual void alarmed(const Text& reason) = 0;
    // While the path runs: for the packet that is answered. `present_mm`: as the robot has taken it.
    virtual Wanted wanted(const CyclicPacket& packet, const Eigen::Vector3d& present_mm) = 0;
};

// A RobotLink whose correction can be steered is one of these too.
class SteeredLink {
  public:
    virtual ~SteeredLink() = default;
    // From the next packet on; nullptr: nobody steers. A correction in force is led to the target without steering.
    virtual void steer(std::shared_ptr<PathSteering> steering) = 0;
    virtual PathPhase path_phase() const = 0;
    // What the packets' poses are: base_from_flange = base_from_reference reference_from_tcp flange_from_tcp^-1.
    virtual const Pose& base_from_reference() const = 0;
    virtual const Pose& flange_from_tcp() const = 0;
    virtual double cycle_s() const = 0;
    // The controller makes the part of a correction along the travel too (RSI), or only what lies across it (EGM).
    virtual bool shifts_along() const = 0;
};

}  // namespace seamwright
