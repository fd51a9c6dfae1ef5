// The replayed sensor and robot.

#include <fmt/format.h>

#include <atomic>
#include <condition_variable>
#include <thread>

#include "devices/exchange/pose_json.h"
#include "devices/exchange/settings.h"
#include "devices/host_time.h"
#include "devices/replay/capture_replay.h"
#include "devices/replay/recording.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;

// Fields that sensor and robot have in common.
struct ReplaySettings {
    std::filesystem::path folder;
    std::string kind, serial;
    bool loop = false, require_poses = false;
    RecordingLayout layout;
};

SettingTable common_table() {
    using namespace entry;
    return {text("folder", nullptr, "of the recording"),
            yes_no("loop", false, "begins anew at the end; sensor and robot alike"),
            choice("kind", {"", "profiles", "images"}, "which files of the folder; empty: what is there"),
            yes_no("require_poses", false, "a frame without pose is refused"),
            object("layout",
                   {text("unit", "", "of the profiles"), text("columns", "", "of the profiles"),
                    text("poses", "", "file of the poses"), text("pose_convention", "", "of the poses"),
                    text("pose_unit", "", "of the poses"), text("pose_angle", "", "of the poses"),
                    text("channel", "grey", "of colour images"),
                    pose("flange_from_sensor", "when the poses are the sensor's")},
                   "how foreign files are read; sensor and robot alike"),
            text("model", "", "as the device answers"),
            text("serial", nullptr, "as it answers; else the folder's name")};
}

const SettingTable& folder_sensor_settings() {
    using namespace entry;
    static const SettingTable table = joined(
        common_table(), {number("rate_hz", 0, 0, 10000, "of the frames; 0: as fast as they are asked for"),
                         whole("bit_depth", 0, 0, 16, "of images: 8, 10, 12, 16; 0: the file's own"),
                         whole("buffers", 16, 2, 4096, "frames that may be handed out"),
                         text("vendor", "", "as the sensor answers")});
    return table;
}

const SettingTable& folder_robot_settings() {
    using namespace entry;
    static const SettingTable table =
        joined(common_table(),
               {yes_no("accept_frames", false, "written frames are taken"),
                object("frames", {}, "NAME: POSE that the controller holds"),
                text("mode", "automatic", "operating mode"), text("brand", "", "as the robot answers")});
    return table;
}

// Settings that only a recording in a folder has, then those of a capture.
SettingTable both(const SettingTable& folder, const SettingTable& capture) {
    SettingTable table = capture;
    for (const SettingInfo& s : folder)
        if (std::none_of(capture.begin(), capture.end(),
                         [&](const SettingInfo& c) { return c.name == s.name; }))
            table.push_back(s);
    return table;
}

Expected<ReplaySettings> common_settings(SettingsReader& f) {
    ReplaySettings s;
    if (f.failed()) return tl::unexpected(f.error());
    SEAM_TRY(const auto folder, json_string(f.json(), "folder", "settings"));
    std::error_code problem;
    s.folder = std::filesystem::weakly_canonical(folder, problem);
    if (problem || folder.empty()) return file_error("is no folder", folder);
    f.truth("loop", s.loop);
    f.truth("require_poses", s.require_poses);
    f.text("kind", s.kind);
    s.serial = s.folder.filename().string();
    f.text("serial", s.serial);
    if (f.failed()) return tl::unexpected(f.error());
    if (f.has("layout")) {
        SEAM_TRY(auto layout, parse_recording_layout(f.json().at("layout"), "settings.layout"));
        s.layout = std::move(layout);
    }
    return s;
}

Expected<std::shared_ptr<Recording>> shared_recording(const ReplaySettings& s, DeviceSession& session) {
    const std::string key = "replay:" + s.folder.string();
    auto recording = session.shared<Recording>(key, [&]() -> Expected<std::shared_ptr<Recording>> {
        SEAM_TRY(auto frames, list_recording(s.folder, s.kind, s.require_poses, s.layout));
        return std::make_shared<Recording>(s.folder, std::move(frames), s.loop);
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
        frame->host_time_ns = host_now_ns();
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
        SEAM_OK(validate({{parameter, value}}, parameters(), "replay"));
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
        return TriggerEvent{frame->spot_id, host_now_ns(), frame->base_from_flange};
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

const SettingTable& replay_sensor_settings() {
    static const SettingTable table = both(folder_sensor_settings(), capture_sensor_settings());
    return table;
}

const SettingTable& replay_robot_settings() {
    static const SettingTable table = both(folder_robot_settings(), capture_robot_settings());
    return table;
}

Expected<std::unique_ptr<ProfileSource>> open_replay_sensor(const nlohmann::json& settings,
                                                            DeviceSession& session) {
    if (settings.is_object() && settings.contains("file")) return open_capture_sensor(settings, session);
    SettingsReader f(settings, "settings", folder_sensor_settings());
    SEAM_TRY(const auto common, common_settings(f));
    double rate_hz = 0;
    int depth = 0;
    std::size_t buffers = 0;
    std::string vendor, model;
    f.number("rate_hz", rate_hz);
    f.whole("bit_depth", depth);
    f.whole("buffers", buffers);
    f.text("vendor", vendor);
    f.text("model", model);
    if (f.failed()) return tl::unexpected(f.error());
    if (depth != 0 && depth != 8 && depth != 10 && depth != 12 && depth != 16)
        return input_error("must be 0 (the file's own), 8, 10, 12 or 16", "settings.bit_depth");
    SEAM_TRY(auto recording, shared_recording(common, session));
    return std::make_unique<ReplaySensor>(recording, SensorIdentity{"replay", vendor, model, common.serial},
                                          rate_hz, depth, buffers, common.layout);
}

Expected<std::unique_ptr<RobotLink>> open_replay_robot(const nlohmann::json& settings,
                                                       DeviceSession& session) {
    if (settings.is_object() && settings.contains("file")) return open_capture_robot(settings, session);
    SettingsReader f(settings, "settings", folder_robot_settings());
    SEAM_TRY(const auto common, common_settings(f));
    bool accept = false;
    std::string mode_name, brand, model;
    std::map<std::string, Pose> frames;
    f.truth("accept_frames", accept);
    f.text("mode", mode_name);
    f.text("brand", brand);
    f.text("model", model);
    f.poses("frames", frames);
    if (f.failed()) return tl::unexpected(f.error());
    const auto mode = robot_mode_from_string(mode_name);
    if (!mode)
        return input_error(Text("\"{}\" is no mode", mode_name), "settings.mode", "give e.g. \"automatic\"");
    SEAM_TRY(auto recording, shared_recording(common, session));
    return std::make_unique<ReplayRobot>(recording, RobotIdentity{"replay", brand, model, common.serial},
                                         *mode, accept, std::move(frames));
}

}  // namespace seamwright
