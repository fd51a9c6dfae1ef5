// Sensor and robot of a simulated cell.

#include <fmt/format.h>

#include <atomic>
#include <thread>

#include "devices/silence.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;

class SimulatedSensor final : public ProfileSource {
  public:
    explicit SimulatedSensor(std::shared_ptr<SimulatedCell> cell)
        : cell_(std::move(cell)), pool_(static_cast<std::size_t>(cell_->settings().buffers)) {}
    ~SimulatedSensor() override { cell_->arm(false); }

    SensorIdentity identity() const override {
        return {"simulated", "Seamwright", "simulated stripe camera", cell_->settings().serial};
    }
    Expected<void> start() override {
        running_ = true;
        cell_->arm(true);
        return {};
    }
    void stop() override {
        running_ = false;
        cell_->arm(false);
    }
    Expected<void> trigger(const std::string& spot_id) override { return cell_->software_trigger(spot_id); }

    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
        const auto until = Clock::now() + timeout;
        for (;;) {
            if (!running_) return device_error("the sensor is not started", "simulated sensor");
            if (const auto exposure = cell_->take_exposure()) {
                FramePtr frame = pool_.acquire();
                if (!frame) {  // as a camera would: the frame is lost and counted
                    const std::lock_guard lock(mutex_);
                    ++counters_.underrun;
                } else {
                    deliver(*exposure, *frame);
                    const std::lock_guard lock(mutex_);
                    ++(frame->status == FrameStatus::ok ? counters_.completed : counters_.damaged);
                    latest_ = frame;
                    return frame;
                }
            }
            if (Clock::now() >= until) {
                return device_error(ErrorCode::silence,
                                    Text("{}: no frame within {} ms", kNoAnswer, timeout.count()),
                                    "simulated sensor", "let the robot measure or trigger the sensor");
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }

    FramePtr latest() const override {
        const std::lock_guard lock(mutex_);
        return latest_;
    }
    SourceCounters counters() const override {
        const std::lock_guard lock(mutex_);
        SourceCounters c = counters_;
        c.underrun += cell_->lost_exposures();
        return c;
    }
    std::vector<ParameterInfo> parameters() const override {
        ParameterInfo exposure, gain, laser, scene;
        exposure.name = "exposure_us";
        exposure.unit = "us";
        exposure.minimum = 1;
        exposure.maximum = 1e6;
        exposure.default_value = cell_->settings().exposure.exposure_us;
        exposure.decimals = 0;
        exposure.help = "Exposure time.";
        gain.name = "gain_db";
        gain.unit = "dB";
        gain.maximum = 48;
        gain.default_value = cell_->settings().exposure.gain_db;
        gain.decimals = 1;
        gain.help = "Gain after exposure; 0 dB shows a full well as full scale.";
        laser.name = "laser";
        laser.maximum = 1;
        laser.default_value = 1;
        laser.decimals = 0;
        laser.help = "Laser on or off.";
        laser.choices = {"off", "on"};
        scene.name = "scene";
        scene.maximum = 3;
        scene.default_value = static_cast<double>(cell_->settings().scene);
        scene.decimals = 0;
        scene.help = "What stands before the sensor.";
        scene.choices = {"part", "sphere", "plate", "triangle"};
        return {exposure, gain, laser, scene};
    }
    Expected<double> get(const std::string& parameter) const override {
        for (const auto& info : parameters()) {
            if (info.name == parameter) return cell_->parameter(parameter);
        }
        return usage_error(Text("there is no parameter \"{}\"", parameter), "simulated sensor",
                           "known are exposure_us, gain_db, laser, scene");
    }
    Expected<void> set(const std::string& parameter, double value) override {
        SEAM_OK(validate({{parameter, value}}, parameters(), "simulated sensor"));
        cell_->set_parameter(parameter, value);
        return {};
    }

  private:
    void deliver(const SimulatedCell::Waiting& exposure, Frame& frame) {
        cell_->render(exposure.base_from_flange, exposure.number, frame, nullptr,
                      exposure.sensor_from_drifted);
        frame.spot_id = exposure.spot_id;
        frame.sequence = exposure.number;
        frame.device_time_ns = exposure.time_ns;
        frame.host_time_ns =
            std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
    }

    std::shared_ptr<SimulatedCell> cell_;
    FramePool pool_;
    std::atomic<bool> running_ = false;
    mutable std::mutex mutex_;
    SourceCounters counters_;
    FramePtr latest_;
};

class SimulatedRobot final : public RobotLink {
  public:
    explicit SimulatedRobot(std::shared_ptr<SimulatedCell> cell) : cell_(std::move(cell)) {}
    Expected<RobotIdentity> identity() override {
        return RobotIdentity{"simulated", "Seamwright", "simulated robot", cell_->settings().serial};
    }
    Expected<RobotMode> mode() override { return cell_->mode(); }
    Expected<Pose> base_from_flange() override {
        const auto pose = cell_->reported_flange();
        if (!pose) return device_error("the robot has not moved anywhere yet", "simulated robot");
        return *pose;
    }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        if (cell_->mode() == RobotMode::stopped || cell_->mode() == RobotMode::fault) {
            return device_error("the robot is stopped", "simulated robot", "start it on its controller");
        }
        for (const auto& move : moves) {
            if (!move.trigger.matrix().allFinite() || !move.entry.matrix().allFinite() ||
                !move.exit.matrix().allFinite()) {
                return input_error("a pose of the move is not finite", move.spot_id);
            }
        }
        cell_->start_moves(moves);
        return {};
    }
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds) override {
        const auto event = cell_->next_trigger();
        if (!event) return device_error("the measuring program has ended", "simulated robot");
        return *event;
    }
    Expected<Pose> read_frame(const std::string& name) override { return cell_->read_frame(name); }
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        return cell_->write_frame(name, base_from_frame);
    }
    bool can_move() const override { return true; }
    Expected<void> move_to(const Pose& base_from_flange) override {
        if (!base_from_flange.matrix().allFinite())
            return input_error("the pose is not finite", "simulated robot");
        cell_->move_to(base_from_flange);
        return {};
    }

  private:
    std::shared_ptr<SimulatedCell> cell_;
};

struct SharedCell {
    std::shared_ptr<SimulatedCell> cell;
    nlohmann::json settings;
};

}  // namespace

std::unique_ptr<ProfileSource> make_simulated_sensor(std::shared_ptr<SimulatedCell> cell) {
    return std::make_unique<SimulatedSensor>(std::move(cell));
}
std::unique_ptr<RobotLink> make_simulated_robot(std::shared_ptr<SimulatedCell> cell) {
    return std::make_unique<SimulatedRobot>(std::move(cell));
}

Expected<std::shared_ptr<SimulatedCell>> shared_cell(const nlohmann::json& settings, DeviceSession& session) {
    const auto shared =
        session.shared<SharedCell>("simulated", [&]() -> Expected<std::shared_ptr<SharedCell>> {
            SEAM_TRY(auto cell, SimulatedCell::open(settings));
            return std::make_shared<SharedCell>(SharedCell{cell, settings});
        });
    if (!shared) return tl::unexpected(shared.error());
    if ((*shared)->settings != settings) {
        return input_error("sensor and robot of the simulated cell have different settings", "simulated",
                           "give both the same settings");
    }
    return (*shared)->cell;
}

Expected<std::unique_ptr<ProfileSource>> open_simulated_sensor(const nlohmann::json& settings,
                                                               DeviceSession& session) {
    SEAM_TRY(auto cell, shared_cell(settings, session));
    return make_simulated_sensor(cell);
}

Expected<std::unique_ptr<RobotLink>> open_simulated_robot(const nlohmann::json& settings,
                                                          DeviceSession& session) {
    SEAM_TRY(auto cell, shared_cell(settings, session));
    return make_simulated_robot(cell);
}

}  // namespace seamwright
