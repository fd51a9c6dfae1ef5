#include "core/calibration/robot_repeatability.h"

#include <cmath>

#include "core/geometry/pose.h"

namespace seamwright {

double place_sigma_mm(const RobotRepeatability& robot, double lever_mm) {
    return std::hypot(robot.sigma_mm, robot.sigma_rad * lever_mm);
}

Expected<void> check_repeatability(const RobotRepeatability& robot) {
    constexpr double kMost_mm = 10, kMost_deg = 5;
    if (robot.sigma_mm >= 0 && robot.sigma_mm <= kMost_mm && robot.sigma_rad >= 0 &&
        robot.sigma_rad <= rad_from_deg(kMost_deg))
        return {};
    return input_error("the robot's repeatability is negative, not finite or above 10 mm and 5 degrees",
                       "robot", "give one standard deviation of an arrival, e.g. 0.03 mm and 0.005 degrees");
}

}  // namespace seamwright
