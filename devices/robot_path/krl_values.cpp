#include "devices/robot_path/krl_values.h"

#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include "core/geometry/notation.h"

namespace seamwright::program_path {

Value krl_frame_value(const Pose& pose) {
    const KukaAbc abc = kuka_from_rotation(pose.linear());
    Value v = Value::numbers({pose.translation().x(), pose.translation().y(), pose.translation().z(),
                              abc.a_deg, abc.b_deg, abc.c_deg});
    v.names = {"X", "Y", "Z", "A", "B", "C"};
    for (Value& part : v.parts) part.type = Value::Type::real;
    return v;
}

std::optional<Pose> krl_pose_of(const Value& v, const std::optional<Pose>& otherwise) {
    if (v.kind != Value::Kind::list || v.names.empty()) return {};
    static constexpr std::array<std::string_view, 6> names = {"X", "Y", "Z", "A", "B", "C"};
    std::array<double, 6> n{};
    std::optional<Value> rest;
    for (std::size_t i = 0; i < 6; ++i) {
        const Value* part = v.part(names[i]);
        if (!part) {
            if (!otherwise) return {};
            if (!rest) rest = krl_frame_value(*otherwise);
            part = &rest->parts[i];
        }
        const auto number = part->as_number();
        if (!number || std::abs(*number) > 1e9) return {};
        n[i] = *number;
    }
    return make_pose(rotation_from_kuka({n[3], n[4], n[5]}), {n[0], n[1], n[2]});
}

std::optional<Value> krl_function(const std::string& name, const std::vector<Value>& a) {
    if (a.size() != 1) return {};
    if (name == "INV_POS") {
        const auto p = krl_pose_of(a[0], {});
        return p ? std::optional(krl_frame_value(p->inverse())) : std::nullopt;
    }
    const auto x = a[0].as_number();
    if (!x) return {};
    if (name == "ABS") return Value::of(std::abs(*x));
    if (name == "SQRT" && *x >= 0) return Value::of(std::sqrt(*x));
    if (name == "SIN") return Value::of(std::sin(rad_from_deg(*x)));
    if (name == "COS") return Value::of(std::cos(rad_from_deg(*x)));
    if (name == "TAN") return Value::of(std::tan(rad_from_deg(*x)));
    return {};
}

bool is_krl_coordinate(const std::string& component) {
    static const std::set<std::string> all = {"X",  "Y",  "Z",  "A",  "B",  "C",  "A1", "A2", "A3",
                                              "A4", "A5", "A6", "E1", "E2", "E3", "E4", "E5", "E6"};
    return all.count(component) > 0;
}

}  // namespace seamwright::program_path
