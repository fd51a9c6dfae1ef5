#pragma once
// The camera's side of GigE Vision on one address of this host: GVCP commands are answered from a memory of
// registers, frames leave as GVSP.
//
// GigE Vision 1.2: GVCP is UDP port 3956 (READREG, WRITEREG, READMEM, WRITEMEM, DISCOVERY; whatever else is
// answered "not implemented"), GVSP goes to where the client's stream registers 0xD00 and 0xD18 say, cut by
// 0xD04, with 16-bit frame numbers: no packet resend, no test packets, no events. One client is in control,
// from its write of 0xA00 until it gives that back or tells nothing for the heartbeat time-out (0x938);
// writes of others are answered "access denied". Every 127.x.y.z is an address of this host, so there may be
// as many cameras as such addresses. Discovery broadcasts of other programs on this host are answered too.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/error.h"

namespace seamwright {

// What the commands read and write. Thread-safe; big-endian as on the wire.
class GigeMemory {
  public:
    virtual ~GigeMemory() = default;
    // false: there is nothing at this address.
    virtual bool read(std::uint32_t address, std::span<std::byte> to) = 0;
    // By the client in control, or by its end (0xA00 = 0); on the server's thread, to be quick.
    virtual bool write(std::uint32_t address, std::span<const std::byte> from) = 0;
};

struct GigeFrame {
    std::uint16_t id = 1;
    std::uint64_t device_ns = 0;
    std::uint32_t pixel_format = 0, width = 0, height = 0, x = 0, y = 0;
    std::span<const std::byte> payload;
};

// Serves from open() to its destruction.
class GigeServer {
  public:
    // `memory` must outlive it. Error (device): the address is no address of this host, or its port 3956 is
    // taken.
    static Expected<std::unique_ptr<GigeServer>> open(const std::string& address, GigeMemory& memory);
    ~GigeServer();  // within 60 ms
    // The packets of one frame, those left out that `lost` says; one thread. Nothing happens without a
    // destination.
    void send(const GigeFrame& frame, const std::function<bool()>& lost);

  private:
    struct Impl;
    explicit GigeServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
