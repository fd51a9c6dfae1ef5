// The acquisition: its stream, the buffers that come of it, its statistics.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "core/number_text.h"
#include "devices/genicam/genicam_source.h"
#include "devices/host_time.h"

namespace seamwright {
namespace {

// For a camera to wait for triggers, at least; and where its status may be another.
constexpr std::chrono::milliseconds kArming{3000}, kStatusUnknown{300};

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

}  // namespace

StreamStatistics stream_statistics(ArvStream* stream) {
    guint64 completed = 0, failed = 0, underrun = 0, resent = 0, missing = 0;
    arv_stream_get_statistics(stream, &completed, &failed, &underrun);
    if (ARV_IS_GV_STREAM(stream)) arv_gv_stream_get_statistics(ARV_GV_STREAM(stream), &resent, &missing);
    return {underrun, missing, resent};
}

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
        a.sequence = counter_.unnumbered();
        a.numbered = arv_buffer_get_frame_id(buffer) != kNoNumber;
        if (a.numbered && status != ARV_BUFFER_STATUS_ABORTED && status != ARV_BUFFER_STATUS_CLEARED) {
            const bool first = counter_.fresh();
            a.sequence = counter_.sequence(arv_buffer_get_frame_id(buffer));
            if (first) a.lost_before = counter_.lost_at_start();
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

Expected<void> GenicamSource::take_format() {
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
    SEAM_OK(check_field(camera_.get(), settings_, changed_));
    arv_camera_get_region(camera_.get(), &armed_.x, &armed_.y, &armed_.width, &armed_.height, g.out());
    if (g)
        return device_error(Text("the region of its images cannot be read ({})", g.text()),
                            settings_.camera_name());
    mapping_.first_column = armed_.x;
    // Rows are small and many.
    const auto handed_out = static_cast<std::size_t>(settings_.buffers) * (range_ ? 32 : 1);
    if (handed_out != pool_size_) pool_ = std::make_unique<FramePool>(pool_size_ = handed_out);
    return {};
}

Expected<void> GenicamSource::open_stream(guint payload) {
    GFailure g;
    context_ = std::make_shared<Context>();
    context_->source = this;
    stream_.reset(arv_camera_create_stream_full(
        camera_.get(), &GenicamSource::on_stream, new std::shared_ptr<Context>(context_),
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
    return {};
}

Expected<void> GenicamSource::start_stream() {
    SEAM_OK(take_format());
    GFailure g;
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
        counter_.restart(gige);
        pairing_.restart();
        stopped_ = false;
    }
    SEAM_OK(open_stream(payload));
    for (int i = 0; i < settings_.buffers; ++i) give_back(arv_buffer_new_allocate(payload));
    arv_camera_start_acquisition(camera, g.out());
    if (g) {
        const std::string why = g.text();
        stop_stream();
        return device_error(Text("the acquisition cannot be started ({})", why), settings_.camera_name());
    }
    if (auto armed = wait_until_armed(); !armed) {
        stop_stream();
        return armed;
    }
    return {};
}

// Where the camera tells, triggers are not sent before it waits for them. A status that says something else than that
// is waited for, but nothing is concluded from it.
Expected<void> GenicamSource::wait_until_armed() {
    GFailure g;
    ArvCamera* camera = camera_.get();
    if (!arv_camera_is_feature_available(camera, "AcquisitionStatus", g.out())) return {};
    const char* selected = arv_camera_is_feature_available(camera, "AcquisitionStatusSelector", g.out())
                               ? arv_camera_get_string(camera, "AcquisitionStatusSelector", g.out())
                               : nullptr;
    const bool tells = !g && selected && std::string(selected) == "FrameTriggerWait" && trigger_ != "free";
    const auto most = std::max(settings_.timeout, kArming);
    const auto begun = std::chrono::steady_clock::now();
    for (;;) {
        if (arv_camera_get_boolean(camera, "AcquisitionStatus", g.out()) || g) return {};
        if (is_lost()) return tl::unexpected(gone());
        const auto waited = std::chrono::steady_clock::now() - begun;
        if (waited > (tells ? most : kStatusUnknown)) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (!tells) return {};
    return device_error(ErrorCode::not_ready, Text("it does not arm within {} ms", most.count()),
                        settings_.camera_name(), "check its trigger settings, or raise timeout_ms");
}

void GenicamSource::take_statistics() {
    if (!stream_) return;
    const StreamStatistics s = stream_statistics(stream_.get());
    before_.underrun += s.underrun;
    before_.missing += s.missing;
    before_.resent += s.resent;
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

}  // namespace seamwright
