// The run through a program's statements: routines, branches, loops, and what of them only the cell knows.

#include <algorithm>
#include <utility>

#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {
namespace {

constexpr std::size_t kMostSteps = 5'000'000;  // statements that run; within a loop one counts ten

}  // namespace

bool Machine::spend(std::size_t steps) {
    steps_ += steps;
    too_long_ = too_long_ || steps_ > kMostSteps;
    return !too_long_;
}

Machine::Flow Machine::run_block(const Block& block) {
    for (const Statement& s : block) {
        const Flow flow = run_statement(s);
        if (flow != Flow::on) return flow;
    }
    return Flow::on;
}

Machine::Flow Machine::run_statement(const Statement& s) {
    if (!spend(loops_ > 0 ? 10 : 1) || too_many_ || over_) return Flow::halt;
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
    bool jumps = false;
    for (std::size_t i = from; i < s.branches.size(); ++i) {
        ++doubt_;
        const Flow flow = run_block(s.branches[i].second);
        --doubt_;
        jumps = jumps || flow == Flow::back || flow == Flow::again || (flow == Flow::leave && counted_);
    }
    // A routine that does not move is in doubt to its end; of one that does the jump has the note.
    if (jumps && !in_moving_routine())
        ++doubt_;
    else
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
Machine::Flow Machine::run_again(const Block& body, bool counted) {
    if (!spend(10)) return Flow::halt;
    const bool outer = std::exchange(counted_, counted);
    ++loops_;
    const Flow flow = run_block(body);
    --loops_;
    counted_ = outer;
    return flow == Flow::again ? Flow::on : flow;
}

// Of RAPID the loop's own, which hides another of its name while the loop runs.
void Machine::count(const std::string& name, Value value) {
    if (loops_declare_ && depth_ > 0) return declare(name, std::move(value), Reach::routine);
    Expr place;
    place.kind = Expr::Kind::name;
    place.text = name;
    assign(place, std::move(value));
}

Machine::Flow Machine::run_count(const Statement& s) {
    note(LineKind::understood);
    const auto from = value_of(*s.from).as_number(), to = value_of(*s.to).as_number();
    auto step = s.step ? value_of(*s.step).as_number() : std::optional(1.0);
    if (from && to && !s.step && dialect_ == Dialect::rapid && *from > *to) step = -1;
    const bool hides = loops_declare_ && depth_ > 0;
    std::map<std::string, Value>::node_type hidden;
    if (hides) hidden = scopes_[depth_ - 1].values.extract(s.variable);
    Flow flow = Flow::on;
    if (!from || !to || !step || *step == 0) {
        count(s.variable, Value::unknown(s.variable));
        run_in_doubt(s, "how often this loop runs is known only in the cell");
    } else {
        flow = turns(s, *from, *to, *step);
    }
    if (hides) {
        auto& own = scopes_[depth_ - 1].values;
        own.erase(s.variable);
        if (hidden) own.insert(std::move(hidden));
    }
    return flow;
}

Machine::Flow Machine::turns(const Statement& s, double from, double to, double step) {
    for (double i = from; step > 0 ? i <= to : i >= to; i += step) {
        Value now = Value::of(i);
        now.type = Value::Type::integer;
        count(s.variable, now);
        const Flow flow = run_again(s.branches.front().second, true);
        if (flow == Flow::leave) return Flow::on;
        if (flow != Flow::on) return flow;
    }
    // KRL's manual does not say what it is behind the last turn.
    if (dialect_ == Dialect::krl) count(s.variable, Value::unknown(s.variable));
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
        const Flow flow = run_again(block, true);
        if (flow != Flow::on) return flow == Flow::leave ? Flow::on : flow;
    }
}

// Nobody here knows how often: what every turn does alike is read once.
Machine::Flow Machine::run_unknown_loop(const Statement& s) {
    const std::size_t begin = path_.points.size();
    const int file = now_file_, line = now_line_;
    const Flow flow = run_again(s.branches.front().second);
    now_file_ = file, now_line_ = line;
    if (flow == Flow::back || flow == Flow::halt) return flow;
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
    if (flow != Flow::on) return flow == Flow::leave ? Flow::on : flow;
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

// What a block gives values to, itself or by what it calls, is not known any more.
void Machine::forget(const Block& block) {
    if (doubt_ > 0) return;  // nor was it before
    const auto here = here_;
    const NamedPose frame = frame_;
    const std::string tool = tool_;
    const bool fixed_tool = fixed_tool_;
    const int file = now_file_, line = now_line_;
    ++doubt_, ++quiet_;
    run_block(block);
    --doubt_, --quiet_;
    now_file_ = file, now_line_ = line;
    here_ = here;
    frame_ = frame;
    tool_ = tool;
    fixed_tool_ = fixed_tool;
}

}  // namespace seamwright::program_path
