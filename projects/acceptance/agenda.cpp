#include "projects/acceptance/agenda.h"

#include <algorithm>

#include "projects/model/part_types.h"
#include "projects/proof/checklist.h"

namespace seamwright {
namespace {

using State = AgendaItem::State;

constexpr int kUsualType1 = 50, kUsualStability = 100, kUsualRehangs = 2, kUsualRepeats = 2;

// The newest plan of the study in the region that runs of the present setup go on with.
Expected<std::optional<StudyProgress>> newest_progress(const ProjectFile& file, const Project& project,
                                                       const std::vector<Evidence>& evidence, Study study,
                                                       const std::string& region_id) {
    for (auto e = evidence.rbegin(); e != evidence.rend(); ++e) {
        const auto* plan = std::get_if<StudyPlan>(&e->what);
        if (!plan || plan->study != to_string(study) || plan->region_id != region_id) continue;
        SEAM_TRY(auto then, file.load_setup(e->setup));
        const auto region = std::ranges::find(project.regions, region_id, &Region::id);
        if (region == project.regions.end() ||
            !changed_since(then, of_type(project, region->type_id)).empty())
            return std::nullopt;
        LiveStudyOptions options;
        options.study = study;
        options.region = region_id;
        options.parts = plan->parts;
        options.rehangs = plan->rehangs;
        options.runs = plan->runs;
        return study_progress(file, project, options);
    }
    return std::nullopt;
}

// `n` values of `least` that prove something.
void of_made(AgendaItem& item, AcceptanceVerdict verdict, const Text& lacks) {
    item.verdict = verdict;
    item.state = verdict == AcceptanceVerdict::too_little_data ? State::begun : State::done;
    item.finding = lacks;
}

void of_studies(AgendaItem& item, const StoredAcceptance& stored) {
    const auto made = [&](const auto& study, Study name) {
        if (study) of_made(item, study->verdict, what_lacks(*stored.studies, name));
    };
    if (!stored.studies) return;
    const Acceptance& a = *stored.studies;
    switch (item.study) {
        case AgendaStudy::type1:
            return made(a.type1, Study::type1);
        case AgendaStudy::type3:
            return made(a.type3, Study::type3);
        case AgendaStudy::linearity:
            return made(a.linearity, Study::linearity);
        case AgendaStudy::stability:
            return made(a.stability, Study::stability);
        case AgendaStudy::correlation:
            return made(a.correlation, Study::correlation);
        case AgendaStudy::vda5:
            return made(a.vda5, Study::vda5);
        default:
            return;
    }
}

void of_devices(AgendaItem& item, const StoredAcceptance& stored) {
    if (item.study == AgendaStudy::robot && stored.robot) {
        item.state = State::done;
        item.finding = Text("RP {:.4f} mm, {:.4f} to {:.4f} mm with 95 %", stored.robot->study.rp_mm,
                            stored.robot->study.rp_limits_mm.low, stored.robot->study.rp_limits_mm.high);
    }
    if (item.study == AgendaStudy::trigger && stored.trigger) {
        item.state = stored.trigger->study ? State::done : State::begun;
        item.finding = stored.trigger->study
                           ? Text("latency {:.3f} ms, jitter {:.3f} ms", stored.trigger->study->latency_ms,
                                  stored.trigger->study->jitter_ms)
                           : stored.trigger->unseen;
    }
    if (item.study == AgendaStudy::sensor && stored.sensor) of_made(item, stored.sensor->study.verdict, {});
}

Text needs_of(AgendaStudy study) {
    switch (study) {
        case AgendaStudy::robot:
            return "Returns to taught spots, by itself. It sets the robot's covariance: make it before the "
                   "studies.";
        case AgendaStudy::trigger:
            return "Passes over one spot at three speeds both ways, by itself. It sets latency and jitter: "
                   "make it "
                   "before the studies.";
        case AgendaStudy::sensor:
            return "The certificate of a sphere or plane and points on it, as a JSON file.";
        case AgendaStudy::type1:
            return "One part that nobody touches, 25 runs or more; 50 are usual.";
        case AgendaStudy::type3:
            return "Five parts or more, each put in twice and measured twice; 25 parts are usual.";
        case AgendaStudy::linearity:
            return "A known shift of five steps and 50 runs or more, made at Prove.";
        case AgendaStudy::stability:
            return "One part that nobody touches, 100 runs or more, best over a shift.";
        case AgendaStudy::correlation:
            return "The parts of type 3 measured by a CMM or tracker too, as a CSV file with part, run and "
                   "value.";
        case AgendaStudy::vda5:
            break;
    }
    return "Nothing of its own: it sums up type 1, type 3 and linearity.";
}

void propose(AgendaItem& item, const std::string& region_id) {
    const auto study = live_study_of(item.study);
    if (!study) return;
    LiveStudyOptions& o = item.proposed;
    o.study = *study;
    o.region = region_id;
    if (item.progress) {
        o.parts = item.progress->plan.parts;
        o.rehangs = item.progress->plan.rehangs;
        o.runs = item.progress->plan.runs;
    } else if (*study == Study::type3) {
        o.parts = {"A", "B", "C", "D", "E"};
        o.rehangs = kUsualRehangs;
        o.runs = kUsualRepeats;
    } else {
        o.runs = *study == Study::type1 ? kUsualType1 : kUsualStability;
    }
}

}  // namespace

Text name_of(AgendaStudy study) {
    constexpr std::array<const char*, kAgenda.size()> names{
        "Robot",     "Trigger",   "Sensor",      "Type 1, capability", "Type 3, repeat and rehang",
        "Linearity", "Stability", "Correlation", "Uncertainty, VDA 5"};
    return Text::chosen(names[static_cast<std::size_t>(study)]);
}

std::optional<Study> live_study_of(AgendaStudy study) {
    if (study == AgendaStudy::type1) return Study::type1;
    if (study == AgendaStudy::type3) return Study::type3;
    if (study == AgendaStudy::stability) return Study::stability;
    return std::nullopt;
}

Expected<Agenda> acceptance_agenda(const ProjectFile& file, const Project& project,
                                   const StoredAcceptance& stored) {
    SEAM_TRY(auto evidence, file.evidence());
    Agenda agenda;
    for (const AgendaStudy study : kAgenda) {
        AgendaItem& item = agenda.of(study);
        item.study = study;
        item.needs = needs_of(study);
        of_studies(item, stored);
        of_devices(item, stored);
        if (const auto live = live_study_of(study)) {
            SEAM_TRY(auto progress, newest_progress(file, project, evidence, *live, stored.region_id));
            item.progress = std::move(progress);
            if (item.progress && !item.progress->complete()) {
                item.state = State::begun;
                item.finding = item.progress->refused() > 0
                                   ? Text("{} of {} runs, {} refused", item.progress->made(),
                                          item.progress->wanted(), item.progress->refused())
                                   : Text("{} of {} runs", item.progress->made(), item.progress->wanted());
            }
        }
        propose(item, stored.region_id);
    }
    for (const AgendaStudy study :
         {AgendaStudy::type1, AgendaStudy::type3, AgendaStudy::linearity, AgendaStudy::stability})
        if (!agenda.next && agenda.of(study).state != State::done) agenda.next = study;
    return agenda;
}

}  // namespace seamwright
