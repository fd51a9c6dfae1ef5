#include "devices/controllers/abb/rapid/rapid_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/controllers/abb/rapid/rapid_system.h"
#include "devices/controllers/abb/rapid/rapid_values.h"

namespace seamwright::rapid {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::milliseconds;

constexpr int kInstructionMicroseconds = 30, kNoOfRetry = 4, kDeepestCall = 100;
constexpr std::size_t kMostMessages = 200;

struct StopTask {};    // the controller is switched off
struct StandStill {};  // Stop, EXIT or an error that nothing treats
struct NewCycle {};    // ExitCycle

}  // namespace

struct Task::Frame {
    const Routine& routine;
    std::vector<Slot> slots;
    Value result;
    bool in_handler = false;
    int retries = 0;
};

bool Call::has(std::string_view name) const {
    for (std::size_t i = 0; i < routine_.parameters.size(); ++i)
        if (routine_.parameters[i].name == name) return slots_[i].present;
    return false;
}

Slot& Call::at(std::string_view name) const {
    for (std::size_t i = 0; i < routine_.parameters.size(); ++i)
        if (routine_.parameters[i].name == name) return slots_[i];
    throw RuntimeError{0, fmt::format("{} has no argument {}", routine_.shown, name), nullptr, false};
}

Task::Task(Machine& machine, TaskProgram program, std::string entry, bool moves)
    : machine_(machine), program_(std::move(program)), entry_(folded(std::move(entry))), moves_(moves) {}

Task::~Task() = default;

void Task::start() {
    running_ = true;
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void Task::run(const std::stop_token& stop) {
    const std::lock_guard lock(machine_.mutex());
    stop_ = stop;
    const Routine* entry = program_.routines.at(entry_);
    try {
        for (;;) {
            try {
                step();
                call(*entry, {}, nullptr);
            } catch (const NewCycle&) {
                depth_ = 0;
            }
        }
    } catch (const StopTask&) {
    } catch (const StandStill&) {
    } catch (const RuntimeError& e) {
        machine_.log(fmt::format("{}: {} (error {}); the task stands", program_.name, e.what, e.number));
    }
    running_ = false;
}

void Task::step() {
    if (stop_.stop_requested()) throw StopTask{};
    // Some instructions at once, then the other tasks' turn: never the same number.
    random_ ^= random_ << 13, random_ ^= random_ >> 7, random_ ^= random_ << 17;
    debt_us_ += kInstructionMicroseconds;
    if (debt_us_ >= 100 + static_cast<int>(random_ % 1000)) {
        unlocked([&] { std::this_thread::sleep_for(std::chrono::microseconds(debt_us_)); });
        debt_us_ = 0;
    }
    while (moves_ && !machine_.may_move()) {
        if (stop_.stop_requested()) throw StopTask{};
        unlocked([&] { std::this_thread::sleep_for(Milliseconds(2)); });
    }
    serve_interrupts();
}

void Task::serve_interrupts() {
    if (in_trap_) return;
    for (;;) {
        int number = 0;
        {
            const std::lock_guard lock(interrupts_mutex_);
            if (interrupts_.empty() || interrupts_.front().first > Clock::now()) return;
            number = interrupts_.front().second;
            interrupts_.pop_front();
        }
        const auto trap = traps_.find(number);
        if (trap == traps_.end()) continue;
        in_trap_ = true;
        call(*trap->second, {}, nullptr);
        in_trap_ = false;
    }
}

void Task::interrupt(int number) {
    const std::lock_guard lock(interrupts_mutex_);
    // 2 to 30 ms after the path's point, as a task that has other things to do takes it.
    const auto late =
        Milliseconds(2 + (number * 7919 + static_cast<int>(interrupts_.size()) * 13 +
                          static_cast<int>(Clock::now().time_since_epoch().count() / 1000 % 29)) %
                             29);
    interrupts_.emplace_back(Clock::now() + late, number);
}

int Task::connect(const Routine* trap) {
    traps_[next_interrupt_] = trap;
    return next_interrupt_++;
}

void Task::stop_here(const std::string& why) {
    machine_.log(fmt::format("{}: {}", program_.name, why));
    throw StandStill{};
}

bool Task::wait_until(const std::function<bool()>& done, std::chrono::duration<double> at_most,
                      std::chrono::duration<double> poll) {
    const auto begin = Clock::now();
    for (;;) {
        if (stop_.stop_requested()) throw StopTask{};
        serve_interrupts();
        if ((!moves_ || machine_.may_move()) && done()) return true;
        const std::chrono::duration<double> left = at_most - (Clock::now() - begin);
        if (left.count() <= 0) return false;
        const auto slice = std::min({left, poll, std::chrono::duration<double>(0.002)});
        unlocked([&] { std::this_thread::sleep_for(slice); });
    }
}

void Task::pause(double seconds) {
    wait_until([] { return false; }, std::chrono::duration<double>(seconds),
               std::chrono::duration<double>(seconds));
}

void Task::call(const Routine& routine, std::vector<Slot> slots, Value* result) {
    if (++depth_ > kDeepestCall) throw RuntimeError{0, "the calls are nested too deeply", nullptr, false};
    struct Leave {
        int& depth;
        ~Leave() { --depth; }
    } leave{depth_};
    Frame frame{routine, std::move(slots), {}};
    frame.slots.resize(static_cast<std::size_t>(routine.slots));
    for (const auto& d : routine.data) frame.slots[static_cast<std::size_t>(d->slot)].own = *d->value;
    const Flow flow = block(routine.body, frame);
    if (routine.kind != Routine::Kind::function) return;
    if (flow != Flow::give_back)
        throw RuntimeError{0, fmt::format("the function {} ends without RETURN", routine.shown), nullptr,
                           false};
    *result = std::move(frame.result);
}

Value Task::call_with(const Routine& routine, const std::vector<Argument>& arguments, Frame* frame) {
    std::vector<Slot> slots(std::max(routine.parameters.size(), static_cast<std::size_t>(routine.slots)));
    for (std::size_t i = 0; i < routine.parameters.size(); ++i) slots[i].present = false;
    if (routine.name == "present") {
        Value yes = make_value(routine.type);
        yes.number = frame->slots[static_cast<std::size_t>(arguments[0].value->slot)].present ? 1 : 0;
        return yes;
    }
    for (const Argument& a : arguments) {
        Slot& slot = slots[a.parameter];
        const Parameter& p = routine.parameters[a.parameter];
        slot.present = true;
        if (!a.value) continue;
        if (p.mode == Parameter::Mode::in) {
            slot.own = eval(*a.value, frame);
            if (p.type->root()->kind != Type::Kind::any) slot.own.type = p.type;
        } else {
            slot.ref = reference(*a.value, frame);
        }
    }
    Value result;
    try {
        if (routine.native >= 0) return machine_.native(routine.native)(*this, Call(routine, slots));
        call(routine, std::move(slots), &result);
    } catch (RuntimeError& e) {
        e.leaving = nullptr;  // now it is the caller's
        throw;
    } catch (const std::runtime_error& e) {
        throw RuntimeError{0, e.what(), nullptr, false};
    }
    return result;
}

Task::Flow Task::block(const Block& b, Frame& frame) {
    for (const auto& s : b)
        if (const Flow flow = guarded(*s, frame); flow != Flow::next) return flow;
    return Flow::next;
}

// One statement with the routine's error handler behind it.
Task::Flow Task::guarded(const Statement& s, Frame& frame) {
    for (;;) {
        RuntimeError error;
        try {
            step();
            return statement(s, frame);
        } catch (RuntimeError& e) {
            if (e.leaving == &frame) throw;
            error = e;
        } catch (const std::runtime_error& e) {
            error.what = e.what();
        }
        if (!std::exchange(error.placed, true))
            error.what = fmt::format("{}, line {}: {}", s.at.file, s.at.line, error.what);
        error.leaving = &frame;
        if (frame.in_handler || !frame.routine.has_handler || error.number == 0) {
            error.number =
                frame.routine.has_handler && !frame.in_handler ? error.number : 0;  // the system's handler
            throw error;
        }
        errno_ = error.number;
        frame.in_handler = true;
        const Flow flow = block(frame.routine.handler, frame);
        frame.in_handler = false;
        if (flow == Flow::next) {
            error.number = 0;
            error.what += "; its error handler ends without treating it";
            throw error;
        }
        if (flow != Flow::retry) return flow == Flow::trynext ? Flow::next : flow;
        if (++frame.retries > kNoOfRetry) {
            error.number = kErrExcrtymax;
            error.what += "; tried too often";
            throw error;
        }
    }
}

Task::Flow Task::statement(const Statement& s, Frame& frame) {
    using K = Statement::Kind;
    switch (s.kind) {
        case K::assign: {
            const Value v = eval(*s.value, &frame);
            store(*reference(*s.target, &frame), v);
            return Flow::next;
        }
        case K::call:
            if (s.name == "exitcycle") throw NewCycle{};
            if (s.name == "waituntil") {
                wait_for_condition(s, frame);
                return Flow::next;
            }
            (void)call_with(*s.routine, s.arguments, &frame);
            return Flow::next;
        case K::branch:
            for (const auto& [condition, inner] : s.branches)
                if (eval(*condition, &frame).number != 0) return block(inner, frame);
            return block(s.otherwise, frame);
        case K::loop_while:
            while (eval(*s.branches[0].first, &frame).number != 0) {
                step();
                if (const Flow flow = block(s.branches[0].second, frame); flow != Flow::next) return flow;
            }
            return Flow::next;
        case K::loop_for:
            return loop_for(s, frame);
        case K::test: {
            const Value v = eval(*s.value, &frame);
            for (const auto& [values, inner] : s.cases)
                for (const auto& value : values)
                    if (same_value(eval(*value, &frame), v)) return block(inner, frame);
            return block(s.otherwise, frame);
        }
        case K::give_back:
            if (s.value) {
                frame.result = eval(*s.value, &frame);
                frame.result.type = frame.routine.type;
            }
            return Flow::give_back;
        case K::raise: {
            RuntimeError e{errno_, "an error is raised", nullptr, false};
            if (s.value) e.number = static_cast<int>(eval(*s.value, &frame).number);
            if (frame.in_handler) {
                e.leaving = &frame;
                // In the handler of a trap or of a task's entry there is nobody to raise it to.
                if (frame.routine.kind == Routine::Kind::trap || depth_ == 1) e.number = 0;
            }
            throw e;
        }
        case K::retry:
            return Flow::retry;
        case K::trynext:
            return Flow::trynext;
        case K::exit:
            stop_here("EXIT");
            break;
        case K::connect: {
            Value& number = *reference(*s.target, &frame);
            if (is_connected(static_cast<int>(number.number)))
                raise(kErrAlrdycnt, "the interrupt is connected already");
            number.number = connect(s.routine);
            return Flow::next;
        }
    }
    return Flow::next;
}

// The condition is computed anew at every poll.
void Task::wait_for_condition(const Statement& s, Frame& frame) {
    const Expr *condition = nullptr, *flag = nullptr;
    double at_most = 1e9, poll = 0.1;
    for (const Argument& a : s.arguments) {
        const std::string& name = s.routine->parameters[a.parameter].name;
        if (name == "cond") condition = a.value.get();
        if (name == "timeflag") flag = a.value.get();
        if (name == "maxtime") at_most = eval(*a.value, &frame).number;
        if (name == "pollrate") poll = eval(*a.value, &frame).number;
    }
    const bool came = wait_until([&] { return eval(*condition, &frame).number != 0; },
                                 std::chrono::duration<double>(at_most), std::chrono::duration<double>(poll));
    if (flag) reference(*flag, &frame)->number = came ? 0 : 1;
    if (!came && !flag) raise(kErrWaitMaxtime, "the condition did not come in time");
}

// Without STEP the loop counts down where it begins above its end, as a controller does.
Task::Flow Task::loop_for(const Statement& s, Frame& frame) {
    const double from = eval(*s.value, &frame).number, to = eval(*s.until, &frame).number;
    const double step_by = s.step ? eval(*s.step, &frame).number : from > to ? -1 : 1;
    if (step_by == 0) throw RuntimeError{0, "a loop with STEP 0", nullptr, false};
    Slot& slot = frame.slots[static_cast<std::size_t>(s.slot)];
    slot.own = make_value(s.value->type->root());
    for (double i = from; step_by > 0 ? i <= to : i >= to; i = as_num(i + step_by)) {
        frame.slots[static_cast<std::size_t>(s.slot)].own.number = i;
        step();
        if (const Flow flow = block(s.otherwise, frame); flow != Flow::next) return flow;
    }
    return Flow::next;
}

Value* Task::reference(const Expr& e, Frame* frame) {
    switch (e.kind) {
        case Expr::Kind::name: {
            if (!e.data) {
                Slot& slot = frame->slots[static_cast<std::size_t>(e.slot)];
                if (!slot.present)
                    throw RuntimeError{0, "the optional argument " + e.text + " is not there", nullptr,
                                       false};
                return &slot.value();
            }
            return e.data->value.get();
        }
        case Expr::Kind::component:
            return &reference(*e.parts[0], frame)->parts[e.field];
        case Expr::Kind::index: {
            std::size_t at = 0;
            std::vector<int> indices;
            for (std::size_t i = 1; i < e.parts.size(); ++i) {
                const double n = eval(*e.parts[i], frame).number;
                if (n != std::floor(n)) throw RuntimeError{0, "an index is no whole number", nullptr, false};
                indices.push_back(static_cast<int>(n));
            }
            Value& array = *reference(*e.parts[0], frame);
            for (std::size_t i = 0; i < indices.size(); ++i) {
                if (indices[i] < 1 || indices[i] > array.dims[i])
                    throw RuntimeError{
                        0, fmt::format("the index {} is not within 1 and {}", indices[i], array.dims[i]),
                        nullptr, false};
                at = at * static_cast<std::size_t>(array.dims[i]) + static_cast<std::size_t>(indices[i] - 1);
            }
            return &array.parts[at];
        }
        default:
            throw RuntimeError{0, "this is no data", nullptr, false};
    }
}

Value Task::eval(const Expr& e, Frame* frame) {
    switch (e.kind) {
        case Expr::Kind::number:
        case Expr::Kind::truth: {
            Value v = make_value(e.type);
            v.number = e.type->root()->kind == Type::Kind::number ? as_num(e.number) : e.number;
            return v;
        }
        case Expr::Kind::text: {
            Value v = make_value(e.type);
            v.text = e.text;
            return v;
        }
        case Expr::Kind::aggregate: {
            Value v = make_value(e.type, e.dims);
            if (e.dims.size() > 1)
                throw RuntimeError{0, "an aggregate of several dimensions", nullptr, false};
            for (std::size_t i = 0; i < e.parts.size(); ++i) store(v.parts[i], eval(*e.parts[i], frame));
            return v;
        }
        case Expr::Kind::name:
            if (e.data && e.data->name == "errno") {
                Value v = make_value(e.type);
                v.number = errno_;
                return v;
            }
            return *reference(e, frame);
        case Expr::Kind::index:
            return *reference(e, frame);
        case Expr::Kind::component:
            if (e.parts[0]->kind == Expr::Kind::call) return eval(*e.parts[0], frame).parts[e.field];
            return *reference(e, frame);
        case Expr::Kind::call:
            return call_with(*e.routine, e.arguments, frame);
        case Expr::Kind::unary:
            return apply_unary(e.text, eval(*e.parts[0], frame));
        case Expr::Kind::binary: {
            const Value a = eval(*e.parts[0], frame);
            const Value b = eval(*e.parts[1], frame);  // both, always: programs must not lean on a shortcut
            return apply_binary(e.text, a, b);
        }
    }
    return {};
}

Machine::Machine(InstructionSet set, std::map<std::string, Native> natives, MayMove may_move)
    : set_(std::move(set)), may_move_(std::move(may_move)) {
    natives_.resize(set_.routines.size());
    for (const auto& [name, routine] : set_.routines) {
        const auto it = natives.find(name);
        natives_[static_cast<std::size_t>(routine->native)] =
            it != natives.end() ? it->second : [shown = routine->shown](Task&, const Call&) -> Value {
            throw RuntimeError{0, shown + " is loaded but not executed here", nullptr, false};
        };
    }
}

Machine::~Machine() {
    stop();
}

Task& Machine::add(const std::string& name, const std::vector<SourceText>& sources, const std::string& entry,
                   bool moves) {
    TaskProgram program = link_task(name, sources, set_, shared_);
    const auto it = program.routines.find(folded(entry));
    if (it == program.routines.end() || it->second->kind != Routine::Kind::procedure ||
        !it->second->parameters.empty())
        throw LoadError({name, 0}, fmt::format("the task has no entry {}", entry));
    tasks_.push_back(std::make_unique<Task>(*this, std::move(program), entry, moves));
    return *tasks_.back();
}

void Machine::start() {
    for (auto& t : tasks_) t->start();
}

void Machine::stop() {
    for (auto& t : tasks_) t->ask_to_stop();
    for (auto& t : tasks_)
        if (t->thread_.joinable()) t->thread_.join();
}

Task* Machine::task(const std::string& name) {
    for (auto& t : tasks_)
        if (folded(t->name()) == name) return t.get();
    return nullptr;
}

Value* Machine::find(const std::string& task_name, const std::string& name) {
    Task* t = task(folded(task_name));
    if (!t) return nullptr;
    const Data* data = t->program_.find(name);
    return data && data->value ? data->value.get() : nullptr;
}

void Machine::log(std::string message) {
    const std::lock_guard lock(log_mutex_);
    if (messages_.size() < kMostMessages) messages_.push_back(std::move(message));
}

std::vector<std::string> Machine::messages() const {
    const std::lock_guard lock(log_mutex_);
    return messages_;
}

}  // namespace seamwright::rapid
