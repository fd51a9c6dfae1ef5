// Seamwright's end of EGM path correction.

#include "devices/abb/egm.h"
#include "devices/abb/egm_protocol.h"

namespace seamwright {

const SettingTable& abb_egm_settings() {
    static const SettingTable table = entry::joined(
        cyclic_settings(6510, 0.5),
        {entry::choice("frame", {"path", "sensor"}, "along whose axes EGMActMove takes the shift"),
         entry::pose("tcp_from_sensor", "sensor frame that EGMActMove was given")});
    return table;
}

Expected<std::unique_ptr<RobotLink>> open_abb_egm(const nlohmann::json& settings, DeviceSession& session,
                                                  OpenRobot open_robot) {
    SEAM_TRY(auto common, parse_cyclic_settings(settings, abb_egm_settings(), "abb-egm"));
    common.brand = "ABB";
    SettingsReader f(settings, "", abb_egm_settings());
    std::string frame;
    Pose tcp_from_sensor = Pose::Identity();
    f.text("frame", frame);
    f.pose("tcp_from_sensor", tcp_from_sensor);
    if (f.failed()) return tl::unexpected(f.error());
    return CyclicLink::open(common, make_egm_protocol({frame == "sensor", tcp_from_sensor}), open_robot,
                            session);
}

}  // namespace seamwright
