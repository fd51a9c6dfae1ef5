// Modbus TCP server. Frames are gathered here, a byte at a time if a stranger sends them so, and only whole and sound
// ones reach libmodbus, which writes the answers: its own receiving waits for the rest of a frame, and its answering
// trusts the lengths that a request claims.

#include <modbus/modbus.h>

#include <boost/asio/bind_executor.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/steady_timer.hpp>
#include <list>
#include <thread>

#include "core/system_text.h"
#include "devices/line/modbus_station.h"

namespace seamwright {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t kHead = 7;           // of a frame: transaction, protocol, length, unit
constexpr std::size_t kLongestRest = 253;  // function and data
constexpr std::chrono::seconds kRestOfFrame{1};
constexpr std::uint8_t kReadHolding = 3, kReadInput = 4, kWriteOne = 6, kWriteMany = 16;

struct ServerSettings {
    std::string listen, line_address;
    int port = 0, unit_id = 0, connections = 0;
    std::chrono::milliseconds idle{};
    HandshakeOptions handshake;
};

Expected<ServerSettings> server_settings(const nlohmann::json& json) {
    ServerSettings s;
    SettingsReader r(json, "settings", modbus_server_settings());
    r.text("listen", s.listen);
    r.whole("port", s.port);
    r.text("line_address", s.line_address);
    r.whole("unit_id", s.unit_id);
    r.whole("connections", s.connections);
    r.duration("idle_ms", s.idle);
    s.handshake = read_handshake(r);
    if (r.failed()) return tl::unexpected(r.error());
    for (const auto& [name, text] :
         {std::pair("listen", &s.listen), std::pair("line_address", &s.line_address)}) {
        error_code error;
        asio::ip::make_address(*text, error);
        if (error && !(text == &s.line_address && text->empty()))
            return input_error(Text("\"{}\" is no address", *text), Text("settings.{}", name),
                               "write numbers, 192.168.1.10");
    }
    if (s.line_address.empty() && !asio::ip::make_address(s.listen).is_loopback())
        return input_error("it would be open to every computer of the network",
                           Text("settings.listen {}", s.listen),
                           "name the PLC's address in \"line_address\"");
    return s;
}

int number_at(const std::uint8_t* bytes) {
    return bytes[0] << 8 | bytes[1];
}

// 0: the request is sound and allowed; else the exception that answers it. `pdu`: function and data.
int exception_of(std::span<const std::uint8_t> pdu) {
    const std::uint8_t function = pdu[0];
    if (function != kReadHolding && function != kReadInput && function != kWriteOne && function != kWriteMany)
        return MODBUS_EXCEPTION_ILLEGAL_FUNCTION;
    if (pdu.size() < 5) return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    const int address = number_at(&pdu[1]);
    if (function == kReadHolding || function == kReadInput) {
        const int count = number_at(&pdu[3]);
        if (pdu.size() != 5 || count < 1 || count > MODBUS_MAX_READ_REGISTERS)
            return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
        return address + count > kAllWords ? MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS : 0;
    }
    int count = 1;
    if (function == kWriteOne) {
        if (pdu.size() != 5) return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    } else {
        count = number_at(&pdu[3]);
        if (pdu.size() < 6 || count < 1 || count > MODBUS_MAX_WRITE_REGISTERS || pdu[5] != 2 * count ||
            pdu.size() != 6 + static_cast<std::size_t>(2 * count))
            return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    }
    return line_may_write(address, count) ? 0 : MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS;
}

class ModbusServer : public ModbusLink {
  public:
    explicit ModbusServer(ServerSettings settings)
        : ModbusLink(settings.handshake),
          settings_(std::move(settings)),
          modbus_(modbus_new_tcp(nullptr, 0)) {
        mapping_.nb_registers = mapping_.nb_input_registers = kAllWords;
        mapping_.tab_registers = mapping_.tab_input_registers = words_.data();
    }
    ~ModbusServer() override {
        context_.stop();
        if (thread_.joinable()) thread_.join();
        connections_.clear();
        modbus_free(modbus_);
    }
    ModbusServer(const ModbusServer&) = delete;
    ModbusServer& operator=(const ModbusServer&) = delete;

    Expected<void> begin() {
        const tcp::endpoint endpoint(asio::ip::make_address(settings_.listen),
                                     static_cast<std::uint16_t>(settings_.port));
        error_code error;
        acceptor_.open(endpoint.protocol(), error);
        if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
        if (!error) acceptor_.bind(endpoint, error);
        if (!error) acceptor_.listen(settings_.connections, error);
        if (error || !modbus_)
            return device_error(Text("the Modbus server cannot begin: {}", system_text(error)),
                                Text("{}:{}", settings_.listen, settings_.port), "choose another port");
        port_ = acceptor_.local_endpoint().port();
        accept();
        thread_ = std::thread([this] { context_.run(); });
        return {};
    }
    int port() const override { return port_; }

  private:
    struct Connection {
        Connection(tcp::socket s, asio::io_context& context) : socket(std::move(s)), timer(context) {}
        tcp::socket socket;
        asio::steady_timer timer;
        std::array<std::uint8_t, kHead + kLongestRest> frame{};
        std::size_t length = 0;
        ModbusStation::Clock::time_point last = ModbusStation::Clock::now();  // whole frame
    };
    using Shared = std::shared_ptr<Connection>;

    void accept() {
        acceptor_.async_accept([this](error_code error, tcp::socket socket) {
            if (error == asio::error::operation_aborted) return;
            if (error) {  // no descriptors left, or the like: not at full speed
                pause_.expires_after(std::chrono::milliseconds(100));
                pause_.async_wait([this](error_code stopped) {
                    if (!stopped) accept();
                });
                return;
            }
            take_in(std::move(socket));
            accept();
        });
    }

    void take_in(tcp::socket socket) {
        error_code error;
        const auto peer = socket.remote_endpoint(error);
        if (error) return;
        if (!settings_.line_address.empty() &&
            peer.address() != asio::ip::make_address(settings_.line_address)) {
            notices_.add(Text("a connection of an unknown peer was refused: {}", peer.address().to_string()));
            return;
        }
        socket.non_blocking(true, error);
        socket.set_option(tcp::no_delay(true), error);
        // The longest silent one makes room: who keeps asking keeps the line.
        if (connections_.size() >= static_cast<std::size_t>(settings_.connections)) {
            const auto oldest =
                std::min_element(connections_.begin(), connections_.end(),
                                 [](const Shared& a, const Shared& b) { return a->last < b->last; });
            close(*oldest);
        }
        auto c = std::make_shared<Connection>(std::move(socket), context_);
        connections_.push_back(c);
        connected_ = true;
        read_head(c);
    }

    void close(const Shared& c) {
        error_code ignored;
        c->timer.cancel();
        c->socket.close(ignored);
        connections_.remove(c);  // may be the list's own: not used from here on
        connected_ = !connections_.empty();
    }

    void until(const Shared& c, ModbusStation::Clock::duration patience) {
        c->timer.expires_after(patience);
        c->timer.async_wait([this, c](error_code stopped) {
            if (!stopped && c->socket.is_open()) close(c);
        });
    }

    void read_head(const Shared& c) {
        until(c, settings_.idle);
        asio::async_read(c->socket, asio::buffer(c->frame.data(), kHead),
                         [this, c](error_code error, std::size_t) {
                             if (error || !c->socket.is_open()) return gone(c);
                             const auto rest = static_cast<std::size_t>(number_at(&c->frame[4]));
                             // What is no Modbus frame leaves no place to go on from.
                             if (number_at(&c->frame[2]) != 0 || rest < 2 || rest > kLongestRest + 1)
                                 return gone(c);
                             c->length = kHead - 1 + rest;
                             read_rest(c);
                         });
    }

    void read_rest(const Shared& c) {
        until(c, kRestOfFrame);
        asio::async_read(c->socket, asio::buffer(c->frame.data() + kHead, c->length - kHead),
                         [this, c](error_code error, std::size_t) {
                             if (error || !c->socket.is_open()) return gone(c);
                             c->last = ModbusStation::Clock::now();
                             if (answer(*c)) return read_head(c);
                             gone(c);
                         });
    }

    void gone(const Shared& c) {
        if (c->socket.is_open()) close(c);
    }

    // False: nobody takes the answer.
    bool answer(Connection& c) {
        const int unit = c.frame[6];
        int exception = exception_of({c.frame.data() + kHead, c.length - kHead});
        if (unit != settings_.unit_id && unit != 0 && unit != MODBUS_TCP_SLAVE)
            exception = MODBUS_EXCEPTION_GATEWAY_TARGET;
        modbus_set_socket(modbus_, c.socket.native_handle());
        if (exception != 0)
            return modbus_reply_exception(modbus_, c.frame.data(), static_cast<unsigned>(exception)) > 0;
        const std::uint8_t function = c.frame[kHead];
        const bool writes = function == kWriteOne || function == kWriteMany;
        // Heard before it is acknowledged: what a PLC does next may start the part that its words were about.
        if (writes) {
            take_words(c.frame.data() + kHead);
            station_.hear({words_.data(), kLineWords});
        } else {
            station_.write(words_);
        }
        return modbus_reply(modbus_, c.frame.data(), static_cast<int>(c.length), &mapping_) > 0;
    }

    // As modbus_reply() would, which does so as it answers. `pdu`: a sound request to write.
    void take_words(const std::uint8_t* pdu) {
        const std::uint8_t* values = pdu + (pdu[0] == kWriteOne ? 3 : 6);
        const int count = pdu[0] == kWriteOne ? 1 : number_at(pdu + 3);
        for (int i = 0; i < count; ++i)
            words_[static_cast<std::size_t>(number_at(pdu + 1) + i)] =
                static_cast<std::uint16_t>(number_at(values + 2 * i));
    }

    ServerSettings settings_;
    modbus_t* modbus_;
    AllWords words_{};
    modbus_mapping_t mapping_{};
    asio::io_context context_{1};
    tcp::acceptor acceptor_{context_};
    asio::steady_timer pause_{context_};
    std::list<Shared> connections_;
    int port_ = 0;
    std::thread thread_;
};

}  // namespace

const SettingTable& modbus_server_settings() {
    static const SettingTable table = modbus_settings({
        entry::text("listen", "127.0.0.1", "address of this computer where the PLC reaches it"),
        entry::whole("port", 502, 0, 65535, "0: any free one"),
        entry::text("line_address", "",
                    "who alone may connect; needed where listen is not of this computer alone"),
        entry::whole("unit_id", 1, 1, 247, "0 and 255 are answered too"),
        entry::whole("connections", 8, 1, 64, "at most; the longest silent one goes when one more comes"),
        entry::whole("idle_ms", 60000, 1000, 3600000, "a connection without a request is closed"),
    });
    return table;
}

Expected<std::unique_ptr<LineLink>> open_modbus_server(const nlohmann::json& settings, const std::string&) {
    SEAM_TRY(auto read, server_settings(settings));
    auto server = std::make_unique<ModbusServer>(std::move(read));
    SEAM_OK(server->begin());
    return server;
}

}  // namespace seamwright
