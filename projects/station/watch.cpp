#include "projects/station/watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <thread>
#include <utility>

#include "devices/silence.h"
#include "projects/model/part_types.h"
#include "projects/station/check.h"

namespace seamwright {

std::string_view to_string(WatchState state) {
    switch (state) {
        case WatchState::connecting:
            return "connecting";
        case WatchState::waiting:
            return "waiting";
        case WatchState::measuring:
            return "measuring";
        case WatchState::lost:
            return "lost";
        case WatchState::stopped:
            return "stopped";
    }
    return "stopped";
}

std::string_view to_string(WatchLevel level) {
    switch (level) {
        case WatchLevel::info:
            return "info";
        case WatchLevel::warning:
            return "warning";
        case WatchLevel::alarm:
            return "alarm";
    }
    return "alarm";
}

std::string_view name_of(const WatchHappening& happening) {
    using namespace watched;
    struct Name {
        std::string_view operator()(const Connected&) const { return "connected"; }
        std::string_view operator()(const Lost&) const { return "lost"; }
        std::string_view operator()(const Back&) const { return "back"; }
        std::string_view operator()(const RobotNotice&) const { return "robot"; }
        std::string_view operator()(const LineNotice&) const { return "line"; }
        std::string_view operator()(const Start&) const { return "start"; }
        std::string_view operator()(const Missed&) const { return "missed"; }
        std::string_view operator()(const SpotDone&) const { return "spot"; }
        std::string_view operator()(const RunDone&) const { return "run"; }
        std::string_view operator()(const ProjectNotice&) const { return "project"; }
        std::string_view operator()(const Stopped&) const { return "stopped"; }
    };
    return std::visit(Name{}, happening);
}

namespace {

constexpr std::chrono::milliseconds kLineSlice{20};

class Watch {
  public:
    Watch(Station& station, const WatchOptions& options)
        : station_(station),
          options_(options),
          retry_(options.retry_first),
          call_again_(options.call_again_first) {}

    Expected<WatchCounts> run() {
        while (!ended()) {
            alive();
            SEAM_OK(follow_file());
            if (!station_.connected()) {
                SEAM_TRY(auto connected, connect());
                if (!connected) continue;
            }
            if (dead_ && std::chrono::steady_clock::now() >= look_again_) dead_ = dead_sensor();
            ask_sensors();
            SEAM_TRY(auto start, next_start());
            if (!start.has_value()) {
                let_call_again();
                continue;
            }
            if (const auto part = named(*start)) SEAM_OK(measure(*part));
        }
        state_ = WatchState::stopped;
        tell(WatchLevel::info, watched::Stopped{}, Text("stopped after {} parts", counts_.parts));
        return counts_;
    }

  private:
    bool ended() const {
        return options_.cancel.stop_requested() || (options_.parts > 0 && counts_.parts >= options_.parts);
    }

    void alive() {
        if (options_.alive) options_.alive();
        if (!options_.line.notices) return;
        for (const Text& notice : options_.line.notices())
            tell(WatchLevel::warning, watched::LineNotice{}, Text("line: {}", notice));
    }

    void tell(WatchLevel level, WatchHappening happening, Text text) {
        if (!options_.tell) return;
        options_.tell({utc_now(), level, std::move(happening), std::move(text), state_, counts_});
    }

    void pause() {
        const auto until = std::chrono::steady_clock::now() + retry_;
        retry_ = std::min(2 * retry_, options_.retry_longest);
        while (!options_.cancel.stop_requested()) {
            alive();
            const auto left = until - std::chrono::steady_clock::now();
            if (left <= left.zero()) break;
            std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(kCancelSlice, left));
        }
    }

    // An outage is told and recorded once, however many attempts it lasts.
    void lost(const Text& subject, const Error& error) {
        state_ = WatchState::lost;
        if (!std::exchange(away_, true)) tell_lost(subject, error);
        pause();
    }

    void tell_lost(const Text& subject, const Error& error) {
        ++counts_.lost;
        // An event that the file does not take is told all the same; the next run's record shows the
        // file's Error.
        (void)station_.file().append_event(
            {0, utc_now(), 0, EventKind::alarm, subject.english(), Text("lost: {}", error.text())});
        tell(WatchLevel::alarm, watched::Lost{subject.english(), error.code},
             Text("{} is lost: {}", subject, error.text()));
    }

    Expected<void> follow_file() {
        SEAM_TRY(const auto edits, station_.follow_file());
        for (const EditOfOthers& edit : edits) {
            const Text text("{}: from now on it is measured with as it is in the file", said_of(edit));
            (void)station_.file().append_event({0, utc_now(), 0, EventKind::note, "watch", text});
            tell(WatchLevel::warning, watched::ProjectNotice{}, text);
        }
        return {};
    }

    // The first sensor that cannot be started, as the next part would start it, and what it says.
    std::optional<std::pair<Text, Error>> dead_sensor() {
        for (const SensorSetup& setup : station_.project().sensors) {
            ProfileSource* sensor = station_.sensor(setup.id);
            if (!sensor) continue;
            auto started = sensor->start();
            sensor->stop();
            if (started) continue;
            look_again_ = std::chrono::steady_clock::now() + retry_;
            retry_ = std::min(2 * retry_, options_.retry_longest);
            return std::pair(Text("sensor {}", setup.id), started.error());
        }
        return std::nullopt;
    }

    // One that has gone while nothing is measured: neither a wait for a start nor a robot finds that out.
    void ask_sensors() {
        if (dead_ || std::chrono::steady_clock::now() < ask_again_) return;
        ask_again_ = std::chrono::steady_clock::now() + options_.ask_sensors;
        for (const SensorSetup& setup : station_.project().sensors) {
            ProfileSource* sensor = station_.sensor(setup.id);
            if (!sensor) continue;
            const auto answered = sensor->answers();
            if (answered) continue;
            dead_ = std::pair(Text("sensor {}", setup.id), answered.error());
            look_again_ = std::chrono::steady_clock::now() + retry_;
            state_ = WatchState::lost;
            return tell_lost(dead_->first, dead_->second);
        }
    }

    // All answer. A call is heard while a sensor is dead, too: the robot is told at once that its part failed.
    void ready() {
        away_ = false;
        if (dead_) return;
        retry_ = options_.retry_first;
        if (state_ == WatchState::lost) {
            (void)station_.file().append_event(
                {0, utc_now(), 0, EventKind::note, "watch", "all devices answer again"});
            state_ = WatchState::waiting;
            tell(WatchLevel::info, watched::Back{}, "all devices answer again");
        }
        state_ = WatchState::waiting;
    }

    // False = not yet. An Error is one that no waiting mends: wrong settings, an unknown driver.
    Expected<bool> connect() {
        if (auto connected = station_.connect(); !connected) {
            if (connected.error().kind != ErrorKind::device) return tl::unexpected(connected.error());
            lost("station", connected.error());
            return false;
        }
        ready();
        tell(WatchLevel::info, watched::Connected{}, "waiting for the robot's start signal");
        return true;
    }

    // Nothing = none yet. An Error is one that no waiting mends.
    Expected<std::optional<StartSignal>> next_start() {
        const auto& robots = station_.project().robots;
        if (robots.empty())
            return usage_error("the project has no robot", station_.file().path().string(), "add one");
        const bool line = options_.line.starts;
        // A line that calls is heard as quickly as a robot.
        const auto slice = (line ? kLineSlice : kCancelSlice) / static_cast<int>(robots.size());
        for (const RobotSetup& setup : robots) {
            RobotLink* robot = station_.robot(setup.id);
            if (!robot) return usage_error("it is not connected", Text("robot {}", setup.id), "connect it");
            auto start = called_ && called_->first == setup.id
                             ? Expected<StartSignal>(std::exchange(called_, std::nullopt)->second)
                             : robot->wait_start(slice);
            for (const Text& notice : robot->take_notices())
                tell(WatchLevel::warning, watched::RobotNotice{}, Text("robot {}: {}", setup.id, notice));
            if (start) untold_.erase(setup.id);  // it is at another part
            if (line && (start || start.error().kind == ErrorKind::usage)) {
                if (!start) std::this_thread::sleep_for(slice);  // it has no call that could be waited for
                continue;
            }
            if (start) {
                ready();
                caller_ = setup.id;
                if (stranded_ && stranded_->first == caller_) stranded_.reset();
                newest(*robot, setup.id, *start);
                if (expired(*robot, setup.id, *start)) return std::nullopt;
                return std::optional(*start);
            }
            if (start.error().kind == ErrorKind::usage) return tl::unexpected(start.error());
            if (!is_silence(start.error())) {
                lost(Text("robot {}", setup.id), start.error());
                return std::nullopt;
            }
            tell_again(*robot, setup.id);
        }
        ready();
        return line ? line_call() : std::nullopt;
    }

    std::optional<StartSignal> line_call() {
        auto start = options_.line.call();
        if (!start) return std::nullopt;
        caller_.clear();
        const auto age = std::chrono::steady_clock::now().time_since_epoch() -
                         std::chrono::nanoseconds(start->host_time_ns);
        if (age <= options_.start_expiry) return start;
        missed("line", *start, too_old(*start, age));
        return std::nullopt;
    }

    struct Part {
        std::string id, type, paint = {};
    };

    // As the line names it and of which type; nothing: it is not to be measured, and who called is told.
    std::optional<Part> named(const StartSignal& start) {
        NamedPart part{start.part_id};
        if (options_.line.named) {
            auto by_line = options_.line.named(start.part_id);
            if (!by_line) return refused(start, by_line.error(), false);
            part = std::move(*by_line);
        }
        auto type = type_of(start, part);
        if (!type) return refused(start, type.error(), true);
        return Part{std::move(part.part_id), std::move(*type),
                    part.paint ? std::to_string(part.paint) : options_.paint};
    }

    std::nullopt_t refused(const StartSignal& start, const Error& error, bool part_type) {
        const Text why("part {}: {}", name(start), error.text());
        missed(part_type && !caller_.empty() ? "robot " + caller_ : "line", start, why, part_type);
        if (RobotLink* robot = caller_.empty() ? nullptr : station_.robot(caller_))
            refuse(*robot, caller_, why);
        return std::nullopt;
    }

    // What robot, line and person say must be one type.
    Expected<std::string> type_of(const StartSignal& start, const NamedPart& part) {
        const Project& project = station_.project();
        // A line numbers its parts for others too.
        const std::string line = part.type && !project.part_types.empty() ? std::to_string(part.type) : "";
        std::string type;
        for (const auto& [who, said] :
             {std::pair{Text("robot {}", caller_), start.part_type}, std::pair{Text("line"), line},
              std::pair{Text("--type"), options_.part_type}}) {
            if (said.empty()) continue;
            SEAM_TRY(auto one, called_type(project, said));
            if (!type.empty() && one != type)
                return input_error(Text("{} says part type {}, before it was {}", who, one, type),
                                   "part types", "let all who say a type say the same");
            type = std::move(one);
        }
        return runnable_type(project, type, options_.push);
    }

    void refuse(RobotLink& robot, const std::string& id, const Text& why) {
        if (auto told = robot.confirm(PartVerdict::refused, why.english()); !told)
            tell(WatchLevel::warning, watched::RobotNotice{}, Text("robot {}: {}", id, told.error().text()));
    }

    // A robot that was away when its part ended waits for the verdict for good.
    void tell_again(RobotLink& robot, const std::string& id) {
        const auto untold = untold_.find(id);
        if (untold == untold_.end() || std::chrono::steady_clock::now() < untold->second.at) return;
        if (auto told = robot.confirm(untold->second.verdict, "the part before was not corrected")) {
            tell(WatchLevel::info, watched::RobotNotice{},
                 Text("robot {}: told now how its part ended ({})", id, to_string(untold->second.verdict)));
            untold_.erase(untold);
        } else {
            untold->second.at = std::chrono::steady_clock::now() + options_.call_again_first;
        }
    }

    // The one that was left in front of a failed part, when its time has come and all sensors answer.
    void let_call_again() {
        if (!stranded_ || dead_ || std::chrono::steady_clock::now() < stranded_->second) return;
        const std::string id = std::exchange(stranded_, std::nullopt)->first;
        if (RobotLink* robot = station_.robot(id))
            refuse(*robot, id, "the measuring failed before the robot moved; call again");
    }

    static Text too_old(const StartSignal& start, std::chrono::nanoseconds age) {
        return Text("part {}: the call may be {:.0f} s old, another part may stand there; call again",
                    name(start), std::chrono::duration<double>(age).count());
    }

    // The newest of the calls that wait.
    void newest(RobotLink& robot, const std::string& id, StartSignal& start) {
        while (auto newer = robot.wait_start(std::chrono::milliseconds(0))) {
            missed("robot " + id, start,
                   Text("part {}: a newer call came before it was measured", name(start)));
            start = *newer;
        }
    }

    // Whether nobody knows what stands there by now; the robot is told then, so that the line goes on.
    bool expired(RobotLink& robot, const std::string& id, const StartSignal& start) {
        const std::int64_t called_ns = start.not_before_ns != 0 ? start.not_before_ns : start.host_time_ns;
        const auto age =
            std::chrono::steady_clock::now().time_since_epoch() - std::chrono::nanoseconds(called_ns);
        if (called_ns == 0 || age <= options_.start_expiry) return false;
        const Text why = too_old(start, age);
        missed("robot " + id, start, why);
        refuse(robot, id, why);
        return true;
    }

    void missed(const std::string& subject, const StartSignal& start, const Text& why,
                bool part_type = false) {
        ++counts_.missed;
        (void)station_.file().append_event({0, utc_now(), 0, EventKind::refusal, subject, why});
        tell(WatchLevel::warning, watched::Missed{start.part_id, part_type}, why);
    }

    static std::string name(const StartSignal& start) {
        return start.part_id.empty() ? "(no name)" : start.part_id;
    }

    static Text named_part(const Part& part) {
        const Text id = part.id.empty() ? Text("(no name)") : Text(part.id);
        return part.type.empty() ? Text("part {}", id) : Text("part {} of type {}", id, part.type);
    }

    Expected<void> measure(const Part& part) {
        state_ = WatchState::measuring;
        calls_heard_ = false;
        ++counts_.parts;
        tell(WatchLevel::info, watched::Start{part.id, part.type}, named_part(part));
        RunOptions run;
        run.part_id = part.id;
        run.part_type = part.type;
        run.paint = part.paint;
        run.caller = caller_;
        run.push = options_.push;
        run.keep_images = options_.keep_images;
        run.limits = options_.limits;
        run.cancel = options_.cancel;
        // The link is here to stay: held until the application has begun, or will not any more.
        run.hold = kHoldForEver;
        run.part_over = [&] { return part_called(); };
        run.untold = [&](const std::string& id, PartVerdict verdict) { untold_[id] = {verdict, {}}; };
        bool went = false;
        run.robot_goes = [&](const std::string& id) {
            went = went || id == caller_;
            untold_.erase(id);
        };
        run.progress = [&](const RunProgress& p) {
            alive();
            tell(WatchLevel::info, watched::SpotDone{p.done, p.total}, p.text);
        };
        const auto begun = std::chrono::steady_clock::now();
        SEAM_TRY(auto record, station_.run(run));
        const auto took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun);
        const RunStatus status = record.status;
        const bool alarm = status == RunStatus::alarm;
        const bool failed = status == RunStatus::device || status == RunStatus::cancelled;
        (status == RunStatus::ok ? counts_.corrected
         : alarm                 ? counts_.alarms
         : failed                ? counts_.failed
                                 : counts_.refused) += 1;
        // No wait for a start finds out that a sensor is dead.
        const bool was_dead = dead_.has_value();
        dead_ = status == RunStatus::device ? dead_sensor() : std::nullopt;
        state_ = was_dead || dead_ ? WatchState::lost : WatchState::waiting;
        const auto done = std::make_shared<const RunRecord>(std::move(record));
        const DriftStanding& drift = station_.drift();
        Text said("{}: {}", named_part({done->part_id, done->type_id}), done->message);
        // Of a run without regions the message knows nothing of it.
        if (drift.stopped && done->regions.empty()) said = joined(said, "; ", drift.trouble);
        tell(alarm || drift.stopped || status == RunStatus::device ? WatchLevel::alarm
             : status == RunStatus::ok                             ? WatchLevel::info
                                                                   : WatchLevel::warning,
             watched::RunDone{done, took.count(), drift}, std::move(said));
        if (dead_ && !was_dead) tell_lost(dead_->first, dead_->second);
        strand(status == RunStatus::device && !went);
        return forget_old_runs();
    }

    // Whether the robot that called stands in front of its part still, which has failed.
    void strand(bool stands) {
        if (!stands) {
            call_again_ = options_.call_again_first;
            stranded_.reset();
        } else if (!caller_.empty()) {
            stranded_.emplace(caller_, std::chrono::steady_clock::now() + call_again_);
            call_again_ = std::min(2 * call_again_, options_.call_again_longest);
        }
    }

    // Whether the line calls for the next part while the last one is still to be taken; kept for the next
    // round.
    bool part_called() {
        alive();
        if (options_.line.starts) return line_over();
        for (const RobotSetup& setup : station_.project().robots) {
            if (called_) return true;
            if (RobotLink* robot = station_.robot(setup.id))
                if (auto start = robot->wait_start(std::chrono::milliseconds(1)))
                    called_.emplace(setup.id, *start);
        }
        return called_.has_value();
    }

    // The line gave the part up, or a robot is at the start of the next one.
    bool line_over() {
        if (options_.line.given_up()) return true;
        const bool first = !std::exchange(calls_heard_, true);
        for (const RobotSetup& setup : station_.project().robots)
            if (RobotLink* robot = station_.robot(setup.id))
                while (robot->wait_start(std::chrono::milliseconds(1)))
                    // What waited until now was this part's: the robot called before it was measured.
                    if (!first) return true;
        return false;
    }

    Expected<void> forget_old_runs() {
        if (options_.keep_runs <= 0) return {};
        SEAM_TRY(auto runs, station_.file().runs());
        const auto keep = static_cast<std::size_t>(options_.keep_runs);
        for (std::size_t i = 0; i + keep < runs.size(); ++i)
            SEAM_OK(station_.file().delete_run(runs[i].number));
        return {};
    }

    Station& station_;
    const WatchOptions& options_;
    WatchState state_ = WatchState::connecting;
    WatchCounts counts_;
    std::string caller_;  // the robot that called for the part that is about to be measured; none: the line
    bool calls_heard_ = false;                                   // line_over() of this part
    std::optional<std::pair<std::string, StartSignal>> called_;  // by which robot, while a part was released
    std::chrono::milliseconds retry_;
    bool away_ = false;  // the station or a robot, and that was told
    std::optional<std::pair<Text, Error>>
        dead_;  // a sensor, since a run that it ended or it did not answer; told
    std::chrono::steady_clock::time_point look_again_{};
    // The next time that the sensors are asked whether they are there.
    std::chrono::steady_clock::time_point ask_again_ =
        std::chrono::steady_clock::now() + options_.ask_sensors;
    // Which robot waits in front of a part that failed before it went, and when it may be refused.
    std::optional<std::pair<std::string, std::chrono::steady_clock::time_point>> stranded_;
    std::chrono::milliseconds call_again_;
    struct Untold {
        PartVerdict verdict;
        std::chrono::steady_clock::time_point at;  // of the next attempt
    };
    std::map<std::string, Untold> untold_;  // by robot
};

}  // namespace

Expected<WatchCounts> watch(Station& station, const WatchOptions& options) {
    return Watch(station, options).run();
}

}  // namespace seamwright
