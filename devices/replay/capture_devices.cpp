// The sensor and the robot of a capture that is played back.

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "devices/exchange/pose_json.h"
#include "devices/exchange/settings.h"
#include "devices/replay/capture_replay.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

using Clock = CaptureReplay::Clock;
constexpr std::chrono::milliseconds kSlice{5};

class CaptureSensor final : public ProfileSource {
  public:
    CaptureSensor(std::shared_ptr<CaptureReplay> replay, const CaptureSource& source, bool recorded_host_time,
                  std::size_t buffers)
        : replay_(std::move(replay)),
          source_(source),
          recorded_host_time_(recorded_host_time),
          pool_(buffers) {}

    ~CaptureSensor() override { replay_->close_sensor(source_.id); }

    SensorIdentity identity() const override {
        return {"replay", source_.vendor, source_.model, source_.serial};
    }
    Expected<void> start() override {
        running_ = true;
        return {};
    }
    void stop() override { running_ = false; }
    Expected<void> trigger(const std::string& spot_id) override {
        if (!running_) return device_error("the sensor is not started", replay_->where());
        return replay_->trigger(source_.id, spot_id);
    }
    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
        const auto until = Clock::now() + timeout;
        FramePtr frame = pool_.acquire();
        if (!frame) {
            const std::lock_guard lock(mutex_);
            ++counters_.underrun;
            return device_error(Text("all {} frame buffers are in use", pool_.size()), replay_->where(),
                                "let go of frames that are no longer needed");
        }
        for (;;) {
            if (!running_) return device_error("the sensor is not started", replay_->where());
            SEAM_TRY(const auto later, replay_->next(source_.id, *frame));
            if (!later) break;
            const auto now = Clock::now();
            if (now >= until)
                return device_error(ErrorCode::silence,
                                    Text("{}: no frame within {} ms", kNoAnswer, timeout.count()),
                                    replay_->where());
            std::this_thread::sleep_until(std::min({*later, until, now + Clock::duration(kSlice)}));
        }
        if (!recorded_host_time_)
            frame->host_time_ns =
                std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
        const std::lock_guard lock(mutex_);
        ++(frame->status == FrameStatus::ok ? counters_.completed : counters_.damaged);
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
    std::vector<ParameterInfo> parameters() const override { return {}; }
    Expected<double> get(const std::string& parameter) const override {
        return usage_error(Text("a capture has no parameter \"{}\"", parameter), replay_->where());
    }
    Expected<void> set(const std::string& parameter, double) override {
        return usage_error(Text("a capture has no parameter \"{}\"", parameter), replay_->where());
    }

  private:
    std::shared_ptr<CaptureReplay> replay_;
    const CaptureSource source_;
    const bool recorded_host_time_;
    FramePool pool_;
    std::atomic<bool> running_ = false;
    mutable std::mutex mutex_;
    SourceCounters counters_;
    FramePtr latest_;
};

class CaptureRobot final : public RobotLink {
  public:
    CaptureRobot(std::shared_ptr<CaptureReplay> replay, const CaptureSource& source, bool accept_frames,
                 std::map<std::string, Pose> frames)
        : replay_(std::move(replay)),
          source_(source),
          accept_frames_(accept_frames),
          frames_(std::move(frames)) {}

    ~CaptureRobot() override { replay_->close_robot(); }

    Expected<RobotIdentity> identity() override {
        return RobotIdentity{"replay", source_.vendor, source_.model, source_.serial};
    }
    Expected<RobotMode> mode() override { return replay_->mode(); }
    bool tells_mode() const override { return false; }  // recordings need not hold it
    Expected<Pose> base_from_flange() override {
        if (const auto pose = replay_->pose()) return *pose;
        return device_error("the recording has not reached a pose", replay_->where());
    }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        std::vector<std::string> ids;
        for (const auto& move : moves) ids.push_back(move.spot_id);
        return replay_->start_moves(ids);
    }
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override {
        const auto until = Clock::now() + timeout;
        TriggerEvent trigger;
        for (;;) {
            SEAM_TRY(const auto later, replay_->next_trigger(trigger));
            if (!later) return trigger;
            if (Clock::now() >= until)
                return device_error(ErrorCode::silence,
                                    Text("{}: no trigger within {} ms", kNoAnswer, timeout.count()),
                                    replay_->where());
            std::this_thread::sleep_until(std::min(*later, until));
        }
    }
    Expected<Pose> read_frame(const std::string& name) override {
        const auto it = frames_.find(name);
        if (it == frames_.end())
            return device_error(Text("the recording has no frame \"{}\"", name), replay_->where(),
                                "give it in the robot's settings under \"frames\"");
        return it->second;
    }
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        if (!accept_frames_)
            return device_error(Text("a recording has no controller to write the frame \"{}\" to", name),
                                replay_->where(), "set \"accept_frames\": true to keep frames in memory");
        frames_[name] = base_from_frame;
        return {};
    }

  private:
    std::shared_ptr<CaptureReplay> replay_;
    const CaptureSource source_;
    bool accept_frames_;
    std::map<std::string, Pose> frames_;
};

// Opens the file for the first device of a session; the others share it.
Expected<std::shared_ptr<CaptureReplay>> shared_replay(SettingsReader& f, DeviceSession& session) {
    if (f.failed()) return tl::unexpected(f.error());
    SEAM_TRY(const auto file, json_string(f.json(), "file", "settings"));
    double speed = 1;
    bool loop = false;
    f.number("speed", speed);
    f.truth("loop", loop);
    if (f.failed()) return tl::unexpected(f.error());
    if (speed != 0 && speed < 0.001)
        return input_error("must be 0 (as fast as frames are asked for) or 0.001 to 1000", "settings.speed");
    std::error_code problem;
    const auto path = std::filesystem::weakly_canonical(file, problem);
    if (problem || file.empty()) return file_error("is no file", file);
    auto replay = session.shared<CaptureReplay>(
        "capture:" + path.string(), [&]() -> Expected<std::shared_ptr<CaptureReplay>> {
            SEAM_TRY(auto reader, CaptureReader::open(path));
            return std::make_shared<CaptureReplay>(std::move(reader), speed, loop);
        });
    if (!replay) return replay;
    if ((*replay)->speed() != speed || (*replay)->loop() != loop)
        return input_error("the devices of one capture disagree", "settings.speed, settings.loop",
                           "set them alike");
    return replay;
}

}  // namespace

const SettingTable& capture_sensor_settings() {
    using namespace entry;
    static const SettingTable table = {
        text("file", nullptr, "the capture"),
        text("source", "", "name in the capture; empty: the only one"),
        number("speed", 1, 0, 1000,
               "of the recording; 0: as fast as frames are asked for; sensor and robot alike"),
        yes_no("step", false, "a frame only after a trigger"),
        yes_no("loop", false, "begins anew at the end; sensor and robot alike"),
        whole("from", 0, 0, 1e15, "first frame, counted from 0"),
        yes_no("recorded_host_time", false, "frames carry the recorded time of arrival"),
        whole("buffers", 16, 2, 4096, "frames that may be handed out")};
    return table;
}

const SettingTable& capture_robot_settings() {
    using namespace entry;
    static const SettingTable table = {
        text("file", nullptr, "the capture"),
        text("source", "", "name in the capture; empty: the only one"),
        number("speed", 1, 0, 1000,
               "of the recording; 0: as fast as frames are asked for; sensor and robot alike"),
        yes_no("loop", false, "begins anew at the end; sensor and robot alike"),
        yes_no("accept_frames", false, "written frames are taken"),
        object("frames", {}, "NAME: POSE that the controller holds")};
    return table;
}

Expected<std::unique_ptr<ProfileSource>> open_capture_sensor(const nlohmann::json& settings,
                                                             DeviceSession& session) {
    SettingsReader f(settings, "settings", capture_sensor_settings());
    std::string name;
    bool step = false, recorded_time = false;
    std::uint64_t from = 0;
    std::size_t buffers = 0;
    f.text("source", name);
    f.truth("step", step);
    f.truth("recorded_host_time", recorded_time);
    f.whole("from", from);
    f.whole("buffers", buffers);
    SEAM_TRY(auto replay, shared_replay(f, session));
    SEAM_TRY(const auto source, replay->source(name, SourceKind::sensor));
    SEAM_OK(replay->open_sensor(source, from, step));
    return std::make_unique<CaptureSensor>(replay, source, recorded_time, buffers);
}

Expected<std::unique_ptr<RobotLink>> open_capture_robot(const nlohmann::json& settings,
                                                        DeviceSession& session) {
    SettingsReader f(settings, "settings", capture_robot_settings());
    std::string name;
    bool accept = false;
    std::map<std::string, Pose> frames;
    f.text("source", name);
    f.truth("accept_frames", accept);
    f.poses("frames", frames);
    SEAM_TRY(auto replay, shared_replay(f, session));
    SEAM_TRY(const auto source, replay->source(name, SourceKind::robot));
    SEAM_OK(replay->open_robot(source));
    return std::make_unique<CaptureRobot>(replay, source, accept, std::move(frames));
}

}  // namespace seamwright
