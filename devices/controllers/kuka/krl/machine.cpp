#include "devices/controllers/kuka/krl/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace seamwright::krl {
namespace {

struct TaskStopped {};
constexpr auto kTaskTick = std::chrono::milliseconds(2);
constexpr auto kSubmitCycle = std::chrono::milliseconds(4);
constexpr std::size_t kDeepest = 20;  // nested calls

}  // namespace

void Host::brake(Task&) {
    throw KrlError("BRAKE is not known to this controller");
}
void Host::give_up_motions(Task&) {
    throw KrlError("RESUME is not known to this controller");
}

void Machine::load(const std::string& file_name, const std::string& text) {
    auto module = std::make_shared<Module>(parse_module(file_name, text));
    const std::lock_guard lock(mutex_);
    if (!module->is_data) {
        programs_[module->name] = module;
        return;
    }
    std::map<std::string, VariablePtr> variables;
    for (const Declaration& d : module->declarations) {
        std::vector<std::size_t> dimensions;
        for (const long size : d.dimensions) {
            if (size < 1) throw KrlError(fmt::format("{}: {} has no size", file_name, d.name));
            dimensions.push_back(static_cast<std::size_t>(size));
        }
        auto variable = std::make_shared<Variable>(d.name, d.type, dimensions);
        if (!variables.emplace(d.name, variable).second)
            throw KrlError(fmt::format("{}: {} is declared twice", file_name, d.name));
        for (const auto& [other, list] : data_)
            for (const Declaration& known : list->declarations)
                if (other != module->name && d.global && known.global && known.name == d.name)
                    throw KrlError(fmt::format("{}: {} is global in {} too", file_name, d.name, other));
    }
    data_[module->name] = module;
    variables_[module->name] = variables;
    // Values are literals: evaluated without a controller.
    struct NoHost final : Host {
        std::optional<Value> system_value(Task&, const Place&) override { return std::nullopt; }
        bool set_system(Task&, const Place&, const Value&) override { return false; }
        std::optional<Value> call(Task&, const std::string&, std::vector<Argument>&) override {
            return std::nullopt;
        }
        void move(Task&, Motion, const Value&, bool, std::vector<PathTrigger>) override {}
        void pulse(Task&, const Place&, bool, double) override {}
        void wait_main_run(Task&) override {}
        void wait_seconds(Task&, double) override {}
        void halt(Task&) override {}
        void told(const std::string&) override {}
    } none;
    Task task(*this, none, TaskKind::trigger, {});
    const auto told = [&](int line, const auto& assign) {
        try {
            assign();
        } catch (const KrlError& e) {
            throw KrlError(fmt::format("{}: line {}: {}", file_name, line, e.what()));
        }
    };
    for (const Declaration& d : module->declarations)
        if (d.initial)
            told(d.line, [&] {
                task.write({variables.at(d.name), 0, false, {}, {}, {}}, task.evaluate(*d.initial));
            });
    for (const Statement& s : module->assignments)
        told(s.line, [&] {
            const auto it = variables.find(s.target->name);
            if (it == variables.end()) throw KrlError(fmt::format("{} is not declared here", s.target->name));
            std::vector<long> indices;
            for (const ExpressionPtr& index : s.target->parts)
                indices.push_back(std::lround(task.evaluate(*index).as_number()));
            task.write({it->second, it->second->cell(indices, true), true, {}, {}, {}},
                       task.evaluate(*s.value));
        });
}

VariablePtr Machine::find(const std::string& name, const std::string& module) const {
    const auto own = variables_.find(module);
    if (own != variables_.end())
        if (const auto it = own->second.find(name); it != own->second.end()) return it->second;
    for (const auto& [list, data] : data_) {
        if (!data->is_public) continue;
        for (const Declaration& d : data->declarations)
            if (d.global && d.name == name) return variables_.at(list).at(name);
    }
    return nullptr;
}

std::shared_ptr<const Routine> Machine::routine(const std::string& name, const std::string& module) const {
    const auto own = programs_.find(module);
    if (own != programs_.end())
        for (const auto& r : own->second->routines)
            if (r->name == name) return r;
    for (const auto& [file, program] : programs_)
        for (const auto& r : program->routines)
            if (r->name == name && (r->global || r->name == file)) return r;
    return nullptr;
}

Value Machine::value(Host& host, const std::string& place) {
    Task task(*this, host, TaskKind::trigger, {});
    const auto e = parse_expression(place);
    if (e->kind != Expression::Kind::place) throw KrlError(fmt::format("{} is no variable", place));
    return task.read(task.place(*e));
}

void Machine::set(Host& host, const std::string& place, const std::string& value) {
    Task task(*this, host, TaskKind::trigger, {});
    const auto e = parse_expression(place);
    if (e->kind != Expression::Kind::place) throw KrlError(fmt::format("{} is no variable", place));
    task.write(task.place(*e), task.evaluate(*parse_expression(value)));
}

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

Place Task::place(const Expression& e) {
    if (e.kind != Expression::Kind::place) throw KrlError("a variable is needed here");
    Place p;
    p.row = e.row;
    p.component = e.component;
    for (const ExpressionPtr& index : e.parts) {
        const Value v = evaluate(*index);
        if (v.type != Type::integer) throw KrlError("an index is an INT");
        p.indices.push_back(std::lround(v.as_number()));
    }
    if (e.name.starts_with('$')) {
        p.system = e.name;
        return p;
    }
    std::string module;
    if (!stack_.empty()) {
        const Locals& locals = stack_.back();
        module = locals.routine->module;
        if (const auto it = locals.variables.find(e.name); it != locals.variables.end())
            p.variable = it->second;
    }
    if (!p.variable) p.variable = machine_.find(e.name, module);
    if (!p.variable) throw KrlError(fmt::format("{} is not declared", e.name));
    p.cell = p.variable->cell(p.indices, p.row);
    if (p.row && p.variable->type != Type::character)
        throw KrlError("only rows of CHAR are taken as a whole");
    return p;
}

Value Task::read(const Place& p) {
    if (!p.variable) {
        auto value = host_.system_value(*this, p);
        if (!value) throw KrlError(fmt::format("there is no system variable {}", p.system));
        if (p.component.empty() || value->parts.empty()) return *value;
        const auto it = value->parts.find(p.component);
        if (it == value->parts.end() || !it->second)
            throw KrlError(fmt::format("{} has no value {}", p.system, p.component));
        return Value::real(*it->second);
    }
    const Variable& v = *p.variable;
    if (p.row) {
        if (!v.cells[p.cell].set) throw KrlError(fmt::format("{}[] is not initialised", v.name));
        return Value::string_of(v.row_text(p.cell));
    }
    const Value& value = v.cells[p.cell];
    if (p.component.empty()) {
        if (!value.set) throw KrlError(fmt::format("{} is not initialised", v.name));
        return value;
    }
    const auto it = value.parts.find(p.component);
    if (it == value.parts.end() || !it->second) {
        const auto& known = components(v.type);
        if (std::find(known.begin(), known.end(), p.component) == known.end())
            throw KrlError(fmt::format("{} has no component {}", v.name, p.component));
        throw KrlError(fmt::format("{}.{} is not initialised", v.name, p.component));
    }
    if (v.type == Type::eki_status)
        return p.component == "CONNECTED" ? Value::boolean(*it->second != 0) : Value::integer(*it->second);
    return Value::real(*it->second);
}

void Task::write(const Place& p, const Value& value) {
    if (!p.variable) {
        if (!host_.set_system(*this, p, value)) throw KrlError(fmt::format("{} cannot be written", p.system));
        return;
    }
    Variable& v = *p.variable;
    if (p.row) {
        if (!value.string) throw KrlError(fmt::format("{}[] takes a string", v.name));
        v.set_row(p.cell, value.text);
        return;
    }
    if (p.component.empty()) {
        v.cells[p.cell] = converted(value, v.type);
        return;
    }
    const auto& known = components(v.type);
    if (std::find(known.begin(), known.end(), p.component) == known.end())
        throw KrlError(fmt::format("{} has no component {}", v.name, p.component));
    v.cells[p.cell].parts[p.component] = converted(value, Type::real).number;
    v.cells[p.cell].set = true;
}

Value Task::evaluate(const Expression& e) {
    using Kind = Expression::Kind;
    switch (e.kind) {
        case Kind::literal:
            return e.value;
        case Kind::aggregate:
            return aggregate(e);
        case Kind::place:
            return read(place(e));
        case Kind::call:
            return call(e, false);
        case Kind::unary: {
            const Value v = evaluate(*e.parts[0]);
            if (e.name == "NOT") return Value::boolean(!v.truth());
            return v.type == Type::real ? Value::real(-v.as_number()) : Value::integer(-v.as_number());
        }
        case Kind::binary:
            return binary(e);
    }
    throw KrlError("an expression that this machine does not know");
}

Value Task::aggregate(const Expression& e) {
    Value v;
    Type type = Type::frame;
    if (!e.name.empty()) {
        const auto named = type_from(e.name);
        if (!named || components(*named).empty()) throw KrlError(fmt::format("{} is no structure", e.name));
        type = *named;
    } else {
        for (const auto& [field, value] : e.fields) {
            if (field == "S" || field == "T") type = Type::pos;
            if (field.starts_with("E")) type = Type::e6pos;
        }
        if (e.fields.front().first == "A1") type = Type::e6axis;
    }
    v.type = type;
    v.set = true;
    const auto& known = components(type);
    for (const auto& [field, value] : e.fields) {
        if (std::find(known.begin(), known.end(), field) == known.end())
            throw KrlError(fmt::format("{} has no component {}", to_string(type), field));
        if (v.parts.count(field) > 0) throw KrlError(fmt::format("component {} is given twice", field));
        v.parts[field] = converted(evaluate(*value), Type::real).number;
    }
    return v;
}

Value Task::binary(const Expression& e) {
    // Both sides are always evaluated, as KRL does.
    const Value a = evaluate(*e.parts[0]), b = evaluate(*e.parts[1]);
    const std::string& op = e.name;
    if (op == "AND") return Value::boolean(static_cast<int>(a.truth()) + static_cast<int>(b.truth()) == 2);
    if (op == "OR") return Value::boolean(static_cast<int>(a.truth()) + static_cast<int>(b.truth()) > 0);
    if (op == "EXOR") return Value::boolean(a.truth() != b.truth());
    if (op == ":") {
        if (!is_geometric(a.type) || !is_geometric(b.type)) throw KrlError("the operator : joins frames");
        return Value::of(a.pose() * b.pose(), b.type);
    }
    if (a.string || b.string) throw KrlError("strings are compared by StrComp");
    if (op == "+" || op == "-" || op == "*" || op == "/") {
        const double x = a.as_number(), y = b.as_number();
        const bool real = a.type == Type::real || b.type == Type::real;
        if (op == "/" && y == 0) throw KrlError("division by zero");
        double r = op == "+" ? x + y : op == "-" ? x - y : op == "*" ? x * y : x / y;
        if (!real && op == "/") r = std::trunc(r);
        return real ? Value::real(r) : Value::integer(r);
    }
    if (a.type == Type::enumeration || a.type == Type::boolean || b.type == Type::enumeration ||
        b.type == Type::boolean) {
        if (a.type != b.type) throw KrlError("values of two types are not compared");
        if (!a.set || !b.set) throw KrlError("a value that is not initialised");
        const bool same = a.type == Type::boolean ? a.truth() == b.truth() : a.text == b.text;
        if (op == "==") return Value::boolean(same);
        if (op == "<>") return Value::boolean(!same);
        throw KrlError("there is no order among these values");
    }
    const double x = a.as_number(), y = b.as_number();
    return Value::boolean(op == "=="   ? x == y
                          : op == "<>" ? x != y
                          : op == "<"  ? x < y
                          : op == ">"  ? x > y
                          : op == "<=" ? x <= y
                                       : x >= y);
}

std::vector<Argument> Task::arguments_of(const Expression& e) {
    std::vector<Argument> all;
    for (const ExpressionPtr& part : e.parts) {
        Argument a;
        if (part) {
            a.given = true;
            if (part->kind == Expression::Kind::place) {
                a.place = place(*part);
                try {
                    a.value = read(*a.place);
                } catch (const KrlError&) {
                    a.value = Value::unset(a.place->variable ? a.place->variable->type : Type::integer);
                }
            } else {
                a.value = evaluate(*part);
            }
        }
        all.push_back(std::move(a));
    }
    return all;
}

Value Task::call(const Expression& e, bool as_statement) {
    auto arguments = arguments_of(e);
    const std::string module = stack_.empty() ? "" : stack_.back().routine->module;
    if (const auto routine = machine_.routine(e.name, module)) {
        if (!routine->returns && !as_statement) throw KrlError(fmt::format("{} gives no value", e.name));
        return invoke(*routine, arguments);
    }
    auto value = host_.call(*this, e.name, arguments);
    if (!value) throw KrlError(fmt::format("there is no program {}", e.name));
    if (!value->set && !as_statement) throw KrlError(fmt::format("{} gives no value", e.name));
    if (value->set && as_statement) throw KrlError(fmt::format("the value of {} goes nowhere", e.name));
    return *value;
}

Value Task::invoke(const Routine& routine, std::vector<Argument>& arguments) {
    if (stack_.size() >= kDeepest) throw KrlError("programs call each other too deeply");
    if (arguments.size() != routine.parameters.size())
        throw KrlError(fmt::format("{} takes {} parameters", routine.name, routine.parameters.size()));
    Locals locals;
    locals.routine = std::shared_ptr<const Routine>(&routine, [](const Routine*) {});
    for (const Declaration& d : routine.declarations) {
        const auto parameter = std::find_if(routine.parameters.begin(), routine.parameters.end(),
                                            [&](const Parameter& p) { return p.name == d.name; });
        if (parameter == routine.parameters.end()) {
            std::vector<std::size_t> dimensions;
            for (const long size : d.dimensions) dimensions.push_back(static_cast<std::size_t>(size));
            if (!locals.variables.emplace(d.name, std::make_shared<Variable>(d.name, d.type, dimensions))
                     .second)
                throw KrlError(fmt::format("{} is declared twice in {}", d.name, routine.name));
            continue;
        }
        Argument& a = arguments[static_cast<std::size_t>(parameter - routine.parameters.begin())];
        if (!a.given) throw KrlError(fmt::format("parameter {} of {} is left out", d.name, routine.name));
        if (parameter->out) {
            if (!a.place || !a.place->variable || !a.place->component.empty())
                throw KrlError(fmt::format("parameter {} of {} wants a variable", d.name, routine.name));
            if (a.place->variable->type != d.type)
                throw KrlError(
                    fmt::format("parameter {} of {} is a {}", d.name, routine.name, to_string(d.type)));
            if (parameter->array != a.place->row ||
                (!parameter->array && !a.place->variable->dimensions.empty()) ||
                (parameter->array && a.place->variable->dimensions.size() != 1))
                throw KrlError(fmt::format("parameter {} of {}: an array where none is meant, or the reverse",
                                           d.name, routine.name));
            locals.variables.emplace(d.name, a.place->variable);
            continue;
        }
        if (is_geometric(d.type) && a.value.type != d.type)
            throw KrlError(fmt::format("parameter {} of {} is a {}, not {}", d.name, routine.name,
                                       to_string(d.type), to_string(a.value.type)));
        auto variable = std::make_shared<Variable>(d.name, d.type, std::vector<std::size_t>{});
        if (!a.value.set)
            throw KrlError(fmt::format("parameter {} of {} is not initialised", d.name, routine.name));
        variable->cells[0] = converted(a.value, d.type);
        locals.variables.emplace(d.name, std::move(variable));
    }
    stack_.push_back(std::move(locals));
    returned_ = Value();
    try {
        const Flow flow = execute(routine.body);
        if (flow == Flow::exit) throw KrlError(fmt::format("{}: EXIT outside a loop", routine.name));
        if (routine.returns && flow != Flow::returned)
            throw KrlError(fmt::format("{} ends without a value", routine.name));
    } catch (...) {
        stack_.pop_back();
        end_interrupts();
        throw;
    }
    stack_.pop_back();
    end_interrupts();
    return routine.returns ? converted(returned_, *routine.returns) : Value();
}

}  // namespace seamwright::krl
