// What RAPID does: data, functions and motions.

#include "devices/robot_path/rapid_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/geometry/notation.h"

namespace seamwright::program_path {

namespace {

std::optional<Eigen::Vector3d> vector_of(const Value& v) {
    if (v.kind != Value::Kind::list || v.parts.size() != 3) return {};
    Eigen::Vector3d p;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto n = v.parts[i].as_number();
        if (!n) return {};
        p[static_cast<Eigen::Index>(i)] = *n;
    }
    return p;
}
std::optional<Eigen::Matrix3d> rotation_of(const Value& v) {
    if (v.kind != Value::Kind::list || v.parts.size() != 4) return {};
    std::array<double, 4> q{};
    for (std::size_t i = 0; i < 4; ++i) {
        const auto n = v.parts[i].as_number();
        if (!n) return {};
        q[i] = *n;
    }
    const auto r = rotation_from_abb({q[0], q[1], q[2], q[3]}, "");
    return r ? std::optional(*r) : std::nullopt;
}
// Of a pose [[x,y,z],[q1,q2,q3,q4]] or a robtarget, which begins like one.
std::optional<Pose> pose_at(const Value& v) {
    if (v.kind != Value::Kind::list || v.parts.size() < 2) return {};
    const auto p = vector_of(v.parts[0]);
    const auto r = rotation_of(v.parts[1]);
    return p && r ? std::optional(make_pose(*r, *p)) : std::nullopt;
}
Value rapid_pose_value(const Pose& pose) {
    const Eigen::Vector3d& t = pose.translation();
    const AbbQuaternion q = abb_from_rotation(pose.linear());
    return Value::list({Value::numbers({t.x(), t.y(), t.z()}), Value::numbers({q.w, q.x, q.y, q.z})});
}
std::optional<bool> truth_at(const Value& v, std::size_t i) {
    return v.kind == Value::Kind::list && i < v.parts.size() ? v.parts[i].as_truth() : std::nullopt;
}

}  // namespace

std::optional<Rapid::Instruction> Rapid::instruction(std::string_view word) {
    static const std::map<std::string_view, Instruction, std::less<>> odd = {
        {"moveabsj", {ProgramMotion::joint, true}},
        {"moveextj", {ProgramMotion::joint, true, true}},
        {"searchl", {ProgramMotion::linear, false, false, true}},
        {"searchc", {ProgramMotion::circular, false, false, true}},
        {"spotl", {ProgramMotion::linear}},
        {"spotj", {ProgramMotion::joint}},
        {"triggabsj", {ProgramMotion::joint, true}},
        {"trigglios", {ProgramMotion::linear}}};
    if (const auto at = odd.find(word); at != odd.end()) return at->second;
    static constexpr std::string_view families[] = {"move", "trigg", "arc",   "disp", "paint",
                                                    "cap",  "cut",   "laser", "nut"};
    static constexpr std::string_view endings[] = {"",      "do",     "ao",   "go",     "sync",
                                                   "start", "end",    "1",    "2",      "1start",
                                                   "1end",  "2start", "2end", "_start", "_end"};
    for (const std::string_view family : families) {
        if (!word.starts_with(family) || word.size() <= family.size()) continue;
        const char letter = word[family.size()];
        const std::string_view ending = word.substr(family.size() + 1);
        if (std::find(std::begin(endings), std::end(endings), ending) == std::end(endings)) continue;
        if (letter == 'l') return Instruction{ProgramMotion::linear};
        if (letter == 'c') return Instruction{ProgramMotion::circular};
        if (letter == 'j') return Instruction{ProgramMotion::joint};
    }
    return {};
}

Rapid::Rapid(const ProgramPathOptions& options) : Machine(Dialect::rapid, options) {
    const Value zero = rapid_pose_value(Pose::Identity());
    globals_["wobj0"] =
        Value::list({Value::of_truth(false), Value::of_truth(true), Value::of_text(""), zero, zero});
    globals_["tool0"] = Value::list({Value::of_truth(true), zero});
    for (const char* name : {"wobj0", "tool0"}) globals_[name].constant = true;
    loops_declare_ = true;
}

bool Rapid::moves(const std::string& word) const {
    return instruction(word).has_value();
}

void Rapid::begin() {
    for (const auto& [name, pose] : options_.frames) {
        std::string folded = name;
        std::transform(folded.begin(), folded.end(), folded.begin(),
                       [](unsigned char c) { return std::tolower(c); });
        impose(folded, Value::list({Value::of_truth(false), Value::of_truth(true), Value::of_text(""),
                                    rapid_pose_value(pose), rapid_pose_value(Pose::Identity())}));
    }
}

Machine::Flow Rapid::execute(const Statement& s) {
    Cursor c(s.tokens);
    const std::string word = c.peek().text;
    if (const auto how = instruction(word)) {
        c.take();
        motion(*how, read_arguments(c, Dialect::rapid, ""));
        return Flow::on;
    }
    if (word == "return") {
        c.take();
        return give_back(c.done() ? Value{} : value_of(*read_expression(c, Dialect::rapid)));
    }
    if (word == "exit" || word == "exitcycle") {  // the next cycle begins anew
        note(LineKind::understood);
        return Flow::halt;
    }
    if (word == "stop" || word == "break" || word == "trynext" || word == "retry" || word == "connect" ||
        word == "alias") {  // Stop goes on at the start key
        note(LineKind::passed_over);
        return Flow::on;
    }
    if (word == "goto" || word == "raise") {
        note(LineKind::not_understood, "jumps are not followed");
        return Flow::on;
    }
    if (declares(c)) {
        declaration(c);
        return Flow::on;
    }
    if (s.tokens.size() == 2 && c.is(":", 1)) {  // a label
        note(LineKind::understood);
        return Flow::on;
    }
    if (c.is("%")) {
        note(LineKind::passed_over, "a routine whose name the program makes while it runs");
        return Flow::on;
    }
    const std::size_t from = c.at();
    const auto place = read_expression(c, Dialect::rapid);
    if (c.accept(":=")) {
        assign(*place, value_of(*read_expression(c, Dialect::rapid)));
        note(LineKind::understood);
        return Flow::on;
    }
    c.go_to(from);
    const std::string name = c.name();
    return instruction_call(name, read_arguments(c, Dialect::rapid, ""));
}

Value Rapid::call(const Expr& e) {
    std::vector<Value> a;
    std::map<std::string, double> options;
    for (const Argument& part : e.parts) {
        const Value v = part.value ? value_of(*part.value) : Value{};
        if (!part.optional) a.push_back(v);
        if (const auto n = v.as_number(); part.optional && n) options[part.name] = *n;
        if (part.optional && part.value && !v.as_number()) return Value::unknown(v.text);
    }
    const auto number = [&](std::size_t i) { return i < a.size() ? a[i].as_number() : std::nullopt; };
    const auto unknown = [&] {
        for (const Value& v : a)
            if (!v.known() && !v.text.empty()) return Value::unknown(v.text);
        return Value::unknown(shown(e));
    };
    if ((e.text == "offs" || e.text == "reltool") && a.size() == 4) {
        const auto target = pose_at(a[0]);
        const auto x = number(1), y = number(2), z = number(3);
        if (!target || !x || !y || !z) return unknown();
        Pose moved = *target;
        if (e.text == "offs") {
            moved.translation() += Eigen::Vector3d(*x, *y, *z);
        } else {  // displaced, then turned about x, y, z of the tool as it then stands
            const Eigen::Matrix3d turn =
                (Eigen::AngleAxisd(rad_from_deg(options["rx"]), Eigen::Vector3d::UnitX()) *
                 Eigen::AngleAxisd(rad_from_deg(options["ry"]), Eigen::Vector3d::UnitY()) *
                 Eigen::AngleAxisd(rad_from_deg(options["rz"]), Eigen::Vector3d::UnitZ()))
                    .toRotationMatrix();
            moved = *target * make_pose(turn, {*x, *y, *z});
        }
        Value v = a[0];
        const Value pose = rapid_pose_value(moved);
        v.parts[0] = pose.parts[0];
        v.parts[1] = pose.parts[1];
        return v;
    }
    if (e.text == "posemult" && a.size() == 2) {
        const auto p = pose_at(a[0]), q = pose_at(a[1]);
        return p && q ? rapid_pose_value(*p * *q) : unknown();
    }
    if (e.text == "poseinv" && a.size() == 1) {
        const auto p = pose_at(a[0]);
        return p ? rapid_pose_value(p->inverse()) : unknown();
    }
    if (e.text == "posevect" && a.size() == 2) {
        const auto p = pose_at(a[0]);
        const auto v = vector_of(a[1]);
        if (!p || !v) return unknown();
        const Eigen::Vector3d r = *p * *v;
        return Value::numbers({r.x(), r.y(), r.z()});
    }
    if (e.text == "orientzyx" && a.size() == 3) {
        const auto z = number(0), y = number(1), x = number(2);
        if (!x || !y || !z) return unknown();
        const AbbQuaternion q = abb_from_rotation(rotation_from_kuka({*z, *y, *x}));
        return Value::numbers({q.w, q.x, q.y, q.z});
    }
    if (e.text == "dim" && a.size() == 2 && a[0].kind == Value::Kind::list && number(1) == 1.0)
        return Value::of(static_cast<double>(a[0].parts.size()));
    if (const auto x = number(0); x && a.size() == 1) {
        if (e.text == "sin") return Value::of(std::sin(rad_from_deg(*x)));
        if (e.text == "cos") return Value::of(std::cos(rad_from_deg(*x)));
        if (e.text == "tan") return Value::of(std::tan(rad_from_deg(*x)));
        if (e.text == "abs") return Value::of(std::abs(*x));
        if (e.text == "sqrt" && *x >= 0) return Value::of(std::sqrt(*x));
        if (e.text == "trunc" && options.empty()) return Value::of(std::trunc(*x));
        if (e.text == "round" && options.empty()) return Value::of(std::round(*x));
    }
    if (const auto x = number(0), y = number(1); x && y && e.text == "pow")
        return Value::of(std::pow(*x, *y));
    return unknown();
}

bool Rapid::declares(const Cursor& c) {
    for (const std::size_t i : {0, 1}) {
        if (c.is("const", i) || c.is("pers", i) || c.is("var", i))
            return i == 0 || c.is("local") || c.is("task");
    }
    return false;
}

void Rapid::declaration(Cursor& c) {
    const bool local = c.accept("local");
    if (!local) c.accept("task");
    const std::string kind = c.take().text;
    const std::string type = c.name();
    const std::string name = c.name();
    const bool array = c.accept("{");
    if (array) read_arguments(c, Dialect::rapid, "}");
    Value value = Value::unknown(name);
    if (c.accept(":="))
        value = value_of(*read_expression(c, Dialect::rapid));
    else if (!array && kind == "var" && type == "num" && in_routine())
        value = Value::of(0);  // as the manual says
    value.constant = kind == "const";
    declare(name, std::move(value), in_routine() ? Reach::routine : local ? Reach::module : Reach::all);
    note(LineKind::understood);
}

// Incr n; Add n, 5; nullopt: none of them.
std::optional<Value> Rapid::counted(const std::string& name, const std::vector<Argument>& arguments) {
    const bool add = name == "add";
    if (!add && name != "incr" && name != "decr" && name != "clear") return {};
    if (arguments.size() != (add ? 2U : 1U)) throw Misread("arguments");
    for (const Argument& a : arguments)
        if (!a.value) throw Misread("arguments");
    if (name == "clear") return Value::of(0);
    const auto n = value_of(*arguments[0].value).as_number(),
               by = add ? value_of(*arguments[1].value).as_number()
                        : std::optional(name == "incr" ? 1.0 : -1.0);
    return n && by ? Value::of(*n + *by) : Value::unknown(shown(*arguments[0].value));
}

Machine::Flow Rapid::instruction_call(const std::string& name, const std::vector<Argument>& arguments) {
    if (name == "pdispset" && arguments.size() == 1 && arguments[0].value) {
        const Value v = value_of(*arguments[0].value);
        displaced_ = true;
        displacement_ = in_doubt() ? std::nullopt : pose_at(v);
        note(LineKind::understood);
    } else if (name == "pdispoff") {
        displaced_ = in_doubt();
        displacement_.reset();
        note(LineKind::understood);
    } else if (name == "pdispon") {
        displaced_ = true;
        displacement_.reset();
        note(LineKind::understood);
    } else {
        Flow flow = Flow::on;
        if (enter(name, arguments, flow)) {
            note(LineKind::understood);
            return flow;
        }
        if (auto value = counted(name, arguments)) {
            assign(*arguments[0].value, *std::move(value));
            note(LineKind::understood);
            return Flow::on;
        }
        static const std::set<std::string> idle = {
            "confl",      "confj",     "singarea", "accset",   "velset",       "waittime", "waitdi",
            "waitdo",     "waituntil", "setdo",    "set",      "reset",        "setgo",    "setao",
            "pulsedo",    "tpwrite",   "tperase",  "gripload", "speedrefresh", "triggio",  "triggequip",
            "waitrob",    "clkstart",  "clkstop",  "clkreset", "isignaldi",    "idelete",  "motsup",
            "pathaccset", "acttool",   "isleep",   "iwatch",   "setdi",        "errwrite"};
        const bool known = idle.count(name) > 0;
        note(LineKind::passed_over, known ? Text() : Text("{} is not in the files that were read", name));
        for (const Argument& a : arguments)  // \TimeFlag:=late
            if (!known || (a.optional && a.value)) lose({a});
    }
    return Flow::on;
}

std::optional<Pose> Rapid::frame_of(const Value& wobj) const {
    if (wobj.kind != Value::Kind::list || wobj.parts.size() < 5) return {};
    if (truth_at(wobj, 0) != false || truth_at(wobj, 1) != true) return {};
    const auto user = pose_at(wobj.parts[3]), object = pose_at(wobj.parts[4]);
    return user && object ? std::optional(*user * *object) : std::nullopt;
}

void Rapid::motion(const Instruction& how, const std::vector<Argument>& arguments) {
    std::vector<const Argument*> places;
    const Argument* wobj = nullptr;
    bool relative = false;
    for (const Argument& a : arguments) {
        if (!a.optional)
            places.push_back(&a);
        else if (a.name == "wobj")
            wobj = &a;
        else if (a.name == "corr")
            relative = true;
    }
    // SearchL \Stop, signal, SearchPoint, ToPoint
    if (how.search) return gap("a search moves until the cell stops it");
    if (how.only_external) return gap("external axes alone move here");
    if (relative) return gap("a path correction from elsewhere is added here");
    const std::size_t count = how.motion == ProgramMotion::circular ? 2 : 1;
    if (places.size() < count + 1) throw Misread("too few arguments");
    // The tool stands last.
    const Expr& tool = *places.back()->value;
    const Value tool_data = value_of(tool);
    const bool has_frame = tool_data.kind == Value::Kind::list && tool_data.parts.size() > 1;
    set_tool(tool_data.known() || tool_data.text.empty() ? shown(tool) : tool_data.text,
             has_frame ? tool_data.parts[1] : Value{});
    fixed_tool_ = truth_at(tool_data, 0) == false;
    if (how.absolute) return joint_values();
    NamedPose frame{"", Pose::Identity()};
    if (wobj && wobj->value) {
        const Value data = value_of(*wobj->value);
        frame.name = data.known() || data.text.empty() ? shown(*wobj->value) : data.text;
        frame.pose = data.known() ? frame_of(data) : std::nullopt;
        if (truth_at(data, 0) == true) fixed_tool_ = true;
        if (data.known() && truth_at(data, 1) == false)
            return gap(Text("{} moves with a positioner", frame.name));
        if (frame.name == "wobj0") frame.name.clear();
        frame.changed = !frame.pose && (data.known() || data.text.ends_with('?'));
    }
    set_frame(std::move(frame));
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < count; ++i) {
        if (!places[i]->value) throw Misread("a position is missing");
        const Value v = value_of(*places[i]->value);
        const auto pose = pose_at(v);
        if (!pose)
            return gap(
                Text("{} is not known from the program", v.known() ? shown(*places[i]->value) : v.text));
        if (displaced_ && !displacement_)
            return gap("a displacement acts here that the program does not say");
        poses.push_back(displaced_ ? *displacement_ * *pose : *pose);
    }
    const auto& target = places[count - 1]->value;
    const std::string name = target->kind == Expr::Kind::list ? std::string() : shown(*target);
    if (how.motion == ProgramMotion::circular)
        arc(poses[0], poses[1], name);
    else
        move(poses[0], how.motion, name);
}

std::unique_ptr<Machine> rapid_machine(const ProgramPathOptions& options) {
    return std::make_unique<Rapid>(options);
}

}  // namespace seamwright::program_path
