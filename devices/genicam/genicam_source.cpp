#include "devices/genicam/genicam_source.h"

#include <algorithm>

#include "devices/host_time.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

}  // namespace

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
    release_camera(camera_.release());
}

Expected<void> GenicamSource::start() {
    const std::lock_guard lock(control_);
    if (running_) return {};
    {
        const std::lock_guard arrivals(arrivals_);
        if (!lost_) stopped_ = false;
        if (lost_ && !camera_) lost_ = false;
    }
    if (is_lost()) bury();
    if (camera_) {
        auto done = start_stream();
        if (done) {
            running_ = true;
            return {};
        }
        if (done.error().code == ErrorCode::not_ready) return done;  // it answers
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
            if (is_lost()) {
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
                    Arrival& next = done_.front();
                    if (next.lost_before > unnumbered_ && tells_lost_first())
                        return lost_frame(next.sequence - next.lost_before--);
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

SourceCounters GenicamSource::counters() const {
    const std::lock_guard lock(control_);
    SourceCounters c = counters_;
    const StreamStatistics now = stream_ ? stream_statistics(stream_.get()) : StreamStatistics{};
    c.underrun += before_.underrun + now.underrun;
    c.missing_packets = before_.missing + now.missing;
    c.resent_packets = before_.resent + now.resent;
    return c;
}

Expected<void> GenicamSource::answers() {
    const std::lock_guard lock(control_);
    if (!camera_ || is_lost()) return tl::unexpected(gone());
    return {};
}

std::vector<ParameterInfo> GenicamSource::parameters() const {
    const std::lock_guard lock(control_);
    return camera_ && !is_lost() ? read_parameters(camera_.get()).list : std::vector<ParameterInfo>{};
}

Expected<double> GenicamSource::get(const std::string& parameter) const {
    const std::lock_guard lock(control_);
    if (!camera_ || is_lost()) return tl::unexpected(gone());
    return get_parameter(camera_.get(), parameter);
}

Expected<void> GenicamSource::set(const std::string& parameter, double value) {
    const std::lock_guard lock(control_);
    if (is_lost()) {
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
        for (const ParameterInfo& info : read_parameters(camera_.get()).list)
            if (info.name == parameter) trigger_ = info.choices[static_cast<std::size_t>(info.default_value)];
    if (restart) SEAM_OK(start_stream());
    return done;
}

Expected<std::unique_ptr<ProfileSource>> open_genicam_sensor(const nlohmann::json& settings, DeviceSession&) {
    SEAM_TRY(auto parsed, parse_genicam_settings(settings));
    auto source = std::make_unique<GenicamSource>(std::move(parsed));
    SEAM_OK(source->open());
    return source;
}

}  // namespace seamwright
