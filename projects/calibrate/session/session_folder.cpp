#include "projects/calibrate/session/session_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "devices/exchange/json_fields.h"
#include "projects/calibrate/session/session.h"

namespace seamwright {

namespace fs = std::filesystem;
using nlohmann::json;

std::string file_name(const std::string& text) {
    std::string name;
    for (const char c : text)
        name += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.' ? c : '_';
    while (!name.empty() && name.front() == '.') name.front() = '_';
    return name.empty() ? "_" : name;
}

namespace {

// Is it the session of that sensor, taken with none of those robots? What cannot be read may be.
bool is_of(const json& list, const std::string& sensor, const std::vector<std::string>& other_robots) {
    const auto text = [&](const char* key) {
        const auto it = list.is_object() ? list.find(key) : list.end();
        return it != list.end() && it->is_string() ? it->get<std::string>() : std::string();
    };
    const std::string of = text("sensor");
    if (!of.empty() && of != sensor) return false;
    const auto captures = list.is_object() ? list.find("captures") : list.end();
    if (captures == list.end() || captures->empty()) return true;
    return std::ranges::find(other_robots, text("robot")) == other_robots.end();
}

}  // namespace

fs::path session_folder(const fs::path& project_file, const MethodId& method, const SensorId& sensor,
                        const std::vector<std::string>& other_robots) {
    const std::string name = file_name(sensor.text()) + "-" + method.text();
    fs::path folder = CalibrationSession::folder_of(project_file) / name;
    std::error_code code;
    for (int n = 2; fs::exists(folder / "session.json", code); ++n) {
        const auto list = read_json_file(folder / "session.json");
        if (!list || is_of(*list, sensor.text(), other_robots)) break;
        folder.replace_filename(fmt::format("{}-{}", name, n));
    }
    return folder;
}

}  // namespace seamwright
