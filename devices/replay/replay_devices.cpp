// The replayed sensor and robot.

#include <fmt/format.h>

#include <atomic>
#include <condition_variable>
#include <thread>

#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/replay/capture_replay.h"
#include "devices/replay/recording.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

// Fields that sensor and robot have in common.
struct ReplaySettings {
    std::filesystem::path folder;
    std::string kind, serial;
    bool loop = false, require_poses = false;
    RecordingLayout layout;
};

Expected<ReplaySettings> common_settings(const nlohmann::json& json) {
    ReplaySettings s;
    const auto folder = json_string(json, "folder", "settings");
    if (!folder) return tl::unexpected(folder.error());
    std::error_code problem;
    s.folder = std::filesystem::weakly_canonical(*folder, problem);
    if (problem || folder->empty()) return file_error("is no folder", *folder);
    const auto loop = json_bool_or(json, "loop", false, "settings");
    if (!loop) return tl::unexpected(loop.error());
    s.loop = *loop;
    const auto poses = json_bool_or(json, "require_poses", false, "settings");
    if (!poses) return tl::unexpected(poses.error());
    s.require_poses = *poses;
    const auto kind = json_string_or(json, "kind", "", "settings");
    if (!kind) return tl::unexpected(kind.error());
    s.kind = *kind;
    if (!s.kind.empty() && s.kind != "profiles" && s.kind != "images") {
        return input_error(Text("\"{}\" is no kind of frame", s.kind), "settings.kind",
                           "give \"profiles\" or \"images\"");
    }
    const auto serial = json_string_or(json, "serial", s.folder.filename().string(), "settings");
    if (!serial) return tl::unexpected(serial.error());
    s.serial = *serial;
    if (json.contains("layout")) {
        auto layout = parse_recording_layout(json["layout"], "settings.layout");
        if (!layout) return tl::unexpected(layout.error());
        s.layout = std::move(*layout);
    }
    return s;
}

Expected<std::shared_ptr<Recording>> shared_recording(const ReplaySettings& s, DeviceSession& session) {
    const std::string key = "replay:" + s.folder.string();
    auto recording = session.shared<Recording>(key, [&]() -> Expected<std::shared_ptr<Recording>> {
        auto frames = list_recording(s.folder, s.kind, s.require_poses, s.layout);
        if (!frames) return tl::unexpected(frames.error());
        return std::make_shared<Recording>(s.folder, std::move(*frames), s.loop);
    });
    if (!recording) return recording;
    // The second of the two devices finds the recording as the first one opened it.
    if ((*recording)->loop() != s.loop) {
        return input_error("sensor and robot of one recording disagree", "settings.loop", "set both alike");
    }
    if (s.require_poses && !(*recording)->frames().front().base_from_flange) {
        return input_error("the recording has no poses", s.folder.string(), "set require_poses to false");
    }
    return recording;
}

class ReplaySensor final : public ProfileSource {
  public:
    ReplaySensor(std::shared_ptr<Recording> recording, SensorIdentity identity, double rate_hz, int bit_depth,
                 std::size_t buffers, RecordingLayout layout)
        : recording_(std::move(recording)),
          identity_(std::move(identity)),
          rate_hz_(rate_hz),
          bit_depth_(bit_depth),
          pool_(buffers),
          layout_(std::move(layout)) {}

    SensorIdentity identity() const override { return identity_; }
    Expected<void> start() override {
        running_ = true;
        return {};
    }
    void stop() override { running_ = false; }

    Expected<void> trigger(const std::string& spot_id) override {
        if (!running_) return device_error("the sensor is not started", "replay");
        return recording_->trigger(spot_id);
    }

    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
        const auto until = Clock::now() + timeout;
        const RecordedFrame* recorded = nullptr;
        for (;;) {
            if (!running_) return device_error("the sensor is not started", "replay");
            const auto next = recording_->next(recorded);
            if (next == Recording::Next::ended)
                return device_error(ErrorCode::end_of_recording, kEndOfRecording,
                                    recording_->folder().string());
            if (next == Recording::Next::frame) break;
            if (Clock::now() >= until) {
                return device_error(
                    ErrorCode::silence, Text("{}: no frame within {} ms", kNoAnswer, timeout.count()),
                    recording_->folder().string(), "let the robot measure or trigger the sensor");
            }
            std::this_thread::sleep_for(
                std::min<Clock::duration>(std::chrono::milliseconds(2), until - Clock::now()));
        }
        if (!pace(until)) {
            recording_->put_back(recorded);
            return device_error(ErrorCode::silence,
                                Text("{}: no frame within {} ms", kNoAnswer, timeout.count()),
                                recording_->folder().string());
        }
        FramePtr frame = pool_.acquire();
        if (!frame) {
            recording_->put_back(recorded);
            const std::lock_guard lock(mutex_);
            ++counters_.underrun;
            return device_error(Text("all {} frame buffers are in use", pool_.size()), "replay",
                                "let go of frames that are no longer needed");
        }
        fill(*recorded, *frame);
        const std::lock_guard lock(mutex_);
        frame->sequence = sequence_++;
        frame->host_time_ns = now_ns();
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
    std::vector<ParameterInfo> parameters() const override {
        return {{"rate_hz", "Hz", 0, 10000, 0, 1,
                 "Frames per second; 0 replays as fast as frames are asked for."}};
    }
    Expected<double> get(const std::string& parameter) const override {
        if (parameter != "rate_hz")
            return usage_error(Text("the replay has no parameter \"{}\"", parameter), "replay");
        return rate_hz_.load();
    }
    Expected<void> set(const std::string& parameter, double value) override {
        if (auto ok = validate({{parameter, value}}, parameters(), "replay"); !ok) return ok;
        rate_hz_ = value;
        return {};
    }

  private:
    // Waits for the frame's turn; false when `until` comes first.
    bool pace(Clock::time_point until) {
        const double rate = rate_hz_;
        if (rate <= 0) return true;
        const auto now = Clock::now();
        if (now < due_) {
            std::this_thread::sleep_until(std::min(due_, until));
            if (due_ > until) return false;
        }
        due_ = std::max(due_, now) +
               std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate));
        return true;
    }

    // A file that cannot be read, or has another size than the first image, gives a corrupt frame: counted,
    // never measured.
    void fill(const RecordedFrame& recorded, Frame& frame) {
        if (!read_recorded(recorded, layout_, bit_depth_, frame)) {
            frame.status = FrameStatus::corrupt;
            return;
        }
        frame.profile.segment.clear();  // what a sensor delivers is not filtered
        if (!recorded.image) return;
        const auto& image = frame.image;
        if (!first_)
            first_ = StripeImage{nullptr, image.width, image.height, image.row_bytes, image.bit_depth};
        if (first_->width != image.width || first_->height != image.height ||
            first_->bit_depth != image.bit_depth) {
            frame.status = FrameStatus::corrupt;
            frame.image = {};
        }
    }

    std::shared_ptr<Recording> recording_;
    SensorIdentity identity_;
    std::atomic<double> rate_hz_;
    int bit_depth_;
    FramePool pool_;
    RecordingLayout layout_;
    std::atomic<bool> running_ = false;
    Clock::time_point due_{};           // of the next frame; only the thread of wait_next()
    std::optional<StripeImage> first_;  // size of the first image; only the thread of wait_next()
    mutable std::mutex mutex_;
    SourceCounters counters_;
    std::uint64_t sequence_ = 0;
    FramePtr latest_;
};

class ReplayRobot final : public RobotLink {
  public:
    ReplayRobot(std::shared_ptr<Recording> recording, RobotIdentity identity, RobotMode mode,
                bool accept_frames, std::map<std::string, Pose> frames)
        : recording_(std::move(recording)),
          identity_(std::move(identity)),
          mode_(mode),
          accept_frames_(accept_frames),
          frames_(std::move(frames)) {}

    Expected<RobotIdentity> identity() override { return identity_; }
    Expected<RobotMode> mode() override { return mode_; }
    bool tells_mode() const override { return false; }  // recordings need not hold it
    Expected<Pose> base_from_flange() override {
        if (!pose_) return device_error("the recording has not reached a pose", where());
        return *pose_;
    }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        std::vector<std::string> ids;
        for (const auto& move : moves) ids.push_back(move.spot_id);
        return recording_->start_moves(ids);
    }
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds) override {
        const RecordedFrame* frame = recording_->fire();
        if (!frame) return device_error("the measuring program has ended", where());
        pose_ = frame->base_from_flange;
        return TriggerEvent{frame->spot_id, now_ns(), frame->base_from_flange};
    }
    Expected<Pose> read_frame(const std::string& name) override {
        const auto it = frames_.find(name);
        if (it == frames_.end()) {
            return device_error(Text("the recording has no frame \"{}\"", name), where(),
                                "give it in the robot's settings under \"frames\"");
        }
        return it->second;
    }
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        if (!accept_frames_) {
            return device_error(Text("a recording has no controller to write the frame \"{}\" to", name),
                                where(), "set \"accept_frames\": true to keep frames in memory");
        }
        frames_[name] = base_from_frame;
        return {};
    }

  private:
    std::string where() const { return recording_->folder().string(); }
    std::shared_ptr<Recording> recording_;
    RobotIdentity identity_;
    RobotMode mode_;
    bool accept_frames_;
    std::map<std::string, Pose> frames_;
    std::optional<Pose> pose_;
};

}  // namespace

Expected<std::unique_ptr<ProfileSource>> open_replay_sensor(const nlohmann::json& settings,
                                                            DeviceSession& session) {
    if (settings.is_object() && settings.contains("file")) return open_capture_sensor(settings, session);
    if (auto ok = only_fields(settings,
                              {"folder", "loop", "rate_hz", "kind", "bit_depth", "require_poses", "buffers",
                               "layout", "vendor", "model", "serial"},
                              "settings");
        !ok) {
        return tl::unexpected(ok.error());
    }
    const auto common = common_settings(settings);
    if (!common) return tl::unexpected(common.error());
    const auto rate = json_number_or(settings, "rate_hz", 0, "settings");
    if (!rate) return tl::unexpected(rate.error());
    if (*rate < 0 || *rate > 10000) return input_error("must be 0 to 10000", "settings.rate_hz");
    const auto depth = json_number_or(settings, "bit_depth", 0, "settings");
    if (!depth) return tl::unexpected(depth.error());
    if (*depth != 0 && *depth != 8 && *depth != 10 && *depth != 12 && *depth != 16) {
        return input_error("must be 0 (the file's own), 8, 10, 12 or 16", "settings.bit_depth");
    }
    const auto buffers = json_number_or(settings, "buffers", 16, "settings");
    if (!buffers) return tl::unexpected(buffers.error());
    if (!(*buffers >= 2 && *buffers <= 4096)) return input_error("must be 2 to 4096", "settings.buffers");
    const auto vendor = json_string_or(settings, "vendor", "", "settings");
    if (!vendor) return tl::unexpected(vendor.error());
    const auto model = json_string_or(settings, "model", "", "settings");
    if (!model) return tl::unexpected(model.error());
    auto recording = shared_recording(*common, session);
    if (!recording) return tl::unexpected(recording.error());
    return std::make_unique<ReplaySensor>(
        *recording, SensorIdentity{"replay", *vendor, *model, common->serial}, *rate,
        static_cast<int>(*depth), static_cast<std::size_t>(*buffers), common->layout);
}

Expected<std::unique_ptr<RobotLink>> open_replay_robot(const nlohmann::json& settings,
                                                       DeviceSession& session) {
    if (settings.is_object() && settings.contains("file")) return open_capture_robot(settings, session);
    if (auto ok = only_fields(settings,
                              {"folder", "loop", "kind", "require_poses", "layout", "accept_frames", "frames",
                               "mode", "brand", "model", "serial"},
                              "settings");
        !ok) {
        return tl::unexpected(ok.error());
    }
    const auto common = common_settings(settings);
    if (!common) return tl::unexpected(common.error());
    const auto accept = json_bool_or(settings, "accept_frames", false, "settings");
    if (!accept) return tl::unexpected(accept.error());
    const auto mode_name = json_string_or(settings, "mode", "automatic", "settings");
    if (!mode_name) return tl::unexpected(mode_name.error());
    const auto mode = robot_mode_from_string(*mode_name);
    if (!mode)
        return input_error(Text("\"{}\" is no mode", *mode_name), "settings.mode", "give e.g. \"automatic\"");
    const auto brand = json_string_or(settings, "brand", "", "settings");
    if (!brand) return tl::unexpected(brand.error());
    const auto model = json_string_or(settings, "model", "", "settings");
    if (!model) return tl::unexpected(model.error());
    std::map<std::string, Pose> frames;
    if (settings.contains("frames")) {
        if (auto ok = only_fields(settings["frames"], {}, "settings.frames"); !ok)
            return tl::unexpected(ok.error());
        for (const auto& [name, pose] : settings["frames"].items()) {
            const auto parsed = parse_pose(pose, "settings.frames." + name);
            if (!parsed) return tl::unexpected(parsed.error());
            frames[name] = *parsed;
        }
    }
    auto recording = shared_recording(*common, session);
    if (!recording) return tl::unexpected(recording.error());
    return std::make_unique<ReplayRobot>(*recording, RobotIdentity{"replay", *brand, *model, common->serial},
                                         *mode, *accept, std::move(frames));
}

}  // namespace seamwright
