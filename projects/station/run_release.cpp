#include "projects/station/run_release.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <thread>

#include "devices/capture/capture.h"

namespace seamwright {

std::vector<PushRecord*> pushes_of(RunRecord& run) {
    std::vector<PushRecord*> pushes;
    for (RegionRecord& region : run.regions) pushes.push_back(&region.push);
    if (run.panel) pushes.push_back(&run.panel->push);
    return pushes;
}

void restore_frames(RunRecord& run, const std::map<std::string, RobotLink*>& robots, const EventSink& record,
                    EventKind kind) {
    auto pushes = pushes_of(run);
    std::reverse(pushes.begin(), pushes.end());
    for (PushRecord* push : pushes)
        if (push->status == PushStatus::written && push->release != Release::taken &&
            push->release != Release::given)
            withdraw_push(*push, *robots.at(push->robot_id), record, kind);
}

namespace {

// The frames that a run has written, looked at from the verdict on: a controller may keep them back until then, and a person
// may change them later. A link whose frames live in itself has nothing to be read.
class WrittenFrames {
  public:
    WrittenFrames(RunRecord& run, const std::map<std::string, RobotLink*>& robots)
        : run_(run), robots_(robots) {}

    // What differs of this robot's; empty: nothing, or it does not say.
    Text differing(const std::string& robot_id) {
        RobotLink& robot = *robots_.at(robot_id);
        if (!robot.permission_outlives_link()) return {};
        Text off, unread;
        for (const PushRecord* push : pushes_of(run_)) {
            if (push->robot_id != robot_id || push->status != PushStatus::written) continue;
            const FrameLook look = look_at_frame(*push, robot);
            if (look.stands == FrameStands::differs) off = joined(off, "; ", look.text);
            if (look.stands == FrameStands::unread) unread = joined(unread, "; ", look.text);
        }
        if (unread.empty()) seen_.insert(robot_id);
        unread_[robot_id] = unread;
        return off;
    }
    // As above, and what was never seen since the verdict.
    Text differing_or_unseen(const std::string& robot_id) {
        const Text off = differing(robot_id);
        return off.empty() && !seen_.count(robot_id) ? unread_[robot_id] : off;
    }

    // An alarm of the run, with its event.
    void raise(const std::string& robot_id, const Text& text, const EventSink& record) {
        run_.message = wrong_ ? joined(run_.message, "; ", text) : Text("alarm: {}", text);
        run_.status = RunStatus::alarm;
        wrong_ = true;
        (void)record(EventKind::alarm, robot_id, text);
    }
    bool wrong() const { return wrong_; }

  private:
    RunRecord& run_;
    bool wrong_ = false;
    const std::map<std::string, RobotLink*>& robots_;
    std::set<std::string> seen_;          // robots all of whose frames were read since the verdict
    std::map<std::string, Text> unread_;  // why they were not, at the last look
};

// What became of the permissions, into the record; frames that nobody may run in go back.
void settle(RunRecord& run, const std::map<std::string, RobotLink*>& robots,
            const std::map<std::string, RobotRelease>& ended, WrittenFrames& frames, const Text& text,
            const EventSink& record) {
    bool unsure = false;
    Text reasons;
    for (const auto& [id, outcome] : ended) {
        for (PushRecord* push : pushes_of(run))
            if (push->robot_id == id && push->status == PushStatus::written) push->release = outcome.release;
        if (outcome.release == Release::taken) {
            if (const Text off = frames.differing_or_unseen(id); !off.empty())
                frames.raise(id, Text("robot {}: its application runs, and {}", id, off), record);
            continue;
        }
        unsure = unsure || outcome.release == Release::given;
        reasons = joined(reasons, "; ", Text("robot {}: {}", id, outcome.text));
    }
    if (reasons.empty()) {
        if (frames.wrong()) return;
        run.status = RunStatus::ok;
        run.message = text;
        return;
    }
    const bool alarm = run.status == RunStatus::alarm;
    restore_frames(run, robots, record, alarm ? EventKind::alarm : EventKind::note);
    for (const PushRecord* push : pushes_of(run)) unsure = unsure || push->status == PushStatus::not_restored;
    if (alarm) {
        if (unsure) run.message = joined(run.message, "; ", reasons);
        return;
    }
    run.status = unsure ? RunStatus::alarm : RunStatus::not_taken;
    run.message = unsure ? Text("alarm: {}", reasons) : Text("nothing is released: {}", reasons);
}

}  // namespace

void release_run(RunRecord& run, const std::map<std::string, RobotLink*>& robots, const Text& text,
                 const HoldOptions& hold, const EventSink& record) {
    std::map<std::string, RobotLink*> pushed;
    for (const PushRecord* push : pushes_of(run))
        if (push->status == PushStatus::written) pushed[push->robot_id] = robots.at(push->robot_id);
    bool acknowledged = true;
    for (const auto& [id, robot] : robots) {
        const auto told = robot->confirm(PartVerdict::corrected, text.english());
        if (told) continue;
        acknowledged = false;
        (void)record(
            EventKind::alarm, id,
            Text("did not acknowledge \"{}\": {}", to_string(PartVerdict::corrected), told.error().text()));
    }
    WrittenFrames frames(run, robots);
    bool stand = acknowledged;
    for (const auto& [id, robot] : pushed) {
        if (!acknowledged) break;
        const Text off = frames.differing(id);
        if (off.empty()) continue;
        stand = false;
        frames.raise(id, Text("robot {}: {}", id, off), record);
    }
    if (stand) {
        HoldOptions watched = hold;
        watched.frame_changed = [&](const std::string& id) {
            const Text off = frames.differing(id);
            if (!off.empty()) frames.raise(id, Text("robot {}: {}", id, off), record);
            return off;
        };
        const auto ended = await_release(pushed, watched, record);
        return settle(run, robots, ended, frames, text, record);
    }
    // A part is not corrected with some of its robots.
    if (!acknowledged) run.message = "alarm: a robot did not acknowledge the corrected frames";
    run.status = RunStatus::alarm;
    std::map<std::string, RobotRelease> ended;
    for (const auto& [id, robot] : robots) {
        const RobotRelease back = take_back(*robot, PartVerdict::failed, run.message, true);
        (void)record(back.release == Release::taken ? EventKind::push : EventKind::alarm, id, back.text);
        if (pushed.count(id)) ended[id] = back;
    }
    settle(run, robots, ended, frames, text, record);
}

Expected<void> record_outcome(RunRecord& run, const std::function<Expected<void>()>& store) {
    Expected<void> stored;
    for (const int pause_ms : {0, 50, 200, 500}) {
        std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
        stored = store();
        if (stored) return stored;
    }
    if (run.status != RunStatus::ok) return stored;
    run.events.push_back(
        {0, utc_now(), run.number, EventKind::alarm, "file",
         Text("it could not be recorded that the application began: {}", stored.error().text())});
    return {};
}

void resolve_release(ProjectFile& file, const std::map<std::string, RobotLink*>& robots) {
    const auto runs = file.runs();
    if (!runs) return;  // whoever works with the file next is told
    const auto last = std::find_if(runs->rbegin(), runs->rend(), [](const RunSummary& r) { return r.push; });
    if (last == runs->rend() || last->status != RunStatus::pushed) return;
    auto run = file.load_run(last->number, false);
    if (!run) return;
    std::map<std::string, RobotRelease> ended;
    for (PushRecord* push : pushes_of(*run)) {
        if (push->release != Release::given) continue;
        const auto robot = robots.find(push->robot_id);
        if (robot == robots.end()) return;
        const auto [now, first] = ended.try_emplace(push->robot_id);
        if (first)
            now->second = take_back(*robot->second, PartVerdict::failed,
                                    "the program that corrected this part has ended", false);
        if (now->second.release == Release::given) return;
        // Nothing is in force any more; whether the application ran before, nobody can tell.
        if (!robot->second->permission_outlives_link()) return;
        push->release = now->second.release;
    }
    const bool taken = std::all_of(ended.begin(), ended.end(),
                                   [](const auto& e) { return e.second.release == Release::taken; });
    run->status = taken ? RunStatus::ok : RunStatus::not_taken;
    run->message = taken ? "corrected and pushed; the application began after the program had ended"
                         : "nothing is released: the program ended before the application had begun; the "
                           "corrected frames still stand on the controller";
    if (file.update_run(*run))
        (void)file.append_event({0, utc_now(), run->number, EventKind::note, "run", run->message});
}

}  // namespace seamwright
