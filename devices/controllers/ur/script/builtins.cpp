#include "devices/controllers/ur/script/builtins.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "devices/controllers/ur/script/robot.h"

namespace seamwright::urscript {
namespace {

// Arguments as the functions want them. The first that is of another type is told, and stays told.
class Arguments {
  public:
    explicit Arguments(const BuiltinCall& call) : call_(call) {}
    bool given(std::size_t i) const { return !std::holds_alternative<std::monostate>(call_.arguments[i].is); }
    double real(std::size_t i, double otherwise = 0) {
        if (!given(i)) return otherwise;
        if (const auto* v = std::get_if<double>(&call_.arguments[i].is)) return *v;
        if (const auto* v = std::get_if<std::int32_t>(&call_.arguments[i].is)) return *v;
        wrong(i, "a number");
        return otherwise;
    }
    std::int32_t whole(std::size_t i, std::int32_t otherwise = 0) {
        return get<std::int32_t>(i, "a whole number", otherwise);
    }
    int whole_up_to(std::size_t i, int most) {
        const int v = whole(i);
        if (v < 0 || v > most)
            error_ = Error{ErrorKind::input, fmt::format("{} is beyond 0 to {}", v, most), {}, {}};
        return std::clamp(v, 0, most);
    }
    bool truth(std::size_t i, bool otherwise = false) { return get<bool>(i, "True or False", otherwise); }
    std::string text(std::size_t i, const std::string& otherwise = {}) {
        return get<std::string>(i, "a string", otherwise);
    }
    PoseValue pose(std::size_t i) { return get<PoseValue>(i, "a pose", {}); }
    Expected<void> done() const {
        if (error_) return tl::unexpected(*error_);
        return {};
    }

  private:
    template <class T>
    T get(std::size_t i, const char* wanted, const T& otherwise) {
        if (!given(i)) return otherwise;
        if (const auto* v = std::get_if<T>(&call_.arguments[i].is)) return *v;
        wrong(i, wanted);
        return otherwise;
    }
    void wrong(std::size_t i, const char* wanted) {
        error_ =
            Error{ErrorKind::input,
                  fmt::format("argument {} is {} and not {}", i + 1, type_name(call_.arguments[i]), wanted),
                  {},
                  {}};
    }
    const BuiltinCall& call_;
    std::optional<Error> error_;
};

// ---- motion and time
Expected<void> movel(BuiltinCall& c) {
    Arguments a(c);
    const PoseValue to = a.pose(0);
    const double acceleration = a.real(1, 1.2), radius = a.real(4, 0);
    double speed = a.real(2, 0.25);
    if (const double time = a.real(3, 0); time != 0) {
        const PoseValue at = c.robot.target_pose();
        speed = std::hypot(to[0] - at[0], to[1] - at[1], to[2] - at[2]) / time;
    }
    SEAM_OK(a.done());
    SEAM_OK(c.robot.movel(c.thread, to, acceleration, speed, radius));
    // With a blend the program goes on while the robot still drives, far enough ahead for the next move to
    // be there.
    constexpr std::size_t kAhead = 2;
    if (radius > 0 && c.robot.moves_left() <= kAhead) return {};
    c.wait = {Wait::For::motion, 0, radius > 0 ? kAhead : 0, 0};
    return {};
}
Expected<void> sync(BuiltinCall& c) {
    c.wait.what = Wait::For::cycle;
    return {};
}
Expected<void> sleep(BuiltinCall& c) {
    Arguments a(c);
    const double t = a.real(0);
    SEAM_OK(a.done());
    if (!(t >= 0 && t < 1e6)) return input_error(Text("sleep({})", t));
    c.wait = {Wait::For::time, c.robot.time_s() + t, 0, 0};
    return {};
}
Expected<void> stopl(BuiltinCall& c) {
    c.robot.stop();
    c.wait.what = Wait::For::cycle;
    return {};
}
Expected<void> get_steptime(BuiltinCall& c) {
    c.result = {c.robot.cycle_s()};
    return {};
}
Expected<void> get_actual_tcp_pose(BuiltinCall& c) {
    c.result = {c.robot.tcp_pose()};
    return {};
}
Expected<void> get_tcp_offset(BuiltinCall& c) {
    c.result = {c.robot.tcp_offset()};
    return {};
}
Expected<void> set_tcp(BuiltinCall& c) {
    Arguments a(c);
    const PoseValue tcp = a.pose(0);
    SEAM_OK(a.done());
    if (c.robot.moves_left() > 0) return input_error("set_tcp() while the robot moves");
    return c.robot.set_tcp(tcp);
}

// ---- poses and numbers
Expected<void> pose_trans(BuiltinCall& c) {
    Arguments a(c);
    c.result = {pose_value(pose_of(a.pose(0)) * pose_of(a.pose(1)))};
    return a.done();
}
Expected<void> pose_inv(BuiltinCall& c) {
    Arguments a(c);
    c.result = {pose_value(pose_of(a.pose(0)).inverse())};
    return a.done();
}
Expected<void> pose_dist(BuiltinCall& c) {
    Arguments a(c);
    const PoseValue p = a.pose(0), q = a.pose(1);
    c.result = {std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2])};
    return a.done();
}
Expected<void> whole_of(BuiltinCall& c, double v) {
    if (!(std::abs(v) < 2147483648.0)) return input_error("a number is beyond 32 bits");
    c.result = {static_cast<std::int32_t>(v)};
    return {};
}
Expected<void> floor(BuiltinCall& c) {
    Arguments a(c);
    const double v = std::floor(a.real(0));
    SEAM_OK(a.done());
    return whole_of(c, v);
}
Expected<void> ceil(BuiltinCall& c) {
    Arguments a(c);
    const double v = std::ceil(a.real(0));
    SEAM_OK(a.done());
    return whole_of(c, v);
}
Expected<void> sqrt(BuiltinCall& c) {
    Arguments a(c);
    const double v = a.real(0);
    SEAM_OK(a.done());
    if (!(v >= 0)) return input_error(Text("sqrt({})", v));
    c.result = {std::sqrt(v)};
    return {};
}
Expected<void> length(BuiltinCall& c) {
    if (const auto* list = std::get_if<ListValue>(&c.arguments[0].is))
        c.result = {static_cast<std::int32_t>(list->size())};
    else if (std::holds_alternative<PoseValue>(c.arguments[0].is))
        c.result = {std::int32_t{6}};
    else
        return input_error(Text("length() of {}", type_name(c.arguments[0])));
    return {};
}

// ---- strings
Expected<void> str_len(BuiltinCall& c) {
    Arguments a(c);
    c.result = {static_cast<std::int32_t>(a.text(0).size())};
    return a.done();
}
Expected<void> str_empty(BuiltinCall& c) {
    Arguments a(c);
    c.result = {a.text(0).empty()};
    return a.done();
}
Expected<void> str_cat(BuiltinCall& c) {
    const std::string both = text_of(c.arguments[0]) + text_of(c.arguments[1]);
    if (both.size() > 1023) return input_error("a string is longer than 1023 signs");
    c.result = {both};
    return {};
}
Expected<void> str_sub(BuiltinCall& c) {
    Arguments a(c);
    const std::string text = a.text(0);
    const std::int32_t at = a.whole(1), count = a.whole(2, static_cast<std::int32_t>(text.size()));
    SEAM_OK(a.done());
    if (at < 0 || at >= static_cast<std::int32_t>(text.size()) || count < 0)
        return input_error(Text("str_sub() at {} of {} signs", at, text.size()));
    c.result = {text.substr(static_cast<std::size_t>(at), static_cast<std::size_t>(count))};
    return {};
}
Expected<void> str_at(BuiltinCall& c) {
    Arguments a(c);
    const std::string text = a.text(0);
    const std::int32_t at = a.whole(1);
    SEAM_OK(a.done());
    if (at < 0 || at >= static_cast<std::int32_t>(text.size()))
        return input_error(Text("str_at() at {} of {} signs", at, text.size()));
    c.result = {text.substr(static_cast<std::size_t>(at), 1)};
    return {};
}
Expected<void> str_find(BuiltinCall& c) {
    Arguments a(c);
    const std::string text = a.text(0), wanted = a.text(1);
    const std::int32_t from = a.whole(2, 0);
    SEAM_OK(a.done());
    if (from < 0) return input_error(Text("str_find() from {}", from));
    const auto at = text.find(wanted, static_cast<std::size_t>(from));
    c.result = {at == std::string::npos ? std::int32_t{-1} : static_cast<std::int32_t>(at)};
    return {};
}
Expected<void> to_str(BuiltinCall& c) {
    c.result = {text_of(c.arguments[0])};
    return {};
}
Expected<void> to_num(BuiltinCall& c) {
    Arguments a(c);
    const std::string text = a.text(0);
    SEAM_OK(a.done());
    double v = 0;
    const auto r = std::from_chars(text.data(), text.data() + text.size(), v);
    if (r.ec != std::errc{} || r.ptr != text.data() + text.size())
        return input_error(Text("to_num(\"{}\")", text));
    if (text.find_first_of(".eE") == std::string::npos && std::abs(v) < 2147483648.0) return whole_of(c, v);
    c.result = {v};
    return {};
}

// ---- screen
Expected<void> textmsg(BuiltinCall& c) {
    std::string text = text_of(c.arguments[0]);
    if (!std::holds_alternative<std::monostate>(c.arguments[1].is)) text += text_of(c.arguments[1]);
    c.robot.messages.push_back(std::move(text));
    return {};
}
Expected<void> popup(BuiltinCall& c) {
    Arguments a(c);
    const std::string title = a.text(1, "Popup");
    const bool warning = a.truth(2), error = a.truth(3), blocking = a.truth(4);
    SEAM_OK(a.done());
    const char* kind = error ? "error" : warning ? "warning" : "message";
    c.robot.popup = fmt::format("{} ({}): {}", title, kind, text_of(c.arguments[0]));
    if (blocking) c.wait.what = Wait::For::popup;
    return {};
}

// ---- inputs, outputs, registers
Expected<void> get_standard_digital_in(BuiltinCall& c) {
    Arguments a(c);
    c.result = {c.robot.digital_in[static_cast<std::size_t>(a.whole_up_to(0, 7))]};
    return a.done();
}
Expected<void> get_standard_digital_out(BuiltinCall& c) {
    Arguments a(c);
    c.result = {c.robot.digital_out(a.whole_up_to(0, 7))};
    return a.done();
}
Expected<void> set_standard_digital_out(BuiltinCall& c) {
    Arguments a(c);
    const int number = a.whole_up_to(0, 7);
    const bool on = a.truth(1);
    SEAM_OK(a.done());
    c.robot.set_digital_out(number, on);
    return {};
}
template <bool kInput>
Registers& bank(BuiltinCall& c) {
    return kInput ? c.robot.inputs : c.robot.outputs;
}
template <bool kInput>
Expected<void> read_int(BuiltinCall& c) {
    Arguments a(c);
    c.result = {bank<kInput>(c).ints[static_cast<std::size_t>(a.whole_up_to(0, 47))]};
    return a.done();
}
template <bool kInput>
Expected<void> read_real(BuiltinCall& c) {
    Arguments a(c);
    c.result = {bank<kInput>(c).reals[static_cast<std::size_t>(a.whole_up_to(0, 47))]};
    return a.done();
}
template <bool kInput>
Expected<void> read_bit(BuiltinCall& c) {
    Arguments a(c);
    c.result = {static_cast<bool>(bank<kInput>(c).bits[static_cast<std::size_t>(a.whole_up_to(0, 127))])};
    return a.done();
}
Expected<void> write_int(BuiltinCall& c) {
    Arguments a(c);
    const int at = a.whole_up_to(0, 47);
    const std::int32_t v = a.whole(1);
    SEAM_OK(a.done());
    c.robot.outputs.ints[static_cast<std::size_t>(at)] = v;
    return {};
}
Expected<void> write_real(BuiltinCall& c) {
    Arguments a(c);
    const int at = a.whole_up_to(0, 47);
    const double v = a.real(1);
    SEAM_OK(a.done());
    c.robot.outputs.reals[static_cast<std::size_t>(at)] = v;
    return {};
}
Expected<void> write_bit(BuiltinCall& c) {
    Arguments a(c);
    const int at = a.whole_up_to(0, 127);
    const bool v = a.truth(1);
    SEAM_OK(a.done());
    c.robot.outputs.bits[static_cast<std::size_t>(at)] = v;
    return {};
}

}  // namespace

const std::vector<Builtin>& builtins() {
    static const std::vector<Builtin> all = {
        {"movel", {"pose", "a", "v", "t", "r"}, 1, &movel},
        {"sync", {}, 0, &sync},
        {"sleep", {"t"}, 1, &sleep},
        {"stopl", {"a"}, 1, &stopl},
        {"get_steptime", {}, 0, &get_steptime},
        {"get_actual_tcp_pose", {}, 0, &get_actual_tcp_pose},
        {"get_tcp_offset", {}, 0, &get_tcp_offset},
        {"set_tcp", {"pose"}, 1, &set_tcp},
        {"pose_trans", {"p_from", "p_from_to"}, 2, &pose_trans},
        {"pose_inv", {"p_from"}, 1, &pose_inv},
        {"pose_dist", {"p_from", "p_to"}, 2, &pose_dist},
        {"floor", {"f"}, 1, &floor},
        {"ceil", {"f"}, 1, &ceil},
        {"sqrt", {"f"}, 1, &sqrt},
        {"length", {"v"}, 1, &length},
        {"get_list_length", {"v"}, 1, &length},
        {"str_len", {"str"}, 1, &str_len},
        {"str_empty", {"str"}, 1, &str_empty},
        {"str_cat", {"op1", "op2"}, 2, &str_cat},
        {"str_sub", {"src", "index", "len"}, 2, &str_sub},
        {"str_at", {"src", "index"}, 2, &str_at},
        {"str_find", {"src", "target", "start_from"}, 2, &str_find},
        {"to_str", {"val"}, 1, &to_str},
        {"to_num", {"str"}, 1, &to_num},
        {"textmsg", {"s1", "s2"}, 1, &textmsg},
        {"popup", {"s", "title", "warning", "error", "blocking"}, 1, &popup},
        {"get_standard_digital_in", {"n"}, 1, &get_standard_digital_in},
        {"get_standard_digital_out", {"n"}, 1, &get_standard_digital_out},
        {"set_standard_digital_out", {"n", "b"}, 2, &set_standard_digital_out},
        {"read_input_integer_register", {"address"}, 1, &read_int<true>},
        {"read_input_float_register", {"address"}, 1, &read_real<true>},
        {"read_input_boolean_register", {"address"}, 1, &read_bit<true>},
        {"read_output_integer_register", {"address"}, 1, &read_int<false>},
        {"read_output_float_register", {"address"}, 1, &read_real<false>},
        {"read_output_boolean_register", {"address"}, 1, &read_bit<false>},
        {"write_output_integer_register", {"address", "value"}, 2, &write_int},
        {"write_output_float_register", {"address", "value"}, 2, &write_real},
        {"write_output_boolean_register", {"address", "value"}, 2, &write_bit}};
    return all;
}

std::optional<int> find_builtin(std::string_view name) {
    const auto& all = builtins();
    const auto it = std::find_if(all.begin(), all.end(), [&](const Builtin& b) { return b.name == name; });
    if (it == all.end()) return std::nullopt;
    return static_cast<int>(it - all.begin());
}

std::string_view type_name(const Value& value) {
    static constexpr std::string_view names[] = {"nothing",  "a truth value", "a whole number", "a number",
                                                 "a string", "a pose",        "a list",         "a thread"};
    return names[value.is.index()];
}

std::string text_of(const Value& value) {
    if (const auto* v = std::get_if<bool>(&value.is)) return *v ? "True" : "False";
    if (const auto* v = std::get_if<std::int32_t>(&value.is)) return std::to_string(*v);
    if (const auto* v = std::get_if<double>(&value.is)) return fmt::format("{}", *v);
    if (const auto* v = std::get_if<std::string>(&value.is)) return *v;
    std::string out;
    if (const auto* v = std::get_if<PoseValue>(&value.is))
        for (const double x : *v) out += (out.empty() ? "p[" : ", ") + fmt::format("{}", x);
    if (const auto* v = std::get_if<ListValue>(&value.is))
        for (const Value& x : *v) out += (out.empty() ? "[" : ", ") + text_of(x);
    return out.empty() ? std::string(type_name(value)) : out + "]";
}

}  // namespace seamwright::urscript
