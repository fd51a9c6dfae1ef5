#include "tests/projects/served_cell.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "devices/capture/capture.h"
#include "devices/exchange/pose_json.h"
#include "devices/net/socket.h"
#include "devices/simulated/scene/door.h"
#include "projects/reuse/simulated_truth.h"
#include "projects/station/acquire.h"
#include "projects/station/teach.h"

namespace seamwright {

Expected<ServedCell> serve_cell(const ServedCellOptions& options, const std::filesystem::path& file) {
    ServedCell served;
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    const nlohmann::json frame = pose_json(default_cell_settings().base_from_workobject);
    auto cell = SimulatedCell::open({{"seed", 5},
                                     {"optics", {{"width", options.width}, {"height", options.height}}},
                                     {"buffers", 64},
                                     {"robot",
                                      {{"repeatability_mm", 0.01},
                                       {"repeatability_deg", 0.001},
                                       {"trigger_jitter_mm", 0.5},
                                       {"frames", {{"path", frame}}}}}});
    if (!cell) return tl::unexpected(cell.error());
    served.cell = *cell;

    constexpr double kSigma_mm = 0.2;
    Project p = simulated_door_project(*served.cell, "all", kSigma_mm);
    p.name = "served door";
    SensorSetup& sensor = p.sensors.front();
    sensor.driver = "genicam";
    sensor.settings = {{"hardware_trigger", true}, {"buffers", 32}};
    nlohmann::json ports;
    if (options.gocator) {
        for (const char* name : {"control_port", "data_port", "ascii_port"})
            ports[name] = TcpListener::listen("127.0.0.1", 0)->port();
        sensor.driver = "gocator";
        sensor.settings.update({{"address", "127.0.0.1"},
                                {"control_port", ports["control_port"]},
                                {"data_port", ports["data_port"]}});
        served.sensor_options.gocator = ports;
    } else {
        // An address of this process alone: a camera that is away for a while finds it free when it is back.
        const int id = static_cast<int>(::getpid());
        served.sensor_options.camera_address =
            fmt::format("127.{}.{}.{}", 10 + id / 62500 % 200, 1 + id / 250 % 250, 1 + id % 250);
    }
    auto sensor_server = CellServer::start(served.sensor_options, served.cell);
    if (!sensor_server) return tl::unexpected(sensor_server.error());
    served.sensor.emplace(std::move(*sensor_server));
    if (!options.gocator)
        sensor.settings["address"] = served.sensor_options.camera_address = served.sensor->camera_address();
    RobotSetup& robot = p.robots.front();
    robot.driver = options.driver;
    robot.settings = {{"port", port}};
    // A UR's arm is commanded once in its cycle, which bounds how much faster than real it can be.
    const double time_scale =
        options.driver == "ur-rtde" ? std::min(options.time_scale, 20.0) : options.time_scale;
    nlohmann::json controller = {{"port", port}, {"time_scale", time_scale}};
    if (options.driver == "ur-rtde")
        robot.settings["dashboard_port"] = controller["dashboard_port"] =
            TcpListener::listen("127.0.0.1", 0)->port();

    served.robot_options.controllers = {{options.driver, controller}};
    served.robot_options.program = measuring_program(p, "R1");
    auto robot_server = CellServer::start(served.robot_options, served.cell);
    if (!robot_server) return tl::unexpected(robot_server.error());
    served.robot.emplace(std::move(*robot_server));

    auto created = ProjectFile::create(file, p, true);
    if (!created) return tl::unexpected(created.error());
    served.station.emplace(std::move(*created), p);
    Station& station = *served.station;
    if (auto connected = station.connect(); !connected) return tl::unexpected(connected.error());
    p = station.project();
    p.calibrations[0].sensor_identity = p.sensors[0].identity;
    p.calibrations[0].robot_identity = p.robots[0].identity;
    // A machine under load may hold an event up for so long that the driver refuses it: half a reference is none.
    auto taught = station.run({});
    for (int again = 0; again < 3 && taught && taught->status == RunStatus::device; ++again)
        taught = station.run({});
    if (!taught) return tl::unexpected(taught.error());
    if (taught->status == RunStatus::device)
        return device_error(Text("the reference was not measured: {}", taught->message), "served cell");
    for (std::size_t i = 0; i < p.spots.size(); ++i) {
        const SpotMeasurement& m = taught->spots[i];
        if (m.status == SpotStatus::measured) p.spots[i].reference_mm = m.measured_mm;
    }
    if (auto saved = station.edit(p); !saved) return tl::unexpected(saved.error());
    if (options.lost_packets_per_mille > 0) {  // from here on
        station.disconnect();
        served.sensor.reset();
        served.sensor_options.camera = {{"lost_packets_per_mille", options.lost_packets_per_mille}};
        auto lossy = CellServer::start(served.sensor_options, served.cell);
        if (!lossy) return tl::unexpected(lossy.error());
        served.sensor.emplace(std::move(*lossy));
        if (auto connected = station.connect(); !connected) return tl::unexpected(connected.error());
    }
    return served;
}

}  // namespace seamwright
