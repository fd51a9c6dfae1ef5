#pragma once
// Sensors that run for the screen, each on a thread of its own: software triggers about every 60 ms where the sensor
// waits for triggers (LiveFeed shows the newest frame), its settings twice a second. One that gives no frame, which it
// may take seconds to say, is asked again every second and keeps no other waiting; a recording that has ended is not.

#include <memory>
#include <vector>

#include "core/parameter.h"
#include "core/text.h"
#include "devices/profile_source.h"

namespace seamwright {

struct SensorState {
    std::string id;
    SensorIdentity identity;
    SourceCounters counters;
    std::vector<ParameterInfo> parameters;  // of the device: exposure_us, ...
    ParameterValues values;
    Text trouble;  // why no frames come; empty when they do
};

// All of it but the id, as the device has it. One that does not answer is asked once and is in trouble.
void read_settings(ProfileSource& sensor, SensorState& state);

class LiveSensors {
  public:
    LiveSensors();
    ~LiveSensors();  // stops the sensors and sets their triggers back; within about a frame where they answer

    // From now on the sensor is this object's alone, but for latest() and counters(). `known`: its id, and what was
    // known of it. `sensor` must stay until this object goes.
    void add(ProfileSource& sensor, SensorState known);
    std::vector<SensorState> states();  // in the order of add()

  private:
    struct Lane;
    std::vector<std::unique_ptr<Lane>> lanes_;
};

}  // namespace seamwright
