#include "devices/controllers/ur/rtde_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <deque>

namespace seamwright::urscript {
namespace {

using rtde::Package;
using rtde::Type;
constexpr Timeout kPoll{1};
constexpr std::size_t kMostNames = 2048;

std::vector<std::string> split(std::string_view names) {
    std::vector<std::string> out;
    for (bool more = true; more;) {
        const std::size_t comma = names.find(',');
        out.emplace_back(names.substr(0, comma));
        more = comma != std::string_view::npos;
        if (more) names.remove_prefix(comma + 1);
    }
    return out;
}

void put_word(std::string& out, std::uint32_t v) {
    for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<char>(v >> shift & 0xff));
}

}  // namespace

struct RtdeServer::Client {
    explicit Client(TcpConnection made) : connection(std::move(made)) {}
    TcpConnection connection;
    int version = 1;  // until another is agreed
    bool cut = false;
    // Under the server's lock.
    bool streaming = false;
    rtde::Recipe outputs;
    std::vector<const OutputVariable*> output_values;
    std::uint64_t every = 1;      // cycles between two packages
    std::deque<std::string> due;  // data packages to be sent
    std::map<std::uint8_t, std::pair<rtde::Recipe, std::vector<const InputVariable*>>> inputs;
    std::vector<std::pair<std::string, std::uint8_t>> to_say;
    std::atomic<bool> gone = false;
    std::jthread thread;
};

RtdeServer::RtdeServer(TcpListener listener, RtdeServerSettings settings,
                       std::function<ControllerFault()> fault)
    : listener_(std::move(listener)),
      settings_(std::move(settings)),
      fault_(std::move(fault)),
      acceptor_([this](const std::stop_token& stop) { accept_clients(stop); }) {}

RtdeServer::~RtdeServer() {
    acceptor_.request_stop();
    acceptor_.join();
    for (const auto& client : clients_) client->thread.request_stop();
    for (const auto& client : clients_) client->thread.join();
}

void RtdeServer::accept_clients(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        auto made = listener_.accept(Timeout(20));
        std::list<std::unique_ptr<Client>> ended;
        const std::lock_guard lock(mutex_);
        for (auto it = clients_.begin(); it != clients_.end();) {
            const auto next = std::next(it);
            if ((*it)->gone) ended.splice(ended.end(), clients_, it);
            it = next;
        }
        if (!made) continue;
        clients_.push_back(std::make_unique<Client>(std::move(*made)));
        Client& client = *clients_.back();
        client.thread = std::jthread([this, &client](const std::stop_token& end) { serve(client, end); });
    }
}

void RtdeServer::serve(Client& client, const std::stop_token& stop) {
    std::string received;
    std::array<char, 4096> buffer;
    const auto serve_once = [&] {
        const auto got = client.connection.receive_some(std::as_writable_bytes(std::span(buffer)), kPoll);
        if (!got && !is_silence(got.error())) return false;
        if (got) received.append(buffer.data(), *got);
        for (;;) {
            const auto package = rtde::take_package(received);
            if (!package) {
                (void)tell(client, package.error().what.english(), 1);
                return false;
            }
            if (!*package) break;
            if (!answer(client, **package)) return false;
        }
        return stream(client);
    };
    while (!stop.stop_requested() && serve_once()) continue;
    release(client);
    client.connection.close();
    client.gone = true;
}

// The variables are free again; the registers keep what was written.
void RtdeServer::release(Client& client) {
    const std::lock_guard lock(mutex_);
    std::erase_if(owners_, [&](const auto& owner) { return owner.second == &client; });
}

bool RtdeServer::answer(Client& client, const Package& package) {
    const auto reply = [&](std::string payload) { return send(client, {package.type, std::move(payload)}); };
    switch (package.type) {
        case Type::protocol_version: {
            const auto wanted = rtde::version_of(package.payload);
            if (!wanted) return tell(client, wanted.error().what.english(), 1) && false;
            const bool yes = *wanted >= 1 && *wanted <= settings_.newest_protocol;
            if (yes) client.version = *wanted;
            return reply(std::string(1, yes ? '\1' : '\0'));
        }
        case Type::controller_version: {
            std::string payload;
            for (const std::uint32_t v : settings_.version) put_word(payload, v);
            return reply(payload);
        }
        case Type::setup_outputs:
            return reply(setup_outputs(client, package.payload));
        case Type::setup_inputs:
            return reply(setup_inputs(client, package.payload));
        case Type::start: {
            const bool yes = !client.output_values.empty() || !client.inputs.empty();
            const bool sent = reply(std::string(1, yes ? '\1' : '\0'));
            const std::lock_guard lock(mutex_);
            client.streaming = yes;
            return sent;
        }
        case Type::pause: {
            {
                const std::lock_guard lock(mutex_);
                client.streaming = false;
                client.due.clear();
            }
            return reply(std::string(1, '\1'));
        }
        case Type::data:
            return take_data(client, package.payload);
        case Type::text:
            return true;  // for the controller's log
    }
    return false;
}

std::string RtdeServer::setup_outputs(Client& client, std::string_view names) {
    double frequency_hz = 125;
    const std::lock_guard lock(mutex_);
    client.output_values.clear();
    client.outputs = {};
    client.streaming = false;
    client.due.clear();
    if (client.version >= 2) {
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < 8 && i < names.size(); ++i)
            bits = bits << 8 | static_cast<unsigned char>(names[i]);
        frequency_hz = std::bit_cast<double>(bits);
        names.remove_prefix(std::min<std::size_t>(8, names.size()));
    }
    const double most_hz = 1 / settings_.cycle_s;
    if (!(frequency_hz > 0) || frequency_hz > most_hz) frequency_hz = most_hz;
    client.every =
        std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::lround(most_hz / frequency_hz)));
    bool all = names.size() <= kMostNames;
    std::string types;
    for (const std::string& name : split(names)) {
        const auto it = output_variables().find(name);
        bool known = it != output_variables().end();
        if (known && name == "tcp_offset") known = state_.tells_tcp_offset;
        types += types.empty() ? "" : ",";
        types += known ? rtde::kind_name(it->second.kind) : "NOT_FOUND";
        all = all && known;
        if (!known) continue;
        client.outputs.names.push_back(name);
        client.outputs.kinds.push_back(it->second.kind);
        client.output_values.push_back(&it->second);
    }
    client.outputs.id = 1;
    client.outputs.numbered = client.version >= 2;
    if (!all) client.output_values.clear();
    if (client.version < 2) return types;
    return std::string(1, all ? '\1' : '\0') + types;
}

std::string RtdeServer::setup_inputs(Client& client, std::string_view names) {
    rtde::Recipe recipe;
    std::vector<const InputVariable*> values;
    std::string types;
    bool all = names.size() <= kMostNames && client.inputs.size() < 255;
    const std::lock_guard lock(mutex_);
    for (const std::string& name : split(names)) {
        const auto it = input_variables().find(name);
        const bool known = it != input_variables().end();
        const auto owner = owners_.find(name);
        const bool free =
            !settings_.elsewhere.contains(name) && (owner == owners_.end() || owner->second == &client);
        types += types.empty() ? "" : ",";
        types += !known ? "NOT_FOUND" : !free ? "IN_USE" : rtde::kind_name(it->second.kind);
        all = all && known && free;
        if (!known) continue;
        recipe.names.push_back(name);
        recipe.kinds.push_back(it->second.kind);
        values.push_back(&it->second);
    }
    if (!all) return std::string(1, '\0') + types;
    recipe.id = static_cast<std::uint8_t>(client.inputs.size() + 1);
    for (const std::string& name : recipe.names) owners_[name] = &client;
    client.inputs[recipe.id] = {recipe, values};
    return std::string(1, static_cast<char>(recipe.id)) + types;
}

bool RtdeServer::take_data(Client& client, const std::string& payload) {
    const auto recipe = client.inputs.find(payload.empty() ? 0 : static_cast<std::uint8_t>(payload[0]));
    if (recipe == client.inputs.end()) return tell(client, "Data of no input recipe came", 1) && false;
    const auto values = rtde::values_of(payload, recipe->second.first);
    if (!values) return tell(client, values.error().what.english(), 1) && false;
    if (!client.streaming) return true;  // not started: not synchronised
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < values->size(); ++i)
        written_.emplace_back(recipe->second.second[i], (*values)[i]);
    return true;
}

void RtdeServer::take_inputs(ControllerInputs& inputs) {
    const std::lock_guard lock(mutex_);
    for (const auto& [variable, value] : written_) variable->take(inputs, value);
    written_.clear();
}

// Each recipe's package is of its own cycle, however late the client's thread comes to send it.
void RtdeServer::publish(const ControllerState& state) {
    constexpr std::size_t kMostDue = 16;  // of a client that does not take them
    const std::lock_guard lock(mutex_);
    state_ = state;
    for (const auto& client : clients_) {
        if (!client->streaming || client->output_values.empty() || state.cycle % client->every != 0) continue;
        std::vector<rtde::Value> values;
        for (const OutputVariable* variable : client->output_values) values.push_back(variable->value(state));
        client->due.push_back(rtde::data_payload(client->outputs, values));
        if (client->due.size() > kMostDue) client->due.pop_front();
    }
}

void RtdeServer::say(const std::string& text, std::uint8_t level) {
    const std::lock_guard lock(mutex_);
    for (const auto& client : clients_) client->to_say.emplace_back(text, level);
}

bool RtdeServer::stream(Client& client) {
    std::deque<std::string> due;
    std::vector<std::pair<std::string, std::uint8_t>> to_say;
    {
        const std::lock_guard lock(mutex_);
        to_say.swap(client.to_say);
        due.swap(client.due);
    }
    for (const auto& [text, level] : to_say)
        if (!tell(client, text, level)) return false;
    for (std::string& payload : due)
        if (!send(client, {Type::data, std::move(payload)})) return false;
    return true;
}

bool RtdeServer::tell(Client& client, const std::string& text, std::uint8_t level) {
    const std::string message = text.substr(0, 255), source = "URControl";
    std::string payload;
    if (client.version == 1) {
        payload = std::string(1, static_cast<char>(level)) + message;
    } else {
        payload = std::string(1, static_cast<char>(message.size())) + message;
        payload += std::string(1, static_cast<char>(source.size())) + source;
        payload.push_back(static_cast<char>(level));
    }
    return send(client, {Type::text, payload});
}

bool RtdeServer::send(Client& client, const Package& package) {
    const ControllerFault now = fault_();
    if (now == ControllerFault::silent || client.cut) return true;
    if (now == ControllerFault::slow) std::this_thread::sleep_for(Timeout(settings_.slow_ms));
    std::string bytes = rtde::package_bytes(package);
    client.cut = now == ControllerFault::half_message;  // and nothing more on this connection
    if (client.cut || now == ControllerFault::disconnect) bytes.resize(bytes.size() / 2);
    return client.connection.send(bytes_of(bytes), Timeout(500)) && now != ControllerFault::disconnect;
}

}  // namespace seamwright::urscript
