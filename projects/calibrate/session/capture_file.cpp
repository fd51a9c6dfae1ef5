#include "projects/calibrate/session/capture_file.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/input/entry.h"

namespace seamwright {
namespace {

using nlohmann::json;

// Solved without any of its entries, the file is read whole and nothing else: what is wrong then and lies in a field of the
// file is the file's; that there are too few is the session's.
Expected<void> check_readable(const CalibrationMethod& method, const ReadCaptures& read, const json& file,
                              const std::string& path) {
    json data = read.settings;
    json& list = data[method.entries] = json::array();
    ExcludedIds all;
    for (const CalibrationCapture& c : read.captures) {
        list.push_back(c.entry);
        all.push_back(c.entry.is_object() && !c.id.empty() ? c.id : std::to_string(list.size() - 1));
    }
    const auto solved = solve_calibration(method, data, all);
    if (solved || solved.error().kind != ErrorKind::input) return {};
    const std::string where = solved.error().where.english();
    const std::string field = where.substr(0, where.find_first_of(".["));
    const bool in_the_list = where.starts_with(method.entries + "[");
    if (!in_the_list && (field == method.entries || !file.contains(field))) return {};
    Error error = solved.error();
    error.within(path);
    return tl::unexpected(std::move(error));
}

std::string without_id(json entry) {
    if (entry.is_object()) entry.erase("id");
    return entry.dump();
}

}  // namespace

Expected<ReadCaptures> read_capture_file(const CalibrationMethod& method, const json& settings,
                                         const std::filesystem::path& path) {
    auto text = read_json_file(path);
    if (!text) {
        Error error = text.error();
        if (error.mend.empty()) error.mend = "choose a JSON file of this method";
        return tl::unexpected(std::move(error));
    }
    json& data = *text;
    if (!data.is_object()) return input_error("the data is not a JSON object", path.string());
    const json file = data;
    ReadCaptures read;
    read.settings = settings;
    json entries;
    const bool chains = method.capture == CaptureKind::board_chain;
    const bool single = chains && !data.contains(method.entries);
    constexpr const char* kReference = "reference_from_world";
    if (chains) read.settings.erase(kReference);  // those of a file end where the file says
    if (single) {
        if (data.contains(kReference)) read.settings[kReference] = data[kReference];
        data.erase(kReference);
        entries = json::array({data});
    } else {
        SEAM_TRY(auto list, json_array(data, method.entries, path.string()));
        entries = *list;
        data.erase(method.entries);
        read.settings.update(data);
    }
    if (entries.empty())
        return input_error(Text("\"{}\" holds nothing", method.entries), path.string(),
                           "choose a file with captures");
    std::set<std::string> sensors;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        CalibrationCapture c;
        const json& entry = entries[i];
        if (entry.is_object()) {
            SEAM_TRY(auto id, entry_id(entry, i, json_path(method.entries, i)));
            if (!single || entry.contains("id")) c.id = id;
            if (entry.contains("base_from_flange") && !entry["base_from_flange"].is_null()) {
                const auto pose = parse_pose(entry["base_from_flange"],
                                             json_path(json_path(method.entries, i), "base_from_flange"));
                if (!pose) {
                    Error error = pose.error();
                    error.within(path.string());
                    return tl::unexpected(std::move(error));
                }
                c.base_from_flange = *pose;
            }
        }
        c.entry = entry;
        c.origin = path.string();
        if (chains && !sensors.insert(sensor_of_chain(c)).second)
            return input_error(Text("the id '{}' occurs twice", sensor_of_chain(c)), path.string(),
                               "give each sensor one chain");
        read.captures.push_back(std::move(c));
    }
    SEAM_OK(check_readable(method, read, file, path.string()));
    return read;
}

NewCaptures without_known(const SessionState& state, std::vector<CalibrationCapture> captures) {
    std::set<std::string> known;
    for (const SessionCapture& c : state.captures) known.insert(without_id(c.taken->entry));
    NewCaptures result;
    for (CalibrationCapture& c : captures)
        if (c.origin == "live" || known.insert(without_id(c.entry)).second)
            result.captures.push_back(std::move(c));
        else
            ++result.known;
    return result;
}

}  // namespace seamwright
