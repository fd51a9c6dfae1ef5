// Values and variables of a program that is read, and what its expressions come to.

#include <algorithm>
#include <cmath>

#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {
namespace {

// Of a value that is copied: a point or a short list comes with its statement.
constexpr std::size_t kSmall = 100, kLargest = 1'000'000;
constexpr int kDeepestList = 30;  // lists within lists

// Its numbers and lists, nested ones included; more than kLargest where it is larger or nested too deep.
std::size_t cells(const Value& v, int depth = 0) {
    if (depth > kDeepestList) return kLargest + 1;
    std::size_t all = 1;
    for (const Value& part : v.parts)
        if ((all += cells(part, depth + 1)) > kLargest) break;
    return all;
}

}  // namespace

Value Value::of(double number) {
    Value v;
    v.kind = Kind::number;
    v.number = number;
    return v;
}
Value Value::of_truth(bool truth) {
    Value v = of(truth);
    v.kind = Kind::truth;
    return v;
}
Value Value::of_text(std::string text) {
    Value v;
    v.kind = Kind::text;
    v.text = std::move(text);
    return v;
}
Value Value::unknown(std::string name) {
    Value v;
    v.text = std::move(name);
    return v;
}
Value Value::list(std::vector<Value> parts) {
    Value v;
    v.kind = Kind::list;
    v.parts = std::move(parts);
    return v;
}
Value Value::numbers(std::initializer_list<double> numbers) {
    std::vector<Value> parts;
    for (const double n : numbers) parts.push_back(of(n));
    return list(std::move(parts));
}
std::optional<double> Value::as_number() const {
    if (kind != Kind::number || !std::isfinite(number)) return {};
    return number;
}
std::optional<bool> Value::as_truth() const {
    if (kind != Kind::truth) return {};
    return number != 0;
}
const Value* Value::part(std::string_view name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? nullptr : &parts[static_cast<std::size_t>(at - names.begin())];
}

std::optional<std::array<double, 6>> six_numbers(const Value& value) {
    if (value.kind != Value::Kind::list || value.parts.size() != 6) return {};
    std::array<double, 6> n{};
    for (std::size_t i = 0; i < 6; ++i) {
        const auto number = value.parts[i].as_number();
        if (!number || std::abs(*number) > 1e9) return {};
        n[i] = *number;
    }
    return n;
}

bool Machine::afford(const Value& copied) {
    const std::size_t size = cells(copied);
    if (size > kLargest) return too_long_ = true, false;
    return spend(size > kSmall ? size : 0);
}

Value Machine::value_of(const Expr& e) {
    switch (e.kind) {
        case Expr::Kind::number: {
            Value v = Value::of(e.number);
            if (dialect_ == Dialect::krl) v.type = e.whole ? Value::Type::integer : Value::Type::real;
            return v;
        }
        case Expr::Kind::truth:
            return Value::of_truth(e.number != 0);
        case Expr::Kind::text:
            return Value::of_text(e.text);
        case Expr::Kind::list:
        case Expr::Kind::pose:
        case Expr::Kind::record: {
            Value v;
            v.kind = Value::Kind::list;
            v.pose = e.kind == Expr::Kind::pose;
            v.parts.reserve(e.parts.size());
            for (const Argument& part : e.parts) {
                Value value = part.value ? value_of(*part.value) : Value{};
                if (e.kind != Expr::Kind::record) {
                    v.parts.push_back(std::move(value));
                    continue;
                }
                v.names.push_back(part.name);
                v.parts.emplace_back().type = type_of(part.name);
                put_in(v.parts.back(), std::move(value), part.name);
            }
            return afford(v) ? v : Value::unknown(shown(e));
        }
        case Expr::Kind::name:
        case Expr::Kind::index:
        case Expr::Kind::component: {
            const Value* found = find(e);
            if (found && found->known()) return afford(*found) ? *found : Value::unknown(shown(e));
            if (found && !found->text.empty()) return Value::unknown(found->text);
            return Value::unknown(shown(e));
        }
        case Expr::Kind::call: {
            Value v = Value::unknown(shown(e));
            Flow flow = Flow::on;
            if (!enter(e.text, e.parts, flow, &v)) v = call(e);
            if (dialect_ == Dialect::krl && v.type == Value::Type::any && !routine(e.text, now_file_))
                v.type = Value::Type::real;
            return v;
        }
        case Expr::Kind::unary: {
            const Value v = value_of(*e.parts[0].value);
            if (e.text == "-") {
                const auto n = v.as_number();
                if (!n) return Value::unknown(shown(e));
                Value minus = v;
                minus.number = -*n;
                return minus;
            }
            const auto t = v.as_truth();
            return t ? Value::of_truth(!*t) : Value::unknown(shown(e));
        }
        default:
            return binary(e);
    }
}

// INT and INT is INT in KRL. Where a type is not known, neither is what hangs on it.
Value Machine::arithmetic(const std::string& op, const Value& a, const Value& b, const Expr& e) const {
    using Type = Value::Type;
    const double x = a.number, y = b.number;
    const bool divides = op == "/" || op == "%" || op == "div" || op == "mod";
    if (divides && y == 0) return Value::unknown(shown(e));
    Value v = Value::of(op == "+"     ? x + y
                        : op == "-"   ? x - y
                        : op == "*"   ? x * y
                        : op == "/"   ? x / y
                        : op == "div" ? std::trunc(x / y)
                                      : std::fmod(x, y));
    if (dialect_ != Dialect::krl) return v;
    const bool both = a.type == Type::integer && b.type == Type::integer,
               real = a.type == Type::real || b.type == Type::real;
    v.type = both ? Type::integer : real ? Type::real : Type::any;
    if (v.type != Type::real && v.number != std::trunc(v.number)) {
        if (v.type == Type::any) return Value::unknown(shown(e));
        v.number = std::trunc(v.number);
    }
    return v;
}

Value Machine::binary(const Expr& e) {
    const std::string& op = e.text;
    const Value a = value_of(*e.parts[0].value), b = value_of(*e.parts[1].value);
    if (op == ":") return chained(a, b);  // frames of KRL
    if (const auto x = a.as_truth(), y = b.as_truth(); x || y) {
        if (op == "or" || op == "OR") {
            if (x && y) return Value::of_truth(*x || *y);
            if ((x && *x) || (y && *y)) return Value::of_truth(true);
        } else if (op == "and" || op == "AND") {
            if (x && y) return Value::of_truth(*x && *y);
            if ((x && !*x) || (y && !*y)) return Value::of_truth(false);
        } else if (x && y) {
            return Value::of_truth((*x == *y) == (op == "==" || op == "="));
        }
        return Value::unknown(!x && !a.text.empty() ? a.text : !y && !b.text.empty() ? b.text : shown(e));
    }
    if (a.kind == Value::Kind::text && b.kind == Value::Kind::text) {
        if (op == "==" || op == "=") return Value::of_truth(a.text == b.text);
        if (op == "<>" || op == "!=") return Value::of_truth(a.text != b.text);
    }
    if (a.kind == Value::Kind::list && b.kind == Value::Kind::list && (op == "+" || op == "-") &&
        a.parts.size() == b.parts.size()) {
        Value v = a;
        for (std::size_t i = 0; i < v.parts.size(); ++i) {
            const auto x = a.parts[i].as_number(), y = b.parts[i].as_number();
            if (!x || !y) return Value::unknown(shown(e));
            v.parts[i] = Value::of(op == "+" ? *x + *y : *x - *y);
        }
        return v;
    }
    const auto x = a.as_number(), y = b.as_number();
    if ((x && b.kind == Value::Kind::list) || (y && a.kind == Value::Kind::list)) {
        Value v = x ? b : a;
        for (Value& part : v.parts) {
            const auto n = part.as_number();
            if (!n || (op != "*" && !(op == "/" && y && *y != 0))) return Value::unknown(shown(e));
            part = Value::of(op == "*" ? *n * (x ? *x : *y) : *n / *y);
        }
        return v;
    }
    if (!x || !y) return Value::unknown(a.known() ? (b.known() ? shown(e) : b.text) : a.text);
    if (op == "+" || op == "-" || op == "*" || op == "/" || op == "%" || op == "div" || op == "mod")
        return arithmetic(op, a, b, e);
    if (op == "==" || op == "=") return Value::of_truth(*x == *y);
    if (op == "<>" || op == "!=") return Value::of_truth(*x != *y);
    if (op == "<") return Value::of_truth(*x < *y);
    if (op == ">") return Value::of_truth(*x > *y);
    if (op == "<=") return Value::of_truth(*x <= *y);
    if (op == ">=") return Value::of_truth(*x >= *y);
    return Value::unknown(shown(e));
}

}  // namespace seamwright::program_path
