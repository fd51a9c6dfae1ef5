#include "tests/projects/fake_cell.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "devices/capture/capture.h"
#include "devices/silence.h"

namespace seamwright {

FakeCell::FakeCell() = default;
FakeCell::~FakeCell() = default;

Profile FakeCell::cut(const Spot& spot) {
    const Calibration& calibration = project.calibrations.front();
    const Pose taught = spot.base_from_flange * calibration.flange_from_sensor;
    const auto moved = actual.find(spot.id);
    const Pose sensor =
        (moved == actual.end() ? spot.base_from_flange : moved->second) * calibration.flange_from_sensor;
    const Pose& base_from_workobject = project.part.base_from_workobject;
    const Pose sensor_from_taught = sensor.inverse() * base_from_workobject *
                                    workobject_from_movedworkobject * base_from_workobject.inverse() * taught;
    Profile profile;
    std::normal_distribution<double> noise(0, 1);
    for (int i = 299; i >= 0; --i) {
        // Half a pitch inside: the contour end is estimated half a pitch beyond the last point.
        Eigen::Vector3d p = spot.reference_mm - Eigen::Vector3d(0.05 * (i + 0.5), 0, 0);
        // Along the half plane's Y until the laser plane is met.
        const Eigen::Vector3d along = sensor_from_taught.linear().col(1);
        Eigen::Vector3d q = sensor_from_taught * p;
        q -= along * (q.y() / along.y());
        profile.x_mm.push_back(q.x() + noise_mm * noise(rng));
        profile.z_mm.push_back(q.z() + noise_mm * noise(rng));
        profile.intensity.push_back(100);
    }
    return profile;
}

SensorIdentity FakeSensor::identity() const {
    return cell_.sensor_identity;
}

Expected<void> FakeSensor::answers() {
    if (cell_.gone_sensor) return device_error(ErrorCode::disconnected, kDisconnected, "sensor A");
    return {};
}

Expected<void> FakeSensor::start() {
    if (cell_.dead_sensor || cell_.gone_sensor)
        return device_error(ErrorCode::disconnected, kDisconnected, "sensor A");
    started = true;
    return {};
}

void FakeSensor::stop() {
    started = false;
}

Expected<void> FakeSensor::trigger(const std::string& spot_id) {
    waiting_ = spot_id;
    if (cell_.on_trigger) cell_.on_trigger(spot_id);
    return {};
}

Expected<FramePtr> FakeSensor::wait_next(std::chrono::milliseconds) {
    if (!started || waiting_.empty() || waiting_ == cell_.silent_sensor_at)
        return device_error("the sensor is silent", "sensor A");
    auto frame = std::make_shared<Frame>();
    frame->sequence = ++sequence_;
    frame->spot_id = waiting_ == cell_.wrong_spot_at && !wrong_sent_ ? "S0" : waiting_;
    wrong_sent_ = wrong_sent_ || frame->spot_id == "S0";
    frame->host_time_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(
                              std::chrono::steady_clock::now().time_since_epoch())
                              .count();
    for (const Spot& spot : cell_.project.spots)
        if (spot.id == waiting_) frame->profile = cell_.cut(spot);
    if (waiting_ == cell_.damaged_at) frame->status = FrameStatus::incomplete;
    if (waiting_ == cell_.empty_at) frame->profile.clear();
    return frame;
}

FramePtr FakeSensor::latest() const {
    return nullptr;
}

SourceCounters FakeSensor::counters() const {
    return {};
}

Expected<double> FakeSensor::get(const std::string&) const {
    return input_error("no parameter");
}

Expected<void> FakeSensor::set(const std::string&, double) {
    return input_error("no parameter");
}

Expected<RobotIdentity> FakeRobot::identity() {
    return cell_.robot_identity;
}

Expected<RobotMode> FakeRobot::mode() {
    return cell_.mode;
}

Expected<Pose> FakeRobot::base_from_flange() {
    return Pose::Identity();
}

Expected<void> FakeRobot::start_measuring(const std::vector<MeasuringMove>& moves) {
    moves_ = moves;
    next_ = 0;
    cell_.permission = Permission::none;
    return {};
}

Expected<TriggerEvent> FakeRobot::wait_trigger(std::chrono::milliseconds) {
    if (next_ >= moves_.size() || moves_[next_].spot_id == cell_.silent_robot_at)
        return device_error("the robot is silent", "robot R1");
    TriggerEvent event;
    event.spot_id = moves_[next_++].spot_id;
    const auto it = cell_.reported.find(event.spot_id);
    event.base_from_flange = it == cell_.reported.end() ? moves_[next_ - 1].trigger : it->second;
    return event;
}

Expected<Pose> FakeRobot::read_frame(const std::string& name) {
    if (!cell_.verdicts.empty() && cell_.verdicts.back() == PartVerdict::corrected) {
        if (cell_.frames_unread_after_verdict) return device_error("the controller does not say");
        const auto kept = cell_.frames_after_verdict.find(name);
        if (kept != cell_.frames_after_verdict.end()) return kept->second;
    }
    const auto it = cell_.frames.find(name);
    if (it == cell_.frames.end()) return device_error("there is no frame " + name);
    return it->second;
}

Expected<void> FakeRobot::write_frame(const std::string& name, const Pose& pose) {
    ++cell_.writes;
    const bool first = written_.insert(name).second;
    if (name == cell_.write_fails && first) return device_error("the controller refuses");
    cell_.frames[name] = pose;
    if (name == cell_.write_spoils && first) cell_.frames[name].translation().z() += 0.5;
    return {};
}

Expected<StartSignal> FakeRobot::wait_start(std::chrono::milliseconds timeout) {
    if (cell_.starts.empty()) {
        std::this_thread::sleep_for(std::min(timeout, std::chrono::milliseconds(2)));
        return device_error(ErrorCode::silence, kNoAnswer, "robot R1");
    }
    Expected<StartSignal> start = std::move(cell_.starts.front());
    cell_.starts.pop_front();
    return start;
}

Expected<void> FakeRobot::confirm(PartVerdict verdict, const std::string&) {
    cell_.verdicts.push_back(verdict);
    if (verdict == PartVerdict::refused && cell_.on_refused) cell_.on_refused();
    const bool deaf = cell_.deaf_to == verdict;
    if ((!deaf || cell_.deaf_but_obeys) && cell_.permission != Permission::taken) {
        cell_.permission = verdict == PartVerdict::corrected ? Permission::given : Permission::none;
        if (verdict == PartVerdict::corrected && cell_.application) cell_.permission = Permission::taken;
    }
    if (deaf) return device_error(ErrorCode::silence, kNoAnswer, "robot R1");
    return {};
}

Expected<Permission> FakeRobot::permission() {
    if (cell_.on_permission) cell_.on_permission();
    return cell_.permission;
}

std::unique_ptr<FakeCell> make_fake_cell(int spots) {
    auto cell = std::make_unique<FakeCell>();
    Project& p = cell->project;
    p.name = "fake";
    p.part.name = "plate";
    p.part.base_from_workobject = make_pose(rotation_exp({0.2, -0.1, 0.4}), {1500, 200, 600});
    SensorSetup sensor;
    sensor.id = "A";
    sensor.driver = "fake";
    sensor.calibration_id = "C1";
    p.sensors.push_back(sensor);
    RobotSetup robot;
    robot.id = "R1";
    robot.driver = "fake";
    robot.required_mode = RobotMode::external;
    p.robots.push_back(robot);
    Calibration c;
    c.id = "C1";
    c.method = "simulated truth";
    c.sensor_id = "A";
    c.robot_id = "R1";
    c.sensor_identity = cell->sensor_identity;
    c.robot_identity = cell->robot_identity;
    c.flange_from_sensor = make_pose(rotation_exp({0.1, 0.7, -0.3}), {30, -20, 250});
    c.verdict = Verdict::good;
    c.created_utc = utc_now();
    p.calibrations.push_back(c);
    for (int i = 0; i < spots; ++i) {
        const double turn = 2 * kPi * i / spots;
        const Eigen::Matrix3d r = rotation_exp(Eigen::Vector3d(0, 0, turn + 0.3)) *
                                  rotation_exp(Eigen::Vector3d(0.3 * (i % 3), 0.2 * (i % 2), 0));
        const Pose workobject_from_sensor =
            make_pose(r, Eigen::Vector3d(500 * std::cos(turn), 400 * std::sin(turn), 40 * (i % 2)));
        Spot s;
        s.id = "S" + std::to_string(i + 1);
        s.sensor_id = "A";
        s.robot_id = "R1";
        s.base_from_flange =
            p.part.base_from_workobject * workobject_from_sensor * c.flange_from_sensor.inverse();
        s.feature.kind = "contour-end";
        s.feature.parameters = {{"side", 1}};
        s.reference_mm = {1.5, 0, -2};
        s.sigma_mm = 0.03;
        p.spots.push_back(s);
    }
    for (const char* id : {"inner", "outer"}) {
        Region region;
        region.id = id;
        for (const Spot& s : p.spots) region.spot_ids.push_back(s.id);
        region.frame_name = std::string("BASE_") + id;
        region.base_from_frame = make_pose(rotation_exp({0.3, 0.2, id[0] * 0.01}), {1400, 100, 500});
        cell->frames[region.frame_name] = region.base_from_frame;
        p.regions.push_back(region);
    }
    return cell;
}

}  // namespace seamwright
