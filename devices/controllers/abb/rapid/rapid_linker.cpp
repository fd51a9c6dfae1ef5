#include "devices/controllers/abb/rapid/rapid_linker.h"

#include <fmt/format.h>

#include <cmath>

#include "devices/controllers/abb/rapid/rapid_linking.h"
#include "devices/controllers/abb/rapid/rapid_values.h"

namespace seamwright::rapid {

using Kind = Type::Kind;

void Linker::link() {
    claim_names();
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

// One name a thing, and what the whole task sees.
void Linker::claim_names() {
    std::map<std::string, Place> global;
    const auto claim = [&](std::map<std::string, Place>& names, const std::string& name,
                           const std::string& as_written, const Place& at) {
        if (is_predefined(name))
            throw LoadError(at, fmt::format("the name {} belongs to the system", as_written));
        if (const auto known = names.find(name); known != names.end())
            throw LoadError(at, fmt::format("the name {} is declared twice (also in {}, line {})", as_written,
                                            known->second.file, known->second.line));
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
}

void Linker::declare(Data& d) {
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

void Linker::head(Routine& r) {
    if (r.kind == Routine::Kind::function) r.type = type_of(r.type_name, r.at);
    for (Parameter& p : r.parameters) p.type = type_of(p.type_name, r.at);
}

const Type* Linker::type_of(const std::string& name, const Place& at) const {
    const auto it = system_.types.find(name);
    if (it == system_.types.end()) throw LoadError(at, fmt::format("there is no type {}", name));
    return it->second;
}

void Linker::share(Data& d) {
    SharedPersistent& common = shared_[d.name];
    if (!common.value) {
        common = {d.value, d.initial != nullptr, d.at};
        return;
    }
    if (!same(common.value->type, d.type) || common.value->dims != d.sizes)
        throw LoadError(d.at, fmt::format("PERS {} is {} here and {} in {}", d.shown, shown(d.type, d.sizes),
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

void Linker::enter(Module& m) {
    own_data_.clear();
    own_routines_.clear();
    for (auto& d : m.data) own_data_[d->name] = d.get();
    for (auto& r : m.routines) own_routines_[r->name] = r.get();
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
    linker.link();
    return task;
}

}  // namespace seamwright::rapid
