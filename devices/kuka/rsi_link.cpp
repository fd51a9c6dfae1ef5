// Seamwright's end of RSI.

#include <cmath>

#include "devices/exchange/json_fields.h"
#include "devices/kuka/rsi.h"
#include "devices/kuka/rsi_protocol.h"

namespace seamwright {
namespace {

Expected<std::string> one_of(const nlohmann::json& settings, const char* key,
                             std::initializer_list<const char*> known) {
    auto value = json_string_or(settings, key, *known.begin(), "");
    if (!value) return value;
    std::string all;
    for (const char* name : known) {
        if (*value == name) return value;
        all += (all.empty() ? "" : ", ") + std::string(name);
    }
    return input_error(Text("\"{}\" is not known", *value), key, Text("known are {}", all));
}

}  // namespace

Expected<std::unique_ptr<RobotLink>> open_kuka_rsi(const nlohmann::json& settings, DeviceSession& session,
                                                   OpenRobot open_robot) {
    auto common = parse_cyclic_settings(
        settings, {"mode", "reference", "sen_type", "decimals", "path_output", "release_output"}, "kuka-rsi",
        49152);
    if (!common) return tl::unexpected(common.error());
    common->brand = "KUKA";
    RsiOptions options;
    auto mode = one_of(settings, "mode", {"absolute", "relative"});
    if (!mode) return tl::unexpected(mode.error());
    options.relative = *mode == "relative";
    auto reference = one_of(settings, "reference", {"base", "tool"});
    if (!reference) return tl::unexpected(reference.error());
    options.tool = *reference == "tool";
    if (options.relative && options.tool)
        return input_error("relative corrections in the tool do not add up", "reference",
                           "use base, or absolute");
    auto type = json_string_or(settings, "sen_type", options.sen_type, "");
    if (!type) return tl::unexpected(type.error());
    if (type->empty() || type->size() > 64 || type->find_first_of("<>&\"'") != std::string::npos)
        return input_error("not a name that XML can hold", "sen_type");
    options.sen_type = *type;
    auto decimals = json_number_or(settings, "decimals", options.decimals, "");
    if (!decimals) return tl::unexpected(decimals.error());
    if (!(*decimals >= 1 && *decimals <= 9 && *decimals == std::floor(*decimals)))
        return input_error("not a whole number from 1 to 9", "decimals");
    options.decimals = static_cast<int>(*decimals);
    return CyclicLink::open(*common, make_rsi_protocol(options, common->server.cycle_ms), open_robot,
                            session);
}

}  // namespace seamwright
