#include "projects/station/acquire.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "devices/host_time.h"
#include "devices/silence.h"
#include "projects/measure/measure.h"
#include "projects/station/light/spot_light.h"

namespace seamwright {
namespace {

// What a frame may come later than the latest of the run; and what it takes where none came after its trigger.
constexpr std::chrono::milliseconds kLaterStill{100}, kNoLatency{500};
// A frame this far off its own trigger, and so near to a neighbour's, is the neighbour's.
constexpr std::chrono::milliseconds kNotItsOwn{120}, kTheOthers{60};

std::int64_t median(std::vector<std::int64_t> of) {
    const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
    std::nth_element(of.begin(), middle, of.end());
    return *middle;
}

}  // namespace

bool hardware_triggered(const SensorSetup& sensor) {
    const auto it = sensor.settings.find("hardware_trigger");
    return it != sensor.settings.end() && it->is_boolean() && it->get<bool>();
}

MeasuringMove measuring_move(const Spot& spot, const Pose& flange_from_sensor) {
    MeasuringMove move;
    move.spot_id = spot.id;
    move.via = spot.via;
    move.trigger = spot.base_from_flange;
    const Eigen::Vector3d travel = (spot.base_from_flange * flange_from_sensor).linear().col(1);
    move.entry = move.exit = move.trigger;
    move.entry.translation() -= spot.entry_mm * travel;
    move.exit.translation() += spot.exit_mm * travel;
    move.speed_mm_s = spot.speed_mm_s;
    move.stop_at_trigger = spot.stop_at_trigger;
    move.stand_s = standing_time_s(spot);
    return move;
}

int region_number(const Project& project, const std::string& region_id, const std::string& robot_id) {
    int number = 0;
    for (const Region& region : project.regions) {
        const bool its = std::any_of(project.spots.begin(), project.spots.end(), [&](const Spot& spot) {
            return spot.robot_id == robot_id && std::find(region.spot_ids.begin(), region.spot_ids.end(),
                                                          spot.id) != region.spot_ids.end();
        });
        if (its) ++number;
        if (region.id == region_id) return its ? number : 0;
    }
    return 0;
}

std::vector<MeasuringMove> measuring_program(const Project& project, const std::string& robot_id) {
    std::vector<MeasuringMove> moves;
    for (const Spot& spot : project.spots) {
        if (!spot.enabled || spot.robot_id != robot_id) continue;
        const Calibration* calibration = calibration_of(project, spot);
        moves.push_back(
            measuring_move(spot, calibration ? calibration->flange_from_sensor : Pose::Identity()));
        for (const Region& region : project.regions)
            if (std::find(region.spot_ids.begin(), region.spot_ids.end(), spot.id) != region.spot_ids.end())
                moves.back().frames.push_back(
                    {region_number(project, region.id, robot_id), region.frame_name});
    }
    return moves;
}

namespace {

// One wait of `timeout` in slices.
template <class Wait>
auto wait_in_slices(std::chrono::milliseconds timeout, const std::stop_token& cancel, const Wait& wait)
    -> decltype(wait(timeout)) {
    const auto until = std::chrono::steady_clock::now() + timeout;
    for (;;) {
        if (cancel.stop_requested()) return device_error(kCancelled);
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
        const auto slice = std::clamp(left, std::chrono::milliseconds(0), kCancelSlice);
        auto got = wait(slice);
        if (got || !is_silence(got.error()) || left <= kCancelSlice) return got;
    }
}

}  // namespace

Expected<FramePtr> next_frame(ProfileSource& sensor, std::chrono::milliseconds timeout,
                              const std::stop_token& cancel) {
    auto frame = wait_in_slices(timeout, cancel,
                                [&](std::chrono::milliseconds slice) { return sensor.wait_next(slice); });
    if (!frame && is_silence(frame.error()))  // of all slices, not of the last one
        frame.error().what = Text("{}: no frame within {} ms", kNoAnswer, timeout.count());
    if (frame && !*frame) return device_error("the sensor gave no frame");
    return frame;
}

Expected<TriggerEvent> next_trigger(RobotLink& robot, std::chrono::milliseconds timeout,
                                    const std::stop_token& cancel) {
    return wait_in_slices(timeout, cancel,
                          [&](std::chrono::milliseconds slice) { return robot.wait_trigger(slice); });
}

Expected<FramePtr> TriggeredFrames::at(const TriggerEvent& trigger, std::chrono::milliseconds timeout,
                                       const std::stop_token& cancel,
                                       const std::function<void(const Frame& dropped)>& dropped) {
    if (hardware_triggered(setup_)) {
        auto frame = in_order(trigger, timeout, cancel);
        if (!frame) return frame;
        const Frame& f = **frame;
        if (f.spot_id.empty() || f.spot_id == trigger.spot_id) return frame;
        return device_error(Text("the frame is of spot {}", f.spot_id), Text("sensor {}", setup_.id));
    }
    SEAM_OK(sensor_.trigger(trigger.spot_id));
    auto frame = next_frame(sensor_, timeout, cancel);
    while (frame && !(*frame)->spot_id.empty() && (*frame)->spot_id != trigger.spot_id) {
        if (dropped) dropped(**frame);
        frame = next_frame(sensor_, timeout, cancel);
    }
    return frame;
}

Expected<FramePtr> TriggeredFrames::in_order(const TriggerEvent& trigger, std::chrono::milliseconds timeout,
                                             const std::stop_token& cancel) {
    FramePtr frame = std::exchange(early_, nullptr);
    while (!frame || is_over(*frame)) {
        auto next = next_frame(sensor_, timeout, cancel);
        if (!next) return next;
        frame = std::move(*next);
    }
    if (!expected_) expected_ = frame->sequence;
    const std::uint64_t expected = (*expected_)++;
    in_doubt_ = true;
    if (frame->sequence < expected)
        return device_error(Text("frame {} came where frame {} was due", frame->sequence, expected),
                            Text("sensor {}", setup_.id),
                            "the sensor restarted in the middle of the run; measure again");
    if (frame->sequence > expected) {  // the one that is due was lost
        early_ = std::move(frame);
        auto lost = std::make_shared<Frame>();
        lost->status = FrameStatus::incomplete;
        lost->sequence = expected;
        lost->host_time_ns = trigger.host_time_ns;
        lost->spot_id = trigger.spot_id;
        in_doubt_ = false;
        return lost;
    }
    last_trigger_ns_ = trigger.host_time_ns;
    const auto apart = std::chrono::nanoseconds(frame->host_time_ns - trigger.host_time_ns);
    if (is_far(*frame, trigger))
        return device_error(Text("frame {} came {:.1f} s {} the trigger of spot {}", frame->sequence,
                                 std::abs(std::chrono::duration<double>(apart).count()),
                                 apart.count() < 0 ? "before" : "after", trigger.spot_id),
                            Text("sensor {}", setup_.id),
                            apart.count() < 0
                                ? Text("the robot's message came late, or the sensor was triggered by "
                                       "something else: check network and trigger line")
                                : Text("check the trigger line between robot and sensor"));
    in_doubt_ = false;
    if (frame->status == FrameStatus::ok && frame->device_time_ns != 0) {
        device_after_ns_.push_back(frame->device_time_ns - trigger.host_time_ns);
        host_after_ns_.push_back(apart.count());
        trigger_ns_.push_back(trigger.host_time_ns);
        spots_.push_back(trigger.spot_id);
    }
    longest_ns_ = std::max(longest_ns_, apart.count());
    return frame;
}

bool TriggeredFrames::is_far(const Frame& frame, const TriggerEvent& trigger) const {
    using std::chrono::nanoseconds;
    if (frame.host_time_ns == 0) return false;  // nothing came of it
    const std::int64_t host = frame.host_time_ns - trigger.host_time_ns;
    if (frame.status != FrameStatus::ok || frame.device_time_ns == 0 || device_after_ns_.empty())
        return std::chrono::abs(nanoseconds(host)) > kPairingWindow;
    const std::int64_t device = frame.device_time_ns - trigger.host_time_ns;
    return std::chrono::abs(nanoseconds(host - median(host_after_ns_))) > kPairingDrift &&
           std::chrono::abs(nanoseconds(device - median(device_after_ns_))) > kPairingDrift;
}

Expected<void> TriggeredFrames::finish() {
    if (!hardware_triggered(setup_)) return {};
    bool more = early_ != nullptr;
    const std::int64_t latency = longest_ns_ > 0 ? longest_ns_ : std::chrono::nanoseconds(kNoLatency).count();
    const std::int64_t until = last_trigger_ns_ + latency + std::chrono::nanoseconds(kLaterStill).count();
    while (!more) {
        const auto rest = std::chrono::ceil<std::chrono::milliseconds>(
            std::chrono::nanoseconds(std::max<std::int64_t>(until - host_now_ns(), 0)));
        const auto left = sensor_.wait_next(last_trigger_ns_ ? rest : std::chrono::milliseconds(0));
        if (!left) break;
        more = !is_over(**left);
    }
    in_doubt_ = true;
    if (more)
        return device_error("the sensor exposed more often than the robot fired",
                            Text("sensor {}", setup_.id), "check the trigger line between robot and sensor");
    SEAM_OK(own_triggers());
    in_doubt_ = false;
    return {};
}

// A message that came late moves a trigger away from its frame, but not on to that of a neighbour.
Expected<void> TriggeredFrames::own_triggers() const {
    using std::chrono::nanoseconds;
    if (trigger_ns_.size() < 3) return {};
    const std::int64_t usual = median(device_after_ns_);
    // Ticks that are no nanoseconds tell nothing.
    const double robots = static_cast<double>(trigger_ns_.back() - trigger_ns_.front());
    const double sensors = robots + static_cast<double>(device_after_ns_.back() - device_after_ns_.front());
    if (!(sensors > 0.3 * robots && sensors < 3 * robots)) return {};
    for (std::size_t i = 0; i < trigger_ns_.size(); ++i) {
        const std::int64_t own = device_after_ns_[i] - usual;
        if (std::chrono::abs(nanoseconds(own)) < kNotItsOwn) continue;
        for (const std::size_t k : {i - 1, i + 1}) {
            if (k >= trigger_ns_.size()) continue;  // i - 1 of the first, too
            if (std::chrono::abs(nanoseconds(own + trigger_ns_[i] - trigger_ns_[k])) > kTheOthers) continue;
            return device_error(Text("the frame of spot {} was exposed when the robot fired for spot {}",
                                     spots_[i], spots_[k]),
                                Text("sensor {}", setup_.id),
                                "a trigger was missed and another came twice: check the trigger line between "
                                "robot and sensor");
        }
    }
    return {};
}

Expected<void> fired_near(const TriggerEvent& trigger, const Spot& spot) {
    if (!trigger.base_from_flange) return {};
    const double off_mm = distance_mm(*trigger.base_from_flange, spot.base_from_flange);
    const double off_deg = deg_from_rad(angle_rad(*trigger.base_from_flange, spot.base_from_flange));
    if (off_mm <= kFarFromSpotMm && off_deg <= kFarFromSpotDeg) return {};
    return device_error(
        Text("it fired for spot {} at a flange pose {:.0f} mm and {:.0f} deg off the taught one", spot.id,
             off_mm, off_deg),
        Text("robot {}", spot.robot_id),
        "compare the program on the controller with the project, and the pose that it sends with "
        "the robot's display");
}

Expected<Pose> stand_at(RobotLink& robot, const std::string& spot_id, const Pose& base_from_flange) {
    const auto moved = robot.move_to(base_from_flange);
    if (!moved && !robot.base_from_flange()) return tl::unexpected(moved.error());
    auto at = robot.standing_at(base_from_flange);  // moved, or jogged there
    if (at) return at;
    Error error = at.error();
    if (error.where.empty()) error.where = Text("spot {}", spot_id);
    if (!moved) {
        error.what = Text("{} ({})", error.what, moved.error().what);
        error.mend = "jog it there";
    }
    return tl::unexpected(std::move(error));
}

Expected<SoftwareTriggered> SoftwareTriggered::begin(ProfileSource& sensor) {
    SoftwareTriggered triggered;
    for (const ParameterInfo& info : sensor.parameters()) {
        const auto software = std::find(info.choices.begin(), info.choices.end(), "software");
        if (info.name != "trigger" || software == info.choices.end()) continue;
        const auto wanted = static_cast<double>(software - info.choices.begin());
        SEAM_TRY(auto now, sensor.get(info.name));
        if (now == wanted) break;
        SEAM_OK(sensor.set(info.name, wanted));
        triggered.sensor_ = &sensor;
        triggered.before_ = now;
    }
    return triggered;
}

SoftwareTriggered::SoftwareTriggered(SoftwareTriggered&& other) noexcept
    : sensor_(std::exchange(other.sensor_, nullptr)), before_(other.before_) {}

SoftwareTriggered::~SoftwareTriggered() {
    // A sensor that is gone comes back with its own settings.
    if (sensor_) (void)sensor_->set("trigger", before_);
}

StartedSensors::~StartedSensors() {
    watches_.clear();
    for (ProfileSource* sensor : started_) sensor->stop();
}

Expected<void> StartedSensors::start(ProfileSource& sensor, const std::stop_token& cancel) {
    watches_.emplace_back(cancel, [&sensor] { sensor.give_up(); });
    started_.push_back(&sensor);  // one that did not start is stopped too: it may have got half the way
    return sensor.start();
}

}  // namespace seamwright
