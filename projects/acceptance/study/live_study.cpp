#include "projects/acceptance/study/live_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "projects/file/id_length.h"
#include "projects/file/project_json.h"
#include "projects/model/part_types.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/zero_shift.h"

namespace seamwright {
namespace {

bool of_parts(Study study) {
    return study == Study::type3 || study == Study::correlation;
}

std::string run_name(const StudyPlan& plan, const StudyStep& step) {
    return plan.rehangs > 1 ? fmt::format("{} (hung {})", step.part, step.rehang) : step.part;
}

Expected<void> check_number(int value, int least, int most, const char* option) {
    if (value >= least && value <= most) return {};
    return usage_error(Text("{} is none", value), option, Text("give {} to {}", least, most));
}

Expected<void> check_parts(const LiveStudyOptions& o) {
    std::set<std::string> seen;
    for (const std::string& part : o.parts) {
        if (part.empty() || is_too_long(part) || part != utf8_text(part))
            return usage_error(Text("\"{}\" names no part", utf8_text(part)), "--parts",
                               Text("give a name of at most {} signs", kLongestId));
        if (is_part_of_proof(part))
            return usage_error(Text("\"{}\" is a name of the proofs' own", part), "--parts",
                               "name the part otherwise");
        if (!seen.insert(part).second)
            return usage_error(Text("part \"{}\" is named twice", part), "--parts", "name each part once");
    }
    // A rehang's name must not be another part's.
    if (o.rehangs > 1)
        for (const std::string& part : o.parts)
            for (int rehang = 1; rehang <= o.rehangs; ++rehang)
                if (seen.contains(fmt::format("{} (hung {})", part, rehang)))
                    return usage_error(
                        Text("\"{} (hung {})\" is a part and a rehang of another", part, rehang), "--parts",
                        "name the part otherwise");
    return {};
}

// The plan that the options ask for.
Expected<StudyPlan> plan_of(const Project& project, const LiveStudyOptions& o) {
    StudyPlan plan;
    plan.study = to_string(of_parts(o.study) ? Study::type3 : o.study);
    if (o.study == Study::linearity)
        return usage_error("linearity is measured over known displacements", "--runs",
                           "make them: seamwright known-shift");
    if (o.study == Study::vda5)
        return usage_error("this study is made of others' values", "--runs",
                           "measure type1 and type3, then leave --runs out");
    SEAM_OK(check_number(o.runs, 1, kMostStudyRuns, "--runs"));
    SEAM_OK(check_number(o.rehangs, 1, kMostRehangs, "--rehangs"));
    if (of_parts(o.study)) {
        if (o.parts.size() < 2 || o.parts.size() > kMostStudyParts)
            return usage_error(Text("{} parts are named", o.parts.size()), "--parts",
                               Text("name 2 to {}, separated by commas", kMostStudyParts));
    } else if (o.parts.size() > 1 || o.rehangs > 1) {
        return usage_error("this study is of one part that is not touched", "--parts",
                           "name one with --part, or none for the part as taught");
    }
    SEAM_OK(check_parts(o));
    plan.parts = o.parts;
    plan.rehangs = o.rehangs;
    plan.runs = o.runs;
    if (project.regions.empty()) return input_error("the project has no region", project.name);
    if (o.region.empty() && project.regions.size() > 1)
        return usage_error(Text("the project has {} regions", project.regions.size()), project.name,
                           "name one with --region");
    plan.region_id = o.region.empty() ? project.regions.front().id : o.region;
    if (std::none_of(project.regions.begin(), project.regions.end(),
                     [&](const Region& r) { return r.id == plan.region_id; }))
        return usage_error(Text("there is no region \"{}\"", plan.region_id), "--region");
    return plan;
}

bool same_question(const StudyPlan& a, const StudyPlan& b) {
    return a.study == b.study && a.region_id == b.region_id && a.parts == b.parts && a.rehangs == b.rehangs &&
           a.runs == b.runs;
}

std::vector<StudyStep> steps_of(const StudyPlan& plan) {
    std::vector<StudyStep> steps;
    for (int rehang = 1; rehang <= plan.rehangs; ++rehang) {
        if (plan.parts.empty()) steps.push_back({"", rehang, plan.runs});
        for (const std::string& part : plan.parts) steps.push_back({part, rehang, plan.runs});
    }
    return steps;
}

// What became of the region in a run: true passed, false refused; nothing where it says neither.
std::optional<bool> outcome(const RunRecord& run, const std::string& region_id) {
    if (run.status != RunStatus::ok && run.status != RunStatus::refused) return std::nullopt;
    for (const RegionRecord& region : run.regions)
        if (region.region_id == region_id) return region.gate_passed;
    return std::nullopt;
}

// The runs of the plan made with `setup` are counted; those of another one are returned.
Expected<int> count_runs(const ProjectFile& file, std::int64_t setup, StudyProgress& progress) {
    SEAM_TRY(auto runs, file.runs());
    int others = 0;
    for (const RunSummary& summary : runs) {
        if (summary.number <= progress.plan.after_run) continue;
        if (summary.status != RunStatus::ok && summary.status != RunStatus::refused) continue;
        for (StudyStep& step : progress.steps) {
            const bool its = step.part.empty() ? summary.part_id.starts_with(kZeroShiftPrefix)
                                               : summary.part_id == run_name(progress.plan, step);
            if (!its) continue;
            if (summary.setup != setup) {
                ++others;
                break;
            }
            SEAM_TRY(auto run, file.load_run(summary.number, false));
            if (const auto passed = outcome(run, progress.plan.region_id))
                ++(*passed ? step.made : step.refused);
            break;
        }
    }
    return others;
}

// The newest plan of the same question, with the setup it is of.
Expected<std::optional<Evidence>> newest_plan(const ProjectFile& file, const StudyPlan& asked) {
    SEAM_TRY(auto evidence, file.evidence());
    std::optional<Evidence> newest;
    for (Evidence& e : evidence)
        if (const auto* plan = std::get_if<StudyPlan>(&e.what); plan && same_question(*plan, asked))
            newest = std::move(e);
    return newest;
}

Expected<StudyProgress> progress_of(const ProjectFile& file, const Evidence& at) {
    StudyProgress progress;
    progress.plan = std::get<StudyPlan>(at.what);
    progress.setup = at.setup;
    progress.steps = steps_of(progress.plan);
    SEAM_OK(count_runs(file, at.setup, progress));
    progress.resumed = progress.made() + progress.refused() > 0;
    return progress;
}

Text what_is_missing(const StudyProgress& progress) {
    return Text("{} of {} runs are made", progress.made(), progress.wanted());
}

// Of the parts that are measured for it: its region's.
std::string type_of(const Project& project, const StudyPlan& plan) {
    for (const Region& region : project.regions)
        if (region.id == plan.region_id) return region.type_id;
    return {};
}

// Goes on with what was begun, or begins: then the plan is in the file before the first run.
Expected<StudyProgress> begin(Station& station, const LiveStudyOptions& options) {
    SEAM_TRY(auto asked, plan_of(station.project(), options));
    const Project with = of_type(station.project(), type_of(station.project(), asked));
    SEAM_TRY(auto setup, station.file().setup_of(with));
    int other_setup = 0;
    if (!options.anew) {
        SEAM_TRY(auto newest, newest_plan(station.file(), asked));
        if (newest) {
            auto progress = progress_of(station.file(), *newest);
            if (!progress || newest->setup == setup) return progress;
            if (!progress->complete()) other_setup = progress->made();
        }
    }
    SEAM_TRY(auto runs, station.file().runs());
    if (!runs.empty()) asked.after_run = runs.back().number;
    SEAM_OK(station.file().append_evidence({0, {}, 0, asked}, with));
    StudyProgress progress;
    progress.plan = std::move(asked);
    progress.setup = setup;
    progress.steps = steps_of(progress.plan);
    progress.other_setup = other_setup;
    return progress;
}

}  // namespace

int StudyProgress::made() const {
    int n = 0;
    for (const StudyStep& step : steps) n += std::min(step.made, step.wanted);
    return n;
}
int StudyProgress::wanted() const {
    int n = 0;
    for (const StudyStep& step : steps) n += step.wanted;
    return n;
}
int StudyProgress::refused() const {
    int n = 0;
    for (const StudyStep& step : steps) n += step.refused;
    return n;
}
const StudyStep* StudyProgress::next() const {
    for (const StudyStep& step : steps)
        if (step.missing() > 0) return &step;
    return nullptr;
}

Expected<std::optional<StudyProgress>> study_progress(const ProjectFile& file, const Project& project,
                                                      const LiveStudyOptions& options) {
    SEAM_TRY(auto asked, plan_of(project, options));
    SEAM_TRY(auto newest, newest_plan(file, asked));
    if (!newest) return std::optional<StudyProgress>();
    SEAM_TRY(auto progress, progress_of(file, *newest));
    if (!progress.complete()) progress.stopped = what_is_missing(progress);
    return std::optional(std::move(progress));
}

Expected<StudyProgress> measure_study(Station& station, const LiveStudyOptions& options) {
    auto progress = begin(station, options);
    if (!progress) return progress;
    const int wanted = progress->wanted();
    int refused_in_a_row = 0;
    for (StudyStep& step : progress->steps) {
        if (step.missing() > 0 && !step.part.empty() && options.place &&
            !options.place(step.part, step.rehang)) {
            progress->stopped = Text("{}; part {} is waited for", what_is_missing(*progress), step.part);
            return progress;
        }
        while (step.missing() > 0) {
            RunOptions run_options;
            run_options.part_id = step.part.empty()
                                      ? fmt::format("{}{}", kZeroShiftPrefix, step.made + step.refused + 1)
                                      : run_name(progress->plan, step);
            run_options.part_type = type_of(station.project(), progress->plan);
            run_options.cancel = options.cancel;
            if (options.progress)
                run_options.progress = [&](const RunProgress& p) {
                    options.progress(
                        {progress->made(), wanted, Text("{}/{}: {}", progress->made() + 1, wanted, p.text)});
                };
            if (options.cancel.stop_requested()) {
                progress->stopped = Text("cancelled, {}", what_is_missing(*progress));
                return progress;
            }
            SEAM_TRY(auto run, station.run(run_options));
            const auto passed = outcome(run, progress->plan.region_id);
            if (passed) ++(*passed ? step.made : step.refused);
            if (options.measured) options.measured(run);
            if (run.status == RunStatus::cancelled) {
                progress->stopped = Text("cancelled, {}", what_is_missing(*progress));
                return progress;
            }
            if (run.status == RunStatus::device || !passed)
                return device_error(run.message, Text("run {}", run.number));
            refused_in_a_row = *passed ? 0 : refused_in_a_row + 1;
            if (refused_in_a_row >= kRefusedInARow) {
                progress->stopped = Text("the gate refused {} runs one after the other: {}; {}",
                                         refused_in_a_row, run.message, what_is_missing(*progress));
                return progress;
            }
        }
    }
    return progress;
}

std::map<std::string, RehungPart> rehung_parts(const std::vector<Evidence>& evidence) {
    std::map<std::string, RehungPart> parts;
    for (const Evidence& e : evidence)
        if (const auto* plan = std::get_if<StudyPlan>(&e.what); plan && plan->rehangs > 1)
            for (const StudyStep& step : steps_of(*plan))
                if (!step.part.empty())
                    parts[run_name(*plan, step)] = {step.part, std::to_string(step.rehang)};
    return parts;
}

}  // namespace seamwright
