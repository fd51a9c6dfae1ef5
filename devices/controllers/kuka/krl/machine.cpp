#include "devices/controllers/kuka/krl/machine.h"

#include <fmt/format.h>

#include <algorithm>

namespace seamwright::krl {

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

}  // namespace seamwright::krl
