// Sensors and robot of a simulated gripper.

#include <fmt/format.h>

#include <atomic>
#include <condition_variable>

#include "devices/silence.h"
#include "devices/simulated/gripper_cell.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;

class GripperSensor final : public ProfileSource {
  public:
    GripperSensor(std::shared_ptr<GripperCell> cell, std::string head)
        : cell_(std::move(cell)),
          head_(std::move(head)),
          pool_(static_cast<std::size_t>(cell_->settings().common.buffers)) {}

    SensorIdentity identity() const override {
        return {"simulated-gripper", "Seamwright", "simulated stripe camera on a gripper",
                cell_->settings().common.serial + "-" + head_};
    }
    Expected<void> start() override {
        const std::lock_guard lock(mutex_);
        running_ = true;
        waiting_.clear();
        return {};
    }
    void stop() override {
        const std::lock_guard lock(mutex_);
        running_ = false;
        waiting_.clear();
    }
    Expected<void> trigger(const std::string& spot_id) override {
        SEAM_TRY(auto exposed, cell_->expose(spot_id));
        const std::lock_guard lock(mutex_);
        if (!running_) return device_error("the sensor is not started", "simulated gripper");
        waiting_.push_back(std::move(exposed));
        arrived_.notify_one();
        return {};
    }

    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
        GripperCell::Exposed exposed;
        {
            std::unique_lock lock(mutex_);
            if (!running_) return device_error("the sensor is not started", "simulated gripper");
            if (!arrived_.wait_for(lock, timeout, [&] { return !waiting_.empty(); }))
                return device_error(ErrorCode::silence,
                                    Text("{}: no frame within {} ms", kNoAnswer, timeout.count()),
                                    "simulated gripper", "trigger the sensor");
            exposed = std::move(waiting_.front());
            waiting_.pop_front();
        }
        FramePtr frame = pool_.acquire();
        if (!frame) {
            const std::lock_guard lock(mutex_);
            ++counters_.underrun;
            return device_error("no buffer is free for the frame", "simulated gripper");
        }
        frame->status = FrameStatus::ok;
        cell_->render(head_, exposed.base_from_flange, exposed.number, *frame);
        frame->spot_id = exposed.spot_id;
        frame->host_time_ns =
            std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
        frame->device_time_ns = frame->host_time_ns;
        const std::lock_guard lock(mutex_);
        frame->sequence = counters_.completed++;
        latest_ = frame;
        return frame;
    }
    FramePtr latest() const override {
        const std::lock_guard lock(mutex_);
        return latest_;
    }
    SourceCounters counters() const override {
        const std::lock_guard lock(mutex_);
        return counters_;
    }
    std::vector<ParameterInfo> parameters() const override {
        ParameterInfo exposure;
        exposure.name = "exposure_us";
        exposure.unit = "us";
        exposure.minimum = 1;
        exposure.maximum = 1e6;
        exposure.default_value = cell_->settings().common.exposure.exposure_us;
        exposure.decimals = 0;
        exposure.help = "Exposure time.";
        return {exposure};
    }
    Expected<double> get(const std::string& parameter) const override {
        if (parameter == "exposure_us") return cell_->exposure_us();
        return usage_error(Text("there is no parameter \"{}\"", parameter), "simulated gripper",
                           "known is exposure_us");
    }
    Expected<void> set(const std::string& parameter, double value) override {
        SEAM_OK(validate({{parameter, value}}, parameters(), "simulated gripper"));
        cell_->set_exposure_us(value);
        return {};
    }

  private:
    std::shared_ptr<GripperCell> cell_;
    const std::string head_;
    FramePool pool_;
    mutable std::mutex mutex_;
    std::condition_variable arrived_;
    bool running_ = false;
    std::deque<GripperCell::Exposed> waiting_;
    SourceCounters counters_;
    FramePtr latest_;
};

class GripperRobot final : public RobotLink {
  public:
    explicit GripperRobot(std::shared_ptr<GripperCell> cell) : cell_(std::move(cell)) {}
    Expected<RobotIdentity> identity() override {
        return RobotIdentity{"simulated-gripper", "Seamwright", "simulated robot with a gripper",
                             cell_->settings().common.serial};
    }
    Expected<RobotMode> mode() override { return cell_->mode(); }
    Expected<Pose> base_from_flange() override {
        const auto pose = cell_->reported_flange();
        if (!pose) return device_error("the robot has not moved anywhere yet", "simulated gripper");
        return *pose;
    }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        SEAM_OK(check_ready());
        for (const MeasuringMove& move : moves)
            if (!move.trigger.matrix().allFinite())
                return input_error("a pose of the move is not finite", move.spot_id);
        cell_->start_moves(moves);
        return {};
    }
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds) override {
        const auto event = cell_->next_trigger();
        if (!event) return device_error("the measuring program has ended", "simulated gripper");
        return *event;
    }
    Expected<Pose> read_frame(const std::string& name) override { return cell_->read_frame(name); }
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        return cell_->write_frame(name, base_from_frame);
    }
    bool can_move() const override { return true; }
    Expected<void> move_to(const Pose& base_from_flange) override {
        SEAM_OK(check_ready());
        if (!base_from_flange.matrix().allFinite())
            return input_error("the pose is not finite", "simulated gripper");
        cell_->move_to(base_from_flange);
        return {};
    }

  private:
    Expected<void> check_ready() const {
        const RobotMode mode = cell_->mode();
        if (mode != RobotMode::stopped && mode != RobotMode::fault) return {};
        return device_error("the robot is stopped", "simulated gripper", "start it on its controller");
    }
    std::shared_ptr<GripperCell> cell_;
};

struct SharedGripper {
    std::shared_ptr<GripperCell> cell;
    nlohmann::json settings;
};

}  // namespace

std::unique_ptr<ProfileSource> make_gripper_sensor(std::shared_ptr<GripperCell> cell,
                                                   const std::string& head) {
    return std::make_unique<GripperSensor>(std::move(cell), head);
}
std::unique_ptr<RobotLink> make_gripper_robot(std::shared_ptr<GripperCell> cell) {
    return std::make_unique<GripperRobot>(std::move(cell));
}

Expected<std::shared_ptr<GripperCell>> shared_gripper_cell(const nlohmann::json& settings,
                                                           DeviceSession& session) {
    SEAM_OK(parse_gripper_settings(settings));
    nlohmann::json common = settings;
    common.erase("head");
    const auto shared =
        session.shared<SharedGripper>("simulated-gripper", [&]() -> Expected<std::shared_ptr<SharedGripper>> {
            SEAM_TRY(auto cell, GripperCell::open(common));
            return std::make_shared<SharedGripper>(SharedGripper{cell, common});
        });
    if (!shared) return tl::unexpected(shared.error());
    if ((*shared)->settings != common)
        return input_error("sensors and robot of the simulated gripper have different settings",
                           "simulated-gripper", "give all the same settings but for \"head\"");
    return (*shared)->cell;
}

Expected<std::unique_ptr<ProfileSource>> open_gripper_sensor(const nlohmann::json& settings,
                                                             DeviceSession& session) {
    SEAM_TRY(auto cell, shared_gripper_cell(settings, session));
    if (!settings.contains("head"))
        return input_error("it is not said which head this sensor is", "settings.head",
                           "name one of settings.heads");
    return make_gripper_sensor(cell, settings.at("head").get<std::string>());
}

Expected<std::unique_ptr<RobotLink>> open_gripper_robot(const nlohmann::json& settings,
                                                        DeviceSession& session) {
    SEAM_TRY(auto cell, shared_gripper_cell(settings, session));
    return make_gripper_robot(cell);
}

}  // namespace seamwright
