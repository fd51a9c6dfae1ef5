#pragma once
// What a Modbus server and a Modbus client have in common: the station's state and the line's words between the
// watching's thread and the link's. Thread-safe; nothing here waits for a socket.

#include <array>
#include <atomic>
#include <deque>
#include <mutex>

#include "devices/line/register_map.h"

namespace seamwright {

// The heartbeat goes on for so long after the station was last heard: as long as the service's watchdog has patience.
inline constexpr std::chrono::seconds kLineAlive{120};

SettingTable modbus_settings(const SettingTable& own);
HandshakeOptions read_handshake(SettingsReader& r);

// Sentences that wait to be told, of which only the first few are kept.
class LineNotices {
  public:
    void add(Text text);
    std::vector<Text> take();

  private:
    std::mutex mutex_;
    std::vector<Text> waiting_;
};

class ModbusStation {
  public:
    using Clock = std::chrono::steady_clock;
    explicit ModbusStation(const HandshakeOptions& options) : options_(options), handshake_(options) {}

    // The watching's thread.
    void publish(const LineState& state);
    void alive();
    std::optional<LineCall> take_call();
    bool given_up() const;
    LinePart announced() const;  // as the registers stand
    bool starts_parts() const { return options_.line_starts; }

    // The link's thread.
    void hear(std::span<const std::uint16_t> line_words);
    void lost();
    void write(AllWords& words);

  private:
    HandshakeOptions options_;
    mutable std::mutex mutex_;
    Handshake handshake_;
    LineState state_;
    Clock::time_point alive_ = Clock::now();
    std::uint16_t heartbeat_ = 0;
    Clock::time_point beat_ = Clock::now();
};

// A link whose station side is a ModbusStation.
class ModbusLink : public LineLink {
  public:
    explicit ModbusLink(const HandshakeOptions& options) : station_(options) {}
    void publish(const LineState& state) override { station_.publish(state); }
    void alive() override { station_.alive(); }
    std::optional<LineCall> take_call() override { return station_.take_call(); }
    bool given_up() const override { return station_.given_up(); }
    LinePart take_announced() override { return station_.announced(); }
    bool starts_parts() const override { return station_.starts_parts(); }
    bool connected() const override { return connected_; }
    std::vector<Text> take_notices() override { return notices_.take(); }

  protected:
    ModbusStation station_;
    LineNotices notices_;
    std::atomic<bool> connected_{false};
};

Expected<std::unique_ptr<LineLink>> open_modbus_server(const nlohmann::json& settings,
                                                       const std::string& name);
const SettingTable& modbus_server_settings();
Expected<std::unique_ptr<LineLink>> open_modbus_client(const nlohmann::json& settings,
                                                       const std::string& name);
const SettingTable& modbus_client_settings();

}  // namespace seamwright
