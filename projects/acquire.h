#pragma once
// From a robot's trigger to the sensor's frame: one way for runs, teaching and passes.

#include <chrono>
#include <functional>
#include <vector>

#include "devices/profile_source.h"
#include "devices/robot_link.h"
#include "projects/project.h"

namespace seamwright {

struct AcquireLimits {
    std::chrono::milliseconds trigger_timeout{20000};  // robot: from one spot to the next
    std::chrono::milliseconds frame_timeout{3000};     // sensor: from trigger to frame
};

// entry -> trigger -> exit along the sensor's Y with the orientation held.
MeasuringMove measuring_move(const Spot& spot, const Pose& flange_from_sensor);

// The frame that belongs to the trigger of `spot_id`. A sensor that is not wired to the robot (setting
// "hardware_trigger") is triggered here. A free-running sensor may still hold frames of before; those of
// other spots are dropped and told.
Expected<FramePtr> frame_at_trigger(ProfileSource& sensor, const SensorSetup& setup,
                                    const std::string& spot_id, std::chrono::milliseconds timeout,
                                    const std::function<void(const Frame& dropped)>& dropped);

// Stops every started sensor, however the work ends.
class StartedSensors {
  public:
    StartedSensors() = default;
    StartedSensors(const StartedSensors&) = delete;
    StartedSensors& operator=(const StartedSensors&) = delete;
    ~StartedSensors();
    Expected<void> start(ProfileSource& sensor);

  private:
    std::vector<ProfileSource*> started_;
};

}  // namespace seamwright
