// Routines: their parameters and data, statements, and the arguments of what they call.

#include <fmt/format.h>

#include <optional>
#include <set>
#include <utility>

#include "devices/controllers/abb/rapid/rapid_linking.h"

namespace seamwright::rapid {

using Kind = Type::Kind;

void Linker::body(Routine& r) {
    locals_.clear();
    routine_ = &r;
    const auto add = [&](const std::string& name, const Place& at, Local local) {
        if (is_predefined(name)) throw LoadError(at, fmt::format("the name {} belongs to the system", name));
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

void Linker::block(Block& b) {
    for (auto& s : b) statement(*s);
}

void Linker::statement(Statement& s) {
    using K = Statement::Kind;
    switch (s.kind) {
        case K::assign:
            assign(s);
            break;
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
                check_as(*condition, truth_);
                block(inner);
            }
            block(s.otherwise);
            break;
        case K::loop_for:
            count_loop(s);
            break;
        case K::test:
            test(s);
            break;
        case K::give_back:
            if ((routine_->kind == Routine::Kind::function) != (s.value != nullptr))
                throw LoadError(s.at,
                                s.value ? "only a function returns a value" : "a function returns a value");
            if (s.value) check_as(*s.value, routine_->type);
            break;
        case K::raise:
            if (s.value) check_as(*s.value, number_);
            break;
        case K::connect:
            connect(s);
            break;
        case K::retry:
        case K::trynext:
        case K::exit:
            break;
    }
}

void Linker::assign(Statement& s) {
    check(*s.target, nullptr);
    const auto kind = reference(*s.target);
    if (!kind || *kind == Local::Mode::constant)
        throw LoadError(s.at, "what is assigned to is neither VAR nor PERS");
    if (s.target->type->root()->kind == Kind::opaque)
        throw LoadError(s.at, fmt::format("a {} cannot be assigned", s.target->type->name));
    check(*s.value, s.target->type, s.target->dims);
    expect(*s.value, s.target->type, s.target->dims);
}

void Linker::count_loop(Statement& s) {
    for (ExprPtr* e : {&s.value, &s.until, &s.step})
        if (*e) check_as(**e, number_);
    if (is_predefined(s.name))
        throw LoadError(s.at, fmt::format("the name {} belongs to the system", s.name));
    const auto before =
        locals_.find(s.name) == locals_.end() ? std::nullopt : std::optional<Local>(locals_.at(s.name));
    s.slot = routine_->slots++;
    locals_[s.name] = {s.slot, number_, {}, Local::Mode::constant};
    block(s.otherwise);
    locals_.erase(s.name);
    if (before) locals_[s.name] = *before;
}

void Linker::test(Statement& s) {
    check(*s.value, nullptr);
    for (auto& [values, inner] : s.cases) {
        for (auto& value : values) {
            check_as(*value, s.value->type);
            (void)constant_value(*value);
        }
        block(inner);
    }
    block(s.otherwise);
}

void Linker::connect(Statement& s) {
    check(*s.target, nullptr);
    if (s.target->kind != Expr::Kind::name || !s.target->data ||
        s.target->data->storage != Storage::variable || s.target->type->name != "intnum")
        throw LoadError(s.at, "CONNECT wants a VAR intnum of a module");
    s.routine = find_routine(s.name, s.at);
    if (s.routine->kind != Routine::Kind::trap)
        throw LoadError(s.at, fmt::format("{} is no trap", s.routine->shown));
}

const Routine* Linker::find_routine(const std::string& name, const Place& at) const {
    if (locals_.count(name) > 0) throw LoadError(at, fmt::format("{} is data, no routine", name));
    for (const std::map<std::string, Routine*>* map :
         {&own_routines_, &std::as_const(task_.routines), &system_.routines})
        if (const auto it = map->find(name); it != map->end()) return it->second;
    throw LoadError(at, fmt::format("there is no routine {}", name));
}

void Linker::arguments(const Routine& r, std::vector<Argument>& list, const Place& at) {
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
            while (i < r.parameters.size() && r.parameters[i].optional && r.parameters[i].name != a.name) ++i;
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
            throw LoadError(at,
                            fmt::format("the argument {} of {} is missing", r.parameters[i].name, r.shown));
}

void Linker::argument(const Routine& r, const Parameter& p, Argument& a) {
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
        refuse(fmt::format("{} is wanted, this is {}", p.type->name, shown(a.value->type, a.value->dims)));
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

}  // namespace seamwright::rapid
