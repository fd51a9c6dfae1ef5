#pragma once
// The controller's dashboard (port 29999) for several clients at once: one line of text a question, one an
// answer, in the words of Universal Robots' dashboard.

#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "devices/net/socket.h"
#include "devices/simulated/controller.h"

namespace seamwright::urscript {

class DashboardServer {
  public:
    // `answer` on the clients' threads; a fault is looked at before each answer.
    DashboardServer(TcpListener listener, int slow_ms, std::function<ControllerFault()> fault,
                    std::function<std::string(const std::string& question)> answer);
    ~DashboardServer();

  private:
    struct Client {
        TcpConnection connection;
        bool gone = false;
        std::jthread thread;
    };
    void accept_clients(const std::stop_token& stop);
    void serve(TcpConnection& connection, const std::stop_token& stop);

    TcpListener listener_;
    const int slow_ms_;
    const std::function<ControllerFault()> fault_;
    const std::function<std::string(const std::string&)> answer_;
    std::mutex mutex_;  // the list
    std::list<std::unique_ptr<Client>> clients_;
    std::jthread acceptor_;  // last
};

}  // namespace seamwright::urscript
