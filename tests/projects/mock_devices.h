#pragma once
// Devices under the test's control.

#include <gmock/gmock.h>

#include <map>

#include "devices/profile_source.h"
#include "devices/robot_link.h"

namespace seamwright {

class MockRobot : public RobotLink {
  public:
    MOCK_METHOD(Expected<RobotIdentity>, identity, (), (override));
    MOCK_METHOD(Expected<RobotMode>, mode, (), (override));
    MOCK_METHOD(Expected<Pose>, base_from_flange, (), (override));
    MOCK_METHOD(Expected<void>, start_measuring, (const std::vector<MeasuringMove>&), (override));
    MOCK_METHOD(Expected<TriggerEvent>, wait_trigger, (std::chrono::milliseconds), (override));
    MOCK_METHOD(Expected<Pose>, read_frame, (const std::string&), (override));
    MOCK_METHOD(Expected<void>, write_frame, (const std::string&, const Pose&), (override));
};

class MockSensor : public ProfileSource {
  public:
    MOCK_METHOD(SensorIdentity, identity, (), (const, override));
    MOCK_METHOD(Expected<void>, start, (), (override));
    MOCK_METHOD(void, stop, (), (override));
    MOCK_METHOD(Expected<void>, trigger, (const std::string&), (override));
    MOCK_METHOD(Expected<FramePtr>, wait_next, (std::chrono::milliseconds), (override));
    MOCK_METHOD(FramePtr, latest, (), (const, override));
    MOCK_METHOD(SourceCounters, counters, (), (const, override));
    MOCK_METHOD(std::vector<ParameterInfo>, parameters, (), (const, override));
    MOCK_METHOD(Expected<double>, get, (const std::string&), (const, override));
    MOCK_METHOD(Expected<void>, set, (const std::string&, double), (override));
};

}  // namespace seamwright
