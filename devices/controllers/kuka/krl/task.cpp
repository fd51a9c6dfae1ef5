// A task's statements.

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "devices/controllers/kuka/krl/machine.h"

namespace seamwright::krl {
namespace {

struct TaskStopped {};
constexpr auto kTaskTick = std::chrono::milliseconds(2);
constexpr auto kSubmitCycle = std::chrono::milliseconds(4);

}  // namespace

Task::Task(Machine& machine, Host& host, TaskKind kind, std::stop_token stop)
    : machine_(machine), host_(host), kind_(kind), stop_(std::move(stop)), lock_(machine.mutex()) {}

TaskEnd Task::run(const std::string& program, std::string& failure) {
    try {
        const auto routine = machine_.routine(program, program);
        if (!routine) throw KrlError(fmt::format("there is no program {}", program));
        std::vector<Argument> none;
        (void)invoke(*routine, none);
        if (kind_ == TaskKind::robot) host_.wait_main_run(*this);
        return TaskEnd::finished;
    } catch (const TaskStopped&) {
        return TaskEnd::stopped;
    } catch (const KrlError& e) {
        failure = e.what();
        return TaskEnd::failed;
    }
}

void Task::unlocked(const std::function<void()>& wait) {
    lock_.unlock();
    wait();
    lock_.lock();
    if (stop_.stop_requested()) throw TaskStopped{};
}

void Task::wait(const std::function<bool()>& over) {
    while (!over()) {
        unlocked([] { std::this_thread::sleep_for(kTaskTick); });
        interrupts();
    }
}

void Task::fail(const Statement& s, const std::string& why) const {
    const std::string where = stack_.empty() ? "" : stack_.back().routine->module + " ";
    throw KrlError(fmt::format("{}line {}: {}", where, s.line, why));
}

Task::Flow Task::execute(const Block& block) {
    for (const Statement& s : block) {
        if (stop_.stop_requested()) throw TaskStopped{};
        Flow flow = Flow::next;
        try {
            flow = execute(s);
        } catch (const Resumed& resumed) {
            if (resumed.level != stack_.size()) throw;
        } catch (const KrlError& e) {
            const std::string what = e.what();
            if (what.find(" line ") != std::string::npos) throw;  // told where it happened
            fail(s, what);
        }
        if (flow != Flow::next) return flow;
        unlocked([] {});  // another interpreter may run between two statements
        interrupts();
    }
    return Flow::next;
}

bool Task::condition(const ExpressionPtr& e) {
    return evaluate(*e).truth();
}

Task::Flow Task::execute(const Statement& s) {
    using Kind = Statement::Kind;
    switch (s.kind) {
        case Kind::if_:
            if (condition(s.value)) return execute(s.blocks[0]);
            return s.blocks.size() > 1 ? execute(s.blocks[1]) : Flow::next;
        case Kind::for_:
        case Kind::while_:
        case Kind::repeat:
        case Kind::loop:
            return loop(s);
        case Kind::exit:
            return Flow::exit;
        case Kind::switch_: {
            const Value key = evaluate(*s.value);
            for (std::size_t i = 0; i < s.cases.size(); ++i) {
                bool hit = s.cases[i].empty();  // DEFAULT
                for (const ExpressionPtr& c : s.cases[i]) {
                    const Value v = evaluate(*c);
                    if (v.type != key.type) throw KrlError("CASE is of another type than SWITCH");
                    hit = hit || (v.type == Type::enumeration ? v.text == key.text
                                                              : v.as_number() == key.as_number());
                }
                if (hit) return execute(s.blocks[i]);
            }
            return Flow::next;
        }
        case Kind::return_:
            returned_ = s.value ? evaluate(*s.value) : Value();
            return Flow::returned;
        default:
            simple(s);
            return Flow::next;
    }
}

Task::Flow Task::loop(const Statement& s) {
    using Kind = Statement::Kind;
    Place counter;
    double last = 0;
    if (s.kind == Kind::for_) {
        counter = place(*s.target);
        write(counter, evaluate(*s.value));
        last = evaluate(*s.second).as_number();
    }
    for (;;) {
        if (s.kind == Kind::while_ && !condition(s.value)) return Flow::next;
        if (s.kind == Kind::for_ && read(counter).as_number() > last) return Flow::next;
        const Flow flow = execute(s.blocks[0]);
        if (flow == Flow::returned) return flow;
        if (flow == Flow::exit) return Flow::next;
        if (s.kind == Kind::repeat && condition(s.value)) return Flow::next;
        if (s.kind == Kind::for_) write(counter, Value::integer(read(counter).as_number() + 1));
        // The submit interpreter shares its time with the robot's; the robot's loops wait by themselves.
        if (s.kind == Kind::loop)
            unlocked(
                [&] { std::this_thread::sleep_for(kind_ == TaskKind::submit ? kSubmitCycle : kTaskTick); });
        else
            unlocked([] {});
    }
}

void Task::simple(const Statement& s) {
    using Kind = Statement::Kind;
    if (kind_ == TaskKind::trigger && s.kind != Kind::assign && s.kind != Kind::call && s.kind != Kind::pulse)
        throw KrlError("neither waits nor motions in a program that TRIGGER calls");
    const bool moves = s.kind == Kind::lin || s.kind == Kind::lin_rel || s.kind == Kind::ptp;
    if (kind_ == TaskKind::submit && (moves || s.kind == Kind::trigger || s.kind == Kind::halt))
        throw KrlError("the submit interpreter has no motions, TRIGGER and HALT");
    const bool interrupts = s.kind == Kind::interrupt_decl || s.kind == Kind::interrupt_on ||
                            s.kind == Kind::interrupt_off || s.kind == Kind::brake || s.kind == Kind::resume;
    if (interrupts && kind_ != TaskKind::robot)
        throw KrlError("INTERRUPT, BRAKE and RESUME are the robot interpreter's");
    switch (s.kind) {
        case Kind::interrupt_decl:
            declare_interrupt(s);
            return;
        case Kind::interrupt_on:
        case Kind::interrupt_off:
            switch_interrupt(s, s.kind == Kind::interrupt_on);
            return;
        case Kind::brake:
            if (serving_.empty()) throw KrlError("BRAKE stands in an interrupt program only");
            host_.brake(*this);
            return;
        case Kind::resume:
            resume();
            return;
        case Kind::assign:
            write(place(*s.target), evaluate(*s.value));
            return;
        case Kind::call:
            (void)call(*s.value, true);
            return;
        case Kind::halt:
            host_.wait_main_run(*this);
            host_.halt(*this);
            return;
        case Kind::wait_for:
            if (kind_ == TaskKind::robot) host_.wait_main_run(*this);
            wait([&] { return condition(s.value); });
            return;
        case Kind::wait_sec: {
            if (kind_ == TaskKind::robot) host_.wait_main_run(*this);
            const double seconds = evaluate(*s.value).as_number();
            if (seconds > 0) host_.wait_seconds(*this, seconds);
            return;
        }
        case Kind::lin:
        case Kind::lin_rel:
        case Kind::ptp: {
            const Motion motion = s.kind == Kind::lin   ? Motion::lin
                                  : s.kind == Kind::ptp ? Motion::ptp
                                                        : Motion::lin_rel;
            host_.move(*this, motion, evaluate(*s.value), s.approximates, std::move(triggers_));
            triggers_.clear();
            return;
        }
        case Kind::pulse:
            if (kind_ == TaskKind::robot) host_.wait_main_run(*this);
            host_.pulse(*this, place(*s.target), evaluate(*s.value).truth(), evaluate(*s.second).as_number());
            return;
        case Kind::trigger:
            trigger(s);
            return;
        default:
            throw KrlError("a statement that this machine does not execute");
    }
}

void Task::trigger(const Statement& s) {
    if (triggers_.size() >= 8) throw KrlError("at most eight TRIGGERs wait for a motion");
    if (evaluate(*s.second).as_number() != 0) throw KrlError("TRIGGER with a DELAY is not known here");
    const double path = evaluate(*s.value).as_number();
    if (path > 0) throw KrlError("TRIGGER behind the point is not known here");
    const Statement& what = s.blocks[0][0];
    PathTrigger t;
    t.before_end_mm = -path;
    // Its values are those of now; it happens on the path.
    if (what.kind == Statement::Kind::pulse) {
        const Place output = place(*what.target);
        const bool level = evaluate(*what.value).truth();
        const double seconds = evaluate(*what.second).as_number();
        t.act = [this_machine = &machine_, host = &host_, output, level, seconds] {
            Task task(*this_machine, *host, TaskKind::trigger, {});
            host->pulse(task, output, level, seconds);
        };
    } else if (what.kind == Statement::Kind::assign) {
        const Place to = place(*what.target);
        const Value value = evaluate(*what.value);
        t.act = [this_machine = &machine_, host = &host_, to, value] {
            Task(*this_machine, *host, TaskKind::trigger, {}).write(to, value);
        };
    } else {
        const double priority = evaluate(*s.third).as_number();
        if (priority != -1 && !(priority >= 1 && priority <= 128)) throw KrlError("there is no such PRIO");
        const auto routine = machine_.routine(what.value->name, stack_.back().routine->module);
        if (!routine) throw KrlError(fmt::format("there is no program {}", what.value->name));
        const auto arguments = arguments_of(*what.value);
        for (const Parameter& p : routine->parameters)
            if (p.out) throw KrlError("TRIGGER hands values over, no variables");
        t.act = [this_machine = &machine_, host = &host_, routine, arguments] {
            Task task(*this_machine, *host, TaskKind::trigger, {});
            auto values = arguments;
            (void)task.invoke(*routine, values);
        };
    }
    // What fails on the path is told; the arm's thread has nobody to throw to.
    t.act = [act = std::move(t.act), host = &host_, line = s.line] {
        try {
            act();
        } catch (const KrlError& e) {
            host->told(fmt::format("TRIGGER of line {}: {}", line, e.what()));
        }
    };
    triggers_.push_back(std::move(t));
}

}  // namespace seamwright::krl
