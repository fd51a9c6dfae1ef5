// FANUC's TP programs as ASCII (.ls): /MN with the motions, /POS with the positions.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/geometry/notation.h"
#include "devices/robot_path/machine.h"

namespace seamwright::program_path {
namespace {

struct Position {
    std::optional<Pose> pose;
    bool joints = false;
    std::string frame, tool, label;
};

std::optional<double> number_behind(std::string_view body, std::string_view key) {
    for (std::size_t at = 0; (at = body.find(key, at)) != std::string_view::npos; at += key.size()) {
        if (at > 0 && (std::isalnum(static_cast<unsigned char>(body[at - 1])) != 0 || body[at - 1] == '_'))
            continue;
        std::size_t from = body.find_first_not_of(" \t\r\n", at + key.size());
        if (from == std::string_view::npos || (body[from] != '=' && body[from] != ':')) continue;
        from = body.find_first_not_of(" \t\r\n+", from + 1);
        if (from == std::string_view::npos) return {};
        double value = 0;
        const auto [end, problem] = std::from_chars(body.data() + from, body.data() + body.size(), value);
        if (problem != std::errc() || !std::isfinite(value) || std::abs(value) > 1e9) return {};
        return value;
    }
    return {};
}

Pose pose_from(const std::array<double, 6>& n) {
    return make_pose(rotation_from_fanuc({n[3], n[4], n[5]}), {n[0], n[1], n[2]});
}
Value fanuc_pose_value(const Pose& pose) {
    const FanucWpr r = fanuc_from_rotation(pose.linear());
    const Eigen::Vector3d& t = pose.translation();
    return Value::numbers({t.x(), t.y(), t.z(), r.w_deg, r.p_deg, r.r_deg});
}

class Fanuc final : public Machine {
  public:
    explicit Fanuc(const ProgramPathOptions& options) : Machine(Dialect::rapid, options) {
        set_frame({"", Pose::Identity()});
    }

    void load(int file, std::string_view text) override {
        std::string section, name = "program", statement;
        int line = 0, begin = 0, position_line = 0;
        std::string position;
        std::vector<Statement> flat;
        while (!text.empty()) {
            ++line;
            const std::size_t end = std::min(text.find('\n'), text.size());
            std::string_view now = text.substr(0, end);
            text.remove_prefix(std::min(end + 1, text.size()));
            const std::size_t first = now.find_first_not_of(" \t\r");
            if (first == std::string_view::npos) continue;
            now = now.substr(first, now.find_last_not_of(" \t\r") - first + 1);
            if (now.front() == '/' && !now.starts_with("//")) {
                section = std::string(now.substr(0, now.find_first_of(" \t")));
                if (section == "/PROG") {
                    const auto at = now.find_first_not_of(" \t", 5);
                    if (at != std::string_view::npos)
                        name = std::string(now.substr(at, now.find_first_of(" \t", at) - at));
                }
                note(file, line, LineKind::understood);
                continue;
            }
            if (section == "/MN") {
                const std::size_t colon = now.find(':');
                const bool numbered =
                    colon != std::string_view::npos && now.find_first_not_of("0123456789 ") == colon;
                if (numbered) now.remove_prefix(colon + 1);
                if (statement.empty()) begin = line;
                statement += std::string(now) + " ";
                if (!now.ends_with(";")) continue;
                Statement s;
                s.file = file;
                s.line = begin;
                const std::size_t from = statement.find_first_not_of(" \t");
                const std::string_view said =
                    std::string_view(statement).substr(std::min(from, statement.size()));
                if (!said.starts_with("//") && !said.starts_with("--") && !said.starts_with("!"))
                    for (Token& t : tokens_of(said, Dialect::rapid))
                        if (t.kind != Token::Kind::newline && t.text != ";") {
                            t.line = begin;
                            s.tokens.push_back(std::move(t));
                        }
                statement.clear();
                if (s.tokens.empty()) continue;  // a comment
                note(file, begin, LineKind::not_reached);
                flat.push_back(std::move(s));
            } else if (section == "/POS") {
                if (position.empty()) position_line = line;
                position += std::string(now) + "\n";
                if (position.find('}') == std::string::npos && position.size() < 10000) continue;
                read_position(file, position_line, position, file == 0);
                position.clear();
            }
        }
        Routine routine;
        routine.file = file;
        routine.name = name;
        std::size_t at = 0;
        while (at < flat.size()) {
            for (Statement& s : block(flat, at, 0)) routine.body.push_back(std::move(s));
            if (at < flat.size()) routine.body.push_back(flat[at++]);  // a closing word of nothing
        }
        if (routines_.count(name) > 0) return;
        routine_order_.push_back(name);
        routines_[name] = std::move(routine);
    }

  protected:
    bool moves(const std::string& word) const override {
        return word == "j" || word == "l" || word == "c" || word == "a" || word == "s";
    }

    void begin() override {
        for (const auto& [name, pose] : options_.frames) {
            std::string plain;
            for (const char c : name)
                if (c != ' ') plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
            if (plain.starts_with("pr["))
                globals_[plain] = fanuc_pose_value(pose);
            else if (plain.starts_with("uframe[") && plain.ends_with("]"))
                frames_["UF " + plain.substr(7, plain.size() - 8)] = pose;
            else if (plain.starts_with("uf"))
                frames_["UF " + plain.substr(2)] = pose;
        }
    }

    Flow execute(const Statement& s) override {
        const std::vector<Token> tokens = collapsed(s.tokens, true);
        Cursor c(tokens);
        const std::string word = c.peek().text;
        if (moves(word) && (c.peek(1).text.starts_with("p[") || c.peek(1).text.starts_with("pr["))) {
            c.take();
            motion(word, c);
            return Flow::on;
        }
        if (word == "uframe_num" || word == "utool_num") {
            c.take();
            c.expect("=");
            const auto n = value_of(*read_expression(c, Dialect::rapid)).as_number();
            std::string& kept = word == "uframe_num" ? frame_number_ : tool_number_;
            kept = n && !in_doubt() ? fmt::format("{:.0f}", *n) : "?";
            note(LineKind::understood);
        } else if ((word == "offset" || word == "tool_offset") && c.is("condition", 1)) {
            c.take(), c.take();
            (word == "offset" ? offset_ : tool_offset_) = c.peek().text;
            note(LineKind::understood);
        } else if (c.is("=", 1) && (word.starts_with("r[") || word.starts_with("pr[") ||
                                    word.starts_with("uframe[") || word.starts_with("p["))) {
            c.take(), c.take();
            give(word, c);
        } else if (word == "lbl" || word.starts_with("lbl[")) {
            note(LineKind::understood);
        } else if (word == "end" || word == "abort") {
            note(LineKind::understood);
            return Flow::back;
        } else if (word == "jmp") {
            note(LineKind::understood);
            remark("a loop made by a jump back is read once");
        } else if (word == "select" ||
                   (word == "if" && std::any_of(tokens.begin(), tokens.end(),
                                                [](const Token& t) { return t.text == "jmp"; }))) {
            note(LineKind::not_understood, "jumps are not followed");
        } else if (word == "call" || word == "run") {
            c.take();
            Flow flow = Flow::on;
            std::string name = c.peek().text;
            std::transform(name.begin(), name.end(), name.begin(),
                           [](unsigned char x) { return std::toupper(x); });
            if (word == "call" && enter(name, {}, flow))
                note(LineKind::understood);
            else
                note(LineKind::passed_over, Text("{} is not in the files that were read", name));
        } else {
            note(LineKind::passed_over);
        }
        return Flow::on;
    }

    Value call(const Expr& e) override { return Value::unknown(shown(e)); }

  private:
    // R[1:count], P[3], PR[2,3], LBL[4:x] as one word each. With `with_registers` P[R[1]] too, by what R[1] holds.
    std::vector<Token> collapsed(const std::vector<Token>& tokens, bool with_registers) {
        std::vector<Token> out;
        for (std::size_t i = 0; i < tokens.size(); ++i) {
            const bool opens =
                tokens[i].kind == Token::Kind::name && i + 1 < tokens.size() && tokens[i + 1].text == "[";
            if (!opens) {
                out.push_back(tokens[i]);
                continue;
            }
            Token t = tokens[i];
            std::size_t at = i + 2;
            t.text += "[";
            for (int item = 0; item < 3 && at < tokens.size(); ++item) {
                if (item > 0) t.text += ",";
                if (tokens[at].kind == Token::Kind::number) {
                    t.text += fmt::format("{:.0f}", tokens[at].number);
                    ++at;
                } else if (tokens[at].text == "r" && at + 2 < tokens.size() && tokens[at + 1].text == "[" &&
                           tokens[at + 2].kind == Token::Kind::number) {
                    const Value* r =
                        with_registers ? variable(fmt::format("r[{:.0f}]", tokens[at + 2].number)) : nullptr;
                    const auto n = r ? r->as_number() : std::nullopt;
                    t.text += n ? fmt::format("{:.0f}", *n) : "?";
                    while (at < tokens.size() && tokens[at].text != "]") ++at;
                    ++at;
                } else {
                    t.text += "?";
                }
                if (at >= tokens.size() || tokens[at].text != ",") break;
                ++at;
            }
            while (at < tokens.size() && tokens[at].text != "]") ++at;
            t.text += "]";
            out.push_back(std::move(t));
            i = at;
        }
        return out;
    }

    ExprPtr condition(const std::vector<Token>& tokens, std::size_t from, std::size_t to) {
        const std::vector<Token> some(tokens.begin() + static_cast<std::ptrdiff_t>(from),
                                      tokens.begin() + static_cast<std::ptrdiff_t>(to));
        const std::vector<Token> words = collapsed(some, false);
        try {
            Cursor c(words);
            auto e = read_expression(c, Dialect::rapid);
            if (c.done()) return e;
        } catch (const Misread&) {
        }
        auto e = std::make_shared<Expr>();
        e->kind = Expr::Kind::name;
        e->text = "?";
        return e;
    }

    static std::size_t index_of(const std::vector<Token>& tokens, std::string_view word) {
        const auto at =
            std::find_if(tokens.begin(), tokens.end(), [&](const Token& t) { return t.text == word; });
        return static_cast<std::size_t>(at - tokens.begin());
    }
    static std::string label_of(const std::vector<Token>& tokens, std::size_t from) {
        for (std::size_t i = from; i + 2 < tokens.size(); ++i)
            if (tokens[i].text == "lbl" && tokens[i + 1].text == "[" &&
                tokens[i + 2].kind == Token::Kind::number)
                return fmt::format("{:.0f}", tokens[i + 2].number);
        return {};
    }
    static bool closes(const Statement& s) {
        const std::string& word = s.tokens.front().text;
        return word == "else" || word == "endif" || word == "endfor";
    }

    // Up to a closing word. A jump forward over statements of the same block leaves them out, or, with a condition, makes
    // them hang on it.
    Block block(const std::vector<Statement>& flat, std::size_t& at, int depth) {
        Block all;
        while (at < flat.size() && !closes(flat[at])) {
            const Statement& now = flat[at];
            const std::string& word = now.tokens.front().text;
            const std::size_t then = index_of(now.tokens, "then"), jmp = index_of(now.tokens, "jmp");
            Statement s;
            s.file = now.file;
            s.line = now.line;
            if (depth < kDeepestNesting && word == "if" && then < now.tokens.size()) {
                s.kind = Statement::Kind::branch;
                auto asked = condition(now.tokens, 1, then);
                ++at;
                s.branches.emplace_back(asked, block(flat, at, depth + 1));
                if (at < flat.size() && flat[at].tokens.front().text == "else") {
                    ++at;
                    s.branches.emplace_back(nullptr, block(flat, at, depth + 1));
                }
                if (at < flat.size() && flat[at].tokens.front().text == "endif") ++at;
            } else if (depth < kDeepestNesting && word == "for") {
                const std::vector<Token>& t = now.tokens;
                const std::size_t equals = index_of(t, "="), to = index_of(t, "to"),
                                  down = index_of(t, "downto");
                s.kind = Statement::Kind::count;
                const std::vector<Token> variable = collapsed(
                    {t.begin() + 1, t.begin() + static_cast<std::ptrdiff_t>(std::min(equals, t.size()))},
                    false);
                s.variable = variable.empty() ? "?" : variable.front().text;
                const std::size_t split = std::min(to, down);
                s.from = condition(t, std::min(equals + 1, t.size()),
                                   std::max(std::min(equals + 1, t.size()), std::min(split, t.size())));
                s.to = condition(t, std::min(split + 1, t.size()), t.size());
                auto step = std::make_shared<Expr>();
                step->number = down < to ? -1 : 1;
                s.step = step;
                ++at;
                s.branches.emplace_back(nullptr, block(flat, at, depth + 1));
                if (at < flat.size() && flat[at].tokens.front().text == "endfor") ++at;
            } else if (depth < kDeepestNesting && jmp < now.tokens.size() &&
                       (word == "jmp" || word == "if")) {
                const std::string label = label_of(now.tokens, jmp);
                std::size_t end = at + 1;
                int nested = 0;
                bool found = false, labelled = false;
                for (; end < flat.size(); ++end) {
                    const std::string& w = flat[end].tokens.front().text;
                    if (nested == 0 && w == "lbl") {
                        found = label_of(flat[end].tokens, 0) == label;
                        if (found) break;
                        labelled = true;
                    }
                    if ((w == "if" && index_of(flat[end].tokens, "then") < flat[end].tokens.size()) ||
                        w == "for")
                        ++nested;
                    if ((w == "endif" || w == "endfor") && nested-- == 0) break;
                }
                std::size_t comma = index_of(now.tokens, ",");
                if (!found || label.empty()) {
                    s.tokens = now.tokens;
                    ++at;
                } else {
                    const std::vector<Statement> over(flat.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                                                      flat.begin() + static_cast<std::ptrdiff_t>(end));
                    at = end;
                    auto staying = std::make_shared<Expr>();
                    if (word == "jmp" && !labelled) {
                        staying->kind = Expr::Kind::truth;
                    } else if (word == "jmp" || labelled) {
                        staying->kind = Expr::Kind::name;
                        staying->text = "a jump";
                    } else {
                        staying->kind = Expr::Kind::unary;
                        staying->text = "not";
                        staying->parts = {{{}, condition(now.tokens, 1, std::min(comma, jmp))}};
                    }
                    s.kind = Statement::Kind::branch;
                    std::size_t inner = 0;
                    Block body;
                    while (inner < over.size()) {
                        for (Statement& i : block(over, inner, depth + 1)) body.push_back(std::move(i));
                        if (inner < over.size()) body.push_back(over[inner++]);
                    }
                    s.branches.emplace_back(staying, std::move(body));
                }
            } else {
                s.tokens = now.tokens;
                ++at;
            }
            all.push_back(std::move(s));
        }
        return all;
    }

    void read_position(int file, int line, std::string_view text, bool mine) {
        const std::size_t open = text.find('['), close = text.find(']'), brace = text.find('{');
        note(file, line, LineKind::understood);
        if (open == text.npos || close == text.npos || brace == text.npos || close < open || close > brace) {
            note(file, line, LineKind::not_understood, "this is not known here");
            return;
        }
        const std::string_view name = text.substr(open + 1, close - open - 1);
        int number = 0;
        std::from_chars(name.data(), name.data() + name.size(), number);
        std::string_view body = text.substr(brace + 1);
        for (const char* other : {"GP2", "GP3", "GP4", "GP5"})  // of another group: a positioner's
            if (const auto at = body.find(other); at != body.npos) body = body.substr(0, at);
        Position p;
        if (const auto colon = name.find(':'); colon != name.npos)
            p.label = std::string(name.substr(colon + 1));
        p.joints = number_behind(body, "J1").has_value();
        const auto uf = number_behind(body, "UF"), ut = number_behind(body, "UT");
        p.frame = uf ? fmt::format("{:.0f}", *uf) : "F";
        p.tool = ut ? fmt::format("{:.0f}", *ut) : "F";
        std::array<double, 6> n{};
        const char* keys[] = {"X", "Y", "Z", "W", "P", "R"};
        bool whole = true;
        for (std::size_t i = 0; i < 6; ++i) {
            const auto value = number_behind(body, keys[i]);
            whole = whole && value;
            n[i] = value.value_or(0);
        }
        if (whole) p.pose = pose_from(n);
        if (mine) positions_[number] = std::move(p);
    }

    void give(const std::string& word, Cursor& c) {
        note(LineKind::understood);
        const auto put = [&](Value v) { globals_[word] = in_doubt() ? Value::unknown(word) : std::move(v); };
        if (word.starts_with("p[")) {
            int n = 0;
            std::from_chars(word.data() + 2, word.data() + word.size(), n);
            positions_[n].pose.reset();  // from here on it is what the program computes
            positions_[n].joints = false;
            return;
        }
        if (word.starts_with("r[")) return put(value_of(*read_expression(c, Dialect::rapid)));
        if (word.starts_with("uframe[")) {
            const Value v = value_of(*read_expression(c, Dialect::rapid));
            const std::string name = "UF " + word.substr(7, word.size() - 8);
            const auto n = in_doubt() ? std::nullopt : six_numbers(v);
            if (n)
                frames_[name] = pose_from(*n);
            else
                frames_[name] = std::nullopt;
            return;
        }
        if (const auto comma = word.find(','); comma != word.npos) {  // PR[i,j]
            Value& v = globals_[word.substr(0, comma) + "]"];
            int j = 0;
            std::from_chars(word.data() + comma + 1, word.data() + word.size(), j);
            const Value element = value_of(*read_expression(c, Dialect::rapid));
            if (j < 1 || j > 6 || in_doubt() || !element.as_number()) {
                v = Value::unknown(word);
                return;
            }
            if (v.kind != Value::Kind::list || v.parts.size() != 6)
                v = Value::list(std::vector<Value>(6, Value::unknown(word.substr(0, comma) + "]")));
            v.parts[static_cast<std::size_t>(j - 1)] = element;
            return;
        }
        // PR[1]=P[2], PR[1]=LPOS, PR[1]=PR[2]+PR[3]
        Value sum;
        for (double sign = 1;;) {
            const Token t = c.take();
            Value term = Value::unknown(t.text);
            if (t.text.starts_with("p[")) {
                int n = 0;
                std::from_chars(t.text.data() + 2, t.text.data() + t.text.size(), n);
                const auto at = positions_.find(n);
                if (at != positions_.end() && at->second.pose) term = fanuc_pose_value(*at->second.pose);
            } else if (t.text == "lpos" && here()) {
                term = fanuc_pose_value(*here());
            } else if (const Value* known = variable(t.text)) {
                term = *known;
            }
            const auto a = six_numbers(sum), b = six_numbers(term);
            if (!sum.known() && sum.text.empty()) {
                sum = std::move(term);
            } else if (a && b) {
                for (std::size_t i = 0; i < 6; ++i) sum.parts[i] = Value::of((*a)[i] + sign * (*b)[i]);
            } else {
                sum = Value::unknown(t.text);
            }
            if (c.accept("+"))
                sign = 1;
            else if (c.accept("-"))
                sign = -1;
            else
                break;
        }
        put(std::move(sum));
    }

    NamedPose user_frame(const std::string& number) const {
        if (number == "0") return {"", Pose::Identity()};
        const std::string name = "UF " + number;
        const auto at = frames_.find(name);
        return {name, at == frames_.end() ? std::nullopt : at->second};
    }

    std::optional<Position> position(const std::string& word) {
        const bool stored = word.starts_with("p[");
        if (stored) {
            int n = 0;
            std::from_chars(word.data() + 2, word.data() + word.size(), n);
            const auto at = positions_.find(n);
            if (at == positions_.end()) return {};
            return at->second;
        }
        const Value* v = variable(word);
        const auto n = v ? six_numbers(*v) : std::nullopt;
        if (!n) return {};
        Position p;
        p.pose = pose_from(*n);
        p.frame = p.tool = "F";
        return p;
    }

    void motion(const std::string& word, Cursor& c) {
        if (word == "a") return gap("arcs of A are not followed");
        std::vector<std::string> names = {c.take().text};
        while (c.peek().text.starts_with("p[") || c.peek().text.starts_with("pr["))
            names.push_back(c.take().text);
        if (names.size() != (word == "c" ? 2U : 1U)) throw Misread("positions");
        bool incremental = false;
        std::string offset, tool_offset;
        while (!c.done()) {
            const std::string t = c.take().text;
            if (t == "inc") incremental = true;
            if (t == "coord" || t == "rtcp" || t.starts_with("coord["))
                return gap("it follows a positioner or a tool that stands fixed");
            if (t == "skip" || t == "voffset" || t == "vis" || t == "track")
                return gap("it ends or shifts by what the cell says");
            if (t == "offset" || t == "tool_offset") {
                std::string& which = t == "offset" ? offset : tool_offset;
                which = t == "offset" ? offset_ : tool_offset_;
                if (c.accept(",")) which = c.peek().text;
                if (which.empty()) return gap("its offset is not known from the program");
            }
        }
        const auto shift = [&](const std::string& name) -> std::optional<Pose> {
            if (name.empty()) return Pose::Identity();
            const Value* v = variable(name);
            const auto n = v ? six_numbers(*v) : std::nullopt;
            return n ? std::optional(pose_from(*n)) : std::nullopt;
        };
        const auto in_frame = shift(offset), in_tool = shift(tool_offset);
        std::vector<Pose> poses;
        for (const std::string& name : names) {
            const auto p = position(name);
            if (p && p->joints) return joint_values();
            if (!p || !p->pose) return gap(Text("{} is not known from the program", capitals(name)));
            set_frame(user_frame(p->frame == "F" ? frame_number_ : p->frame));
            tool_ = "UT " + (p->tool == "F" ? tool_number_ : p->tool);
            Pose pose = *p->pose;
            if (incremental) {
                if (!here()) return gap("where this relative motion begins is not known");
                if (!pose.linear().isApprox(Eigen::Matrix3d::Identity(), 1e-9))
                    return gap("a relative motion that turns");
                pose = make_pose(here()->linear(), here()->translation() + pose.translation());
            }
            if (!in_frame) return gap(Text("{} is not known from the program", capitals(offset)));
            if (!in_tool) return gap(Text("{} is not known from the program", capitals(tool_offset)));
            if (!in_frame->linear().isApprox(Eigen::Matrix3d::Identity(), 1e-9))
                return gap("an offset that turns");
            pose.translation() += in_frame->translation();
            poses.push_back(pose * *in_tool);
        }
        const std::string name = capitals(names.back());
        if (word == "c")
            arc(poses[0], poses[1], name);
        else
            move(poses[0],
                 word == "j"   ? ProgramMotion::joint
                 : word == "s" ? ProgramMotion::spline
                               : ProgramMotion::linear,
                 name);
    }

    static std::string capitals(std::string name) {
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return std::toupper(c); });
        return name;
    }

    std::map<int, Position> positions_;
    std::map<std::string, std::optional<Pose>> frames_;
    std::string frame_number_ = "?", tool_number_ = "?", offset_, tool_offset_;
};

}  // namespace

std::unique_ptr<Machine> fanuc_machine(const ProgramPathOptions& options) {
    return std::make_unique<Fanuc>(options);
}

}  // namespace seamwright::program_path
