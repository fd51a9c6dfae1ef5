#include "devices/controllers/cyclic/measuring_controller.h"

#include <utility>

#include "devices/exchange/json_fields.h"

namespace seamwright {

Expected<std::unique_ptr<SimulatedController>> start_measuring_controller(const nlohmann::json& settings,
                                                                          std::shared_ptr<SimulatedCell> cell,
                                                                          StartController start_controller) {
    if (!settings.contains("measuring")) return std::unique_ptr<SimulatedController>();
    const nlohmann::json& measuring = settings["measuring"];
    SEAM_OK(only_fields(measuring, {"driver", "settings"}, "measuring"));
    SEAM_TRY(auto name, json_string(measuring, "driver", "measuring"));
    if (name == "kuka-rsi" || name == "abb-egm")
        return input_error("a cyclic correction cannot measure", "measuring.driver");
    if (!start_controller) return usage_error("no measuring controller can be started here", "measuring");
    return start_controller(
        name, std::move(cell),
        measuring.contains("settings") ? measuring["settings"] : nlohmann::json::object());
}

}  // namespace seamwright
