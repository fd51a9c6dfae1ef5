#pragma once
// What `seamwright acceptance` does to a project beside judging: measures a study run by run, keeps requirements and
// offsets.

#include <string>
#include <vector>

#include "app/cli/command.h"
#include "projects/acceptance/study/live_study.h"

namespace seamwright::cli {

struct LiveArguments {
    std::string file, region, part;
    std::vector<std::string> parts;
    int runs = 0, rehangs = 1;
    bool anew = false, unattended = false, simulated_parts = false;
};

// The forecast goes to stderr before anything moves. Between parts the person is asked, unless unattended.
Expected<StudyProgress> measure_live(const LiveArguments& arguments, Study study,
                                     const AcceptanceSettings& settings);
// Of one that is not complete: what is to do.
Answer incomplete_answer(const StudyProgress& progress);

// The requirements as the project's own from here on.
Expected<void> keep_requirements(const std::string& file, const AcceptanceRequirements& requirements);

// Kept offsets: a new version of the correlation; a switch, or taking it back. The answer lists them.
Expected<void> keep_offset_of(const std::string& file, const Acceptance& acceptance, Answer& answer);
struct OffsetSwitch {
    bool undo = false;
    int version = 0;  // 0: none acts
};
Expected<Answer> switch_offset_command(const std::string& file, const std::string& region,
                                       const OffsetSwitch& to);

}  // namespace seamwright::cli
