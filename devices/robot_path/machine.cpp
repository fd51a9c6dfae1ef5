#include "devices/robot_path/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seamwright::program_path {
namespace {

constexpr std::size_t kMostSteps = 5'000'000;  // statements that run; within a loop one counts ten
constexpr std::size_t kDeepestCalls = 30;
constexpr long kLargestIndex = 100'000;  // of an array that is filled element by element
constexpr double kStraight_mm =
    1e-3;  // three points whose middle one lies nearer to the chord make no circle

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

}  // namespace

Value Value::of(double number) {
    Value v;
    v.kind = Kind::number;
    v.number = number;
    return v;
}
Value Value::of_truth(bool truth) {
    Value v = of(truth);
    v.kind = Kind::truth;
    return v;
}
Value Value::of_text(std::string text) {
    Value v;
    v.kind = Kind::text;
    v.text = std::move(text);
    return v;
}
Value Value::unknown(std::string name) {
    Value v;
    v.text = std::move(name);
    return v;
}
Value Value::list(std::vector<Value> parts) {
    Value v;
    v.kind = Kind::list;
    v.parts = std::move(parts);
    return v;
}
Value Value::numbers(std::initializer_list<double> numbers) {
    std::vector<Value> parts;
    for (const double n : numbers) parts.push_back(of(n));
    return list(std::move(parts));
}
std::optional<double> Value::as_number() const {
    if (kind != Kind::number || !std::isfinite(number)) return {};
    return number;
}
std::optional<bool> Value::as_truth() const {
    if (kind != Kind::truth) return {};
    return number != 0;
}
const Value* Value::part(std::string_view name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? nullptr : &parts[static_cast<std::size_t>(at - names.begin())];
}

std::optional<std::array<double, 6>> six_numbers(const Value& value) {
    if (value.kind != Value::Kind::list || value.parts.size() != 6) return {};
    std::array<double, 6> n{};
    for (std::size_t i = 0; i < 6; ++i) {
        const auto number = value.parts[i].as_number();
        if (!number || std::abs(*number) > 1e9) return {};
        n[i] = *number;
    }
    return n;
}

// ---- values

const Value* Machine::variable(const std::string& name) const {
    if (volatile_.count(name) > 0) return nullptr;
    if (!scopes_.empty()) {
        const auto local = scopes_.back().find(name);
        if (local != scopes_.back().end()) return &local->second;
    }
    const auto global = globals_.find(name);
    return global == globals_.end() ? nullptr : &global->second;
}

void Machine::declare(const std::string& name, Value value, bool local) {
    if (local && !scopes_.empty())
        scopes_.back()[name] = std::move(value);
    else
        globals_[name] = std::move(value);
}

const Value* Machine::find(const Expr& e) {
    if (e.kind == Expr::Kind::name) return variable(e.text);
    if (e.kind != Expr::Kind::index && e.kind != Expr::Kind::component) return nullptr;
    const Value* of = find(*e.of);
    if (!of || of->kind != Value::Kind::list) return nullptr;
    if (e.kind == Expr::Kind::component) {
        if (!of->names.empty()) return of->part(e.text);
        const int at = place_of(e.text);
        return at >= 0 && static_cast<std::size_t>(at) < of->parts.size()
                   ? &of->parts[static_cast<std::size_t>(at)]
                   : nullptr;
    }
    const int first = dialect_ == Dialect::urscript ? 0 : 1;
    for (const Argument& index : e.parts) {
        if (!index.value) return nullptr;
        const auto n = value_of(*index.value).as_number();
        if (!n || of->kind != Value::Kind::list || *n < first ||
            *n - first >= static_cast<double>(of->parts.size()))
            return nullptr;
        of = &of->parts[static_cast<std::size_t>(*n - first)];
    }
    return of;
}

void Machine::assign(const Expr& place, Value value) {
    if (doubt_ > 0) value = Value::unknown(shown(place));
    // The way down to the variable: its name, then indices and components.
    std::vector<const Expr*> way;
    for (const Expr* e = &place;; e = e->of.get()) {
        way.push_back(e);
        if (e->kind == Expr::Kind::name) break;
        if (e->kind != Expr::Kind::index && e->kind != Expr::Kind::component) return;
    }
    const std::string& name = way.back()->text;
    Value* at = nullptr;
    if (!scopes_.empty() && scopes_.back().count(name) > 0)
        at = &scopes_.back()[name];
    else
        at = &globals_[name];
    for (auto e = way.rbegin() + 1; e != way.rend(); ++e) {
        if ((*e)->kind == Expr::Kind::component) {
            if (at->kind != Value::Kind::list) {
                *at = {};
                at->kind = Value::Kind::list;
            }
            const int by_place = place_of((*e)->text);
            if (dialect_ == Dialect::krl || by_place < 0) {
                const auto known = std::find(at->names.begin(), at->names.end(), (*e)->text);
                if (known == at->names.end()) {
                    at->names.resize(at->parts.size());
                    at->names.push_back((*e)->text);
                    at->parts.emplace_back();
                    at = &at->parts.back();
                } else {
                    at = &at->parts[static_cast<std::size_t>(known - at->names.begin())];
                }
            } else {
                const auto place_in = static_cast<std::size_t>(by_place);
                if (at->parts.size() <= place_in) at->parts.resize(place_in + 1);
                at = &at->parts[place_in];
            }
            continue;
        }
        const int first = dialect_ == Dialect::urscript ? 0 : 1;
        for (const Argument& index : (*e)->parts) {
            if (!index.value) return;  // NAME[]="text" of KRL
            const auto n = value_of(*index.value).as_number();
            if (!n || *n < first || *n - first >= kLargestIndex) {
                *at = Value::unknown(name);  // any of its elements
                return;
            }
            const auto i = static_cast<std::size_t>(*n - first);
            if (at->kind != Value::Kind::list) {
                *at = {};
                at->kind = Value::Kind::list;
            }
            if (at->parts.size() <= i) at->parts.resize(i + 1);
            at = &at->parts[i];
        }
    }
    *at = std::move(value);
}

Value Machine::value_of(const Expr& e) {
    switch (e.kind) {
        case Expr::Kind::number:
            return Value::of(e.number);
        case Expr::Kind::truth:
            return Value::of_truth(e.number != 0);
        case Expr::Kind::text:
            return Value::of_text(e.text);
        case Expr::Kind::list:
        case Expr::Kind::pose:
        case Expr::Kind::record: {
            Value v;
            v.kind = Value::Kind::list;
            v.pose = e.kind == Expr::Kind::pose;
            v.parts.reserve(e.parts.size());
            for (const Argument& part : e.parts) {
                v.parts.push_back(part.value ? value_of(*part.value) : Value{});
                if (e.kind == Expr::Kind::record) v.names.push_back(part.name);
            }
            return v;
        }
        case Expr::Kind::name:
        case Expr::Kind::index:
        case Expr::Kind::component: {
            const Value* found = find(e);
            if (found && found->known()) return *found;
            if (found && !found->text.empty()) return Value::unknown(found->text);
            return Value::unknown(shown(e));
        }
        case Expr::Kind::call:
            return call(e);
        case Expr::Kind::unary: {
            const Value v = value_of(*e.parts[0].value);
            if (e.text == "-") {
                const auto n = v.as_number();
                return n ? Value::of(-*n) : Value::unknown(shown(e));
            }
            const auto t = v.as_truth();
            return t ? Value::of_truth(!*t) : Value::unknown(shown(e));
        }
        default:
            return binary(e);
    }
}

Value Machine::binary(const Expr& e) {
    const std::string& op = e.text;
    const Value a = value_of(*e.parts[0].value), b = value_of(*e.parts[1].value);
    if (op == ":") {  // frames of KRL
        Expr product;
        product.kind = Expr::Kind::call;
        product.text = ":";
        product.parts = e.parts;
        return call(product);
    }
    if (const auto x = a.as_truth(), y = b.as_truth(); x || y) {
        if (op == "or" || op == "OR") {
            if (x && y) return Value::of_truth(*x || *y);
            if ((x && *x) || (y && *y)) return Value::of_truth(true);
        } else if (op == "and" || op == "AND") {
            if (x && y) return Value::of_truth(*x && *y);
            if ((x && !*x) || (y && !*y)) return Value::of_truth(false);
        } else if (x && y) {
            return Value::of_truth((*x == *y) == (op == "==" || op == "="));
        }
        return Value::unknown(!x && !a.text.empty() ? a.text : !y && !b.text.empty() ? b.text : shown(e));
    }
    if (a.kind == Value::Kind::text && b.kind == Value::Kind::text) {
        if (op == "==" || op == "=") return Value::of_truth(a.text == b.text);
        if (op == "<>" || op == "!=") return Value::of_truth(a.text != b.text);
    }
    if (a.kind == Value::Kind::list && b.kind == Value::Kind::list && (op == "+" || op == "-") &&
        a.parts.size() == b.parts.size()) {
        Value v = a;
        for (std::size_t i = 0; i < v.parts.size(); ++i) {
            const auto x = a.parts[i].as_number(), y = b.parts[i].as_number();
            if (!x || !y) return Value::unknown(shown(e));
            v.parts[i] = Value::of(op == "+" ? *x + *y : *x - *y);
        }
        return v;
    }
    const auto x = a.as_number(), y = b.as_number();
    if ((x && b.kind == Value::Kind::list) || (y && a.kind == Value::Kind::list)) {
        Value v = x ? b : a;
        for (Value& part : v.parts) {
            const auto n = part.as_number();
            if (!n || (op != "*" && !(op == "/" && y && *y != 0))) return Value::unknown(shown(e));
            part = Value::of(op == "*" ? *n * (x ? *x : *y) : *n / *y);
        }
        return v;
    }
    if (!x || !y) return Value::unknown(a.known() ? (b.known() ? shown(e) : b.text) : a.text);
    if (op == "+") return Value::of(*x + *y);
    if (op == "-") return Value::of(*x - *y);
    if (op == "*") return Value::of(*x * *y);
    if (op == "/" && *y != 0) return Value::of(*x / *y);
    if (op == "div" && *y != 0) return Value::of(std::trunc(*x / *y));
    if ((op == "mod" || op == "%") && *y != 0) return Value::of(std::fmod(*x, *y));
    if (op == "==" || op == "=") return Value::of_truth(*x == *y);
    if (op == "<>" || op == "!=") return Value::of_truth(*x != *y);
    if (op == "<") return Value::of_truth(*x < *y);
    if (op == ">") return Value::of_truth(*x > *y);
    if (op == "<=") return Value::of_truth(*x <= *y);
    if (op == ">=") return Value::of_truth(*x >= *y);
    return Value::unknown(shown(e));
}

// ---- notes

void Machine::note(int file, int line, LineKind kind, Text why) {
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
    if (std::find(path_.remarks.begin(), path_.remarks.end(), text) == path_.remarks.end())
        path_.remarks.push_back(std::move(text));
}

// ---- motions

void Machine::put(const Pose& frame_from_tool, ProgramMotion motion, const std::string& name) {
    const bool outside = now_file_ == 0 && ((options_.first_line > 0 && now_line_ < options_.first_line) ||
                                            (options_.last_line > 0 && now_line_ > options_.last_line));
    if (outside) return note(LineKind::left_out, "outside the lines that were asked for");
    if (path_.points.size() >= kPathPointLimit) {
        too_many_ = true;
        return;
    }
    if (tools_.empty() || tools_.back() != tool_) tools_.push_back(tool_);
    path_.points.push_back({now_line_, sources_[static_cast<std::size_t>(now_file_)].name, name, motion,
                            frame_.name, frame_.pose, frame_from_tool});
    note(LineKind::point);
    ++lines_[static_cast<std::size_t>(now_file_)][now_line_].points;
}

void Machine::move(const Pose& frame_from_tool, ProgramMotion motion, const std::string& name) {
    if (doubt_ > 0) return gap(doubt_why_);
    if (fixed_tool_) return gap("the tool stands fixed in the room here and the robot moves the part");
    if (!frame_from_tool.matrix().allFinite() || frame_from_tool.translation().cwiseAbs().maxCoeff() > 1e5)
        return gap("the point lies beyond 100 m");
    put(frame_from_tool, motion, name);
    here_ = frame_from_tool;
}

void Machine::arc(const Pose& via, const Pose& end, const std::string& name, double angle_rad) {
    if (doubt_ > 0) return gap(doubt_why_);
    if (!here_) return gap("where this circle begins is not known");
    const Pose start = *here_;
    const Eigen::Vector3d a = start.translation(), b = via.translation() - a, c = end.translation() - a;
    const Eigen::Vector3d axis = b.cross(c);
    if (!axis.allFinite() || b.norm() < kStraight_mm || c.norm() < kStraight_mm ||
        axis.norm() < kStraight_mm * std::max(b.norm(), c.norm()))
        return gap("its three points lie on one line and make no circle");
    const Eigen::Vector3d n = axis.normalized();
    // Circumcentre of a triangle, seen from its first corner.
    const Eigen::Vector3d centre =
        (b.squaredNorm() * c.cross(axis) + c.squaredNorm() * axis.cross(b)) / (2 * axis.squaredNorm());
    const double radius = centre.norm();
    if (!(radius < 1e5)) return gap("the circle's radius is beyond 100 m");
    const Eigen::Vector3d x = -centre / radius, y = n.cross(x);
    // start -> via -> end runs in the positive sense about n, always.
    double angle = std::atan2((c - centre).dot(y), (c - centre).dot(x));
    if (angle <= 0) angle += 2 * kPi;
    const bool whole = angle_rad == 0;
    if (!whole) {
        if (!(std::abs(angle_rad) < 20 * kPi)) return gap("the circle's angle is beyond ten turns");
        angle = angle_rad;
    }
    const double chord = std::clamp(options_.chord_mm, 1e-4, radius);
    const double step = 2 * std::acos(std::max(0.0, 1 - chord / radius));
    const int pieces = std::max(1, static_cast<int>(std::ceil(std::abs(angle) / step - 1e-9)));
    const Eigen::Quaterniond from(start.linear()), to(end.linear());
    for (int i = 1; i <= pieces; ++i) {
        const double share = static_cast<double>(i) / pieces, t = angle * share;
        Pose p = end;
        if (i < pieces || !whole) {
            p.translation() = a + centre + radius * (std::cos(t) * x + std::sin(t) * y);
            p.linear() = i < pieces ? from.slerp(share, to).toRotationMatrix() : end.linear();
        }
        move(p, ProgramMotion::circular, i == pieces ? name : std::string());
    }
}

void Machine::joint_values() {
    if (doubt_ > 0) return gap(doubt_why_);
    note(LineKind::understood);
    joints_.push_back({now_file_, now_line_, path_.points.size()});
    here_.reset();
}

void Machine::settle_joint_values() {
    for (const JointMove& j : joints_) {
        now_file_ = j.file, now_line_ = j.line;
        if (j.before == 0 || j.before == path_.points.size())
            note(LineKind::left_out, "joint values: the way to the path or from it");
        else
            note(LineKind::not_understood,
                 "joint values on the way are no pose without the robot's kinematics");
    }
}

void Machine::set_frame(NamedPose frame) {
    if (doubt_ > 0) frame = {frame.name + "?", std::nullopt};
    if (here_ && frame.name != frame_.name) {
        if (frame.pose && frame_.pose)
            here_ = frame.pose->inverse() * *frame_.pose * *here_;
        else
            here_.reset();
    }
    frame_ = std::move(frame);
}

// ---- the run

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

// ---- which routine

bool Machine::holds_motion(const Block& block, std::set<std::string>& seen) const {
    for (const Statement& s : block) {
        for (const auto& [condition, inner] : s.branches)
            if (holds_motion(inner, seen)) return true;
        if (s.tokens.empty()) continue;
        if (moves(s.tokens.front().text)) return true;
        const auto routine = routines_.find(s.tokens.front().text);
        if (routine != routines_.end() && seen.size() < 1000 && seen.insert(routine->first).second &&
            holds_motion(routine->second.body, seen))
            return true;
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
        const Routine& routine = routines_.at(name);
        if (routine.file != 0 || !holds_motion(routine.body, seen)) continue;
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

Expected<ProgramPath> Machine::run(std::vector<Source> sources, const std::string& name) {
    sources_ = std::move(sources);
    lines_.resize(sources_.size());
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
    begin();
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

}  // namespace seamwright::program_path
