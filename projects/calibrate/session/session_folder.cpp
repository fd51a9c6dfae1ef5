#include "projects/calibrate/session/session_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "core/system_text.h"
#include "devices/capture/capture.h"
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

std::string text_in(const json& list, const char* key) {
    const auto it = list.is_object() ? list.find(key) : list.end();
    return it != list.end() && it->is_string() ? it->get<std::string>() : std::string();
}

bool taken_with_another(const json& list, const std::vector<std::string>& other_robots) {
    const auto captures = list.is_object() ? list.find("captures") : list.end();
    return captures != list.end() && !captures->empty() &&
           std::ranges::find(other_robots, text_in(list, "robot")) != other_robots.end();
}

// Is it the session of that sensor, taken with none of those robots? What cannot be read may be.
bool is_of(const json& list, const std::string& sensor, const OtherDevices& others) {
    const std::string of = text_in(list, "sensor");
    return (of.empty() || of == sensor) && !taken_with_another(list, others.robots);
}

// "A-tcp-sphere", "A-tcp-sphere-2"; behind what was put aside stands its time.
bool is_called_after(const std::string& folder, const std::string& method) {
    std::string_view name = folder;
    const auto last = name.find_last_not_of("0123456789");
    if (last != name.npos && last + 1 < name.size() && name[last] == '-') name = name.substr(0, last);
    return name.ends_with("-" + method);
}

template <class Wanted>
std::vector<fs::path> folders_of(const fs::path& project_file, const Wanted& wanted) {
    std::vector<fs::path> found;
    std::error_code code, looked;
    for (fs::directory_iterator at(CalibrationSession::folder_of(project_file), code), end;
         !code && at != end; at.increment(code))
        if (wanted(at->path().filename().string()) && fs::exists(at->path() / "session.json", looked))
            found.push_back(at->path());
    std::ranges::sort(found);
    return found;
}

}  // namespace

std::vector<std::string> former_sensors(const json& list, const std::string& sensor) {
    std::vector<std::string> names;
    const auto take = [&](const std::string& name) {
        std::erase(names, name);
        if (!name.empty() && name != sensor) names.push_back(name);
    };
    if (const auto former = list.is_object() ? list.find("former_sensors") : list.end();
        former != list.end() && former->is_array())
        for (const json& name : *former)
            if (name.is_string()) take(name.get<std::string>());
    take(text_in(list, "sensor"));
    return names;
}

// Under a name that it had, where the sensor that it names is none of the project's: the project was not saved after the
// renaming.
bool is_session_of(const json& list, const std::string& sensor,
                   const std::vector<std::string>& other_sensors) {
    const std::string of = text_in(list, "sensor");
    if (of == sensor) return true;
    const auto former = former_sensors(list, of);
    return std::ranges::find(former, sensor) != former.end() &&
           std::ranges::find(other_sensors, of) == other_sensors.end();
}

Expected<void> move_folder(const fs::path& from, const fs::path& to) {
    std::error_code code;
    fs::rename(from, to, code);
    if (code) return file_error(Text("the folder cannot be moved: {}", system_text(code)), from.string());
    return {};
}

Expected<fs::path> put_folder_aside(const fs::path& folder) {
    std::error_code code;
    if (!fs::exists(folder, code)) return fs::path();
    std::string time = utc_now();
    std::ranges::replace(time, ':', '.');
    const std::string aside = folder.string() + "-" + time;
    fs::path to = aside;
    for (int n = 2; fs::exists(to, code); ++n) to = fmt::format("{}-{}", aside, n);
    SEAM_OK(move_folder(folder, to));
    return to;
}

std::vector<fs::path> session_folders(const fs::path& project_file) {
    return folders_of(project_file, [](const std::string& name) {
        return std::ranges::any_of(calibration_methods(), [&](const CalibrationMethod& method) {
            return is_called_after(name, method.id);
        });
    });
}

fs::path session_folder(const fs::path& project_file, const MethodId& method, const SensorId& sensor,
                        const OtherDevices& others) {
    const std::string name = file_name(sensor.text()) + "-" + method.text();
    fs::path folder = CalibrationSession::folder_of(project_file) / name;
    std::error_code code;
    for (int n = 2; fs::exists(folder / "session.json", code); ++n) {
        const auto list = read_json_file(folder / "session.json");
        if (!list || is_of(*list, sensor.text(), others)) return folder;
        folder.replace_filename(fmt::format("{}-{}", name, n));
    }
    // Begun under another name.
    fs::path former;
    for (const fs::path& other : folders_of(
             project_file, [&](const std::string& one) { return is_called_after(one, method.text()); })) {
        const auto list = read_json_file(other / "session.json");
        if (!list || text_in(*list, "method") != method.text() ||
            !is_session_of(*list, sensor.text(), others.sensors) || taken_with_another(*list, others.robots))
            continue;
        if (text_in(*list, "sensor") == sensor.text()) return other;
        if (former.empty()) former = other;
    }
    return former.empty() ? folder : former;
}

}  // namespace seamwright
