#pragma once
// The measuring controller that a simulated cyclic controller starts beside itself, so that one start gives
// the whole robot. start_controller() of registry.h lies above this library and is handed in.

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "devices/simulated/cell.h"
#include "devices/simulated/controller.h"

namespace seamwright {

using StartController = Expected<std::unique_ptr<SimulatedController>> (*)(
    const std::string& driver, std::shared_ptr<SimulatedCell> cell, const nlohmann::json& settings);

// Of {"measuring": {"driver", "settings"}}; nullptr where there is no such field.
Expected<std::unique_ptr<SimulatedController>> start_measuring_controller(const nlohmann::json& settings,
                                                                          std::shared_ptr<SimulatedCell> cell,
                                                                          StartController start_controller);

// Tells when the next part begins: at the measuring controller, whose verdict on the last one is gone then.
class NextPart {
  public:
    bool begins(const SimulatedController* measuring) {
        const bool judged = measuring && measuring->verdict().has_value();
        return std::exchange(judged_, judged) && !judged;
    }

  private:
    bool judged_ = false;
};

}  // namespace seamwright
