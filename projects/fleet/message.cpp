#include "projects/fleet/message.h"

#include <cmath>

#include "devices/exchange/json_fields.h"
#include "projects/file/project_json.h"
#include "projects/file/stored_text.h"
#include "projects/statistics/statistics.h"

namespace seamwright {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestWord = 256;              // of what is an index of the database
constexpr std::int64_t kLastMs = 253'402'300'799'999;  // end of the year 9999

json number(double value) {
    return std::isfinite(value) ? json(value) : json();
}
template <class Numbers>
json numbers(const Numbers& values) {
    json list = json::array();
    for (const double v : values) list.push_back(number(v));
    return list;
}

// The database takes no NUL inside a text, and what devices say may be no UTF-8.
std::string clean(const std::string& text) {
    std::string out;
    for (const char c : utf8_text(text))
        if (c == '\0')
            out += "\xef\xbf\xbd";
        else
            out += c;
    return out;
}
std::string word(const std::string& text) {
    std::string out = clean(text);
    if (out.size() <= kLongestWord) return out;
    std::size_t end = kLongestWord;
    while (end > 0 && (static_cast<unsigned char>(out[end]) & 0xc0) == 0x80) --end;
    return out.substr(0, end);
}

void add_keys(json& result, const json& keys, json values) {
    std::string encoding;
    for (const json& key : keys) append_netstring(encoding, key.get<std::string>());
    result["keys_id"] = hex(sha256(encoding));
    result["keys"] = keys;
    result["vals"] = std::move(values);
}

json region_json(const RegionValue& r, const std::vector<PathDirection>& points) {
    json out = {{"panel", false},      {"region", word(r.region_id)}, {"passed", r.gate_passed},
                {"used", is_value(r)}, {"status", nullptr},           {"numbers", nullptr},
                {"sigma", nullptr}};
    json keys = json::array(), values = json::array();
    if (r.status) out["status"] = to_string(*r.status);
    if (r.status == CorrectionStatus::ok || r.status == CorrectionStatus::over_limit) {
        const auto six = displacement_numbers(r.workobject_from_movedworkobject);
        out["numbers"] = numbers(six);
        if (r.sigma) out["sigma"] = numbers(*r.sigma);
        for (std::size_t k = 0; k < six.size(); ++k) {
            keys.push_back(kDisplacementKeys[k]);
            values.push_back(number(six[k]));
        }
        for (const PathDirection& at : points) {
            keys.push_back(word(path_point_key(at)));
            values.push_back(number(at.value(r.workobject_from_movedworkobject)));
        }
    }
    add_keys(out, keys, std::move(values));
    return out;
}

json panel_json(const PanelValue& p) {
    json out = {{"panel", true},           {"region", word(p.job_id)},
                {"passed", p.gate_passed}, {"used", !p.after.empty()},
                {"status", nullptr},       {"numbers", nullptr},
                {"sigma", nullptr}};
    json keys = json::array(), values = json::array();
    for (const PlaceValue& place : p.after)
        for (const bool gap : {true, false}) {
            keys.push_back(word(place_key(place.place_id, gap)));
            values.push_back(number(gap ? place.gap_mm : place.flush_mm));
        }
    add_keys(out, keys, std::move(values));
    return out;
}

json time_json(const std::string& utc) {
    const auto ms = utc_milliseconds(utc);
    return ms && *ms >= 0 && *ms <= kLastMs ? json(*ms) : json();
}

void add_refusals(json& list, bool panel, const std::string& region, const std::vector<Text>& refusals) {
    for (const Text& why : refusals)
        list.push_back({{"position", list.size()},
                        {"panel", panel},
                        {"region", word(region)},
                        {"pattern", clean(refusal_pattern(why))},
                        {"english", clean(why.english())},
                        {"body", clean(stored_text(telling_refusal(why)))}});
}

json message_json(const RunValues& run, RunPurpose purpose,
                  const std::map<std::string, std::vector<PathDirection>>& path_points) {
    const json started = time_json(run.started_utc), finished = time_json(run.finished_utc);
    json results = json::array(), refusals = json::array(), unmeasured = json::array(), cycle;
    // A clock that was set back during a run tells no time, a device that failed no cycle.
    if (run.status != RunStatus::device && started.is_number() && finished.is_number() && finished >= started)
        cycle = finished.get<std::int64_t>() - started.get<std::int64_t>();
    for (const RegionValue& r : run.regions) {
        const auto points = path_points.find(r.region_id);
        results.push_back(
            region_json(r, points == path_points.end() ? std::vector<PathDirection>() : points->second));
        add_refusals(refusals, false, r.region_id, r.refusals);
    }
    if (run.panel) {
        results.push_back(panel_json(*run.panel));
        add_refusals(refusals, true, run.panel->job_id, run.panel->refusals);
    }
    for (std::size_t i = 0; i < results.size(); ++i) results[i]["position"] = i;
    for (const auto& [spot, status] : run.not_measured)
        unmeasured.push_back(
            {{"position", unmeasured.size()}, {"spot", clean(spot)}, {"status", to_string(status)}});
    const bool ended = run.status != RunStatus::cancelled && run.status != RunStatus::interrupted;
    return {{"number", run.number},
            {"made_with", run.setup},
            {"part", clean(run.part_id)},
            {"type", word(run.type_id)},
            {"started_ms", started},
            {"finished_ms", finished},
            {"cycle_ms", cycle},
            {"push", run.push},
            {"status", to_string(run.status)},
            {"purpose", static_cast<int>(purpose)},
            {"production", purpose == RunPurpose::production && ended && started.is_number()},
            {"message_key", clean(run.message.key())},
            {"message", clean(run.message.english())},
            {"results", std::move(results)},
            {"refusals", std::move(refusals)},
            {"unmeasured", std::move(unmeasured)}};
}

}  // namespace

FleetSetup fleet_setup(const Project& project) {
    FleetSetup out;
    Project& p = out.project;
    p.name = project.name;
    p.part.name = project.part.name;
    p.part_types = project.part_types;
    p.regions = project.regions;
    p.panel_jobs = project.panel_jobs;
    for (PanelJob& job : p.panel_jobs)
        for (PanelPlace& place : job.places) place.reference_profile = {};
    for (const RobotSetup& robot : project.robots) {
        RobotSetup& named = p.robots.emplace_back();
        named.id = robot.id;
        named.identity = robot.identity;
    }
    out.path_points = path_points_of(project);
    return out;
}

std::string to_text(const FleetSetup& setup) {
    json points = json::object();
    for (const auto& [region, list] : setup.path_points)
        for (const PathDirection& at : list)
            points[utf8_text(region)].push_back({{"spot", at.spot_id},
                                                 {"normal", at.normal},
                                                 {"point_mm", numbers(at.point_mm)},
                                                 {"direction", numbers(at.direction)}});
    const json document = {{"project", to_json_document(setup.project, {.profiles = false})},
                           {"path_points", std::move(points)}};
    return clean(dump_messages(document));
}

Expected<FleetSetup> fleet_setup_from(const std::string& text, const std::string& where) {
    SEAM_TRY(const auto document, parse_json(text, where));
    FleetSetup out;
    SEAM_OK(only_fields(document, {"project", "path_points"}, where));
    SEAM_TRY(out.project, from_json_document<Project>(document.value("project", json::object()), where,
                                                      {.profiles = false}));
    const json points = document.value("path_points", json::object());
    for (const auto& [region, list] : points.items())
        for (const json& item : list) {
            PathDirection at;
            SEAM_TRY(at.spot_id, json_string(item, "spot", where));
            at.normal = item.contains("normal") && item["normal"] == json(true);
            SEAM_TRY(at.point_mm, json_vector3(item, "point_mm", where));
            SEAM_TRY(at.direction, json_vector3(item, "direction", where));
            out.path_points[region].push_back(std::move(at));
        }
    return out;
}

Expected<FleetMessages> FleetMessages::of(const ProjectFile& file) {
    SEAM_TRY(const auto project, file.load());
    SEAM_TRY(const auto evidence, file.evidence());
    FleetMessages out{RunPurposes(evidence)};
    FleetSetup setup = fleet_setup(project);
    out.setup_ = to_text(setup);
    out.path_points_ = std::move(setup.path_points);
    out.name_ = project.name;
    return out;
}

Expected<std::optional<std::string>> FleetMessages::message(const ProjectFile& file,
                                                            const QueuedRun& run) const {
    std::string text = run.message;
    if (text.empty()) {
        RunValuesWanted wanted;
        wanted.run = run.run;
        wanted.sigmas = true;
        SEAM_TRY(const auto values, file.run_values(wanted));
        if (values.empty()) return std::optional<std::string>();
        json made = message_json(values.front(), purposes_.of(values.front()), path_points_);
        made["id"] = run.id;
        made["revision"] = run.revision;
        text = dump_messages(made);
    }
    return std::optional(std::move(text));
}

Expected<void> check_station_name(const std::string& name) {
    const auto wrong = [](const Text& what) {
        return usage_error(what, "--station", "give a short name, \"line 2, left\" for example");
    };
    if (name.empty()) return wrong("the station has no name");
    if (name.size() > kLongestId)
        return wrong(Text("the station's name is longer than {} bytes", kLongestId));
    if (utf8_text(name) != name) return wrong("the station's name is no UTF-8");
    for (const char c : name)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            return wrong("the station's name holds a control character");
    return {};
}

}  // namespace seamwright
