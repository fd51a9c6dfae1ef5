#include "devices/controllers/ur/script/interpreter.h"

#include <fmt/format.h>
#include <iterator>

#include <algorithm>
#include <cmath>

namespace seamwright::urscript {
namespace {

constexpr int kLongestIdle = 100'000;  // operations without robot time; a real controller gives up too
constexpr std::size_t kMostThreads = 16, kDeepest = 100;

std::optional<double> number(const Value& v) {
    if (const auto* whole = std::get_if<std::int32_t>(&v.is)) return *whole;
    if (const auto* real = std::get_if<double>(&v.is)) return *real;
    return std::nullopt;
}

}  // namespace

Interpreter::Interpreter(Program program, ScriptRobot& robot, const InterpreterSettings& settings)
    : program_(std::move(program)),
      robot_(robot),
      settings_(settings),
      random_(settings.seed),
      globals_(program_.globals.size()) {
    Thread main;
    main.id = next_id_++;
    main.frames.push_back({0, 0, {}});
    threads_.push_back(std::move(main));
}

const Value* Interpreter::global(const std::string& name) const {
    const auto it = std::find(program_.globals.begin(), program_.globals.end(), name);
    if (it == program_.globals.end()) return nullptr;
    const auto& value = globals_[static_cast<std::size_t>(it - program_.globals.begin())];
    return value ? &*value : nullptr;
}

void Interpreter::stop() {
    stopped_ = true;
    threads_.clear();
    born_.clear();
    robot_.stop();
}

void Interpreter::fault(const std::string& what) {
    if (!error_) error_ = Error{ErrorKind::input, what, program_.where(line_), {}};
    stopped_ = true;
}

bool Interpreter::alive(int id) const {
    const auto is = [id](const Thread& t) { return t.id == id && !t.frames.empty(); };
    return std::any_of(threads_.begin(), threads_.end(), is) || std::any_of(born_.begin(), born_.end(), is);
}

void Interpreter::kill(int id) {
    for (auto* all : {&threads_, &born_})
        for (Thread& t : *all) {
            if (t.id == id) t.frames.clear();
            if (t.parent == id && !t.frames.empty()) kill(t.id);
        }
}

bool Interpreter::ready(Thread& thread) const {
    switch (thread.wait.what) {
        case Wait::For::nothing:
        case Wait::For::cycle:
            break;
        case Wait::For::time:
            if (robot_.time_s() < thread.wait.until_s - 1e-9) return false;
            break;
        case Wait::For::motion:
            if (robot_.moves_left() > thread.wait.pending) return false;
            break;
        case Wait::For::popup:
            if (robot_.popup) return false;
            break;
        case Wait::For::thread:
            if (alive(thread.wait.thread)) return false;
            break;
    }
    thread.wait = {};
    return true;
}

void Interpreter::cycle() {
    if (threads_.empty()) return;
    std::vector<std::size_t> order(threads_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random_);
    for (const std::size_t i : order) {
        if (threads_[i].frames.empty() || !ready(threads_[i])) continue;
        run(threads_[i]);
        if (stopped_ || threads_.front().frames.empty()) return stop();  // its end is the program's
    }
    std::erase_if(threads_, [](const Thread& t) { return t.frames.empty(); });
    std::erase_if(born_, [](const Thread& t) { return t.frames.empty(); });
    std::move(born_.begin(), born_.end(), std::back_inserter(threads_));
    born_.clear();
}

void Interpreter::run(Thread& thread) {
    int left = std::uniform_int_distribution(settings_.least_slice, settings_.most_slice)(random_);
    while (left-- > 0 || thread.critical > 0) {
        if (++thread.idle_operations > kLongestIdle) return fault("a loop uses no time: it wants a sync()");
        const Then then = step(thread);
        if (stopped_) return;
        if (then == Then::ended) return;
        if (then == Then::waits) {
            if (thread.critical > 0) return fault("the robot's time is used in a critical section");
            thread.idle_operations = 0;
            return;
        }
    }
}

void Interpreter::store(std::optional<Value>& to, Value value, const std::string& name) {
    if (std::holds_alternative<std::monostate>(value.is))
        return fault(fmt::format("nothing is assigned to {}", name));
    if (to && to->is.index() != value.is.index())
        return fault(fmt::format("{} is {} and cannot become {}", name, type_name(*to), type_name(value)));
    if (to)
        if (const auto* old = std::get_if<ListValue>(&to->is))
            if (old->size() != std::get<ListValue>(value.is).size())
                return fault(fmt::format("{} is a list of {} and cannot become one of {}", name, old->size(),
                                         std::get<ListValue>(value.is).size()));
    to = std::move(value);
}

std::optional<std::size_t> Interpreter::place(const Value& index, std::size_t size) {
    const auto* at = std::get_if<std::int32_t>(&index.is);
    if (!at) {
        fault(fmt::format("{} is no index", type_name(index)));
        return std::nullopt;
    }
    if (*at < 0 || *at >= static_cast<std::int32_t>(size)) {
        fault(fmt::format("index {} is beyond the list of {}", *at, size));
        return std::nullopt;
    }
    return static_cast<std::size_t>(*at);
}

void Interpreter::store_element(std::optional<Value>& in, const std::string& name, const Value& index,
                                Value value) {
    if (!in) return fault(fmt::format("{} has no value yet", name));
    if (auto* list = std::get_if<ListValue>(&in->is)) {
        const auto at = place(index, list->size());
        if (!at) return;
        if ((*list)[*at].is.index() != value.is.index())
            return fault(fmt::format("{} holds {} and cannot hold {}", name, type_name((*list)[*at]),
                                     type_name(value)));
        (*list)[*at] = std::move(value);
    } else if (auto* pose = std::get_if<PoseValue>(&in->is)) {
        const auto at = place(index, 6);
        const auto real = number(value);
        if (!at) return;
        if (!real) return fault(fmt::format("{} is no number of a pose", type_name(value)));
        (*pose)[*at] = *real;
    } else {
        fault(fmt::format("{} is {} and has no elements", name, type_name(*in)));
    }
}

Value Interpreter::element(const Value& of, const Value& index) {
    if (const auto* list = std::get_if<ListValue>(&of.is)) {
        const auto at = place(index, list->size());
        return at ? (*list)[*at] : Value{};
    }
    if (const auto* pose = std::get_if<PoseValue>(&of.is)) {
        const auto at = place(index, 6);
        return at ? Value{(*pose)[*at]} : Value{};
    }
    // Strings have no index on controllers before 5.x: str_at() everywhere.
    fault(fmt::format("{} has no elements", type_name(of)));
    return {};
}

Value Interpreter::arithmetic(Code code, const Value& a, const Value& b) {
    const auto x = number(a), y = number(b);
    if (!x || !y) {
        fault(fmt::format("{} and {} are not to be reckoned with", type_name(a), type_name(b)));
        return {};
    }
    const bool whole =
        std::holds_alternative<std::int32_t>(a.is) && std::holds_alternative<std::int32_t>(b.is);
    double out = 0;
    if (code == Code::add) out = *x + *y;
    if (code == Code::subtract) out = *x - *y;
    if (code == Code::multiply) out = *x * *y;
    if (code == Code::divide || code == Code::remainder) {
        if (*y == 0) {
            fault("a division by zero");
            return {};
        }
        // Versions differ in whether 7 / 2 is 3 or 3.5.
        if (whole && code == Code::divide && std::fmod(*x, *y) != 0) {
            fault("a division of whole numbers leaves a rest: controllers differ in what they make of it");
            return {};
        }
        out = code == Code::divide ? *x / *y : std::fmod(*x, *y);
    }
    if (!whole) return {out};
    if (!(out >= -2147483648.0 && out <= 2147483647.0)) {
        fault("a whole number is beyond 32 bits");
        return {};
    }
    return {static_cast<std::int32_t>(out)};
}

Value Interpreter::comparison(Code code, const Value& a, const Value& b) {
    const auto x = number(a), y = number(b);
    if (code == Code::equal || code == Code::unequal) {
        if (!(x && y) && a.is.index() != b.is.index()) {
            fault(fmt::format("{} is compared with {}", type_name(a), type_name(b)));
            return {};
        }
        const bool same = x && y ? *x == *y : a == b;
        return {same == (code == Code::equal)};
    }
    if (!x || !y) {
        fault(fmt::format("{} and {} have no order", type_name(a), type_name(b)));
        return {};
    }
    return {code == Code::less         ? *x < *y
            : code == Code::greater    ? *x > *y
            : code == Code::less_equal ? *x <= *y
                                       : *x >= *y};
}

bool Interpreter::truth(const Value& value) {
    if (const auto* v = std::get_if<bool>(&value.is)) return *v;
    fault(fmt::format("{} is no condition", type_name(value)));
    return false;
}

Interpreter::Then Interpreter::call_builtin(Thread& thread, int number) {
    const Builtin& called = builtins()[static_cast<std::size_t>(number)];
    BuiltinCall call{robot_, thread.id, {}};
    const std::size_t count = called.parameters.size();
    call.arguments.assign(thread.stack.end() - static_cast<std::ptrdiff_t>(count), thread.stack.end());
    thread.stack.resize(thread.stack.size() - count);
    for (std::size_t i = 0; i < called.required; ++i)
        if (std::holds_alternative<std::monostate>(call.arguments[i].is)) {
            fault(fmt::format("{}() gets nothing as its argument {}", called.name, i + 1));
            return Then::goes_on;
        }
    if (const auto done = called.act(call); !done) {
        fault(fmt::format("{}(): {}", called.name, done.error().what));
        return Then::goes_on;
    }
    thread.stack.push_back(std::move(call.result));
    thread.wait = call.wait;
    return call.wait.what == Wait::For::nothing ? Then::goes_on : Then::waits;
}

// Takes the topmost `count` values.
Value Interpreter::list_of(std::vector<Value>& stack, std::size_t count) {
    const auto first = stack.end() - static_cast<std::ptrdiff_t>(count);
    ListValue list(std::make_move_iterator(first), std::make_move_iterator(stack.end()));
    stack.erase(first, stack.end());
    for (const Value& v : list)
        if (v.is.index() != list.front().is.index() || std::holds_alternative<ListValue>(v.is) ||
            std::holds_alternative<std::monostate>(v.is))
            fault(fmt::format("a list holds {} beside {}", type_name(v), type_name(list.front())));
    return {std::move(list)};
}

// Takes the topmost six values.
Value Interpreter::pose_of(std::vector<Value>& stack) {
    PoseValue pose{};
    for (std::size_t i = pose.size(); i-- > 0;) {
        const auto real = number(stack.back());
        if (!real) fault(fmt::format("{} is no number of a pose", type_name(stack.back())));
        pose[i] = real.value_or(0);
        stack.pop_back();
    }
    return {pose};
}

void Interpreter::call(Thread& thread, int function, int arguments) {
    if (thread.frames.size() >= kDeepest) return fault("functions call each other too deeply");
    const Function& callee = program_.functions[static_cast<std::size_t>(function)];
    Frame called{function, 0, {}};
    called.locals.resize(callee.locals.size());
    for (int i = arguments; i-- > 0;) {
        auto& argument = called.locals[static_cast<std::size_t>(i)];
        argument = std::move(thread.stack.back());
        thread.stack.pop_back();
        if (std::holds_alternative<std::monostate>(argument->is))
            fault(fmt::format("{}() gets nothing as an argument", callee.name));
    }
    thread.frames.push_back(std::move(called));
}

// Leaves the handle.
void Interpreter::run_thread(Thread& thread, int function) {
    if (threads_.size() + born_.size() >= kMostThreads)
        return fault(fmt::format("more than {} threads run", kMostThreads));
    Thread made;
    made.id = next_id_++;
    made.parent = thread.id;
    made.frames.push_back({function, 0, {}});
    thread.stack.push_back({ThreadHandle{made.id}});
    born_.push_back(std::move(made));
}

Interpreter::Then Interpreter::join_or_kill(Thread& thread, const Value& which, bool kills) {
    const auto* handle = std::get_if<ThreadHandle>(&which.is);
    if (!handle) {
        fault(fmt::format("{} is no thread", type_name(which)));
        return Then::goes_on;
    }
    if (kills) {
        kill(handle->id);
        return thread.frames.empty() ? Then::ended : Then::goes_on;
    }
    thread.wait = {Wait::For::thread, 0, 0, handle->id};
    return Then::waits;
}

Interpreter::Then Interpreter::step(Thread& thread) {
    Frame& frame = thread.frames.back();
    const Function& function = program_.functions[static_cast<std::size_t>(frame.function)];
    const Operation& op = function.code[frame.at++];
    line_ = op.line;
    const auto a = static_cast<std::size_t>(op.a);
    const auto pop = [&] {
        Value v = std::move(thread.stack.back());
        thread.stack.pop_back();
        return v;
    };
    const auto push = [&](Value v) { thread.stack.push_back(std::move(v)); };
    switch (op.code) {
        case Code::constant:
            push(program_.constants[a]);
            break;
        case Code::load_global:
            if (!globals_[a]) fault(fmt::format("{} has no value yet", program_.globals[a]));
            if (!stopped_) push(*globals_[a]);
            break;
        case Code::load_local:
            if (frame.locals.size() <= a || !frame.locals[a])
                fault(fmt::format("{} has no value yet", function.locals[a]));
            if (!stopped_) push(*frame.locals[a]);
            break;
        case Code::store_global:
            store(globals_[a], pop(), program_.globals[a]);
            break;
        case Code::store_local:
            if (frame.locals.size() <= a) frame.locals.resize(function.locals.size());
            store(frame.locals[a], pop(), function.locals[a]);
            break;
        case Code::store_element: {
            Value value = pop();
            const Value index = pop();
            if (op.b != 1 && frame.locals.size() <= a) frame.locals.resize(function.locals.size());
            store_element(op.b == 1 ? globals_[a] : frame.locals[a],
                          op.b == 1 ? program_.globals[a] : function.locals[a], index, std::move(value));
            break;
        }
        case Code::index: {
            const Value index = pop();
            push(element(pop(), index));
            break;
        }
        case Code::add:
        case Code::subtract:
        case Code::multiply:
        case Code::divide:
        case Code::remainder: {
            const Value y = pop();
            push(arithmetic(op.code, pop(), y));
            break;
        }
        case Code::negate: {
            const Value v = pop();
            push(arithmetic(Code::subtract,
                            std::holds_alternative<double>(v.is) ? Value{0.0} : Value{std::int32_t{0}}, v));
            break;
        }
        case Code::equal:
        case Code::unequal:
        case Code::less:
        case Code::greater:
        case Code::less_equal:
        case Code::greater_equal: {
            const Value y = pop();
            push(comparison(op.code, pop(), y));
            break;
        }
        case Code::logical_and:
        case Code::logical_or:
        case Code::logical_xor: {
            const bool y = truth(pop()), x = truth(pop());
            push({op.code == Code::logical_and ? x && y : op.code == Code::logical_or ? x || y : x != y});
            break;
        }
        case Code::logical_not:
            push({!truth(pop())});
            break;
        case Code::make_list:
            push(list_of(thread.stack, a));
            break;
        case Code::make_pose:
            push(pose_of(thread.stack));
            break;
        case Code::jump:
            frame.at = a;
            break;
        case Code::jump_if_not:
            if (!truth(pop())) frame.at = a;
            break;
        case Code::call:
            call(thread, op.a, op.b);  // `frame` is invalid from here on
            break;
        case Code::call_builtin:
            return call_builtin(thread, op.a);
        case Code::run_thread:
            run_thread(thread, op.a);
            break;
        case Code::give_back: {
            thread.frames.pop_back();
            if (thread.frames.empty()) {
                if (thread.critical > 0) fault("a critical section has no end");
                return Then::ended;
            }
            break;  // the value stays on the stack
        }
        case Code::drop:
            pop();
            break;
        case Code::join_thread:
        case Code::kill_thread:
            return join_or_kill(thread, pop(), op.code == Code::kill_thread);
        case Code::halt_program:
            stopped_ = true;
            break;
        case Code::enter_critical:
            ++thread.critical;
            break;
        case Code::exit_critical:
            if (--thread.critical < 0) fault("exit_critical stands outside a critical section");
            break;
    }
    return Then::goes_on;
}

}  // namespace seamwright::urscript
