#include "devices/served/gige_server.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <optional>
#include <thread>
#include <vector>

#include "devices/genicam/gvcp.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Timeout kServerSlice{50};
constexpr std::size_t kCommandHeader = 8, kMostData = 536, kPacketOverhead = 20 + 8 + 8;  // IP, UDP, GVSP
// Bootstrap registers.
constexpr std::uint32_t kHeartbeat = 0x938, kPrivilege = 0xA00, kStreamPort = 0xD00, kPacketSize = 0xD04,
                        kStreamAddress = 0xD18, kDiscoveryData = 0, kDiscoverySize = 0xF8;
struct Gvcp {
    enum Command : std::uint16_t {
        discovery = 2,
        read_register = 0x80,
        write_register = 0x82,
        read_memory = 0x84,
        write_memory = 0x86
    };
    enum Status : std::uint16_t {
        success = 0,
        not_implemented = 0x8001,
        invalid_parameter = 0x8002,
        invalid_address = 0x8003,
        access_denied = 0x8006
    };
};

using GigeBytes = std::vector<std::byte>;

template <class T>
void put_big(GigeBytes& to, T value) {
    for (int shift = 8 * (static_cast<int>(sizeof(T)) - 1); shift >= 0; shift -= 8)
        to.push_back(static_cast<std::byte>(value >> shift & 0xFF));
}
std::uint32_t word32(std::span<const std::byte> from, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint32_t>(from[at + i]);
    return value;
}
std::uint16_t word16(std::span<const std::byte> from, std::size_t at) {
    return static_cast<std::uint16_t>(std::to_integer<unsigned>(from[at]) << 8 |
                                      std::to_integer<unsigned>(from[at + 1]));
}

GigeBytes gvsp_header(std::uint16_t frame, std::uint8_t format, std::uint32_t packet) {
    GigeBytes p;
    put_big<std::uint16_t>(p, 0);
    put_big(p, frame);
    put_big<std::uint32_t>(p, static_cast<std::uint32_t>(format) << 24 | (packet & 0xFFFFFF));
    return p;
}

}  // namespace

struct GigeServer::Impl {
    Impl(UdpSocket c, UdpSocket s, GigeMemory& m) : control(std::move(c)), stream(std::move(s)), memory(m) {}
    UdpSocket control, stream;
    std::optional<UdpSocket> broadcasts, answers;  // where the system lets us hear them
    GigeMemory& memory;
    std::optional<Endpoint> controller;  // control thread
    Clock::time_point heard{};           // of it
    std::jthread control_thread, broadcast_thread;

    std::uint32_t reg(std::uint32_t address) {
        std::array<std::byte, 4> raw{};
        return memory.read(address, raw) ? word32(raw, 0) : 0;
    }
    GigeBytes answer(std::span<const std::byte> command, const Endpoint& from);
    Gvcp::Status execute(std::uint16_t word, std::span<const std::byte> data, bool may_write,
                         GigeBytes& body);
    void end_of_control();
    void serve(const std::stop_token& stop);
    void hear_broadcasts(const std::stop_token& stop);
};

Gvcp::Status GigeServer::Impl::execute(std::uint16_t word, std::span<const std::byte> data, bool may_write,
                                       GigeBytes& body) {
    const bool writes = word == Gvcp::write_register || word == Gvcp::write_memory;
    if (writes && !may_write) return Gvcp::access_denied;
    switch (word) {
        case Gvcp::discovery:
            body.resize(kDiscoverySize);
            return memory.read(kDiscoveryData, body) ? Gvcp::success : Gvcp::invalid_address;
        case Gvcp::read_register:
            if (data.empty() || data.size() % 4 != 0) return Gvcp::invalid_parameter;
            body.resize(data.size());
            for (std::size_t at = 0; at < data.size(); at += 4)
                if (!memory.read(word32(data, at), std::span(body).subspan(at, 4)))
                    return Gvcp::invalid_address;
            return Gvcp::success;
        case Gvcp::write_register: {
            if (data.empty() || data.size() % 8 != 0) return Gvcp::invalid_parameter;
            for (std::size_t at = 0; at < data.size(); at += 8)
                if (!memory.write(word32(data, at), data.subspan(at + 4, 4))) return Gvcp::invalid_address;
            put_big<std::uint32_t>(body, static_cast<std::uint32_t>(data.size() / 8));
            return Gvcp::success;
        }
        case Gvcp::read_memory: {
            if (data.size() != 8) return Gvcp::invalid_parameter;
            const std::size_t count = word16(data, 6);
            if (count == 0 || count > kMostData || count % 4 != 0) return Gvcp::invalid_parameter;
            put_big(body, word32(data, 0));
            body.resize(4 + count);
            return memory.read(word32(data, 0), std::span(body).subspan(4)) ? Gvcp::success
                                                                            : Gvcp::invalid_address;
        }
        case Gvcp::write_memory:
            if (data.size() < 8 || data.size() > 4 + kMostData) return Gvcp::invalid_parameter;
            if (!memory.write(word32(data, 0), data.subspan(4))) return Gvcp::invalid_address;
            put_big<std::uint32_t>(body, static_cast<std::uint32_t>(data.size() - 4));
            return Gvcp::success;
        default:
            return Gvcp::not_implemented;
    }
}

// Empty: no command.
GigeBytes GigeServer::Impl::answer(std::span<const std::byte> command, const Endpoint& from) {
    if (command.size() < kCommandHeader || command[0] != std::byte{0x42} ||
        command.size() < kCommandHeader + word16(command, 4))
        return {};
    const std::uint16_t word = word16(command, 2);
    const std::span<const std::byte> data = command.subspan(kCommandHeader, word16(command, 4));
    const bool in_control = controller && *controller == from;
    if (in_control) heard = Clock::now();
    // Who is not in control may write one register alone: that with which it takes the control.
    const bool takes_control =
        !controller && word == Gvcp::write_register && data.size() == 8 && word32(data, 0) == kPrivilege;
    GigeBytes body;
    const Gvcp::Status status = execute(word, data, in_control || takes_control, body);
    if (status != Gvcp::success) body.clear();
    if (const bool taken = (reg(kPrivilege) & 3U) != 0; taken && !controller) {
        controller = from;
        heard = Clock::now();
    } else if (!taken) {
        controller.reset();
    }
    GigeBytes packet;
    put_big<std::uint16_t>(packet, status);
    put_big<std::uint16_t>(packet, static_cast<std::uint16_t>(word + 1));
    put_big<std::uint16_t>(packet, static_cast<std::uint16_t>(body.size()));
    put_big<std::uint16_t>(packet, word16(command, 6));
    packet.insert(packet.end(), body.begin(), body.end());
    return packet;
}

// A client that says nothing for the heartbeat time-out is in control no more.
void GigeServer::Impl::end_of_control() {
    if (!controller || Clock::now() - heard <= std::chrono::milliseconds(reg(kHeartbeat))) return;
    controller.reset();
    memory.write(kPrivilege, std::array<std::byte, 4>{});
}

void GigeServer::Impl::serve(const std::stop_token& stop) {
    std::array<std::byte, 2048> datagram;
    while (!stop.stop_requested()) {
        Endpoint from;
        const auto size = control.receive(datagram, from, kServerSlice);
        end_of_control();
        if (!size) continue;
        if (const GigeBytes packet = answer(std::span(datagram).first(*size), from); !packet.empty())
            (void)control.send_to(packet, from);  // a client that has gone misses nothing
    }
}

void GigeServer::Impl::hear_broadcasts(const std::stop_token& stop) {
    std::array<std::byte, 2048> datagram;
    while (!stop.stop_requested()) {
        Endpoint from;
        const auto size = broadcasts->receive(datagram, from, kServerSlice);
        const auto command = std::span(datagram).first(size.value_or(0));
        if (command.size() < kCommandHeader || command[0] != std::byte{0x42} ||
            word16(command, 2) != Gvcp::discovery)
            continue;
        GigeBytes packet;
        put_big<std::uint16_t>(packet, Gvcp::success);
        put_big<std::uint16_t>(packet, Gvcp::discovery + 1);
        put_big<std::uint16_t>(packet, kDiscoverySize);
        put_big<std::uint16_t>(packet, word16(command, 6));
        packet.resize(kCommandHeader + kDiscoverySize);
        if (memory.read(kDiscoveryData, std::span(packet).subspan(kCommandHeader)))
            (void)answers->send_to(packet, from);
    }
}

GigeServer::GigeServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GigeServer::~GigeServer() = default;

Expected<std::unique_ptr<GigeServer>> GigeServer::open(const std::string& address, GigeMemory& memory) {
    SEAM_TRY(auto control, UdpSocket::bind(address, kGvcpPort));
    SEAM_TRY(auto stream, UdpSocket::bind(address, 0));
    auto impl = std::make_unique<Impl>(std::move(control), std::move(stream), memory);
    auto broadcasts = UdpSocket::bind("255.255.255.255", kGvcpPort, UdpSocket::Shared::yes);
    auto answers = UdpSocket::bind(address, 0);
    Impl* i = impl.get();
    if (broadcasts && answers) {
        i->broadcasts.emplace(std::move(*broadcasts));
        i->answers.emplace(std::move(*answers));
        i->broadcast_thread = std::jthread([i](const std::stop_token& stop) { i->hear_broadcasts(stop); });
    }
    i->control_thread = std::jthread([i](const std::stop_token& stop) { i->serve(stop); });
    return std::unique_ptr<GigeServer>(new GigeServer(std::move(impl)));
}

void GigeServer::send(const GigeFrame& frame, const std::function<bool()>& lost) {
    Impl& i = *impl_;
    const std::uint32_t ip = i.reg(kStreamAddress), port = i.reg(kStreamPort) & 0xFFFF;
    const std::uint32_t packet_size = i.reg(kPacketSize) & 0xFFFF;
    if (ip == 0 || port == 0 || packet_size <= kPacketOverhead) return;
    const Endpoint to{std::to_string(ip >> 24) + "." + std::to_string(ip >> 16 & 255) + "." +
                          std::to_string(ip >> 8 & 255) + "." + std::to_string(ip & 255),
                      static_cast<std::uint16_t>(port)};
    std::uint32_t number = 0;
    const auto leave = [&](const GigeBytes& packet) {
        if (!lost()) (void)i.stream.send_to(packet, to);
        ++number;
    };
    GigeBytes leader = gvsp_header(frame.id, 1, number);
    put_big<std::uint16_t>(leader, 0);
    put_big<std::uint16_t>(leader, 1);  // an image
    put_big(leader, frame.device_ns);
    for (const std::uint32_t v : {frame.pixel_format, frame.width, frame.height, frame.x, frame.y})
        put_big(leader, v);
    put_big<std::uint32_t>(leader, 0);  // no padding
    leave(leader);
    const std::size_t most = packet_size - kPacketOverhead;
    for (std::size_t at = 0; at < frame.payload.size(); at += most) {
        const auto part = frame.payload.subspan(at, std::min(most, frame.payload.size() - at));
        GigeBytes packet = gvsp_header(frame.id, 3, number);
        packet.insert(packet.end(), part.begin(), part.end());
        leave(packet);
    }
    GigeBytes trailer = gvsp_header(frame.id, 2, number);
    put_big<std::uint32_t>(trailer, 1);
    put_big(trailer, frame.height);
    leave(trailer);
}

}  // namespace seamwright
