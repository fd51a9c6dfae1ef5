// Sessions follow their devices to other names.

#include <algorithm>

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "projects/calibrate/session/session.h"
#include "projects/calibrate/session/session_folder.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Which captures of a gripper's shot are whose; undo may bring back those that the list does not name.
Expected<void> rename_in_chains(const fs::path& folder, const std::string& from, const std::string& to) {
    std::error_code code;
    for (fs::directory_iterator at(folder / "captures", code), end; !code && at != end; at.increment(code)) {
        if (at->path().extension() != ".json") continue;
        auto capture = read_json_file(at->path());
        if (!capture || !capture->is_object()) continue;
        const auto entry = capture->find("entry");
        if (entry == capture->end() || !entry->is_object() || entry->value("sensor", json()) != from)
            continue;
        (*entry)["sensor"] = to;
        SEAM_OK(write_text_file(at->path(), capture->dump()));
    }
    return {};
}

bool holds_chains(const json& list) {
    const json name = list.value("method", json());
    const CalibrationMethod* method = name.is_string() ? find_method(name.get<std::string>()) : nullptr;
    return method && method->capture == CaptureKind::board_chain;
}

}  // namespace

Expected<void> CalibrationSession::rename_sensor(const fs::path& project_file, const std::string& from,
                                                 const std::string& to,
                                                 const std::vector<std::string>& other_sensors) {
    for (const fs::path& folder : session_folders(project_file)) {
        auto list = read_json_file(folder / "session.json");
        if (!list || !list->is_object()) continue;
        if (holds_chains(*list)) SEAM_OK(rename_in_chains(folder, from, to));
        if (is_session_of(*list, from, other_sensors)) {
            (*list)["former_sensors"] = former_sensors(*list, to);
            (*list)["sensor"] = to;
            SEAM_OK(write_text_file(folder / "session.json", list->dump(1)));
        } else if (list->value("sensor", json()) == to) {
            SEAM_OK(put_folder_aside(folder));  // of a sensor that is gone
        }
    }
    return {};
}

Expected<void> CalibrationSession::rename_robot(const fs::path& project_file, const std::string& from,
                                                const std::string& to) {
    for (const fs::path& folder : session_folders(project_file)) {
        auto list = read_json_file(folder / "session.json");
        if (!list || !list->is_object() || list->value("robot", json()) != from) continue;
        (*list)["robot"] = to;
        SEAM_OK(write_text_file(folder / "session.json", list->dump(1)));
    }
    return {};
}

void CalibrationSession::renamed(const std::string& sensor, const std::string& robot) {
    former_sensors_ =
        seamwright::former_sensors(json{{"sensor", sensor_id_}, {"former_sensors", former_sensors_}}, sensor);
    sensor_id_ = sensor;
    robot_id_ = robot;
}

}  // namespace seamwright
