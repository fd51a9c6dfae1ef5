#include "devices/cell_server.h"

#include "devices/served/served_camera.h"
#include "devices/served/served_gocator.h"

namespace seamwright {

CellServer::CellServer(CellServer&&) noexcept = default;
CellServer& CellServer::operator=(CellServer&&) noexcept = default;
CellServer::~CellServer() = default;

Expected<CellServer> CellServer::start(const CellServerOptions& options) {
    SEAM_TRY(auto cell, SimulatedCell::open(options.cell));
    return start(options, cell);
}

Expected<CellServer> CellServer::start(const CellServerOptions& options,
                                       const std::shared_ptr<SimulatedCell>& cell) {
    CellServer server;
    server.cell_ = cell;
    if (!options.camera_address.empty() && !options.gocator.is_null())
        return usage_error("the cell has one sensor: a camera or a Gocator", "cell server");
    if (!options.program.empty()) cell->store_program(options.program);
    if (!options.camera_address.empty()) {
        nlohmann::json settings = options.camera;
        settings["address"] = options.camera_address;
        SEAM_TRY(auto camera, ServedCamera::open(cell, settings));
        server.camera_ = std::move(camera);
        server.camera_address_ = server.camera_->address();
        settings["address"] = server.camera_address_;
        server.camera_settings_ = std::move(settings);
    }
    if (!options.gocator.is_null()) {
        SEAM_TRY(auto gocator, ServedGocator::open(cell, options.gocator));
        server.gocator_ = std::move(gocator);
    }
    for (const ServedController& c : options.controllers) {
        SEAM_TRY(auto controller, start_controller(c.name, cell, c.settings));
        server.controllers_.emplace_back(c.name, std::move(controller));
    }
    return server;
}

Expected<void> CellServer::plug_camera(bool in) {
    if (camera_address_.empty()) return usage_error("the cell has no camera", "cell server");
    if (!in) {
        camera_.reset();
    } else if (!camera_) {
        SEAM_TRY(auto camera, ServedCamera::open(cell_, camera_settings_));
        camera_ = std::move(camera);
    }
    return {};
}

}  // namespace seamwright
