// Modbus TCP client: the PLC is the server, and holds the same table at addresses of its choice. Polled on a thread of
// its own, on which libmodbus may wait.

#include <modbus/modbus.h>

#include <cerrno>
#include <condition_variable>
#include <thread>

#include "core/system_text.h"
#include "devices/backoff.h"
#include "devices/line/modbus_station.h"

namespace seamwright {
namespace {

struct ClientSettings {
    std::string address;
    int port = 0, unit_id = 0, read_address = 0, write_address = 0;
    std::chrono::milliseconds poll{}, timeout{}, reconnect{}, reconnect_most{};
    HandshakeOptions handshake;
};

Expected<ClientSettings> client_settings(const nlohmann::json& json) {
    ClientSettings s;
    SettingsReader r(json, "settings", modbus_client_settings());
    r.text("address", s.address);
    r.whole("port", s.port);
    r.whole("unit_id", s.unit_id);
    r.whole("read_address", s.read_address);
    r.whole("write_address", s.write_address);
    r.duration("poll_ms", s.poll);
    r.duration("timeout_ms", s.timeout);
    r.duration("reconnect_ms", s.reconnect);
    r.duration("reconnect_most_ms", s.reconnect_most);
    s.handshake = read_handshake(r);
    if (r.failed()) return tl::unexpected(r.error());
    if (s.address.empty())
        return input_error("the PLC's address is missing", "settings.address", "write numbers, 192.168.1.10");
    // The station's block must not lie on the line's.
    const int block = kAllWords - kStationWords;
    if (s.read_address < s.write_address + block && s.write_address < s.read_address + kLineWords)
        return input_error("the words of line and station lie on one another", "settings.write_address",
                           Text("leave {} words from read_address on", kLineWords));
    return s;
}

class ModbusClient : public ModbusLink {
  public:
    explicit ModbusClient(ClientSettings settings)
        : ModbusLink(settings.handshake),
          settings_(std::move(settings)),
          backoff_(settings_.reconnect, settings_.reconnect_most) {
        thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
    }
    ~ModbusClient() override {
        thread_.request_stop();
        thread_.join();
    }
    ModbusClient(const ModbusClient&) = delete;
    ModbusClient& operator=(const ModbusClient&) = delete;

  private:
    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            if (!modbus_ && !connect()) {
                rest(stop, std::max(backoff_.left(), std::chrono::milliseconds(1)));
                continue;
            }
            if (exchange()) {
                rest(stop, settings_.poll);
            } else {
                drop(errno);
            }
        }
        close();
    }

    void rest(const std::stop_token& stop, std::chrono::milliseconds time) {
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, stop, time, [] { return false; });
    }

    bool connect() {
        if (!backoff_.due()) return false;
        modbus_ = modbus_new_tcp_pi(settings_.address.c_str(), std::to_string(settings_.port).c_str());
        const auto micro = std::chrono::duration_cast<std::chrono::microseconds>(settings_.timeout).count();
        const auto s = static_cast<std::uint32_t>(micro / 1000000),
                   us = static_cast<std::uint32_t>(micro % 1000000);
        if (modbus_) {
            modbus_set_response_timeout(modbus_, s, us);
            modbus_set_byte_timeout(modbus_, s, us);
            modbus_set_slave(modbus_, settings_.unit_id);
        }
        if (!modbus_ || modbus_connect(modbus_) != 0) {
            drop(errno);
            return false;
        }
        written_.reset();
        return true;
    }

    void close() {
        if (!modbus_) return;
        modbus_close(modbus_);
        modbus_free(modbus_);
        modbus_ = nullptr;
    }

    // An exception is an answer, to something that this PLC does not do.
    static bool is_exception(int error) { return error >= EMBXILFUN && error <= EMBXGTAR; }

    void drop(int error) {
        const Text why =
            error < MODBUS_ENOBASE ? system_text(error) : Text(std::string(modbus_strerror(error)));
        // Told once an outage.
        if (!told_away_)
            notices_.add(
                is_exception(error)
                    ? Text("the PLC at {}:{} refuses the words at read_address or write_address: {}",
                           settings_.address, settings_.port, why)
                    : Text("the PLC at {}:{} does not answer: {}", settings_.address, settings_.port, why));
        told_away_ = true;
        connected_ = false;
        station_.lost();
        close();
        backoff_.failed();
    }

    bool write_block(int from, int count) {
        for (int at = from; at < from + count; at += MODBUS_MAX_WRITE_REGISTERS) {
            const int part = std::min(MODBUS_MAX_WRITE_REGISTERS, from + count - at);
            if (modbus_write_registers(modbus_, settings_.write_address + at - kStationWords, part,
                                       &words_[static_cast<std::size_t>(at)]) != part)
                return false;
        }
        return true;
    }

    // Reads the line's words, writes the station's: the regions where they changed, then the head, so that `done` is
    // never before what it stands for.
    bool exchange() {
        std::array<std::uint16_t, kLineWords> line{};
        if (modbus_read_registers(modbus_, settings_.read_address, kLineWords, line.data()) != kLineWords)
            return false;
        station_.hear(line);
        station_.write(words_);
        for (int k = 0; k < kLineRegions; ++k) {
            const int from = kRegionWords + k * kRegionStride;
            const auto* begin = words_.data() + from;
            const bool is = std::any_of(begin, begin + kRegionStride, [](auto w) { return w != 0; });
            if (written_ ? !std::equal(begin, begin + kRegionStride, written_->data() + from) : is) {
                if (!write_block(from, kRegionStride)) return false;
            } else if (!written_ && !write_block(from, 1) && !is_exception(errno)) {
                return false;  // a PLC may hold that of an earlier station, or no words for it at all
            }
        }
        if (!write_block(kStationWords, kStationWordsEnd - kStationWords)) return false;
        written_ = words_;
        backoff_.worked();
        if (told_away_)
            notices_.add(Text("the PLC at {}:{} answers again", settings_.address, settings_.port));
        told_away_ = false;
        connected_ = true;
        return true;
    }

    ClientSettings settings_;
    Backoff backoff_;
    modbus_t* modbus_ = nullptr;
    AllWords words_{};
    std::optional<AllWords> written_;
    bool told_away_ = false;
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::jthread thread_;
};

}  // namespace

const SettingTable& modbus_client_settings() {
    static const SettingTable table = modbus_settings(entry::joined(
        {
            entry::text("address", "", "of the PLC, which is the server; needed"),
            entry::whole("port", 502, 1, 65535, ""),
            entry::whole("unit_id", 1, 0, 255, "of the PLC"),
            entry::whole("read_address", 0, 0, 65000,
                         "where the PLC holds the line's words (address 0 of the table)"),
            entry::whole("write_address", 100, 0, 65000,
                         "where it takes the station's (address 100 of the table)"),
            entry::whole("poll_ms", 100, 10, 10000, "between two looks"),
            entry::whole("timeout_ms", 500, 20, 10000, "for an answer"),
        },
        entry::reconnect(10, 200, 5000)));
    return table;
}

Expected<std::unique_ptr<LineLink>> open_modbus_client(const nlohmann::json& settings, const std::string&) {
    SEAM_TRY(auto read, client_settings(settings));
    return std::make_unique<ModbusClient>(std::move(read));
}

}  // namespace seamwright
