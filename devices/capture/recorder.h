#pragma once
// The recorder: what sensors and robots deliver, into a capture, at full rate.
//
// frame() packs the frame into the open block of its source (one copy, no allocation once the blocks are
// there) and returns: nobody waits for the disk. One thread writes what is full, and every `flush_ms` what is
// not, each time in one transaction. Memory is bounded: what waits for the disk never exceeds `queue_mib`; a
// frame that finds no room is dropped and counted. What was lost before (gaps of the sequence numbers) is
// counted apart.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "devices/capture/capture_file.h"
#include "devices/capture/profile_blob.h"
#include "devices/profile_source.h"
#include "devices/robot_link.h"

namespace seamwright {

struct RecorderOptions {
    bool images = false;            // raw pixels too; else profiles and candidates only
    bool compress = false;          // zlib level 1 for blocks, while the writer keeps up
    int queue_mib = 256;            // memory for what waits for the disk
    int flush_ms = 200;             // what a killed process loses at most, beside what waits for the disk
    std::uint64_t limit_bytes = 0;  // the recording fails there as on a full disk; 0 = none
};

struct RecorderStatus {
    std::map<std::string, CaptureCounters> sources;  // by name; `frames` are the committed ones
    std::uint64_t bytes = 0;                         // of blocks committed
    std::optional<Error> failure;                    // the disk; nothing is written after it
};

// Thread-safe.
class Recorder {
  public:
    static Expected<std::unique_ptr<Recorder>> create(const std::filesystem::path& path,
                                                      const RecorderOptions& options = {});
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;
    ~Recorder();  // finishes

    // The number that frame() and event() take.
    Expected<std::int64_t> add_sensor(const std::string& name, const SensorIdentity& identity);
    Expected<std::int64_t> add_robot(const std::string& name, const RobotIdentity& identity);

    // `candidates`: peaks in millimetres of a camera frame whose image is not kept.
    void frame(std::int64_t source, const Frame& frame, const ProfileCandidates* candidates = nullptr);
    void event(CaptureEvent event);

    RecorderStatus status() const;
    // Writes what waits and closes the file. Error: the disk failed; the file holds what was committed
    // before.
    Expected<RecorderStatus> finish(const std::string& how = "stopped");

  private:
    struct Pending {
        FrameBlock block;
        std::int64_t source = 0;
        std::int64_t first_host_ns = 0, last_host_ns = 0;
        std::vector<std::pair<int, std::string>> spots;  // index in the block
    };
    struct Source {
        std::mutex mutex;
        std::string name;
        std::unique_ptr<Pending> open;
        std::optional<std::uint64_t> last_sequence;
        std::uint64_t damaged = 0, lost = 0, dropped = 0;  // guarded by mutex
        std::uint64_t committed = 0, uncommitted = 0;      // frames written, and lost to a failed disk;
                                                           // guarded by Recorder::mutex_
    };
    Recorder(CaptureWriter writer, const RecorderOptions& options);
    Source* find(std::int64_t source) const;
    std::unique_ptr<Pending> take_block();
    void hand_over(Source& source);  // precondition: source locked
    void write_loop();
    void write_batch(std::deque<std::unique_ptr<Pending>> blocks, std::vector<CaptureEvent> events);

    const RecorderOptions options_;
    std::mutex file_mutex_;  // of writer_
    CaptureWriter writer_;
    mutable std::mutex mutex_;  // of what follows
    std::map<std::int64_t, std::unique_ptr<Source>> sources_;
    std::deque<std::unique_ptr<Pending>> full_;
    std::vector<std::unique_ptr<Pending>> free_;
    std::vector<CaptureEvent> events_;
    std::uint64_t bytes_written_ = 0;
    std::optional<Error> failure_;
    bool finishing_ = false, finished_ = false;
    std::condition_variable wake_;
    std::atomic<std::size_t> waiting_bytes_ = 0;
    std::thread thread_;
};

// Devices that record themselves while others use them as usual: a whole session (runs, teaching) is recorded
// by handing a Station these in place of its own.
std::unique_ptr<ProfileSource> record_sensor(std::unique_ptr<ProfileSource> sensor,
                                             std::shared_ptr<Recorder> recorder, std::int64_t source);
std::unique_ptr<RobotLink> record_robot(std::unique_ptr<RobotLink> robot, std::shared_ptr<Recorder> recorder,
                                        std::int64_t source);

// Records devices that nobody else uses: a thread each waits for the frames of a sensor, or asks a robot for
// its pose and mode and hears its triggers. The sensors are started, and stopped at the end.
class RecordingSession {
  public:
    struct Sensor {
        std::int64_t source = 0;
        ProfileSource* sensor = nullptr;  // must outlive the session
        // Candidates of a camera frame, computed on the sensor's thread; nullptr = none. False = no stripe.
        std::function<bool(const Frame&, ProfileCandidates&)> candidates;
        double trigger_hz = 0;  // software triggers; 0 = the sensor runs freely or is triggered by wire
    };
    struct Robot {
        std::int64_t source = 0;
        RobotLink* robot = nullptr;
        double pose_hz = 50;
    };
    // All or nothing: a sensor that does not start ends it.
    static Expected<std::unique_ptr<RecordingSession>> start(std::shared_ptr<Recorder> recorder,
                                                             std::vector<Sensor> sensors,
                                                             const std::vector<Robot>& robots);
    ~RecordingSession();  // stops
    // Ends within the devices' time-outs of 100 ms and a little.
    void stop();
    // False when every sensor has come to its end (a replayed recording).
    bool running() const { return live_ > 0; }
    // Of a sensor that has refused its software triggers for 2 s and has sent no frame meanwhile; it is given
    // up. A connection that is lost is no refusal: it may come back.
    std::optional<Error> refusal() const;
    std::uint64_t frames() const { return frames_; }  // that came from the sensors

  private:
    RecordingSession() = default;
    void pump(Sensor sensor);
    void listen(Robot robot);
    std::shared_ptr<Recorder> recorder_;
    std::vector<ProfileSource*> started_;
    std::vector<std::thread> threads_;
    std::atomic<bool> stop_ = false;
    std::atomic<int> live_ = 0;
    std::atomic<std::uint64_t> frames_ = 0;
    mutable std::mutex mutex_;  // what follows
    std::optional<Error> refusal_;
};

}  // namespace seamwright
