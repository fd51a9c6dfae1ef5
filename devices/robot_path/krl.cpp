// KRL: .src with its .dat, $config.dat.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/notation.h"
#include "devices/robot_path/krl_blocks.h"
#include "devices/robot_path/krl_values.h"
#include "devices/robot_path/machine/machine.h"

namespace seamwright::program_path {
namespace {

class Krl final : public Machine {
  public:
    explicit Krl(const ProgramPathOptions& options) : Machine(Dialect::krl, options) {}

    void load(int file, std::string_view text) override {
        std::vector<std::vector<Token>> lines;
        std::vector<Token> line;
        for (Token& t : tokens_of(text, Dialect::krl)) {
            if (t.kind != Token::Kind::newline) {
                line.push_back(std::move(t));
            } else if (!line.empty()) {
                note(file, line.front().line, LineKind::not_reached);
                lines.push_back(std::exchange(line, {}));
            }
        }
        if (!lines.empty() && lines.front().front().text == "DEFDAT") return data_list(file, lines);
        KrlBlocks blocks(std::move(lines), file);
        bool first = true;  // the routine of the file's name is everybody's
        while (!blocks.done()) {
            if (!blocks.begins_routine()) {
                blocks.next();
                continue;
            }
            Routine routine;
            routine.file = file;
            Cursor head(blocks.line());
            try {
                routine.own = !head.accept("GLOBAL") && !std::exchange(first, false);
                if (head.take().text == "DEFFCT") routine.returns = number_type(head.name());
                while (head.accept("[") || head.accept(",") || head.accept("]")) {
                }
                routine.name = head.name();
                head.accept("(");
                while (!head.done() && !head.accept(")")) {
                    const Token t = head.take();
                    if (t.kind != Token::Kind::name) continue;
                    auto& all = routine.parameters;
                    if (!all.empty() && (t.text == "IN" || t.text == "OUT"))
                        all.back().way = t.text == "IN" ? Parameter::Way::value : Parameter::Way::reference;
                    else
                        all.push_back({Parameter::Way::either, t.text, false, nullptr});
                }
            } catch (const Misread&) {
            }
            note(file, blocks.line().front().line, LineKind::understood);
            blocks.next();
            routine.body = blocks.block({}, 0);
            if (!blocks.done() && !blocks.begins_routine()) {
                note(file, blocks.line().front().line, LineKind::understood);
                blocks.next();
            }
            routine_order_.push_back(routine.name);
            add_routine(std::move(routine));
        }
    }

  protected:
    std::string module_name(const Source& source) const override {
        std::string name = source.name.substr(0, source.name.rfind('.'));
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return std::toupper(c); });
        return name;
    }
    Value::Type type_of(const std::string& component) const override {
        return is_krl_coordinate(component) && otherwise_typed_.count(component) == 0 ? Value::Type::real
                                                                                      : Value::Type::any;
    }
    Value chained(const Value& a, const Value& b) override {
        const auto p = krl_pose_of(a, Pose::Identity()), q = krl_pose_of(b, Pose::Identity());
        return p && q ? krl_frame_value(*p * *q) : Value::unknown(!p ? a.text : b.text);
    }
    bool moves(const std::string& word) const override {
        static const std::set<std::string> words = {"PTP",      "LIN",      "CIRC",      "PTP_REL", "LIN_REL",
                                                    "CIRC_REL", "SPTP",     "SLIN",      "SCIRC",   "SPL",
                                                    "SPTP_REL", "SLIN_REL", "SCIRC_REL", "SPL_REL", "ASYPTP"};
        return words.count(word) > 0;
    }
    std::optional<std::string> preferred() const override {  // what a call of the file's name runs
        return routine_order_.empty() ? std::optional<std::string>() : routine_order_.front();
    }

    void begin() override {
        globals_["$NULLFRAME"] = krl_frame_value(Pose::Identity());
        for (const auto& [name, pose] : options_.frames) {
            const auto tokens = tokens_of(name, Dialect::krl);
            Cursor c(std::span<const Token>(tokens).first(tokens.size() - 1));
            try {
                const auto place = read_expression(c, Dialect::krl);
                globals_.try_emplace(root_of(*place));
                assign(*place, krl_frame_value(pose));
                if (place->kind == Expr::Kind::name && place->text == "$BASE") {
                    set_frame({"$BASE", pose});
                    base_set_ = true;
                }
            } catch (const Misread&) {
            }
        }
    }

    Flow execute(const Statement& s) override {
        Cursor c(s.tokens);
        const std::string word = c.peek().text;
        if (moves(word)) {
            motion(c);
            return Flow::on;
        }
        if (word == "EXIT") return leave_loop();
        if (word == "RETURN") {
            c.take();
            return give_back(c.done() ? Value{} : value_of(*read_expression(c, Dialect::krl)));
        }
        if (word == "GOTO") {
            note(LineKind::not_understood, "jumps are not followed");
            return Flow::on;
        }
        static const std::set<std::string> idle = {
            "WAIT",      "PULSE",     "TRIGGER",  "ANOUT",      "ANIN",
            "DIGIN",     "INTERRUPT", "CONTINUE", "HALT",       "SIGNAL",
            "BRAKE",     "RESUME",    "EXT",      "EXTFCT",     "ON_ERROR_PROCEED",
            "STOP",      "ENUM",      "STRUC",    "TIME_BLOCK", "IMPORT",
            "CONST_VEL", "ERR_RAISE", "CHANNEL",  "CREAD",      "CWRITE",
            "COPEN",     "CCLOSE",    "SREAD",    "SWRITE",     "ERR_CLEAR"};
        static const std::set<std::string> order = {"SPLINE",  "ENDSPLINE", "PTP_SPLINE", "ELSE",
                                                    "ENDIF",   "ENDFOR",    "UNTIL",      "ENDWHILE",
                                                    "ENDLOOP", "ENDSWITCH"};
        if (idle.count(word) > 0 || (word == "GLOBAL" && c.is("INTERRUPT", 1))) {
            note(LineKind::passed_over);
        } else if (order.count(word) > 0) {
            if (word == "SPLINE") with(c);
            note(LineKind::understood);
        } else if (declares(c)) {
            declaration(c, Reach::routine, false);
        } else if (s.tokens.size() == 2 && c.is(":", 1)) {
            note(LineKind::understood);  // a label
        } else {
            const auto e = read_expression(c, Dialect::krl);
            if (e->kind == Expr::Kind::call && c.done()) return call_routine(*e);
            if (c.accept("=")) {
                const auto value = read_expression(c, Dialect::krl);
                give(*e, *value);
            } else {
                note(LineKind::not_understood, "this is not known here");
            }
        }
        return Flow::on;
    }

    Value call(const Expr& e) override {
        std::vector<Value> a;
        for (const Argument& part : e.parts) a.push_back(part.value ? value_of(*part.value) : Value{});
        if ((e.text == "SBASE" || e.text == "STOOL") && a.size() == 1) {
            if (const auto n = a[0].as_number())
                return numbered(e.text == "SBASE" ? "BASE_DATA" : "TOOL_DATA",
                                static_cast<int>(std::clamp(*n, -1.0, 999.0)));
        }
        if (auto v = krl_function(e.text, a)) return *std::move(v);
        return Value::unknown(shown(e));
    }

  private:
    static bool is_type(const std::string& word) {
        static const std::set<std::string> types = {"INT",  "REAL",   "BOOL", "CHAR", "FRAME", "POS", "E6POS",
                                                    "AXIS", "E6AXIS", "FDAT", "LDAT", "PDAT",  "LOAD"};
        return types.count(word) > 0;
    }
    static bool declares(const Cursor& c) {
        return c.is("DECL") || c.is("GLOBAL") || c.is("CONST") ||
               (is_type(c.peek().text) && c.peek(1).kind == Token::Kind::name);
    }

    static Value::Type number_type(const std::string& type) {
        return type == "INT" ? Value::Type::integer : type == "REAL" ? Value::Type::real : Value::Type::any;
    }

    // Of a data list it says which positions it gives, in order; what is GLOBAL there is so where the list is PUBLIC.
    void declaration(Cursor& c, Reach reach, bool is_public) {
        const bool in_data_list = reach != Reach::routine;
        for (; c.is("DECL") || c.is("GLOBAL") || c.is("CONST"); c.take())
            if (c.is("GLOBAL") && in_data_list && is_public) reach = Reach::all;
        if (c.is("STRUC")) return structure(c);
        const std::string type = c.name();
        if (type == "ENUM" || type == "SIGNAL" || type == "EXT" || type == "EXTFCT")
            return note(LineKind::passed_over);
        do {
            const Token first = c.peek();
            if (first.kind != Token::Kind::name) throw Misread(first.text);
            read_expression(c, Dialect::krl);  // NAME[3,4]
            Value value;
            value.type = number_type(type);
            if (!in_data_list && is_parameter(first.text)) {
                type_parameter(first.text, value.type);
            } else {
                if (c.accept("=")) {
                    put_in(value, value_of(*read_expression(c, Dialect::krl)), first.text);
                    if (in_data_list && (type == "E6POS" || type == "POS" || type == "FRAME"))
                        positions_.push_back(first);
                }
                declare(first.text, std::move(value), reach);
            }
        } while (c.accept(","));
        note(LineKind::understood);
    }

    // STRUC NAME INT X,Y, REAL D: its X is none of a frame.
    void structure(Cursor& c) {
        note(LineKind::passed_over);
        c.take();
        std::string type;
        for (c.name(); !c.done();) {
            const Token t = c.take();
            if (t.kind != Token::Kind::name) continue;
            if (c.peek().kind == Token::Kind::name)
                type = t.text;
            else if (type != "REAL")
                otherwise_typed_.insert(t.text);
        }
    }

    void data_list(int file, const std::vector<std::vector<Token>>& lines) {
        now_file_ = file;
        with_data_.insert(module());
        const std::vector<Token>& head = lines.front();
        const bool system =
            head.size() > 1 && head[1].text.starts_with('$');  // $CONFIG: all of it is everybody's
        const bool is_public = head.size() > 2 && head[2].text == "PUBLIC";
        const Reach reach = system ? Reach::all : Reach::module;
        for (const auto& tokens : lines) {
            now_line_ = tokens.front().line;
            Cursor c(tokens);
            try {
                if (c.is("DEFDAT") || c.is("ENDDAT")) {
                    note(LineKind::understood);
                } else if (c.is("STRUC")) {
                    structure(c);
                } else if (declares(c)) {
                    declaration(c, reach, is_public);
                } else if (c.is("EXT") || c.is("EXTFCT") || c.is("IMPORT") || c.is("SIGNAL") ||
                           c.is("ENUM")) {
                    note(LineKind::passed_over);
                } else {
                    const auto place = read_expression(c, Dialect::krl);
                    c.expect("=");
                    if (!variable(root_of(*place))) declare(root_of(*place), Value{}, reach);
                    assign(*place, value_of(*read_expression(c, Dialect::krl)));
                    note(LineKind::understood);
                }
            } catch (const Misread&) {
                note(LineKind::not_understood, "this is not known here");
            }
        }
        if (file != 0 || lines.front().size() < 2) return;
        Routine all;  // a data list alone
        all.name = lines.front()[1].text;
        for (const Token& position : positions_) {
            Token lin = position;
            lin.text = "LIN";
            Statement s;
            s.line = position.line;
            s.tokens = {lin, position};
            all.body.push_back(std::move(s));
        }
        remark("a data list says no motions: its positions are taken in the order of their lines");
        routine_order_.push_back(all.name);
        add_routine(std::move(all));
    }

    Value numbered(const std::string& list, int n) {
        if (n == 0) return krl_frame_value(Pose::Identity());
        const Value* all = variable(list);
        const auto i = static_cast<std::size_t>(n - 1);
        const std::string name = fmt::format("{}[{}]", list, n);
        if (!all || n < 1 || all->kind != Value::Kind::list || i >= all->parts.size())
            return Value::unknown(name);
        const Value& v = all->parts[i];
        if (krl_pose_of(v, {})) return v;
        return Value::unknown(v.known() || !v.text.empty() ? name + "?"
                                                           : name);  // ?: the program gave it a value
    }

    // `computed`: of other values, which its name does not say.
    void base(const Value& v, const std::string& name, bool computed = false) {
        base_set_ = true;
        const auto pose = krl_pose_of(v, {});
        const bool null = pose && pose->isApprox(Pose::Identity(), 1e-12);
        globals_["$BASE"] = pose && !in_doubt() ? krl_frame_value(*pose) : Value::unknown("$BASE");
        set_frame({null ? "" : name, pose, !pose && (computed || v.text.ends_with('?'))});
    }
    void ipo_mode(const Value& v) {
        if (v.text == "#TCP") fixed_tool_ = true;
        if (v.text == "#BASE") fixed_tool_ = false;
    }
    // What an inline form is run with: FDAT_ACT=FP1.
    void frame_data(const Value& v, const std::string& name) {
        const auto number = [&](std::string_view field) {
            const Value* part = v.kind == Value::Kind::list ? v.part(field) : nullptr;
            const auto n = part ? part->as_number() : std::nullopt;
            return n && *n >= 0 && *n < 1000 ? std::optional(static_cast<int>(*n)) : std::nullopt;
        };
        if (const auto n = number("BASE_NO"))
            base(numbered("BASE_DATA", *n), fmt::format("BASE_DATA[{}]", *n));
        else
            base(Value::unknown(name), name + ".BASE_NO");
        const auto tool = number("TOOL_NO");
        set_tool(tool ? fmt::format("TOOL_DATA[{}]", *tool) : name + ".TOOL_NO",
                 tool ? numbered("TOOL_DATA", *tool) : Value{});
        if (const Value* mode = v.kind == Value::Kind::list ? v.part("IPO_FRAME") : nullptr) ipo_mode(*mode);
    }

    void give(const Expr& place, const Expr& what) {
        const Value value = value_of(what);
        assign(place, value);
        note(LineKind::understood);
        const std::string root = root_of(place);
        const std::string name = value.known() && what.kind == Expr::Kind::record
                                     ? fmt::format("{}, line {}", root, now_line_)
                                 : value.known() || value.text.empty() ? shown(what)
                                                                       : value.text;
        if (root == "$BASE") {
            base(Value(globals_[root]), place.of ? fmt::format("$BASE, line {}", now_line_) : name,
                 place.of || what.kind == Expr::Kind::binary);
        } else if (root == "$TOOL") {
            set_tool(place.of ? fmt::format("$TOOL, line {}", now_line_) : name,
                     in_doubt() ? Value::unknown("?") : globals_[root]);
        } else if (root == "$IPO_MODE") {
            ipo_mode(value);
        } else if (root == "FDAT_ACT") {
            frame_data(value, shown(what));
        }
    }

    Flow call_routine(const Expr& e) {
        if (e.text == "BAS" && !e.parts.empty() && e.parts[0].value) {
            const std::string what = value_of(*e.parts[0].value).text;
            const auto n = e.parts.size() > 1 && e.parts[1].value ? value_of(*e.parts[1].value).as_number()
                                                                  : std::nullopt;
            if ((what == "#BASE" || what == "#TOOL") && n && *n >= 0 && *n < 1000) {
                const int i = static_cast<int>(*n);
                if (what == "#BASE") base(numbered("BASE_DATA", i), fmt::format("BASE_DATA[{}]", i));
                if (what == "#TOOL") set_tool(fmt::format("TOOL_DATA[{}]", i), numbered("TOOL_DATA", i));
                note(LineKind::understood);
            } else {
                note(LineKind::passed_over);
            }
            return Flow::on;
        }
        Flow flow = Flow::on;
        if (enter(e.text, e.parts, flow)) {
            note(LineKind::understood);
        } else {
            note(LineKind::passed_over, Text("{} is not in the files that were read", e.text));
            lose(e.parts);
        }
        return flow;
    }

    // WITH $VEL=..., $BASE=SBASE(FP1.BASE_NO), $TOOL=STOOL2(FP1)
    void with(Cursor& c) {
        while (!c.done() && !c.is("WITH")) c.take();
        if (!c.accept("WITH")) return;
        do {
            const auto place = read_expression(c, Dialect::krl);
            c.expect("=");
            const auto value = read_expression(c, Dialect::krl);
            if (place->text == "$BASE") {
                const Value v = value_of(*value);
                base(v, v.known() ? with_name(*value, "BASE_DATA") : v.text);
            } else if (place->text == "$TOOL") {
                tool_ = with_name(*value, "TOOL_DATA");
            } else if (place->text == "$IPO_MODE") {
                ipo_mode(value_of(*value));
            }
        } while (c.accept(","));
    }
    // SBASE(FP1.BASE_NO) and STOOL2(FP1) by the number that they lead to.
    std::string with_name(const Expr& e, const std::string& list) {
        if (e.kind != Expr::Kind::call || e.parts.empty() || !e.parts[0].value) return shown(e);
        Value v = value_of(*e.parts[0].value);
        if (v.kind == Value::Kind::list)
            if (const Value* n = v.part(list == "TOOL_DATA" ? "TOOL_NO" : "BASE_NO")) v = Value(*n);
        const auto n = v.as_number();
        return n ? fmt::format("{}[{:.0f}]", list, *n) : shown(e);
    }

    struct Target {
        std::optional<Pose> pose;
        std::optional<Pose> step;  // of a relative motion
        bool joints = false;
        std::string name, unknown;
    };
    Target target(Cursor& c, const std::string& word) {
        Target t;
        const auto e = read_expression(c, Dialect::krl);
        if (e->kind != Expr::Kind::record) t.name = shown(*e);
        const Value v = value_of(*e);
        t.unknown = v.known() ? shown(*e) : v.text;
        if (v.kind != Value::Kind::list) {
            t.joints = (word == "PTP" || word == "SPTP") &&
                       (t.unknown == "XHOME" || t.unknown == "HOME" || t.unknown.starts_with("$AXIS"));
            return t;
        }
        t.joints =
            v.part("A1") || v.part("A2") || v.part("A3") || v.part("A4") || v.part("A5") || v.part("A6");
        if (!t.joints) t.pose = krl_pose_of(v, here());
        return t;
    }
    // LIN_REL: along the base's axes, or with #TOOL the tool's.
    Target relative(Cursor& c) {
        Target t;
        const auto e = read_expression(c, Dialect::krl);
        const Value v = value_of(*e);
        t.unknown = v.known() ? shown(*e) : v.text;
        t.joints = v.kind == Value::Kind::list && v.part("A1");
        if (!t.joints) t.step = krl_pose_of(v, Pose::Identity());
        return t;
    }

    void motion(Cursor& c) {
        const std::string word = c.take().text;
        const bool rel = word.ends_with("_REL");
        const std::string kind = rel ? word.substr(0, word.size() - 4) : word;
        if (kind == "ASYPTP") return gap("external axes alone move here");
        const auto read = [&] { return rel ? relative(c) : target(c, kind); };
        std::vector<Target> targets = {read()};
        double angle = 0;
        if (kind == "CIRC" || kind == "SCIRC") {
            c.expect(",");
            targets.push_back(read());
        }
        while (c.accept(",")) {
            c.expect("CA");
            const auto n = value_of(*read_expression(c, Dialect::krl)).as_number();
            if (!n) return gap("the circle's angle is not known");
            angle = rad_from_deg(*n);
            if (angle == 0) return gap("the circle's angle is not known");
        }
        bool in_tool = false;
        for (Cursor rest = c; !rest.done();)
            if (rest.take().text == "#" && rest.is("TOOL")) in_tool = true;
        with(c);
        if (rel) {
            for (Target& t : targets) {
                if (!t.step || !here()) continue;
                if (in_tool)
                    t.pose = *here() * *t.step;
                else if (t.step->linear().isApprox(Eigen::Matrix3d::Identity(), 1e-12))
                    t.pose = make_pose(here()->linear(), here()->translation() + t.step->translation());
                else
                    return gap("a relative motion that turns about the base's axes");
            }
            if (!here() && !targets.front().joints)
                return gap("where this relative motion begins is not known");
        }
        const ProgramMotion how = kind == "PTP" || kind == "SPTP"   ? ProgramMotion::joint
                                  : kind == "LIN" || kind == "SLIN" ? ProgramMotion::linear
                                  : kind == "SPL"                   ? ProgramMotion::spline
                                                                    : ProgramMotion::circular;
        const Target& end = targets.back();
        if (end.joints && how != ProgramMotion::circular) return joint_values();
        for (const Target& t : targets)
            if (!t.pose) return gap(Text("{} is not known from the program", t.unknown));
        if (!base_set_) {
            base_set_ = true;
            remark("$BASE is not set before the first point: the points are taken in the robot's base");
        }
        if (how == ProgramMotion::circular)
            arc(*targets.front().pose, *end.pose, end.name, angle);
        else
            move(*end.pose, how, end.name);
    }

    std::vector<Token> positions_;
    std::set<std::string> otherwise_typed_;  // components that a STRUC calls as a frame's
    bool base_set_ = false;
};

}  // namespace

std::unique_ptr<Machine> krl_machine(const ProgramPathOptions& options) {
    return std::make_unique<Krl>(options);
}

}  // namespace seamwright::program_path
