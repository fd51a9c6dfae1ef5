#pragma once
// TCP and UDP with a deadline on every call: the transport of every controller and network sensor. Nothing
// here knows a protocol.
//
// Failures are Errors of kind device whose `where` is the peer ("192.168.1.10:7000"); `what` begins with one
// of the constants of silence.h, so that callers can tell silence from a lost connection. An object belongs
// to one thread at a time; close() may be called from any thread and ends a call that waits within 50 ms.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/error.h"
#include "devices/silence.h"

namespace seamwright {

using Timeout = std::chrono::milliseconds;

inline std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

bool is_loopback(const std::string& address);  // 127.0.0.0/8

// A server of ours that the whole network reaches must know whom it serves. Error: `listen` is not loopback
// and `robot_address` is empty.
Expected<void> check_robot_address(const std::string& listen, const std::string& robot_address);

class TcpConnection {
  public:
    // `host`: an address, or a name that this computer finds (its addresses are tried one after the other). Error (input):
    // neither; (device): not found, or nobody answers, all within `timeout`.
    static Expected<TcpConnection> connect(const std::string& host, std::uint16_t port, Timeout timeout);
    TcpConnection(TcpConnection&&) noexcept;
    TcpConnection& operator=(TcpConnection&&) noexcept;
    ~TcpConnection();

    Expected<void> send(std::span<const std::byte> data, Timeout timeout);
    // At least one byte, at most the buffer; the number received.
    Expected<std::size_t> receive_some(std::span<std::byte> buffer, Timeout timeout);
    // Fills the buffer, or Error with how much came. What came before a failure is lost: treat the stream as
    // broken.
    Expected<void> receive_exactly(std::span<std::byte> buffer, Timeout timeout);
    void close();
    bool is_open() const;
    std::string peer() const;  // "127.0.0.1:7000"

  private:
    friend class TcpListener;
    struct Impl;
    explicit TcpConnection(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

// Listens on one address; 127.0.0.1 unless the project names another. Port 0 takes a free one.
class TcpListener {
  public:
    static Expected<TcpListener> listen(const std::string& address, std::uint16_t port);
    TcpListener(TcpListener&&) noexcept;
    TcpListener& operator=(TcpListener&&) noexcept;
    ~TcpListener();
    std::uint16_t port() const;
    Expected<TcpConnection> accept(Timeout timeout);
    void close();

  private:
    struct Impl;
    explicit TcpListener(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

struct Endpoint {
    std::string address;
    std::uint16_t port = 0;
    bool operator==(const Endpoint&) const = default;
};

class UdpSocket {
  public:
    enum class Shared { no, yes };  // yes: others may have the same; each hears what is broadcast
    static Expected<UdpSocket> bind(const std::string& address, std::uint16_t port,
                                    Shared shared = Shared::no);
    UdpSocket(UdpSocket&&) noexcept;
    UdpSocket& operator=(UdpSocket&&) noexcept;
    ~UdpSocket();
    std::uint16_t port() const;
    Expected<void> send_to(std::span<const std::byte> datagram, const Endpoint& to);
    // One datagram; longer ones than the buffer are refused, never cut.
    Expected<std::size_t> receive(std::span<std::byte> buffer, Endpoint& from, Timeout timeout);
    bool has_datagram() const;  // the next receive() would not wait
    void close();

  private:
    struct Impl;
    explicit UdpSocket(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
