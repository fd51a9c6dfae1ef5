#include "devices/replay/recording_layout.h"

#include <fmt/format.h>

#include <cmath>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/replay/recording.h"

namespace seamwright {

nlohmann::json recording_layout_json(const RecordingLayout& layout) {
    nlohmann::json json = nlohmann::json::object();
    const auto put = [&](const char* key, const std::string& value) {
        if (!value.empty()) json[key] = value;
    };
    put("unit", layout.profile.unit);
    put("columns", layout.profile.columns);
    put("poses", layout.poses);
    put("pose_convention", layout.pose.convention);
    put("pose_unit", layout.pose.unit);
    put("pose_angle", layout.pose.angle);
    if (layout.channel != ImageChannel::grey) json["channel"] = to_string(layout.channel);
    if (!layout.profile.invalid.empty()) json["invalid"] = layout.profile.invalid;
    const auto put_pose = [&](const char* key, const std::optional<Pose>& pose) {
        if (pose) json[key] = pose_json(*pose);
    };
    put_pose("flange_from_sensor", layout.flange_from_sensor);
    put_pose("flange_from_tool", layout.pose.flange_from_tool);
    put_pose("base_from_user_frame", layout.pose.base_from_user_frame);
    return json;
}

namespace {

constexpr double kFarFromPlane_mm = 0.05;

// Points of the base into the sensor's plane; Error where they do not lie in it.
Expected<Profile> into_plane(const ReadProfile& points, const Pose& base_from_sensor,
                             const std::string& where) {
    const Pose sensor_from_base = base_from_sensor.inverse();
    Profile profile = points.profile;
    double worst = 0;
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const Eigen::Vector3d p =
            sensor_from_base * Eigen::Vector3d(profile.x_mm[i], points.y_mm[i], profile.z_mm[i]);
        profile.x_mm[i] = p.x();
        profile.z_mm[i] = p.z();
        if (p.allFinite()) worst = std::max(worst, std::abs(p.y()));
    }
    if (worst > kFarFromPlane_mm)
        return input_error(Text("its points in space lie up to {:.3g} mm beside the sensor's plane", worst),
                           where,
                           "give points in the robot's base with the pose they were taken at, or x and z");
    return profile;
}

}  // namespace

Expected<RecordingLayout> parse_recording_layout(const nlohmann::json& json, const std::string& where) {
    if (auto ok =
            only_fields(json,
                        {"unit", "columns", "poses", "pose_convention", "pose_unit", "pose_angle", "channel",
                         "flange_from_sensor", "flange_from_tool", "base_from_user_frame", "invalid"},
                        where);
        !ok)
        return tl::unexpected(ok.error());
    RecordingLayout layout;
    std::string channel = "grey";
    for (const auto& [key, value] : {std::pair<const char*, std::string*>{"unit", &layout.profile.unit},
                                     {"columns", &layout.profile.columns},
                                     {"poses", &layout.poses},
                                     {"pose_convention", &layout.pose.convention},
                                     {"pose_unit", &layout.pose.unit},
                                     {"pose_angle", &layout.pose.angle},
                                     {"channel", &channel}}) {
        SEAM_TRY(auto text, json_string_or(json, key, *value, where));
        *value = text;
    }
    const auto known = image_channel(channel);
    if (!known) return input_error(Text("\"{}\" is no channel", channel), json_path(where, "channel"));
    layout.channel = *known;
    if (json.contains("invalid")) {
        SEAM_TRY(auto values, json_array(json, "invalid", where));
        for (const nlohmann::json& value : *values) {
            if (!value.is_number())
                return input_error("is no height", json_path(where, "invalid"), "give numbers");
            layout.profile.invalid.push_back(value.get<double>());
        }
    }
    using Named = std::pair<const char*, std::optional<Pose>*>;
    for (const auto& [key, value] : {Named{"flange_from_sensor", &layout.flange_from_sensor},
                                     Named{"flange_from_tool", &layout.pose.flange_from_tool},
                                     Named{"base_from_user_frame", &layout.pose.base_from_user_frame}}) {
        if (!json.contains(key)) continue;
        SEAM_TRY(auto pose, parse_pose(json[key], json_path(where, key)));
        *value = pose;
    }
    return layout;
}

Expected<void> read_recorded(const RecordedFrame& recorded, const RecordingLayout& layout, int bit_depth,
                             Frame& frame) {
    frame.status = FrameStatus::ok;
    frame.profile.clear();
    frame.image = {};
    frame.spot_id = recorded.spot_id;
    frame.base_from_flange = recorded.base_from_flange;
    if (recorded.image) return read_image_file(recorded.file, frame, bit_depth, layout.channel);
    if (recorded.profile) {  // one of several of a file, read with the list
        frame.profile = *recorded.profile;
        return {};
    }
    SEAM_TRY(auto read, read_profiles(recorded.file, layout.profile));
    if (read.profiles.size() != 1)
        return input_error(Text("holds {} profiles, one was expected", read.profiles.size()),
                           recorded.file.string(), "give the file itself to --from");
    if (!read.profiles.front().y_mm.empty() && layout.flange_from_sensor && recorded.base_from_flange) {
        auto profile =
            into_plane(read.profiles.front(), *recorded.base_from_flange * *layout.flange_from_sensor,
                       recorded.file.string());
        if (!profile) return tl::unexpected(profile.error());
        frame.profile = std::move(*profile);
        return {};
    }
    if (!read.profiles.front().y_mm.empty())
        return input_error("its points lie in space and in no one plane", recorded.file.string(),
                           "give x and z of the sensor's plane, or say the columns with --columns-xz X,Z");
    frame.profile = std::move(read.profiles.front().profile);
    return {};
}

}  // namespace seamwright
