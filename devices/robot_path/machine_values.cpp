// Values and variables of a program that is read, and what its expressions come to.

#include <algorithm>
#include <cmath>

#include "devices/robot_path/machine.h"

namespace seamwright::program_path {
namespace {

constexpr long kLargestIndex = 100'000;  // of an array that is filled element by element

// By place, as RAPID writes its records.
int place_of(std::string_view component) {
    static const std::map<std::string_view, int> places = {
        {"trans", 0},  {"rot", 1},     {"robconf", 2}, {"extax", 3}, {"x", 0},
        {"y", 1},      {"z", 2},       {"q1", 0},      {"q2", 1},    {"q3", 2},
        {"q4", 3},     {"robhold", 0}, {"ufprog", 1},  {"ufmec", 2}, {"uframe", 3},
        {"oframe", 4}, {"tframe", 1},  {"tload", 2},   {"robax", 0}};
    const auto at = places.find(component);
    return at == places.end() ? -1 : at->second;
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

const Value* Machine::variable(const std::string& name) const {
    if (volatile_.count(name) > 0) return nullptr;
    if (!scopes_.empty()) {
        const auto local = scopes_.back().find(name);
        if (local != scopes_.back().end()) return &local->second;
    }
    const auto global = globals_.find(name);
    return global == globals_.end() ? nullptr : &global->second;
}

void Machine::declare(const std::string& name, Value value, bool local) {
    if (local && !scopes_.empty())
        scopes_.back()[name] = std::move(value);
    else
        globals_[name] = std::move(value);
}

const Value* Machine::find(const Expr& e) {
    if (e.kind == Expr::Kind::name) return variable(e.text);
    if (e.kind != Expr::Kind::index && e.kind != Expr::Kind::component) return nullptr;
    const Value* of = find(*e.of);
    if (!of || of->kind != Value::Kind::list) return nullptr;
    if (e.kind == Expr::Kind::component) {
        if (!of->names.empty()) return of->part(e.text);
        const int at = place_of(e.text);
        return at >= 0 && static_cast<std::size_t>(at) < of->parts.size()
                   ? &of->parts[static_cast<std::size_t>(at)]
                   : nullptr;
    }
    const int first = dialect_ == Dialect::urscript ? 0 : 1;
    for (const Argument& index : e.parts) {
        if (!index.value) return nullptr;
        const auto n = value_of(*index.value).as_number();
        if (!n || of->kind != Value::Kind::list || *n < first ||
            *n - first >= static_cast<double>(of->parts.size()))
            return nullptr;
        of = &of->parts[static_cast<std::size_t>(*n - first)];
    }
    return of;
}

void Machine::assign(const Expr& place, Value value) {
    if (doubt_ > 0) value = Value::unknown(shown(place));
    // The way down to the variable: its name, then indices and components.
    std::vector<const Expr*> way;
    for (const Expr* e = &place;; e = e->of.get()) {
        way.push_back(e);
        if (e->kind == Expr::Kind::name) break;
        if (e->kind != Expr::Kind::index && e->kind != Expr::Kind::component) return;
    }
    const std::string& name = way.back()->text;
    Value* at = nullptr;
    if (!scopes_.empty() && scopes_.back().count(name) > 0)
        at = &scopes_.back()[name];
    else
        at = &globals_[name];
    for (auto e = way.rbegin() + 1; e != way.rend(); ++e) {
        if ((*e)->kind == Expr::Kind::component) {
            if (at->kind != Value::Kind::list) {
                *at = {};
                at->kind = Value::Kind::list;
            }
            const int by_place = place_of((*e)->text);
            if (dialect_ == Dialect::krl || by_place < 0) {
                const auto known = std::find(at->names.begin(), at->names.end(), (*e)->text);
                if (known == at->names.end()) {
                    at->names.resize(at->parts.size());
                    at->names.push_back((*e)->text);
                    at->parts.emplace_back();
                    at = &at->parts.back();
                } else {
                    at = &at->parts[static_cast<std::size_t>(known - at->names.begin())];
                }
            } else {
                const auto place_in = static_cast<std::size_t>(by_place);
                if (at->parts.size() <= place_in) at->parts.resize(place_in + 1);
                at = &at->parts[place_in];
            }
            continue;
        }
        const int first = dialect_ == Dialect::urscript ? 0 : 1;
        for (const Argument& index : (*e)->parts) {
            if (!index.value) return;  // NAME[]="text" of KRL
            const auto n = value_of(*index.value).as_number();
            if (!n || *n < first || *n - first >= kLargestIndex) {
                *at = Value::unknown(name);  // any of its elements
                return;
            }
            const auto i = static_cast<std::size_t>(*n - first);
            if (at->kind != Value::Kind::list) {
                *at = {};
                at->kind = Value::Kind::list;
            }
            if (at->parts.size() <= i) at->parts.resize(i + 1);
            at = &at->parts[i];
        }
    }
    *at = std::move(value);
}

Value Machine::value_of(const Expr& e) {
    switch (e.kind) {
        case Expr::Kind::number:
            return Value::of(e.number);
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
                v.parts.push_back(part.value ? value_of(*part.value) : Value{});
                if (e.kind == Expr::Kind::record) v.names.push_back(part.name);
            }
            return v;
        }
        case Expr::Kind::name:
        case Expr::Kind::index:
        case Expr::Kind::component: {
            const Value* found = find(e);
            if (found && found->known()) return *found;
            if (found && !found->text.empty()) return Value::unknown(found->text);
            return Value::unknown(shown(e));
        }
        case Expr::Kind::call:
            return call(e);
        case Expr::Kind::unary: {
            const Value v = value_of(*e.parts[0].value);
            if (e.text == "-") {
                const auto n = v.as_number();
                return n ? Value::of(-*n) : Value::unknown(shown(e));
            }
            const auto t = v.as_truth();
            return t ? Value::of_truth(!*t) : Value::unknown(shown(e));
        }
        default:
            return binary(e);
    }
}

Value Machine::binary(const Expr& e) {
    const std::string& op = e.text;
    const Value a = value_of(*e.parts[0].value), b = value_of(*e.parts[1].value);
    if (op == ":") {  // frames of KRL
        Expr product;
        product.kind = Expr::Kind::call;
        product.text = ":";
        product.parts = e.parts;
        return call(product);
    }
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
    if (op == "+") return Value::of(*x + *y);
    if (op == "-") return Value::of(*x - *y);
    if (op == "*") return Value::of(*x * *y);
    if (op == "/" && *y != 0) return Value::of(*x / *y);
    if (op == "div" && *y != 0) return Value::of(std::trunc(*x / *y));
    if ((op == "mod" || op == "%") && *y != 0) return Value::of(std::fmod(*x, *y));
    if (op == "==" || op == "=") return Value::of_truth(*x == *y);
    if (op == "<>" || op == "!=") return Value::of_truth(*x != *y);
    if (op == "<") return Value::of_truth(*x < *y);
    if (op == ">") return Value::of_truth(*x > *y);
    if (op == "<=") return Value::of_truth(*x <= *y);
    if (op == ">=") return Value::of_truth(*x >= *y);
    return Value::unknown(shown(e));
}

}  // namespace seamwright::program_path
