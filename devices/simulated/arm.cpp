#include "devices/simulated/arm.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace seamwright {
namespace {
using Clock = std::chrono::steady_clock;
constexpr auto kArmTick = std::chrono::milliseconds(1);
}  // namespace

// Way s(t) of a trapezoid: from speed v0 up to v, on, and down to v1 at the end.
struct SimulatedArm::Line {
    ArmMove move;
    Pose from;
    double length_mm, v0, v, v1, a;
    double pace;                    // rotation needs longer than the way: everything that much slower
    double t1 = 0, t2 = 0, t3 = 0;  // ends of the three parts, s
    double begin_s;                 // on the arm's clock
    std::size_t next_event = 0;
    bool goes_on;  // into the next move

    Line(ArmMove m, const Pose& start, double entry_speed, bool follows, const ArmSettings& s, double at_s)
        : move(std::move(m)), from(start), begin_s(at_s), goes_on(follows && move.rounding_mm > 0) {
        std::stable_sort(move.events.begin(), move.events.end(), [](const PathEvent& x, const PathEvent& y) {
            return x.before_end_mm > y.before_end_mm;
        });
        length_mm = distance_mm(from, move.base_from_flange);
        a = s.acceleration_mm_s2;
        v = std::max(move.speed_mm_s, 1e-3);
        v0 = std::min(entry_speed, v);
        v1 = goes_on ? v : 0;
        // Too short for the whole trapezoid: a lower top speed, or a lower speed at the end.
        v1 = std::min(v1, std::sqrt(v0 * v0 + 2 * a * length_mm));
        v0 = std::min(v0, std::sqrt(v1 * v1 + 2 * a * length_mm));
        v = std::max({v0, v1, std::min(v, std::sqrt(a * length_mm + (v0 * v0 + v1 * v1) / 2))});
        const double up = (v * v - v0 * v0) / (2 * a), down = (v * v - v1 * v1) / (2 * a);
        t1 = (v - v0) / a;
        t2 = t1 + (v > 0 ? std::max(0.0, length_mm - up - down) / v : 0);
        t3 = t2 + (v - v1) / a;
        const double turn_s = deg_from_rad(angle_rad(from, move.base_from_flange)) / s.rotation_deg_s;
        pace = t3 < turn_s ? t3 / turn_s : 1;
        if (t3 <= 0 && turn_s > 0) t3 = turn_s, pace = 1;  // turns on the spot
    }
    double way_at(double t) const {
        t = std::clamp(t * pace, 0.0, t3);
        if (t < t1) return v0 * t + a * t * t / 2;
        const double up = v0 * t1 + a * t1 * t1 / 2;
        if (t < t2) return up + v * (t - t1);
        return std::min(length_mm, up + v * (t2 - t1) + v * (t - t2) - a * (t - t2) * (t - t2) / 2);
    }
    double speed_at(double t) const {
        t = std::clamp(t * pace, 0.0, t3);
        return pace * (t < t1 ? v0 + a * t : t < t2 ? v : v - a * (t - t2));
    }
    bool ended(double t) const { return t * pace >= t3; }
    double duration() const { return t3 / pace; }
    Pose at_share(double share) const {
        const Eigen::Quaterniond q0(from.linear()), q1(move.base_from_flange.linear());
        return make_pose(
            q0.slerp(share, q1).toRotationMatrix(),
            from.translation() + share * (move.base_from_flange.translation() - from.translation()));
    }
    Pose at_way(double s) const {
        return at_share(length_mm > 0 ? std::clamp(s / length_mm, 0.0, 1.0) : 1.0);
    }
    Pose at_time(double t) const {
        if (length_mm > 0) return at_way(way_at(t));
        return at_share(t3 > 0 ? std::clamp(t * pace / t3, 0.0, 1.0) : 1.0);
    }
    Eigen::Vector3d direction() const {
        if (length_mm <= 0) return Eigen::Vector3d::Zero();
        return (move.base_from_flange.translation() - from.translation()) / length_mm;
    }
};

SimulatedArm::SimulatedArm(std::shared_ptr<SimulatedCell> cell, const ArmSettings& settings,
                           const Pose& start)
    : cell_(std::move(cell)), settings_(settings), here_(start) {
    cell_->follow(start);
    if (!settings_.driven) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

SimulatedArm::~SimulatedArm() = default;

Pose SimulatedArm::position() const {
    const std::lock_guard lock(mutex_);
    return standing_or_here();
}

Pose SimulatedArm::standing_or_here() const {
    const auto cell = !line_ && moves_.empty() ? cell_->reported_flange() : std::nullopt;
    return cell ? *cell : here_;
}

Eigen::Vector3d SimulatedArm::velocity_mm_s() const {
    const std::lock_guard lock(mutex_);
    return velocity_;
}

void SimulatedArm::move(ArmMove move) {
    const std::lock_guard lock(mutex_);
    moves_.push_back(std::move(move));
    changed_.notify_all();
}

std::size_t SimulatedArm::pending() const {
    const std::lock_guard lock(mutex_);
    return moves_.size() + (line_ ? 1 : 0);
}

bool SimulatedArm::wait(std::size_t pending, const std::stop_token& stop) const {
    std::unique_lock lock(mutex_);
    return changed_.wait(lock, stop, [&] { return moves_.size() + (line_ ? 1 : 0) <= pending; });
}

void SimulatedArm::halt() {
    const std::lock_guard lock(mutex_);
    moves_.clear();
    line_.reset();
    ended_s_.reset();
    velocity_.setZero();
    speed_ = 0;
    changed_.notify_all();
}

void SimulatedArm::set_output(int number, bool on) {
    Pose at;
    Eigen::Vector3d velocity;
    {
        const std::lock_guard lock(mutex_);
        const bool was_on = std::exchange(outputs_[number], on);
        if (!on || was_on || number != settings_.trigger_output) return;
        at = here_;
        velocity = velocity_;
    }
    cell_->fire(at, velocity);
}

bool SimulatedArm::output(int number) const {
    const std::lock_guard lock(mutex_);
    const auto it = outputs_.find(number);
    return it != outputs_.end() && it->second;
}

double SimulatedArm::clock_s() const {
    return settings_.driven ? driven_s_ : std::chrono::duration<double>(Clock::now() - begun_).count();
}

void SimulatedArm::advance(double seconds) {
    {
        const std::lock_guard lock(mutex_);
        driven_s_ += seconds;
    }
    while (tick()) {
        const std::lock_guard lock(mutex_);
        if (line_) break;  // under way at this instant
    }
}

void SimulatedArm::place(const Pose& base_from_flange) {
    const std::lock_guard lock(mutex_);
    if (!line_ && moves_.empty()) here_ = base_from_flange;
}

bool SimulatedArm::tick() {
    std::vector<std::pair<PathEvent, Pose>> due;
    bool ended = false;
    {
        const std::lock_guard lock(mutex_);
        if (!line_ && moves_.empty()) {
            velocity_.setZero();
            speed_ = 0;
            ended_s_.reset();
            return false;
        }
        const double now = clock_s();
        if (!line_) {
            if (speed_ == 0)
                if (const auto jogged = cell_->reported_flange()) here_ = *jogged;
            ArmMove next = std::move(moves_.front());
            moves_.pop_front();
            line_ = std::make_unique<Line>(std::move(next), here_, speed_, !moves_.empty(), settings_,
                                           ended_s_.value_or(now));
        }
        // The next move came only while this one was under way: it need not stop any more.
        if (line_->move.rounding_mm > 0 && !line_->goes_on && !moves_.empty() &&
            !line_->ended((now - line_->begin_s) * settings_.time_scale)) {
            const double t = (now - line_->begin_s) * settings_.time_scale, speed = line_->speed_at(t);
            const Pose from = line_->at_time(t);
            ArmMove rest = std::move(line_->move);
            rest.events.erase(rest.events.begin(),
                              rest.events.begin() + static_cast<std::ptrdiff_t>(line_->next_event));
            line_ = std::make_unique<Line>(std::move(rest), from, speed, true, settings_, now);
        }
        Line& line = *line_;
        const double t = (now - line.begin_s) * settings_.time_scale;
        ended = line.ended(t);
        const double way = ended ? line.length_mm : line.way_at(t);
        here_ = ended ? line.move.base_from_flange : line.at_time(t);
        velocity_ = line.direction() * line.speed_at(t);
        while (line.next_event < line.move.events.size()) {
            const PathEvent& event = line.move.events[line.next_event];
            const double place = std::max(0.0, line.length_mm - event.before_end_mm);
            if (!ended && way < place) break;
            due.emplace_back(event, line.at_way(place));
            ++line.next_event;
        }
    }
    cell_->follow(position());
    for (auto& [event, at] : due) {
        const Pose now = position();
        {
            // What the event asks, an output among it, happens at its place and not a tick later.
            const std::lock_guard lock(mutex_);
            here_ = at;
        }
        event.act(at);
        const std::lock_guard lock(mutex_);
        here_ = now;
    }
    if (ended) {  // after its events, so that who waits for the end finds them done
        const std::lock_guard lock(mutex_);
        // It stands, where the scatter of an arrival has put it.
        if (line_ && line_->v1 == 0) cell_->move_to(line_->move.base_from_flange);
        if (line_) {
            speed_ = line_->pace < 1 ? 0 : line_->v1;
            ended_s_ = line_->begin_s + line_->duration() / settings_.time_scale;
        }
        line_.reset();
        changed_.notify_all();
    }
    return true;
}

void SimulatedArm::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        if (tick()) {
            std::this_thread::sleep_for(kArmTick);
            continue;
        }
        std::unique_lock lock(mutex_);
        changed_.wait(lock, stop, [&] { return !moves_.empty(); });
    }
}

}  // namespace seamwright
