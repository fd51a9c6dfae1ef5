#include "devices/controllers/kuka/krl/krl_value.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/geometry/notation.h"

namespace seamwright::krl {
namespace {

constexpr std::array kTypes = {
    std::pair{Type::boolean, "BOOL"},     std::pair{Type::integer, "INT"},
    std::pair{Type::real, "REAL"},        std::pair{Type::character, "CHAR"},
    std::pair{Type::enumeration, "ENUM"}, std::pair{Type::frame, "FRAME"},
    std::pair{Type::pos, "POS"},          std::pair{Type::e6pos, "E6POS"},
    std::pair{Type::e6axis, "E6AXIS"},    std::pair{Type::eki_status, "EKI_STATUS"}};
constexpr double kIntMost = 2147483647.0;

double single(double v) {
    return static_cast<double>(static_cast<float>(v));
}

}  // namespace

std::string capitals(std::string text) {
    for (char& c : text)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return text;
}

std::string_view to_string(Type type) {
    for (const auto& [t, name] : kTypes)
        if (t == type) return name;
    return "";
}

std::optional<Type> type_from(std::string_view name) {
    for (const auto& [t, known] : kTypes)
        if (name == known && t != Type::enumeration) return t;
    return std::nullopt;
}

bool is_geometric(Type type) {
    return type == Type::frame || type == Type::pos || type == Type::e6pos;
}
bool is_number(Type type) {
    return type == Type::integer || type == Type::real || type == Type::character;
}

const std::vector<std::string>& components(Type type) {
    static const std::vector<std::string> frame = {"X", "Y", "Z", "A", "B", "C"};
    static const std::vector<std::string> pos = {"X", "Y", "Z", "A", "B", "C", "S", "T"};
    static const std::vector<std::string> e6pos = {"X", "Y",  "Z",  "A",  "B",  "C",  "S",
                                                   "T", "E1", "E2", "E3", "E4", "E5", "E6"};
    static const std::vector<std::string> e6axis = {"A1", "A2", "A3", "A4", "A5", "A6",
                                                    "E1", "E2", "E3", "E4", "E5", "E6"};
    static const std::vector<std::string> status = {"BUFF",      "READ",    "MSG_NO",
                                                    "CONNECTED", "COUNTER", "LENGTH"};
    static const std::vector<std::string> none;
    switch (type) {
        case Type::frame:
            return frame;
        case Type::pos:
            return pos;
        case Type::e6pos:
            return e6pos;
        case Type::e6axis:
            return e6axis;
        case Type::eki_status:
            return status;
        default:
            return none;
    }
}

Value Value::boolean(bool v) {
    return {Type::boolean, true, false, v ? 1.0 : 0.0, {}, {}};
}
Value Value::integer(double v) {
    if (!(std::abs(v) <= kIntMost)) throw KrlError(fmt::format("{} is no INT", v));
    return {Type::integer, true, false, v, {}, {}};
}
Value Value::real(double v) {
    if (!std::isfinite(v)) throw KrlError("a REAL that is not finite");
    return {Type::real, true, false, single(v), {}, {}};
}
Value Value::name(std::string v) {
    return {Type::enumeration, true, false, 0, std::move(v), {}};
}
Value Value::string_of(std::string v) {
    return {Type::character, true, true, 0, std::move(v), {}};
}
Value Value::unset(Type type) {
    Value v;
    v.type = type;
    return v;
}
Value Value::of(const Pose& pose, Type type) {
    const KukaAbc abc = kuka_from_rotation(pose.linear());
    const Eigen::Vector3d& p = pose.translation();
    const std::array<double, 6> v = {p.x(), p.y(), p.z(), abc.a_deg, abc.b_deg, abc.c_deg};
    Value value = unset(type);
    value.set = true;
    const auto& names = components(type);
    for (std::size_t i = 0; i < names.size(); ++i) value.parts[names[i]] = i < 6 ? single(v[i]) : 0.0;
    return value;
}

bool Value::truth() const {
    if (type != Type::boolean) throw KrlError(fmt::format("a BOOL is needed, not {}", to_string(type)));
    if (!set) throw KrlError("a BOOL that is not initialised");
    return number != 0;
}
double Value::as_number() const {
    if (!is_number(type) || string)
        throw KrlError(fmt::format("a number is needed, not {}", to_string(type)));
    if (!set) throw KrlError(fmt::format("a {} that is not initialised", to_string(type)));
    return number;
}
Pose Value::pose() const {
    if (!is_geometric(type)) throw KrlError(fmt::format("a FRAME is needed, not {}", to_string(type)));
    std::array<double, 6> v{};
    for (std::size_t i = 0; i < 6; ++i) {
        const auto it = parts.find(components(Type::frame)[i]);
        if (it == parts.end() || !it->second)
            throw KrlError(fmt::format("component {} is not initialised", components(Type::frame)[i]));
        v[i] = *it->second;
    }
    return make_pose(rotation_from_kuka({v[3], v[4], v[5]}), {v[0], v[1], v[2]});
}

std::string shown(const Value& value) {
    if (value.string) return "\"" + value.text + "\"";
    switch (value.type) {
        case Type::boolean:
            return value.truth() ? "TRUE" : "FALSE";
        case Type::integer:
            return fmt::format("{:.0f}", value.as_number());
        case Type::character:
            return fmt::format("\"{}\"", static_cast<char>(value.as_number()));
        case Type::real:
            return fmt::format("{:.6f}", value.as_number());
        case Type::enumeration:
            if (!value.set) throw KrlError("an enumeration that is not initialised");
            return "#" + value.text;
        default:
            break;
    }
    std::string out;
    for (const std::string& name : components(value.type)) {
        const auto it = value.parts.find(name);
        if (it == value.parts.end() || !it->second) continue;
        out += out.empty() ? " " : ", ";
        out += name + (name == "S" || name == "T" ? fmt::format(" {:.0f}", *it->second)
                                                  : fmt::format(" {:.6f}", *it->second));
    }
    if (out.empty()) throw KrlError(fmt::format("a {} that is not initialised", to_string(value.type)));
    return fmt::format("{{{}:{}}}", to_string(value.type), out);
}

Value converted(const Value& value, Type type) {
    if (value.string) throw KrlError("a string goes into a CHAR array only, written NAME[]");
    if (value.type != Type::enumeration && !is_geometric(value.type) && value.type != Type::eki_status &&
        value.type != Type::e6axis && !value.set)
        throw KrlError(fmt::format("a {} that is not initialised", to_string(value.type)));
    if (value.type == type && !is_geometric(type)) return value;
    if (is_number(value.type) && is_number(type)) {
        const double v = value.number;
        if (type == Type::real) return Value::real(v);
        if (type == Type::character && !(v >= 0 && v <= 255)) throw KrlError(fmt::format("{} is no CHAR", v));
        Value out = Value::integer(std::round(v));
        out.type = type;
        return out;
    }
    if (is_geometric(value.type) && is_geometric(type)) {
        Value out = Value::unset(type);
        out.set = true;
        for (const std::string& name : components(type))
            if (const auto it = value.parts.find(name); it != value.parts.end()) out.parts[name] = it->second;
        return out;
    }
    throw KrlError(fmt::format("{} cannot be assigned to {}", to_string(value.type), to_string(type)));
}

Variable::Variable(std::string n, Type t, std::vector<std::size_t> d)
    : name(std::move(n)), type(t), dimensions(std::move(d)) {
    std::size_t count = 1;
    for (const std::size_t size : dimensions) count *= size;
    cells.assign(count, Value::unset(type));
}

std::size_t Variable::cell(const std::vector<long>& indices, bool row) const {
    if (indices.size() + (row ? 1 : 0) != dimensions.size())
        throw KrlError(fmt::format("{} has {} dimensions", name, dimensions.size()));
    std::size_t at = 0;
    for (std::size_t k = 0; k < dimensions.size(); ++k) {
        long index = 1;
        if (k < indices.size()) index = indices[k];
        if (index < 1 || static_cast<std::size_t>(index) > dimensions[k])
            throw KrlError(fmt::format("index {} of {} is outside 1 to {}", index, name, dimensions[k]));
        at = at * dimensions[k] + static_cast<std::size_t>(index - 1);
    }
    return at;
}

std::string Variable::row_text(std::size_t from) const {
    std::string text;
    for (std::size_t i = 0; i < row_length(); ++i) {
        const Value& c = cells[from + i];
        if (!c.set || c.number == 0) break;
        text += static_cast<char>(c.number);
    }
    return text;
}

void Variable::set_row(std::size_t from, const std::string& text) {
    if (text.size() > row_length())
        throw KrlError(fmt::format("{} characters do not fit in {}[{}]", text.size(), name, row_length()));
    for (std::size_t i = 0; i < row_length(); ++i) {
        Value& c = cells[from + i];
        c = Value::unset(Type::character);
        if (i >= text.size()) continue;
        c.set = true;
        c.number = static_cast<unsigned char>(text[i]);
    }
}

bool Variable::row_initialised(std::size_t from) const {
    for (std::size_t i = 0; i < row_length(); ++i)
        if (!cells[from + i].set) return false;
    return true;
}

}  // namespace seamwright::krl
