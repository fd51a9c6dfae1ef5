#include "devices/genicam/wire_camera.h"

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
#include <thread>

#include "devices/genicam/aravis_private.h"
#include "devices/genicam/gvcp.h"
#include "devices/genicam/pixel_format.h"
#include "devices/net/socket.h"
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
                        kVersion = 0x88, kInfo = 0xa8, kSerial = 0xd8, kPacketSize = 0xd04;

constexpr auto kWait = std::chrono::milliseconds(1);  // of the wire thread for a frame

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
            return input_error("\"" + name + "\" is no pixel format that can be served", "pixel_formats");
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

struct WireCamera::Impl {
    WireCameraSettings settings;
    std::function<void()> software_trigger;
    GPtr<ArvGvFakeCamera> camera;
    ArvGvFakeCamera* wire = nullptr;  // the same; the wire thread draws until the camera has gone
    ArvFakeCamera* registers = nullptr;
    std::atomic<bool> ready = false;
    struct Waiting {
        std::vector<std::byte> payload;
        std::int64_t device_ns = 0;
        std::chrono::steady_clock::time_point due;
    };
    mutable std::mutex mutex;
    std::mutex ending;
    std::condition_variable pushed;
    std::deque<Waiting> queue;
    WireFault fault = WireFault::none;
    int late_ms = 0;
    std::atomic<double> lost_per_mille = 0;
    std::atomic<std::uint64_t> sent = 0, dropped = 0, triggers = 0;
    std::atomic<bool> stopping = false;
    std::uint16_t frame_id = 0;  // of the last frame sent; wire thread

    std::uint32_t read(std::uint32_t address) const {
        guint32 value = 0;
        arv_fake_camera_read_register(registers, address, &value);
        return value;
    }
    void write(std::uint32_t address, std::uint32_t value) {
        arv_fake_camera_write_register(registers, address, value);
    }
    double read_double(std::uint32_t address) const {
        std::uint64_t raw = 0, again = 0;  // the wire thread may be writing: twice the same is whole
        for (int i = 0; i < 10; ++i) {
            arv_fake_camera_read_memory(registers, address, sizeof raw, &raw);
            arv_fake_camera_read_memory(registers, address, sizeof again, &again);
            if (raw == again) break;
        }
        return std::bit_cast<double>(GUINT64_FROM_BE(raw));
    }
    void write_double(std::uint32_t address, double value) {
        const std::uint64_t raw = GUINT64_TO_BE(std::bit_cast<std::uint64_t>(value));
        arv_fake_camera_write_memory(registers, address, sizeof raw, &raw);
    }
    void write_text(std::uint32_t address, std::size_t size, const std::string& text) {
        std::vector<char> field(size, '\0');
        std::memcpy(field.data(), text.data(), std::min(text.size(), size - 1));
        arv_fake_camera_write_memory(registers, address, static_cast<guint32>(size), field.data());
    }
    void wake_up();
    void fill(ArvBuffer* buffer);
    static void draw(ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat) {
        static_cast<Impl*>(self)->fill(buffer);
    }
};

void WireCamera::Impl::wake_up() {
    const auto& s = settings;
    write(kGevVersion, 0x00010002);  // 1.2: 16-bit frame numbers, 32-bit packet headers
    write(kDeviceMode, 0x80000001);  // big-endian registers, texts in UTF-8
    write_text(kVendorName, 32, "Seamwright");
    write_text(kModelName, 32, s.model);
    write_text(kVersion, 32, "1");
    write_text(kInfo, 48, "simulated");
    write_text(kSerial, 16, s.serial);
    const auto width = static_cast<std::uint32_t>(s.width), height = static_cast<std::uint32_t>(s.height);
    write(ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, width);
    write(ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, height);
    write(ARV_FAKE_CAMERA_REGISTER_WIDTH, width);
    write(ARV_FAKE_CAMERA_REGISTER_HEIGHT, height);
    const PixelFormat* format = pixel_format_by_name(s.pixel_formats.front());
    write(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, format->code);
    write(ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE, 0);
    write(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, 1);
    write(kPacketSize, static_cast<std::uint32_t>(s.packet_size));
    write_double(kRate, 50);
    write(kRateEnable, 1);
    write_double(kExposure, s.exposure_us);
    write_double(kGain, s.gain_db);
    write_double(kTemperature, 35);
    write(kStatusSelector, 1);
    write(kExposureMode, 1);
    write(kScanType, format->is_range() ? 1 : 0);
    write(kOutputMode, format->coordinates.size() > 1 ? 1 : 0);
    write(kInvalidFlag, s.invalid_flag ? 1 : 0);
    write_double(kInvalidValue, s.invalid_value);
    write_double(kScale, s.a_scale_mm);
    write_double(kOffset, s.a_offset_mm);
    write_double(kScale + 8, 1);
    write_double(kScale + 16, s.c_scale_mm);
    write_double(kOffset + 16, s.c_offset_mm);
}

// On the wire thread, once a round while acquiring.
void WireCamera::Impl::fill(ArvBuffer* buffer) {
    if (stopping) return;
    if (read(kTriggerSoftware) != 0) {
        write(kTriggerSoftware, 0);
        ++triggers;
        if (software_trigger) software_trigger();
    }
    // From the first round on a trigger leads to a frame at once: told to the client by AcquisitionStatus.
    if (ready && read(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) == 1)
        write(ARV_FAKE_CAMERA_REGISTER_ACQUISITION, 2);
    double loss = 1;
    {
        std::unique_lock lock(mutex);
        pushed.wait_for(lock, kWait, [this] { return stopping || !queue.empty(); });
        const auto now = std::chrono::steady_clock::now();
        // A late frame holds up those behind it for short spans only: the wire thread must go on answering.
        if (!queue.empty() && queue.front().due > now)
            pushed.wait_for(lock, kWait, [this] { return stopping.load(); });
        if (!queue.empty() && queue.front().due <= std::chrono::steady_clock::now()) {
            const Waiting frame = std::move(queue.front());
            queue.pop_front();
            const bool fits = frame.payload.size() == arv_fake_camera_get_payload(registers);
            if (fits) {
                size_t unused = 0;
                auto* to = static_cast<std::byte*>(const_cast<void*>(arv_buffer_get_data(buffer, &unused)));
                std::memcpy(to, frame.payload.data(), frame.payload.size());
                arv_buffer_set_timestamp(buffer, static_cast<guint64>(frame.device_ns));
                frame_id = frame_id == 65535 ? 1 : static_cast<std::uint16_t>(frame_id + 1);
                loss = lost_per_mille / 1000;
                if (fault == WireFault::damaged) loss = std::max(loss, 0.3);
                if (fault == WireFault::lost) loss = 1;
                if (fault == WireFault::damaged || fault == WireFault::lost) fault = WireFault::none;
                ++sent;
            } else {
                ++dropped;
            }
        }
    }
    arv_buffer_set_frame_id(buffer, frame_id);
    const std::lock_guard lock(ending);
    if (!stopping) g_object_set(wire, "gvsp-lost-ratio", loss, nullptr);
}

WireCamera::WireCamera(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Expected<std::unique_ptr<WireCamera>> WireCamera::open(const WireCameraSettings& settings,
                                                       std::function<void()> software_trigger) {
    const std::string where = "served camera " + settings.address;
    if (settings.serial.empty() || settings.serial.size() > 15)
        return input_error("the serial number must have 1 to 15 signs", "serial");
    if (settings.width < 1 || settings.height < 1 || settings.width > 16384 || settings.height > 16384)
        return input_error("width and height must be 1 to 16384 px", where);
    if (settings.packet_size < 576 || settings.packet_size > 16376)
        return input_error("must be 576 to 16376 bytes", "packet_size");
    if (!(settings.lost_packets_per_mille >= 0 && settings.lost_packets_per_mille <= 1000))
        return input_error("must be 0 to 1000", "lost_packets_per_mille");
    if (settings.pixel_formats.empty()) return input_error("one pixel format at least", "pixel_formats");
    // Aravis takes no notice of a port that it cannot have.
    if (auto port = UdpSocket::bind(settings.address, kGvcpPort); !port) {
        return device_error(
            "no camera can be served: port 3956 of the address is taken or the address is not "
            "this host's",
            where, "stop the other camera, or give 127.0.0.1");
    }
    auto description = write_description(settings);
    if (!description) return tl::unexpected(description.error());
    auto impl = std::make_unique<Impl>();
    impl->settings = settings;
    impl->software_trigger = std::move(software_trigger);
    impl->lost_per_mille = settings.lost_packets_per_mille;
    impl->frame_id = static_cast<std::uint16_t>(std::max<int>(settings.first_frame_id, 1) - 1);
    impl->camera.reset(
        arv_gv_fake_camera_new_full(settings.address.c_str(), settings.serial.c_str(), description->c_str()));
    std::error_code ignored;
    std::filesystem::remove(*description, ignored);
    if (!impl->camera || !arv_gv_fake_camera_is_running(impl->camera.get())) {
        return device_error("no camera can be served: the address has no network interface of its own", where,
                            "give 127.0.0.1");
    }
    impl->wire = impl->camera.get();
    impl->registers = arv_gv_fake_camera_get_fake_camera(impl->camera.get());
    g_random_set_seed(settings.loss_seed);
    impl->wake_up();
    arv_fake_camera_set_fill_pattern(impl->registers, &Impl::draw, impl.get());
    return std::unique_ptr<WireCamera>(new WireCamera(std::move(impl)));
}

WireCamera::~WireCamera() {
    {
        // The wire thread draws until the camera's end has joined it: it must touch the object no more by
        // then.
        const std::lock_guard lock(impl_->ending);
        impl_->stopping = true;
        g_object_set(impl_->wire, "gvsp-lost-ratio", 1.0, nullptr);
    }
    impl_->pushed.notify_all();
    impl_->camera.reset();  // joins the wire thread
}

WireState WireCamera::state() const {
    const Impl& i = *impl_;
    WireState s;
    s.acquiring = i.read(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0 &&
                  arv_fake_camera_get_control_channel_privilege(i.registers) != 0;
    s.x = static_cast<int>(i.read(ARV_FAKE_CAMERA_REGISTER_X_OFFSET));
    s.y = static_cast<int>(i.read(ARV_FAKE_CAMERA_REGISTER_Y_OFFSET));
    s.width = static_cast<int>(i.read(ARV_FAKE_CAMERA_REGISTER_WIDTH));
    s.height = static_cast<int>(i.read(ARV_FAKE_CAMERA_REGISTER_HEIGHT));
    s.pixel_format = i.read(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT);
    s.exposure_us = i.read_double(kExposure);
    s.gain_db = i.read_double(kGain);
    s.trigger = i.read(kTriggerMode) == 0     ? WireTrigger::free
                : i.read(kTriggerSource) == 0 ? WireTrigger::software
                                              : WireTrigger::line;
    s.frame_rate_hz = i.read(kRateEnable) ? i.read_double(kRate) : 0;
    return s;
}

void WireCamera::set_ready(bool ready) {
    impl_->ready = ready;
    if (ready) return;
    const std::lock_guard lock(impl_->mutex);
    impl_->queue.clear();
}

bool WireCamera::push(std::vector<std::byte> payload, std::int64_t device_ns) {
    Impl& i = *impl_;
    auto due = std::chrono::steady_clock::now();
    {
        const std::lock_guard lock(i.mutex);
        if (i.queue.size() >= i.settings.queue ||
            payload.size() != arv_fake_camera_get_payload(i.registers) ||
            i.read(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) == 0) {
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
