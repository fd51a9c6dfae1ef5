// What FANUC's TP programs do: motions, registers and frames.

#include "devices/robot_path/fanuc_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace seamwright::program_path {

namespace {

Value fanuc_pose_value(const Pose& pose) {
    const FanucWpr r = fanuc_from_rotation(pose.linear());
    const Eigen::Vector3d& t = pose.translation();
    return Value::numbers({t.x(), t.y(), t.z(), r.w_deg, r.p_deg, r.r_deg});
}

}  // namespace

void Fanuc::begin() {
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

Machine::Flow Fanuc::execute(const Statement& s) {
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
    } else if (c.is("=", 1) &&
               (word.starts_with("r[") || word.starts_with("pr[") || word.starts_with("uframe[") ||
                word.starts_with("utool[") || word.starts_with("p["))) {
        c.take(), c.take();
        give(word, c);
    } else if (word == "lbl" || word.starts_with("lbl[")) {
        note(LineKind::understood);
    } else if (word == "end") {
        return give_back({});
    } else if (word == "abort") {  // PAUSE goes on at the start key
        note(LineKind::understood);
        return Flow::halt;
    } else if (word == "jmp") {
        note(LineKind::understood);
        remark("a loop made by a jump back is read once");
    } else if (word == "select" ||
               (word == "if" &&
                std::any_of(tokens.begin(), tokens.end(), [](const Token& t) { return t.text == "jmp"; }))) {
        note(LineKind::not_understood, "jumps are not followed");
    } else if (word == "call" || word == "run") {
        c.take();
        Flow flow = Flow::on;
        std::string name = c.peek().text;
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char x) { return std::toupper(x); });
        if (word == "call" && routine(name, now_file_)) {
            const auto conditions = std::pair(std::exchange(offset_, {}), std::exchange(tool_offset_, {}));
            enter(name, {}, flow);
            // Whether those of the called program live on is not in the manual.
            offset_ = offset_.empty() ? conditions.first : std::string();
            tool_offset_ = tool_offset_.empty() ? conditions.second : std::string();
            note(LineKind::understood);
        } else {
            note(LineKind::passed_over, Text("{} is not in the files that were read", name));
        }
        return flow;
    } else {
        note(LineKind::passed_over);
    }
    return Flow::on;
}

void Fanuc::give(const std::string& word, Cursor& c) {
    note(LineKind::understood);
    const auto put = [&](Value v) { globals_[word] = in_doubt() ? Value::unknown(word) : std::move(v); };
    if (word.starts_with("p[")) {
        int n = 0;
        std::from_chars(word.data() + 2, word.data() + word.size(), n);
        Position& p = positions_[{now_file_, n}];
        p.pose.reset();  // from here on it is what the program computes
        p.joints = false;
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
            const auto at = positions_.find({now_file_, n});
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

NamedPose Fanuc::user_frame(const std::string& number) const {
    if (number == "0") return {"", Pose::Identity()};
    const std::string name = "UF " + number;
    const auto at = frames_.find(name);
    if (at == frames_.end()) return {name, std::nullopt};
    return {name, at->second, !at->second};
}

std::optional<Fanuc::Position> Fanuc::position(const std::string& word) {
    const bool stored = word.starts_with("p[");
    if (stored) {
        int n = 0;
        std::from_chars(word.data() + 2, word.data() + word.size(), n);
        const auto at = positions_.find({now_file_, n});
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

void Fanuc::motion(const std::string& word, Cursor& c) {
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
        const std::string tool = p->tool == "F" ? tool_number_ : p->tool;
        const Value* data = variable("utool[" + tool + "]");
        set_tool("UT " + tool, data ? *data : Value{});
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

std::string Fanuc::capitals(std::string name) {
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
    return name;
}

std::unique_ptr<Machine> fanuc_machine(const ProgramPathOptions& options) {
    return std::make_unique<Fanuc>(options);
}

}  // namespace seamwright::program_path
