// Seamwright's end of a KUKAVARPROXY connection.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <thread>
#include <utility>

#include "devices/backoff.h"
#include "devices/exchange/settings.h"
#include "devices/host_time.h"
#include "devices/kuka/kvp.h"
#include "devices/kuka/kvp_message.h"
#include "devices/kuka/move_time.h"
#include "devices/kuka/program.h"
#include "devices/net/socket.h"
#include "devices/robot_program.h"
#include "devices/same_robot.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;

struct KvpSettings {
    std::string address;
    int port = 0, timeout_ms = 0, poll_ms = 0, reconnect_ms = 0, reconnect_most_ms = 0;
};

class KvpLink final : public RobotLink {
  public:
    explicit KvpLink(KvpSettings settings)
        : settings_(std::move(settings)),
          where_(fmt::format("{}:{}", settings_.address, settings_.port)),
          timeout_(settings_.timeout_ms),
          back_off_(Timeout(settings_.reconnect_ms), Timeout(settings_.reconnect_most_ms)) {}

    Expected<RobotIdentity> identity() override {
        auto now = ask_identity();
        if (!now) return now;
        return robot_.told(*now);
    }

    Expected<RobotMode> mode() override {
        SEAM_TRY(auto values, read({"$STOPMESS", "$MODE_OP"}));
        auto stopped = bool_from_krl(values[0]);
        if (!stopped) return fail(stopped.error());
        static const std::map<std::string, RobotMode> kKvpModes = {{"#T1", RobotMode::manual_reduced},
                                                                   {"#T2", RobotMode::manual_full},
                                                                   {"#AUT", RobotMode::automatic},
                                                                   {"#EX", RobotMode::external}};
        const auto mode = kKvpModes.find(string_from_krl(values[1]));
        if (mode == kKvpModes.end())
            return fail(
                {ErrorKind::device, "\"" + values[1].substr(0, 20) + "\" is no operating mode", where_, ""});
        return *stopped ? RobotMode::stopped : mode->second;
    }

    // $POS_ACT is the active tool in the active base, those of the main run; both are read before and after
    // it.
    Expected<Pose> base_from_flange() override {
        constexpr int kAttempts = 5;
        const std::string suffix = main_run_suffix();
        const std::string base = "$BASE" + suffix, tool = "$TOOL" + suffix, mode = "$IPO_MODE" + suffix;
        for (int i = 0; i < kAttempts; ++i) {
            SEAM_TRY(auto answers, try_read({mode, base, tool, "$POS_ACT", base, tool}));
            if (answers[0].done && string_from_krl(answers[0].value) == "#TCP")
                return device_error("the tool is fixed in the cell ($IPO_MODE #TCP): the flange is not told",
                                    where_, "select a program whose tool is on the robot");
            std::vector<Pose> poses;
            for (std::size_t k = 1; k < answers.size(); ++k) {
                const KvpAnswer& a = answers[k];
                static const std::array<const char*, 5> names = {"$BASE", "$TOOL", "$POS_ACT", "$BASE",
                                                                 "$TOOL"};
                if (!a.done)
                    return device_error(Text("the controller refuses to read {}", names[k - 1]), where_,
                                        "select and start a program, so that tool and base are active");
                auto pose = frame_from_krl(a.value);
                if (!pose) return fail(pose.error());
                poses.push_back(*pose);
            }
            const auto same = [](const Pose& a, const Pose& b) { return a.isApprox(b, 1e-12); };
            if (same(poses[0], poses[3]) && same(poses[1], poses[4]))
                return poses[0] * poses[2] * poses[1].inverse();
        }
        return device_error("tool or base changed while the flange was read", where_, "read it again");
    }

    Expected<StartSignal> wait_start(std::chrono::milliseconds timeout) override {
        SEAM_OK(poll_until(timeout, [&] { return called_now(); }));
        SEAM_TRY(auto part, read({"SW_PART[]"}));
        SEAM_TRY(auto type, try_read({"SW_TYPE[]"}));  // a module of before it has none
        SEAM_OK(begin_part());
        SEAM_OK(write({{"SW_CALL", "FALSE"}}));
        // A module of before SW_CALLED refuses that, and a call that is lost with its connection stays lost.
        if (auto noted = try_write({{"SW_CALLED", "TRUE"}}); !noted && !connection_)
            return tl::unexpected(noted.error());
        call_taken_here_ = true;
        const std::string id = string_from_krl(part[0]);
        const std::int64_t now = host_now_ns();
        std::string part_type = type[0].done ? string_from_krl(type[0].value) : "";
        if (part_type == "-") part_type.clear();
        return StartSignal{id == "-" ? "" : id, now, std::exchange(quiet_ns_, now), std::move(part_type)};
    }

    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        told_ = 0;
        SEAM_OK(write({{"SW_RELEASED", "FALSE"}}));
        SEAM_TRY(auto state, read({"$STOPMESS"}));
        auto stopped = bool_from_krl(state[0]);
        if (!stopped) return fail(stopped.error());
        if (*stopped) return device_error("the robot is stopped", where_, "start it on its controller");
        // The application may be on its way out of the last part: a part without a verdict is given up.
        bool given_up = false;
        auto idle = poll_until(timeout_, [&]() -> Expected<bool> {
            SEAM_TRY(auto answers, try_read({"SW_WAITS", "SW_BUSY", "SW_TAKEN", "SW_TAKING"}));
            if (!answers[0].done) {  // a module of before SW_WAITS
                auto busy = truth("SW_BUSY", answers[1]);
                if (!busy) return busy;
                return !*busy;
            }
            auto waits = truth("SW_WAITS", answers[0]), busy = truth("SW_BUSY", answers[1]),
                 taken = truth("SW_TAKEN", answers[2]), taking = truth("SW_TAKING", answers[3]);
            for (const auto* answer : {&waits, &busy, &taken, &taking})
                if (!*answer) return *answer;
            if (!*waits && !*busy && !*taken && !*taking && !std::exchange(given_up, true))
                SEAM_OK(try_write({{"SW_VERDICT", "4"}}));
            return waits;
        });
        if (!idle && is_silence(idle.error()) && connection_)
            return device_error("no program waits in SEAMWRIGHT_SPOTS", where_,
                                "start the application on the controller");
        if (!idle) return idle;
        auto signature = read({"SW_SIGNATURE[]"});  // set by the application before it waits
        if (!signature) return tl::unexpected(signature.error());
        if (string_from_krl((*signature)[0]) != program_signature(moves))
            return device_error("another measuring program is loaded than the project's", where_,
                                "load the one that `seamwright robot-program` writes");
        SEAM_OK(begin_part());
        SEAM_OK(write({{"SW_FIRED", "0"}, {"SW_GO", "TRUE"}}));
        auto gone = poll_until(timeout_, [&]() -> Expected<bool> {
            auto waits_to_go = read_bool("SW_GO");
            if (!waits_to_go) return waits_to_go;
            return !*waits_to_go;
        });
        if (gone || !is_silence(gone.error()) || !connection_) return gone;
        SEAM_OK(write({{"SW_GO", "FALSE"}}));
        return device_error("the program that waited did not go on", where_,
                            "start the application on the controller");
    }

    Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) override {
        SEAM_OK(poll_until(timeout, [&]() -> Expected<bool> {
            SEAM_TRY(auto count, read_int("SW_FIRED"));
            if (count < told_ || count > 64)
                return fail({ErrorKind::device,
                             fmt::format("the controller counts {} triggers after {}", count, told_), where_,
                             "measure the part again"});
            return count > told_;
        }));
        const std::int64_t heard_ns = host_now_ns();
        ++told_;  // the module keeps all of a program, so none is lost between two polls
        SEAM_TRY(auto values,
                 read({fmt::format("SW_SPOT[{},]", told_), fmt::format("SW_SPOT_AT[{}]", told_)}));
        auto pose = frame_from_krl(values[1]);
        if (!pose) return fail(pose.error());
        return TriggerEvent{string_from_krl(values[0]), heard_ns, *pose};
    }

    Expected<Pose> read_frame(const std::string& name) override {
        SEAM_TRY(auto variable, frame_variable(name));
        return read_pose(variable);
    }

    Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) override {
        if (!base_from_frame.matrix().allFinite() ||
            base_from_frame.translation().cwiseAbs().maxCoeff() > 1e5)
            return input_error("the frame is not finite or beyond 100 m", name);
        SEAM_TRY(auto variable, frame_variable(name));
        SEAM_OK(same_robot());
        SEAM_OK(withdraw());
        return write({{variable, krl_from_frame(base_from_frame)}});
    }

    Expected<void> confirm(PartVerdict verdict, const std::string&) override {
        const bool released = verdict == PartVerdict::corrected;
        if (released) SEAM_OK(same_robot());
        if (auto ready = withdraw(); !ready) {
            // Said once more to an application that runs already: nothing changes.
            if (auto now = permission(); released && now && *now == Permission::taken) return {};
            return ready;
        }
        const char* number = released ? "1" : verdict == PartVerdict::refused ? "2" : "3";
        SEAM_OK(try_write({{"SW_VERDICT", number}}));
        if (verdict == PartVerdict::refused) SEAM_OK(call_again());
        if (!released) {
            (void)called_now();  // from here on the next call is as old as it is heard
            return {};
        }
        SEAM_OK(write({{"SW_RELEASED", "TRUE"}}));
        SEAM_TRY(auto back, permission());
        if (back == Permission::none) return device_error("the controller did not keep the verdict", where_);
        (void)called_now();  // from here on the next call is as old as it is heard; its Error is the next
                             // call's
        return {};
    }

    Expected<Permission> permission() override {
        SEAM_TRY(auto answers, try_read({"SW_TAKEN", "SW_RELEASED"}));
        if (answers[0].done) {
            SEAM_TRY(auto taken, truth("SW_TAKEN", answers[0]));
            if (taken) return Permission::taken;
        }
        SEAM_TRY(auto released, truth("SW_RELEASED", answers[1]));
        return released ? Permission::given : Permission::none;
    }

    bool can_move() const override { return true; }
    Expected<void> move_to(const Pose& base_from_flange) override {
        if (!base_from_flange.matrix().allFinite()) return input_error("the pose is not finite", where_);
        SEAM_OK(same_robot());
        SEAM_TRY(auto now, mode());
        SEAM_TRY(auto runs, teaching_runs());
        SEAM_TRY(auto program, read({"$PRO_NAME1[]"}));
        std::string name = string_from_krl(program[0]);
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return std::toupper(c); });
        if (now != RobotMode::manual_reduced || !runs || name != "SEAMWRIGHT")
            return device_error("moving by command wants T1 with the program SEAMWRIGHT running", where_);
        SEAM_TRY(auto from, this->base_from_flange());
        auto moved = move_from(from, base_from_flange);
        // What has failed is not driven by the next start key. Whether that can be written is not asked: the
        // move's own Error counts.
        if (!moved) (void)try_write({{"SW_MOVE", "FALSE"}});
        SEAM_OK(moved);
        SEAM_OK(standing_at(base_from_flange));
        return {};
    }

  private:
    // The program goes on by itself: drives are ready and no start key is missing.
    Expected<bool> teaching_runs() {
        SEAM_TRY(auto values, read({"$PERI_RDY", "$PRO_STATE1"}));
        auto ready = bool_from_krl(values[0]);
        if (!ready) return fail(ready.error());
        return *ready && string_from_krl(values[1]) == "#P_ACTIVE";
    }
    Expected<void> move_from(const Pose& from, const Pose& to) {
        // A flag whose goal was refused would send the robot to the last one.
        SEAM_OK(write({{"SW_MOVE_TO", krl_from_frame(to)}}));
        SEAM_TRY(auto number, try_read({"SW_MOVE_NO"}));
        if (number[0].done) {  // a module of before it has none
            const auto last = int_from_krl(number[0].value);
            if (!last) return fail(last.error());
            SEAM_OK(write({{"SW_MOVE_NO", std::to_string(*last % 1'000'000 + 1)}}));
        }
        SEAM_OK(write({{"SW_MOVE", "TRUE"}}));
        return poll_until(timeout_ + kuka_move_time(from, to), [&]() -> Expected<bool> {
            SEAM_TRY(auto moving, read_bool("SW_MOVE"));
            if (!moving) return true;
            SEAM_TRY(auto runs, teaching_runs());
            if (!runs) return device_error("the robot was stopped on its way", where_);
            return false;
        });
    }
    Expected<RobotIdentity> ask_identity() {
        SEAM_TRY(auto values, read({"$KR_SERIALNO", "$TRAFONAME[]"}));
        return RobotIdentity{"kuka-kvp", "KUKA", string_from_krl(values[1]), string_from_krl(values[0])};
    }
    Expected<void> same_robot() {
        SEAM_OK(connected());
        return robot_.check([this] { return ask_identity(); }, where_);
    }
    // A refused call of a robot that waits for it still is as good as a new one.
    Expected<void> call_again() {
        SEAM_TRY(auto answers, try_read({"SW_WAITS", "SW_CALLED", "SW_CALLS"}));
        for (const KvpAnswer& answer : answers) {
            if (!answer.done) return {};  // a module of before SW_CALLED
            SEAM_TRY(auto yes, truth("SW_CALLED", answer));
            if (!yes) return {};
        }
        return try_write({{"SW_CALL", "TRUE"}});
    }
    Expected<bool> called_now() {
        SEAM_TRY(auto answers, try_read({"SW_CALL", "SW_WAITS", "SW_CALLED"}));
        auto called = truth("SW_CALL", answers[0]);
        // Taken over a connection that is lost, and not measured: the robot waits for it still.
        if (called && !*called && answers[2].done && !call_taken_here_) {
            auto before = truth("SW_CALLED", answers[2]);
            if (before && *before) called = true;
        }
        if (called && !*called) quiet_ns_ = host_now_ns();
        if (!called || !*called || !answers[1].done) return called;
        return truth("SW_WAITS", answers[1]);  // the program is there to measure it
    }

    static Timeout left(Clock::time_point until) {
        return std::max(Timeout(0), std::chrono::ceil<Timeout>(until - Clock::now()));
    }

    // Back to no connection; answers that are still under way are not taken for later ones.
    tl::unexpected<Error> fail(Error error) {
        connection_.reset();
        call_taken_here_ = false;
        stream_.clear();
        names_.reset();
        main_run_.reset();
        error.where = where_;
        return tl::unexpected(std::move(error));
    }

    Expected<void> connected() {
        if (connection_ && connection_->is_open()) return {};
        auto made = back_off_.attempt([this] {
            return TcpConnection::connect(settings_.address, static_cast<std::uint16_t>(settings_.port),
                                          timeout_);
        });
        if (!made)
            return device_error(ErrorCode::disconnected,
                                Text("{}, the next attempt is due soon", kDisconnected), where_,
                                "check that KUKAVARPROXY runs on the controller");
        if (!*made) return fail(made->error());
        stream_.clear();
        connection_.emplace(std::move(**made));
        robot_.connected_anew();
        return {};
    }

    // One request after the other: servers that take what one receive brings for one message answer the first of several
    // alone. Each answer has the whole time-out.
    Expected<std::vector<KvpAnswer>> ask(std::vector<KvpRequest> requests) {
        SEAM_OK(connected());
        std::vector<KvpAnswer> answers;
        for (KvpRequest& r : requests) {
            r.id = ++last_id_;
            SEAM_TRY(auto answer, ask_one(r));
            answers.push_back(std::move(answer));
        }
        return answers;
    }
    Expected<KvpAnswer> ask_one(const KvpRequest& asked) {
        const auto until = Clock::now() + timeout_;
        if (auto sent = connection_->send(bytes_of(kvp_bytes(asked)), timeout_); !sent)
            return fail(sent.error());
        for (;;) {
            auto answer = take_kvp_answer(stream_);
            if (!answer) return fail(answer.error());
            if (*answer) {
                if ((*answer)->id != asked.id || (*answer)->write != asked.write)
                    return fail({ErrorKind::device,
                                 fmt::format("answer {} came to request {} ({})", (*answer)->id, asked.id,
                                             asked.name),
                                 where_, "only one program may use this connection"});
                return std::move(**answer);
            }
            std::array<char, 4096> buffer;
            const auto got =
                connection_->receive_some(std::as_writable_bytes(std::span(buffer)), left(until));
            if (!got) return fail(got.error());
            stream_.append(buffer.data(), *got);
        }
    }

    Expected<std::vector<std::string>> read(const std::vector<std::string>& names) {
        std::vector<KvpRequest> requests;
        for (const std::string& name : names) requests.push_back({0, false, name, {}});
        SEAM_TRY(auto answers, ask(std::move(requests)));
        std::vector<std::string> values;
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (!answers[i].done)
                return device_error(Text("the controller refuses to read {}", names[i]), where_,
                                    "load seamwright.dat on the controller");
            values.push_back(std::move(answers[i].value));
        }
        return values;
    }

    // The same; what the controller refuses is left to the caller.
    Expected<std::vector<KvpAnswer>> try_read(const std::vector<std::string>& names) {
        std::vector<KvpRequest> requests;
        for (const std::string& name : names) requests.push_back({0, false, name, {}});
        return ask(std::move(requests));
    }
    Expected<void> try_write(const std::vector<std::pair<std::string, std::string>>& values) {
        std::vector<KvpRequest> requests;
        for (const auto& [name, value] : values) requests.push_back({0, true, name, value});
        SEAM_OK(ask(std::move(requests)));
        return {};
    }
    Expected<bool> truth(const char* name, const KvpAnswer& answer) {
        if (!answer.done)
            return device_error(Text("the controller refuses to read {}", name), where_,
                                "load seamwright.dat on the controller");
        auto value = bool_from_krl(answer.value);
        if (!value) return fail(value.error());
        return value;
    }

    // The variables of the main run have _C behind their names; what cannot read them reads those of the
    // advance run, which are the same while the robot stands. Asked once a connection.
    std::string main_run_suffix() {
        if (!main_run_) {
            const auto answers = try_read({"$BASE_C", "$BASE"});
            if (!answers || (!(*answers)[0].done && !(*answers)[1].done)) return "_C";
            main_run_ = (*answers)[0].done;
        }
        return *main_run_ ? "_C" : "";
    }

    // Takes the permission back and says whether that came in time: an application that is taking it, or runs
    // with it, keeps it and its frames (seamwright.src, SW_ACTIVATE).
    Expected<void> withdraw() {
        auto free = poll_until(timeout_, [&]() -> Expected<bool> {
            SEAM_OK(write({{"SW_RELEASED", "FALSE"}}));
            SEAM_TRY(auto answers, try_read({"SW_TAKING", "SW_TAKEN", "SW_WAITS"}));
            if (!answers[0].done) return true;  // a module of before SW_TAKING
            auto taking = truth("SW_TAKING", answers[0]), has = truth("SW_TAKEN", answers[1]),
                 waits = truth("SW_WAITS", answers[2]);
            for (const auto* answer : {&taking, &has, &waits})
                if (!*answer) return *answer;
            return !*taking && (!*has || *waits);
        });
        if (!free && is_silence(free.error()) && connection_)
            return device_error("the application runs with the frames already", where_);
        return free;
    }
    Expected<void> begin_part() {
        SEAM_OK(write({{"SW_RELEASED", "FALSE"}}));
        return try_write({{"SW_TAKEN", "FALSE"}, {"SW_VERDICT", "0"}});
    }

    // In order, up to the first that is refused: what follows may set off what it prepares.
    Expected<void> write(const std::vector<std::pair<std::string, std::string>>& values) {
        for (const auto& [name, value] : values) {
            SEAM_TRY(auto answers, ask({{0, true, name, value}}));
            if (!answers[0].done)
                return device_error(Text("the controller refuses to write {}", name), where_,
                                    "check the operating mode and that the variable is global");
        }
        return {};
    }

    Expected<bool> read_bool(const std::string& name) {
        SEAM_TRY(auto values, read({name}));
        auto value = bool_from_krl(values[0]);
        if (!value) return fail(value.error());
        return value;
    }
    Expected<std::int64_t> read_int(const std::string& name) {
        SEAM_TRY(auto values, read({name}));
        auto value = int_from_krl(values[0]);
        if (!value) return fail(value.error());
        return value;
    }
    Expected<Pose> read_pose(const std::string& variable) {
        SEAM_TRY(auto values, read({variable}));
        auto pose = frame_from_krl(values[0]);
        if (!pose) return fail(pose.error());
        return pose;
    }

    // The module's table, read once a connection; any other name is a variable's own.
    Expected<std::string> frame_variable(const std::string& name) {
        if (name.empty() || name.size() > 79)
            return input_error(Text("\"{}\" is no name of a frame", name), where_);
        // None yet: the application writes them when it begins.
        if (names_ && names_->empty()) names_.reset();
        if (!names_) {
            SEAM_TRY(auto count, ask({{0, false, "SW_FRAMES", {}}}));
            names_.emplace();
            if (count[0].done) {
                auto frames = int_from_krl(count[0].value);
                if (!frames || *frames < 0 || *frames > 32)
                    return fail({ErrorKind::device, "SW_FRAMES is no number of frames", where_, ""});
                std::vector<std::string> wanted;
                for (std::int64_t i = 1; i <= *frames; ++i) wanted.push_back(fmt::format("SW_NAME[{},]", i));
                if (!wanted.empty()) {
                    auto names = read(wanted);
                    if (!names) {
                        names_.reset();
                        return tl::unexpected(names.error());
                    }
                    for (std::size_t i = 0; i < names->size(); ++i)
                        (*names_)[string_from_krl((*names)[i])] = fmt::format("SW_FRAME[{}]", i + 1);
                }
            }
        }
        const auto known = names_->find(name);
        return known == names_->end() ? name : known->second;
    }

    template <class Ready>
    Expected<void> poll_until(std::chrono::milliseconds timeout, const Ready& ready) {
        for (const auto until = Clock::now() + timeout;;) {
            auto now = ready();
            if (!now) return tl::unexpected(fell_silent(now.error()));
            if (*now) return {};
            if (Clock::now() >= until) return device_error(ErrorCode::silence, kNoAnswer, where_);
            std::this_thread::sleep_for(std::min(Timeout(settings_.poll_ms), left(until)));
        }
    }

    const KvpSettings settings_;
    const std::string where_;
    const Timeout timeout_;
    Backoff back_off_;
    std::optional<TcpConnection> connection_;
    std::string stream_;
    std::uint16_t last_id_ = 0;
    std::int64_t told_ = 0;
    std::optional<std::map<std::string, std::string>> names_;
    SameRobot robot_;
    std::int64_t quiet_ns_ = 0;     // when nobody called; 0 = not known
    bool call_taken_here_ = false;  // over this connection: it is measured, or lost with it
    std::optional<bool> main_run_;
};

}  // namespace

const SettingTable& kuka_kvp_settings() {
    static const SettingTable table = entry::joined(
        entry::joined({entry::text("address", "127.0.0.1", "the controller's"),
                       entry::whole("port", 7000, 1, 65535, "of KUKAVARPROXY"),
                       entry::whole("timeout_ms", 1000, 10, 60000, "for a connection and for every answer"),
                       entry::whole("poll_ms", 10, 1, 1000, "between two looks for a start or a trigger")},
                      entry::reconnect(1, 100, 500, "retry_ms", "retry_most_ms")),
        kuka_program_settings());
    return table;
}

Expected<std::unique_ptr<RobotLink>> open_kuka_kvp(const nlohmann::json& settings, DeviceSession&) {
    KvpSettings s;
    SettingsReader f(settings, "settings", kuka_kvp_settings());
    f.text("address", s.address);
    f.whole("port", s.port);
    f.whole("timeout_ms", s.timeout_ms);
    f.whole("poll_ms", s.poll_ms);
    f.whole("reconnect_ms", s.reconnect_ms);
    f.whole("reconnect_most_ms", s.reconnect_most_ms);
    if (f.failed()) return tl::unexpected(f.error());
    return std::make_unique<KvpLink>(s);
}

}  // namespace seamwright
