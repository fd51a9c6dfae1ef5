#include "devices/served/served_gocator.h"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cmath>
#include <list>
#include <thread>

#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"
#include "core/number_text.h"
#include "core/profile/filter.h"
#include "core/profile/sensor_model.h"
#include "core/profile/stripe/peaks.h"
#include "devices/exchange/settings.h"
#include "devices/gocator/ascii_result.h"
#include "devices/gocator/gdp_message.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {
constexpr Timeout kTick{1}, kSend{1000};
constexpr std::size_t kMostClients = 16;
}  // namespace

struct ServedGocator::Impl {
    struct Client {
        TcpConnection connection;
        std::string stream;
    };
    struct Port {
        TcpListener listener;
        std::list<Client> clients;
    };

    std::shared_ptr<SimulatedCell> cell;
    std::string serial, format;
    Port control, data, ascii;
    std::unique_ptr<FeatureFinder> tool;
    std::atomic<int> losing = 0;
    std::atomic<bool> cutting = false;
    bool running = false;
    std::chrono::milliseconds start_time{0};
    std::uint64_t frames = 0;
    Frame frame{};
    StripePeaks peaks{};
    ProfileCandidates candidates{};
    std::jthread thread{};

    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            if (cutting.exchange(false))
                for (Port* port : {&control, &data, &ascii}) port->clients.clear();
            for (Port* port : {&control, &data, &ascii}) {
                auto client = port->listener.accept(kTick);
                if (client && port->clients.size() < kMostClients)
                    port->clients.push_back({std::move(*client), {}});
            }
            std::erase_if(control.clients, [&](Client& c) { return !answer(c); });
            for (Port* port : {&data, &ascii})
                std::erase_if(port->clients, [&](Client& c) { return !read(c); });
            if (running)
                if (const auto exposure = cell->take_exposure()) expose(*exposure);
        }
        if (running) cell->arm(false);
    }

    static bool read(Client& client) {
        std::array<std::byte, 4096> buffer;
        const auto got = client.connection.receive_some(buffer, kTick);
        if (!got) return is_silence(got.error());
        client.stream.append(reinterpret_cast<const char*>(buffer.data()), *got);
        return client.stream.size() < gdp::kLongestMessage;
    }

    bool answer(Client& client) {
        if (!read(client)) return false;
        for (;;) {
            auto request = gdp::take_request(client.stream);
            if (!request) return false;
            if (!*request) return true;
            gdp::Reply reply{(*request)->command, gdp::kDone, {}};
            switch (static_cast<gdp::Command>(reply.command)) {
                case gdp::Command::start:
                    std::this_thread::sleep_for(start_time);
                    running = true;
                    frames = 0;
                    cell->arm(true);
                    break;
                case gdp::Command::stop:
                    if (running) std::this_thread::sleep_for(start_time);
                    running = false;
                    cell->arm(false);
                    break;
                case gdp::Command::trigger:
                    if (!running || !cell->software_trigger("")) reply.status = 0;
                    break;
                case gdp::Command::ping:
                    break;
                case gdp::Command::protocol_version:
                    reply.answer = {4, 0};
                    break;
                case gdp::Command::system_info:
                    reply.answer = gdp::system_info_answer({"Gocator simulated", serial, running ? 1 : 0});
                    break;
                default:
                    reply.status = 0;
            }
            if (!client.connection.send(bytes_of(gdp::reply_bytes(reply)), kSend)) return false;
        }
    }

    static void send(Port& port, const std::string& bytes) {
        std::erase_if(port.clients, [&](Client& c) { return !c.connection.send(bytes_of(bytes), kSend); });
    }

    void expose(const SimulatedCell::Waiting& exposure) {
        const std::uint64_t number = frames++;
        if (losing > 0) {
            --losing;
            return;
        }
        cell->render(exposure.base_from_flange, exposure.number, frame, nullptr,
                     exposure.sensor_from_drifted);
        Profile profile;
        if (find_peaks(frame.image, {}, peaks)) {
            to_millimetres(peaks, cell->sensor_model(), candidates);
            if (track_stripe(candidates, {}, profile))
                for (std::size_t i = 0; i < profile.size(); ++i)
                    if (profile.segment[i] == kOutlier) profile.z_mm[i] = std::nan("");
        }
        const auto time_us = static_cast<std::uint64_t>(exposure.time_ns / 1000);
        send(data,
             gdp::message_bytes({static_cast<std::uint16_t>(gdp::Type::stamp), false,
                                 gdp::stamps_content({{number, time_us, 0,
                                                       number_from<std::uint32_t>(serial).value_or(0)}})}) +
                 gdp::message_bytes(
                     {static_cast<std::uint16_t>(gdp::Type::points), true, gdp::points_content(profile)}));
        if (!ascii.clients.empty()) send(ascii, line_of(profile, number, time_us));
    }

    std::string line_of(const Profile& profile, std::uint64_t number, std::uint64_t time_us) const {
        const Feature end = tool->find(profile);
        const bool found = end.status == FeatureStatus::ok;
        const auto value = [&](double mm) {
            return found ? std::to_string(std::lround(1000 * mm)) : std::string("INVALID");
        };
        const std::string x = value(end.point_mm.x()), z = value(end.point_mm.y());
        const int decision = found ? 1 : 2;
        if (format.empty()) return fmt::format("M01,0,V{},D{},M00,1,V{},D{}\r\n", x, decision, z, decision);
        std::string line = format;
        const auto fill = [&](const std::string& placeholder, const std::string& text) {
            if (const auto at = line.find(placeholder); at != std::string::npos)
                line.replace(at, placeholder.size(), text);
        };
        fill("%time", std::to_string(time_us));
        fill("%frame", std::to_string(number));
        fill("%encoder", "0");
        fill("%value[0]", x);
        fill("%value[1]", z);
        fill("%decision[0]", std::to_string(decision));
        fill("%decision[1]", std::to_string(decision));
        return line + "\r\n";
    }
};

ServedGocator::ServedGocator(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ServedGocator::~ServedGocator() = default;
std::uint16_t ServedGocator::control_port() const {
    return impl_->control.listener.port();
}
std::uint16_t ServedGocator::data_port() const {
    return impl_->data.listener.port();
}
std::uint16_t ServedGocator::ascii_port() const {
    return impl_->ascii.listener.port();
}
void ServedGocator::lose_next(int frames) {
    impl_->losing = frames;
}
void ServedGocator::cut() {
    impl_->cutting = true;
}

Expected<std::unique_ptr<ServedGocator>> ServedGocator::open(std::shared_ptr<SimulatedCell> cell,
                                                             const nlohmann::json& settings) {
    std::string address = "127.0.0.1", format;
    std::uint16_t control_port = gdp::kControlPort, data_port = gdp::kDataPort,
                  ascii_port = gocator::kAsciiPort;
    std::uint32_t serial = 12345;
    int start_ms = 0;
    SettingsReader read(settings, "gocator");
    read.only({"address", "control_port", "data_port", "ascii_port", "serial", "format", "start_ms"});
    read.text("address", address);
    read.text("format", format);
    read.whole("control_port", control_port, 0, 65535);
    read.whole("data_port", data_port, 0, 65535);
    read.whole("ascii_port", ascii_port, 0, 65535);
    read.whole("start_ms", start_ms, 0, 15000);
    read.whole("serial", serial, 1, 4294967295.0);
    if (read.failed()) return tl::unexpected(read.error());
    SEAM_OK(gocator::check_format({format}));
    SEAM_TRY(auto tool, make_feature_finder({"contour-end", {}, {}, Eigen::Vector2d::Zero()}));
    SEAM_TRY(auto control, TcpListener::listen(address, control_port));
    SEAM_TRY(auto data, TcpListener::listen(address, data_port));
    SEAM_TRY(auto ascii, TcpListener::listen(address, ascii_port));
    auto impl = std::unique_ptr<Impl>(new Impl{.cell = std::move(cell),
                                               .serial = std::to_string(serial),
                                               .format = format,
                                               .control = {std::move(control), {}},
                                               .data = {std::move(data), {}},
                                               .ascii = {std::move(ascii), {}},
                                               .tool = std::move(tool),
                                               .start_time = std::chrono::milliseconds(start_ms)});
    impl->thread = std::jthread([i = impl.get()](const std::stop_token& stop) { i->serve(stop); });
    return std::unique_ptr<ServedGocator>(new ServedGocator(std::move(impl)));
}

}  // namespace seamwright
