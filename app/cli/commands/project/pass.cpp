// seamwright pass: the pass through a spot that shows whether its contour stands still, recorded on the devices and
// accepted as the desk's Align page does.

#include "app/cli/commands/project/pass.h"

#include <fmt/format.h>

#include "app/cli/answers/result_json.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/profile_csv.h"
#include "projects/proof/checklist.h"
#include "projects/proof/present_names.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

Expected<const Spot*> spot_of(const Project& project, const std::string& id, const std::string& file) {
    if (const Spot* spot = find_spot(project, id)) return spot;
    return input_error(Text("there is no spot \"{}\"", id), file, "see `seamwright info`");
}

AlignmentOptions judged_by(const Spot& spot, const LivePass& a) {
    AlignmentOptions options = alignment_options(spot);
    if (a.jitter_mm) options.jitter_mm = *a.jitter_mm;
    if (a.tolerance_mm) options.tolerance_mm = *a.tolerance_mm;
    if (a.window_mm) options.window_mm = *a.window_mm;
    if (a.reference_mm) options.reference_mm = *a.reference_mm;
    return options;
}

void replace_spot(Project& project, const Spot& after) {
    for (Spot& s : project.spots)
        if (s.id == after.id) s = after;
}

// Curve and jitter into the spot, the verdict into the file as evidence.
Expected<void> accept(Station& station, const JudgedPass& judged, Answer& answer) {
    Project project = station.project();
    SEAM_TRY(const auto after, with_pass(*find_spot(project, judged.spot.id), judged));
    replace_spot(project, after);
    SEAM_OK(station.edit(project));
    SEAM_TRY(const auto id,
             station.file().append_evidence(
                 {0, {}, 0, frozen_contour(after.id, judged.result, judged.options)}, station.project()));
    answer.json["evidence"] = id;
    answer.text += fmt::format("accepted: curve and jitter of +-{:g} mm are the spot's\n", after.jitter_mm);
    return {};
}

// The pose that cures the drift.
Expected<void> adopt(Station& station, const JudgedPass& judged, Answer& answer) {
    Project project = station.project();
    const Calibration* c = calibration_of(project, judged.spot);
    const Spot after = cured(*find_spot(project, judged.spot.id), judged.result,
                             c ? c->flange_from_sensor : Pose::Identity());
    replace_spot(project, after);
    SEAM_OK(station.edit(project));
    answer.json["base_from_flange"] = pose_json(after.base_from_flange);
    answer.text += "the spot's pose is turned by the cure: measure its reference anew, then pass it again\n";
    return {};
}

Answer told(const JudgedPass& judged) {
    Answer answer;
    answer.json = alignment_json(judged.result);
    answer.json["spot"] = judged.spot.id;
    answer.json["profiles"] = judged.pass.profiles.size();
    answer.json["feature_found"] = judged.pass.references.size();
    answer.json["jitter_mm"] = judged.options.jitter_mm;
    answer.json["tolerance_mm"] = judged.options.tolerance_mm;
    answer.json["done"] = "recorded";
    answer.text = fmt::format("spot {}: {} profiles\n", judged.spot.id, judged.pass.profiles.size());
    answer.text += alignment_text(judged.result);
    if (!judged.curve)
        answer.text += "The feature was found in too few profiles to learn the contour's curve.\n";
    answer.exit_code = judged.result.status == AlignmentStatus::frozen ? kExitOk : kExitVerdict;
    return answer;
}

// What the file says of the spot's passes.
Expected<Answer> list(const std::string& path, const std::string& spot_id) {
    SEAM_TRY(auto file, ProjectFile::open(path, FileAccess::read_only));
    SEAM_TRY(const auto project, file.load());
    SEAM_TRY(const Spot* spot, spot_of(project, spot_id, path));
    Facts facts;
    SEAM_OK(gather(file, facts));
    const Evidence* last = newest_pass(project, facts, spot_id);
    const auto setup = last ? facts.setups.find(last->setup) : facts.setups.end();
    const bool holds =
        last && spot->curve && setup != facts.setups.end() && !pass_changed(*setup->second, project, spot_id);
    Answer answer;
    answer.json = {{"spot", spot_id},
                   {"status", !last || !spot->curve ? "none"
                              : holds               ? "accepted"
                                                    : "stale"},
                   {"passes", json::array()}};
    for (const Evidence& e : facts.evidence) {
        const auto* f = std::get_if<FrozenContour>(&e.what);
        if (!f || !is_pass_of(project, facts, e, spot_id)) continue;
        answer.json["passes"].push_back({{"evidence", e.id},
                                         {"utc", e.utc},
                                         {"status", to_string(f->status)},
                                         {"yaw_deg", f->yaw_deg},
                                         {"pitch_deg", f->pitch_deg},
                                         {"radius_mm", f->radius_mm},
                                         {"expected_error_mm", f->expected_error_mm},
                                         {"tolerance_mm", f->tolerance_mm},
                                         {"jitter_mm", f->jitter_mm},
                                         {"profiles", f->offsets.size()}});
        answer.text +=
            fmt::format("{}  {}  expected error {:.3f} mm at a jitter of +-{:g} mm, tolerance {:g} mm\n",
                        e.utc, to_string(f->status), f->expected_error_mm, f->jitter_mm, f->tolerance_mm);
    }
    answer.text += fmt::format("spot {}: {}\n", spot_id,
                               !last || !spot->curve ? "no pass is accepted"
                               : holds               ? "the last pass holds"
                                                     : "it was changed since its last pass: pass it again");
    return answer;
}

struct PassArguments : LivePass {
    std::string deed = "list";
};

}  // namespace

Expected<Answer> pass_on_devices(const LivePass& a, PassDeed deed) {
    const bool edits = deed != PassDeed::record;
    SEAM_TRY(auto station, open_station(a.file, edits ? std::optional(Deed::teach) : std::nullopt));
    SEAM_TRY(const Spot* found, spot_of(station.project(), a.spot, a.file));
    const Spot spot = *found;
    SEAM_OK(station.connect());
    PassOptions options;
    options.step_mm = a.step_mm;
    options.cancel = stop_on_signal();
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
    SEAM_TRY(auto pass, record_pass(station, spot, options));
    station.disconnect();
    if (!a.out.empty()) SEAM_OK(write_text_file(a.out, align_csv(pass.profiles)));
    SEAM_TRY(const auto judged, judge_pass(spot, std::move(pass), judged_by(spot, a)));
    Answer answer = told(judged);
    if (!a.out.empty()) answer.json["file"] = a.out;
    if (deed == PassDeed::accept) {
        if (judged.acceptable()) {
            SEAM_OK(accept(station, judged, answer));
            answer.json["done"] = "accepted";
        } else {
            answer.text += "not accepted\n";
            answer.exit_code = kExitVerdict;
        }
    }
    if (deed == PassDeed::adopt) {
        if (judged.result.status == AlignmentStatus::drifting) {
            SEAM_OK(adopt(station, judged, answer));
            answer.json["done"] = "adopted";
            answer.exit_code = kExitOk;
        } else {
            answer.text += "there is no drift to cure\n";
        }
    }
    return answer;
}

void add_pass(CommandLine& line) {
    auto a = std::make_shared<PassArguments>();
    CLI::App* command = line.add(
        "pass",
        "The pass through a spot from its entry to its exit, on the devices: does the contour stand still?\n"
        "record judges it and keeps nothing; accept passes, and where the contour is frozen keeps its curve "
        "and the "
        "jitter\nin the spot and the verdict as evidence; adopt passes, and where it drifts turns the spot's "
        "pose by "
        "the cure; list says\nwhat was accepted, and whether it still holds.",
        "seamwright pass door_left.seam S1 record --out pass.csv\n"
        "  seamwright pass door_left.seam S1 accept --jitter-mm 3 --tolerance-mm 0.05\n"
        "  seamwright pass door_left.seam S1 adopt\n"
        "  seamwright pass door_left.seam S1 list");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command->add_option("spot", a->spot, "The spot")->required()->type_name("SPOT");
    command->add_option("deed", a->deed, "record, accept, adopt or list")
        ->check(CLI::IsMember({"record", "accept", "adopt", "list"}))
        ->capture_default_str();
    add_sign_in(command);
    command->add_option("--out", a->out, "Where the profiles go, as `align` reads them")
        ->type_name("PASS.csv");
    command->add_option("--step-mm", a->step_mm, "Travel between two profiles")->capture_default_str();
    command->add_option("--jitter-mm", a->jitter_mm,
                        "Half width of the trigger jitter (default: the spot's)");
    command->add_option("--tolerance-mm", a->tolerance_mm, "Error that the jitter may cause (default: 0.05)");
    line.on(command, [a]() -> Expected<Answer> {
        if (a->deed == "list") return list(a->file, a->spot);
        return pass_on_devices(*a, a->deed == "accept"  ? PassDeed::accept
                                   : a->deed == "adopt" ? PassDeed::adopt
                                                        : PassDeed::record);
    });
}

}  // namespace seamwright::cli
