// Seamwright's end of the EthernetKRL connection.

#include <fmt/format.h>

#include <array>
#include <deque>
#include <optional>

#include "devices/exchange/settings.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/eki_telegram.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

class EkiLink final : public RobotLink {
  public:
    EkiLink(TcpListener listener, std::string where, std::string robot_address, Timeout timeout)
        : listener_(std::move(listener)),
          where_(std::move(where)),
          robot_address_(std::move(robot_address)),
          timeout_(timeout) {}

    Expected<RobotIdentity> identity() override {
        if (auto ready = connected(Clock::now() + timeout_); !ready) return tl::unexpected(ready.error());
        return RobotIdentity{"kuka-eki", "KUKA", hello_.part, hello_.name};
    }

    Expected<RobotMode> mode() override {
        auto state = ask({.kind = "state"});
        if (!state) return tl::unexpected(state.error());
        auto mode = mode_from_eki(state->mode);
        if (!mode) return fail(mode.error());
        return mode;
    }

    Expected<Pose> base_from_flange() override {
        auto state = ask({.kind = "state"});
        if (!state) return tl::unexpected(state.error());
        return state->pose;
    }

    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override {
        auto start = wait_event(starts_, Clock::now() + timeout);
        if (!start) return tl::unexpected(start.error());
        return StartSignal{start->telegram.part, start->time_ns};
    }

    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        triggers_.clear();
        last_trigger_ = 0;
        return only_error(ask({.kind = "measure", .name = program_signature(moves)}));
    }

    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override {
        auto event = wait_event(triggers_, Clock::now() + timeout);
        if (!event) return tl::unexpected(event.error());
        const EkiTelegram& t = event->telegram;
        if (t.id != last_trigger_ + 1)
            return fail({ErrorKind::device,
                         fmt::format("trigger {} came where trigger {} was due", t.id, last_trigger_ + 1),
                         where_, "measure the part again"});
        ++last_trigger_;
        return TriggerEvent{t.name, event->time_ns, t.pose};
    }

    Expected<Pose> read_frame(const std::string& name) override {
        auto answer = ask({.kind = "read", .name = name});
        if (!answer) return tl::unexpected(answer.error());
        return answer->pose;
    }

    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        if (name.empty() || name.size() > kEkiLongestText)
            return input_error("\"" + name + "\" is no name of a frame", where_);
        if (!base_from_frame.matrix().allFinite() ||
            base_from_frame.translation().cwiseAbs().maxCoeff() > 1e5)
            return input_error("the frame is not finite or beyond 100 m", name);
        return only_error(ask({.kind = "write", .name = name, .pose = base_from_frame}));
    }

    Expected<void> confirm(PartVerdict verdict, const std::string& text) override {
        return only_error(ask({.kind = "confirm", .name = std::string(to_string(verdict)), .text = text}));
    }

    Expected<void> move_to(const Pose& base_from_flange) override {
        if (!base_from_flange.matrix().allFinite()) return input_error("the pose is not finite", where_);
        return only_error(ask({.kind = "move", .pose = base_from_flange}));
    }

    std::vector<std::string> take_notices() override {
        if (strangers_ == 0) return {};
        return {fmt::format("{} connections of an unknown peer were refused, the last of {}",
                            std::exchange(strangers_, 0), stranger_)};
    }

  private:
    struct Event {
        EkiTelegram telegram;
        std::int64_t time_ns = 0;
    };

    // What came over a broken stream means nothing any more.
    void drop() {
        connection_.reset();
        splitter_.clear();
        starts_.clear();
        triggers_.clear();
    }
    tl::unexpected<Error> fail(Error error) {
        drop();
        if (error.where.empty() || error.where.find(':') == std::string::npos) error.where = where_;
        return tl::unexpected(std::move(error));
    }
    static Timeout left(Clock::time_point until) {
        return std::max(Timeout(0), std::chrono::ceil<Timeout>(until - Clock::now()));
    }
    static Expected<void> only_error(const Expected<EkiTelegram>& answer) {
        if (!answer) return tl::unexpected(answer.error());
        return {};
    }

    // The controller's connection; others are closed and told.
    Expected<TcpConnection> accept(Clock::time_point until) {
        for (;;) {
            auto connection = listener_.accept(left(until));
            if (!connection || robot_address_.empty()) return connection;
            const std::string peer = connection->peer();
            if (peer.substr(0, peer.rfind(':')) == robot_address_) return connection;
            ++strangers_;
            stranger_ = peer;
        }
    }

    // A connection whose hello has come.
    Expected<void> connected(Clock::time_point until) {
        if (auto newer = accept(Clock::now())) {
            drop();
            connection_.emplace(std::move(*newer));
        }
        if (connection_ && greeted_ && connection_->is_open()) return {};
        if (!connection_ || !connection_->is_open()) {
            drop();
            auto accepted = accept(until);
            if (!accepted)
                return device_error(std::string(kNoAnswer) + ": no robot has connected", where_,
                                    "start SEAMWRIGHT_SERVE on the controller");
            connection_.emplace(std::move(*accepted));
        }
        greeted_ = false;
        auto hello = receive(until);
        if (!hello) return tl::unexpected(hello.error());
        if (hello->kind != "hello" || hello->name.empty())
            return fail({ErrorKind::device, "the robot did not say who it is", where_,
                         "load seamwright.src of this version on the controller"});
        hello_ = std::move(*hello);
        greeted_ = true;
        return {};
    }

    // The next telegram. Silence in the middle of one breaks the stream; between two it does not.
    Expected<EkiTelegram> receive(Clock::time_point until) {
        std::string document;
        while (!splitter_.next(document)) {
            std::array<char, 4096> buffer;
            const auto got =
                connection_->receive_some(std::as_writable_bytes(std::span(buffer)), left(until));
            if (!got) {
                if (!is_silence(got.error())) return fail(got.error());
                if (splitter_.in_the_middle())
                    return fail({ErrorKind::device,
                                 std::string(kNoAnswer) + ": a telegram broke off in the middle", where_,
                                 "check the connection to the controller"});
                return tl::unexpected(got.error());
            }
            if (auto added = splitter_.add({buffer.data(), *got}); !added) return fail(added.error());
        }
        auto telegram = parse_eki_telegram(document);
        if (!telegram) return fail(telegram.error());
        return telegram;
    }

    // Start signals and triggers come at any time; they are kept in order.
    Expected<bool> keep_event(EkiTelegram& telegram) {
        if (telegram.kind != "start" && telegram.kind != "trigger") return false;
        auto& events = telegram.kind == "start" ? starts_ : triggers_;
        if (events.size() >= 1000) return fail({ErrorKind::device, "1000 events wait unread", where_, ""});
        events.push_back({std::move(telegram), now_ns()});
        return true;
    }

    Expected<Event> wait_event(std::deque<Event>& events, Clock::time_point until) {
        if (auto ready = connected(std::max(until, Clock::now())); !ready)
            return tl::unexpected(ready.error());
        while (events.empty()) {
            auto telegram = receive(until);
            if (!telegram) return tl::unexpected(telegram.error());
            if (telegram->kind == "error")
                return device_error("the controller reports: " + telegram->text, where_);
            if (telegram->kind == "done" && &events == &triggers_)
                return device_error("the measuring program has ended", where_);
            if (auto kept = keep_event(*telegram); !kept) return tl::unexpected(kept.error());
        }
        Event event = std::move(events.front());
        events.pop_front();
        return event;
    }

    Expected<EkiTelegram> ask(EkiTelegram command) {
        const auto until = Clock::now() + timeout_;
        if (auto ready = connected(until); !ready) return tl::unexpected(ready.error());
        command.id = ++last_id_;
        if (auto sent = connection_->send(bytes_of(write_eki("Sensor", command)), left(until)); !sent)
            return fail(sent.error());
        for (;;) {
            auto telegram = receive(until);
            if (!telegram) return telegram;
            auto kept = keep_event(*telegram);
            if (!kept) return tl::unexpected(kept.error());
            if (*kept || telegram->id < command.id) continue;  // an answer given too late
            if (telegram->kind == "error" && telegram->id == command.id)
                return device_error(
                    fmt::format("the controller refuses \"{}\": {}", command.kind, telegram->text), where_);
            if (telegram->kind != "answer" || telegram->id != command.id || telegram->name != command.name)
                return fail(
                    {ErrorKind::device,
                     fmt::format("the controller answered \"{} {} {}\" to \"{} {} {}\"", telegram->kind,
                                 telegram->id, telegram->name, command.kind, command.id, command.name),
                     where_, "load seamwright.src of this version on the controller"});
            return telegram;
        }
    }

    TcpListener listener_;
    const std::string where_;
    const std::string robot_address_;
    const Timeout timeout_;
    std::uint64_t strangers_ = 0;  // since they were told
    std::string stranger_;
    std::optional<TcpConnection> connection_;
    EkiSplitter splitter_{"Robot"};
    EkiTelegram hello_;
    bool greeted_ = false;
    std::deque<Event> starts_, triggers_;
    std::int64_t last_id_ = 0, last_trigger_ = 0;
};

}  // namespace

Expected<std::unique_ptr<RobotLink>> open_kuka_eki(const nlohmann::json& settings, DeviceSession&) {
    std::string listen = "127.0.0.1", robot_address;
    int port = 54600, timeout_ms = 1000;
    SettingsReader f(settings, "settings");
    f.only({"listen", "port", "robot_address", "timeout_ms", "trigger_output", "flag_alive", "flag_command"});
    f.text("listen", listen);
    f.text("robot_address", robot_address);
    f.whole("port", port, 0, 65535);
    f.whole("timeout_ms", timeout_ms, 10, 60000);
    if (f.failed()) return tl::unexpected(f.error());
    if (auto known = check_robot_address(listen, robot_address); !known) return tl::unexpected(known.error());
    auto listener = TcpListener::listen(listen, static_cast<std::uint16_t>(port));
    if (!listener) return tl::unexpected(listener.error());
    const std::string where = fmt::format("{}:{}", listen, listener->port());
    return std::make_unique<EkiLink>(std::move(*listener), where, robot_address, Timeout(timeout_ms));
}

}  // namespace seamwright
