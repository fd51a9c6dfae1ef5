#include "projects/calibrate/input/pose_lists.h"

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/written_pose.h"

namespace seamwright {
namespace {

using nlohmann::json;

constexpr const char* kSaid = "pose_convention";
constexpr const char* kRobot = kRobotPose.data();

// What the data say of this list.
Expected<std::optional<PoseConvention>> said_of(const json& data, std::string_view key) {
    const auto said = data.find(kSaid);
    if (said == data.end() || said->is_null()) return std::nullopt;
    const json* code = nullptr;
    if (said->is_string()) {
        if (key == kRobot) code = &*said;
    } else if (said->is_object()) {
        SEAM_OK(only_fields(*said, {kRobot, "camera_from_target"}, kSaid));
        if (const auto it = said->find(key); it != said->end()) code = &*it;
    } else {
        return input_error("this is neither a code nor an object of codes", kSaid);
    }
    if (!code) return std::nullopt;
    if (!code->is_string()) return input_error("this is no code", kSaid);
    SEAM_TRY(auto convention, pose_convention_named(code->get<std::string>(), kSaid));
    return convention;
}

const json* entries_of(const json& data, const PoseListPlace& place) {
    if (!data.is_object()) return nullptr;
    const auto it = data.find(place.entries);
    return it != data.end() && it->is_array() ? &*it : nullptr;
}

const json* pose_of_entry(const json& entry, const PoseListPlace& place) {
    if (!entry.is_object()) return nullptr;
    const auto it = entry.find(place.key);
    return it != entry.end() && !it->is_null() ? &*it : nullptr;
}

std::string where_of(const PoseListPlace& place, std::size_t index) {
    return json_path(json_path(std::string(place.entries), index), std::string(place.key));
}

}  // namespace

Expected<std::vector<WrittenPoses>> written_poses(const PoseLists& places, const json& data) {
    std::vector<WrittenPoses> lists;
    for (const PoseListPlace& place : places) {
        const json* entries = entries_of(data, place);
        if (!entries) continue;
        WrittenPoses list{std::string(place.key), {}, {}};
        for (std::size_t i = 0; i < entries->size(); ++i) {
            const json* one = pose_of_entry((*entries)[i], place);
            if (!one) continue;
            SEAM_TRY(auto written, written_pose(*one, where_of(place, i)));
            if (list.numbers.empty()) list.as_given = written.as_given;
            if (!(written.as_given == list.as_given))
                return input_error("the poses are written in several forms", where_of(place, i),
                                   "write all of a list in one form");
            list.numbers.push_back(written.numbers);
        }
        if (list.numbers.empty()) continue;
        SEAM_TRY(auto said, said_of(data, place.key));
        if (said) {
            if (form_of(said->rotation) != list.numbers.front().form)
                return input_error(Text("the poses are not written as {}", words_of(*said)), kSaid);
            list.as_given = *said;
        }
        lists.push_back(std::move(list));
    }
    return lists;
}

json without_poses(const PoseLists& lists, const json& data, const json& instead) {
    json bare = data;
    bare.erase(kSaid);
    for (const PoseListPlace& place : lists)
        if (const auto list = bare.find(place.entries); list != bare.end() && list->is_array())
            for (json& entry : *list)
                if (entry.is_object() && entry.contains(place.key)) entry[place.key] = instead;
    return bare;
}

Expected<void> say_convention(const PoseLists& lists, const std::string& said, const Text& where,
                              json& data) {
    const std::size_t sign = said.find('=');
    const std::string key = sign == std::string::npos ? kRobot : said.substr(0, sign);
    const std::string code = sign == std::string::npos ? said : said.substr(sign + 1);
    bool known = false;
    for (const PoseListPlace& place : lists) known = known || place.key == key;
    if (!known) return usage_error(Text("its data have no poses {}", key), where);
    if (auto convention = pose_convention_named(code, where); !convention) {
        convention.error().kind = ErrorKind::usage;
        return tl::unexpected(convention.error());
    }
    if (!data.is_object()) return {};
    json& all = data[kSaid];
    if (all.is_string()) all = {{kRobot, all}};
    if (!all.is_object()) all = json::object();
    all[key] = code;
    return {};
}

void UsualPoses::put(json& result) const {
    if (!said_.is_null()) result[kSaid] = said_;
}

Expected<UsualPoses> with_usual_poses(const PoseLists& lists, const json& data) {
    if (!data.is_object() || !data.contains(kSaid)) return UsualPoses(data);
    json changed = data;
    for (const PoseListPlace& place : lists) {
        SEAM_TRY(auto said, said_of(data, place.key));
        if (!said || !entries_of(data, place)) continue;
        json& entries = changed[place.entries];
        for (std::size_t i = 0; i < entries.size(); ++i) {
            const json* one = pose_of_entry(entries[i], place);
            if (!one) continue;
            SEAM_TRY(auto written, written_pose(*one, where_of(place, i)));
            const auto pose = read_pose(written.numbers, *said);
            if (!pose)
                return input_error(Text("these numbers are no pose as {}", words_of(*said)),
                                   where_of(place, i),
                                   "leave the convention out, or see --detect-convention");
            entries[i][place.key] = pose_json(*pose);
        }
    }
    changed.erase(kSaid);
    return UsualPoses(std::move(changed), data[kSaid]);
}

}  // namespace seamwright
