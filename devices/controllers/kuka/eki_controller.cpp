// The controller with EthernetKRL.

#include "devices/controllers/kuka/cell_operator.h"
#include "devices/controllers/kuka/controller.h"

namespace seamwright {
namespace {

class EkiController final : public krl::KukaCell {
  public:
    EkiController(std::shared_ptr<SimulatedCell> cell, krl::OperatorSettings settings)
        : KukaCell(std::move(cell), std::move(settings), true) {}
    ~EkiController() override { end(); }
    using KukaCell::begin;
    std::uint16_t port() const override { return static_cast<std::uint16_t>(settings_.port); }
};

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_kuka_eki_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings) {
    SEAM_TRY(auto parsed, krl::parse_operator_settings(settings, 54600, 1));
    auto controller = std::make_unique<EkiController>(std::move(cell), std::move(parsed));
    SEAM_OK(controller->begin());
    return controller;
}

}  // namespace seamwright
