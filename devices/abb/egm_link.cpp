// Seamwright's end of EGM path correction.

#include "devices/abb/egm.h"
#include "devices/abb/egm_protocol.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"

namespace seamwright {

Expected<std::unique_ptr<RobotLink>> open_abb_egm(const nlohmann::json& settings, DeviceSession& session,
                                                  OpenRobot open_robot) {
    nlohmann::json with_defaults = settings;
    if (settings.is_object() && !settings.contains("max_rotation_deg"))
        with_defaults["max_rotation_deg"] = 0.5;
    auto common = parse_cyclic_settings(with_defaults, {"frame", "tcp_from_sensor"}, "abb-egm", 6510);
    if (!common) return tl::unexpected(common.error());
    common->brand = "ABB";
    auto frame = json_string_or(settings, "frame", "path", "");
    if (!frame) return tl::unexpected(frame.error());
    if (*frame != "path" && *frame != "sensor")
        return input_error(Text("\"{}\" is not known", *frame), "frame", "known are path, sensor");
    Pose tcp_from_sensor = Pose::Identity();
    if (settings.contains("tcp_from_sensor")) {
        auto pose = parse_pose(settings["tcp_from_sensor"], "tcp_from_sensor");
        if (!pose) return tl::unexpected(pose.error());
        tcp_from_sensor = *pose;
    }
    return CyclicLink::open(*common, make_egm_protocol({*frame == "sensor", tcp_from_sensor}), open_robot,
                            session);
}

}  // namespace seamwright
