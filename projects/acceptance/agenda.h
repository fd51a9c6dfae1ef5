#pragma once
// The studies of an acceptance in the order of the work: what each needs, how far it is, what came of it, and the one
// that is next. Robot, trigger and sensor stand first, because what they set is another measuring process from there
// on; they are offered, not asked for. Of the others the next is the first that is not done.

#include <array>

#include "projects/acceptance/stored_acceptance.h"
#include "projects/acceptance/study/live_study.h"

namespace seamwright {

enum class AgendaStudy { robot, trigger, sensor, type1, type3, linearity, stability, correlation, vda5 };
inline constexpr std::array<AgendaStudy, 9> kAgenda{
    AgendaStudy::robot,     AgendaStudy::trigger,     AgendaStudy::sensor,
    AgendaStudy::type1,     AgendaStudy::type3,       AgendaStudy::linearity,
    AgendaStudy::stability, AgendaStudy::correlation, AgendaStudy::vda5};
Text name_of(AgendaStudy study);
// Measured run by run (live_study.h).
std::optional<Study> live_study_of(AgendaStudy study);

struct AgendaItem {
    AgendaStudy study = AgendaStudy::type1;
    enum class State { not_begun, begun, done } state = State::not_begun;
    std::optional<StudyProgress> progress;  // of the newest plan made with the present setup
    std::optional<AcceptanceVerdict> verdict;
    Text needs;    // what it is made of
    Text finding;  // one sentence: what there is, or what is missing
    // What goes on, or begins: of the live studies.
    LiveStudyOptions proposed;
};

struct Agenda {
    std::array<AgendaItem, kAgenda.size()> items;
    AgendaItem& of(AgendaStudy study) { return items[static_cast<std::size_t>(study)]; }
    const AgendaItem& of(AgendaStudy study) const { return items[static_cast<std::size_t>(study)]; }
    std::optional<AgendaStudy> next;  // none: all that is asked for is done
};

// Error (file): the file.
Expected<Agenda> acceptance_agenda(const ProjectFile& file, const Project& project,
                                   const StoredAcceptance& stored);

}  // namespace seamwright
