// seamwright drift: the drift watch of a project: what it says, and what a person decides about it.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "devices/capture/capture.h"
#include "projects/drift/drift_edits.h"
#include "projects/drift/drift_keeper.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct DriftArguments {
    std::string file, action, on_off, as = "sensor", by, text;
    std::vector<std::string> spots;
    std::size_t points = 0;
    double most_mm = 0.3;
    DriftSettings settings;
};

json directions_json(const LearntDrift& learnt, const DriftStanding& s) {
    json list = json::array();
    for (std::size_t d = 0; d < learnt.directions.size(); ++d) {
        const LearntDirection& direction = learnt.directions[d];
        json rules = json::array();
        for (const DriftRule& rule : s.rules)
            if (rule.direction == d) rules.push_back({{"rule", rule.rule}, {"stated_sigma", rule.stated}});
        json one = {{"spot", direction.spot_id},
                    {"axis", direction.axis == 0 ? "x" : "z"},
                    {"mean_mm", direction.mean_mm},
                    {"sigma_mm", direction.sigma_mm},
                    {"stated_sigma_mm", direction.stated_mm},
                    {"warm_up_mm", direction.warm_up_mm},
                    {"nelson", std::move(rules)}};
        if (d < s.level_mm.size()) {
            one["level_mm"] = s.level_mm[d];
            one["level_sigma_mm"] = s.level_sigma_mm[d];
        }
        list.push_back(std::move(one));
    }
    return list;
}

json watch_json(const DriftWatch& watch, const DriftStanding& s) {
    json out = {{"status", to_string(s.verdict)},
                {"text", s.text},
                {"change", to_string(s.change)},
                {"stopped", s.stopped},
                {"spots", watch.spot_ids},
                {"points", s.points},
                {"last_utc", s.last_utc},
                {"parts_since", s.parts_since},
                {"minutes_since", s.minutes_since},
                {"due", s.due},
                {"every_parts", watch.every_parts},
                {"every_minutes", watch.every_minutes},
                {"limit_mm", watch.limit_mm},
                {"pause_minutes", watch.pause_minutes},
                {"learnt", nullptr},
                {"compensation",
                 {{"on", watch.compensate},
                  {"acts", s.acting.compensated},
                  {"as", watch.drifts == DriftOf::sensor ? "sensor" : "robot"},
                  {"most_mm", watch.most_mm},
                  {"why", s.acting.why},
                  {"shift_mm", {s.acting.shift_mm.x(), s.acting.shift_mm.y(), s.acting.shift_mm.z()}},
                  {"sigma_mm", s.acting.sigma_mm}}},
                {"acknowledged", json::array()}};
    if (watch.learnt)
        out["learnt"] = {{"utc", watch.learnt->utc},
                         {"points", watch.learnt->points},
                         {"time_constant_s", watch.learnt->time_constant_s},
                         {"directions", directions_json(*watch.learnt, s)}};
    for (const SetAside& range : watch.set_aside)
        out["acknowledged"].push_back({{"utc", range.utc},
                                       {"by", range.by},
                                       {"text", range.text},
                                       {"points", {range.first_point, range.last_point}}});
    return out;
}

Answer shown(const Project& project, const DriftStanding& s) {
    Answer answer;
    if (!project.drift) {
        answer.json = {{"status", "none"}};
        answer.text = "the project watches no reference (drift FILE.seam set --spots ID)\n";
        return answer;
    }
    const DriftWatch& watch = *project.drift;
    answer.json = watch_json(watch, s);
    answer.text = fmt::format("{}: {}\n", to_string(s.verdict), s.text);
    answer.text += fmt::format("  spots {}; {} points, the last {}{}\n", fmt::join(watch.spot_ids, ", "),
                               s.points, s.last_utc.empty() ? "never" : s.last_utc, s.due ? "; due" : "");
    if (watch.learnt) {
        for (std::size_t d = 0; d < watch.learnt->directions.size(); ++d) {
            const LearntDirection& direction = watch.learnt->directions[d];
            answer.text +=
                fmt::format("  {}: sigma {:.4f} mm (stated {:.4f}), warm-up {:+.3f} mm", name_of(direction),
                            direction.sigma_mm, direction.stated_mm, direction.warm_up_mm);
            if (d < s.level_mm.size())
                answer.text += fmt::format(", now {:+.4f} ± {:.4f} mm", s.level_mm[d], s.level_sigma_mm[d]);
            answer.text += "\n";
        }
        if (watch.learnt->time_constant_s > 0)
            answer.text += fmt::format("  warm-up: time constant {:.0f} s\n", watch.learnt->time_constant_s);
    }
    if (watch.compensate) answer.text += "  " + said_of(s.acting).english() + "\n";
    if (!s.trouble.empty()) answer.text += "  " + s.trouble.english() + "\n";
    answer.exit_code =
        s.verdict == DriftVerdict::step || s.verdict == DriftVerdict::recalibrate || !s.trouble.empty()
            ? kExitVerdict
            : kExitOk;
    return answer;
}

// Who has looked: whoever is signed in, where nobody is named.
std::string said_by(const ProjectFile& file, const DriftArguments& a) {
    return a.by.empty() && file.person() ? file.person()->name : a.by;
}

Expected<void> edit(Project& project, ProjectFile& file, const DriftArguments& a) {
    SEAM_TRY(const auto points, file.drift_points());
    const std::string now = utc_now();
    if (a.action == "set") {
        DriftSettings settings = a.settings;
        settings.spot_ids = a.spots;
        return set_drift_watch(project, settings);
    }
    if (a.action == "learn") return learn_drift_watch(project, points, a.points, now);
    if (a.action == "compensate") {
        if (a.on_off != "on" && a.on_off != "off")
            return usage_error("compensate is neither switched on nor off", a.file,
                               "say: drift FILE.seam compensate on");
        return switch_compensation(project, points, a.on_off == "on",
                                   a.as == "robot" ? DriftOf::robot : DriftOf::sensor, a.most_mm, now);
    }
    if (a.action == "remove") {
        if (!project.drift) return input_error("the project watches no reference", a.file);
        if (drift_standing(project, points, now, 0).stopped)
            return input_error("a step was not acknowledged", a.file, "acknowledge it first");
        project.drift.reset();
        return {};
    }
    SEAM_OK(acknowledge_step(project, points, said_by(file, a), a.text, now));
    return {};
}

Expected<Answer> drift_command(const DriftArguments& a) {
    if (a.action == "status") {
        SEAM_TRY(const auto file, ProjectFile::open(a.file, FileAccess::read_only));
        SEAM_TRY(const Project project, file.load());
        SEAM_TRY(const auto standing, stored_standing(file, project, utc_now()));
        return shown(project, standing);
    }
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(Project project, file.load());
    SEAM_OK(edit(project, file, a));
    SEAM_OK(file.save(project));
    const Text said =
        a.action == "acknowledge" ? Text("a step was acknowledged by {}: {}", said_by(file, a), a.text)
        : a.action == "compensate"
            ? (a.on_off == "on" ? Text("compensation is switched on, at most {:.3f} mm", a.most_mm)
                                : Text("compensation is switched off"))
            : Text("drift watch: {}", a.action);
    SEAM_OK(file.append_event({0, utc_now(), 0, EventKind::note, "drift watch", said}));
    SEAM_TRY(const auto standing, stored_standing(file, project, utc_now()));
    Answer answer = shown(project, standing);
    answer.exit_code = kExitOk;  // the edit is done
    return answer;
}

}  // namespace

void add_drift(CommandLine& line) {
    auto a = std::make_shared<DriftArguments>();
    CLI::App* command =
        line.add("drift",
                 "The drift watch: reference spots on something fixed in the cell, measured by the robot's "
                 "own program with every "
                 "part\nor as a part type of their own. set: which spots, how often, which limit. learn: "
                 "their place, scatter and "
                 "warm-up from\nthe runs so far (20 at least). status: fine, watch, recalibrate or step. "
                 "compensate on|off: whether "
                 "what they drift by\nis taken off the measurements. acknowledge: a person has looked after "
                 "a step, production may "
                 "go on. Exit 1 of status:\nrecalibrate, or stopped by a step.",
                 "seamwright drift door.seam acknowledge --by Ada --text \"bracket tightened\"");
    command->add_option("file", a->file, "Project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    command->add_option("action", a->action, "status, set, learn, compensate, acknowledge or remove")
        ->required()
        ->check(CLI::IsMember({"status", "set", "learn", "compensate", "acknowledge", "remove"}));
    command->add_option("switch", a->on_off, "With compensate: on or off")
        ->check(CLI::IsMember({"on", "off"}));
    command->add_option("--spots", a->spots, "With set: the reference spots, of no region")->delimiter(',');
    command->add_option("--every-parts", a->settings.every_parts,
                        "With set: due after so many parts; 0: not by parts [1]");
    command->add_option("--every-minutes", a->settings.every_minutes,
                        "With set: due after so many minutes; 0: not by time [0]");
    command->add_option("--limit-mm", a->settings.limit_mm, "With set: recalibrate beyond [0.1]");
    command->add_option("--pause-minutes", a->settings.pause_minutes,
                        "With set: after so long without a part the warm-up begins anew [10]");
    command->add_option("--points", a->points, "With learn: from so many of the newest points [all]")
        ->check(CLI::Range(20, 100000));
    command
        ->add_option("--as", a->as,
                     "With compensate on: a drift of the sensor on its flange, or of the robot")
        ->check(CLI::IsMember({"sensor", "robot"}))
        ->capture_default_str();
    command->add_option("--most-mm", a->most_mm, "With compensate on: beyond it nothing is pushed")
        ->check(CLI::Range(0.001, kMostCompensatedMm))
        ->capture_default_str();
    command->add_option("--by", a->by, "With acknowledge: who has looked");
    command->add_option("--text", a->text, "With acknowledge: what was found");
    line.on(command, [a] { return drift_command(*a); });
}

}  // namespace seamwright::cli
