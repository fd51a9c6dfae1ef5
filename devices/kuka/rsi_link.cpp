// Seamwright's end of RSI.

#include "devices/kuka/rsi.h"
#include "devices/kuka/rsi_protocol.h"

namespace seamwright {
const SettingTable& kuka_rsi_settings() {
    static const SettingTable table = entry::joined(
        cyclic_settings(49152, 2),
        {entry::choice("mode", {"absolute", "relative"}, "of RSI_ON"),
         entry::choice("reference", {"base", "tool"}, "of the correction, as POSCORR is set"),
         entry::text("sen_type", "ImFree", "SENTYPE of the controller's configuration"),
         entry::whole("decimals", 7, 1, 9, "of the telegrams' numbers"),
         entry::whole("path_output", 101, 1, 4096, "is on while the path runs, for the program"),
         entry::whole("release_output", 102, 1, 4096, "lets the path begin, for the program")});
    return table;
}

Expected<std::unique_ptr<RobotLink>> open_kuka_rsi(const nlohmann::json& settings, DeviceSession& session,
                                                   OpenRobot open_robot) {
    SEAM_TRY(auto common, parse_cyclic_settings(settings, kuka_rsi_settings(), "kuka-rsi"));
    common.brand = "KUKA";
    RsiOptions options;
    std::string mode, reference;
    SettingsReader f(settings, "", kuka_rsi_settings());
    f.text("mode", mode);
    f.text("reference", reference);
    f.text("sen_type", options.sen_type);
    f.whole("decimals", options.decimals);
    if (f.failed()) return tl::unexpected(f.error());
    options.relative = mode == "relative";
    options.tool = reference == "tool";
    if (options.relative && options.tool)
        return input_error("relative corrections in the tool do not add up", "reference",
                           "use base, or absolute");
    if (options.sen_type.empty() || options.sen_type.size() > 64 ||
        options.sen_type.find_first_of("<>&\"'") != std::string::npos)
        return input_error("not a name that XML can hold", "sen_type");
    return CyclicLink::open(common, make_rsi_protocol(options, common.server.cycle_ms), open_robot, session);
}

}  // namespace seamwright
