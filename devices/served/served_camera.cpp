#include "devices/served/served_camera.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <thread>

#include "devices/exchange/json_fields.h"
#include "devices/genicam/pixels/pixel_format.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<std::string> formats_of(int bit_depth) {
    if (bit_depth == 10) return {"Mono8", "Mono10", "Mono10p", "Mono10Packed", "Mono16"};
    if (bit_depth == 12) return {"Mono8", "Mono12", "Mono12p", "Mono12Packed", "Mono16"};
    if (bit_depth == 16) return {"Mono8", "Mono16"};
    return {"Mono8"};
}

// The region of the cell's image in the wire's format.
std::vector<std::byte> payload_of(const StripeImage& image, const WireState& state,
                                  const PixelFormat& format) {
    const auto w = static_cast<std::size_t>(state.width), h = static_cast<std::size_t>(state.height);
    std::vector<std::byte> grey(w * h * (format.bit_depth > 8 ? 2 : 1));
    const int shift = format.bit_depth - image.bit_depth;
    for (std::size_t y = 0; y < h; ++y) {
        const std::byte* from = image.pixels + (y + static_cast<std::size_t>(state.y)) * image.row_bytes +
                                static_cast<std::size_t>(state.x * image.bytes_per_pixel());
        if (shift == 0) {
            const std::size_t row = w * static_cast<std::size_t>(image.bytes_per_pixel());
            std::memcpy(grey.data() + y * row, from, row);
            continue;
        }
        for (std::size_t x = 0; x < w; ++x) {
            std::uint16_t value = 0;
            std::memcpy(&value, from + x * static_cast<std::size_t>(image.bytes_per_pixel()),
                        static_cast<std::size_t>(image.bytes_per_pixel()));
            value = static_cast<std::uint16_t>(shift > 0 ? value << shift : value >> -shift);
            if (format.bit_depth > 8)
                std::memcpy(grey.data() + 2 * (y * w + x), &value, 2);
            else
                grey[y * w + x] = static_cast<std::byte>(value);
        }
    }
    if (format.packing == Packing::bytes || format.packing == Packing::words) return grey;
    std::vector<std::byte> packed(image_bytes(format, state.width, state.height));
    pack_pixels(format, grey.data(), w * h, packed.data());
    return packed;
}

}  // namespace

struct ServedCamera::Impl {
    std::shared_ptr<SimulatedCell> cell;
    std::string serial;
    std::unique_ptr<WireCamera> wire;
    std::mutex mutex;
    std::function<void(const Served&)> watcher;
    std::atomic<bool> stopping = false;
    std::thread drawing;
    Frame frame;

    void expose() {
        // A camera exposes whatever stands before it, even before the robot's first move.
        if (!cell->true_flange()) cell->move_to(cell->flange_for(Pose::Identity()));
        (void)cell->software_trigger("");  // refuses when not armed: then nobody acquires
    }
    void draw();
    void deliver(const SimulatedCell::Waiting& exposure, const WireState& state);
};

void ServedCamera::Impl::deliver(const SimulatedCell::Waiting& exposure, const WireState& state) {
    const PixelFormat* format = pixel_format_by_code(state.pixel_format);
    const auto& optics = cell->settings().optics;
    if (!format || format->is_range() || !format->colour.empty() || state.width < 1 || state.height < 1 ||
        state.x < 0 || state.y < 0 || state.x + state.width > optics.width ||
        state.y + state.height > optics.height)
        return;  // registers that make no image: a client wrote past the description's bounds
    frame.status = FrameStatus::ok;
    cell->render(exposure.base_from_flange, exposure.number, frame, nullptr, exposure.sensor_from_drifted);
    std::vector<std::byte> payload = payload_of(frame.image, state, *format);
    {
        const std::lock_guard lock(mutex);
        if (watcher) watcher({exposure.number, exposure.spot_id, exposure.time_ns, &payload});
    }
    if (frame.status != FrameStatus::ok)
        wire->fail_next(WireFault::damaged);  // the cell's damaged_probability
    wire->push(std::move(payload), exposure.time_ns, state.acquisition);
}

void ServedCamera::Impl::draw() {
    bool armed = false;
    std::uint64_t acquisition = 0;
    double exposure_us = cell->parameter("exposure_us"), gain_db = cell->parameter("gain_db");
    auto next_free = Clock::now();
    while (!stopping) {
        const WireState state = wire->state();
        if (state.acquiring != armed || state.acquisition != acquisition) {
            armed = state.acquiring;
            acquisition = state.acquisition;
            cell->arm(armed);
            wire->set_ready(armed);
            next_free = Clock::now();
        }
        // Only what a client changed: the cell's own side may set it too.
        if (state.exposure_us != exposure_us && state.exposure_us >= 1 && state.exposure_us <= 1e6)
            cell->set_parameter("exposure_us", exposure_us = state.exposure_us);
        if (state.gain_db != gain_db && state.gain_db >= 0 && state.gain_db <= 48)
            cell->set_parameter("gain_db", gain_db = state.gain_db);
        if (armed && state.trigger == WireTrigger::free && Clock::now() >= next_free) {
            const double rate = std::clamp(
                state.frame_rate_hz > 0 ? state.frame_rate_hz : 1e6 / state.exposure_us, 0.1, 2000.0);
            next_free =
                std::max(next_free + std::chrono::nanoseconds(std::llround(1e9 / rate)), Clock::now());
            expose();
        }
        const auto exposure = armed ? cell->take_exposure() : std::nullopt;
        if (!exposure) {
            std::this_thread::sleep_for(armed ? std::chrono::microseconds(200)
                                              : std::chrono::microseconds(500));
            continue;
        }
        // The robot's trigger counts on its line only, a command or the camera's own clock never there.
        const bool from_robot = !exposure->spot_id.empty();
        if (from_robot == (state.trigger == WireTrigger::line)) deliver(*exposure, state);
    }
    if (armed) cell->arm(false);
}

ServedCamera::ServedCamera(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Expected<std::unique_ptr<ServedCamera>> ServedCamera::open(std::shared_ptr<SimulatedCell> cell,
                                                           const nlohmann::json& settings) {
    const std::string where = "settings";
    if (auto known = only_fields(
            settings,
            {"address", "serial", "packet_size", "lost_packets_per_mille", "loss_seed", "first_frame_id"},
            where);
        !known)
        return tl::unexpected(known.error());
    WireCameraSettings s;
    SEAM_TRY(const auto address, json_string_or(settings, "address", s.address, where));
    SEAM_TRY(const auto serial, json_string_or(settings, "serial", cell->settings().serial, where));
    s.address = address;
    s.serial = serial;
    const auto number = [&](const char* key, double otherwise, double low, double high) -> Expected<double> {
        auto value = json_number_or(settings, key, otherwise, where);
        if (value && !(*value >= low && *value <= high))
            return input_error("is out of range", json_path(where, key));
        return value;
    };
    SEAM_TRY(const auto packet, number("packet_size", s.packet_size, 576, 16376));
    SEAM_TRY(const auto lost, number("lost_packets_per_mille", 0, 0, 1000));
    SEAM_TRY(const auto seed, number("loss_seed", 1, 0, 4294967295.0));
    SEAM_TRY(const auto first, number("first_frame_id", 1, 1, 65535));
    s.packet_size = static_cast<int>(packet) / 4 * 4;
    s.lost_packets_per_mille = lost;
    s.loss_seed = static_cast<std::uint32_t>(seed);
    s.first_frame_id = static_cast<std::uint16_t>(first);
    const auto& optics = cell->settings().optics;
    s.width = optics.width;
    s.height = optics.height;
    s.pixel_formats = formats_of(optics.bit_depth);
    s.exposure_us = cell->parameter("exposure_us");
    s.gain_db = cell->parameter("gain_db");
    auto impl = std::make_unique<Impl>();
    impl->cell = std::move(cell);
    impl->serial = s.serial;
    SEAM_TRY(auto wire, WireCamera::open(s, [i = impl.get()] { i->expose(); }));
    impl->wire = std::move(wire);
    impl->drawing = std::thread([i = impl.get()] { i->draw(); });
    return std::unique_ptr<ServedCamera>(new ServedCamera(std::move(impl)));
}

ServedCamera::~ServedCamera() {
    impl_->stopping = true;
    impl_->drawing.join();
    impl_->wire.reset();
}

WireCamera& ServedCamera::wire() {
    return *impl_->wire;
}
std::string ServedCamera::address() const {
    return impl_->wire->address();
}
std::string ServedCamera::serial() const {
    return impl_->serial;
}
void ServedCamera::watch(std::function<void(const Served&)> watcher) {
    const std::lock_guard lock(impl_->mutex);
    impl_->watcher = std::move(watcher);
}

}  // namespace seamwright
