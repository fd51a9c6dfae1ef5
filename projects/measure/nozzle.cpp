#include "projects/measure/nozzle.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "devices/capture/capture.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

Expected<RobotSetup*> marked_robot(Project& project, const std::string& robot_id) {
    for (RobotSetup& robot : project.robots)
        if (robot.id == robot_id) return &robot;
    return input_error(Text("the project has no robot \"{}\"", robot_id), "--robot");
}

}  // namespace

const Calibration* nozzle_of(const Project& project, const std::string& robot_id) {
    const auto it = std::find_if(
        project.calibrations.rbegin(), project.calibrations.rend(),
        [&](const Calibration& c) { return c.nozzle && c.robot_id == robot_id && serves(c.verdict); });
    return it == project.calibrations.rend() ? nullptr : &*it;
}

double nozzle_sigma_mm(const Calibration& calibration) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(calibration.nozzle->covariance_mm2,
                                                               Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

Text nozzle_trouble(const Project& project, const std::string& robot_id) {
    const Calibration* nozzle = nozzle_of(project, robot_id);
    if (!nozzle) return {};
    const std::string collided = last_collision(project, robot_id);
    if (before_collision(nozzle->created_utc, collided))
        return Text(
            "nozzle calibration {} of robot {} is older than the collision of {}: touch the sphere again",
            nozzle->id, robot_id, collided);
    const RobotSetup* robot = find_robot(project, robot_id);
    if (robot && !robot->identity.serial.empty() && !(robot->identity == nozzle->robot_identity))
        return Text("robot {} is another one ({}) than its nozzle was calibrated on ({})", robot_id,
                    robot->identity.serial, nozzle->robot_identity.serial);
    return {};
}

const RobotSetup* robot_of(const Project& project, const Region& region) {
    for (const std::string& id : region.spot_ids)
        if (const Spot* spot = find_spot(project, id)) return find_robot(project, spot->robot_id);
    return nullptr;
}

double nozzle_sigma_mm(const Project& project, const Region& region) {
    const RobotSetup* robot = robot_of(project, region);
    const Calibration* nozzle = robot ? nozzle_of(project, robot->id) : nullptr;
    return nozzle ? nozzle_sigma_mm(*nozzle) : 0;
}

bool before_collision(const std::string& created_utc, const std::string& collided_utc) {
    if (collided_utc.empty()) return false;
    const auto created = utc_seconds(created_utc), collided = utc_seconds(collided_utc);
    return !created || !collided || *created < *collided;
}

std::string last_collision(const Project& project, const std::string& robot_id) {
    const RobotSetup* robot = find_robot(project, robot_id);
    return robot && !robot->collisions.empty() ? robot->collisions.back() : std::string();
}

Expected<void> mark_collision(Project& project, const std::string& robot_id, const std::string& utc) {
    SEAM_TRY(RobotSetup* const robot, marked_robot(project, robot_id));
    const std::string now = utc_now(), when = utc.empty() ? now : utc;
    const auto seconds = utc_seconds(when);
    if (!seconds)
        return input_error(Text("\"{}\" is no date", when), "--utc", "write it as 2026-03-21T14:05:00Z");
    if (*seconds > *utc_seconds(now))
        return input_error(Text("the collision lies in the future ({})", when), "--utc",
                           "give the date in UTC");
    if (!robot->collisions.empty() && before_collision(when, robot->collisions.back()))
        return input_error(Text("a later collision is marked already ({})", robot->collisions.back()),
                           Text("robot {}", robot_id), "nothing is older than that one and still holds");
    robot->collisions.push_back(when);
    return {};
}

Expected<void> take_collision_back(Project& project, const std::string& robot_id) {
    SEAM_TRY(RobotSetup* const robot, marked_robot(project, robot_id));
    if (robot->collisions.empty()) return input_error("no collision is marked", Text("robot {}", robot_id));
    robot->collisions.pop_back();
    return {};
}

}  // namespace seamwright
