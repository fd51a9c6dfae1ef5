#include "devices/controllers/kuka/robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "devices/controllers/kuka/krl/arguments.h"

namespace seamwright::krl {
namespace {

constexpr double kT1MmS = 250, kPtpMmS = 500;
constexpr std::size_t kMostMessages = 200;

Value structure(const std::string& component, std::optional<double> value) {
    Value v = Value::unset(Type::frame);
    v.set = true;
    v.parts[component] = value;
    return v;
}

const char* name_of(ProgramState state) {
    switch (state) {
        case ProgramState::free:
            return "P_FREE";
        case ProgramState::active:
            return "P_ACTIVE";
        case ProgramState::stopped:
            return "P_STOP";
        case ProgramState::ended:
            return "P_END";
    }
    return "P_FREE";
}

// Reading or writing these in the robot's program stops the advance run.
bool belongs_to_main_run(const std::string& name) {
    static const std::set<std::string> names = {"$POS_ACT", "$AXIS_ACT", "$TIMER", "$TIMER_STOP",
                                                "$FLAG",    "$OUT",      "$IN",    "$STOPMESS",
                                                "$BASE_C",  "$TOOL_C"};
    return names.count(name) > 0;
}

Value frame_or_unset(const std::optional<Pose>& pose, const std::string& name) {
    if (!pose) throw KrlError(fmt::format("{} is not initialised", name));
    return Value::of(*pose, Type::frame);
}

}  // namespace

KukaRobot::KukaRobot(std::shared_ptr<SimulatedCell> cell, RobotSettings settings, const Pose& start,
                     int trigger_output)
    : cell_(std::move(cell)),
      settings_(std::move(settings)),
      planned_(start),
      arm_(cell_, {.time_scale = settings_.time_scale, .trigger_output = trigger_output}, start) {}

KukaRobot::~KukaRobot() {
    arm_.halt();
}

void KukaRobot::select(const std::string& program) {
    const std::lock_guard lock(mutex_);
    program_ = program;
    at_block_ = false;
    halted_ = false;
}

std::vector<std::string> KukaRobot::messages() const {
    const std::lock_guard lock(mutex_);
    return messages_;
}

void KukaRobot::told(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (messages_.size() < kMostMessages) messages_.push_back(message);
}

void KukaRobot::tick() {
    std::vector<Pulse> over;
    {
        const std::lock_guard lock(mutex_);
        const auto now = Clock::now();
        for (const Pulse& p : pulses_)
            if (p.until <= now) over.push_back(p);
        std::erase_if(pulses_, [&](const Pulse& p) { return p.until <= now; });
        for (const Pulse& p : over) outputs_[p.output] = p.level;
    }
    for (const Pulse& p : over) arm_.set_output(p.output, p.level);
}

Value KukaRobot::flag(int number) const {
    const std::lock_guard lock(mutex_);
    const auto it = flags_.find(number);
    return Value::boolean(it != flags_.end() && it->second);
}

std::optional<Value> KukaRobot::system_value(Task& task, const Place& place) {
    const std::string& name = place.system;
    if (task.stops_advance() && belongs_to_main_run(name)) wait_main_run(task);
    if (name == "$NULLFRAME") return Value::of(Pose::Identity(), Type::frame);
    if (name == "$FLAG") return flag(index_of(place, 1024));
    if (name == "$IN") {
        (void)index_of(place, 8192);
        return Value::boolean(false);
    }
    const RobotMode mode = cell_->mode();
    const bool stopped = mode == RobotMode::stopped || mode == RobotMode::fault;
    if (name == "$STOPMESS") return Value::boolean(stopped);
    if (name == "$PERI_RDY") return Value::boolean(!stopped);
    if (name == "$MODE_OP")
        return Value::name(mode == RobotMode::manual_reduced ? "T1"
                           : mode == RobotMode::manual_full  ? "T2"
                           : mode == RobotMode::external     ? "EX"
                                                             : "AUT");
    if (name == "$PRO_STATE1") return Value::name(name_of(state_));
    if (name == "$KR_SERIALNO") return Value::integer(settings_.serial);
    if (name == "$TRAFONAME") return Value::string_of("#KR SIMULATED");
    if (name == "$AXIS_ACT") {
        Value v = Value::unset(Type::e6axis);
        v.set = true;
        for (const std::string& axis : components(Type::e6axis)) v.parts[axis] = 0.0;
        return v;
    }
    const Pose flange = name == "$POS_ACT" ? arm_.position() : Pose::Identity();
    const std::lock_guard lock(mutex_);
    if (name == "$POS_ACT") {
        if (!main_.base || !main_.tool)
            throw KrlError("$POS_ACT is not initialised: no $TOOL or $BASE was ever active");
        Value v = Value::of(main_.base->inverse() * flange * *main_.tool, Type::e6pos);
        v.parts["S"] = 2;
        v.parts["T"] = 10;
        return v;
    }
    if (name == "$BASE") return frame_or_unset(advance_.base, name);
    if (name == "$TOOL") return frame_or_unset(advance_.tool, name);
    if (name == "$IPO_MODE") return Value::name(advance_.fixed_tool ? "TCP" : "BASE");
    if (name == "$IPO_MODE_C") return Value::name(main_.fixed_tool ? "TCP" : "BASE");
    if (name == "$BASE_C") return frame_or_unset(main_.base, name);
    if (name == "$TOOL_C") return frame_or_unset(main_.tool, name);
    if (name == "$VEL") return structure("CP", velocity_m_s_);
    if (name == "$APO") return structure("CDIS", cdis_mm_);
    if (name == "$ADVANCE") return Value::integer(advance_moves_);
    if (name == "$PRO_NAME1") return Value::string_of(program_);
    if (name == "$OUT") {
        const auto it = outputs_.find(index_of(place, 8192));
        return Value::boolean(it != outputs_.end() && it->second);
    }
    if (name == "$TIMER" || name == "$TIMER_STOP") {
        const Timer& t = timers_[index_of(place, 64)];
        if (name == "$TIMER_STOP") return Value::boolean(t.stopped);
        const double run =
            t.stopped ? 0 : std::chrono::duration<double, std::milli>(Clock::now() - t.since).count();
        return Value::integer(std::round(t.value_ms + run));
    }
    return std::nullopt;
}

bool KukaRobot::set_system(Task& task, const Place& place, const Value& value) {
    const std::string& name = place.system;
    if (task.kind() == TaskKind::robot && belongs_to_main_run(name)) wait_main_run(task);
    if (name == "$OUT") {
        const int number = index_of(place, 4096);
        const bool on = value.truth();
        {
            const std::lock_guard lock(mutex_);
            outputs_[number] = on;
        }
        arm_.set_output(number, on);
        return true;
    }
    const std::lock_guard lock(mutex_);
    if (name == "$FLAG") {
        flags_[index_of(place, 1024)] = value.truth();
        return true;
    }
    if (name == "$TIMER") {
        Timer& t = timers_[index_of(place, 64)];
        t.value_ms = converted(value, Type::integer).number;
        t.since = Clock::now();
        return true;
    }
    if (name == "$TIMER_STOP") {
        Timer& t = timers_[index_of(place, 64)];
        const bool stop = value.truth();
        if (stop && !t.stopped)
            t.value_ms += std::chrono::duration<double, std::milli>(Clock::now() - t.since).count();
        t.since = Clock::now();
        t.stopped = stop;
        return true;
    }
    // What plans motions belongs to the robot's interpreter.
    if (task.kind() == TaskKind::submit) return false;
    if (name == "$BASE" || name == "$TOOL") {
        if (!place.component.empty()) return false;
        (name == "$BASE" ? advance_.base : advance_.tool) = value.pose();
        return true;
    }
    if (name == "$IPO_MODE") {
        if (value.type != Type::enumeration || (value.text != "BASE" && value.text != "TCP"))
            throw KrlError("$IPO_MODE is #BASE or #TCP");
        advance_.fixed_tool = value.text == "TCP";
        return true;
    }
    if (name == "$VEL" && place.component == "CP") {
        const double v = value.as_number();
        if (!(v > 0 && v <= 3)) throw KrlError(fmt::format("$VEL.CP={} m/s is not possible", v));
        velocity_m_s_ = v;
        return true;
    }
    if (name == "$APO" && place.component == "CDIS") {
        const double v = value.as_number();
        if (v < 0) throw KrlError("$APO.CDIS is negative");
        cdis_mm_ = v;
        return true;
    }
    if (name == "$ADVANCE") {
        const double n = converted(value, Type::integer).number;
        if (n < 0 || n > 5) throw KrlError("$ADVANCE is 0 to 5");
        advance_moves_ = static_cast<int>(n);
        return true;
    }
    return false;
}

void KukaRobot::move(Task& task, Motion motion, const Value& target, bool approximates,
                     std::vector<PathTrigger> triggers) {
    ArmMove move;
    int ahead = 3;
    {
        const std::lock_guard lock(mutex_);
        if (motion != Motion::ptp && !at_block_)
            throw KrlError("the first motion of a selected program is a PTP (block coincidence)");
        if (at_block_ && !cell_->reported_flange()) throw KrlError("the robot's position is not known");
        if (!advance_.base || !advance_.tool) throw KrlError("$BASE or $TOOL is not initialised");
        if (motion != Motion::ptp && !velocity_m_s_) throw KrlError("$VEL.CP is not initialised");
        if (!at_block_) planned_ = arm_.position();
        const Frames now = advance_;
        if (now.fixed_tool && target.type != Type::e6axis)
            throw KrlError("with a fixed tool ($IPO_MODE=#TCP) only axis angles are known here");
        if (target.type == Type::e6axis) {
            if (motion != Motion::ptp) throw KrlError("a LIN goes to a position, not to axis angles");
            move.base_from_flange = planned_;  // the only angles there are: $AXIS_ACT
        } else if (motion == Motion::lin_rel) {
            Pose at = now.base->inverse() * planned_ * *now.tool;
            for (int i = 0; i < 3; ++i)
                if (const auto it = target.parts.find(components(Type::frame)[static_cast<std::size_t>(i)]);
                    it != target.parts.end() && it->second)
                    at.translation()[i] += *it->second;
            for (const char* turn : {"A", "B", "C"})
                if (target.parts.count(turn) > 0) throw KrlError("LIN_REL that turns is not known here");
            move.base_from_flange = *now.base * at * now.tool->inverse();
        } else {
            if (motion == Motion::ptp && target.type == Type::frame)
                throw KrlError("PTP wants Status and Turn, a POS or E6POS");
            move.base_from_flange = *now.base * target.pose() * now.tool->inverse();
        }
        move.speed_mm_s = motion == Motion::ptp ? kPtpMmS : *velocity_m_s_ * 1000;
        if (cell_->mode() == RobotMode::manual_reduced) move.speed_mm_s = std::min(move.speed_mm_s, kT1MmS);
        move.rounding_mm = approximates ? cdis_mm_ : 0;
        planned_ = move.base_from_flange;
        at_block_ = true;
        ahead = advance_moves_;
        // The main run reaches this motion.
        move.events.push_back({1e9, [this, now](const Pose&) {
                                   const std::lock_guard inner(mutex_);
                                   main_ = now;
                               }});
    }
    for (PathTrigger& t : triggers)
        move.events.push_back({t.before_end_mm, [act = std::move(t.act)](const Pose&) { act(); }});
    arm_.move(std::move(move));
    task.unlocked([&] { arm_.wait(static_cast<std::size_t>(ahead), task.stop()); });
}

void KukaRobot::pulse(Task&, const Place& output, bool level, double seconds) {
    if (output.system != "$OUT") throw KrlError("PULSE wants an output");
    if (!(seconds >= 0.012 && seconds <= 3)) throw KrlError("PULSE lasts 0.012 to 3 s");
    const int number = index_of(output, 4096);
    tick();  // one that is over has its edge before this one's
    {
        const std::lock_guard lock(mutex_);
        outputs_[number] = level;
        pulses_.push_back(
            {number, !level,
             Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(seconds / settings_.time_scale))});
    }
    arm_.set_output(number, level);
}

void KukaRobot::wait_main_run(Task& task) {
    if (task.kind() != TaskKind::robot) return;
    task.unlocked([&] { arm_.wait(0, task.stop()); });
}

void KukaRobot::wait_seconds(Task& task, double seconds) {
    // The robot's own waits are part of its pace; the submit interpreter's are not.
    const double real = task.kind() == TaskKind::robot ? seconds / settings_.time_scale : seconds;
    const auto until =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(real));
    task.unlocked([&] {
        while (!task.stop().stop_requested() && Clock::now() < until)
            std::this_thread::sleep_for(
                std::min<Clock::duration>(std::chrono::milliseconds(5), until - Clock::now()));
    });
}

void KukaRobot::halt(Task& task) {
    halted_ = true;
    state_ = ProgramState::stopped;
    task.unlocked([&] {
        while (halted_ && !task.stop().stop_requested())
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    });
    state_ = ProgramState::active;
}

}  // namespace seamwright::krl
