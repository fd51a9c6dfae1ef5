// URScript, as people write it and as PolyScope saves it.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {
namespace {

std::optional<Pose> ur_pose(const Value& v) {
    const auto n = v.pose ? six_numbers(v) : std::nullopt;
    if (!n) return {};
    return make_pose(rotation_from_ur({(*n)[3], (*n)[4], (*n)[5]}),
                     1000 * Eigen::Vector3d((*n)[0], (*n)[1], (*n)[2]));
}
Value ur_pose_value(const Pose& pose) {
    const Eigen::Vector3d t = pose.translation() / 1000, w = ur_from_rotation(pose.linear());
    Value v = Value::numbers({t.x(), t.y(), t.z(), w.x(), w.y(), w.z()});
    v.pose = true;
    return v;
}

class UrScript final : public Machine {
  public:
    explicit UrScript(const ProgramPathOptions& options) : Machine(Dialect::urscript, options) {
        globals_["pi"] = Value::of(kPi);
    }

    void load(int file, std::string_view text) override {
        lines_.clear();
        at_ = 0;
        file_ = file;
        std::vector<Token> line;
        int open = 0;  // a bracket goes on over the line's end
        for (Token& t : tokens_of(text, Dialect::urscript)) {
            if (t.text == "(" || t.text == "[") ++open;
            if (t.text == ")" || t.text == "]") open = std::max(0, open - 1);
            const bool ends =
                t.kind == Token::Kind::newline ? open == 0 || line.size() > 10000 : t.text == ";";
            if (!ends && t.kind != Token::Kind::newline) {
                line.push_back(std::move(t));
            } else if (ends && !line.empty()) {
                note(file, line.front().line, LineKind::not_reached);
                lines_.push_back(std::exchange(line, {}));
                open = 0;
            }
        }
        if (!line.empty()) lines_.push_back(std::move(line));
        Block top = block({}, 0);
        while (at_ < lines_.size()) {  // a closing word of nothing
            note(file, lines_[at_].front().line, LineKind::not_understood, "this is not known here");
            ++at_;
            for (Statement& s : block({}, 0)) top.push_back(std::move(s));
        }
        std::set<std::string> ignored;
        if (file == 0 && !top.empty()) {  // lines outside of any def: they are a program by themselves
            Routine script;
            script.name = "(script)";
            script.body = std::move(top);
            routine_order_.push_back(script.name);
            add_routine(std::move(script));
        } else {
            for (const Statement& s : top) run_statement(s);
        }
    }

  protected:
    std::string module_name(const Source& /*source*/) const override { return {}; }  // one for all
    bool moves(const std::string& word) const override {
        static const std::set<std::string> words = {
            "movel",  "movej",  "movep", "movec",  "servoj",          "servoc",
            "speedl", "speedj", "movet", "servol", "force_mode_move", "conveyor_pulse_decode_move"};
        return words.count(word) > 0;
    }

    void begin() override {
        std::set<std::string> seen;
        for (const Block& thread : threads_) collect_volatile(thread, seen);
        for (const auto& [name, pose] : options_.frames) globals_[name] = ur_pose_value(pose);
    }

    Flow execute(const Statement& s) override {
        Cursor c(s.tokens);
        if (moves(c.peek().text) && c.is("(", 1)) {
            const auto e = read_expression(c, Dialect::urscript);
            motion(*e);
            return Flow::on;
        }
        const std::string word = c.peek().text;
        if (word == "return") {
            c.take();
            return give_back(c.done() ? Value{} : value_of(*read_expression(c, Dialect::urscript)));
        }
        if (word == "continue") return turn_over();
        if (word == "break") return leave_loop();
        if (word == "halt") {
            note(LineKind::understood);
            return Flow::halt;
        }
        if (word == "pass" || word == "end" || word == "popup" || word == "run" || word == "join" ||
            word == "kill") {
            note(LineKind::passed_over);
            return Flow::on;
        }
        if (!c.accept("global")) c.accept("local");
        const auto place = read_expression(c, Dialect::urscript);
        if (c.accept("=")) {
            Value value =
                c.accept("run") ? Value::unknown("run") : value_of(*read_expression(c, Dialect::urscript));
            give(*place, word, std::move(value));
            note(LineKind::understood);
            return Flow::on;
        }
        if (place->kind != Expr::Kind::call || !c.done()) {
            note(LineKind::not_understood, "this is not known here");
            return Flow::on;
        }
        if (place->text == "set_tcp") {
            const Value v =
                place->parts.empty() || !place->parts[0].value ? Value{} : value_of(*place->parts[0].value);
            const auto pose = ur_pose(v);
            tool_ = pose ? fmt::format("set_tcp, line {}", now_line_) : v.text;
            if (pose && set_tool_ && set_tool_->isApprox(*pose, 1e-9)) tool_ = set_tool_name_;
            set_tool_ = pose;
            set_tool_name_ = tool_;
            note(LineKind::understood);
            return Flow::on;
        }
        Flow flow = Flow::on;
        if (enter(place->text, place->parts, flow))
            note(LineKind::understood);
        else
            note(LineKind::passed_over);
        return flow;
    }

    Value call(const Expr& e) override {
        std::vector<Value> a;
        for (const Argument& part : e.parts) a.push_back(part.value ? value_of(*part.value) : Value{});
        const auto unknown = [&] {
            for (const Value& v : a)
                if (!v.known() && !v.text.empty()) return Value::unknown(v.text);
            return Value::unknown(shown(e));
        };
        const auto pose = [&](std::size_t i) { return i < a.size() ? ur_pose(a[i]) : std::nullopt; };
        const auto number = [&](std::size_t i) { return i < a.size() ? a[i].as_number() : std::nullopt; };
        const std::string& f = e.text;
        if (f == "pose_trans") {
            const auto p = pose(0), q = pose(1);
            return p && q ? ur_pose_value(*p * *q) : unknown();
        }
        if (f == "pose_inv") {
            const auto p = pose(0);
            return p ? ur_pose_value(p->inverse()) : unknown();
        }
        if (f == "pose_add") {  // positions added, rotations one after the other
            const auto p = pose(0), q = pose(1);
            return p && q ? ur_pose_value(
                                make_pose(p->linear() * q->linear(), p->translation() + q->translation()))
                          : unknown();
        }
        if (f == "pose_sub") {
            const auto p = pose(0), q = pose(1);
            return p && q ? ur_pose_value(make_pose(q->linear().transpose() * p->linear(),
                                                    p->translation() - q->translation()))
                          : unknown();
        }
        if (f == "interpolate_pose") {
            const auto p = pose(0), q = pose(1);
            const auto share = number(2);
            if (!p || !q || !share) return unknown();
            const Eigen::Quaterniond from(p->linear()), to(q->linear());
            return ur_pose_value(
                make_pose(from.slerp(*share, to).toRotationMatrix(),
                          p->translation() + *share * (q->translation() - p->translation())));
        }
        if (f == "get_inverse_kin" && pose(0))
            return a[0];  // joint values that reach it: the pose is what counts
        if ((f == "get_actual_tcp_pose" || f == "get_target_tcp_pose") && here())
            return ur_pose_value(*here());
        if (f == "wrench_trans" || f == "make_list") return unknown();
        if (const auto x = number(0); x && a.size() == 1) {
            if (f == "d2r") return Value::of(rad_from_deg(*x));
            if (f == "r2d") return Value::of(deg_from_rad(*x));
            if (f == "sin") return Value::of(std::sin(*x));
            if (f == "cos") return Value::of(std::cos(*x));
            if (f == "tan") return Value::of(std::tan(*x));
            if (f == "sqrt" && *x >= 0) return Value::of(std::sqrt(*x));
            if (f == "floor") return Value::of(std::floor(*x));
            if (f == "ceil") return Value::of(std::ceil(*x));
            if (f == "norm") return Value::of(std::abs(*x));
        }
        if (const auto x = number(0), y = number(1); x && y) {
            if (f == "pow") return Value::of(std::pow(*x, *y));
            if (f == "atan2") return Value::of(std::atan2(*x, *y));
        }
        return unknown();
    }

  private:
    bool is(std::string_view word) const {
        return at_ < lines_.size() && lines_[at_].front().kind == Token::Kind::name &&
               lines_[at_].front().text == word;
    }

    // What stands in the program itself is everybody's; in its functions a name is, unless it is said, a global one
    // where there is one, else the function's own.
    void give(const Expr& place, const std::string& word, Value value) {
        const bool name = place.kind == Expr::Kind::name;
        if (in_doubt()) value = Value::unknown(shown(place));
        if (name && in_function() && (word == "local" || (word != "global" && !variable(place.text))))
            declare(place.text, std::move(value), Reach::routine);
        else if (name && word == "global")
            globals_[place.text] = std::move(value);
        else
            assign(place, std::move(value));
    }

    static ExprPtr condition(std::span<const Token> tokens) {
        try {
            Cursor c(tokens);
            return read_expression(c, Dialect::urscript);
        } catch (const Misread&) {
            auto e = std::make_shared<Expr>();
            e->kind = Expr::Kind::name;
            e->text = "?";
            return e;
        }
    }

    Block block(std::initializer_list<std::string_view> ends, int depth) {
        Block all;
        while (at_ < lines_.size()) {
            if (is("end") || is("elif") || is("else")) return all;
            for (const std::string_view end : ends)
                if (is(end)) return all;
            statement(all, depth);
        }
        return all;
    }

    void statement(Block& all, int depth) {
        const std::vector<Token> line = lines_[at_];
        const std::span<const Token> rest = std::span(line).subspan(1);
        Statement s;
        s.file = file_;
        s.line = line.front().line;
        const std::string& word = line.front().text;
        ++at_;
        const bool name = line.front().kind == Token::Kind::name && depth < kDeepestNesting;
        if (name && word == "if") {
            s.kind = Statement::Kind::branch;
            s.branches.emplace_back(condition(rest), block({}, depth + 1));
            while (is("elif")) {
                const std::vector<Token> next = lines_[at_++];
                s.branches.emplace_back(condition(std::span(next).subspan(1)), block({}, depth + 1));
            }
            if (is("else")) {
                ++at_;
                s.branches.emplace_back(nullptr, block({}, depth + 1));
            }
            if (is("end")) ++at_;
        } else if (name && word == "while") {
            s.kind = Statement::Kind::loop;
            auto asked = condition(rest);
            s.branches.emplace_back(asked, block({}, depth + 1));
            if (is("end")) ++at_;
        } else if (name && (word == "def" || word == "thread" || word == "sec")) {
            Routine r;
            r.file = file_;
            note(file_, s.line, LineKind::understood);
            Cursor c(rest);
            if (!c.done()) r.name = c.take().text;
            if (c.accept("(")) {
                while (!c.done() && !c.accept(")")) {
                    const Token t = c.take();
                    if (t.kind != Token::Kind::name) continue;
                    r.parameters.push_back({Parameter::Way::value, t.text, false, nullptr});
                    if (!c.accept("=")) continue;
                    try {
                        r.parameters.back().otherwise = read_expression(c, Dialect::urscript);
                    } catch (const Misread&) {
                    }
                }
            }
            r.body = block({}, depth + 1);
            if (is("end")) {
                note(file_, lines_[at_].front().line, LineKind::understood);
                ++at_;
            }
            if (word == "thread") threads_.push_back(r.body);
            if (word != "def" || r.name.empty() || routine(r.name, file_)) return;
            routine_order_.push_back(r.name);
            add_routine(std::move(r));
            return;
        } else {
            s.tokens = line;
        }
        all.push_back(std::move(s));
    }

    void motion(const Expr& e) {
        const std::string& word = e.text;
        if (word.starts_with("speed") || word.starts_with("servo") || word == "movet")
            return gap("a motion that follows what the program computes while it runs");
        std::vector<const Argument*> places;
        for (const Argument& a : e.parts) {
            if (a.name == "a" || a.name == "v" || a.name == "t" || a.name == "r" || a.name == "mode")
                continue;
            places.push_back(&a);
        }
        const std::size_t count = word == "movec" ? 2 : 1;
        if (places.size() < count) throw Misread("a position is missing");
        std::vector<Pose> poses;
        for (std::size_t i = 0; i < count; ++i) {
            if (!places[i]->value) throw Misread("a position is missing");
            const Value v = value_of(*places[i]->value);
            if (!v.pose && six_numbers(v)) return joint_values();
            if (!v.known() && v.text.ends_with("_q") && word == "movej") return joint_values();
            const auto pose = ur_pose(v);
            if (!pose)
                return gap(
                    Text("{} is not known from the program", v.known() ? shown(*places[i]->value) : v.text));
            poses.push_back(*pose);
        }
        const auto& target = places[count - 1]->value;
        const std::string name =
            target->kind == Expr::Kind::name || target->kind == Expr::Kind::index ? shown(*target) : "";
        if (word == "movec")
            arc(poses[0], poses[1], name);
        else
            move(poses[0], word == "movej" ? ProgramMotion::joint : ProgramMotion::linear, name);
    }

    // What threads give values to, themselves or by what they call, the program does not know.
    void collect_volatile(const Block& block, std::set<std::string>& seen) {
        for (const Statement& s : block) {
            for (const auto& [condition, inner] : s.branches) collect_volatile(inner, seen);
            for (std::size_t i = 0; i < s.tokens.size(); ++i) {
                const Token& t = s.tokens[i];
                if (t.kind != Token::Kind::name) continue;
                if (i + 1 < s.tokens.size() && s.tokens[i + 1].text == "=" &&
                    (i == 0 || s.tokens[i - 1].text == "global"))
                    volatile_.insert(t.text);
                const auto called = routines_.find(t.text);
                if (called != routines_.end() && seen.size() < 1000 && seen.insert(t.text).second)
                    collect_volatile(called->second.body, seen);
            }
        }
    }

    std::vector<Block> threads_;
    std::vector<std::vector<Token>> lines_;
    std::size_t at_ = 0;
    int file_ = 0;
    std::optional<Pose> set_tool_;
    std::string set_tool_name_;
};

}  // namespace

std::unique_ptr<Machine> urscript_machine(const ProgramPathOptions& options) {
    return std::make_unique<UrScript>(options);
}

}  // namespace seamwright::program_path
