// The controller with KUKAVARPROXY: its variables by name, read and written whenever a client asks.

#include <array>
#include <optional>
#include <thread>

#include "devices/controllers/kuka/cell_operator.h"
#include "devices/controllers/kuka/controller.h"
#include "devices/kuka/kvp_message.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

constexpr Timeout kKvpServerTick{2};

class KvpController final : public krl::KukaCell {
  public:
    KvpController(std::shared_ptr<SimulatedCell> cell, krl::OperatorSettings settings, TcpListener listener)
        : KukaCell(std::move(cell), std::move(settings), false), listener_(std::move(listener)) {}
    ~KvpController() override {
        thread_ = {};
        end();
    }
    Expected<void> start() {
        SEAM_OK(begin());
        thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
        return {};
    }
    std::uint16_t port() const override { return listener_.port(); }

  private:
    void serve(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            auto client = listener_.accept(kKvpServerTick);
            if (!client) continue;
            connection_.emplace(std::move(*client));
            cut_ = false;
            std::string stream;
            while (!stop.stop_requested() && answer_all(stream)) {
            }
            connection_.reset();
        }
    }

    bool answer_all(std::string& stream) {
        std::array<char, 4096> buffer;
        const auto got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)), kKvpServerTick);
        if (!got) return is_silence(got.error());
        stream.append(buffer.data(), *got);
        refresh();
        for (;;) {
            auto request = take_kvp_request(stream);
            if (!request) return false;
            if (!*request) return true;
            if (!tell(answer_to(**request))) return false;
        }
    }

    KvpAnswer answer_to(const KvpRequest& request) {
        KvpAnswer answer{request.id, request.write, request.value, false};
        if (request.write && fault() == ControllerFault::reject_write) return answer;
        const std::lock_guard lock(machine_.mutex());
        try {
            if (request.write)
                machine_.set(*robot_, request.name, request.value);
            else
                answer.value = told(request.name, machine_.value(*robot_, request.name));
            answer.done = true;
        } catch (const krl::KrlError&) {
            if (!request.write) answer.value.clear();
        }
        return answer;
    }

    std::string told(const std::string& name, krl::Value value) const {
        if (fault() == ControllerFault::out_of_range) {
            if (value.parts.count("X") > 0) value.parts["X"] = 1e9;
            if (name == "$MODE_OP") value.text = "T9";
            if (name == "SW_FIRED") value.number = 1e9;
        }
        return krl::shown(value);
    }

    bool tell(KvpAnswer answer) {
        const ControllerFault now = fault();
        if (now == ControllerFault::silent || cut_) return true;
        if (now == ControllerFault::slow) std::this_thread::sleep_for(Timeout(settings_.slow_ms));
        if (now == ControllerFault::wrong_answer) answer.id = static_cast<std::uint16_t>(answer.id + 7);
        std::string bytes = kvp_bytes(answer);
        cut_ = now == ControllerFault::half_message;  // and nothing more on this connection
        if (cut_ || now == ControllerFault::disconnect) bytes.resize(bytes.size() / 2);
        return connection_->send(bytes_of(bytes), Timeout(500)) && now != ControllerFault::disconnect;
    }

    TcpListener listener_;
    std::optional<TcpConnection> connection_;
    bool cut_ = false;
    std::jthread thread_;  // last: everything above is there while it runs
};

}  // namespace

Expected<std::unique_ptr<SimulatedController>> start_kuka_kvp_controller(std::shared_ptr<SimulatedCell> cell,
                                                                         const nlohmann::json& settings) {
    SEAM_TRY(auto parsed, krl::parse_operator_settings(settings, 7000, 0));
    SEAM_TRY(auto listener, TcpListener::listen(parsed.address, static_cast<std::uint16_t>(parsed.port)));
    auto controller =
        std::make_unique<KvpController>(std::move(cell), std::move(parsed), std::move(listener));
    SEAM_OK(controller->start());
    return controller;
}

}  // namespace seamwright
