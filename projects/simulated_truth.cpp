#include "projects/simulated_truth.h"

#include "devices/capture/capture.h"
#include "devices/simulated/cell.h"

namespace seamwright {

Expected<Calibration> simulated_truth(const SensorSetup& sensor, const RobotSetup& robot) {
    if (sensor.driver != "simulated" || robot.driver != "simulated")
        return input_error("only a simulated cell knows its own calibration", "sensor " + sensor.id,
                           "calibrate the sensor");
    auto cell = SimulatedCell::open(sensor.settings);
    if (!cell) return tl::unexpected(cell.error());
    Calibration c;
    c.id = "simulated-truth";
    c.method = "simulated truth";
    c.sensor_id = sensor.id;
    c.robot_id = robot.id;
    c.sensor_identity = sensor.identity;
    c.robot_identity = robot.identity;
    c.created_utc = utc_now();
    c.source = "the simulated cell's own optics and mounting";
    c.model = (*cell)->sensor_model();
    c.flange_from_sensor = (*cell)->flange_from_sensor();
    c.verdict = "good";
    return c;
}

}  // namespace seamwright
