#include "devices/robot_path/machine/machine.h"

#include <algorithm>
#include <cctype>

namespace seamwright::program_path {
namespace {

int weight(LineKind kind) {
    switch (kind) {
        case LineKind::not_reached:
            return 0;
        case LineKind::passed_over:
            return 1;
        case LineKind::understood:
            return 2;
        case LineKind::point:
            return 3;
        case LineKind::left_out:
            return 4;
        default:
            return 5;
    }
}

}  // namespace

Expected<ProgramPath> Machine::run(std::vector<Source> sources, const std::string& name) {
    sources_ = std::move(sources);
    lines_.resize(sources_.size());
    std::map<std::string, int> modules;
    for (const Source& source : sources_)
        modules_of_.push_back(
            modules.try_emplace(module_name(source), static_cast<int>(modules.size())).first->second);
    modules_.resize(modules.size());
    std::vector<std::string> texts(sources_.size());
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        for (std::string& line : sources_[i].lines) {
            texts[i] += line + "\n";
            const auto from = line.find_first_not_of(" \t\r");  // as notes show it
            line =
                from == std::string::npos ? "" : line.substr(from, line.find_last_not_of(" \t\r") - from + 1);
            if (line.size() > 120) line.replace(117, std::string::npos, "...");
            std::replace_if(
                line.begin(), line.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
        }
    }
    for (std::size_t i = 0; i < sources_.size(); ++i) load(static_cast<int>(i), texts[i]);
    SEAM_TRY(const auto routine, chosen_routine(name));
    path_.routine = routine;
    now_file_ = 0;
    begin();
    if (!this->routine(routine, 0)) now_file_ = routines_.find(routine)->second.file;
    Flow flow = Flow::on;
    std::vector<Argument> none;
    enter(routine, none, flow);
    if (too_long_)
        return input_error("the program does not come to an end", name,
                           "take one of its routines with --routine");
    if (too_many_) return input_error(Text("there are more than {} points", kPathPointLimit), name);
    settle_joint_values();
    path_.tools = tools_;
    int by_joints = 0;
    for (std::size_t i = 1; i < path_.points.size(); ++i)
        by_joints += path_.points[i].motion == ProgramMotion::joint;
    if (by_joints > 0)
        remark(Text("{} points are reached joint by joint in the program, and on a straight line in the path",
                    by_joints));
    if (std::any_of(path_.points.begin(), path_.points.end(),
                    [](const ProgramPoint& p) { return p.motion == ProgramMotion::spline; }))
        remark(
            "between the points of a spline the curve is the controller's own: the path holds its points "
            "alone");
    for (auto& lines : lines_)
        for (auto& [number, line] : lines) path_.lines.push_back(std::move(line));
    return std::move(path_);
}

void Machine::note(int file, int line, LineKind kind, Text why) {
    if (quiet_ > 0) return;
    auto& lines = lines_[static_cast<std::size_t>(file)];
    auto [at, fresh] = lines.try_emplace(line);
    ProgramLine& l = at->second;
    if (fresh) {
        const Source& source = sources_[static_cast<std::size_t>(file)];
        l.file = source.name;
        l.line = line;
        l.kind = kind;
        if (line >= 1 && static_cast<std::size_t>(line) <= source.lines.size())
            l.text = source.lines[static_cast<std::size_t>(line) - 1];
    }
    if (fresh || weight(kind) > weight(l.kind)) {
        l.kind = kind;
        l.why = std::move(why);
    }
}

void Machine::gap(Text why) {
    note(LineKind::not_understood, doubt_ > 0 ? doubt_why_ : std::move(why));
    here_.reset();
}

void Machine::remark(Text text) {
    if (quiet_ == 0 && std::find(path_.remarks.begin(), path_.remarks.end(), text) == path_.remarks.end())
        path_.remarks.push_back(std::move(text));
}

bool Machine::holds_motion(const Block& block, std::set<std::string>& seen) const {
    for (const Statement& s : block) {
        for (const auto& [condition, inner] : s.branches)
            if (holds_motion(inner, seen)) return true;
        if (s.tokens.empty()) continue;
        if (moves(s.tokens.front().text)) return true;
        for (std::size_t i = 0; i < s.tokens.size(); ++i) {
            const bool calls = i == 0 || (i + 1 < s.tokens.size() && s.tokens[i + 1].text == "(");
            const Routine* called = calls ? routine(s.tokens[i].text, s.file) : nullptr;
            if (called && seen.size() < 1000 && seen.insert(called->name).second &&
                holds_motion(called->body, seen))
                return true;
        }
    }
    return false;
}

void Machine::called_by(const Block& block, std::set<std::string>& names) const {
    for (const Statement& s : block) {
        for (const auto& [condition, inner] : s.branches) called_by(inner, names);
        for (const Token& t : s.tokens)
            if (t.kind == Token::Kind::name && routines_.count(t.text) > 0) names.insert(t.text);
    }
}

Expected<std::string> Machine::chosen_routine(const std::string& where) const {
    if (!options_.routine.empty()) {
        std::string wanted = options_.routine;
        for (const std::string& name : routine_order_) {
            const bool same =
                std::equal(name.begin(), name.end(), wanted.begin(), wanted.end(), [&](char a, char b) {
                    return dialect_ == Dialect::urscript ? a == b
                                                         : std::tolower(static_cast<unsigned char>(a)) ==
                                                               std::tolower(static_cast<unsigned char>(b));
                });
            if (same) return name;
        }
        return input_error(Text("the program has no routine {}", options_.routine), where);
    }
    std::set<std::string> called;
    for (const auto& [name, routine] : routines_) {
        std::set<std::string> names;
        called_by(routine.body, names);
        names.erase(name);
        called.insert(names.begin(), names.end());
    }
    std::vector<std::string> can, alone;
    for (const std::string& name : routine_order_) {
        std::set<std::string> seen = {name};
        const Routine* candidate = routine(name, 0);
        if (!candidate || candidate->file != 0 || !holds_motion(candidate->body, seen) ||
            std::find(can.begin(), can.end(), name) != can.end())
            continue;
        can.push_back(name);
        if (called.count(name) == 0) alone.push_back(name);
    }
    if (can.empty())
        return input_error("no routine of the program moves the robot", where,
                           "give the files that it calls with --with, or another program");
    if (const auto first = preferred(); first && std::find(can.begin(), can.end(), *first) != can.end())
        return *first;
    const std::vector<std::string>& choice = alone.empty() ? can : alone;
    if (choice.size() == 1) return choice.front();
    std::string names;
    for (std::size_t i = 0; i < choice.size() && i < 12; ++i) names += (i > 0 ? ", " : "") + choice[i];
    return input_error(Text("{} routines move the robot: {}", choice.size(), names), where,
                       "say which one with --routine");
}

}  // namespace seamwright::program_path
