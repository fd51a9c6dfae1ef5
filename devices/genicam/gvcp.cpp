#include "devices/genicam/gvcp.h"

#include <fmt/format.h>

#include <atomic>

#include "devices/net/socket.h"

namespace seamwright {
namespace {

constexpr std::size_t kHeader = 8, kRegisters = 0xF8;

unsigned big16(std::span<const std::byte> bytes, std::size_t at) {
    return std::to_integer<unsigned>(bytes[at]) << 8 | std::to_integer<unsigned>(bytes[at + 1]);
}

std::string text_at(std::span<const std::byte> registers, std::size_t at, std::size_t size) {
    std::string text;
    for (const std::byte b : registers.subspan(at, size)) {
        if (b == std::byte{0}) break;
        const char c = static_cast<char>(b);
        text += c >= 0x20 && c < 0x7F ? c : '?';
    }
    return text;
}

}  // namespace

std::array<std::byte, 8> discovery_command(std::uint16_t request_id) {
    return {std::byte{0x42},
            std::byte{0x01},
            std::byte{0},
            std::byte{0x02},
            std::byte{0},
            std::byte{0},
            static_cast<std::byte>(request_id >> 8),
            static_cast<std::byte>(request_id & 0xFF)};
}

Expected<DiscoveredCamera> parse_discovery_ack(std::span<const std::byte> datagram,
                                               std::uint16_t request_id) {
    const std::string where = "GVCP discovery";
    if (datagram.size() < kHeader) return device_error("the answer is shorter than its header", where);
    if (big16(datagram, 2) != 0x0003) return device_error("the answer is no DISCOVERY_ACK", where);
    if (big16(datagram, 6) != request_id) return device_error("the answer is to another question", where);
    if (const unsigned status = big16(datagram, 0); status != 0)
        return device_error(Text("the camera answers with error 0x{:04X}", status), where);
    if (datagram.size() < kHeader + kRegisters || big16(datagram, 4) < kRegisters)
        return device_error("the answer is cut short", where);
    const auto registers = datagram.subspan(kHeader, kRegisters);
    DiscoveredCamera camera;
    camera.protocol = "GigEVision";
    camera.address = fmt::format("{}.{}.{}.{}", std::to_integer<int>(registers[0x24]),
                                 std::to_integer<int>(registers[0x25]), std::to_integer<int>(registers[0x26]),
                                 std::to_integer<int>(registers[0x27]));
    camera.vendor = text_at(registers, 0x48, 32);
    camera.model = text_at(registers, 0x68, 32);
    camera.serial = text_at(registers, 0xD8, 16);
    return camera;
}

Expected<DiscoveredCamera> ask_camera(const std::string& address, std::chrono::milliseconds timeout) {
    static std::atomic<std::uint16_t> counter = 1;
    std::uint16_t request = counter++;
    if (request == 0) request = counter++;  // 0 is no request
    const bool loopback = address.starts_with("127.");
    SEAM_TRY(auto socket, UdpSocket::bind(loopback ? "127.0.0.1" : "0.0.0.0", 0));
    SEAM_OK(socket.send_to(discovery_command(request), {address, kGvcpPort}));
    const auto until = std::chrono::steady_clock::now() + timeout;
    std::array<std::byte, 1500> datagram;
    for (;;) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
        if (left.count() <= 0) break;
        Endpoint from;
        const auto size = socket.receive(datagram, from, left);
        if (!size) {
            if (is_silence(size.error())) break;
            continue;  // refused by the host: as silent as nobody
        }
        if (from.address != address) continue;
        if (auto camera = parse_discovery_ack(std::span(datagram).first(*size), request)) return camera;
    }
    return device_error(ErrorCode::silence, kNoAnswer, Text("camera {}", address),
                        "check its power and cable");
}

}  // namespace seamwright
