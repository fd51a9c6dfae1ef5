#include "devices/exchange/pose_json.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>

#include "core/geometry/notation.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/shown_text.h"
#include "devices/exchange/written_pose.h"

namespace seamwright {
namespace {

constexpr double kFarthest_mm = 1e5;
constexpr double kFarthest_m = 50;

Expected<Eigen::Matrix4d> matrix_numbers(const nlohmann::json& json, const std::string& where) {
    Eigen::Matrix4d matrix;
    const bool rows = json.is_array() && !json.empty() && json[0].is_array();
    if (rows) {
        if (json.size() != 4) return input_error(Text("has {} rows instead of 4", json.size()), where);
        for (int r = 0; r < 4; ++r) {
            SEAM_TRY(const auto numbers, as_numbers(json[static_cast<std::size_t>(r)], 4,
                                                    json_path(where, static_cast<std::size_t>(r))));
            for (int c = 0; c < 4; ++c) matrix(r, c) = numbers[static_cast<std::size_t>(c)];
        }
    } else {
        SEAM_TRY(const auto numbers, as_numbers(json, 16, where));
        for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers[static_cast<std::size_t>(i)];
    }
    return matrix;
}

Expected<Pose> from_matrix(const nlohmann::json& json, const std::string& where) {
    SEAM_TRY(const auto matrix, matrix_numbers(json, where));
    return pose_from_matrix(matrix, where);
}

Expected<Eigen::Matrix3d> from_abc(const nlohmann::json& json, const std::string& where) {
    SEAM_TRY(const auto abc, json_vector3(json, "abc", where));
    if (abc.cwiseAbs().maxCoeff() > 720) {
        return input_error("an angle exceeds 720", json_path(where, "abc"), "give degrees");
    }
    return rotation_from_kuka({abc.x(), abc.y(), abc.z()});
}

Expected<Pose> pose_from_metres(const Eigen::Vector3d& t, const Eigen::Vector4d& q_xyzw,
                                const std::string& where) {
    if (!t.allFinite() || !q_xyzw.allFinite()) return input_error("a number is not finite", where);
    if (t.norm() > kFarthest_m) {
        return input_error(Text("the translation is {} m long, but this format is in metres", t.norm()),
                           where, "convert millimetres to metres or use a .json pose file");
    }
    SEAM_TRY(const auto rotation, rotation_from_abb({q_xyzw[3], q_xyzw[0], q_xyzw[1], q_xyzw[2]}, where));
    return make_pose(rotation, 1000.0 * t);
}

// The number at the start of `text`, blanks skipped; text moves behind it.
Expected<double> leading_number(std::string_view text, const std::string& where) {
    double value = 0;
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || problem != std::errc() || end != text.data() + text.size()) {
        return input_error(Text("\"{}\" is no number", shown_text(text, 24)), where);
    }
    return value;
}

// Which of a POSE's fields are there; exactly one form, or all that pose_json() writes.
struct PoseFields {
    bool xyz, abc, quat, matrix;  // else a rotation vector
};
Expected<PoseFields> pose_fields(const nlohmann::json& json, const std::string& where) {
    SEAM_OK(only_fields(json, {"xyz", "abc", "quat_wxyz", "rotvec_rad", "matrix"}, where));
    const bool xyz = json.contains("xyz"), abc = json.contains("abc"), quat = json.contains("quat_wxyz"),
               rotvec = json.contains("rotvec_rad"), matrix = json.contains("matrix");
    if (abc + quat + rotvec > 1 || (matrix && (quat || rotvec)) || (matrix && xyz != abc)) {
        return input_error("mixes several forms of a pose", where,
                           "give xyz with one of abc, quat_wxyz, rotvec_rad, or matrix alone");
    }
    if (!matrix && (!xyz || abc + quat + rotvec != 1)) {
        return input_error(xyz ? "has no rotation" : "has no translation", where,
                           "give xyz with one of abc, quat_wxyz, rotvec_rad, or matrix alone");
    }
    return PoseFields{xyz, abc, quat, matrix};
}

}  // namespace

Expected<Pose> parse_pose(const nlohmann::json& json, const std::string& where) {
    SEAM_TRY(const auto form, pose_fields(json, where));
    const auto [xyz, abc, quat, matrix] = form;
    Eigen::Vector3d t = Eigen::Vector3d::Zero();
    if (xyz) {
        SEAM_TRY(const auto read, json_vector3(json, "xyz", where));
        t = read;
        if (t.cwiseAbs().maxCoeff() > kFarthest_mm) {
            return input_error("the translation exceeds 100 m", json_path(where, "xyz"), "give millimetres");
        }
    }
    if (matrix) {
        const auto pose = from_matrix(json.at("matrix"), json_path(where, "matrix"));
        if (!pose || !xyz) return pose;
        SEAM_TRY(const auto rotation, from_abc(json, where));
        const Pose beside = make_pose(rotation, t);
        if (distance_mm(*pose, beside) > 1e-4 || deg_from_rad(angle_rad(*pose, beside)) > 1e-4) {
            return input_error("xyz and abc contradict matrix", where, "give one form only");
        }
        return pose;
    }
    if (abc) {
        SEAM_TRY(const auto rotation, from_abc(json, where));
        return make_pose(rotation, t);
    }
    if (quat) {
        SEAM_TRY(const auto q, as_numbers(json.at("quat_wxyz"), 4, json_path(where, "quat_wxyz")));
        const auto rotation = rotation_from_abb({q[0], q[1], q[2], q[3]}, json_path(where, "quat_wxyz"));
        if (!rotation) return tl::unexpected(rotation.error());
        return make_pose(*rotation, t);
    }
    SEAM_TRY(const auto w, json_vector3(json, "rotvec_rad", where));
    if (w.norm() > 2 * kPi + 1e-6) {
        return input_error("the rotation vector is longer than one turn", json_path(where, "rotvec_rad"),
                           "give radian");
    }
    return make_pose(rotation_exp(w), t);
}

Expected<WrittenPose> written_pose(const nlohmann::json& json, const std::string& where) {
    SEAM_TRY(const auto form, pose_fields(json, where));
    const auto [xyz, abc, quat, matrix] = form;
    if (matrix && abc) SEAM_OK(parse_pose(json, where));
    WrittenPose pose;
    if (matrix && !abc) {
        SEAM_TRY(const auto m, matrix_numbers(json.at("matrix"), json_path(where, "matrix")));
        pose.as_given.rotation = RotationReading::matrix;
        pose.numbers.form = RotationForm::matrix;
        pose.numbers.position_in_last_row =
            m.col(3).head<3>().isZero(1e-9) && !m.row(3).head<3>().isZero(1e-9);
        pose.numbers.position = pose.numbers.position_in_last_row
                                    ? Eigen::Vector3d(m.row(3).head<3>().transpose())
                                    : Eigen::Vector3d(m.col(3).head<3>());
        const bool homogeneous = pose.numbers.position_in_last_row || m.row(3).head<3>().isZero(1e-9);
        if (!homogeneous || std::abs(m(3, 3) - 1) > 1e-9)
            return input_error("the matrix has neither 0 0 0 1 as its last row nor as its last column",
                               json_path(where, "matrix"));
        for (std::size_t i = 0; i < 9; ++i)
            pose.numbers.rotation[i] = m(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
        return pose;
    }
    SEAM_TRY(const auto t, json_vector3(json, "xyz", where));
    pose.numbers.position = t;
    const char* key = abc ? "abc" : quat ? "quat_wxyz" : "rotvec_rad";
    SEAM_TRY(const auto rotation, as_numbers(json.at(key), quat ? 4 : 3, json_path(where, key)));
    std::copy(rotation.begin(), rotation.end(), pose.numbers.rotation.begin());
    if (quat) {
        pose.numbers.form = RotationForm::quaternion;
        pose.as_given.rotation = RotationReading::quat_wxyz;
    } else if (!abc) {
        pose.as_given.rotation = RotationReading::rotation_vector;
        pose.as_given.radian = true;
    }
    return pose;
}

nlohmann::json pose_json(const Pose& pose) {
    const auto abc = kuka_from_rotation(pose.linear());
    const auto t = pose.translation();
    nlohmann::json matrix = nlohmann::json::array();
    for (int r = 0; r < 4; ++r) {
        matrix.push_back(
            {pose.matrix()(r, 0), pose.matrix()(r, 1), pose.matrix()(r, 2), pose.matrix()(r, 3)});
    }
    return {{"xyz", {t.x(), t.y(), t.z()}}, {"abc", {abc.a_deg, abc.b_deg, abc.c_deg}}, {"matrix", matrix}};
}

Expected<Pose> parse_tuple_pose(std::string_view text, const std::string& where) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    constexpr std::string_view separators = "()[], \t\r\n";
    double numbers[7];
    std::size_t count = 0, at = 0;
    while ((at = text.find_first_not_of(separators, at)) != std::string_view::npos) {
        const auto end = std::min(text.find_first_of(separators, at), text.size());
        SEAM_TRY(const auto number, leading_number(text.substr(at, end - at), where));
        if (count == 7)
            return input_error("holds more than 7 numbers", where, "write ((x, y, z), (qx, qy, qz, qw))");
        numbers[count++] = number;
        at = end;
    }
    if (count != 7) {
        return input_error(Text("holds {} numbers instead of 7", count), where,
                           "write ((x, y, z), (qx, qy, qz, qw)) in metres");
    }
    return pose_from_metres({numbers[0], numbers[1], numbers[2]},
                            {numbers[3], numbers[4], numbers[5], numbers[6]}, where);
}

Expected<Pose> parse_yaml_pose(std::string_view text, const std::string& where) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    std::map<std::string, double, std::less<>> values;
    constexpr std::string_view keys[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};
    const auto trim = [](std::string_view s) {
        const auto first = s.find_first_not_of(" \t\r");
        return first == std::string_view::npos ? std::string_view{}
                                               : s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
    };
    std::size_t line_number = 0;
    while (!text.empty()) {
        const auto end = text.find('\n');
        std::string_view line = text.substr(0, end);
        text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
        ++line_number;
        const std::string at = fmt::format("{}, line {}", where, line_number);
        line = trim(line.substr(0, line.find('#')));
        if (line.empty() || line == "---" || line == "...") continue;
        const auto colon = line.find(':');
        if (colon == std::string_view::npos) return input_error("is no `key: number`", at);
        const std::string_view key = trim(line.substr(0, colon));
        if (std::find(std::begin(keys), std::end(keys), key) == std::end(keys)) {
            return input_error("is not one of x, y, z, qx, qy, qz, qw", at);
        }
        SEAM_TRY(const auto number, leading_number(trim(line.substr(colon + 1)), at));
        if (!values.emplace(key, number).second)
            return input_error(Text("{} is given twice", std::string(key)), at);
    }
    for (std::string_view key : keys) {
        if (!values.contains(key)) return input_error(Text("{} is missing", std::string(key)), where);
    }
    return pose_from_metres({values["x"], values["y"], values["z"]},
                            {values["qx"], values["qy"], values["qz"], values["qw"]}, where);
}

Expected<Pose> read_pose_file(const std::filesystem::path& path) {
    const std::string where = path.string();
    SEAM_TRY(const auto text, read_text_file(path, std::size_t{1} << 20));
    const auto extension = path.extension().string();
    if (extension == ".txt") return parse_tuple_pose(text, where);
    if (extension == ".yaml" || extension == ".yml") return parse_yaml_pose(text, where);
    if (extension == ".json") {
        SEAM_TRY(const auto json, parse_json(text, where));
        if (json.is_object() && json.contains("base_from_flange")) {
            return parse_pose(json["base_from_flange"], where + ": base_from_flange");
        }
        return parse_pose(json, where);
    }
    return input_error("is no known kind of pose file", where, "known are .txt, .yaml and .json");
}

}  // namespace seamwright
