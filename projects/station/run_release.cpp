#include "projects/station/run_release.h"

#include <fmt/format.h>

#include <algorithm>
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

// What became of the permissions, into the record; frames that nobody may run in go back.
void settle(RunRecord& run, const std::map<std::string, RobotLink*>& robots,
            const std::map<std::string, RobotRelease>& ended, const Text& text, const EventSink& record) {
    bool unsure = false;
    Text reasons;
    for (const auto& [id, outcome] : ended) {
        for (PushRecord* push : pushes_of(run))
            if (push->robot_id == id && push->status == PushStatus::written) push->release = outcome.release;
        if (outcome.release == Release::taken) continue;
        unsure = unsure || outcome.release == Release::given;
        reasons = joined(reasons, "; ", Text("robot {}: {}", id, outcome.text));
    }
    if (reasons.empty()) {
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
    if (acknowledged) return settle(run, robots, await_release(pushed, hold, record), text, record);
    // A part is not corrected with some of its robots.
    run.status = RunStatus::alarm;
    run.message = "alarm: a robot did not acknowledge the corrected frames";
    std::map<std::string, RobotRelease> ended;
    for (const auto& [id, robot] : robots) {
        const RobotRelease back = take_back(*robot, PartVerdict::failed, run.message, true);
        (void)record(back.release == Release::taken ? EventKind::push : EventKind::alarm, id, back.text);
        if (pushed.count(id)) ended[id] = back;
    }
    settle(run, robots, ended, text, record);
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
