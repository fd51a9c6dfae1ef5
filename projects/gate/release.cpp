#include "projects/gate/release.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLook{25};
constexpr std::chrono::seconds kTell{5};    // how often the wait is told
constexpr std::chrono::seconds kFrames{1};  // how often the frames are looked at

// The wait for one robot.
class Waiting {
  public:
    Waiting(RobotLink& robot, const HoldOptions& options) : robot_(robot), options_(options) {}

    // Nothing = it still waits.
    std::optional<RobotRelease> look(bool time_over, bool next_part, const Text& changed) {
        const Expected<Permission> now = robot_.permission();
        trouble_ = now ? Text() : now.error().text();
        if (now && *now == Permission::taken) return taken();
        if (now && *now == Permission::none)
            return RobotRelease{Release::withdrawn,
                                ran_ ? Text("the application was stopped before its end")
                                     : Text("the robot took the permission back by itself")};
        if (now) ran_ = ran_ || *now == Permission::running;
        const bool running = now && *now == Permission::running;
        if (!changed.empty()) return give_up(Release::withdrawn, changed);
        if (options_.cancel.stop_requested())
            return give_up(Release::withdrawn, "cancelled before the application had taken the permission");
        if (running) return std::nullopt;
        if (next_part)
            return give_up(Release::not_taken,
                           "the line called for the next part before the application began");
        if (time_over)
            return give_up(Release::not_taken,
                           Text("the application did not begin within {} s",
                                std::chrono::duration_cast<std::chrono::seconds>(options_.hold).count()));
        return std::nullopt;
    }
    Text state(std::optional<Clock::duration> left) const {
        if (!trouble_.empty()) return Text("does not say whether the application began: {}", trouble_);
        if (ran_) return "the application runs in the frames";
        if (!left) return "released, waiting for the application";
        return Text("released, waiting for the application, {} s left",
                    std::chrono::ceil<std::chrono::seconds>(*left).count());
    }

  private:
    static RobotRelease taken() { return {Release::taken, "the application runs in the frames"}; }
    RobotRelease give_up(Release as, const Text& why) {
        RobotRelease back = take_back(robot_, PartVerdict::failed, Text("not released: {}", why), true);
        if (back.release == Release::withdrawn) return {as, why};
        if (back.release == Release::given) back.text = joined(why, "; ", back.text);
        return back;
    }
    RobotLink& robot_;
    const HoldOptions& options_;
    bool ran_ = false;
    Text trouble_;
};

}  // namespace

RobotRelease take_back(RobotLink& robot, PartVerdict verdict, const Text& text, bool running) {
    const auto has_it = [&](const Expected<Permission>& now) {
        return now && (*now == Permission::taken || (*now == Permission::running && !running));
    };
    const RobotRelease taken{Release::taken, "the application runs in the frames"};
    if (has_it(robot.permission())) return taken;
    const Expected<void> told = robot.confirm(verdict, text.english());
    const Expected<Permission> now = robot.permission();
    if (now && *now == Permission::taken) return taken;
    if (now && *now == Permission::none) return {Release::withdrawn, "the permission is taken back"};
    const Text why = !told ? told.error().text()
                     : now ? Text("it says \"{}\" all the same", to_string(*now))
                           : now.error().text();
    return {Release::given, Text("it is not sure that the permission was taken back: {}", why)};
}

std::map<std::string, RobotRelease> await_release(const std::map<std::string, RobotLink*>& robots,
                                                  const HoldOptions& options, const EventSink& record) {
    std::map<std::string, RobotRelease> ended;
    std::map<std::string, Waiting> open;
    for (const auto& [id, robot] : robots) open.try_emplace(id, *robot, options);
    std::optional<Clock::time_point> until;
    if (options.hold != kHoldForEver) until = Clock::now() + options.hold;
    auto tell_again = Clock::now();
    auto look_at_frames = Clock::now() + kFrames;
    bool next_part = false;
    while (!open.empty()) {
        const bool frames = options.frame_changed && Clock::now() >= look_at_frames;
        if (frames) look_at_frames = Clock::now() + kFrames;
        for (auto it = open.begin(); it != open.end();) {
            const Text changed = frames ? options.frame_changed(it->first) : Text();
            auto outcome = it->second.look(until && Clock::now() >= *until, next_part, changed);
            if (!outcome) {
                ++it;
                continue;
            }
            const EventKind kind = outcome->release == Release::taken   ? EventKind::push
                                   : outcome->release == Release::given ? EventKind::alarm
                                                                        : EventKind::refusal;
            const bool released = outcome->release == Release::taken;
            // The outcome is in the run's record in any case; the log is the second place.
            (void)record(kind, it->first, released ? outcome->text : Text("not released: {}", outcome->text));
            if (options.progress) options.progress(Text("robot {}: {}", it->first, outcome->text));
            ended[it->first] = std::move(*outcome);
            it = open.erase(it);
        }
        if (open.empty()) break;
        if (options.progress && Clock::now() >= tell_again) {
            tell_again = Clock::now() + kTell;
            std::optional<Clock::duration> left;
            if (until) left = std::max(*until - Clock::now(), Clock::duration::zero());
            for (const auto& [id, waiting] : open)
                options.progress(Text("robot {}: {}", id, waiting.state(left)));
        }
        // Asked last: who has begun needs no more than that.
        next_part = options.part_over && options.part_over();
        if (!next_part) std::this_thread::sleep_for(kLook);
    }
    return ended;
}

}  // namespace seamwright
