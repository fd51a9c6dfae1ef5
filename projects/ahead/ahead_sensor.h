#pragma once
// The sensor before the tool, on a thread of its own while the path runs: triggered, measured like a spot, told to the
// steering with the flange's pose at the exposure.
//
// The exposure lies `latency_s` behind the trigger, which is taken at the middle of its call; a frame that knows where
// the robot stood brings its own pose. Covariance of a point: the feature's in the sensor, turned into base, and one
// arrival of the robot.

#include <atomic>
#include <memory>
#include <thread>

#include "devices/profile_source.h"
#include "projects/ahead/seam_steering.h"
#include "projects/measure/measure.h"

namespace seamwright {

struct AheadSensorSetup {
    Pose flange_from_sensor = Pose::Identity();
    double latency_s = 0;
    Matrix6 arrival_covariance = Matrix6::Zero();
    std::chrono::milliseconds frame_timeout{1000};  // longer without a frame: the sensor is lost
};

class AheadSensor {
  public:
    // Begins at once, and measures while the steering's path runs. `sensor` is started, and left alone by everybody else
    // from the release to end().
    AheadSensor(ProfileSource& sensor, SpotMeasurer measurer, std::shared_ptr<SeamSteering> steering,
                const AheadSensorSetup& setup);
    ~AheadSensor() { end(); }
    AheadSensor(const AheadSensor&) = delete;
    AheadSensor& operator=(const AheadSensor&) = delete;
    void end();  // and waits for it

  private:
    void run();
    Expected<void> measure(std::uint64_t number);

    ProfileSource& sensor_;
    SpotMeasurer measurer_;
    std::shared_ptr<SeamSteering> steering_;
    const AheadSensorSetup setup_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;  // last
};

}  // namespace seamwright
