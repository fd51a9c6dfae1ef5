// Expressions: every name resolved, every type checked, constants computed.

#include <fmt/format.h>

#include <utility>

#include "devices/controllers/abb/rapid/rapid_linking.h"
#include "devices/controllers/abb/rapid/rapid_values.h"

namespace seamwright::rapid {

using Kind = Type::Kind;

namespace {

bool is_number(const Type* t) {
    return t->root()->kind == Kind::number || t->root()->kind == Kind::long_number;
}

}  // namespace

std::string shown(const Type* type, const std::vector<int>& dims) {
    std::string text = type ? type->name : "?";
    for (std::size_t i = 0; i < dims.size(); ++i) text += fmt::format("{}{}", i == 0 ? "{" : ",", dims[i]);
    return dims.empty() ? text : text + "}";
}

bool is_literal(const Expr& e) {
    switch (e.kind) {
        case Expr::Kind::number:
        case Expr::Kind::text:
        case Expr::Kind::truth:
            return true;
        case Expr::Kind::unary:
            return e.text == "-" && e.parts[0]->kind == Expr::Kind::number;
        case Expr::Kind::aggregate:
            for (const auto& part : e.parts)
                if (!is_literal(*part)) return false;
            return true;
        default:
            return false;
    }
}

Value constant_value(const Expr& e) {
    switch (e.kind) {
        case Expr::Kind::number:
        case Expr::Kind::truth: {
            Value v = make_value(e.type);
            v.number = e.type->root()->kind == Kind::number ? as_num(e.number) : e.number;
            return v;
        }
        case Expr::Kind::text: {
            Value v = make_value(e.type);
            v.text = e.text;
            return v;
        }
        case Expr::Kind::aggregate: {
            Value v = make_value(e.type, e.dims);
            if (e.dims.size() > 1) {
                std::size_t at = 0;
                for (const auto& part : e.parts)
                    for (Value& inner : constant_value(*part).parts) v.parts[at++] = std::move(inner);
                return v;
            }
            for (std::size_t i = 0; i < e.parts.size(); ++i) v.parts[i] = constant_value(*e.parts[i]);
            return v;
        }
        case Expr::Kind::unary:
            return apply_unary(e.text, constant_value(*e.parts[0]));
        case Expr::Kind::binary:
            return apply_binary(e.text, constant_value(*e.parts[0]), constant_value(*e.parts[1]));
        case Expr::Kind::name:
            if (e.data && e.data->storage == Storage::constant && e.data->value) return *e.data->value;
            break;
        case Expr::Kind::component:
            return constant_value(*e.parts[0]).parts[e.field];
        default:
            break;
    }
    throw LoadError(e.at, "this is no constant expression");
}

// What kind of data an expression refers to; nothing for a value.
std::optional<Linker::Local::Mode> Linker::reference(const Expr& e) const {
    if (e.kind == Expr::Kind::index || e.kind == Expr::Kind::component) return reference(*e.parts[0]);
    if (e.kind != Expr::Kind::name) return std::nullopt;
    if (const auto it = locals_.find(e.text); it != locals_.end()) return it->second.mode;
    return e.data->storage == Storage::variable     ? Local::Mode::variable
           : e.data->storage == Storage::persistent ? Local::Mode::persistent
                                                    : Local::Mode::constant;
}

void Linker::expect(const Expr& e, const Type* type, const std::vector<int>& dims) const {
    if (same(e.type, type) && e.dims == dims) return;
    throw LoadError(e.at, fmt::format("{} is wanted, this is {}", shown(type, dims), shown(e.type, e.dims)));
}

void Linker::check(Expr& e, const Type* wanted, const std::vector<int>& dims) {
    switch (e.kind) {
        case Expr::Kind::number:
            e.type = wanted && wanted->root()->kind == Kind::long_number ? wanted : number_;
            break;
        case Expr::Kind::truth:
            e.type = truth_;
            break;
        case Expr::Kind::text:
            e.type = text_;
            break;
        case Expr::Kind::aggregate:
            aggregate(e, wanted, dims);
            break;
        case Expr::Kind::name:
            name(e);
            break;
        case Expr::Kind::index:
            index(e);
            break;
        case Expr::Kind::component:
            component(e);
            break;
        case Expr::Kind::call:
            e.routine = find_routine(e.text, e.at);
            if (e.routine->kind != Routine::Kind::function)
                throw LoadError(e.at, fmt::format("{} is no function", e.routine->shown));
            arguments(*e.routine, e.arguments, e.at);
            e.type = e.routine->type;
            break;
        case Expr::Kind::unary:
            check(*e.parts[0], e.text == "not" ? truth_ : wanted);
            e.type = e.parts[0]->type;
            if (!e.parts[0]->dims.empty() || (e.text == "not" ? !same(e.type, truth_) : !is_number(e.type)))
                throw LoadError(
                    e.at, fmt::format("{} does not go with {}", e.text, shown(e.type, e.parts[0]->dims)));
            break;
        case Expr::Kind::binary:
            binary(e);
            break;
    }
}

void Linker::aggregate(Expr& e, const Type* wanted, const std::vector<int>& dims) {
    if (!wanted) throw LoadError(e.at, "an aggregate stands where no type is known");
    e.type = wanted;
    e.dims = dims;
    if (!dims.empty()) {
        if (e.parts.size() != static_cast<std::size_t>(dims[0]))
            throw LoadError(e.at,
                            fmt::format("{} elements stand where {} are wanted", e.parts.size(), dims[0]));
        const std::vector<int> rest(dims.begin() + 1, dims.end());
        for (auto& part : e.parts) {
            check(*part, wanted, rest);
            expect(*part, wanted, rest);
        }
        return;
    }
    const Type* record = wanted->root();
    if (record->kind != Kind::record) throw LoadError(e.at, fmt::format("{} is no record", wanted->name));
    if (record->fields.size() != e.parts.size())
        throw LoadError(e.at, fmt::format("{} components stand where {} has {}", e.parts.size(), wanted->name,
                                          record->fields.size()));
    for (std::size_t i = 0; i < e.parts.size(); ++i) {
        check_as(*e.parts[i], record->fields[i].type);
    }
}

void Linker::name(Expr& e) {
    if (const auto it = locals_.find(e.text); it != locals_.end()) {
        e.slot = it->second.slot;
        e.type = it->second.type;
        e.dims = it->second.dims;
        if (e.type->root()->kind == Kind::presence)
            throw LoadError(e.at, "a switch is asked by Present() only");
        return;
    }
    for (const std::map<std::string, Data*>* map :
         {&std::as_const(own_data_), &std::as_const(task_.data), &system_.data})
        if (const auto it = map->find(e.text); it != map->end()) {
            e.data = it->second;
            if (!e.data->value)
                throw LoadError(e.at, fmt::format("{} is used before it is declared", e.text));
            e.type = e.data->type;
            e.dims = e.data->sizes;
            return;
        }
    if (is_predefined(e.text) || own_routines_.count(e.text) + task_.routines.count(e.text) > 0)
        throw LoadError(e.at, fmt::format("{} is no data", e.text));
    throw LoadError(e.at, fmt::format("there is no data {}", e.text));
}

void Linker::index(Expr& e) {
    check(*e.parts[0], nullptr);
    if (e.parts[0]->dims.size() != e.parts.size() - 1)
        throw LoadError(e.at, "the number of indices is not that of the dimensions");
    for (std::size_t i = 1; i < e.parts.size(); ++i) {
        check_as(*e.parts[i], number_);
    }
    e.type = e.parts[0]->type;
}

void Linker::component(Expr& e) {
    check(*e.parts[0], nullptr);
    const Type* record = e.parts[0]->type->root();
    if (record->kind != Kind::record || !e.parts[0]->dims.empty())
        throw LoadError(e.at, fmt::format("{} has no component {}", record->name, e.text));
    for (e.field = 0; e.field < record->fields.size(); ++e.field)
        if (record->fields[e.field].name == e.text) break;
    if (e.field == record->fields.size())
        throw LoadError(e.at, fmt::format("{} has no component {}", record->name, e.text));
    e.type = record->fields[e.field].type;
}

void Linker::binary(Expr& e) {
    Expr &a = *e.parts[0], &b = *e.parts[1];
    check(a, nullptr);
    check(b, a.type);
    if (is_literal(a) && is_number(b.type)) check(a, b.type);
    const auto refuse = [&]() {
        throw LoadError(e.at, fmt::format("{} does not go with {} and {}", e.text, shown(a.type, a.dims),
                                          shown(b.type, b.dims)));
    };
    if (!same(a.type, b.type) || !a.dims.empty() || !b.dims.empty()) refuse();
    const std::string& sign = e.text;
    const Kind kind = a.type->root()->kind;
    if (sign == "and" || sign == "or" || sign == "xor") {
        if (kind != Kind::truth) refuse();
        e.type = truth_;
    } else if (sign == "=" || sign == "<>") {
        if (kind == Kind::opaque) refuse();
        e.type = truth_;
    } else if (sign == "<" || sign == ">" || sign == "<=" || sign == ">=") {
        if (!is_number(a.type)) refuse();
        e.type = truth_;
    } else if (sign == "+" && kind == Kind::text) {
        e.type = text_;
    } else {
        if (!is_number(a.type)) refuse();
        e.type = a.type->root();
    }
}

}  // namespace seamwright::rapid
