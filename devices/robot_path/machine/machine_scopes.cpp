// What a name means: variables of routines, modules and all of them, what routines are given and give back.

#include <algorithm>
#include <cmath>
#include <utility>

#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {
namespace {

constexpr long kLargestIndex = 100'000;  // of an array that is filled element by element
constexpr std::size_t kStepsOfElement = 2;
constexpr std::size_t kDeepestCalls = 30;

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

bool is_place(const Expr& e) {
    return e.kind == Expr::Kind::name || e.kind == Expr::Kind::index || e.kind == Expr::Kind::component;
}

}  // namespace

Value::Type Machine::type_of(const std::string& /*component*/) const {
    return Value::Type::any;
}

// ---- routines

void Machine::add_routine(Routine routine) {
    if (routine.name.empty()) return;
    const auto [from, to] = routines_.equal_range(routine.name);
    const auto module_of = [&](const Routine& r) { return modules_of_[static_cast<std::size_t>(r.file)]; };
    if (std::any_of(from, to, [&](const auto& r) { return module_of(r.second) == module_of(routine); }))
        return;
    const std::string name = routine.name;
    routines_.emplace(name, std::move(routine));
}

const Routine* Machine::routine(const std::string& name, int file) const {
    const Routine* found = nullptr;
    const auto [from, to] = routines_.equal_range(name);
    for (auto at = from; at != to; ++at) {
        const Routine& r = at->second;
        if (modules_of_[static_cast<std::size_t>(r.file)] == modules_of_[static_cast<std::size_t>(file)])
            return &r;
        if (!r.own && !found) found = &r;
    }
    return found;
}

const Parameter* Machine::parameter_of(const Routine& routine, const Argument& a, std::size_t& place) {
    const auto& all = routine.parameters;
    if (a.optional || !a.name.empty()) {
        const auto at = std::find_if(all.begin(), all.end(), [&](const Parameter& p) {
            return p.name == a.name && p.optional == a.optional;
        });
        return at == all.end() ? nullptr : &*at;
    }
    while (place < all.size() && all[place].optional) ++place;
    return place < all.size() ? &all[place++] : nullptr;
}

Machine::Scope Machine::scope_of(const Routine& routine, const std::vector<Argument>& arguments) {
    Scope scope;
    scope.routine = &routine;
    for (const Parameter& p : routine.parameters)
        scope.values[p.name] = p.otherwise ? value_of(*p.otherwise) : Value::unknown(p.name);
    std::size_t place = 0;
    for (const Argument& a : arguments) {
        const Parameter* p = parameter_of(routine, a, place);
        if (!p || !a.value) continue;
        const ExprPtr given = p->way == Parameter::Way::reference ? frozen(*a.value) : nullptr;
        if (given) {
            scope.values.erase(p->name);
            scope.given[p->name] = {given, depth_, now_file_};
            continue;
        }
        Value& value = scope.values[p->name] = value_of(*a.value);
        value.constant = false;
    }
    return scope;
}

// What a routine may have given a value to, and nobody knows which.
void Machine::lose_given(const Routine& routine, const std::vector<Argument>& arguments, const Scope& before,
                         const Scope& after) {
    std::size_t place = 0;
    for (const Argument& a : arguments) {
        const Parameter* p = parameter_of(routine, a, place);
        if (!p || !a.value || !is_place(*a.value) || p->way == Parameter::Way::value) continue;
        const auto was = before.values.find(p->name), is = after.values.find(p->name);
        if (was == before.values.end() || is == after.values.end()) continue;  // its own place
        Value now = is->second;
        now.type = was->second.type;
        if (p->way == Parameter::Way::reference || !(now == was->second)) lose({a});
    }
}

void Machine::lose(const std::vector<Argument>& arguments) {
    for (const Argument& a : arguments) {
        if (!a.value || !is_place(*a.value)) continue;
        const Value* root = variable(root_of(*a.value));
        if (!root || root->constant) continue;
        if (const Value* now = find(*a.value); now && !now->known()) continue;
        assign(*a.value, Value::unknown(shown(*a.value) + "?"));
    }
}

bool Machine::enter(const std::string& name, const std::vector<Argument>& arguments, Flow& flow,
                    Value* result) {
    const Routine* entered = routine(name, now_file_);
    if (!entered) return false;
    if (scopes_.size() >= kDeepestCalls) {
        too_long_ = true;
        flow = Flow::halt;
        return true;
    }
    const Scope before = scope_of(*entered, arguments);
    const std::size_t depth = depth_;
    const int file = now_file_, line = now_line_;
    Value returned = std::exchange(returned_, Value::unknown(name));
    const bool in_doubt_before = std::exchange(returned_in_doubt_, doubt_ > 0);
    const int doubt = doubt_;
    const Text why = doubt_why_;
    scopes_.push_back(before);
    depth_ = scopes_.size();
    flow = run_block(entered->body) == Flow::halt ? Flow::halt : Flow::on;
    doubt_ = doubt;
    doubt_why_ = why;
    over_ = over_ || (flow == Flow::halt && doubt_ == 0);
    const Scope after = std::move(scopes_.back());
    scopes_.pop_back();
    depth_ = depth;
    now_file_ = file, now_line_ = line;
    if (result) {
        *result = returned_in_doubt_ ? Value::unknown(name) : std::move(returned_);
        Value typed;
        typed.type = entered->returns;
        put_in(typed, std::move(*result), name);
        *result = std::move(typed);
    }
    returned_ = std::move(returned);
    returned_in_doubt_ = in_doubt_before;
    lose_given(*entered, arguments, before, after);
    return true;
}

bool Machine::in_moving_routine() {
    if (depth_ == 0) return false;
    const Routine* routine = scopes_[depth_ - 1].routine;
    const auto [at, fresh] = moving_.try_emplace(routine, false);
    std::set<std::string> seen;
    if (fresh) at->second = holds_motion(routine->body, seen);
    return at->second;
}

// Where it hangs on the cell, so do the motions behind it.
void Machine::note_jump() {
    if (doubt_ > 0 && in_moving_routine())
        note(LineKind::not_understood, doubt_why_);
    else
        note(LineKind::understood);
}

Machine::Flow Machine::turn_over() {
    note_jump();
    return Flow::again;
}

Machine::Flow Machine::leave_loop() {
    if (counted_)
        note_jump();
    else
        note(LineKind::understood);  // a loop that the cell ends
    return Flow::leave;
}

Machine::Flow Machine::give_back(const Value& result) {
    note_jump();
    returned_ = result;
    returned_in_doubt_ = returned_in_doubt_ || doubt_ > 0;
    return Flow::back;
}

// ---- names

const Machine::Given* Machine::given_as(const std::string& name) const {
    if (depth_ == 0) return nullptr;
    const Scope& scope = scopes_[depth_ - 1];
    const auto at = scope.given.find(name);
    return at == scope.given.end() || scope.values.count(name) > 0 ? nullptr : &at->second;
}

// As who gave it sees it.
template <class Function>
auto Machine::as_given(const Given& given, Function function) {
    const std::size_t depth = std::exchange(depth_, given.depth);
    const int file = std::exchange(now_file_, given.file);
    auto result = function(*given.place);
    depth_ = depth;
    now_file_ = file;
    return result;
}

bool Machine::is_parameter(const std::string& name) const {
    return given_as(name) != nullptr || (depth_ > 0 && scopes_[depth_ - 1].values.count(name) > 0);
}

// What is given by reference has its type.
void Machine::type_parameter(const std::string& name, Value::Type type) {
    const auto at = scopes_[depth_ - 1].values.find(name);
    if (at == scopes_[depth_ - 1].values.end()) return;
    Value typed;
    typed.type = type;
    put_in(typed, std::move(at->second), name);
    at->second = std::move(typed);
}

std::string Machine::root_of(const Expr& place) const {
    const Expr* e = &place;
    std::size_t depth = depth_;
    for (;;) {
        while (e->of) e = e->of.get();
        if (depth == 0) return e->text;
        const Scope& scope = scopes_[depth - 1];
        const auto at = scope.given.find(e->text);
        if (at == scope.given.end() || scope.values.count(e->text) > 0) return e->text;
        e = at->second.place.get();
        depth = at->second.depth;
    }
}

// KRL says in a data list which names are a module's own. Where a list is not among the files, a name that nobody declares may
// be of that module alone.
bool Machine::shared(const std::string& name) const {
    const auto at = undeclared_.find(name);
    return at == undeclared_.end() || at->second == module() ||
           (with_data_.count(at->second) > 0 && with_data_.count(module()) > 0);
}

const Value* Machine::variable(const std::string& name) {
    if (volatile_.count(name) > 0) return nullptr;
    if (const Given* given = given_as(name))
        return as_given(*given, [&](const Expr& place) { return find(place); });
    if (depth_ > 0) {
        const auto& own = scopes_[depth_ - 1].values;
        if (const auto at = own.find(name); at != own.end()) return &at->second;
    }
    const auto& module_values = modules_[static_cast<std::size_t>(module())];
    if (const auto at = module_values.find(name); at != module_values.end()) return &at->second;
    const auto global = globals_.find(name);
    return global == globals_.end() || !shared(name) ? nullptr : &global->second;
}

// The variable that is given a value.
Value* Machine::home(const std::string& name) {
    if (const Given* given = given_as(name))
        return as_given(*given, [&](const Expr& place) { return slot(place); });
    if (depth_ > 0) {
        auto& own = scopes_[depth_ - 1].values;
        if (const auto at = own.find(name); at != own.end()) return &at->second;
    }
    auto& module_values = modules_[static_cast<std::size_t>(module())];
    if (const auto at = module_values.find(name); at != module_values.end()) return &at->second;
    const auto [at, fresh] = globals_.try_emplace(name);
    if (fresh && dialect_ == Dialect::krl && !name.starts_with('$'))
        undeclared_[name] = module();
    else if (!shared(name))
        volatile_.insert(name);
    return &at->second;
}

void Machine::declare(const std::string& name, Value value, Reach reach) {
    if (reach == Reach::routine && depth_ > 0) {
        scopes_[depth_ - 1].values[name] = std::move(value);
        return;
    }
    auto& values = reach == Reach::all ? globals_ : modules_[static_cast<std::size_t>(module())];
    const auto [at, fresh] = values.try_emplace(name, value);
    if (reach == Reach::all) undeclared_.erase(name);
    if (fresh || at->second == value) return;
    if (at->second.known() && value.known()) volatile_.insert(name);  // two of one name: nobody knows which
    if (value.known()) at->second = std::move(value);
}

void Machine::impose(const std::string& name, Value value) {
    volatile_.erase(name);
    for (auto& values : modules_)
        if (const auto at = values.find(name); at != values.end()) at->second = value;
    globals_[name] = std::move(value);
}

// ---- places

std::optional<std::vector<double>> Machine::indices_of(const Expr& place) {
    std::vector<double> all;
    bool known = true;
    if (place.kind == Expr::Kind::index)
        for (const Argument& index : place.parts) {
            const auto n = index.value ? value_of(*index.value).as_number() : std::nullopt;
            known = known && n;
            all.push_back(n.value_or(0));
        }
    return known ? std::optional(std::move(all)) : std::nullopt;
}

const Value* Machine::find(const Expr& e) {
    if (e.kind == Expr::Kind::name) return variable(e.text);
    if (!is_place(e)) return nullptr;
    const auto indices = indices_of(e);
    const Value* of = indices ? find(*e.of) : nullptr;
    if (!of || (of->kind != Value::Kind::list && !indices->empty())) return nullptr;
    if (e.kind == Expr::Kind::component) {
        if (of->kind != Value::Kind::list) return nullptr;
        if (!of->names.empty()) return of->part(e.text);
        const int at = place_of(e.text);
        return at >= 0 && static_cast<std::size_t>(at) < of->parts.size()
                   ? &of->parts[static_cast<std::size_t>(at)]
                   : nullptr;
    }
    const int first = dialect_ == Dialect::urscript ? 0 : 1;
    for (const double n : *indices) {
        if (of->kind != Value::Kind::list || n < first || n - first >= static_cast<double>(of->parts.size()))
            return nullptr;
        of = &of->parts[static_cast<std::size_t>(n - first)];
    }
    return of;
}

// The same place whatever becomes of the variables in its indices. None: it is no place, or an index is not known.
ExprPtr Machine::frozen(const Expr& e) {
    if (!is_place(e)) return nullptr;
    auto same = std::make_shared<Expr>(e);
    if (e.kind == Expr::Kind::name) return same;
    const auto indices = indices_of(e);
    same->of = indices ? frozen(*e.of) : nullptr;
    if (!same->of) return nullptr;
    for (std::size_t i = 0; i < indices->size(); ++i) {
        auto n = std::make_shared<Expr>();
        n->number = (*indices)[i];
        same->parts[i] = {{}, std::move(n)};
    }
    return same;
}

Value* Machine::component_of(Value& record, const std::string& name) const {
    if (record.kind != Value::Kind::list) {
        record = {};
        record.kind = Value::Kind::list;
    }
    const int by_place = place_of(name);
    if (dialect_ == Dialect::krl || by_place < 0) {
        const auto known = std::find(record.names.begin(), record.names.end(), name);
        if (known != record.names.end())
            return &record.parts[static_cast<std::size_t>(known - record.names.begin())];
        record.names.resize(record.parts.size());
        record.names.push_back(name);
        record.parts.emplace_back().type = type_of(name);
        return &record.parts.back();
    }
    const auto place = static_cast<std::size_t>(by_place);
    if (record.parts.size() <= place) record.parts.resize(place + 1);
    return &record.parts[place];
}

// None: which one it is is not known, and so are all that it could be.
Value* Machine::slot(const Expr& e) {
    if (e.kind == Expr::Kind::name) return home(e.text);
    if (!is_place(e)) return nullptr;
    const auto indices = indices_of(e);  // first: a function may give values too
    Value* at = slot(*e.of);
    if (!at) return nullptr;
    if (e.kind == Expr::Kind::component) return component_of(*at, e.text);
    const int first = dialect_ == Dialect::urscript ? 0 : 1;
    const auto no_index = [&](double n) { return n < first || n - first >= kLargestIndex; };
    const Value::Type type = at->type;
    if (!indices || std::any_of(indices->begin(), indices->end(), no_index)) {
        *at = Value::unknown(shown(*e.of));  // any of its elements
        at->type = type;
        return nullptr;
    }
    for (const double n : *indices) {
        const auto i = static_cast<std::size_t>(n - first);
        if (at->kind != Value::Kind::list) {
            *at = {};
            at->kind = Value::Kind::list;
            at->type = type;
        }
        if (at->parts.size() <= i) {
            if (!spend(kStepsOfElement * (i + 1 - at->parts.size()))) return nullptr;
            Value element;
            element.type = type;
            at->parts.resize(i + 1, element);
        }
        at = &at->parts[i];
    }
    return at;
}

void Machine::put_in(Value& place, Value value, const std::string& name) const {
    const Value::Type type = place.type;
    if (dialect_ == Dialect::krl && value.kind == Value::Kind::number) {
        if (type == Value::Type::integer)
            value.number = std::round(value.number);
        else if (type == Value::Type::any && value.number != std::trunc(value.number))
            value = Value::unknown(name);  // whether it is rounded is not known
    }
    value.type = type;
    value.constant = false;
    place = std::move(value);
}

void Machine::assign(const Expr& place, Value value) {
    if (doubt_ > 0) value = Value::unknown(shown(place));
    if (Value* at = slot(place)) put_in(*at, std::move(value), shown(place));
}

}  // namespace seamwright::program_path
