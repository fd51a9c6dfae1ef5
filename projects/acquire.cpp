#include "projects/acquire.h"

namespace seamwright {
namespace {

bool hardware_triggered(const SensorSetup& sensor) {
    const auto it = sensor.settings.find("hardware_trigger");
    return it != sensor.settings.end() && it->is_boolean() && it->get<bool>();
}

}  // namespace

MeasuringMove measuring_move(const Spot& spot, const Pose& flange_from_sensor) {
    MeasuringMove move;
    move.spot_id = spot.id;
    move.trigger = spot.base_from_flange;
    const Eigen::Vector3d travel = (spot.base_from_flange * flange_from_sensor).linear().col(1);
    move.entry = move.exit = move.trigger;
    move.entry.translation() -= spot.entry_mm * travel;
    move.exit.translation() += spot.exit_mm * travel;
    move.speed_mm_s = spot.speed_mm_s;
    move.stop_at_trigger = spot.stop_at_trigger;
    return move;
}

Expected<FramePtr> frame_at_trigger(ProfileSource& sensor, const SensorSetup& setup,
                                    const std::string& spot_id, std::chrono::milliseconds timeout,
                                    const std::function<void(const Frame& dropped)>& dropped) {
    if (!hardware_triggered(setup))
        if (auto fired = sensor.trigger(spot_id); !fired) return tl::unexpected(fired.error());
    Expected<FramePtr> frame = sensor.wait_next(timeout);
    while (frame && *frame && !(*frame)->spot_id.empty() && (*frame)->spot_id != spot_id) {
        if (dropped) dropped(**frame);
        frame = sensor.wait_next(timeout);
    }
    if (frame && !*frame) return device_error("the sensor gave no frame", "sensor " + setup.id);
    return frame;
}

StartedSensors::~StartedSensors() {
    for (ProfileSource* sensor : started_) sensor->stop();
}

Expected<void> StartedSensors::start(ProfileSource& sensor) {
    auto started = sensor.start();
    if (started) started_.push_back(&sensor);
    return started;
}

}  // namespace seamwright
