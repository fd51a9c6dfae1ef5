// Seamwright's end of the EthernetKRL connection.

#include <fmt/format.h>

#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "devices/exchange/settings.h"
#include "devices/host_time.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/eki_telegram.h"
#include "devices/kuka/move_time.h"
#include "devices/kuka/program.h"
#include "devices/net/socket.h"
#include "devices/same_robot.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr Timeout kEkiReadyPoll{30};

constexpr std::size_t kMostNewcomers = 8;
constexpr Timeout kHelloTime{1000}, kLook{10};

class EkiLink final : public RobotLink {
  public:
    EkiLink(TcpListener listener, std::string where, std::string robot_address, Timeout timeout)
        : listener_(std::move(listener)),
          where_(std::move(where)),
          robot_address_(std::move(robot_address)),
          timeout_(timeout) {}

    Expected<RobotIdentity> identity() override {
        SEAM_OK(connected(Clock::now() + timeout_));
        return robot_.told(identity_of(hello_));
    }

    Expected<RobotMode> mode() override {
        SEAM_TRY(auto state, ask({.kind = "state"}));
        auto mode = mode_from_eki(state.mode);
        if (!mode) return fail(mode.error());
        return mode;
    }

    Expected<Pose> base_from_flange() override {
        SEAM_TRY(auto state, ask({.kind = "state"}));
        if (!state.text.empty())
            return device_error(Text("the controller does not know the flange: {}", state.text), where_,
                                "select and start a program on the controller");
        return state.pose;
    }

    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override {
        SEAM_TRY(auto start, wait_event(starts_, Clock::now() + timeout));
        return StartSignal{start.telegram.part, start.time_ns, start.not_before_ns, start.telegram.name};
    }

    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        const EkiTelegram command{.kind = "measure", .name = program_signature(moves)};
        auto started = ask_until_ready(command);
        triggers_.clear();  // the new program's come after its answer
        last_trigger_ = 0;
        measuring_ = started.has_value();
        return only_error(started);
    }

    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override {
        if (!measuring_)
            return device_error("the connection was lost while the part was measured", where_,
                                "measure the part again");
        SEAM_TRY(auto event, wait_event(triggers_, Clock::now() + timeout));
        const EkiTelegram& t = event.telegram;
        if (t.id != last_trigger_ + 1)
            return fail({ErrorKind::device,
                         fmt::format("trigger {} came where trigger {} was due", t.id, last_trigger_ + 1),
                         where_, "measure the part again"});
        ++last_trigger_;
        return TriggerEvent{t.name, event.time_ns, t.pose};
    }

    Expected<Pose> read_frame(const std::string& name) override {
        SEAM_TRY(auto answer, ask({.kind = "read", .name = name}));
        return answer.pose;
    }

    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        if (name.empty() || name.size() > kEkiLongestText)
            return input_error(Text("\"{}\" is no name of a frame", name), where_);
        if (!base_from_frame.matrix().allFinite() ||
            base_from_frame.translation().cwiseAbs().maxCoeff() > 1e5)
            return input_error("the frame is not finite or beyond 100 m", name);
        return only_error(ask_until_ready({.kind = "write", .name = name, .pose = base_from_frame}));
    }

    Expected<void> confirm(PartVerdict verdict, const std::string& text) override {
        confirmed_ = false;
        auto told =
            ask_until_ready({.kind = "confirm", .name = std::string(to_string(verdict)), .text = text});
        confirmed_ = told && verdict == PartVerdict::corrected;
        return only_error(told);
    }

    Expected<Permission> permission() override {
        SEAM_TRY(auto state, ask({.kind = "state"}));
        if (state.part == "taken") return Permission::taken;
        if (state.part == "given") return Permission::given;
        if (state.part == "none") return Permission::none;
        // A module of before this question: what is known is that it acknowledged on this connection.
        return confirmed_ ? Permission::given : Permission::none;
    }

    bool can_move() const override { return true; }
    Expected<void> move_to(const Pose& base_from_flange) override {
        if (!base_from_flange.matrix().allFinite()) return input_error("the pose is not finite", where_);
        SEAM_TRY(auto from, this->base_from_flange());
        SEAM_OK(ask({.kind = "move", .pose = base_from_flange},
                    timeout_ + kuka_move_time(from, base_from_flange)));
        SEAM_OK(standing_at(base_from_flange));
        return {};
    }

    std::vector<Text> take_notices() override {
        auto notices = std::exchange(notices_, {});
        if (strangers_ > 0)
            notices.push_back(Text("{} connections of an unknown peer were refused, the last of {}",
                                   std::exchange(strangers_, 0), stranger_));
        return notices;
    }

  private:
    struct Event {
        EkiTelegram telegram;
        std::int64_t time_ns = 0, not_before_ns = 0;
    };
    // Somebody who has connected and has not said yet who it is.
    struct Newcomer {
        TcpConnection connection;
        Clock::time_point until;
        EkiSplitter splitter{"Robot"};
    };

    // What came over a broken stream means nothing any more.
    void drop() {
        connection_.reset();
        confirmed_ = false;
        splitter_.clear();
        starts_.clear();
        triggers_.clear();
        measuring_ = false;
    }
    tl::unexpected<Error> fail(Error error) {
        drop();
        if (error.where.english().find(':') == std::string::npos) error.where = where_;
        return tl::unexpected(std::move(error));
    }
    static Timeout left(Clock::time_point until) {
        return std::max(Timeout(0), std::chrono::ceil<Timeout>(until - Clock::now()));
    }
    static Expected<void> only_error(const Expected<EkiTelegram>& answer) {
        if (!answer) return tl::unexpected(answer.error());
        return {};
    }

    static RobotIdentity identity_of(const EkiTelegram& hello) {
        return {"kuka-eki", "KUKA", hello.part, hello.name};
    }
    static std::string who(const EkiTelegram& hello, const TcpConnection& connection) {
        return fmt::format("{} at {}", hello.name, connection.peer());
    }

    // Waits until `until` for somebody to connect.
    void welcome(Clock::time_point until) {
        while (auto connection = listener_.accept(left(until))) {
            const std::string peer = connection->peer();
            if (!robot_address_.empty() && peer.substr(0, peer.rfind(':')) != robot_address_) {
                refuse(peer);
            } else {
                if (newcomers_.size() == kMostNewcomers) {  // who came first has had its time
                    refuse(newcomers_.front().connection.peer());
                    newcomers_.erase(newcomers_.begin());
                }
                newcomers_.push_back({std::move(*connection), Clock::now() + std::min(timeout_, kHelloTime)});
            }
            until = Clock::now();
        }
    }
    void refuse(const std::string& peer) {
        ++strangers_;
        stranger_ = peer;
    }

    enum class Said { nothing_yet, hello, nonsense };
    // What a newcomer has said by now.
    Said hear(Newcomer& newcomer, EkiTelegram& hello) {
        std::array<char, 4096> buffer;
        while (const auto got =
                   newcomer.connection.receive_some(std::as_writable_bytes(std::span(buffer)), Timeout(0)))
            if (!newcomer.splitter.add({buffer.data(), *got})) return Said::nonsense;
        if (std::string document; newcomer.splitter.next(document)) {
            auto telegram = parse_eki_telegram(document);
            if (!telegram) misheard_ = telegram.error().what;
            if (!telegram || telegram->kind != "hello" || telegram->name.empty()) return Said::nonsense;
            hello = std::move(*telegram);
            return Said::hello;
        }
        return Clock::now() < newcomer.until ? Said::nothing_yet : Said::nonsense;
    }

    // The robot is who says hello; a connection that says nothing or something else costs it nothing. A
    // second one takes over only when the first does not answer any more.
    void meet() {
        for (auto newcomer = newcomers_.begin(); newcomer != newcomers_.end();) {
            EkiTelegram hello;
            const Said said = hear(*newcomer, hello);
            if (said == Said::nothing_yet) {
                ++newcomer;
                continue;
            }
            const std::string peer = newcomer->connection.peer();
            if (said == Said::nonsense) {
                refuse(peer);
            } else if (connection_ && still_answers()) {
                notices_.push_back(Text("a second robot was refused, {}: the first one answers",
                                        who(hello, newcomer->connection)));
            } else {
                if (connection_)
                    notices_.push_back(Text("{} has taken over from {}, which answers no more",
                                            who(hello, newcomer->connection), who(hello_, *connection_)));
                drop();
                misheard_.reset();
                hello_ = std::move(hello);
                connection_.emplace(std::move(newcomer->connection));
                splitter_ = std::move(newcomer->splitter);
                robot_.connected_anew();
            }
            newcomer = newcomers_.erase(newcomer);
        }
    }
    bool still_answers() {
        const bool answers =
            exchange({.kind = "state"}, Clock::now() + std::min(timeout_, kHelloTime)).has_value();
        return answers && connection_;
    }

    // A connection whose hello has come.
    Expected<void> connected(Clock::time_point until) {
        for (welcome(Clock::now());; welcome(std::min(until, Clock::now() + kLook))) {
            meet();
            if (connection_ && connection_->is_open()) return {};
            if (Clock::now() >= until && misheard_)
                return device_error(ErrorCode::silence,
                                    Text("{}: {} has connected, but its first telegram {}", kNoAnswer,
                                         stranger_, *std::exchange(misheard_, std::nullopt)),
                                    where_, "load the files of `seamwright robot-program` on the controller");
            if (Clock::now() >= until)
                return device_error(ErrorCode::silence, Text("{}: no robot has connected", kNoAnswer), where_,
                                    "start SEAMWRIGHT_SUB in the controller's submit interpreter");
        }
    }

    // The next telegram. Silence in the middle of one breaks the stream; between two it does not. One that has begun is waited
    // for as long as an answer is: a network may cut it anywhere.
    Expected<EkiTelegram> receive(Clock::time_point until) {
        std::string document;
        while (!splitter_.next(document)) {
            std::array<char, 4096> buffer;
            const bool middle = splitter_.in_the_middle();
            const auto end = middle ? std::max(until, begun_ + timeout_) : until;
            const auto got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)), left(end));
            if (!got) {
                if (!is_silence(got.error())) return fail(got.error());
                if (middle && Clock::now() < end) continue;
                if (middle)
                    return fail({ErrorKind::device, Text("{}: a telegram broke off in the middle", kNoAnswer),
                                 where_, "check the connection to the controller", ErrorCode::silence});
                quiet_ns_ = host_now_ns();
                return tl::unexpected(got.error());
            }
            if (!middle) begun_ = Clock::now();
            if (auto added = splitter_.add({buffer.data(), *got}); !added) return fail(added.error());
        }
        begun_ = Clock::now();
        auto telegram = parse_eki_telegram(document);
        if (!telegram) return fail(telegram.error());
        return telegram;
    }

    // Start signals and triggers come at any time; they are kept in order.
    Expected<bool> keep_event(EkiTelegram& telegram) {
        if (telegram.kind != "start" && telegram.kind != "trigger") return false;
        auto& events = telegram.kind == "start" ? starts_ : triggers_;
        if (events.size() >= 1000) return fail({ErrorKind::device, "1000 events wait unread", where_, ""});
        const std::int64_t now = host_now_ns();
        events.push_back({std::move(telegram), now, quiet_ns_ == 0 ? now : quiet_ns_});
        return true;
    }

    Expected<Event> wait_event(std::deque<Event>& events, Clock::time_point until) {
        if (auto ready = connected(std::max(until, Clock::now())); !ready)
            return tl::unexpected(fell_silent(ready.error()));
        while (events.empty()) {
            auto telegram = receive(until);
            if (!telegram)
                return tl::unexpected(connection_ ? telegram.error() : fell_silent(telegram.error()));
            if (telegram->kind == "error")
                return device_error(Text("the controller reports: {}", telegram->text), where_);
            if (telegram->kind == "done" && &events == &triggers_)
                return device_error("the measuring program has ended", where_);
            SEAM_OK(keep_event(*telegram));
        }
        Event event = std::move(events.front());
        events.pop_front();
        return event;
    }

    // As ask(), again while the controller is about to be ready; all within one time-out.
    Expected<EkiTelegram> ask_until_ready(const EkiTelegram& command) {
        for (const auto until = Clock::now() + timeout_;;) {
            auto answer = ask(command);
            if (answer || answer.error().code != ErrorCode::not_ready ||
                Clock::now() + kEkiReadyPoll >= until)
                return answer;
            std::this_thread::sleep_for(kEkiReadyPoll);
        }
    }

    Expected<EkiTelegram> ask(EkiTelegram command) { return ask(std::move(command), timeout_); }
    Expected<EkiTelegram> ask(EkiTelegram command, Timeout timeout) {
        const auto until = Clock::now() + timeout;
        SEAM_OK(connected(until));
        static const std::set<std::string, std::less<>> kHarmless = {"state", "read"};
        const bool harmless =
            kHarmless.contains(command.kind) ||
            (command.kind == "confirm" && command.name != to_string(PartVerdict::corrected));
        if (!harmless)
            if (auto same =
                    robot_.check([&] { return Expected<RobotIdentity>(identity_of(hello_)); }, where_);
                !same)
                return tl::unexpected(same.error());
        return exchange(std::move(command), until);
    }

    // Command and answer on the connection that there is.
    Expected<EkiTelegram> exchange(EkiTelegram command, Clock::time_point until) {
        command.id = ++last_id_;
        if (auto sent = connection_->send(bytes_of(write_eki("Sensor", command)), left(until)); !sent)
            return fail(sent.error());
        for (;;) {
            auto telegram = receive(until);
            if (!telegram) return telegram;
            SEAM_TRY(auto kept, keep_event(*telegram));
            if (kept || telegram->id < command.id) continue;  // an answer given too late
            if (telegram->kind == "error" && telegram->id == command.id)
                return device_error(
                    telegram->text.starts_with(kEkiNotReady) ? ErrorCode::not_ready : ErrorCode::none,
                    Text("the controller refuses \"{}\": {}",
                         command.kind == "read" || command.kind == "write" ? command.kind + " " + command.name
                                                                           : command.kind,
                         telegram->text),
                    where_);
            if (telegram->kind != "answer" || telegram->id != command.id || telegram->name != command.name)
                return fail(
                    {ErrorKind::device,
                     fmt::format("the controller answered \"{} {} {}\" to \"{} {} {}\"", telegram->kind,
                                 telegram->id, telegram->name, command.kind, command.id, command.name),
                     where_, "load seamwright_sub.sub of this version on the controller"});
            quiet_ns_ = host_now_ns();
            return telegram;
        }
    }

    TcpListener listener_;
    const std::string where_;
    const std::string robot_address_;
    const Timeout timeout_;
    std::uint64_t strangers_ = 0;  // since they were told
    std::string stranger_;
    std::optional<Text> misheard_;  // why a newcomer's first telegram was none
    std::vector<Text> notices_;
    std::vector<Newcomer> newcomers_;
    std::optional<TcpConnection> connection_;  // has said hello
    EkiSplitter splitter_{"Robot"};
    Clock::time_point begun_;  // when what is in the splitter began to come
    EkiTelegram hello_;
    SameRobot robot_;
    bool measuring_ = false;     // started on this connection
    std::int64_t quiet_ns_ = 0;  // when nothing more was waiting to be heard; 0 = never
    bool confirmed_ = false;     // "corrected", on this connection
    std::deque<Event> starts_, triggers_;
    std::int64_t last_id_ = 0, last_trigger_ = 0;
};

}  // namespace

const SettingTable& kuka_eki_settings() {
    static const SettingTable table =
        entry::joined({entry::text("listen", "127.0.0.1", "this computer's address in the robot's network"),
                       entry::whole("port", 54600, 0, 65535, "where the controller connects to"),
                       entry::text("robot_address", "",
                                   "the controller's; must be named unless listen is a loopback address"),
                       entry::whole("timeout_ms", 1000, 10, 60000, "for a connection and for every answer")},
                      kuka_program_settings());
    return table;
}

Expected<std::unique_ptr<RobotLink>> open_kuka_eki(const nlohmann::json& settings, DeviceSession&) {
    std::string listen, robot_address;
    int port = 0, timeout_ms = 0;
    SettingsReader f(settings, "settings", kuka_eki_settings());
    f.text("listen", listen);
    f.text("robot_address", robot_address);
    f.whole("port", port);
    f.whole("timeout_ms", timeout_ms);
    if (f.failed()) return tl::unexpected(f.error());
    SEAM_OK(check_robot_address(listen, robot_address));
    SEAM_TRY(auto listener, TcpListener::listen(listen, static_cast<std::uint16_t>(port)));
    const std::string where = fmt::format("{}:{}", listen, listener.port());
    return std::make_unique<EkiLink>(std::move(listener), where, robot_address, Timeout(timeout_ms));
}

}  // namespace seamwright
