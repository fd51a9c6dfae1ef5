#include "app/cli/commands/proof/acceptance_live.h"
#include "app/cli/sign_in.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "app/cli/signal_watch.h"
#include "projects/acceptance/pages/acceptance_json.h"
#include "projects/acceptance/simulated_parts.h"
#include "projects/acceptance/study/kept_offsets.h"
#include "projects/acceptance/study/stored_values.h"
#include "projects/measure/fields.h"

namespace seamwright::cli {
namespace {

// The region of that id; of none the only one.
Expected<Region*> region_in(Project& project, const std::string& file, const std::string& id) {
    if (project.regions.empty()) return input_error("the project has no region", file);
    if (id.empty() && project.regions.size() > 1)
        return usage_error(Text("the project has {} regions", project.regions.size()), file,
                           "name one with --region");
    for (Region& region : project.regions)
        if (id.empty() || region.id == id) return &region;
    return usage_error(Text("there is no region \"{}\"", id), file);
}

// What a person puts before the robot, then return; anything else lets the study wait.
bool ask_for_part(const std::string& part, int rehang, int rehangs) {
    fmt::print(stderr, "\npart {}{}\nReturn when it stands, q to go on another time: ", part,
               rehangs > 1 ? fmt::format(", put in for the {} of {} times", rehang, rehangs) : std::string());
    std::string line;
    return std::getline(std::cin, line) && line.empty();
}

void list_offsets(const Region& region, Answer& answer) {
    const KeptOffset* acting = acting_offset(region);
    nlohmann::json versions = nlohmann::json::array();
    for (const KeptOffset& kept : region.offsets) {
        versions.push_back(offset_json(kept));
        answer.text +=
            fmt::format("region {} offset {}{}: X {:.4f}  Y {:.4f}  Z {:.4f} mm  {}  {}\n", region.id,
                        kept.version, &kept == acting ? " ACTS" : "", kept.offset_mm.x(), kept.offset_mm.y(),
                        kept.offset_mm.z(), kept.utc, kept.source);
    }
    answer.json["offsets"] = {
        {"region", region.id}, {"acting", acting ? acting->version : 0}, {"versions", versions}};
}

}  // namespace

Expected<StudyProgress> measure_live(const LiveArguments& a, Study study,
                                     const AcceptanceSettings& settings) {
    LiveStudyOptions options;
    options.study = study;
    options.region = a.region;
    options.parts = a.parts;
    if (options.parts.empty() && !a.part.empty()) options.parts = {a.part};
    options.runs = a.runs;
    options.rehangs = a.rehangs;
    options.anew = a.anew;
    options.cancel = stop_on_signal();
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
    if (!a.unattended && !a.simulated_parts && !a.parts.empty())
        options.place = [&](const std::string& part, int rehang) {
            return ask_for_part(part, rehang, a.rehangs);
        };
    SEAM_TRY(auto station, open_station(a.file, Deed::teach));
    // Options that are none are refused before a device is opened, and a study that is complete needs none.
    SEAM_TRY(auto before, study_progress(station.file(), station.project(), options));
    Project project = station.project();
    SEAM_TRY(auto setup, station.file().setup_of(project));
    if (before && before->complete() && before->setup == setup && !a.anew) return std::move(*before);
    SEAM_TRY(const auto region, region_in(project, a.file, a.region));
    if (const auto forecast = forecast_studies(project, *region))
        fmt::print(stderr, "forecast: s {:.4f} mm, Cg {:.2f}, %GRR {:.1f}\n", forecast->type1_s_mm,
                   predicted_cg(*forecast, settings), predicted_grr_percent(*forecast, settings));
    SEAM_OK(station.connect());
    if (a.simulated_parts && !SimulatedParts::possible(station.project()))
        return usage_error("only a simulated cell can put in its parts", "--simulated-parts", "leave it out");
    SimulatedParts simulated(station);
    Expected<void> put;
    if (a.simulated_parts && a.parts.empty()) {
        put = simulated.put(a.part, 1);
    } else if (a.simulated_parts) {
        options.place = [&](const std::string& part, int rehang) {
            put = simulated.put(part, rehang);
            return put.has_value();
        };
    }
    if (!put) return tl::unexpected(put.error());
    auto progress = measure_study(station, options);
    if (!put) return tl::unexpected(put.error());
    if (progress && progress->other_setup > 0)
        fmt::print(stderr, "the project was changed since: {} runs of before do not count\n",
                   progress->other_setup);
    return progress;
}

Answer incomplete_answer(const StudyProgress& progress) {
    Answer answer;
    answer.json = {{"status", "incomplete"}, {"plan", study_progress_json(progress)}};
    answer.text = fmt::format("incomplete: {}; the same command goes on\n", progress.stopped.english());
    if (const StudyStep* next = progress.next(); next && !next->part.empty())
        answer.text +=
            fmt::format("next: part {}, rehang {}, {} runs\n", next->part, next->rehang, next->missing());
    answer.exit_code = kExitVerdict;
    return answer;
}

Expected<void> keep_requirements(const std::string& path, const AcceptanceRequirements& requirements) {
    SEAM_OK(validate_fields(requirements));
    SEAM_TRY(auto file, open_to_edit(path));
    SEAM_TRY(auto project, file.load());
    project.requirements.acceptance = requirements;
    return file.save(project);
}

Expected<void> keep_offset_of(const std::string& path, const Acceptance& acceptance, Answer& answer) {
    SEAM_TRY(auto file, open_to_edit(path));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto region,
             region_in(project, path,
                       acceptance.source.offset ? acceptance.source.offset->region_id : std::string()));
    SEAM_TRY(auto version, keep_offset(*region, acceptance, utc_now()));
    SEAM_OK(file.save(project));
    list_offsets(*region, answer);
    answer.json["offsets"]["kept"] = version;
    answer.text += fmt::format("kept as version {}; it does not act: --switch-offset {}\n", version, version);
    return {};
}

Expected<Answer> switch_offset_command(const std::string& path, const std::string& region_id,
                                       const OffsetSwitch& to) {
    SEAM_TRY(auto file, open_to_edit(path));
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto region, region_in(project, path, region_id));
    SEAM_OK(to.undo ? undo_offset(*region) : switch_offset(*region, to.version));
    SEAM_OK(file.save(project));
    const KeptOffset* acting = acting_offset(*region);
    // The correction is another one from here on, and the log says since when and why.
    const Text note =
        acting ? said_of(ActingOffset{acting->version, acting->offset_mm}) : Text("no kept offset acts");
    SEAM_OK(file.append_event({0, utc_now(), 0, EventKind::note, region->id, note}));
    Answer answer;
    answer.json = {{"status", "ok"}};
    answer.text = fmt::format("region {}: {}\n", region->id, note.english());
    list_offsets(*region, answer);
    return answer;
}

}  // namespace seamwright::cli
