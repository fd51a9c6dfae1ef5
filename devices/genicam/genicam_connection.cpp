// A camera that comes, goes, and comes again.

#include <algorithm>

#include "devices/genicam/genicam_source.h"
#include "devices/genicam/gvcp.h"

namespace seamwright {
namespace {

using std::chrono::milliseconds;
constexpr int kMisses = 3;                   // unanswered heartbeats that make a camera gone
constexpr milliseconds kHeartbeatWait{300};  // for one of them

}  // namespace

void release_camera(ArvCamera* camera) {
    if (!camera) return;
    GPtr<ArvDevice> device(static_cast<ArvDevice*>(g_object_ref(arv_camera_get_device(camera))));
    g_object_unref(camera);
    for (int i = 0; i < 1000 && g_atomic_int_get(&G_OBJECT(device.get())->ref_count) > 1; ++i)
        std::this_thread::sleep_for(milliseconds(10));
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

Expected<void> GenicamSource::connect() {
    GenicamSettings where = settings_;
    // Where it was before; after some attempts wherever it may be.
    if (where.address.empty() && !address_.empty() && attempts_ < kMisses) where.address = address_;
    if (where.serial.empty()) where.serial = identity_.serial;
    SEAM_TRY(auto camera, open_camera(where));
    const SensorIdentity identity = identity_of(camera.get());
    SEAM_OK(apply_settings(camera.get(), settings_));
    for (const auto& [name, value] : changed_) SEAM_OK(set_parameter(camera.get(), name, value));
    SEAM_OK(check_field(camera.get(), settings_, changed_));
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
            release_camera(camera);
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

}  // namespace seamwright
