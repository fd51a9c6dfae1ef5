// Devices that record themselves, and the session that records devices of its own.

#include <fmt/format.h>

#include <chrono>

#include "devices/capture/recorder.h"
#include "devices/host_time.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kSlice{100};

CaptureEvent make_event(std::int64_t source, CaptureEventKind kind) {
    CaptureEvent event;
    event.source = source;
    event.kind = kind;
    event.host_time_ns = host_now_ns();
    return event;
}

void note_trigger(Recorder& recorder, std::int64_t source, const TriggerEvent& trigger) {
    CaptureEvent event = make_event(source, CaptureEventKind::trigger);
    if (trigger.host_time_ns != 0) event.host_time_ns = trigger.host_time_ns;
    event.spot_id = trigger.spot_id;
    event.base_from_flange = trigger.base_from_flange;
    recorder.event(std::move(event));
}
void note_pose(Recorder& recorder, std::int64_t source, const Pose& pose) {
    CaptureEvent event = make_event(source, CaptureEventKind::pose);
    event.base_from_flange = pose;
    recorder.event(std::move(event));
}
void note_text(Recorder& recorder, std::int64_t source, CaptureEventKind kind, std::string text) {
    CaptureEvent event = make_event(source, kind);
    event.text = std::move(text);
    recorder.event(std::move(event));
}

class RecordedSensor final : public ProfileSource {
  public:
    RecordedSensor(std::unique_ptr<ProfileSource> sensor, std::shared_ptr<Recorder> recorder,
                   std::int64_t source)
        : sensor_(std::move(sensor)), recorder_(std::move(recorder)), source_(source) {}
    SensorIdentity identity() const override { return sensor_->identity(); }
    Expected<void> start() override { return sensor_->start(); }
    void stop() override { sensor_->stop(); }
    void give_up() override { sensor_->give_up(); }
    Expected<void> trigger(const std::string& spot_id) override { return sensor_->trigger(spot_id); }
    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override {
        auto frame = sensor_->wait_next(timeout);
        if (frame && *frame) recorder_->frame(source_, **frame);
        return frame;
    }
    FramePtr latest() const override { return sensor_->latest(); }
    SourceCounters counters() const override { return sensor_->counters(); }
    Expected<void> answers() override { return sensor_->answers(); }
    std::vector<ParameterInfo> parameters() const override { return sensor_->parameters(); }
    Expected<double> get(const std::string& parameter) const override { return sensor_->get(parameter); }
    Expected<void> set(const std::string& parameter, double value) override {
        return sensor_->set(parameter, value);
    }

  private:
    std::unique_ptr<ProfileSource> sensor_;
    std::shared_ptr<Recorder> recorder_;
    std::int64_t source_;
};

class RecordedRobot final : public RobotLink {
  public:
    RecordedRobot(std::unique_ptr<RobotLink> robot, std::shared_ptr<Recorder> recorder, std::int64_t source)
        : robot_(std::move(robot)), recorder_(std::move(recorder)), source_(source) {}
    Expected<RobotIdentity> identity() override { return robot_->identity(); }
    Expected<RobotMode> mode() override {
        auto mode = robot_->mode();
        if (mode && mode_ != *mode) {
            mode_ = *mode;
            note_text(*recorder_, source_, CaptureEventKind::mode, std::string(to_string(*mode)));
        }
        return mode;
    }
    bool tells_mode() const override { return robot_->tells_mode(); }
    bool permission_outlives_link() const override { return robot_->permission_outlives_link(); }
    Expected<Pose> base_from_flange() override {
        auto pose = robot_->base_from_flange();
        if (pose) note_pose(*recorder_, source_, *pose);
        return pose;
    }
    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override {
        auto signal = robot_->wait_start(timeout);
        if (signal)
            note("start signal for part \"" + signal->part_id + "\"" +
                 (signal->part_type.empty() ? "" : " of type \"" + signal->part_type + "\""));
        return signal;
    }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        auto started = robot_->start_measuring(moves);
        note(started ? fmt::format("measuring of {} spots started", moves.size())
                     : started.error().sentence());
        return started;
    }
    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override {
        auto trigger = robot_->wait_trigger(timeout);
        if (trigger) note_trigger(*recorder_, source_, *trigger);
        return trigger;
    }
    Expected<Pose> read_frame(const std::string& name) override { return robot_->read_frame(name); }
    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        auto written = robot_->write_frame(name, base_from_frame);
        note(written ? "frame \"" + name + "\" written" : written.error().sentence());
        return written;
    }
    Expected<void> confirm(PartVerdict verdict, const std::string& text) override {
        auto confirmed = robot_->confirm(verdict, text);
        note(fmt::format("confirmed as {}{}", to_string(verdict),
                         confirmed ? "" : ": " + confirmed.error().sentence()));
        permission_.reset();
        return confirmed;
    }
    Expected<Permission> permission() override {
        auto permission = robot_->permission();
        if (permission && permission_ != *permission) {
            permission_ = *permission;
            note(fmt::format("permission to run: {}", to_string(*permission)));
        }
        return permission;
    }
    bool can_move() const override { return robot_->can_move(); }
    Expected<void> move_to(const Pose& base_from_flange) override {
        return robot_->move_to(base_from_flange);
    }
    std::vector<Text> take_notices() override {
        auto notices = robot_->take_notices();
        for (const Text& text : notices) note(text.english());
        return notices;
    }

  private:
    void note(std::string text) { note_text(*recorder_, source_, CaptureEventKind::note, std::move(text)); }
    std::unique_ptr<RobotLink> robot_;
    std::shared_ptr<Recorder> recorder_;
    std::int64_t source_;
    std::optional<RobotMode> mode_;
    std::optional<Permission> permission_;
};

}  // namespace

std::unique_ptr<ProfileSource> record_sensor(std::unique_ptr<ProfileSource> sensor,
                                             std::shared_ptr<Recorder> recorder, std::int64_t source) {
    return std::make_unique<RecordedSensor>(std::move(sensor), std::move(recorder), source);
}

std::unique_ptr<RobotLink> record_robot(std::unique_ptr<RobotLink> robot, std::shared_ptr<Recorder> recorder,
                                        std::int64_t source) {
    return std::make_unique<RecordedRobot>(std::move(robot), std::move(recorder), source);
}

Expected<std::unique_ptr<RecordingSession>> RecordingSession::start(std::shared_ptr<Recorder> recorder,
                                                                    std::vector<Sensor> sensors,
                                                                    const std::vector<Robot>& robots) {
    std::unique_ptr<RecordingSession> session(new RecordingSession);
    session->recorder_ = std::move(recorder);
    for (const Sensor& s : sensors) {
        SEAM_OK(s.sensor->start());
        session->started_.push_back(s.sensor);
    }
    session->live_ = static_cast<int>(sensors.size());
    for (Sensor& s : sensors)
        session->threads_.emplace_back(&RecordingSession::pump, session.get(), std::move(s));
    for (const Robot& r : robots) session->threads_.emplace_back(&RecordingSession::listen, session.get(), r);
    return session;
}

RecordingSession::~RecordingSession() {
    stop();
}

void RecordingSession::stop() {
    stop_ = true;
    for (std::thread& thread : threads_)
        if (thread.joinable()) thread.join();
    threads_.clear();
    for (ProfileSource* sensor : started_) sensor->stop();
    started_.clear();
}

void RecordingSession::pump(Sensor s) {
    constexpr std::chrono::seconds kPatience{2};
    ProfileCandidates candidates;
    Text told;
    auto due = Clock::now(), fired_or_seen = due;
    while (!stop_) {
        std::optional<Error> failure;
        auto timeout = kSlice;
        if (s.trigger_hz > 0) {
            const auto now = Clock::now();
            if (now >= due) {
                auto fired = s.sensor->trigger("");
                if (!fired) failure = fired.error();
                if (fired || is_silence(*failure) || is_disconnect(*failure)) fired_or_seen = now;
                due = std::max(due + std::chrono::duration_cast<Clock::duration>(
                                         std::chrono::duration<double>(1 / s.trigger_hz)),
                               now - kSlice);
            }
            timeout = std::clamp(std::chrono::duration_cast<std::chrono::milliseconds>(due - Clock::now()),
                                 std::chrono::milliseconds(1), kSlice);
        }
        auto frame = s.sensor->wait_next(timeout);
        if (frame && *frame) {
            ++frames_;
            fired_or_seen = Clock::now();
            const bool found = s.candidates && !(*frame)->image.empty() &&
                               (*frame)->status == FrameStatus::ok && s.candidates(**frame, candidates);
            recorder_->frame(s.source, **frame, found ? &candidates : nullptr);
            told.clear();
            continue;
        }
        if (!frame && frame.error().code == ErrorCode::end_of_recording) break;
        if (!frame && !is_silence(frame.error())) failure = frame.error();
        // A failure is told once, not as often as it is met.
        if (failure && failure->what != told) {
            told = failure->what;
            note_text(*recorder_, s.source, CaptureEventKind::note, failure->sentence());
        }
        if (s.trigger_hz > 0 && failure && Clock::now() - fired_or_seen > kPatience) {
            const std::lock_guard lock(mutex_);
            if (!refusal_) refusal_ = std::move(failure);
            break;
        }
        if (failure) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    --live_;
}

std::optional<Error> RecordingSession::refusal() const {
    const std::lock_guard lock(mutex_);
    return refusal_;
}

void RecordingSession::listen(Robot r) {
    const auto period = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(1 / std::clamp(r.pose_hz, 0.1, 1000.0)));
    auto pose_due = Clock::now(), mode_due = pose_due;
    std::optional<RobotMode> mode;
    Text told;
    while (!stop_) {
        std::optional<Error> failure;
        if (Clock::now() >= mode_due) {
            mode_due = Clock::now() + std::chrono::seconds(1);
            auto now = r.robot->mode();
            if (!now) failure = now.error();
            if (now && mode != *now) {
                mode = *now;
                note_text(*recorder_, r.source, CaptureEventKind::mode, std::string(to_string(*now)));
            }
        }
        if (Clock::now() >= pose_due) {
            pose_due = Clock::now() + period;
            if (auto pose = r.robot->base_from_flange()) note_pose(*recorder_, r.source, *pose);
        }
        const auto before = Clock::now();
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(pose_due - before);
        if (auto trigger = r.robot->wait_trigger(std::clamp(left, std::chrono::milliseconds(1), kSlice)))
            note_trigger(*recorder_, r.source, *trigger);
        else
            std::this_thread::sleep_until(std::min(pose_due, before + kSlice));  // no measuring program runs
        if (failure && failure->what != told) {
            told = failure->what;
            note_text(*recorder_, r.source, CaptureEventKind::note, failure->sentence());
        }
    }
}

}  // namespace seamwright
