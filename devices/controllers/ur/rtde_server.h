#pragma once
// The controller's RTDE interface (port 30004) for several clients at once, as the RTDE guide has it:
// protocol versions 1 and 2, the controller's version, output recipes each at its own frequency, input
// recipes whose variables belong to the first client that asks (IN_USE for the others until it goes), start
// and pause, text messages. A client that sends what is no RTDE, or data of no recipe of its own, is told so
// and put out.

#include <array>
#include <functional>
#include <list>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "devices/controllers/ur/rtde_variables.h"
#include "devices/net/socket.h"
#include "devices/simulated/controller.h"

namespace seamwright::urscript {

struct RtdeServerSettings {
    int newest_protocol = 2;
    double cycle_s = 0.002;
    std::array<std::uint32_t, 4> version = {5, 12, 0, 1101319};  // of the controller
    std::set<std::string> elsewhere;                             // inputs that a field bus writes
    int slow_ms = 300;
};

class RtdeServer {
  public:
    // `fault` is asked before each package.
    RtdeServer(TcpListener listener, RtdeServerSettings settings, std::function<ControllerFault()> fault);
    ~RtdeServer();
    std::uint16_t port() const { return listener_.port(); }

    // The controller's cycle: what clients wrote since the last, and what it tells them.
    void take_inputs(ControllerInputs& inputs);
    void publish(const ControllerState& state);
    void say(const std::string& text, std::uint8_t level);  // to all; 0 exception .. 3 information

  private:
    struct Client;
    void accept_clients(const std::stop_token& stop);
    void serve(Client& client, const std::stop_token& stop);
    bool answer(Client& client, const rtde::Package& package);
    bool stream(Client& client);
    bool send(Client& client, const rtde::Package& package);
    bool tell(Client& client, const std::string& text, std::uint8_t level);
    std::string setup_outputs(Client& client, std::string_view names);
    std::string setup_inputs(Client& client, std::string_view names);
    bool take_data(Client& client, const std::string& payload);
    void release(Client& client);

    TcpListener listener_;
    const RtdeServerSettings settings_;
    const std::function<ControllerFault()> fault_;
    std::mutex mutex_;  // all below
    ControllerState state_;
    std::vector<std::pair<const InputVariable*, rtde::Value>> written_;
    std::map<std::string, const Client*> owners_;
    std::list<std::unique_ptr<Client>> clients_;
    std::jthread acceptor_;  // last
};

}  // namespace seamwright::urscript
