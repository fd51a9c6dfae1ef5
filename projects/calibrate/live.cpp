#include "projects/calibrate/live.h"

#include <algorithm>
#include <thread>

#include "core/geometry/notation.h"
#include "devices/registry.h"
#include "projects/calibrate/session/answer.h"
#include "projects/calibrate/session/guide.h"
#include "projects/calibrate/session/shot.h"
#include "projects/measure/measure.h"
#include "projects/station/acquire.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLook{50}, kStill{500};
constexpr double kStillMm = 0.02, kStillDeg = 0.005, kNewMm = 3, kNewDeg = 1;

bool apart(const Pose& a, const Pose& b, double mm, double deg) {
    return distance_mm(a, b) > mm || angle_rad(a, b) > rad_from_deg(deg);
}

// The simulated sensor looks at the method's target as long as this lives.
class ShownTarget {
  public:
    ShownTarget(ProfileSource& sensor, const std::string& scene) : sensor_(sensor) {
        for (const ParameterInfo& p : sensor.parameters()) {
            if (p.name != "scene") continue;
            const auto at = std::find(p.choices.begin(), p.choices.end(), scene);
            auto before = sensor.get("scene");
            if (at == p.choices.end() || !before) return;
            if (sensor.set("scene", static_cast<double>(at - p.choices.begin()))) before_ = *before;
        }
    }
    ShownTarget(const ShownTarget&) = delete;
    ShownTarget& operator=(const ShownTarget&) = delete;
    ~ShownTarget() {
        if (before_) (void)sensor_.set("scene", *before_);
    }

  private:
    ProfileSource& sensor_;
    std::optional<double> before_;
};

class Live {
  public:
    Live(Station& station, const LiveCalibrationOptions& options, CalibrationSession& session,
         RobotLink& robot)
        : station_(station), options_(options), session_(session), robot_(robot) {
        const RobotSetup* setup = find_robot(station.project(), session.robot_id());
        moves_ = setup && is_simulated_cell(setup->driver);
        wanted_ = options.captures > 0 ? options.captures : session.method().advised;
        kept_back_ = session.method().keeps_back ? options.verification : 0;
    }

    Expected<void> capture_all() {
        for (;;) {
            const bool verification = session_.solving_captures() >= wanted_;
            if (verification && session_.verification_captures() >= kept_back_) return {};
            SEAM_TRY(auto there, moves_ ? go() : wait());
            if (!there) return keep_back();
            SEAM_OK(capture(verification));
        }
    }

  private:
    void say(const Text& text) const {
        if (options_.said) options_.said(text);
    }

    std::optional<Pose> target() const { return next_place(session_, station_.project()); }

    // false: there is no pose left to go to.
    Expected<bool> go() const {
        const auto to = target();
        if (!to) return false;
        SEAM_OK(robot_.move_to(*to));
        return true;
    }

    bool taken_at(const Pose& at) const {
        const auto& captures = session_.state().captures;
        return std::any_of(captures.begin(), captures.end(), [&](const SessionCapture& c) {
            return c.taken->base_from_flange && !apart(*c.taken->base_from_flange, at, kNewMm, kNewDeg);
        });
    }

    Text where_to() const {
        const int number = static_cast<int>(session_.state().captures.size()) + 1;
        const int of = wanted_ + kept_back_;
        const auto to = target();
        if (!to)
            return Text(
                "capture {} of {}: bring the target into view, turned otherwise than before, and let the "
                "robot "
                "stand still",
                number, of);
        const KukaAbc turn = kuka_from_rotation(to->linear());
        const Eigen::Vector3d p = to->translation();
        return Text(
            "capture {} of {}: bring the robot to about X {:.1f}, Y {:.1f}, Z {:.1f} mm, A {:.1f}, B {:.1f}, "
            "C {:.1f} deg and let it stand still",
            number, of, p.x(), p.y(), p.z(), turn.a_deg, turn.b_deg, turn.c_deg);
    }

    // Until the robot stands at a new place.
    Expected<bool> wait() {
        say(where_to());
        const auto end = Clock::now() + options_.patience;
        std::optional<Pose> last;
        auto still_since = Clock::now();
        while (Clock::now() < end) {
            if (options_.cancel.stop_requested()) return device_error(kCancelled, session_.method().id);
            SEAM_TRY(auto at, robot_.base_from_flange());
            if (!last || apart(*last, at, kStillMm, kStillDeg)) still_since = Clock::now();
            last = at;
            const bool refused_here = refused_at_ && !apart(*refused_at_, at, kNewMm, kNewDeg);
            if (Clock::now() - still_since >= kStill && !taken_at(at) && !refused_here) return true;
            std::this_thread::sleep_for(kLook);
        }
        return device_error("the robot has not come to rest at a new place in time",
                            Text("robot {}", session_.robot_id()),
                            "move it, or give it longer; what was captured is kept");
    }

    Expected<void> capture(bool verification) {
        if (options_.cancel.stop_requested()) return device_error(kCancelled, session_.method().id);
        std::vector<std::string> connected;
        for (const SensorSetup& s : station_.project().sensors)
            if (station_.sensor(s.id)) connected.push_back(s.id);
        const auto sensors = shot_sensors(session_, station_.project(), connected);
        SEAM_TRY(auto settings, capture_settings(session_, station_.project(), sensors));
        CalibrationShots shots;
        for (const std::string& id : sensors)
            shots.push_back(take_shot(station_, SensorId(id), RobotId(session_.robot_id()),
                                      shows_board(session_.method().capture), options_.cancel));
        if (!shots.front() && shots.front().error().kind == ErrorKind::device)
            return tl::unexpected(shots.front().error());
        auto taken =
            captures_of_shots(session_, station_.project(), std::move(settings), shots, options_.cancel);
        for (const Error& refusal : taken.refusals) say(refusal.text());
        if (taken.captures.empty()) {
            if (taken.refusals.empty()) return device_error(kCancelled, session_.method().id);
            // A person brings the target into view; a simulated robot would come here again.
            if (moves_) return tl::unexpected(taken.refusals.front());
            SEAM_TRY(auto at, robot_.base_from_flange());
            refused_at_ = at;
            return {};
        }
        if (auto ok =
                add_captures(session_, std::move(taken.captures), std::move(taken.settings), verification);
            !ok)
            return ok;
        say(verification
                ? Text("capture {} is kept for verification", session_.state().captures.back().taken->id)
                : Text("capture {} is taken", session_.state().captures.back().taken->id));
        return {};
    }

    Expected<void> keep_back() {
        for (const std::string& id : to_keep_back(session_, kept_back_))
            SEAM_OK(session_.set_verification(id, true));
        return {};
    }

    Station& station_;
    const LiveCalibrationOptions& options_;
    CalibrationSession& session_;
    RobotLink& robot_;
    bool moves_ = false;
    int wanted_ = 0, kept_back_ = 0;
    std::optional<Pose> refused_at_;
};

Expected<std::string> robot_of(const Project& project, const CalibrationMethod& method,
                               const std::string& asked) {
    if (!asked.empty()) {
        if (!find_robot(project, asked))
            return usage_error(Text("the project has no robot \"{}\"", asked), "--robot");
        return asked;
    }
    if (project.robots.size() == 1) return project.robots.front().id;
    return usage_error(project.robots.empty() ? Text("the project has no robot")
                                              : Text("the project has {} robots", project.robots.size()),
                       Text("calibrate {}", method.id), "say which one carries the sensor");
}

// The answer into the project, all of it or nothing.
Expected<std::vector<std::string>> store(Station& station, CalibrationSession& session, bool use) {
    SEAM_TRY(auto made, calibrations_of_session(session, station.project()));
    Project project = station.project();
    std::vector<std::string> ids;
    for (Calibration& c : made) {
        ids.push_back(c.id);
        for (SensorSetup& s : project.sensors)
            if (use && s.id == c.sensor_id) s.calibration_id = c.id;
        project.calibrations.push_back(std::move(c));
    }
    SEAM_OK(station.edit(project));
    SEAM_OK(session.set_used_as(ids));
    return ids;
}

}  // namespace

Expected<LiveCalibration> calibrate_live(Station& station, const CalibrationMethod& method,
                                         const LiveCalibrationOptions& options) {
    if (method.capture == CaptureKind::files)
        return usage_error("the data of this method are loaded from a file", method.id);
    // Standing still is no touch.
    if (method.capture == CaptureKind::touch)
        return usage_error("a person says when the tip touches", method.id,
                           "capture in the studio, or write the poses to a file");
    const SensorSetup* setup = find_sensor(station.project(), options.sensor_id);
    if (!setup) return usage_error(Text("the project has no sensor \"{}\"", options.sensor_id), "--sensor");
    ProfileSource* sensor = station.sensor(options.sensor_id);
    if (!sensor)
        return device_error("the sensor is not connected", Text("sensor {}", options.sensor_id),
                            "connect it");
    SEAM_TRY(const auto robot, robot_of(station.project(), method, options.robot_id));
    RobotLink* link = station.robot(robot);
    if (!link) return device_error("the robot is not connected", Text("robot {}", robot), "connect it");
    std::vector<std::string> robots;
    for (const RobotSetup& r : station.project().robots) robots.push_back(r.id);
    std::vector<std::string> sensors;
    for (const SensorSetup& s : station.project().sensors) sensors.push_back(s.id);
    SEAM_TRY(auto session,
             CalibrationSession::open(station.file().path(), MethodId(method.id), SensorId(options.sensor_id),
                                      RobotId(robot), robots, sensors));
    if (options.anew || session.stage() == SessionStage::used) SEAM_OK(session.begin_anew());
    for (const auto& [name, value] : options.settings) SEAM_OK(session.set(name, value));
    std::optional<ShownTarget> shown;
    if (is_simulated_cell(setup->driver))
        if (const auto start = simulated_start(method, setup->settings)) shown.emplace(*sensor, start->scene);
    Live live(station, options, session, *link);
    SEAM_OK(live.capture_all());

    SEAM_TRY(auto solution, session.solve());
    SEAM_OK(session.take(solution, session.state()));
    LiveCalibration answer{
        std::move(solution), session.verification(), session.solving_captures(), {}, false};
    if (session.stage() != SessionStage::use || method.use == AnswerUse::check) return answer;
    answer.used = options.use && method.use == AnswerUse::sensor;
    SEAM_TRY(auto stored, store(station, session, answer.used));
    answer.stored = std::move(stored);
    return answer;
}

}  // namespace seamwright
