// What a task's expressions come to: variables, structures, operators, and the routines that are called.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "devices/controllers/kuka/krl/machine.h"

namespace seamwright::krl {
namespace {

constexpr std::size_t kDeepest = 20;  // nested calls

}  // namespace

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
