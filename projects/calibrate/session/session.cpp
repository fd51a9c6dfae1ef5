#include "projects/calibrate/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <set>

#include "core/system_text.h"
#include "devices/capture/capture.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "projects/calibrate/session/session_folder.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFormat = "seamwright-calibration-session";
constexpr int kVersion = 2;  // 1: "used_as" is one id, not a list

json capture_json(const CalibrationCapture& c) {
    return {{"id", c.id},
            {"taken_utc", c.taken_utc},
            {"origin", c.origin},
            {"base_from_flange", c.base_from_flange ? pose_json(*c.base_from_flange) : json(nullptr)},
            {"picture", c.picture},
            {"sensor_serial", c.sensor_serial},
            {"robot_serial", c.robot_serial},
            {"entry", c.entry}};
}

Expected<CalibrationCapture> parse_capture(const json& data, const std::string& where) {
    CalibrationCapture c;
    for (auto [key, target] : {std::pair{"id", &c.id}, std::pair{"taken_utc", &c.taken_utc},
                               std::pair{"origin", &c.origin}, std::pair{"picture", &c.picture}}) {
        SEAM_TRY(auto text, json_string(data, key, where));
        *target = text;
    }
    for (auto [key, target] :
         {std::pair{"sensor_serial", &c.sensor_serial}, std::pair{"robot_serial", &c.robot_serial}})
        if (data.contains(key)) {
            SEAM_TRY(*target, json_string(data, key, where));
        }
    if (const auto it = data.find("base_from_flange"); it != data.end() && !it->is_null()) {
        SEAM_TRY(auto pose, parse_pose(*it, json_path(where, "base_from_flange")));
        c.base_from_flange = pose;
    }
    SEAM_TRY(auto entry, json_field(data, "entry", where));
    c.entry = *entry;
    return c;
}

json marks_json(const SessionState& state) {
    json list = json::array();
    for (const SessionCapture& c : state.captures)
        list.push_back({{"id", c.taken->id}, {"left_out", c.left_out}, {"verification", c.verification}});
    return list;
}

int number_of(const std::string& id) {
    int n = 0;
    if (id.size() < 2 || id[0] != 'P') return 0;
    const auto end = id.data() + id.size();
    const auto parsed = std::from_chars(id.data() + 1, end, n);
    return parsed.ec == std::errc() && parsed.ptr == end ? n : 0;
}

Expected<void> make_folder(const fs::path& folder) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (code) return file_error(Text("the folder cannot be made: {}", system_text(code)), folder.string());
    return {};
}

}  // namespace

const std::string& sensor_of_chain(const CalibrationCapture& capture) {
    if (capture.entry.is_object())
        if (const auto named = capture.entry.find("sensor");
            named != capture.entry.end() && named->is_string())
            return named->get_ref<const std::string&>();
    return capture.id;
}

fs::path CalibrationSession::folder_of(const fs::path& project_file) {
    return fs::path(project_file.string() + ".calibration");
}

Expected<void> CalibrationSession::put_aside(const fs::path& project_file) {
    SEAM_OK(put_folder_aside(folder_of(project_file)));
    return {};
}

Expected<void> CalibrationSession::copy_all(const fs::path& from_project, const fs::path& to_project) {
    SEAM_OK(put_aside(to_project));
    std::error_code code;
    const fs::path from = folder_of(from_project), to = folder_of(to_project);
    if (!fs::exists(from, code)) return {};
    fs::copy(from, to, fs::copy_options::recursive, code);
    if (code)
        return file_error(Text("the calibration sessions cannot be copied: {}", system_text(code)),
                          to.string());
    return {};
}

namespace {

std::vector<std::string> without(std::vector<std::string> names, const std::string& one) {
    std::erase(names, one);
    return names;
}

}  // namespace

bool CalibrationSession::exists(const fs::path& project_file, const MethodId& method, const SensorId& sensor,
                                const std::vector<std::string>& sensors) {
    std::error_code code;
    return fs::exists(
        session_folder(project_file, method, sensor, {without(sensors, sensor.text()), {}}) / "session.json",
        code);
}

Expected<CalibrationSession> CalibrationSession::open(const fs::path& project_file, const MethodId& method,
                                                      const SensorId& sensor, const RobotId& robot,
                                                      const std::vector<std::string>& robots,
                                                      const std::vector<std::string>& sensors) {
    CalibrationSession s;
    s.method_ = find_method(method.text());
    if (!s.method_)
        return usage_error(Text("the calibration method '{}' is unknown", method.text()), "method");
    s.sensor_id_ = sensor.text();
    s.robot_id_ = robot.text();
    s.folder_ = session_folder(project_file, method, sensor,
                               {without(sensors, sensor.text()), without(robots, robot.text())});
    s.state_.settings = default_settings(*s.method_);
    std::error_code code;
    if (fs::exists(s.folder_ / "session.json", code)) SEAM_OK(s.read());
    return s;
}

Expected<void> CalibrationSession::read() {
    const fs::path list_file = folder_ / "session.json";
    auto data = read_json_file(list_file);
    const auto mend = "move the folder away to begin anew";
    if (!data) return file_error(data.error().what, list_file.string(), mend);
    const auto whole = [](const json& holder, const char* key) {
        const auto it = holder.find(key);
        return it != holder.end() && it->is_number_integer() ? it->get<int>() : 0;
    };
    if (!data->is_object() || data->value("format", json()) != kFormat ||
        data->value("method", json()) != method_->id)
        return file_error(Text("this is no calibration session of {}", method_->id), list_file.string(),
                          mend);
    if (whole(*data, "version") > kVersion)
        return file_error("a newer Seamwright has written this session", list_file.string(), "use that one");
    auto settings = json_field(*data, "settings", "");
    auto captures = json_array(*data, "captures", "");
    if (!settings || !captures)
        return file_error((!settings ? settings.error() : captures.error()).text(), list_file.string(), mend);
    state_.settings = **settings;
    if (const auto used = data->find("used_as"); used != data->end()) {
        for (const json& id : used->is_array() ? *used : json::array({*used}))
            if (id.is_string() && !id.get_ref<const std::string&>().empty()) used_as_.push_back(id);
    }
    former_sensors_ = former_sensors(*data, sensor_id_);
    last_number_ = whole(*data, "last_number");
    for (const json& mark : **captures) {
        const auto marked = [&](const char* key) {
            const auto it = mark.find(key);
            return it != mark.end() && it->is_boolean() && it->get<bool>();
        };
        const auto named = mark.find("id");
        const std::string id = named != mark.end() && named->is_string() ? named->get<std::string>() : "";
        const fs::path file = folder_ / "captures" / (file_name(id) + ".json");
        auto stored = read_json_file(file);
        auto capture = stored ? parse_capture(*stored, id) : tl::unexpected(stored.error());
        if (!capture) {
            notices_.push_back(Text("capture {} is lost: {}", id, capture.error().text()));
            continue;
        }
        last_number_ = std::max(last_number_, number_of(id));
        state_.captures.push_back({std::make_shared<const CalibrationCapture>(std::move(*capture)),
                                   marked("left_out"), marked("verification")});
    }
    // A solution that does not belong to exactly these captures and marks is solved again; so is one that its document
    // does not hold whole.
    if (auto solved = read_json_file(folder_ / "result.json");
        solved && solved->contains("result") && solved->value("settings", json()) == state_.settings &&
        solved->value("captures", json()) == marks_json(state_)) {
        auto solution = solution_from_document((*solved)["result"]);
        const bool complete = solution && (method_->use != AnswerUse::sensor ||
                                           !serves(solution->verdict()) || solution->found.index() != 0);
        if (complete) {
            solution_ = std::move(*solution);
            solved_from_ = state_;
        }
    }
    return {};
}

Expected<void> CalibrationSession::write_list(const SessionState& state,
                                              const std::vector<std::string>& used_as) const {
    SEAM_OK(make_folder(folder_ / "captures"));
    return write_text_file(folder_ / "session.json", json{{"format", kFormat},
                                                          {"version", kVersion},
                                                          {"method", method_->id},
                                                          {"sensor", sensor_id_},
                                                          {"former_sensors", former_sensors_},
                                                          {"robot", robot_id_},
                                                          {"settings", state.settings},
                                                          {"captures", marks_json(state)},
                                                          {"last_number", last_number_},
                                                          {"used_as", used_as}}
                                                         .dump(1));
}

Expected<void> CalibrationSession::set_state(SessionState state) {
    SEAM_OK(write_list(state, {}));
    state_ = std::move(state);
    used_as_.clear();
    return {};
}

std::string CalibrationSession::free_id() const {
    return fmt::format("P{}", last_number_ + 1);
}

fs::path CalibrationSession::free_picture_path(const std::string& id) const {
    const std::string name = file_name(id.empty() ? free_id() : id);
    fs::path path = folder_ / "captures" / (name + ".png");
    std::error_code code;
    // Undo brings a capture back with its picture.
    for (int n = 2; fs::exists(path, code); ++n)
        path = folder_ / "captures" / fmt::format("{}-{}.png", name, n);
    return path;
}

fs::path CalibrationSession::picture_of(const CalibrationCapture& capture) const {
    if (capture.picture.empty()) return {};
    const fs::path p(capture.picture);
    return p.is_absolute() ? p : folder_ / p;
}

Expected<std::string> CalibrationSession::add(CalibrationCapture capture, bool verification) {
    std::set<std::string> taken;
    for (const SessionCapture& c : state_.captures) taken.insert(file_name(c.taken->id));
    const bool chain = method_->capture == CaptureKind::board_chain && capture.entry.is_object();
    if (chain) {
        const std::string sensor = sensor_of_chain(capture);
        capture.entry["sensor"] = sensor.empty() ? sensor_id_ : sensor;
    }
    if (capture.id.empty()) capture.id = free_id();
    const std::string wanted = capture.id;
    std::error_code code;
    // A capture that was removed keeps its file: undo brings it back.
    for (int n = 2; taken.contains(file_name(capture.id)) ||
                    fs::exists(folder_ / "captures" / (file_name(capture.id) + ".json"), code);
         ++n)
        capture.id = fmt::format("{}-{}", wanted, n);
    if (capture.taken_utc.empty()) capture.taken_utc = utc_now();
    if (capture.entry.is_object()) capture.entry["id"] = capture.id;
    SEAM_OK(make_folder(folder_ / "captures"));
    if (auto ok = write_text_file(folder_ / "captures" / (file_name(capture.id) + ".json"),
                                  capture_json(capture).dump());
        !ok)
        return tl::unexpected(ok.error());
    const int before = last_number_;
    last_number_ = std::max(last_number_, number_of(capture.id));
    const std::string id = capture.id;
    SessionState next = state_;
    if (chain)
        std::erase_if(next.captures, [&](const SessionCapture& c) {
            return sensor_of_chain(*c.taken) == sensor_of_chain(capture);
        });
    next.captures.push_back(
        {std::make_shared<const CalibrationCapture>(std::move(capture)), false, verification});
    if (auto ok = set_state(std::move(next)); !ok) {
        last_number_ = before;
        return tl::unexpected(ok.error());
    }
    return id;
}

namespace {
SessionCapture* find(SessionState& state, const std::string& id) {
    for (SessionCapture& c : state.captures)
        if (c.taken->id == id) return &c;
    return nullptr;
}
}  // namespace

Expected<void> CalibrationSession::leave_out(const std::string& id, bool left_out) {
    SessionState next = state_;
    SessionCapture* c = find(next, id);
    if (!c) return input_error(Text("there is no capture {}", id), method_->id);
    c->left_out = left_out;
    return set_state(std::move(next));
}

Expected<void> CalibrationSession::set_verification(const std::string& id, bool verification) {
    SessionState next = state_;
    SessionCapture* c = find(next, id);
    if (!c) return input_error(Text("there is no capture {}", id), method_->id);
    c->verification = verification;
    return set_state(std::move(next));
}

Expected<void> CalibrationSession::remove(const std::string& id) {
    SessionState next = state_;
    if (std::erase_if(next.captures, [&](const SessionCapture& c) { return c.taken->id == id; }) == 0)
        return input_error(Text("there is no capture {}", id), method_->id);
    return set_state(std::move(next));
}

Expected<void> CalibrationSession::set(const std::string& name, double value) {
    SessionState next = state_;
    SEAM_OK(set_setting(*method_, next.settings, name, value));
    return set_state(std::move(next));
}

Expected<void> CalibrationSession::set_settings(json settings) {
    SessionState next = state_;
    next.settings = std::move(settings);
    return next == state_ ? Expected<void>() : set_state(std::move(next));
}

json CalibrationSession::data() const {
    json data = state_.settings;
    json list = json::array();
    for (const SessionCapture& c : state_.captures) list.push_back(c.taken->entry);
    data[method_->entries] = std::move(list);
    return data;
}

std::vector<std::string> CalibrationSession::exclude() const {
    std::vector<std::string> ids;
    for (std::size_t i = 0; i < state_.captures.size(); ++i) {
        const SessionCapture& c = state_.captures[i];
        // Entries without fields, the lines of a lens, are excluded by their number.
        if (c.left_out || c.verification)
            ids.push_back(c.taken->entry.is_object() ? c.taken->id : std::to_string(i));
    }
    return ids;
}

int CalibrationSession::solving_captures() const {
    return static_cast<int>(
        std::count_if(state_.captures.begin(), state_.captures.end(),
                      [](const SessionCapture& c) { return !c.left_out && !c.verification; }));
}

int CalibrationSession::verification_captures() const {
    return static_cast<int>(
        std::count_if(state_.captures.begin(), state_.captures.end(),
                      [](const SessionCapture& c) { return !c.left_out && c.verification; }));
}

Expected<CalibrationSolution> CalibrationSession::solve() const {
    if (solving_captures() < method_->fewest)
        return input_error(
            Text("{} captures are too few, at least {} are needed", solving_captures(), method_->fewest),
            method_->id, "take more");
    return solve_calibration(*method_, data(), exclude());
}

Expected<void> CalibrationSession::take(const CalibrationSolution& solution,
                                        const SessionState& solved_from) {
    const json stored{{"result", solution.document},
                      {"settings", solved_from.settings},
                      {"captures", marks_json(solved_from)}};
    SEAM_OK(make_folder(folder_));
    SEAM_OK(write_text_file(folder_ / "result.json", stored.dump(1)));
    solution_ = solution;
    solved_from_ = solved_from;
    return {};
}

const CalibrationSolution* CalibrationSession::solution() const {
    return solution_ && solved_from_ == state_ ? &*solution_ : nullptr;
}

std::vector<PoseRow> CalibrationSession::rows() const {
    std::vector<PoseRow> rows;
    const CalibrationSolution* solved = solution();
    for (std::size_t i = 0; i < state_.captures.size(); ++i) {
        const SessionCapture& c = state_.captures[i];
        PoseRow row;
        row.id = c.taken->id;
        row.left_out = c.left_out;
        row.verification = c.verification;
        const std::string key = c.taken->entry.is_object() ? row.id : std::to_string(i);
        if (solved)
            for (const PoseResidual& p : solved->report.poses) {
                if (p.id != key) continue;
                row.rms_mm = p.rms_mm;
                row.deg = p.deg;
                row.rms_px = p.rms_px;
                if (c.left_out || c.verification) break;
                row.contradicts = !p.used || p.contradicts;
                row.note = p.note;
            }
        rows.push_back(std::move(row));
    }
    return rows;
}

SessionStage CalibrationSession::stage() const {
    if (!used_as_.empty()) return SessionStage::used;
    if (state_.captures.empty()) return SessionStage::prepare;
    if (solving_captures() < method_->fewest) return SessionStage::capture;
    const CalibrationSolution* solved = solution();
    if (!solved) return SessionStage::solve;
    if (!serves(solved->verdict())) return SessionStage::capture;
    if (!method_->keeps_back) return SessionStage::use;
    return verification().confirmed ? SessionStage::use : SessionStage::verify;
}

Expected<void> CalibrationSession::set_used_as(std::vector<std::string> calibration_ids) {
    SEAM_OK(write_list(state_, calibration_ids));
    used_as_ = std::move(calibration_ids);
    return {};
}

Expected<fs::path> CalibrationSession::begin_anew() {
    SEAM_TRY(auto parked, put_folder_aside(folder_));
    state_.captures.clear();
    last_number_ = 0;
    solution_.reset();
    notices_.clear();
    SEAM_OK(set_state(state_));
    return parked;
}

Expected<void> CalibrationSession::exchange(fs::path& parked) {
    std::error_code code;
    if (parked.empty() || !fs::exists(parked / "session.json", code))
        return file_error("the session that was put aside is no longer there", parked.string());
    SEAM_TRY(auto aside, put_folder_aside(folder_));
    if (auto ok = move_folder(parked, folder_); !ok) {
        if (!aside.empty()) (void)move_folder(aside, folder_);
        return ok;
    }
    CalibrationSession other = *this;
    other.state_ = {};
    other.used_as_.clear();
    other.solution_.reset();
    other.notices_.clear();
    SEAM_OK(other.read());
    *this = std::move(other);
    parked = std::move(aside);
    return {};
}

}  // namespace seamwright
