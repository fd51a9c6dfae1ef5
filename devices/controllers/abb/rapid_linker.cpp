#include "devices/controllers/abb/rapid_linker.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <set>
#include <utility>

namespace seamwright::rapid {
namespace {

using Kind = Type::Kind;

bool same(const Type* a, const Type* b) {
    return a && b && a->root() == b->root();
}

std::string shown(const Type* type, const std::vector<int>& dims) {
    std::string text = type ? type->name : "?";
    for (std::size_t i = 0; i < dims.size(); ++i) text += fmt::format("{}{}", i == 0 ? "{" : ",", dims[i]);
    return dims.empty() ? text : text + "}";
}

// A literal, or an aggregate of literals.
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

class Linker {
  public:
    Linker(TaskProgram& task, const InstructionSet& system, Persistents& shared)
        : task_(task), system_(system), shared_(shared) {}

    void link() {
        std::map<std::string, Place> global;
        const auto claim = [&](std::map<std::string, Place>& names, const std::string& name,
                               const std::string& as_written, const Place& at) {
            if (is_predefined(name))
                throw LoadError(at, fmt::format("the name {} belongs to the system", as_written));
            if (const auto known = names.find(name); known != names.end())
                throw LoadError(at, fmt::format("the name {} is declared twice (also in {}, line {})",
                                                as_written, known->second.file, known->second.line));
            names[name] = at;
        };
        for (auto& m : task_.modules) claim(global, m->name, m->shown, m->at);
        for (auto& m : task_.modules) {
            if (!m->types.empty())
                throw LoadError(m->at, "the interpreter does not know records of a program's own");
            std::map<std::string, Place> local{{m->name, m->at}};
            for (auto& d : m->data) {
                claim(local, d->name, d->shown, d->at);
                if (d->scope == Data::Scope::local) continue;
                claim(global, d->name, d->shown, d->at);
                task_.data[d->name] = d.get();
            }
            for (auto& r : m->routines) {
                claim(local, r->name, r->shown, r->at);
                if (r->local) continue;
                claim(global, r->name, r->shown, r->at);
                task_.routines[r->name] = r.get();
            }
        }
        for (auto& m : task_.modules) {
            enter(*m);
            for (auto& d : m->data) declare(*d);
        }
        for (auto& m : task_.modules) {
            enter(*m);
            for (auto& r : m->routines) head(*r);
        }
        for (auto& m : task_.modules) {
            enter(*m);
            for (auto& r : m->routines) body(*r);
        }
    }

    void declare(Data& d) {
        d.type = type_of(d.type_name, d.at);
        for (auto& dim : d.dims) {
            check(*dim, number_);
            const double n = constant_value(*dim).number;
            if (n < 1 || n != std::floor(n)) throw LoadError(d.at, "an array has a whole number of elements");
            d.sizes.push_back(static_cast<int>(n));
        }
        if (d.type->root()->kind == Kind::opaque && d.storage != Storage::variable)
            throw LoadError(d.at, fmt::format("{} is declared as VAR only", d.type->name));
        d.value = std::make_shared<Value>(make_value(d.type, d.sizes));
        if (d.initial) {
            if (d.storage == Storage::persistent && !is_literal(*d.initial))
                throw LoadError(d.at, "the initial value of a PERS is a literal");
            check(*d.initial, d.type, d.sizes);
            expect(*d.initial, d.type, d.sizes);
            *d.value = constant_value(*d.initial);
            d.value->type = d.type;
        }
        if (d.storage == Storage::persistent && d.scope == Data::Scope::global) share(d);
    }

    void head(Routine& r) {
        if (r.kind == Routine::Kind::function) r.type = type_of(r.type_name, r.at);
        for (Parameter& p : r.parameters) p.type = type_of(p.type_name, r.at);
    }
    void set_basic(const Type* number, const Type* truth, const Type* text) {
        number_ = number;
        truth_ = truth;
        text_ = text;
    }

  private:
    struct Local {
        int slot;
        const Type* type;
        std::vector<int> dims;
        enum class Mode { variable, constant, inout, persistent, optional_in } mode;
        bool optional = false;
    };

    bool is_predefined(const std::string& name) const {
        return system_.types.count(name) + system_.data.count(name) + system_.routines.count(name) > 0;
    }
    const Type* type_of(const std::string& name, const Place& at) const {
        const auto it = system_.types.find(name);
        if (it == system_.types.end()) throw LoadError(at, fmt::format("there is no type {}", name));
        return it->second;
    }

    void share(Data& d) {
        SharedPersistent& common = shared_[d.name];
        if (!common.value) {
            common = {d.value, d.initial != nullptr, d.at};
            return;
        }
        if (!same(common.value->type, d.type) || common.value->dims != d.sizes)
            throw LoadError(d.at,
                            fmt::format("PERS {} is {} here and {} in {}", d.shown, shown(d.type, d.sizes),
                                        shown(common.value->type, common.value->dims), common.at.file));
        if (d.initial && common.has_initial && !same_value(*d.value, *common.value))
            throw LoadError(d.at,
                            fmt::format("PERS {} has another initial value in {}", d.shown, common.at.file));
        if (d.initial) {
            store(*common.value, *d.value);
            common.has_initial = true;
        }
        d.value = common.value;
    }

    void enter(Module& m) {
        own_data_.clear();
        own_routines_.clear();
        for (auto& d : m.data) own_data_[d->name] = d.get();
        for (auto& r : m.routines) own_routines_[r->name] = r.get();
    }

    void body(Routine& r) {
        locals_.clear();
        routine_ = &r;
        const auto add = [&](const std::string& name, const Place& at, Local local) {
            if (is_predefined(name))
                throw LoadError(at, fmt::format("the name {} belongs to the system", name));
            local.slot = r.slots++;
            if (!locals_.emplace(name, std::move(local)).second)
                throw LoadError(at, fmt::format("the name {} is declared twice", name));
        };
        for (const Parameter& p : r.parameters) {
            using Mode = Local::Mode;
            const Mode mode = p.mode == Parameter::Mode::in           ? Mode::variable
                              : p.mode == Parameter::Mode::persistent ? Mode::persistent
                              : p.mode == Parameter::Mode::inout      ? Mode::inout
                                                                      : Mode::variable;
            add(p.name, r.at,
                {0, p.type, std::vector<int>(static_cast<std::size_t>(p.dims), -1), mode, p.optional});
        }
        for (auto& d : r.data) {
            declare(*d);
            add(d->name, d->at,
                {0, d->type, d->sizes,
                 d->storage == Storage::constant ? Local::Mode::constant : Local::Mode::variable});
            d->slot = locals_.at(d->name).slot;
        }
        block(r.body);
        block(r.handler);
    }

    void block(Block& b) {
        for (auto& s : b) statement(*s);
    }

    void statement(Statement& s) {
        using K = Statement::Kind;
        switch (s.kind) {
            case K::assign: {
                check(*s.target, nullptr);
                const auto kind = reference(*s.target);
                if (!kind || *kind == Local::Mode::constant)
                    throw LoadError(s.at, "what is assigned to is neither VAR nor PERS");
                if (s.target->type->root()->kind == Kind::opaque)
                    throw LoadError(s.at, fmt::format("a {} cannot be assigned", s.target->type->name));
                check(*s.value, s.target->type, s.target->dims);
                expect(*s.value, s.target->type, s.target->dims);
                break;
            }
            case K::call: {
                s.routine = find_routine(s.name, s.at);
                if (s.routine->kind != Routine::Kind::procedure)
                    throw LoadError(s.at, fmt::format("{} is no procedure", s.routine->shown));
                arguments(*s.routine, s.arguments, s.at);
                break;
            }
            case K::branch:
            case K::loop_while:
                for (auto& [condition, inner] : s.branches) {
                    check(*condition, truth_);
                    expect(*condition, truth_, {});
                    block(inner);
                }
                block(s.otherwise);
                break;
            case K::loop_for: {
                for (ExprPtr* e : {&s.value, &s.until, &s.step}) {
                    if (!*e) continue;
                    check(**e, number_);
                    expect(**e, number_, {});
                }
                if (is_predefined(s.name))
                    throw LoadError(s.at, fmt::format("the name {} belongs to the system", s.name));
                const auto before = locals_.find(s.name) == locals_.end()
                                        ? std::nullopt
                                        : std::optional<Local>(locals_.at(s.name));
                s.slot = routine_->slots++;
                locals_[s.name] = {s.slot, number_, {}, Local::Mode::constant};
                block(s.otherwise);
                locals_.erase(s.name);
                if (before) locals_[s.name] = *before;
                break;
            }
            case K::test:
                check(*s.value, nullptr);
                for (auto& [values, inner] : s.cases) {
                    for (auto& value : values) {
                        check(*value, s.value->type);
                        expect(*value, s.value->type, {});
                        (void)constant_value(*value);
                    }
                    block(inner);
                }
                block(s.otherwise);
                break;
            case K::give_back:
                if ((routine_->kind == Routine::Kind::function) != (s.value != nullptr))
                    throw LoadError(
                        s.at, s.value ? "only a function returns a value" : "a function returns a value");
                if (s.value) {
                    check(*s.value, routine_->type);
                    expect(*s.value, routine_->type, {});
                }
                break;
            case K::raise:
                if (s.value) {
                    check(*s.value, number_);
                    expect(*s.value, number_, {});
                }
                break;
            case K::connect: {
                check(*s.target, nullptr);
                if (s.target->kind != Expr::Kind::name || !s.target->data ||
                    s.target->data->storage != Storage::variable || s.target->type->name != "intnum")
                    throw LoadError(s.at, "CONNECT wants a VAR intnum of a module");
                s.routine = find_routine(s.name, s.at);
                if (s.routine->kind != Routine::Kind::trap)
                    throw LoadError(s.at, fmt::format("{} is no trap", s.routine->shown));
                break;
            }
            case K::retry:
            case K::trynext:
            case K::exit:
                break;
        }
    }

    const Routine* find_routine(const std::string& name, const Place& at) const {
        if (locals_.count(name) > 0) throw LoadError(at, fmt::format("{} is data, no routine", name));
        for (const std::map<std::string, Routine*>* map :
             {&own_routines_, &std::as_const(task_.routines), &system_.routines})
            if (const auto it = map->find(name); it != map->end()) return it->second;
        throw LoadError(at, fmt::format("there is no routine {}", name));
    }

    void arguments(const Routine& r, std::vector<Argument>& list, const Place& at) {
        std::set<std::size_t> given;
        std::size_t next = 0;  // first parameter that may come
        for (Argument& a : list) {
            std::size_t i = next;
            if (a.name.empty()) {
                while (i < r.parameters.size() && r.parameters[i].optional) ++i;
                if (i == r.parameters.size())
                    throw LoadError(a.at, fmt::format("{} takes fewer arguments", r.shown));
                next = i + 1;
            } else {
                while (i < r.parameters.size() && r.parameters[i].optional && r.parameters[i].name != a.name)
                    ++i;
                if (i == r.parameters.size() || r.parameters[i].name != a.name)
                    throw LoadError(a.at, fmt::format("{} has no argument \\{} here", r.shown, a.name));
            }
            const Parameter& p = r.parameters[i];
            for (const std::size_t other : given)
                if (other == i || (p.optional && r.parameters[other].choice == p.choice))
                    throw LoadError(a.at, fmt::format("the arguments \\{} and \\{} of {} exclude each other",
                                                      r.parameters[other].name, p.name, r.shown));
            given.insert(i);
            a.parameter = i;
            argument(r, p, a);
        }
        for (std::size_t i = 0; i < r.parameters.size(); ++i)
            if (!r.parameters[i].optional && given.count(i) == 0)
                throw LoadError(
                    at, fmt::format("the argument {} of {} is missing", r.parameters[i].name, r.shown));
    }

    void argument(const Routine& r, const Parameter& p, Argument& a) {
        const auto refuse = [&](const std::string& why) {
            throw LoadError(a.at, fmt::format("argument {} of {}: {}", p.name, r.shown, why));
        };
        if ((p.type->root()->kind == Kind::presence) != (a.value == nullptr) && r.name != "present")
            refuse(a.value ? "a switch takes no value" : "a value is missing");
        if (!a.value) return;
        if (r.name == "present") {
            const auto it = a.value->kind == Expr::Kind::name ? locals_.find(a.value->text) : locals_.end();
            if (it == locals_.end() || !it->second.optional) refuse("an optional parameter is wanted");
            a.value->slot = it->second.slot;
            a.value->type = it->second.type;
            return;
        }
        const bool any = p.type->root()->kind == Kind::any;
        check(*a.value, any ? nullptr : p.type);
        if (!any && !same(a.value->type, p.type))
            refuse(
                fmt::format("{} is wanted, this is {}", p.type->name, shown(a.value->type, a.value->dims)));
        if (!any && a.value->dims.size() != static_cast<std::size_t>(p.dims))
            refuse("the number of dimensions differs");
        if (p.mode == Parameter::Mode::in) return;
        using Mode = Local::Mode;
        const auto kind = reference(*a.value);
        const bool good = kind && (p.mode == Parameter::Mode::persistent ? *kind == Mode::persistent
                                   : p.mode == Parameter::Mode::variable ? *kind == Mode::variable
                                                                         : *kind != Mode::constant);
        if (!good)
            refuse(p.mode == Parameter::Mode::persistent ? "a PERS is wanted"
                   : p.mode == Parameter::Mode::variable ? "a VAR is wanted"
                                                         : "a VAR or PERS is wanted");
    }

    // What kind of data an expression refers to; nothing for a value.
    std::optional<Local::Mode> reference(const Expr& e) const {
        if (e.kind == Expr::Kind::index || e.kind == Expr::Kind::component) return reference(*e.parts[0]);
        if (e.kind != Expr::Kind::name) return std::nullopt;
        if (const auto it = locals_.find(e.text); it != locals_.end()) return it->second.mode;
        return e.data->storage == Storage::variable     ? Local::Mode::variable
               : e.data->storage == Storage::persistent ? Local::Mode::persistent
                                                        : Local::Mode::constant;
    }

    void expect(const Expr& e, const Type* type, const std::vector<int>& dims) const {
        if (same(e.type, type) && e.dims == dims) return;
        throw LoadError(e.at,
                        fmt::format("{} is wanted, this is {}", shown(type, dims), shown(e.type, e.dims)));
    }

    void check(Expr& e, const Type* wanted, const std::vector<int>& dims = {}) {
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
                check(*e.parts[0], nullptr);
                if (e.parts[0]->dims.size() != e.parts.size() - 1)
                    throw LoadError(e.at, "the number of indices is not that of the dimensions");
                for (std::size_t i = 1; i < e.parts.size(); ++i) {
                    check(*e.parts[i], number_);
                    expect(*e.parts[i], number_, {});
                }
                e.type = e.parts[0]->type;
                break;
            case Expr::Kind::component: {
                check(*e.parts[0], nullptr);
                const Type* record = e.parts[0]->type->root();
                if (record->kind != Kind::record || !e.parts[0]->dims.empty())
                    throw LoadError(e.at, fmt::format("{} has no component {}", record->name, e.text));
                for (e.field = 0; e.field < record->fields.size(); ++e.field)
                    if (record->fields[e.field].name == e.text) break;
                if (e.field == record->fields.size())
                    throw LoadError(e.at, fmt::format("{} has no component {}", record->name, e.text));
                e.type = record->fields[e.field].type;
                break;
            }
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
                if (!e.parts[0]->dims.empty() ||
                    (e.text == "not" ? !same(e.type, truth_) : !is_number(e.type)))
                    throw LoadError(
                        e.at, fmt::format("{} does not go with {}", e.text, shown(e.type, e.parts[0]->dims)));
                break;
            case Expr::Kind::binary:
                binary(e);
                break;
        }
    }

    static bool is_number(const Type* t) {
        return t->root()->kind == Kind::number || t->root()->kind == Kind::long_number;
    }

    void aggregate(Expr& e, const Type* wanted, const std::vector<int>& dims) {
        if (!wanted) throw LoadError(e.at, "an aggregate stands where no type is known");
        e.type = wanted;
        e.dims = dims;
        if (!dims.empty()) {
            if (e.parts.size() != static_cast<std::size_t>(dims[0]))
                throw LoadError(
                    e.at, fmt::format("{} elements stand where {} are wanted", e.parts.size(), dims[0]));
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
            throw LoadError(e.at, fmt::format("{} components stand where {} has {}", e.parts.size(),
                                              wanted->name, record->fields.size()));
        for (std::size_t i = 0; i < e.parts.size(); ++i) {
            check(*e.parts[i], record->fields[i].type);
            expect(*e.parts[i], record->fields[i].type, {});
        }
    }

    void name(Expr& e) {
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

    void binary(Expr& e) {
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

    TaskProgram& task_;
    const InstructionSet& system_;
    Persistents& shared_;
    std::map<std::string, Data*> own_data_;
    std::map<std::string, Routine*> own_routines_;
    std::map<std::string, Local> locals_;
    Routine* routine_ = nullptr;
    const Type *number_ = nullptr, *truth_ = nullptr, *text_ = nullptr;
};

void set_basic(Linker& linker, const InstructionSet& system) {
    linker.set_basic(system.types.at("num"), system.types.at("bool"), system.types.at("string"));
}

}  // namespace

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

InstructionSet make_instruction_set(const std::string& text,
                                    const std::map<std::string, std::string>& signals) {
    InstructionSet set;
    set.module = parse_module(text, "instruction set", true);
    const auto basic = [&](const char* name, Type::Kind kind) {
        set.basic.push_back(std::make_unique<Type>(Type{name, kind, nullptr, {}}));
        set.types[name] = set.basic.back().get();
    };
    basic("num", Type::Kind::number);
    basic("dnum", Type::Kind::long_number);
    basic("bool", Type::Kind::truth);
    basic("string", Type::Kind::text);
    basic("switch", Type::Kind::presence);
    basic("anytype", Type::Kind::any);
    for (const char* name :
         {"socketdev", "triggdata", "rawbytes", "signaldo", "signaldi", "clock", "egmident", "mecunit"})
        basic(name, Type::Kind::opaque);
    Module& m = *set.module;
    for (std::size_t i = 0; i < m.types.size(); ++i) {
        Type& t = *m.types[i];
        if (!m.type_alias[i].empty()) {
            t.alias_of = set.types.at(m.type_alias[i]);
            t.kind = t.alias_of->kind;
        }
        for (const auto& [type, field] : m.type_fields[i]) t.fields.push_back({field, set.types.at(type)});
        set.types[t.name] = &t;
    }
    TaskProgram none;
    Persistents own;
    Linker linker(none, set, own);
    set_basic(linker, set);
    for (auto& d : m.data) {
        linker.declare(*d);
        set.data[d->name] = d.get();
    }
    for (auto& r : m.routines) {
        linker.head(*r);
        r->native = static_cast<int>(set.routines.size());
        set.routines[r->name] = r.get();
    }
    for (const auto& [name, type] : signals) {
        m.data.push_back(std::make_unique<Data>());
        Data& d = *m.data.back();
        d.name = folded(name);
        d.shown = name;
        d.type = set.types.at(type);
        d.storage = Storage::variable;  // as instructions want it
        d.value = std::make_shared<Value>(make_value(d.type));
        d.value->text = d.name;
        set.data[d.name] = &d;
    }
    return set;
}

const Data* TaskProgram::find(const std::string& path) const {
    const std::size_t dot = path.find('.');
    if (dot == std::string::npos) {
        const auto it = data.find(folded(path));
        return it == data.end() ? nullptr : it->second;
    }
    for (const auto& m : modules)
        if (m->name == folded(path.substr(0, dot)))
            for (const auto& d : m->data)
                if (d->name == folded(path.substr(dot + 1))) return d.get();
    return nullptr;
}

TaskProgram link_task(const std::string& name, const std::vector<SourceText>& sources,
                      const InstructionSet& system, Persistents& shared) {
    TaskProgram task;
    task.name = name;
    for (const SourceText& source : sources) task.modules.push_back(parse_module(source.text, source.file));
    Linker linker(task, system, shared);
    set_basic(linker, system);
    linker.link();
    return task;
}

}  // namespace seamwright::rapid
