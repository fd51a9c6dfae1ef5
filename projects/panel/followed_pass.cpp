#include <chrono>
#include <cmath>
#include <thread>

#include "projects/panel/pass_sections.h"

namespace seamwright {
namespace passing {

Expected<PassDevices> devices_of(const Project& project, const std::string& sensor_id,
                                 const std::string& robot_id) {
    PassDevices d{sensor_id, robot_id};
    if (d.sensor_id.empty() && project.sensors.size() == 1) d.sensor_id = project.sensors.front().id;
    if (d.robot_id.empty() && project.robots.size() == 1) d.robot_id = project.robots.front().id;
    if (d.sensor_id.empty())
        return usage_error("the project does not have exactly one sensor", project.name,
                           "name the one that scans: --sensor ID");
    if (d.robot_id.empty())
        return usage_error("the project does not have exactly one robot", project.name,
                           "name the one that carries the sensor: --robot ID");
    if (!find_sensor(project, d.sensor_id))
        return input_error(Text("the project has no sensor \"{}\"", d.sensor_id), project.name);
    if (!find_robot(project, d.robot_id))
        return input_error(Text("the project has no robot \"{}\"", d.robot_id), project.name);
    if (!calibration_of(project, d.sensor_id))
        return input_error(Text("sensor {} has no calibration", d.sensor_id), project.name,
                           "calibrate it first");
    return d;
}

}  // namespace passing

namespace {

using FollowClock = std::chrono::steady_clock;
constexpr double kTurnRad = 0.035;                 // as good as a step
constexpr double kRestMm = 0.05, kRestRad = 2e-4;  // from one look to a second later: it rests
constexpr std::chrono::milliseconds kBetweenLooks{5};

double seconds_between(FollowClock::time_point a, FollowClock::time_point b) {
    return std::chrono::duration<double>(b - a).count();
}

// Whether the robot has moved at all, and how long it has rested since.
class Movement {
  public:
    explicit Movement(const Pose& first) : first_(first), anchor_(first), since_(FollowClock::now()) {}
    void see(const Pose& at) {
        if (distance_mm(at, anchor_) <= kRestMm && angle_rad(at, anchor_) <= kRestRad) return;
        anchor_ = at;
        since_ = FollowClock::now();
        moved_ = moved_ || distance_mm(at, first_) > 1 || angle_rad(at, first_) > kTurnRad / 2;
    }
    bool moved() const { return moved_; }
    double rested_s() const { return seconds_between(since_, FollowClock::now()); }

  private:
    Pose first_, anchor_;
    FollowClock::time_point since_;
    bool moved_ = false;
};

struct Look {
    FollowClock::time_point time;  // middle of question and answer
    Pose base_from_flange;
};
Expected<Look> look_at(RobotLink& robot) {
    const auto asked = FollowClock::now();
    SEAM_TRY(auto pose, robot.base_from_flange());
    return Look{asked + (FollowClock::now() - asked) / 2, pose};
}

// One profile and the poses on either side of it.
struct Shot {
    FramePtr frame;
    Pose base_from_flange;
    Look after;
    double travel_sigma_mm = 0;
};
Expected<Shot> shoot(ProfileSource& sensor, RobotLink& robot, const Look& before,
                     const Pose& flange_from_sensor, std::size_t number, const std::stop_token& cancel) {
    Shot shot;
    const auto triggered = FollowClock::now();
    SEAM_OK(sensor.trigger(std::to_string(number)));
    SEAM_TRY(shot.frame, next_frame(sensor, AcquireLimits{}.frame_timeout, cancel));
    const auto came = FollowClock::now();
    SEAM_TRY(shot.after, look_at(robot));
    const double between = seconds_between(before.time, shot.after.time);
    const auto middle = triggered + (came - triggered) / 2;
    const double share =
        between > 0 ? std::clamp(seconds_between(before.time, middle) / between, 0.0, 1.0) : 0;
    shot.base_from_flange = interpolate(before.base_from_flange, shot.after.base_from_flange, share);
    const double travel = distance_mm(before.base_from_flange * flange_from_sensor,
                                      shot.after.base_from_flange * flange_from_sensor);
    if (between > 0)
        shot.travel_sigma_mm = travel * (seconds_between(triggered, came) / between / std::sqrt(12.0));
    return shot;
}

}  // namespace

Expected<GapPass> followed_pass(Station& station, const FollowedPass& options) {
    if (!(options.step_mm >= 0.05) || !std::isfinite(options.step_mm))
        return usage_error(Text("a step of {} mm", options.step_mm), "step", "give 0.05 mm or more");
    const Project& project = station.project();
    SEAM_TRY(const auto names, passing::devices_of(project, options.sensor_id, options.robot_id));
    SEAM_TRY(auto sections, passing::Sections::make(project, names.sensor_id));
    ProfileSource* sensor = station.sensor(names.sensor_id);
    RobotLink* robot = station.robot(names.robot_id);
    if (!sensor || !robot)
        return usage_error(Text("sensor {} or robot {} is not connected", names.sensor_id, names.robot_id),
                           project.name, "connect first");
    const Pose mounting = sections.calibration().flange_from_sensor;
    SEAM_TRY(const auto by_software, SoftwareTriggered::begin(*sensor));
    StartedSensors started;
    SEAM_OK(started.start(*sensor, options.cancel));
    const auto begun = FollowClock::now();
    SEAM_TRY(auto look, look_at(*robot));
    Movement movement(look.base_from_flange);
    std::optional<Pose> last;  // of the sensor, at the last profile that was kept
    GapPass& pass = sections.pass;
    while (pass.frames < options.most_profiles && !options.finish.stop_requested() &&
           seconds_between(begun, FollowClock::now()) < options.most_s) {
        if (options.cancel.stop_requested()) return device_error(kCancelled, project.name);
        movement.see(look.base_from_flange);
        if (options.rest_s > 0 && movement.moved() && movement.rested_s() > options.rest_s) break;
        const Pose at = look.base_from_flange * mounting;
        if (last && distance_mm(at, *last) < options.step_mm && angle_rad(at, *last) < kTurnRad) {
            std::this_thread::sleep_for(kBetweenLooks);
            SEAM_TRY(look, look_at(*robot));
            continue;
        }
        SEAM_TRY(auto shot, shoot(*sensor, *robot, look, mounting, pass.frames + 1, options.cancel));
        ++pass.frames;
        sections.add(*shot.frame, shot.base_from_flange);
        pass.travel_sigma_mm = std::max(pass.travel_sigma_mm, shot.travel_sigma_mm);
        look = shot.after;
        last = at;
        const int n = static_cast<int>(pass.frames);
        if (options.progress) options.progress({n, 0, Text("profile {}", n)});
    }
    if (options.cancel.stop_requested()) return device_error(kCancelled, project.name);
    if (!movement.moved())
        return device_error("the robot did not move", Text("robot {}", names.robot_id),
                            "start its program, or jog it along the part, while it is followed");
    return std::move(pass);
}

}  // namespace seamwright
