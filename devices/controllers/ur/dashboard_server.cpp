#include "devices/controllers/ur/dashboard_server.h"

#include <array>

namespace seamwright::urscript {

DashboardServer::DashboardServer(TcpListener listener, int slow_ms, std::function<ControllerFault()> fault,
                                 std::function<std::string(const std::string&)> answer)
    : listener_(std::move(listener)),
      slow_ms_(slow_ms),
      fault_(std::move(fault)),
      answer_(std::move(answer)),
      acceptor_([this](const std::stop_token& stop) { accept_clients(stop); }) {}

DashboardServer::~DashboardServer() {
    acceptor_.request_stop();
    acceptor_.join();
    for (const auto& client : clients_) client->thread.request_stop();
    for (const auto& client : clients_) client->thread.join();
}

void DashboardServer::accept_clients(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        auto made = listener_.accept(Timeout(20));
        const std::lock_guard lock(mutex_);
        clients_.remove_if([](const auto& client) {
            if (client->gone) client->thread.join();
            return client->gone;
        });
        if (!made) continue;
        clients_.push_back(std::make_unique<Client>(Client{std::move(*made), false, {}}));
        Client& client = *clients_.back();
        client.thread = std::jthread([this, &client](const std::stop_token& end) {
            serve(client.connection, end);
            client.connection.close();
            const std::lock_guard gone(mutex_);
            client.gone = true;
        });
    }
}

void DashboardServer::serve(TcpConnection& connection, const std::stop_token& stop) {
    constexpr Timeout kSend{500};
    if (!connection.send(bytes_of("Connected: Universal Robots Dashboard Server\n"), kSend)) return;
    std::string received;
    std::array<char, 256> buffer;
    while (!stop.stop_requested()) {
        const auto got = connection.receive_some(std::as_writable_bytes(std::span(buffer)), Timeout(20));
        if (!got && !is_silence(got.error())) return;
        if (got) received.append(buffer.data(), *got);
        if (received.size() > 10'000) return;
        for (std::size_t end; (end = received.find('\n')) != std::string::npos;) {
            std::string question = received.substr(0, end);
            received.erase(0, end + 1);
            if (question.ends_with('\r')) question.pop_back();
            const ControllerFault now = fault_();
            if (now == ControllerFault::silent) continue;
            if (now == ControllerFault::slow) std::this_thread::sleep_for(Timeout(slow_ms_));
            if (now == ControllerFault::disconnect) return;
            const std::string answer = answer_(question) + "\n";
            if (!connection.send(bytes_of(answer), kSend) || question == "quit") return;
        }
    }
}

}  // namespace seamwright::urscript
