// The run through a program's statements: routines, branches, loops, and what of them only the cell knows.

#include <algorithm>

#include "devices/robot_path/machine.h"

namespace seamwright::program_path {
namespace {

constexpr std::size_t kMostSteps = 5'000'000;  // statements that run; within a loop one counts ten
constexpr std::size_t kDeepestCalls = 30;

}  // namespace

bool Machine::enter(const std::string& name, const std::vector<Argument>& arguments, Flow& flow) {
    const auto at = routines_.find(name);
    if (at == routines_.end()) return false;
    flow = Flow::on;
    if (scopes_.size() >= kDeepestCalls) {
        too_long_ = true;
        return true;
    }
    const Routine& routine = at->second;
    std::map<std::string, Value> scope;
    for (const std::string& parameter : routine.parameters) scope[parameter] = Value::unknown(parameter);
    for (const auto& [parameter, value] : routine.defaults)
        if (value) scope[parameter] = value_of(*value);
    std::size_t place = 0;
    for (const Argument& a : arguments) {
        if (a.optional) continue;
        const std::string parameter = !a.name.empty()                     ? a.name
                                      : place < routine.parameters.size() ? routine.parameters[place++]
                                                                          : "";
        if (!parameter.empty() && a.value) scope[parameter] = value_of(*a.value);
    }
    scopes_.push_back(std::move(scope));
    const int file = now_file_, line = now_line_;
    run_block(routine.body);
    now_file_ = file, now_line_ = line;
    scopes_.pop_back();
    return true;
}

Machine::Flow Machine::run_block(const Block& block) {
    for (const Statement& s : block) {
        const Flow flow = run_statement(s);
        if (flow != Flow::on) return flow;
    }
    return Flow::on;
}

Machine::Flow Machine::run_statement(const Statement& s) {
    if ((steps_ += loops_ > 0 ? 10 : 1) > kMostSteps) too_long_ = true;
    if (too_long_ || too_many_) return Flow::back;
    now_file_ = s.file, now_line_ = s.line;
    try {
        switch (s.kind) {
            case Statement::Kind::simple:
                return s.tokens.empty() ? Flow::on : execute(s);
            case Statement::Kind::branch:
                return run_branch(s);
            case Statement::Kind::count:
                return run_count(s);
            default:
                return run_loop(s);
        }
    } catch (const Misread&) {
        const bool motion = !s.tokens.empty() && moves(s.tokens.front().text);
        if (motion)
            gap("the motion is written in a way that is not known here");
        else
            note(LineKind::not_understood, "this is not known here");
        return Flow::on;
    }
}

void Machine::run_in_doubt(const Statement& s, const Text& why, std::size_t from) {
    const Text outer = doubt_why_;
    if (doubt_ == 0) doubt_why_ = why;
    for (std::size_t i = from; i < s.branches.size(); ++i) {
        ++doubt_;
        run_block(s.branches[i].second);
        --doubt_;
    }
    doubt_why_ = outer;
}

Machine::Flow Machine::run_branch(const Statement& s) {
    note(LineKind::understood);
    for (std::size_t i = 0; i < s.branches.size(); ++i) {
        const auto& [condition, block] = s.branches[i];
        const Value asked = condition ? value_of(*condition) : Value::of_truth(true);
        const auto truth = asked.as_truth();
        if (!truth) {
            run_in_doubt(s,
                         Text("it hangs on {}, which only the cell knows",
                              asked.known() ? shown(*condition) : asked.text),
                         i);
            return Flow::on;
        }
        if (*truth) return run_block(block);
    }
    return Flow::on;
}

// The body of a loop once more.
Machine::Flow Machine::run_again(const Block& body) {
    if ((steps_ += 10) > kMostSteps) too_long_ = true;
    if (too_long_) return Flow::back;
    ++loops_;
    const Flow flow = run_block(body);
    --loops_;
    return flow;
}

Machine::Flow Machine::run_count(const Statement& s) {
    note(LineKind::understood);
    const auto from = value_of(*s.from).as_number(), to = value_of(*s.to).as_number();
    auto step = s.step ? value_of(*s.step).as_number() : std::optional(1.0);
    if (from && to && !s.step && dialect_ == Dialect::rapid && *from > *to) step = -1;
    if (!from || !to || !step || *step == 0) {
        run_in_doubt(s, "how often this loop runs is known only in the cell");
        return Flow::on;
    }
    for (double i = *from; *step > 0 ? i <= *to : i >= *to; i += *step) {
        declare(s.variable, Value::of(i), dialect_ == Dialect::rapid);
        const Flow flow = run_again(s.branches.front().second);
        if (flow == Flow::leave) break;
        if (flow == Flow::back) return flow;
    }
    return Flow::on;
}

Machine::Flow Machine::run_loop(const Statement& s) {
    note(LineKind::understood);
    const auto& [condition, block] = s.branches.front();
    const bool endless =
        !condition || (condition->kind == Expr::Kind::truth && (condition->number != 0) != s.condition_last);
    for (bool first = true;; first = false) {
        if (!endless && !(first && s.condition_last)) {
            const auto truth = value_of(*condition).as_truth();
            if (!truth) return run_unknown_loop(s);
            if (*truth == s.condition_last) return Flow::on;
        }
        if (endless) {
            const int file = now_file_, line = now_line_;
            const std::size_t begin = path_.points.size();
            const Flow flow = run_again(block);
            if (flow != Flow::on) return flow == Flow::leave ? Flow::on : flow;
            now_file_ = file, now_line_ = line;
            return begin == path_.points.size() ? Flow::on : run_turns(s, begin);
        }
        const Flow flow = run_again(block);
        if (flow == Flow::leave) return Flow::on;
        if (flow == Flow::back) return flow;
    }
}

// Nobody here knows how often: what every turn does alike is read once.
Machine::Flow Machine::run_unknown_loop(const Statement& s) {
    const std::size_t begin = path_.points.size();
    const int file = now_file_, line = now_line_;
    const Flow flow = run_again(s.branches.front().second);
    now_file_ = file, now_line_ = line;
    if (flow == Flow::back) return flow;
    const Flow turns = begin == path_.points.size() || flow == Flow::leave ? Flow::on : run_turns(s, begin);
    forget(s.branches.front().second);
    return turns;
}

// Behind the first turn, whose points begin at `begin`. A turn that runs the same points again is left out; one that leaves the loop
// ends it; turns that go on otherwise are not understood.
Machine::Flow Machine::run_turns(const Statement& s, std::size_t begin) {
    const std::size_t first = path_.points.size();
    const int file = now_file_, line = now_line_;
    const Flow flow = run_again(s.branches.front().second);
    now_file_ = file, now_line_ = line;
    if (flow == Flow::back) return flow;
    if (flow == Flow::leave) return Flow::on;
    bool same = path_.points.size() - first == first - begin;
    for (std::size_t i = begin; same && i < first; ++i) {
        const ProgramPoint &p = path_.points[i], &q = path_.points[i + (first - begin)];
        same = p.frame == q.frame && p.frame_from_tool.isApprox(q.frame_from_tool, 1e-9);
    }
    // A joint move between two turns parts their points, as the way home does.
    drop_points(same ? first : begin);
    if (same) {
        remark("a loop whose end only the cell knows is read once");
    } else {
        run_in_doubt(s, "how often this loop runs is known only in the cell");
    }
    return Flow::on;
}

void Machine::drop_points(std::size_t from) {
    for (std::size_t i = from; i < path_.points.size(); ++i) {
        const ProgramPoint& p = path_.points[i];
        for (std::size_t f = 0; f < sources_.size(); ++f)
            if (sources_[f].name == p.file) {
                --lines_[f][p.line].points;
                break;
            }
    }
    path_.points.resize(from);
    for (JointMove& j : joints_) j.before = std::min(j.before, from);
}

// What a block gives values to is not known any more.
void Machine::forget(const Block& block) {
    for (const Statement& s : block) {
        for (const auto& [condition, inner] : s.branches) forget(inner);
        std::size_t at = 0;
        while (at < s.tokens.size() && (s.tokens[at].text == "global" || s.tokens[at].text == "local")) ++at;
        if (at >= s.tokens.size() || s.tokens[at].kind != Token::Kind::name) continue;
        const bool gives = std::any_of(s.tokens.begin() + static_cast<std::ptrdiff_t>(at), s.tokens.end(),
                                       [](const Token& t) { return t.text == "=" || t.text == ":="; });
        const std::string& name = s.tokens[at].text;
        if (!gives || !variable(name)) continue;
        Value& v = !scopes_.empty() && scopes_.back().count(name) > 0 ? scopes_.back()[name] : globals_[name];
        v = Value::unknown(name);
    }
}

}  // namespace seamwright::program_path
