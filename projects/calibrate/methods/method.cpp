#include "projects/calibrate/methods/method.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/calibration/board/board.h"
#include "devices/exchange/json_fields.h"

namespace seamwright {

using nlohmann::json;

bool shows_board(CaptureKind kind) {
    return kind == CaptureKind::board_and_stripe || kind == CaptureKind::board_pose ||
           kind == CaptureKind::board_points || kind == CaptureKind::board_view || of_all_sensors(kind);
}

bool of_all_sensors(CaptureKind kind) {
    return kind == CaptureKind::board_chain || kind == CaptureKind::board_sights;
}

Expected<json> prepared_settings(const CalibrationMethod& method, json settings, const Calibration* base,
                                 const std::vector<Calibration>& kept, const RobotSetup* robot) {
    if (method.repeatability && robot && !settings.contains("robot") &&
        !robot->arrival_covariance.isZero(0)) {
        // One sigma for the three axes: what arrivals along the worst axis do more, they do less along the others.
        const auto sigma = [](const Eigen::Matrix3d& c) { return std::sqrt(std::max(0.0, c.trace() / 3)); };
        settings["robot"] = {
            {"sigma_mm", sigma(robot->arrival_covariance.topLeftCorner<3, 3>())},
            {"sigma_deg", deg_from_rad(sigma(robot->arrival_covariance.bottomRightCorner<3, 3>()))}};
    }
    return method.prepare ? method.prepare(std::move(settings), base, kept)
                          : Expected<json>(std::move(settings));
}

namespace {

void write_setting(const MethodSetting& which, json& settings, double value) {
    const json::json_pointer at(which.pointer);
    if (which.written.empty()) {
        settings[at] = which.info.decimals == 0 ? std::round(value) : value;
        return;
    }
    const json& written = which.written[static_cast<std::size_t>(std::lround(value))];
    if (!written.is_null())
        settings[at] = written;
    else if (settings.contains(at))
        settings[at.parent_pointer()].erase(at.back());
}

}  // namespace

json default_settings(const CalibrationMethod& method) {
    json settings = method.fixed_settings;
    for (const MethodSetting& s : method.settings) write_setting(s, settings, s.info.default_value);
    return settings;
}

Expected<void> set_setting(const CalibrationMethod& method, json& settings, const std::string& name,
                           double value) {
    for (const MethodSetting& s : method.settings) {
        if (s.info.name != name) continue;
        SEAM_OK(validate({{name, value}}, {s.info}, method.id));
        write_setting(s, settings, value);
        return {};
    }
    return input_error(Text("there is no setting \"{}\"", name), method.id);
}

double setting(const MethodSetting& which, const json& settings) {
    const json::json_pointer at(which.pointer);
    if (!which.written.empty()) {
        const json written = settings.contains(at) ? settings[at] : json();
        const auto it = std::find(which.written.begin(), which.written.end(), written);
        return it == which.written.end() ? which.info.default_value
                                         : static_cast<double>(it - which.written.begin());
    }
    return settings.contains(at) && settings[at].is_number() ? settings[at].get<double>()
                                                             : which.info.default_value;
}

MethodSetting number_setting(const char* name, const char* pointer, const char* unit, double minimum,
                             double maximum, double otherwise, int decimals, const char* help, Text label) {
    MethodSetting s;
    s.info.name = name;
    s.info.unit = unit;
    s.info.minimum = minimum;
    s.info.maximum = maximum;
    s.info.default_value = otherwise;
    s.info.decimals = decimals;
    s.info.help = help;
    s.pointer = pointer;
    s.label = std::move(label);
    return s;
}

MethodSetting choice_setting(const char* name, const char* pointer, std::vector<std::string> choices,
                             std::vector<json> written, const char* help, Text label) {
    MethodSetting s;
    s.info.name = name;
    s.info.maximum = static_cast<double>(choices.size()) - 1;
    s.info.decimals = 0;
    s.info.help = help;
    s.info.choices = std::move(choices);
    s.pointer = pointer;
    s.label = std::move(label);
    s.written = std::move(written);
    return s;
}

MethodSetting sphere_radius_setting() {
    return number_setting("radius", "/radius_mm", "mm", 1, 500, 25, 4, "Radius of the sphere.",
                          "Radius of the sphere");
}

std::vector<MethodSetting> board_settings() {
    std::vector<std::string> patterns, dictionaries{"found"};
    std::vector<json> pattern_written{json()}, dictionary_written{json()};
    for (const BoardPattern p :
         {BoardPattern::chessboard, BoardPattern::circles, BoardPattern::charuco, BoardPattern::aprilgrid}) {
        patterns.emplace_back(name_of(p));
        if (p != BoardPattern::chessboard) pattern_written.emplace_back(name_of(p));
    }
    for (const std::string& name : dictionary_names()) {
        dictionaries.push_back(name);
        dictionary_written.emplace_back(name);
    }
    return {
        choice_setting(
            "board_pattern", "/board/pattern", patterns, pattern_written,
            "Chessboard; grid of circles; chessboard with markers (ChArUco); grid of tags (AprilGrid).",
            "Pattern"),
        number_setting("board_columns", "/board/columns", "", 3, 200, 7, 0,
                       "Along the board: inner corners or circles; of ChArUco squares, of AprilGrid tags.",
                       "Corners along"),
        number_setting("board_rows", "/board/rows", "", 3, 200, 6, 0,
                       "Across the board, counted as along it.", "Corners across"),
        number_setting("board_pitch", "/board/pitch_mm", "mm", 0.2, 1000, 10, 3,
                       "Edge of a square; distance of circles; from tag to tag.", "Edge of a square"),
        number_setting("board_marker", "/board/marker_mm", "mm", 0, 1000, 0, 3,
                       "Edge of a marker or tag; 0: found from the picture (ChArUco alone).",
                       "Edge of a marker"),
        choice_setting("board_dictionary", "/board/dictionary", dictionaries, dictionary_written,
                       "The markers' dictionary; found: the one that fits the picture.", "Dictionary"),
        choice_setting("board_legacy", "/board/legacy", {"found", "yes", "no"}, {json(), true, false},
                       "ChArUco as OpenCV drew it before version 4.6.", "Old layout")};
}

DataFields robot_fields() {
    return {"robot", {"sigma_mm", "sigma_deg"}};
}

DataFields camera_fields(std::string at) {
    return {std::move(at), {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "width", "height"}};
}

namespace {

constexpr const char* kPoseConvention =
    "pose_convention";  // of a method without poses it would act on nothing
constexpr std::size_t kShortestBeginning = 4, kShortWord = 5;  // letters

// In small letters, without what joins words.
std::string plain(std::string_view name) {
    std::string letters;
    for (const char c : name)
        if (std::isalnum(static_cast<unsigned char>(c)))
            letters += char(std::tolower(static_cast<unsigned char>(c)));
    return letters;
}

// How many letters are to be changed, put in or left out (Levenshtein 1966).
std::size_t letters_apart(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t corner = row[0]++;
        for (std::size_t j = 0; j < b.size(); ++j)
            corner = std::exchange(row[j + 1],
                                   std::min({row[j] + 1, row[j + 1] + 1, corner + (a[i] == b[j] ? 0 : 1)}));
    }
    return row.back();
}

// One is the beginning of the other, or a letter or two are wrong.
bool resembles(const std::string& key, std::string_view known) {
    const std::string a = plain(key), b = plain(known);
    const std::size_t shorter = std::min(a.size(), b.size());
    if (shorter >= kShortestBeginning && a.compare(0, shorter, b, 0, shorter) == 0) return true;
    return letters_apart(a, b) <= (shorter < kShortWord ? shorter / 2 : 2);
}

Expected<void> check_object(const json& object, const DataFields& fields, const std::string& where) {
    const auto in = [](const std::vector<std::string_view>& list, const std::string& key) {
        return std::find(list.begin(), list.end(), key) != list.end();
    };
    for (const auto& [key, value] : object.items()) {
        if (in(fields.known, key) || in(fields.written, key)) continue;
        const auto meant = [&key = key](std::string_view known) { return resembles(key, known); };
        if (key == kPoseConvention || std::any_of(fields.known.begin(), fields.known.end(), meant))
            return only_fields(json{{key, nullptr}}, fields.known, where);
    }
    return {};
}

// `at` is what is left of the place.
Expected<void> check_at(const json& value, std::string_view at, const DataFields& fields,
                        const std::string& where) {
    if (at.starts_with("[]")) {
        if (!value.is_array()) return {};
        for (std::size_t i = 0; i < value.size(); ++i)
            SEAM_OK(check_at(value[i], at.substr(2), fields, json_path(where, i)));
        return {};
    }
    if (!value.is_object()) return {};
    if (at.empty()) return check_object(value, fields, where);
    if (at.front() == '.') at.remove_prefix(1);
    const std::string key(at.substr(0, at.find_first_of(".[")));
    const auto it = value.find(key);
    return it == value.end() ? Expected<void>()
                             : check_at(*it, at.substr(key.size()), fields, json_path(where, key));
}

}  // namespace

Expected<void> check_fields(const CalibrationMethod& method, const json& data) {
    for (DataFields fields : method.fields) {
        if (fields.at.empty() && !method.poses.empty()) fields.known.emplace_back(kPoseConvention);
        SEAM_OK(check_at(data, fields.at, fields, ""));
    }
    return {};
}

}  // namespace seamwright
