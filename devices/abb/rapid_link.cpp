#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <set>
#include <thread>

#include "devices/abb/rapid.h"
#include "devices/abb/rapid_message.h"
#include "devices/backoff.h"
#include "devices/exchange/settings.h"
#include "devices/host_time.h"
#include "devices/net/socket.h"
#include "devices/robot_program.h"
#include "devices/same_robot.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

using abb::Message;
using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::milliseconds;

constexpr std::size_t kEventLimit = 10000;  // events waiting: a controller that floods is refused
constexpr Milliseconds kAlive{500};         // so often a link that waits is heard
// SW_Teach: 100 mm/s and, of the zone of that speed, at least 45 degree/s; the speed may be overridden down
// to 20 %.
constexpr double kTeachSpeed_mm_s = 100, kTeachTurn_deg_s = 45, kSlowest = 0.2;

struct LinkSettings {
    std::string address;
    std::uint16_t port = 0;
    Milliseconds timeout{}, move_timeout{}, reconnect{}, reconnect_most{};
};

Expected<LinkSettings> parse_link_settings(const nlohmann::json& json) {
    LinkSettings s;
    SettingsReader f(json, "settings of abb-rapid", abb_rapid_settings());
    f.text("address", s.address);
    f.whole("port", s.port);
    f.duration("timeout_ms", s.timeout);
    f.duration("move_timeout_ms", s.move_timeout);
    f.duration("reconnect_ms", s.reconnect);
    f.duration("reconnect_most_ms", s.reconnect_most);
    if (f.failed()) return tl::unexpected(f.error());
    return s;
}

class AbbRapidLink final : public RobotLink {
  public:
    explicit AbbRapidLink(LinkSettings settings)
        : settings_(std::move(settings)),
          where_(fmt::format("abb-rapid {}:{}", settings_.address, settings_.port)) {}

    Expected<RobotIdentity> identity() override {
        auto now = ask_identity();
        if (!now) return now;
        return robot_.told(*now);
    }

    Expected<RobotMode> mode() override {
        SEAM_TRY(auto answer, ask({0, "MODE", {}, {}, {}}, settings_.timeout));
        const auto& f = answer.fields;
        const auto one_of = [&](std::size_t i, std::initializer_list<std::string_view> known) {
            return i < f.size() && std::find(known.begin(), known.end(), f[i]) != known.end();
        };
        if (f.size() != 3 || !one_of(0, {"AUTO", "MANR", "MANF", "UNDEF"}) ||
            !one_of(1, {"ON", "OFF", "STOP", "ESTOP"}) || !one_of(2, {"RUN", "HALT"}))
            return broken(
                fmt::format("the controller tells a mode that does not exist: \"{}\"", fmt::join(f, " ")));
        if (f[1] == "ESTOP") return RobotMode::fault;
        if (f[1] != "ON" || f[2] != "RUN") return RobotMode::stopped;
        if (f[0] == "AUTO") return RobotMode::automatic;
        if (f[0] == "MANR") return RobotMode::manual_reduced;
        if (f[0] == "MANF") return RobotMode::manual_full;
        return RobotMode::unknown;
    }

    Expected<Pose> base_from_flange() override {
        return pose_of(ask({0, "POSE", {}, {}, {}}, settings_.timeout));
    }

    Expected<StartSignal> wait_start(Milliseconds timeout) override {
        const auto until = Clock::now() + timeout;
        for (;;) {
            if (!starts_.empty()) {
                StartSignal start = std::move(starts_.front());
                starts_.pop_front();
                return start;
            }
            SEAM_OK(next_event(until));
        }
    }

    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        std::vector<std::string> names;
        for (const MeasuringMove& move : moves) {
            if (!abb::is_spot_name(move.spot_id))
                return input_error(Text("\"{}\" is no name for a spot on an ABB controller", move.spot_id),
                                   where_,
                                   "use at most 32 characters without blanks, quotes and backslashes");
            names.push_back(move.spot_id);
        }
        SEAM_OK(connected());
        next_trigger_ = 0;  // until the answer every trigger and end is of the measuring before
        SEAM_OK(ask({0, "MEASURE", {std::to_string(names.size()), program_signature(moves)}, {}, {}},
                    settings_.timeout));
        triggers_.clear();
        written_.clear();
        ended_ = false;
        next_trigger_ = 1;
        starts_.clear();  // whatever was called for before is what is measured now
        return {};
    }

    Expected<TriggerEvent> wait_trigger(Milliseconds timeout) override {
        const auto until = Clock::now() + timeout;
        for (;;) {
            if (!triggers_.empty()) {
                TriggerEvent trigger = std::move(triggers_.front());
                triggers_.pop_front();
                return trigger;
            }
            if (ended_) return device_error("the measuring program has ended", where_);
            if (next_trigger_ == 0)
                return device_error("the connection was lost while the part was measured", where_,
                                    "measure the part again");
            SEAM_OK(next_event(until));
        }
    }

    Expected<Pose> read_frame(const std::string& name) override {
        SEAM_OK(check_frame_name(name));
        return pose_of(ask({0, "READ", {name}, {}, {}}, settings_.timeout));
    }

    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        SEAM_OK(check_frame_name(name));
        Message request{0, "WRITE", {name}, {}, {}};
        SEAM_OK(put_pose(request, base_from_frame));
        SEAM_OK(same_robot());
        SEAM_OK(pose_of(ask(std::move(request), settings_.timeout)));
        written_.insert(name);
        return {};
    }

    Expected<void> confirm(PartVerdict verdict, const std::string& text) override {
        const char* word = verdict == PartVerdict::corrected ? "CORRECTED"
                           : verdict == PartVerdict::refused ? "REFUSED"
                                                             : "FAILED";
        std::vector<std::string> fields = {word};
        if (verdict == PartVerdict::corrected) {
            SEAM_OK(same_robot());
            fields.push_back(std::to_string(written_.size()));
        }
        SEAM_OK(ask({0, "VERDICT", std::move(fields), text, {}}, settings_.timeout));
        if (verdict != PartVerdict::corrected) written_.clear();  // as on the controller
        return {};
    }

    Expected<Permission> permission() override {
        SEAM_TRY(auto answer, ask({0, "PERMIT", {}, {}, {}}, settings_.timeout));
        for (const auto& [word, permission] : {std::pair{"NONE", Permission::none},
                                               {"GIVEN", Permission::given},
                                               {"TAKEN", Permission::taken}})
            if (answer.fields == std::vector<std::string>{word}) return permission;
        return broken(fmt::format("the controller tells a permission that does not exist: \"{}\"",
                                  fmt::join(answer.fields, " ")));
    }

    bool can_move() const override { return true; }
    Expected<void> move_to(const Pose& base_from_flange) override {
        Message request{0, "MOVE", {}, {}, {}};
        SEAM_OK(put_pose(request, base_from_flange));
        SEAM_OK(same_robot());
        SEAM_TRY(auto from, this->base_from_flange());
        const double way_s = std::max(distance_mm(from, base_from_flange) / kTeachSpeed_mm_s,
                                      deg_from_rad(angle_rad(from, base_from_flange)) / kTeachTurn_deg_s);
        SEAM_OK(ask(std::move(request),
                    settings_.move_timeout + Milliseconds(static_cast<long>(1000 * way_s / kSlowest))));
        SEAM_OK(standing_at(base_from_flange));
        return {};
    }

  private:
    Expected<RobotIdentity> ask_identity() {
        SEAM_TRY(auto answer, ask({0, "HELLO", {"2"}, {}, {}}, settings_.timeout));
        const auto& version = answer.fields;
        if (version.size() != 1 || (version[0] != "1" && version[0] != "2"))
            return broken("the controller's module speaks another version of the protocol than 1 and 2");
        return RobotIdentity{"abb-rapid", "ABB", answer.line3, answer.line2};
    }
    Expected<void> same_robot() {
        SEAM_OK(connected());
        return robot_.check([this] { return ask_identity(); }, where_);
    }
    Expected<void> check_frame_name(const std::string& name) const {
        if (abb::is_rapid_identifier(name)) return {};
        return input_error(Text("\"{}\" is no name of a work object", name), where_,
                           "use a letter, then letters, digits and _, at most 32 characters");
    }
    Expected<void> put_pose(Message& request, const Pose& pose) const {
        if (!pose.matrix().allFinite() || pose.translation().cwiseAbs().maxCoeff() > 1e5)
            return input_error("the pose is not finite or beyond 1e5 mm", where_);
        abb::set_pose_lines(request, pose);
        return {};
    }
    Expected<Pose> pose_of(Expected<Message> answer) {
        if (!answer) return tl::unexpected(answer.error());
        auto pose = abb::parse_pose_lines(*answer, where_);
        if (!pose) drop();
        return pose;
    }

    void drop() {
        connection_.reset();
        received_.clear();
        starts_.clear();
        triggers_.clear();
        next_trigger_ = 0;
        // Longer and longer while nothing answers: who connects anew at once stands behind itself in the
        // queue.
        back_off_.failed();
    }
    tl::unexpected<Error> broken(Text what) {
        drop();
        return device_error(std::move(what), where_,
                            "the controller's module and this program must speak the same version");
    }
    tl::unexpected<Error> lost(Error error) {
        drop();
        error.where = where_;
        return tl::unexpected(std::move(error));
    }

    // The first call after a loss waits for its turn at most as long as an answer may take.
    Expected<void> connected() {
        if (connection_) return {};
        const auto turn = back_off_.left();
        if (turn > settings_.timeout)
            return device_error(ErrorCode::silence,
                                Text("{}: the next attempt to connect is in {} ms", kNoAnswer, turn.count()),
                                where_);
        if (turn.count() > 0) std::this_thread::sleep_for(turn);
        auto connection = TcpConnection::connect(settings_.address, settings_.port, settings_.timeout);
        if (!connection) {
            back_off_.failed();
            Error error = connection.error();
            error.where = where_;
            return tl::unexpected(error);
        }
        connection_.emplace(std::move(*connection));
        received_.clear();
        triggers_.clear();
        starts_.clear();
        next_trigger_ = 0;
        start_count_.reset();
        robot_.connected_anew();
        return {};
    }

    // The next whole message until `until`.
    // A message that has begun by then is waited for as long as an answer is: a network may cut it anywhere.
    Expected<Message> receive(Clock::time_point until) {
        char buffer[4 * abb::kMessageBytes];
        for (;;) {
            if (received_.size() >= abb::kMessageBytes) {
                auto message =
                    abb::parse_message(std::string_view(received_).substr(0, abb::kMessageBytes), where_);
                received_.erase(0, abb::kMessageBytes);
                begun_ = Clock::now();
                return message;
            }
            const auto end = received_.empty() ? until : std::max(until, begun_ + settings_.timeout);
            const auto left = std::chrono::duration_cast<Milliseconds>(end - Clock::now()) + Milliseconds(1);
            const auto got = connection_->receive_some(std::as_writable_bytes(std::span(buffer)),
                                                       std::max(left, Milliseconds(1)));
            if (!got && (received_.empty() || !is_silence(got.error()))) return tl::unexpected(got.error());
            if (got && received_.empty()) begun_ = Clock::now();
            if (got) received_.append(buffer, *got);
            if (!received_.empty() && received_.size() < abb::kMessageBytes &&
                Clock::now() >= std::max(until, begun_ + settings_.timeout))
                return device_error(ErrorCode::silence, Text("{}: half a message came", kNoAnswer), where_);
        }
    }

    Expected<void> take_event(const Message& event) {
        if (triggers_.size() + starts_.size() >= kEventLimit)
            return device_error("the controller floods with events", where_);
        const auto count = event.fields.empty() ? std::nullopt : abb::parse_count(event.fields.front());
        if (!count) return device_error(Text("an event \"{}\" without its number came", event.word), where_);
        if (event.word == "START") {
            if (start_count_ && *count != *start_count_ + 1)
                return device_error(Text("start signal {} came after {}", *count, *start_count_), where_,
                                    "a start signal was lost; the part has to be started again");
            start_count_ = *count;
            starts_.clear();  // the robot calls for one part at a time: an older call is over
            const std::int64_t now = host_now_ns();
            starts_.push_back({event.line2, now, quiet_ns_ == 0 ? now : quiet_ns_, event.line3});
            return {};
        }
        if (event.word == "END") {
            if (next_trigger_ == 0) return {};
            if (*count + 1 != next_trigger_)
                return device_error(
                    Text("the program ended after {} triggers, of which {} came", *count, next_trigger_ - 1),
                    where_, "a trigger was lost; the part has to be measured again");
            ended_ = true;
            return {};
        }
        if (event.word != "TRIGGER" || event.fields.size() != 3)
            return device_error(Text("the controller sent an unknown event \"{}\"", event.word), where_);
        if (next_trigger_ == 0) return {};  // of a measuring that another connection started
        if (*count != next_trigger_)
            return device_error(Text("trigger {} came instead of {}", *count, next_trigger_), where_,
                                "a trigger was lost; the part has to be measured again");
        SEAM_TRY(auto pose, abb::parse_pose_lines(event, where_));
        ++next_trigger_;
        triggers_.push_back({event.fields[2], host_now_ns(), pose});
        return {};
    }

    // Waits for one event. Silence leaves the connection up unless half a message came. The controller is
    // asked now and then meanwhile, so that each side knows that the other is there.
    Expected<void> next_event(Clock::time_point until) {
        if (auto open = connected(); !open) return tl::unexpected(fell_silent(open.error()));
        const auto slice = std::min(until, std::max(asked_ + kAlive, Clock::now()));
        auto message = receive(slice);
        if (!message) {
            if (!is_silence(message.error()) || !received_.empty()) return lost(fell_silent(message.error()));
            quiet_ns_ = host_now_ns();
            if (Clock::now() >= until) {
                Error error = message.error();
                error.where = where_;
                return tl::unexpected(error);
            }
            SEAM_OK(ask({0, "PING", {}, {}, {}}, settings_.timeout));
            return {};
        }
        if (message->number != 0)
            return broken(fmt::format("answer {} came and nothing was asked", message->number));
        if (auto taken = take_event(*message); !taken) {
            drop();
            return taken;
        }
        return {};
    }

    Expected<Message> ask(Message request, Milliseconds timeout) {
        SEAM_OK(connected());
        number_ = number_ % abb::kHighestNumber + 1;
        request.number = number_;
        asked_ = Clock::now();
        const auto until = asked_ + timeout;
        if (auto sent = connection_->send(bytes_of(abb::message_bytes(request)), timeout); !sent)
            return lost(sent.error());
        for (;;) {
            auto message = receive(until);
            if (!message) return lost(message.error());
            if (message->number == 0) {
                if (auto taken = take_event(*message); !taken) {
                    drop();
                    return tl::unexpected(taken.error());
                }
                continue;
            }
            if (message->number != request.number)
                return broken(fmt::format("answer {} came to request {}", message->number, request.number));
            back_off_.worked();  // it answers: the next loss begins with the shortest wait
            quiet_ns_ = host_now_ns();
            if (message->word == "NO")
                return device_error(Text("the controller refuses {}: {}", request.word, message->line2),
                                    where_);
            if (message->word != request.word)
                return broken(fmt::format("the answer to {} is one to {}", request.word, message->word));
            if ((request.word == "READ" || request.word == "WRITE" || request.word == "VERDICT") &&
                (message->fields.empty() || message->fields.front() != request.fields.front()))
                return broken(fmt::format("the answer to {} {} names \"{}\"", request.word,
                                          request.fields.front(), fmt::join(message->fields, " ")));
            return message;
        }
    }

    const LinkSettings settings_;
    const std::string where_;
    std::optional<TcpConnection> connection_;
    std::string received_;
    Clock::time_point begun_;  // when the message at the front of it began to come
    std::deque<StartSignal> starts_;
    std::deque<TriggerEvent> triggers_;
    // Frames of the part that is measured, whatever connection they were written over: what the controller holds of them it
    // loses with a connection and with a verdict.
    std::set<std::string> written_;
    bool ended_ = false;
    std::uint32_t number_ = 0, next_trigger_ = 0;  // 0 = no measuring of this connection
    std::optional<std::uint32_t> start_count_;
    SameRobot robot_;
    std::int64_t quiet_ns_ = 0;  // when nothing more was waiting to be heard; 0 = never
    Clock::time_point asked_{};
    Backoff back_off_{settings_.reconnect, settings_.reconnect_most};
};

}  // namespace

const SettingTable& abb_rapid_settings() {
    static const SettingTable table = entry::joined(
        {entry::text("address", "127.0.0.1", "where the server task listens"),
         entry::whole("port", 1025, 1, 65535, "of the server task"),
         entry::whole("timeout_ms", 1000, 1, 600000, "for a connection and for every answer"),
         entry::whole("move_timeout_ms", 60000, 1, 3600000,
                      "for a move, beyond what its way takes at a fifth of the teaching speed"),
         entry::text("tool", "", "tooldata of T_ROB1 whose load the moves carry, for the program"),
         entry::object("load",
                       {entry::number("mass_kg", nullptr, 0.001, 5000, "mass"),
                        entry::list("centre_mm", nullptr, "centre of gravity [x, y, z] in the flange"),
                        entry::list("inertia_kgm2", nullptr, "moments of inertia [x, y, z]")},
                       "what the flange carries, for the program, in place of tool")},
        entry::reconnect(0, 100, 500, "backoff_ms", "backoff_max_ms"));
    return table;
}

Expected<std::unique_ptr<RobotLink>> open_abb_rapid(const nlohmann::json& settings, DeviceSession&) {
    SEAM_TRY(auto parsed, parse_link_settings(settings));
    return std::make_unique<AbbRapidLink>(std::move(parsed));
}

}  // namespace seamwright
