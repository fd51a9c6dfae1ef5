#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <future>
#include <mutex>
#include <thread>

#include "core/number_text.h"
#include "devices/backoff.h"
#include "devices/genicam/camera_features.h"
#include "devices/genicam/frame_order.h"
#include "devices/genicam/genicam.h"
#include "devices/genicam/gvcp.h"
#include "devices/host_time.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

// Aravis sets the size of its socket's buffer when the first frame has begun, and a first frame that comes in
// one burst does not fit in the kernel's default. The socket is found by its port; where it is not, Aravis'
// way remains.
void widen_receive_buffer(guint16 port, int bytes) {
    std::error_code failed;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", failed)) {
        const int fd = number_from<int>(entry.path().filename().string()).value_or(-1);
        int type = 0;
        sockaddr_in bound{};
        socklen_t size = sizeof type, length = sizeof bound;
        if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_DGRAM) continue;
        if (getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &length) != 0 || bound.sin_family != AF_INET)
            continue;
        if (ntohs(bound.sin_port) == port) setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    }
}

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// Takes leave of a camera. Aravis' heartbeat thread holds the device while it tells that the control is lost;
// were its hold the last one, the thread would join itself, which ends the program. So the last is ours.
void release(ArvCamera* camera) {
    if (!camera) return;
    GPtr<ArvDevice> device(static_cast<ArvDevice*>(g_object_ref(arv_camera_get_device(camera))));
    g_object_unref(camera);
    for (int i = 0; i < 1000 && g_atomic_int_get(&G_OBJECT(device.get())->ref_count) > 1; ++i)
        std::this_thread::sleep_for(milliseconds(10));
}

// Aravis learns a frame's number from its first packet; without that the buffer keeps this one.
constexpr std::uint64_t kNoNumber = ~std::uint64_t{0};
constexpr int kMisses = 3;                   // unanswered heartbeats that make a camera gone
constexpr milliseconds kHeartbeatWait{300};  // for one of them

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
    Expected<FramePtr> wait_next(milliseconds timeout) override;
    FramePtr latest() const override {
        const std::lock_guard lock(arrivals_);
        return latest_;
    }
    SourceCounters counters() const override;
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
        std::int64_t host_ns = 0;
        TriggerPairing::Answer answer;
    };
    static void on_stream(void* context, ArvStreamCallbackType type, ArvBuffer* buffer);
    static void on_control_lost(ArvDevice*, gpointer self) { static_cast<GenicamSource*>(self)->lose(); }
    void arrived(ArvBuffer* buffer);
    void lose();
    void watch();

    Expected<void> connect();                     // control_ held
    Expected<void> reconnect(milliseconds most);  // control_ held
    void bury();                                  // control_ held: drops a camera that is gone
    Expected<void> start_stream();                // control_ held
    void stop_stream();                           // control_ held
    void take_statistics();                       // control_ held
    void count_gap(const Arrival& arrival);
    FramePtr convert(ArvBuffer* buffer, const Arrival& arrival);
    FramePtr next_row();
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
    RangeMapping mapping_;
    std::unique_ptr<FramePool> pool_;
    std::size_t pool_size_ = 0;
    ArvBuffer* rows_ = nullptr;  // the image whose rows are being delivered
    Arrival rows_arrival_;
    int next_row_ = 0;
    std::optional<std::uint64_t> last_sequence_;
    std::uint64_t unnumbered_ = 0;  // frames without a number since the last gap
    SourceCounters counters_;
    std::uint64_t before_underrun_ = 0, before_missing_ = 0, before_resent_ = 0;  // of streams that are over
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

void GenicamSource::on_stream(void* raw, ArvStreamCallbackType type, ArvBuffer* buffer) {
    auto& context = *static_cast<std::shared_ptr<Context>*>(raw);
    if (type == ARV_STREAM_CALLBACK_TYPE_INIT) {
        // A receiver that comes late loses packets. Where the system forbids it, it stays as it is.
        ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), -10);
    } else if (type == ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE && buffer) {
        const std::lock_guard lock(context->mutex);
        if (context->source) context->source->arrived(buffer);
    }
}

void GenicamSource::arrived(ArvBuffer* buffer) {
    const ArvBufferStatus status = arv_buffer_get_status(buffer);
    {
        const std::lock_guard lock(arrivals_);
        Arrival a;
        a.buffer = buffer;
        a.host_ns = host_now_ns();
        a.numbered = arv_buffer_get_frame_id(buffer) != kNoNumber;
        if (a.numbered && status != ARV_BUFFER_STATUS_ABORTED && status != ARV_BUFFER_STATUS_CLEARED) {
            a.sequence = counter_.sequence(arv_buffer_get_frame_id(buffer));
            // Of a damaged frame the packet with the time may be the one that got lost.
            const bool whole = status == ARV_BUFFER_STATUS_SUCCESS;
            a.answer = pairing_.arrived(
                a.sequence, whole ? static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer)) : 0,
                a.host_ns);
        }
        done_.push_back(std::move(a));
    }
    something_.notify_all();
}

void GenicamSource::lose() {
    {
        const std::lock_guard lock(arrivals_);
        if (!connected_) return;
        lost_ = true;
    }
    something_.notify_all();
}

// Aravis notices a silent camera after several seconds only.
void GenicamSource::watch() {
    int misses = 0;
    std::unique_lock lock(arrivals_);
    while (!ending_) {
        something_.wait_for(lock, settings_.heartbeat, [this] { return ending_; });
        if (ending_ || !connected_ || lost_ || watched_.empty()) {
            misses = 0;
            continue;
        }
        const std::string address = watched_;
        lock.unlock();
        const auto answer = ask_camera(address, kHeartbeatWait);
        lock.lock();
        misses = answer ? 0 : misses + 1;
        if (misses < kMisses || !connected_ || watched_ != address) continue;
        misses = 0;
        lost_ = true;
        something_.notify_all();
    }
}

Expected<void> GenicamSource::open() {
    const std::lock_guard lock(control_);
    trigger_ = settings_.trigger;
    SEAM_OK(connect());
    if (settings_.heartbeat.count() > 0) watcher_ = std::thread([this] { watch(); });
    return {};
}

GenicamSource::~GenicamSource() {
    stop();
    {
        const std::lock_guard lock(arrivals_);
        ending_ = true;
        connected_ = false;
    }
    something_.notify_all();
    if (watcher_.joinable()) watcher_.join();
    if (camera_) g_signal_handlers_disconnect_by_data(arv_camera_get_device(camera_.get()), this);
    chunks_.reset();
    release(camera_.release());
}

Expected<void> GenicamSource::connect() {
    GenicamSettings where = settings_;
    // Where it was before; after some attempts wherever it may be.
    if (where.address.empty() && !address_.empty() && attempts_ < kMisses) where.address = address_;
    if (where.serial.empty()) where.serial = identity_.serial;
    SEAM_TRY(auto camera, open_camera(where));
    const SensorIdentity identity = identity_of(camera.get());
    SEAM_OK(apply_settings(camera.get(), settings_));
    for (const auto& [name, value] : changed_) SEAM_OK(set_parameter(camera.get(), name, value));
    camera_ = std::move(camera);
    identity_ = identity;
    address_ = address_of(camera_.get());
    chunks_.reset(settings_.chunks.empty() ? nullptr : arv_camera_create_chunk_parser(camera_.get()));
    g_signal_connect(arv_camera_get_device(camera_.get()), "control-lost", G_CALLBACK(on_control_lost), this);
    {
        const std::lock_guard lock(arrivals_);
        lost_ = false;
        connected_ = true;
        watched_ = address_;
    }
    attempts_ = 0;
    back_off_.worked();
    return {};
}

void GenicamSource::bury() {
    if (!camera_) return;
    {
        const std::lock_guard lock(arrivals_);
        connected_ = false;
        lost_ = false;
    }
    g_signal_handlers_disconnect_by_data(arv_camera_get_device(camera_.get()), this);
    take_statistics();
    if (context_) {
        const std::lock_guard lock(context_->mutex);
        context_->source = nullptr;
    }
    if (rows_) g_object_unref(rows_);
    rows_ = nullptr;
    {
        const std::lock_guard lock(arrivals_);
        done_.clear();
        pairing_.restart();
    }
    // Taking leave of a camera that does not answer takes Aravis seconds.
    std::erase_if(burials_, [](auto& b) { return b.wait_for(milliseconds(0)) == std::future_status::ready; });
    burials_.push_back(
        std::async(std::launch::async, [camera = camera_.release(), stream = stream_.release()] {
            if (stream) g_object_unref(stream);
            release(camera);
        }));
    chunks_.reset();
    back_off_.try_now();
}

Expected<void> GenicamSource::reconnect(milliseconds most) {
    const auto attempt = [&]() -> Expected<void> {
        ++attempts_;
        // Nobody there is found out quickly; opening would wait for every register.
        if (const auto there = address_.empty() ? Expected<DiscoveredCamera>()
                                                : ask_camera(address_, std::min(most, kHeartbeatWait));
            !there && (!settings_.address.empty() || attempts_ < kMisses))
            return tl::unexpected(there.error());
        auto done = connect();
        if (done && running_) done = start_stream();
        if (!done && camera_) bury();
        return done;
    };
    const auto done = back_off_.attempt(attempt);
    if (!done)
        return device_error(ErrorCode::silence, Text("{}: the camera is gone", kNoAnswer),
                            settings_.camera_name(),
                            "check its power and cable; it is connected again by itself");
    if (*done) ++counters_.reconnects;
    return *done;
}

Expected<void> GenicamSource::start_stream() {
    GFailure g;
    const char* name = arv_camera_get_pixel_format_as_string(camera_.get(), g.out());
    const PixelFormat* format = name ? pixel_format_by_name(name) : nullptr;
    if (!format)
        return device_error(Text("its pixel format \"{}\" cannot be read", name ? name : "?"),
                            settings_.camera_name(), "set pixel_format");
    range_ = format->is_range() || settings_.range;
    if (settings_.range) {
        mapping_ = *settings_.range;
    } else if (range_) {
        SEAM_TRY(auto mapping, range_mapping(camera_.get()));
        mapping_ = mapping;
    }
    gint x = 0, y = 0, width = 0, height = 0;
    arv_camera_get_region(camera_.get(), &x, &y, &width, &height, g.out());
    mapping_.first_column = x;
    // Rows are small and many.
    const auto handed_out = static_cast<std::size_t>(settings_.buffers) * (range_ ? 32 : 1);
    if (handed_out != pool_size_) pool_ = std::make_unique<FramePool>(pool_size_ = handed_out);

    ArvCamera* camera = camera_.get();
    const bool gige = arv_camera_is_gv_device(camera);
    const bool loopback = address_.starts_with("127.");
    if (gige) {
        arv_camera_gv_set_stream_options(camera, settings_.packet_socket && !loopback
                                                     ? ARV_GV_STREAM_OPTION_NONE
                                                     : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
        arv_camera_gv_set_packet_size_adjustment(camera, settings_.packet_size == 0 && !loopback
                                                             ? ARV_GV_PACKET_SIZE_ADJUSTMENT_ON_FAILURE_ONCE
                                                             : ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    }
    const guint payload = arv_camera_get_payload(camera, g.out());
    if (g || payload == 0 || payload > (1U << 30))
        return device_error(Text("the size of its images cannot be read ({})", g.text()),
                            settings_.camera_name());
    {
        const std::lock_guard lock(arrivals_);
        done_.clear();
        counter_.restart();
        pairing_.restart();
        stopped_ = false;
    }
    context_ = std::make_shared<Context>();
    context_->source = this;
    stream_.reset(arv_camera_create_stream_full(
        camera, &GenicamSource::on_stream, new std::shared_ptr<Context>(context_),
        [](gpointer c) { delete static_cast<std::shared_ptr<Context>*>(c); }, g.out()));
    if (!stream_)
        return device_error(Text("no stream can be opened ({})", g.text()), settings_.camera_name());
    if (ARV_IS_GV_STREAM(stream_.get())) {
        const std::size_t automatic =
            std::clamp<std::size_t>(std::size_t{payload} * 8, std::size_t{1} << 20, std::size_t{32} << 20);
        const auto bytes = static_cast<gint>(settings_.socket_buffer ? settings_.socket_buffer : automatic);
        g_object_set(
            stream_.get(), "packet-resend",
            settings_.packet_resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER,
            "packet-timeout", static_cast<guint>(settings_.packet_timeout.count() * 1000), "frame-retention",
            static_cast<guint>(settings_.frame_retention.count() * 1000), "socket-buffer",
            ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", bytes, nullptr);
        widen_receive_buffer(arv_gv_stream_get_port(ARV_GV_STREAM(stream_.get())), bytes);
    }
    for (int i = 0; i < settings_.buffers; ++i) give_back(arv_buffer_new_allocate(payload));
    arv_camera_start_acquisition(camera, g.out());
    if (g) {
        const std::string why = g.text();
        stop_stream();
        return device_error(Text("the acquisition cannot be started ({})", why), settings_.camera_name());
    }
    // Where the camera tells, triggers are not sent before it waits for them.
    if (arv_camera_is_feature_available(camera, "AcquisitionStatus", g.out())) {
        for (int i = 0; i < 300; ++i) {
            if (arv_camera_get_boolean(camera, "AcquisitionStatus", g.out()) || g) break;
            std::this_thread::sleep_for(milliseconds(1));
        }
    }
    return {};
}

void GenicamSource::take_statistics() {
    if (!stream_) return;
    guint64 completed = 0, failed = 0, underrun = 0, resent = 0, missing = 0;
    arv_stream_get_statistics(stream_.get(), &completed, &failed, &underrun);
    if (ARV_IS_GV_STREAM(stream_.get()))
        arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
    before_underrun_ += underrun;
    before_missing_ += missing;
    before_resent_ += resent;
}

void GenicamSource::stop_stream() {
    if (!stream_) return;
    GFailure g;
    arv_camera_stop_acquisition(camera_.get(), g.out());
    take_statistics();
    if (rows_) g_object_unref(rows_);
    rows_ = nullptr;
    stream_.reset();  // joins the stream thread: no frame of this acquisition can come any more
    {
        const std::lock_guard lock(context_->mutex);
        context_->source = nullptr;
    }
    const std::lock_guard lock(arrivals_);
    done_.clear();
    pairing_.restart();
}

Expected<void> GenicamSource::start() {
    const std::lock_guard lock(control_);
    if (running_) return {};
    {
        const std::lock_guard arrivals(arrivals_);
        if (!lost_) stopped_ = false;
        if (lost_ && !camera_) lost_ = false;
    }
    bool lost = false;
    {
        const std::lock_guard arrivals(arrivals_);
        lost = lost_;
    }
    if (lost) bury();
    if (camera_) {
        if (auto done = start_stream(); done) {
            running_ = true;
            return {};
        }
        bury();  // it may have been switched off and on since, which no heartbeat has told yet
    }
    // A part waits: whatever attempts failed before, now is the next.
    // The camera may still hold our own lost connection for a moment.
    for (const auto until = Clock::now() + settings_.timeout;;) {
        back_off_.try_now();
        auto done = reconnect(settings_.timeout);
        if (done) break;
        if (!is_in_use(done.error()) || Clock::now() >= until) return done;
        std::this_thread::sleep_for(milliseconds(50));
    }
    SEAM_OK(start_stream());
    running_ = true;
    return {};
}

void GenicamSource::stop() {
    const std::lock_guard lock(control_);
    running_ = false;
    bool lost = false;
    {
        const std::lock_guard arrivals(arrivals_);
        stopped_ = true;
        lost = lost_;
    }
    something_.notify_all();
    if (lost)
        bury();
    else if (camera_)
        stop_stream();
}

Expected<void> GenicamSource::trigger(const std::string& spot_id) {
    std::unique_lock control(control_);
    if (!running_) return tl::unexpected(not_started());
    if (trigger_ != "software")
        return device_error(Text("it is not triggered by software but by \"{}\"", trigger_),
                            settings_.camera_name(), "set trigger to \"software\"");
    const auto until = Clock::now() + settings_.timeout;
    for (;;) {
        std::unique_lock arrivals(arrivals_);
        if (lost_) {
            arrivals.unlock();
            bury();
            return tl::unexpected(gone());
        }
        if (!camera_) {
            arrivals.unlock();
            SEAM_OK(reconnect(settings_.timeout));
            continue;
        }
        pairing_.expire(host_now_ns() - std::chrono::nanoseconds(settings_.timeout).count());
        if (pairing_.lost_track()) {
            arrivals.unlock();
            stop_stream();
            SEAM_OK(start_stream());
            continue;
        }
        if (pairing_.ready()) break;
        if (Clock::now() >= until)
            return device_error(ErrorCode::silence,
                                Text("{}: the trigger before this one has no frame yet", kNoAnswer),
                                settings_.camera_name());
        control.unlock();  // frames are delivered meanwhile
        something_.wait_for(arrivals, milliseconds(20));
        arrivals.unlock();
        control.lock();
        if (!running_) return tl::unexpected(not_started());
    }
    {
        const std::lock_guard arrivals(arrivals_);
        pairing_.begin(spot_id, host_now_ns());
    }
    GFailure g;
    arv_camera_software_trigger(camera_.get(), g.out());
    const std::lock_guard arrivals(arrivals_);
    if (g) {
        pairing_.cancel();
        return device_error(Text("the trigger was refused ({})", g.text()), settings_.camera_name());
    }
    pairing_.sent(host_now_ns());
    return {};
}

Expected<FramePtr> GenicamSource::wait_next(milliseconds timeout) {
    const auto until = Clock::now() + timeout;
    for (;;) {
        {
            const std::lock_guard control(control_);
            if (!running_) return tl::unexpected(not_started());
            bool lost = false;
            {
                const std::lock_guard arrivals(arrivals_);
                lost = lost_;
            }
            if (lost) {
                bury();
                return tl::unexpected(gone());
            }
            if (!camera_) {
                const auto left = std::chrono::duration_cast<milliseconds>(until - Clock::now());
                if (auto done = reconnect(std::max(left, milliseconds(1))); !done && Clock::now() >= until)
                    return tl::unexpected(done.error());
            }
            while (camera_) {
                if (rows_) {
                    if (FramePtr frame = next_row()) return frame;
                    continue;
                }
                Arrival arrival;
                {
                    const std::lock_guard arrivals(arrivals_);
                    if (done_.empty()) break;
                    arrival = std::move(done_.front());
                    done_.pop_front();
                }
                // The callback comes a moment before or after the buffer itself.
                ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_.get(), 200000);
                if (!buffer) break;
                if (FramePtr frame = convert(buffer, arrival)) return frame;
            }
        }
        std::unique_lock arrivals(arrivals_);
        if (Clock::now() >= until) {
            pairing_.expire(host_now_ns() - std::chrono::nanoseconds(settings_.timeout).count());
            return device_error(ErrorCode::silence,
                                Text("{}: no frame within {} ms", kNoAnswer, timeout.count()),
                                settings_.camera_name(), "let the robot measure or trigger the sensor");
        }
        // Without a camera nothing arrives: look again when the next attempt is due.
        const auto wake = connected_ ? until : std::min(until, Clock::now() + milliseconds(20));
        something_.wait_until(arrivals, wake, [this] { return !done_.empty() || lost_ || stopped_; });
        if (stopped_ && done_.empty()) return tl::unexpected(not_started());
    }
}

void GenicamSource::fill_payload(ArvBuffer* buffer, Frame& frame) {
    gint px = 0, py = 0;
    size_t size = 0;
    const void* data = arv_buffer_get_image_data(buffer, &size);
    const PixelFormat* format = pixel_format_by_code(arv_buffer_get_image_pixel_format(buffer));
    arv_buffer_get_image_padding(buffer, &px, &py);
    if (!data || !format || px < 0) {
        frame.status = FrameStatus::corrupt;
        return;
    }
    auto image = unpack_image(*format, {static_cast<const std::byte*>(data), size},
                              arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer),
                              static_cast<std::size_t>(px), frame.pixels, settings_.channel);
    if (image)
        frame.image = *image;
    else
        frame.status = FrameStatus::corrupt;
}

// A frame without its number is one of those that the next number shows to be missing.
void GenicamSource::count_gap(const Arrival& arrival) {
    if (!arrival.numbered) {
        ++unnumbered_;
        return;
    }
    if (last_sequence_ && arrival.sequence > *last_sequence_ + 1) {
        const std::uint64_t gap = arrival.sequence - *last_sequence_ - 1, known = std::min(gap, unnumbered_);
        counters_.lost += gap - known;
        unnumbered_ -= known;
    } else if (last_sequence_ && arrival.sequence < *last_sequence_ && counters_.lost > 0) {
        --counters_.lost;  // it comes after all
    }
    if (!last_sequence_ || arrival.sequence > *last_sequence_) last_sequence_ = arrival.sequence;
}

// Takes the buffer. nullptr: nothing to deliver, or its rows follow.
FramePtr GenicamSource::convert(ArvBuffer* buffer, const Arrival& arrival) {
    const ArvBufferStatus status = arv_buffer_get_status(buffer);
    if (status == ARV_BUFFER_STATUS_ABORTED || status == ARV_BUFFER_STATUS_CLEARED) {
        give_back(buffer);
        return nullptr;
    }
    count_gap(arrival);
    const bool whole = status == ARV_BUFFER_STATUS_SUCCESS && arrival.buffer == buffer;
    if (range_ && whole && arrival.answer.verdict != TriggerPairing::Verdict::late) {
        rows_ = buffer;
        rows_arrival_ = arrival;
        next_row_ = 0;
        return nullptr;
    }
    FramePtr frame = pool_->acquire();
    if (!frame) {
        ++counters_.underrun;
        give_back(buffer);
        return nullptr;
    }
    frame->sequence = arrival.numbered ? arrival.sequence : last_sequence_.value_or(0);
    frame->host_time_ns = arrival.host_ns;
    if (arrival.answer.verdict == TriggerPairing::Verdict::late) {
        frame->status = FrameStatus::late;
        ++counters_.late;
    } else {
        frame->spot_id = arrival.answer.spot_id;
        if (whole) {
            frame->device_time_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
            if (chunks_ && arv_buffer_has_chunks(buffer)) {
                GFailure g;
                const gint64 ticks =
                    arv_chunk_parser_get_integer_value(chunks_.get(), buffer, "ChunkTimestamp", g.out());
                if (!g) frame->device_time_ns = ticks;
            }
            fill_payload(buffer, *frame);
        } else {
            const bool packets =
                status == ARV_BUFFER_STATUS_MISSING_PACKETS || status == ARV_BUFFER_STATUS_TIMEOUT;
            frame->status = packets ? FrameStatus::incomplete : FrameStatus::corrupt;
        }
        ++(frame->status == FrameStatus::ok ? counters_.completed : counters_.damaged);
    }
    give_back(buffer);
    publish(frame);
    return frame;
}

FramePtr GenicamSource::next_row() {
    const gint width = arv_buffer_get_image_width(rows_), height = arv_buffer_get_image_height(rows_);
    const PixelFormat* format = pixel_format_by_code(arv_buffer_get_image_pixel_format(rows_));
    const int row = next_row_++;
    FramePtr frame = height > 0 && row < height ? pool_->acquire() : nullptr;
    if (frame) {
        gint px = 0, py = 0;
        size_t size = 0;
        const void* data = arv_buffer_get_image_data(rows_, &size);
        arv_buffer_get_image_padding(rows_, &px, &py);
        const auto done =
            format && data
                ? range_row(*format, {static_cast<const std::byte*>(data), size}, width, height, row,
                            static_cast<std::size_t>(std::max(px, 0)), mapping_, frame->profile)
                : Expected<void>(device_error("no image", ""));
        if (!done) {
            frame->status = FrameStatus::corrupt;
            frame->profile.clear();
        }
        frame->sequence =
            rows_arrival_.sequence * static_cast<std::uint64_t>(height) + static_cast<std::uint64_t>(row);
        frame->host_time_ns = rows_arrival_.host_ns;
        frame->device_time_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(rows_));
        frame->spot_id = rows_arrival_.answer.spot_id;
        ++(done ? counters_.completed : counters_.damaged);
        publish(frame);
    } else if (row < height) {
        ++counters_.underrun;
    }
    if (row + 1 >= height) {
        give_back(rows_);
        rows_ = nullptr;
    }
    return frame;
}

SourceCounters GenicamSource::counters() const {
    const std::lock_guard lock(control_);
    SourceCounters c = counters_;
    guint64 completed = 0, failed = 0, underrun = 0, resent = 0, missing = 0;
    if (stream_) {
        arv_stream_get_statistics(stream_.get(), &completed, &failed, &underrun);
        if (ARV_IS_GV_STREAM(stream_.get()))
            arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
    }
    c.underrun += before_underrun_ + underrun;
    c.missing_packets = before_missing_ + missing;
    c.resent_packets = before_resent_ + resent;
    return c;
}

std::vector<ParameterInfo> GenicamSource::parameters() const {
    const std::lock_guard lock(control_);
    return camera_ ? read_parameters(camera_.get()) : std::vector<ParameterInfo>{};
}

Expected<double> GenicamSource::get(const std::string& parameter) const {
    const std::lock_guard lock(control_);
    if (!camera_) return tl::unexpected(gone());
    return get_parameter(camera_.get(), parameter);
}

Expected<void> GenicamSource::set(const std::string& parameter, double value) {
    const std::lock_guard lock(control_);
    bool lost = false;
    {
        const std::lock_guard arrivals(arrivals_);
        lost = lost_;
    }
    if (lost) {
        bury();
        return tl::unexpected(gone());
    }
    if (!camera_) SEAM_OK(reconnect(settings_.timeout));
    const bool restart = running_ && (changes_stream(parameter) || parameter == "trigger");
    if (restart) stop_stream();
    auto done = set_parameter(camera_.get(), parameter, value);
    if (done) {
        changed_[parameter] = value;
        const std::lock_guard arrivals(arrivals_);
        pairing_.forget_clock();
    }
    if (done && parameter == "trigger")
        for (const ParameterInfo& info : read_parameters(camera_.get()))
            if (info.name == parameter) trigger_ = info.choices[static_cast<std::size_t>(info.default_value)];
    if (restart) SEAM_OK(start_stream());
    return done;
}

}  // namespace

Expected<std::unique_ptr<ProfileSource>> open_genicam_sensor(const nlohmann::json& settings, DeviceSession&) {
    SEAM_TRY(auto parsed, parse_genicam_settings(settings));
    auto source = std::make_unique<GenicamSource>(std::move(parsed));
    SEAM_OK(source->open());
    return source;
}

}  // namespace seamwright
