#pragma once
// A recorded capture, played back. Opened by the drivers "replay" when their settings name a file instead of
// a folder; settings: capture_sensor_settings(), capture_robot_settings().
// Sensors and robot of one session play one file: "speed", "loop" must be the same for all.
//
// Frames come back as recorded, bit for bit: status, sequence with its gaps, spot, pose, device time, damaged
// ones included. The arrival (host_time_ns) is that of the replay, so that what is measured does not look
// old; "recorded_host_time" keeps the recorded one. A camera frame that was recorded without its image comes
// back as a profile of the strongest candidate of each line.
//
// Speed: the first call that waits starts the clock of all devices of the file; each frame and trigger comes
// when its recorded arrival has passed on that clock, never earlier, and none is dropped by one who asks
// late. "step": a frame only after trigger(), whatever the time. A software trigger for a spot delivers the
// next frame that was taken for it. The robot hands out its recorded triggers in order; after
// start_measuring() it fires the given spots instead, each with the frame recorded for it. Its pose is the
// newest one recorded until now.

#include <chrono>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "devices/capture/capture_file.h"
#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/profile_source.h"
#include "devices/robot_link.h"

namespace seamwright {

// What the devices of one capture share. Thread-safe.
class CaptureReplay {
  public:
    using Clock = std::chrono::steady_clock;
    CaptureReplay(CaptureReader reader, double speed, bool loop);

    std::string where() const { return where_; }
    double speed() const { return speed_; }
    bool loop() const { return loop_; }

    Expected<CaptureSource> source(const std::string& name, SourceKind kind) const;

    // A sensor's side. A source is open for one sensor at a time; one that is opened again goes on where it
    // was.
    Expected<void> open_sensor(const CaptureSource& source, std::uint64_t from, bool step);
    void close_sensor(std::int64_t source);
    Expected<void> trigger(std::int64_t source, const std::string& spot_id);
    // Fills `frame` (nullopt), or says when to ask again; time_point::max() while nothing is due before a
    // trigger. Error: the end, or a damaged block.
    Expected<std::optional<Clock::time_point>> next(std::int64_t source, Frame& frame);

    // The robot's side.
    Expected<void> open_robot(const CaptureSource& source);
    void close_robot();
    Expected<void> start_moves(const std::vector<std::string>& spot_ids);
    // The next trigger, or when to ask again.
    Expected<std::optional<Clock::time_point>> next_trigger(TriggerEvent& trigger);
    std::optional<Pose> pose();
    RobotMode mode();

  private:
    struct Player {
        std::uint64_t count = 0, cursor = 0;
        bool open = true, step = false, driven = false;
        int loops = 0;
        std::deque<std::uint64_t> due;
        std::map<std::string, std::vector<std::uint64_t>> of_spot;
        std::map<std::string, std::size_t> played;
    };
    // All with the mutex held.
    Expected<void> start_clock();
    Clock::time_point when(std::int64_t host_time_ns, int loops) const;
    std::int64_t position_ns() const;
    Expected<std::uint64_t> take(Player& player, const std::string& spot_id);
    Expected<void> deliver(std::int64_t source, std::uint64_t number, Frame& frame);

    const std::string where_;
    const double speed_;
    const bool loop_;
    mutable std::mutex mutex_;
    CaptureReader reader_;
    std::map<std::int64_t, Player> players_;
    std::optional<Clock::time_point> started_;
    std::int64_t first_ns_ = 0, newest_ns_ = 0;
    std::vector<CaptureEvent> triggers_, poses_, modes_;
    std::map<std::string, std::size_t> fired_;  // triggers_ of a spot, during measuring
    std::size_t next_trigger_ = 0;
    bool robot_open_ = false, measuring_ = false;
    std::deque<std::string> moves_;
};

const SettingTable& capture_sensor_settings();
const SettingTable& capture_robot_settings();
Expected<std::unique_ptr<ProfileSource>> open_capture_sensor(const nlohmann::json& settings,
                                                             DeviceSession& session);
Expected<std::unique_ptr<RobotLink>> open_capture_robot(const nlohmann::json& settings,
                                                        DeviceSession& session);

}  // namespace seamwright
