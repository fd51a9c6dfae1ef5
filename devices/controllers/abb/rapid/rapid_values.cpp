#include "devices/controllers/abb/rapid/rapid_values.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace seamwright::rapid {

double as_num(double value) {
    return static_cast<double>(static_cast<float>(value));
}

Value make_value(const Type* type, const std::vector<int>& dims) {
    Value v;
    v.type = type;
    v.dims = dims;
    if (!dims.empty()) {
        std::size_t count = 1;
        for (const int n : dims) count *= static_cast<std::size_t>(n);
        v.parts.assign(count, make_value(type));
    } else if (type->root()->kind == Type::Kind::record) {
        for (const Type::Field& field : type->root()->fields) v.parts.push_back(make_value(field.type));
    }
    return v;
}

void store(Value& target, const Value& from) {
    target.number =
        target.type && target.type->root()->kind == Type::Kind::number ? as_num(from.number) : from.number;
    target.text = from.text;
    target.object = from.object;
    if (target.parts.size() != from.parts.size()) {
        target.parts = from.parts;
        target.dims = from.dims;
        return;
    }
    for (std::size_t i = 0; i < target.parts.size(); ++i) store(target.parts[i], from.parts[i]);
}

bool same_value(const Value& a, const Value& b) {
    if (a.number != b.number || a.text != b.text || a.parts.size() != b.parts.size()) return false;
    for (std::size_t i = 0; i < a.parts.size(); ++i)
        if (!same_value(a.parts[i], b.parts[i])) return false;
    return true;
}

Value apply_unary(const std::string& sign, const Value& a) {
    Value v = a;
    v.number = sign == "not" ? (a.number != 0 ? 0 : 1) : -a.number;
    return v;
}

Value apply_binary(const std::string& sign, const Value& a, const Value& b) {
    static const Type truth{"bool", Type::Kind::truth, nullptr, {}};
    const auto truthful = [&](bool yes) {
        Value v = make_value(&truth);
        v.number = yes ? 1 : 0;
        return v;
    };
    if (sign == "=") return truthful(same_value(a, b));
    if (sign == "<>") return truthful(!same_value(a, b));
    if (sign == "<") return truthful(a.number < b.number);
    if (sign == ">") return truthful(a.number > b.number);
    if (sign == "<=") return truthful(a.number <= b.number);
    if (sign == ">=") return truthful(a.number >= b.number);
    if (sign == "and") return truthful(a.number != 0 && b.number != 0);
    if (sign == "or") return truthful(a.number != 0 || b.number != 0);
    if (sign == "xor") return truthful((a.number != 0) != (b.number != 0));
    Value v = make_value(a.type->root());
    if (a.type->root()->kind == Type::Kind::text) {
        v.text = a.text + b.text;
        if (v.text.size() > kLongestString)
            throw std::runtime_error(fmt::format("a string of {} characters is too long", v.text.size()));
        return v;
    }
    if (sign == "+") v.number = a.number + b.number;
    if (sign == "-") v.number = a.number - b.number;
    if (sign == "*") v.number = a.number * b.number;
    if (sign == "/" || sign == "div" || sign == "mod") {
        if (b.number == 0) throw std::runtime_error("division by zero");
        if (sign == "/") {
            v.number = a.number / b.number;
        } else {
            if (a.number != std::floor(a.number) || b.number != std::floor(b.number))
                throw std::runtime_error(sign + " wants whole numbers");
            v.number = sign == "div" ? std::trunc(a.number / b.number) : std::fmod(a.number, b.number);
        }
    }
    if (v.type->kind == Type::Kind::number) v.number = as_num(v.number);
    return v;
}

}  // namespace seamwright::rapid
