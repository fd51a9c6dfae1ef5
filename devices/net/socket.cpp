#include "devices/net/socket.h"

#include <fmt/format.h>

#include <netdb.h>

#include <algorithm>
#include <atomic>
#include <boost/asio.hpp>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "core/system_text.h"

namespace seamwright {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr Timeout kSlice{50};  // how long close() from another thread may take to be seen

template <class Endpoint_>
std::string text(const Endpoint_& endpoint) {
    return fmt::format("{}:{}", endpoint.address().to_string(), endpoint.port());
}

bool ended_by_peer(const error_code& e) {
    return e == asio::error::eof || e == asio::error::connection_reset || e == asio::error::broken_pipe ||
           e == asio::error::connection_aborted;
}

// Runs the one pending operation until it is done, the deadline passes or the object is closed. Returns false
// on the deadline, after the operation was cancelled and its handler ran.
template <class Cancel>
bool run_until_done(asio::io_context& io, const bool& done, Timeout timeout, const std::atomic<bool>& closed,
                    Cancel cancel) {
    const auto deadline = Clock::now() + timeout;
    io.restart();
    while (!done) {
        const auto now = Clock::now();
        if (now >= deadline || closed) break;
        io.run_one_until(std::min(deadline, now + kSlice));
        if (io.stopped() && !done) io.restart();
    }
    if (done) return true;
    cancel();
    io.restart();
    io.run();
    return false;
}

tl::unexpected<Error> failure(const error_code& e, const std::string& where) {
    if (ended_by_peer(e))
        return device_error(ErrorCode::disconnected, kDisconnected, where,
                            "check the cable and the controller");
    return device_error(system_text(e), where);
}

// Letters, digits, '-' and '_' between dots. What ends in a number is none: the system's lookup would take "192.168.1" and
// octal "0177.0.0.1" for addresses, and other ones than they look like.
bool may_be_name(const std::string& host) {
    const auto sign = [](unsigned char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
               c == '_' || c == '.';
    };
    const std::string last = host.substr(host.rfind('.') + 1);
    return host.size() <= 253 && std::all_of(host.begin(), host.end(), sign) &&
           host.find("..") == std::string::npos && !last.empty() &&
           ((last[0] | 0x20) >= 'a' && (last[0] | 0x20) <= 'z') && host[0] != '.' && host[0] != '-';
}

// A lookup cannot be called off, so it has a thread of its own, which may outlast who asked.
Expected<std::vector<asio::ip::address>> addresses_of(const std::string& name, Timeout timeout) {
    struct Lookup {
        std::mutex mutex;
        std::condition_variable ended;
        bool done = false;
        int result = 0;
        std::vector<asio::ip::address> found;
    };
    const auto lookup = std::make_shared<Lookup>();
    std::thread([lookup, name] {
        addrinfo wanted{}, *list = nullptr;
        wanted.ai_socktype = SOCK_STREAM;
        const int result = ::getaddrinfo(name.c_str(), nullptr, &wanted, &list);
        std::vector<asio::ip::address> found;
        for (const addrinfo* a = list; result == 0 && a != nullptr; a = a->ai_next) {
            asio::ip::tcp::endpoint endpoint;
            if (a->ai_addrlen > endpoint.capacity()) continue;
            std::copy_n(reinterpret_cast<const char*>(a->ai_addr), a->ai_addrlen,
                        reinterpret_cast<char*>(endpoint.data()));
            endpoint.resize(a->ai_addrlen);
            found.push_back(endpoint.address());
        }
        if (list != nullptr) ::freeaddrinfo(list);
        const std::lock_guard lock(lookup->mutex);
        lookup->result = result;
        lookup->found = std::move(found);
        lookup->done = true;
        lookup->ended.notify_all();
    }).detach();
    std::unique_lock lock(lookup->mutex);
    if (!lookup->ended.wait_for(lock, timeout, [&] { return lookup->done; }))
        return device_error(ErrorCode::silence, Text("{}: the name \"{}\" is not found", kNoAnswer, name),
                            name, "check the name, or give the address as four numbers, 192.168.1.10");
    if (lookup->found.empty())
        return device_error(Text("the name \"{}\" is not found", name), name,
                            "check the name, or give the address as four numbers, 192.168.1.10");
    return lookup->found;
}

tl::unexpected<Error> closed_here(const std::string& where) {
    return device_error("the connection is closed", where);
}

}  // namespace

struct TcpConnection::Impl {
    asio::io_context io;
    tcp::socket socket{io};
    std::string peer;
    std::atomic<bool> closed{false};

    // `outcome` of an operation that has been waited for: Error, or the bytes moved.
    Expected<std::size_t> finish(bool in_time, const error_code& e, std::size_t moved) const {
        if (closed) return closed_here(peer);
        if (!in_time)
            return device_error(ErrorCode::silence, kNoAnswer, peer,
                                "check that the controller runs and its program is started");
        if (e) return failure(e, peer);
        return moved;
    }

    template <class Start>
    Expected<std::size_t> wait(Timeout timeout, Start start) {
        if (closed) return closed_here(peer);
        bool done = false;
        error_code result;
        std::size_t moved = 0;
        start([&](const error_code& e, std::size_t n) {
            done = true;
            result = e;
            moved = n;
        });
        const bool in_time = run_until_done(io, done, timeout, closed, [&] {
            error_code ignored;
            socket.cancel(ignored);
        });
        // An operation that completed while it was being cancelled still counts.
        return finish(in_time || (done && !result), result, moved);
    }
};

TcpConnection::TcpConnection(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TcpConnection::TcpConnection(TcpConnection&&) noexcept = default;
TcpConnection& TcpConnection::operator=(TcpConnection&&) noexcept = default;
TcpConnection::~TcpConnection() = default;

Expected<TcpConnection> TcpConnection::connect(const std::string& host, std::uint16_t port, Timeout timeout) {
    const auto until = Clock::now() + timeout;
    const auto left = [&] { return std::max(Timeout(0), std::chrono::ceil<Timeout>(until - Clock::now())); };
    auto impl = std::make_unique<Impl>();
    impl->peer = fmt::format("{}:{}", host, port);
    error_code e;
    std::vector<asio::ip::address> addresses = {asio::ip::make_address(host, e)};
    if (e && !may_be_name(host))
        return input_error(Text("\"{}\" is not an IP address", host), "",
                           "give it as four numbers, 192.168.1.10");
    if (e) {
        SEAM_TRY(addresses, addresses_of(host, timeout));
    }
    // One after the other, as the system orders them; each has its share of the time.
    Expected<std::size_t> made;
    for (std::size_t i = 0; i < addresses.size(); ++i) {
        error_code ignored;
        impl->socket.close(ignored);
        made = impl->wait(left() / static_cast<int>(addresses.size() - i), [&](auto done) {
            impl->socket.async_connect({addresses[i], port},
                                       [done](const error_code& error) mutable { done(error, 0); });
        });
        if (made) break;
    }
    if (!made) return tl::unexpected(made.error());
    impl->socket.set_option(tcp::no_delay(true), e);
    return TcpConnection(std::move(impl));
}

Expected<void> TcpConnection::send(std::span<const std::byte> data, Timeout timeout) {
    SEAM_OK(impl_->wait(timeout, [&](auto done) {
        asio::async_write(impl_->socket, asio::buffer(data.data(), data.size()), done);
    }));
    return {};
}

Expected<std::size_t> TcpConnection::receive_some(std::span<std::byte> buffer, Timeout timeout) {
    return impl_->wait(timeout, [&](auto done) {
        impl_->socket.async_read_some(asio::buffer(buffer.data(), buffer.size()), done);
    });
}

Expected<void> TcpConnection::receive_exactly(std::span<std::byte> buffer, Timeout timeout) {
    SEAM_OK(impl_->wait(timeout, [&](auto done) {
        asio::async_read(impl_->socket, asio::buffer(buffer.data(), buffer.size()), done);
    }));
    return {};
}

void TcpConnection::close() {
    impl_->closed = true;
}
bool TcpConnection::is_open() const {
    return impl_ && !impl_->closed && impl_->socket.is_open();
}
bool is_loopback(const std::string& address) {
    error_code none;
    const auto parsed = boost::asio::ip::make_address(address, none);
    return !none && parsed.is_loopback();
}

Expected<void> check_robot_address(const std::string& listen, const std::string& robot_address) {
    if (!robot_address.empty() || is_loopback(listen)) return {};
    return input_error("it would be open to every computer of the network",
                       Text("settings.listen {}", listen),
                       "name the controller's address in \"robot_address\"");
}

std::string TcpConnection::peer() const {
    return impl_->peer;
}

struct TcpListener::Impl {
    asio::io_context io;
    tcp::acceptor acceptor{io};
    std::string where;
    std::atomic<bool> closed{false};
};

TcpListener::TcpListener(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TcpListener::TcpListener(TcpListener&&) noexcept = default;
TcpListener& TcpListener::operator=(TcpListener&&) noexcept = default;
TcpListener::~TcpListener() = default;

Expected<TcpListener> TcpListener::listen(const std::string& address, std::uint16_t port) {
    auto impl = std::make_unique<Impl>();
    impl->where = fmt::format("{}:{}", address, port);
    error_code e;
    const tcp::endpoint endpoint(asio::ip::make_address(address, e), port);
    if (e) return input_error(Text("\"{}\" is not an IP address", address), "listen");
    impl->acceptor.open(endpoint.protocol(), e);
    if (!e) impl->acceptor.set_option(tcp::acceptor::reuse_address(true), e);
    if (!e) impl->acceptor.bind(endpoint, e);
    if (!e) impl->acceptor.listen(4, e);
    if (e)
        return device_error(Text("cannot listen: {}", system_text(e)), impl->where,
                            "another program may use this port");
    impl->where = text(impl->acceptor.local_endpoint());
    return TcpListener(std::move(impl));
}

std::uint16_t TcpListener::port() const {
    return impl_->acceptor.local_endpoint().port();
}

Expected<TcpConnection> TcpListener::accept(Timeout timeout) {
    auto connection = std::make_unique<TcpConnection::Impl>();
    bool done = false;
    error_code result;
    tcp::socket socket(impl_->io);
    impl_->acceptor.async_accept(socket, [&](const error_code& e) {
        done = true;
        result = e;
    });
    const bool in_time = run_until_done(impl_->io, done, timeout, impl_->closed, [&] {
        error_code ignored;
        impl_->acceptor.cancel(ignored);
    });
    if (impl_->closed) return closed_here(impl_->where);
    if (!in_time && (!done || result))
        return device_error(ErrorCode::silence, kNoAnswer, impl_->where, "nobody connected");
    if (result) return failure(result, impl_->where);
    // The connection gets an io_context of its own, so that it may live in another thread than the listener.
    error_code e;
    const tcp::endpoint peer = socket.remote_endpoint(e);
    if (e) return failure(e, impl_->where);
    connection->peer = text(peer);
    connection->socket.assign(peer.protocol(), socket.release(), e);
    if (e) return failure(e, impl_->where);
    connection->socket.set_option(tcp::no_delay(true), e);
    return TcpConnection(std::move(connection));
}

void TcpListener::close() {
    impl_->closed = true;
}

struct UdpSocket::Impl {
    asio::io_context io;
    udp::socket socket{io};
    std::string where;
    std::atomic<bool> closed{false};
};

UdpSocket::UdpSocket(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
UdpSocket::UdpSocket(UdpSocket&&) noexcept = default;
UdpSocket& UdpSocket::operator=(UdpSocket&&) noexcept = default;
UdpSocket::~UdpSocket() = default;

Expected<UdpSocket> UdpSocket::bind(const std::string& address, std::uint16_t port, Shared shared) {
    auto impl = std::make_unique<Impl>();
    impl->where = fmt::format("{}:{}", address, port);
    error_code e;
    const udp::endpoint endpoint(asio::ip::make_address(address, e), port);
    if (e) return input_error(Text("\"{}\" is not an IP address", address), "bind");
    impl->socket.open(endpoint.protocol(), e);
    if (!e && shared == Shared::yes) impl->socket.set_option(udp::socket::reuse_address(true), e);
    if (!e) impl->socket.bind(endpoint, e);
    if (e)
        return device_error(Text("cannot bind: {}", system_text(e)), impl->where,
                            "another program may use this port");
    impl->where = text(impl->socket.local_endpoint());
    return UdpSocket(std::move(impl));
}

std::uint16_t UdpSocket::port() const {
    return impl_->socket.local_endpoint().port();
}

Expected<void> UdpSocket::send_to(std::span<const std::byte> datagram, const Endpoint& to) {
    error_code e;
    const auto address = asio::ip::make_address(to.address, e);
    if (e) return input_error(Text("\"{}\" is not an IP address", to.address), impl_->where);
    impl_->socket.send_to(asio::buffer(datagram.data(), datagram.size()), {address, to.port}, 0, e);
    if (e) return failure(e, impl_->where);
    return {};
}

Expected<std::size_t> UdpSocket::receive(std::span<std::byte> buffer, Endpoint& from, Timeout timeout) {
    if (impl_->closed) return closed_here(impl_->where);
    bool done = false;
    error_code result;
    std::size_t size = 0;
    udp::endpoint sender;
    // MSG_TRUNC makes the system report the datagram's true length even when the buffer is shorter.
    impl_->socket.async_receive_from(asio::buffer(buffer.data(), buffer.size()), sender, MSG_TRUNC,
                                     [&](const error_code& e, std::size_t n) {
                                         done = true;
                                         result = e;
                                         size = n;
                                     });
    const bool in_time = run_until_done(impl_->io, done, timeout, impl_->closed, [&] {
        error_code ignored;
        impl_->socket.cancel(ignored);
    });
    if (impl_->closed) return closed_here(impl_->where);
    if (!in_time && (!done || result)) return device_error(ErrorCode::silence, kNoAnswer, impl_->where);
    if (result) return failure(result, impl_->where);
    if (size > buffer.size())
        return device_error(Text("a datagram of {} bytes is longer than {}", size, buffer.size()),
                            text(sender));
    from = {sender.address().to_string(), sender.port()};
    return size;
}

bool UdpSocket::has_datagram() const {
    error_code e;
    return !impl_->closed && impl_->socket.available(e) > 0 && !e;
}

void UdpSocket::close() {
    impl_->closed = true;
}

}  // namespace seamwright
