#pragma once
// The driver's source. For the .cpp files of this folder only: what a station calls is genicam_source.cpp, the camera that
// comes and goes genicam_connection.cpp, its acquisition genicam_stream.cpp, buffers made frames genicam_frames.cpp.

#include <chrono>
#include <condition_variable>
#include <deque>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "devices/backoff.h"
#include "devices/genicam/camera_features.h"
#include "devices/genicam/frame_order.h"
#include "devices/genicam/genicam.h"
#include "devices/silence.h"

namespace seamwright {

// Takes leave of a camera. Aravis' heartbeat thread holds the device while it tells that the control is lost;
// were its hold the last one, the thread would join itself, which ends the program. So the last is ours.
void release_camera(ArvCamera* camera);

struct StreamStatistics {
    std::uint64_t underrun = 0, missing = 0, resent = 0;
};
StreamStatistics stream_statistics(ArvStream* stream);

// Aravis learns a frame's number from its first packet; without that the buffer keeps this one.
inline constexpr std::uint64_t kNoNumber = ~std::uint64_t{0};

// Two locks. `control_` guards camera, stream and delivery; it is held through GVCP calls but never while
// waiting for a frame. `arrivals_` guards what the stream thread tells; taken last, never held over a call of
// Aravis.
class GenicamSource final : public ProfileSource {
  public:
    explicit GenicamSource(GenicamSettings settings) : settings_(std::move(settings)) {}
    ~GenicamSource() override;
    Expected<void> open();

    SensorIdentity identity() const override {
        const std::lock_guard lock(control_);
        return identity_;
    }
    Expected<void> start() override;
    void stop() override;
    Expected<void> trigger(const std::string& spot_id) override;
    Expected<FramePtr> wait_next(std::chrono::milliseconds timeout) override;
    FramePtr latest() const override {
        const std::lock_guard lock(arrivals_);
        return latest_;
    }
    SourceCounters counters() const override;
    Expected<void> answers() override;  // as its heartbeats tell: nothing is waited for
    std::vector<ParameterInfo> parameters() const override;
    Expected<double> get(const std::string& parameter) const override;
    Expected<void> set(const std::string& parameter, double value) override;

  private:
    // What the stream thread holds of us; outlives us when a dead stream is taken down in the background.
    struct Context {
        std::mutex mutex;
        GenicamSource* source = nullptr;
    };
    struct Arrival {
        ArvBuffer* buffer = nullptr;
        bool numbered = false;
        std::uint64_t sequence = 0;
        std::uint64_t lost_before = 0;  // of this acquisition, whose first it is
        std::int64_t host_ns = 0;
        TriggerPairing::Answer answer;
    };
    static void on_stream(void* context, ArvStreamCallbackType type, ArvBuffer* buffer);
    static void on_control_lost(ArvDevice*, gpointer self) { static_cast<GenicamSource*>(self)->lose(); }
    void arrived(ArvBuffer* buffer);
    void lose();
    bool is_lost() const {
        const std::lock_guard lock(arrivals_);
        return lost_;
    }
    void watch();

    Expected<void> connect();                                  // control_ held
    Expected<void> reconnect(std::chrono::milliseconds most);  // control_ held
    void bury();                                               // control_ held: drops a camera that is gone
    Expected<void> start_stream();                             // control_ held
    void stop_stream();                                        // control_ held
    Expected<void> take_format();                              // control_ held
    Expected<void> wait_until_armed();                         // control_ held
    Expected<void> open_stream(guint payload);                 // control_ held
    void take_statistics();                                    // control_ held
    void count_gap(const Arrival& arrival);
    FramePtr convert(ArvBuffer* buffer, const Arrival& arrival);
    FramePtr next_row();
    FramePtr lost_frame(std::uint64_t sequence);
    bool as_armed(ArvBuffer* buffer) const;
    bool tells_lost_first() const {
        return trigger_ != "software" && trigger_ != "free" && (!range_ || armed_.height == 1);
    }
    void give_back(ArvBuffer* buffer) {
        arv_buffer_set_frame_id(buffer, kNoNumber);
        arv_stream_push_buffer(stream_.get(), buffer);
    }
    void fill_payload(ArvBuffer* buffer, Frame& frame);
    Error gone() const {
        return {ErrorKind::device, Text("{}: the camera is gone", kDisconnected), settings_.camera_name(),
                "check its power and cable; it is connected again by itself", ErrorCode::disconnected};
    }
    Error not_started() const {
        return {ErrorKind::device, "the sensor is not started", settings_.camera_name(), ""};
    }
    void publish(const FramePtr& frame) {
        const std::lock_guard lock(arrivals_);
        latest_ = frame;
    }

    const GenicamSettings settings_;
    mutable std::mutex control_;
    GPtr<ArvCamera> camera_;
    GPtr<ArvStream> stream_;
    std::shared_ptr<Context> context_;
    GPtr<ArvChunkParser> chunks_;
    SensorIdentity identity_;
    std::string address_;
    std::string trigger_;                    // as set
    std::map<std::string, double> changed_;  // by set(), to be restored
    bool running_ = false, range_ = false;
    ImageField armed_;
    RangeMapping mapping_;
    std::unique_ptr<FramePool> pool_;
    std::size_t pool_size_ = 0;
    ArvBuffer* rows_ = nullptr;  // the image whose rows are being delivered
    Arrival rows_arrival_;
    int next_row_ = 0;
    std::optional<std::uint64_t> last_sequence_;
    std::uint64_t unnumbered_ = 0;  // frames without a number since the last gap
    SourceCounters counters_;
    StreamStatistics before_;  // of streams that are over
    Backoff back_off_{settings_.reconnect, settings_.reconnect_most};
    int attempts_ = 0;
    std::vector<std::future<void>> burials_;

    mutable std::mutex arrivals_;
    std::condition_variable something_;
    std::deque<Arrival> done_;
    FrameCounter counter_;
    TriggerPairing pairing_;
    FramePtr latest_;
    bool lost_ = false, connected_ = false, ending_ = false, stopped_ = true;
    std::string watched_;  // address that is asked
    std::thread watcher_;
};

}  // namespace seamwright
