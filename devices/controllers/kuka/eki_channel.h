#pragma once
// EthernetKRL as a controller has it: a channel configured by its XML file, element by element with a FIFO
// each, over a TCP connection that the controller opens. Source: KUKA.EthernetKRL 2.2 / 3.0 (configuration
// file, functions and EKI_STATUS).

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "devices/controllers/kuka/krl/krl_value.h"
#include "devices/net/socket.h"
#include "devices/simulated/controller.h"

namespace seamwright::krl {

struct EkiElement {
    std::string tag;   // "Sensor/Pos/@X"
    std::string type;  // STRING, REAL, INT, BOOL; empty in SEND and for the document's own flag
    int flag = 0;      // set when it has come; 0 = none
};

struct EkiConfiguration {
    std::string address;
    std::uint16_t port = 0;
    std::size_t fifo = 16, buffer = 16384;
    int alive_flag = 0;
    std::vector<EkiElement> receive, send;
};

// Error (KrlError) for what EthernetKRL does not accept: unknown elements and attributes, missing ones,
// numbers out of range, addresses that cannot be connected to, tags that stand twice, types that do not
// exist.
EkiConfiguration parse_eki_configuration(const std::string& xml);

// Thread-safe. Answers as EKI_STATUS: `message` 0 = done.
class EkiChannel {
  public:
    using SetFlag = std::function<void(int number, bool value)>;  // not called with the channel's lock held
    // `fault` is asked at every message; `slow` is how late they then come.
    EkiChannel(EkiConfiguration configuration, SetFlag set_flag, std::function<ControllerFault()> fault,
               Timeout slow, std::function<void()> before_telegram);
    ~EkiChannel();

    struct Status {
        int message = 0;
        bool connected = false;
        std::size_t buffered = 0, read = 0;
    };
    Status open();  // blocks until connected or refused
    Status close();
    Status check(const std::string& tag) const;  // elements that wait; Error for a tag that is not configured
    Status take(const std::string& tag, const std::string& type, std::string& value);
    void set(const std::string& tag, std::string value);
    Status send(const std::string& root);

  private:
    void receive(const std::stop_token& stop);
    bool arrived(const std::string& document);
    bool put(std::string bytes);  // with the fault's changes
    bool reject(const std::string& document);

    const EkiConfiguration configuration_;
    const SetFlag set_flag_;
    const std::function<ControllerFault()> fault_;
    const Timeout slow_;
    const std::function<void()> before_telegram_;
    mutable std::mutex mutex_;
    std::mutex connection_mutex_;  // the connection belongs to one thread at a time
    std::shared_ptr<TcpConnection> connection_;
    bool connected_ = false;
    std::map<std::string, std::deque<std::string>> fifos_;
    std::map<std::string, std::string> values_;  // set and not yet sent
    std::jthread reader_;
};

}  // namespace seamwright::krl
