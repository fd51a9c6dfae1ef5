#include "core/geometry/pose_convention.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/length_unit.h"
#include "core/geometry/notation.h"

namespace seamwright {
namespace {

constexpr double kNearest_mm = 100, kFarthestBase_mm = 5e4, kFarthestRead_mm = 1e5;
constexpr double kTurn = 2 * kPi + 1e-6;

constexpr EulerConvention kFixedXyz{EulerOrder::xyz, EulerTurns::extrinsic};
constexpr EulerConvention kTurnedZyz{EulerOrder::zyz, EulerTurns::intrinsic};

bool has_angles(const PoseConvention& c) {
    return form_of(c.rotation) == RotationForm::angles;
}

std::optional<Eigen::Matrix3d> read_rotation(const PoseNumbers& n, const PoseConvention& c) {
    const auto& r = n.rotation;
    const double rad = c.radian ? 1 : kPi / 180;
    switch (c.rotation) {
        case RotationReading::euler:
            return rotation_from_euler(c.euler, rad * Eigen::Vector3d(r[0], r[1], r[2]));
        case RotationReading::rotation_vector:
            return rotation_exp(rad * Eigen::Vector3d(r[0], r[1], r[2]));
        case RotationReading::quat_wxyz:
        case RotationReading::quat_xyzw: {
            const bool first = c.rotation == RotationReading::quat_wxyz;
            const auto q = rotation_from_abb(
                first ? AbbQuaternion{r[0], r[1], r[2], r[3]} : AbbQuaternion{r[3], r[0], r[1], r[2]}, {});
            if (!q) return std::nullopt;
            return *q;
        }
        case RotationReading::matrix: {
            Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
            for (Eigen::Index i = 0; i < 9; ++i) m(i / 3, i % 3) = r[static_cast<std::size_t>(i)];
            const auto pose = pose_from_matrix(m, {});
            if (!pose) return std::nullopt;
            return pose->linear();
        }
    }
    return std::nullopt;
}

// The words of a code, without those that say what is usual.
struct Rotation {
    std::string_view name;
    PoseConvention convention;
};
const Rotation kRotations[] = {
    {"rotvec", {.rotation = RotationReading::rotation_vector}},
    {"quat-wxyz", {.rotation = RotationReading::quat_wxyz}},
    {"quat-xyzw", {.rotation = RotationReading::quat_xyzw}},
    {"matrix", {.rotation = RotationReading::matrix}},
    {"kuka-abc", {}},
    {"fanuc-wpr", {.euler = kFixedXyz}},
    {"rpy", {.euler = kFixedXyz}},
    {"zyz", {.euler = kTurnedZyz}},
    {"ur-rotvec", {.rotation = RotationReading::rotation_vector, .radian = true}},
};

std::optional<PoseConvention> rotation_named(std::string_view word) {
    for (const Rotation& r : kRotations)
        if (r.name == word) return r.convention;
    PoseConvention c;
    if (!word.starts_with("euler-") || word.size() < 10 || word[9] != '-') return std::nullopt;
    const auto order = euler_order_named(word.substr(6, 3));
    if (!order) return std::nullopt;
    c.euler.order = *order;
    for (const EulerTurns turns : {EulerTurns::intrinsic, EulerTurns::extrinsic})
        if (word.substr(10) == name_of(turns)) {
            c.euler.turns = turns;
            return c;
        }
    return std::nullopt;
}

// "Z-Y-X"
std::string shown(EulerOrder order) {
    std::string text;
    for (const char axis : name_of(order)) {
        if (!text.empty()) text += '-';
        text += static_cast<char>(axis - 'x' + 'X');
    }
    return text;
}

}  // namespace

RotationForm form_of(RotationReading reading) {
    switch (reading) {
        case RotationReading::quat_wxyz:
        case RotationReading::quat_xyzw:
            return RotationForm::quaternion;
        case RotationReading::matrix:
            return RotationForm::matrix;
        default:
            return RotationForm::angles;
    }
}

bool PoseConvention::operator==(const PoseConvention& other) const {
    return code_of(*this) == code_of(other);
}

std::string code_of(const PoseConvention& c) {
    std::string code;
    if (c.rotation == RotationReading::euler) {
        code = "euler-";
        code += name_of(c.euler.order);
        code += '-';
        code += name_of(c.euler.turns);
    } else {
        for (const Rotation& r : kRotations)
            if (code.empty() && r.convention.rotation == c.rotation) code = r.name;
    }
    if (has_angles(c)) code += c.radian ? ",rad" : ",deg";
    code += ',';
    code += c.unit;
    if (c.transposed && !has_angles(c)) code += ",transposed";
    if (c.inverse) code += ",inverse";
    return code;
}

Text words_of(const PoseConvention& c) {
    Text words;
    switch (c.rotation) {
        case RotationReading::euler:
            words = c.euler.turns == EulerTurns::intrinsic
                        ? Text("Euler angles {} about the turned axes", shown(c.euler.order))
                        : Text("Euler angles {} about the fixed axes", shown(c.euler.order));
            break;
        case RotationReading::rotation_vector:
            words = "a rotation vector";
            break;
        case RotationReading::quat_wxyz:
            words = "a quaternion, w first";
            break;
        case RotationReading::quat_xyzw:
            words = "a quaternion, w last";
            break;
        case RotationReading::matrix:
            words = "a matrix";
            break;
    }
    if (has_angles(c)) words = joined(words, ", ", c.radian ? Text("radian") : Text("degrees"));
    words = joined(words, ", ", std::string(c.unit));
    if (c.transposed && !has_angles(c)) words = joined(words, ", ", "rotation transposed");
    if (c.inverse) words = joined(words, ", ", "inverse");
    return words;
}

Expected<PoseConvention> pose_convention_named(std::string_view code, const Text& where) {
    PoseConvention c;
    bool rotation = false, angle = false, unit = false;
    for (std::size_t from = 0; from <= code.size();) {
        const std::size_t end = std::min(code.find(',', from), code.size());
        const std::string_view word = code.substr(from, end - from);
        from = end + 1;
        bool fresh = true;
        const auto once = [&](bool& said) {
            fresh = !said;
            said = true;
        };
        if (const auto named = rotation_named(word)) {
            once(rotation);
            const PoseConvention before = c;
            c = *named;
            c.radian = angle ? before.radian : c.radian;
            c.unit = before.unit;
            c.transposed = before.transposed;
            c.inverse = before.inverse;
        } else if (word == "deg" || word == "rad") {
            once(angle);
            c.radian = word == "rad";
        } else if (word == "transposed") {
            once(c.transposed);
        } else if (word == "inverse") {
            once(c.inverse);
        } else {
            const auto* known = std::find(std::begin(kLengthUnits), std::end(kLengthUnits), word);
            if (known == std::end(kLengthUnits))
                return input_error(Text("\"{}\" is no word of a pose's convention", std::string(word)), where,
                                   "write for example euler-zyx-intrinsic,deg,mm or quat-xyzw,m,inverse");
            once(unit);
            c.unit = *known;
        }
        if (!fresh)
            return input_error(Text("\"{}\" is said after another of its kind", std::string(word)), where);
    }
    if (!rotation)
        return input_error("the convention does not say what the rotation is", where,
                           "write for example euler-zyx-intrinsic,deg,mm or quat-xyzw,m,inverse");
    if (c.transposed && has_angles(c))
        return input_error("angles cannot be transposed", where, "leave transposed out, or say inverse");
    if (angle && !has_angles(c))
        return input_error("this rotation is not written in angles", where, "leave deg and rad out");
    return c;
}

std::optional<Pose> read_pose(const PoseNumbers& numbers, const PoseConvention& c) {
    if (numbers.form != form_of(c.rotation) || !numbers.position.allFinite()) return std::nullopt;
    for (const double value : numbers.rotation)
        if (!std::isfinite(value)) return std::nullopt;
    if (numbers.position_in_last_row && !c.transposed) return std::nullopt;
    const Eigen::Vector3d t = mm_of_unit(c.unit).value_or(1) * numbers.position;
    if (t.cwiseAbs().maxCoeff() > kFarthestRead_mm) return std::nullopt;
    auto rotation = read_rotation(numbers, c);
    if (!rotation) return std::nullopt;
    if (c.transposed && !has_angles(c)) rotation->transposeInPlace();
    const Pose pose = make_pose(*rotation, t);
    return c.inverse ? pose.inverse() : pose;
}

PoseNumbers write_pose(const Pose& given, const PoseConvention& c) {
    const Pose pose = c.inverse ? given.inverse() : given;
    PoseNumbers n;
    n.form = form_of(c.rotation);
    n.position = pose.translation() / mm_of_unit(c.unit).value_or(1);
    const bool transposed = c.transposed && !has_angles(c);
    const Eigen::Matrix3d r = transposed ? Eigen::Matrix3d(pose.linear().transpose()) : pose.linear();
    const auto put = [&n](const Eigen::Vector3d& angles) {
        for (Eigen::Index i = 0; i < 3; ++i) n.rotation[static_cast<std::size_t>(i)] = angles[i];
    };
    const double a_rad = c.radian ? 1 : 180 / kPi;
    const AbbQuaternion q = abb_from_rotation(r);
    switch (c.rotation) {
        case RotationReading::euler:
            put(a_rad * euler_from_rotation(c.euler, r));
            break;
        case RotationReading::rotation_vector:
            put(a_rad * rotation_log(r));
            break;
        case RotationReading::quat_wxyz:
            n.rotation = {q.w, q.x, q.y, q.z};
            break;
        case RotationReading::quat_xyzw:
            n.rotation = {q.x, q.y, q.z, q.w};
            break;
        case RotationReading::matrix:
            for (Eigen::Index i = 0; i < 9; ++i) n.rotation[static_cast<std::size_t>(i)] = r(i / 3, i % 3);
            break;
    }
    return n;
}

std::vector<PoseConvention> possible_conventions(std::span<const PoseNumbers> poses,
                                                 const PoseConvention& as_given) {
    std::vector<PoseConvention> all = {as_given};
    const RotationForm form = form_of(as_given.rotation);
    double farthest = 0, widest = 0;
    for (const PoseNumbers& n : poses) {
        farthest = std::max(farthest, n.position.norm());
        for (std::size_t i = 0; i < 3; ++i) widest = std::max(widest, std::abs(n.rotation[i]));
    }
    std::vector<PoseConvention> rotations;
    if (form == RotationForm::angles) {
        for (const bool radian : {false, true}) {
            if (radian && widest > kTurn) continue;
            for (const EulerConvention& euler : euler_conventions())
                rotations.push_back({.euler = euler, .radian = radian});
            rotations.push_back({.rotation = RotationReading::rotation_vector, .radian = radian});
        }
    } else {
        for (const bool transposed : {false, true}) {
            if (form == RotationForm::matrix) {
                rotations.push_back({.rotation = RotationReading::matrix, .transposed = transposed});
                continue;
            }
            rotations.push_back({.rotation = RotationReading::quat_wxyz, .transposed = transposed});
            rotations.push_back({.rotation = RotationReading::quat_xyzw, .transposed = transposed});
        }
    }
    for (const char* unit : kLengthUnits) {
        const double mm = *mm_of_unit(unit) * farthest;
        if (farthest > 0 && (mm < kNearest_mm || mm > kFarthestBase_mm)) continue;
        if (farthest == 0 && unit != kLengthUnits[0]) continue;
        for (const bool inverse : {false, true})
            for (PoseConvention c : rotations) {
                c.unit = unit;
                c.inverse = inverse;
                if (c == as_given) continue;
                all.push_back(c);
            }
    }
    return all;
}

}  // namespace seamwright
