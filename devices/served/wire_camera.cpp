#include "devices/served/wire_camera.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <random>
#include <span>
#include <thread>

#include "devices/genicam/aravis_private.h"
#include "devices/genicam/pixels/pixel_format.h"
#include "devices/served/gige_server.h"
#include "served_camera_xml.h"

namespace seamwright {
namespace {

// Registers of ours, as in resources/camera/served-camera.xml.
constexpr std::uint32_t kTriggerMode = 0x400, kTriggerSource = 0x404, kTriggerSoftware = 0x408,
                        kRateEnable = 0x414, kRate = 0x418, kExposure = 0x420, kGain = 0x428,
                        kInvalidFlag = 0x444, kScale = 0x450, kOffset = 0x470, kInvalidValue = 0x490,
                        kScanType = 0x4a0, kTemperature = 0x4a8, kStatusSelector = 0x4b0,
                        kExposureMode = 0x4b8, kOutputMode = 0x4c8;
// Bootstrap registers of GigE Vision.
constexpr std::uint32_t kGevVersion = 0x0, kDeviceMode = 0x4, kVendorName = 0x48, kModelName = 0x68,
                        kVersion = 0x88, kInfo = 0xa8, kSerial = 0xd8, kCameraPrivilege = 0xa00,
                        kCameraPacketSize = 0xd04, kCameraStreamPort = 0xd00;

constexpr int kFreeAddresses = 50;  // tried

// The address, or the first ones of the loopback range in an order that differs from process to process.
std::vector<std::string> addresses_of(const std::string& address) {
    if (address != kFreeAddress) return {address};
    std::vector<std::string> list = {"127.0.0.1"};
    std::mt19937 random(std::random_device{}());
    std::uniform_int_distribution<int> byte(1, 254);
    while (list.size() < kFreeAddresses)
        list.push_back(fmt::format("127.{}.{}.{}", byte(random), byte(random), byte(random)));
    return list;
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
        text.replace(at, what.size(), with);
    return text;
}

// Aravis reads the description from a file while it makes the camera.
Expected<std::filesystem::path> write_description(const WireCameraSettings& settings) {
    std::string entries;
    for (const std::string& name : settings.pixel_formats) {
        const PixelFormat* format = pixel_format_by_name(name);
        if (!format)
            return input_error(Text("\"{}\" is no pixel format that can be served", name), "pixel_formats");
        entries +=
            fmt::format("<EnumEntry Name=\"{}\" NameSpace=\"Standard\"><Value>{}</Value></EnumEntry>\n",
                        format->name, format->code);
    }
    std::string text(resources::served_camera_xml);
    text = replaced(replaced(text, "@PIXEL_FORMATS@", entries), "@MODEL@", "StripeCamera");
    std::string name = (std::filesystem::temp_directory_path() / "seamwright-camera-XXXXXX").string();
    const int file = ::mkstemp(name.data());
    if (file < 0) return file_error("the camera's description cannot be written", name);
    std::size_t done = 0;
    while (done < text.size()) {
        const auto wrote = ::write(file, text.data() + done, text.size() - done);
        if (wrote <= 0) break;
        done += static_cast<std::size_t>(wrote);
    }
    ::close(file);
    if (done < text.size()) {
        ::unlink(name.c_str());
        return file_error("the camera's description cannot be written", name);
    }
    return std::filesystem::path(name);
}

}  // namespace

namespace {
std::uint16_t before_first(const WireCameraSettings& s) {
    return static_cast<std::uint16_t>(std::max<int>(s.first_frame_id, 1) - 1);
}
}  // namespace

struct WireCamera::Impl final : GigeMemory {
    WireCameraSettings settings;
    std::function<void()> software_trigger;
    mutable std::mutex registers_mutex;
    GPtr<ArvFakeCamera> registers;
    std::atomic<bool> ready = false;
    std::atomic<std::uint64_t> acquisitions = 0;
    struct Waiting {
        std::vector<std::byte> payload;
        std::int64_t device_ns = 0;
        std::chrono::steady_clock::time_point due;
    };
    mutable std::mutex mutex;
    std::condition_variable_any pushed;
    std::deque<Waiting> queue;
    WireFault fault = WireFault::none;
    int late_ms = 0;
    std::atomic<double> lost_per_mille = 0;
    std::atomic<std::uint64_t> sent = 0, dropped = 0, triggers = 0;
    std::uint16_t frame_id = 0;      // of the last frame sent; stream thread
    std::atomic<bool> anew = false;  // a stream was opened: its numbers begin
    std::mt19937 loss;               // stream thread
    std::unique_ptr<GigeServer> server;
    std::jthread stream;  // last

    std::uint32_t reg(std::uint32_t address) const {
        const std::lock_guard lock(registers_mutex);
        guint32 value = 0;
        arv_fake_camera_read_register(registers.get(), address, &value);
        return value;
    }
    void set_reg(std::uint32_t address, std::uint32_t value) {
        const std::lock_guard lock(registers_mutex);
        arv_fake_camera_write_register(registers.get(), address, value);
    }
    double read_double(std::uint32_t address) const {
        const std::lock_guard lock(registers_mutex);
        std::uint64_t raw = 0;
        arv_fake_camera_read_memory(registers.get(), address, sizeof raw, &raw);
        return std::bit_cast<double>(GUINT64_FROM_BE(raw));
    }
    void write_double(std::uint32_t address, double value) {
        const std::lock_guard lock(registers_mutex);
        const std::uint64_t raw = GUINT64_TO_BE(std::bit_cast<std::uint64_t>(value));
        arv_fake_camera_write_memory(registers.get(), address, sizeof raw, &raw);
    }
    void write_text(std::uint32_t address, std::size_t size, const std::string& text) {
        const std::lock_guard lock(registers_mutex);
        std::vector<char> field(size, '\0');
        std::memcpy(field.data(), text.data(), std::min(text.size(), size - 1));
        arv_fake_camera_write_memory(registers.get(), address, static_cast<guint32>(size), field.data());
    }
    std::size_t payload_size() const {
        const std::lock_guard lock(registers_mutex);
        return arv_fake_camera_get_payload(registers.get());
    }

    bool read(std::uint32_t address, std::span<std::byte> to) override {
        const std::lock_guard lock(registers_mutex);
        return arv_fake_camera_read_memory(registers.get(), address, static_cast<guint32>(to.size()),
                                           to.data());
    }
    bool write(std::uint32_t address, std::span<const std::byte> from) override;
    void acquire_when_ready();
    void wake_up();
    void run(const std::stop_token& stop);
    void send(const Waiting& frame, double loss_share, std::uint32_t moved_px);
};

bool WireCamera::Impl::write(std::uint32_t address, std::span<const std::byte> from) {
    const bool acquired = reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0;
    {
        const std::lock_guard lock(registers_mutex);
        if (!arv_fake_camera_write_memory(registers.get(), address, static_cast<guint32>(from.size()),
                                          from.data()))
            return false;
    }
    if (address <= kCameraStreamPort && kCameraStreamPort < address + from.size() &&
        (reg(kCameraStreamPort) & 0xFFFF) != 0)
        anew = true;
    if (reg(kCameraPrivilege) == 0)  // nobody is in control any more
        set_reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 0);
    // Who draws may not have seen that one has ended before the next begins: that takes no trigger until it has been armed.
    if (const bool acquires = reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0; acquires != acquired) {
        if (acquires)
            ++acquisitions;
        else
            ready = false;
    }
    if (reg(kTriggerSoftware) != 0) {
        set_reg(kTriggerSoftware, 0);
        if (reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0) {
            ++triggers;
            if (software_trigger) software_trigger();
        }
    }
    acquire_when_ready();
    return true;
}

// A trigger leads to a frame at once: told to the client by AcquisitionStatus.
void WireCamera::Impl::acquire_when_ready() {
    if (ready && reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) == 1)
        set_reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 2);
}

void WireCamera::Impl::wake_up() {
    const auto& s = settings;
    set_reg(kGevVersion, 0x00010002);  // 1.2: 16-bit frame numbers, 32-bit packet headers
    set_reg(kDeviceMode, 0x80000001);  // big-endian registers, texts in UTF-8
    write_text(kVendorName, 32, "Seamwright");
    write_text(kModelName, 32, s.model);
    write_text(kVersion, 32, "1");
    write_text(kInfo, 48, "simulated");
    write_text(kSerial, 16, s.serial);
    const auto width = static_cast<std::uint32_t>(s.width), height = static_cast<std::uint32_t>(s.height);
    set_reg(ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, width);
    set_reg(ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, height);
    set_reg(ARV_FAKE_CAMERA_REGISTER_WIDTH, width);
    set_reg(ARV_FAKE_CAMERA_REGISTER_HEIGHT, height);
    const PixelFormat* format = pixel_format_by_name(s.pixel_formats.front());
    set_reg(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, format->code);
    set_reg(ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE, 0);
    set_reg(kCameraPacketSize, static_cast<std::uint32_t>(s.packet_size));
    write_double(kRate, 50);
    set_reg(kRateEnable, 1);
    write_double(kExposure, s.exposure_us);
    write_double(kGain, s.gain_db);
    write_double(kTemperature, 35);
    set_reg(kStatusSelector, 1);
    set_reg(kExposureMode, 1);
    set_reg(kScanType, format->is_range() ? 1 : 0);
    set_reg(kOutputMode, format->coordinates.size() > 1 ? 1 : 0);
    set_reg(kInvalidFlag, s.invalid_flag ? 1 : 0);
    write_double(kInvalidValue, s.invalid_value);
    write_double(kScale, s.a_scale_mm);
    write_double(kOffset, s.a_offset_mm);
    write_double(kScale + 8, 1);
    write_double(kScale + 16, s.c_scale_mm);
    write_double(kOffset + 16, s.c_offset_mm);
}

void WireCamera::Impl::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::unique_lock lock(mutex);
        pushed.wait(lock, stop, [this] { return !queue.empty(); });
        if (queue.empty()) continue;
        // A late frame holds up those behind it.
        const auto due = queue.front().due;
        pushed.wait_until(lock, stop, due,
                          [&] { return queue.empty() || std::chrono::steady_clock::now() >= due; });
        if (stop.stop_requested() || queue.empty() || queue.front().due > std::chrono::steady_clock::now())
            continue;
        const Waiting frame = std::move(queue.front());
        queue.pop_front();
        if (frame.payload.size() != payload_size()) {  // the client has changed the region meanwhile
            ++dropped;
            continue;
        }
        const std::uint32_t moved = fault == WireFault::moved ? 1 : 0;
        double share = lost_per_mille / 1000;
        if (fault == WireFault::damaged) share = std::max(share, 0.3);
        if (fault == WireFault::lost) share = 1;
        if (fault != WireFault::late) fault = WireFault::none;
        lock.unlock();
        send(frame, share, moved);
        ++sent;
    }
}

void WireCamera::Impl::send(const Waiting& frame, double loss_share, std::uint32_t moved_px) {
    if (anew.exchange(false)) frame_id = before_first(settings);
    frame_id = frame_id == 65535 ? 1 : static_cast<std::uint16_t>(frame_id + 1);
    std::uniform_real_distribution<double> random(0, 1);
    server->send({.id = frame_id,
                  .device_ns = static_cast<std::uint64_t>(frame.device_ns),
                  .pixel_format = reg(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT),
                  .width = reg(ARV_FAKE_CAMERA_REGISTER_WIDTH),
                  .height = reg(ARV_FAKE_CAMERA_REGISTER_HEIGHT),
                  .x = reg(ARV_FAKE_CAMERA_REGISTER_X_OFFSET),
                  .y = reg(ARV_FAKE_CAMERA_REGISTER_Y_OFFSET) + moved_px,
                  .payload = frame.payload},
                 [&] { return random(loss) < loss_share; });
}

WireCamera::WireCamera(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Expected<std::unique_ptr<WireCamera>> WireCamera::open(const WireCameraSettings& settings,
                                                       std::function<void()> software_trigger) {
    const Text where("served camera {}", settings.address);
    if (settings.serial.empty() || settings.serial.size() > 15)
        return input_error("the serial number must have 1 to 15 signs", "serial");
    if (settings.width < 1 || settings.height < 1 || settings.width > 16384 || settings.height > 16384)
        return input_error("width and height must be 1 to 16384 px", where);
    if (settings.packet_size < 576 || settings.packet_size > 16376)
        return input_error("must be 576 to 16376 bytes", "packet_size");
    if (!(settings.lost_packets_per_mille >= 0 && settings.lost_packets_per_mille <= 1000))
        return input_error("must be 0 to 1000", "lost_packets_per_mille");
    if (settings.pixel_formats.empty()) return input_error("one pixel format at least", "pixel_formats");
    SEAM_TRY(auto description, write_description(settings));
    auto impl = std::make_unique<Impl>();
    Impl* i = impl.get();
    i->settings = settings;
    i->software_trigger = std::move(software_trigger);
    i->lost_per_mille = settings.lost_packets_per_mille;
    i->loss.seed(settings.loss_seed);
    i->frame_id = before_first(settings);
    i->registers.reset(arv_fake_camera_new_full(settings.serial.c_str(), description.c_str()));
    std::error_code ignored;
    std::filesystem::remove(description, ignored);
    i->wake_up();
    for (const std::string& address : addresses_of(settings.address)) {
        auto server = GigeServer::open(address, *i);
        if (!server) continue;
        i->settings.address = address;
        i->server = std::move(*server);
        GPtr<GInetAddress> own(g_inet_address_new_from_string(address.c_str()));
        const std::lock_guard lock(i->registers_mutex);
        arv_fake_camera_set_inet_address(i->registers.get(), own.get());
        break;
    }
    if (!i->server)
        return device_error(
            "no camera can be served: port 3956 of the address is taken or the address is not "
            "this host's",
            where, "stop the other camera, or give another address of 127.0.0.0/8");
    i->stream = std::jthread([i](const std::stop_token& stop) { i->run(stop); });
    return std::unique_ptr<WireCamera>(new WireCamera(std::move(impl)));
}

WireCamera::~WireCamera() = default;

WireState WireCamera::state() const {
    const Impl& i = *impl_;
    WireState s;
    s.acquiring = i.reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0 && i.reg(kCameraPrivilege) != 0;
    s.acquisition = i.acquisitions;
    s.x = static_cast<int>(i.reg(ARV_FAKE_CAMERA_REGISTER_X_OFFSET));
    s.y = static_cast<int>(i.reg(ARV_FAKE_CAMERA_REGISTER_Y_OFFSET));
    s.width = static_cast<int>(i.reg(ARV_FAKE_CAMERA_REGISTER_WIDTH));
    s.height = static_cast<int>(i.reg(ARV_FAKE_CAMERA_REGISTER_HEIGHT));
    s.pixel_format = i.reg(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT);
    s.exposure_us = i.read_double(kExposure);
    s.gain_db = i.read_double(kGain);
    s.trigger = i.reg(kTriggerMode) == 0     ? WireTrigger::free
                : i.reg(kTriggerSource) == 0 ? WireTrigger::software
                                             : WireTrigger::line;
    s.frame_rate_hz = i.reg(kRateEnable) ? i.read_double(kRate) : 0;
    return s;
}

void WireCamera::set_ready(bool ready) {
    impl_->ready = ready;
    if (ready) return impl_->acquire_when_ready();
    const std::lock_guard lock(impl_->mutex);
    impl_->queue.clear();
}

bool WireCamera::push(std::vector<std::byte> payload, std::int64_t device_ns, std::uint64_t acquisition) {
    Impl& i = *impl_;
    auto due = std::chrono::steady_clock::now();
    {
        const std::lock_guard lock(i.mutex);
        if (i.queue.size() >= i.settings.queue || payload.size() != i.payload_size() ||
            i.reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) == 0 ||
            (acquisition != 0 && acquisition != i.acquisitions)) {
            ++i.dropped;
            return false;
        }
        if (i.fault == WireFault::late) {
            due += std::chrono::milliseconds(i.late_ms);
            i.fault = WireFault::none;
        }
        i.queue.push_back({std::move(payload), device_ns, due});
    }
    i.pushed.notify_all();
    return true;
}

void WireCamera::fail_next(WireFault fault, int late_ms) {
    const std::lock_guard lock(impl_->mutex);
    impl_->fault = fault;
    impl_->late_ms = late_ms;
}

void WireCamera::set_lost_packets(double per_mille) {
    impl_->lost_per_mille = std::clamp(per_mille, 0.0, 1000.0);
}

WireCounters WireCamera::counters() const {
    return {impl_->sent, impl_->dropped, impl_->triggers};
}

std::string WireCamera::address() const {
    return impl_->settings.address;
}

}  // namespace seamwright
