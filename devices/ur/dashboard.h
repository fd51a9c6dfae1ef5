#pragma once
// Universal Robots' Dashboard server (port 29999): one line of text a question, one an answer, a greeting
// first.

#include <optional>
#include <string>

#include "devices/net/socket.h"

namespace seamwright::ur {

class Dashboard {
  public:
    Dashboard(std::string address, std::uint16_t port, Timeout timeout);
    // Connects where needed, anew where the other side has closed. Error (device): not reachable, silence, a
    // line over 1000 bytes; the connection is dropped and the next question connects anew.
    Expected<std::string> ask(const std::string& question);
    // The same; nothing where the server does not know the question: older versions know fewer, and their line says so in words
    // ("could not understand: ..", the protocol has no code).
    Expected<std::optional<std::string>> ask_if_known(const std::string& question);
    void close() { connection_.reset(); }

  private:
    Expected<std::string> ask_once(const std::string& question);
    Expected<std::string> line(std::chrono::steady_clock::time_point until);
    tl::unexpected<Error> fail(Error error);

    const std::string address_, where_;
    const std::uint16_t port_;
    const Timeout timeout_;
    std::optional<TcpConnection> connection_;
    std::string received_;
};

}  // namespace seamwright::ur
