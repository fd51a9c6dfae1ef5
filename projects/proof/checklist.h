#pragma once
// Commissioning as a checklist whose completion is derived: from the project, from who answers, and from the
// evidence in the project's file. Nothing is ticked by hand. A step that was proven with another project than
// the present one is stale, and says what was changed.

#include <array>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/text.h"
#include "projects/file/project_file.h"
#include "projects/model/evidence.h"
#include "projects/model/project.h"

namespace seamwright {

// In the order of the work.
enum class CheckStep {
    sensors,       // connected and healthy
    robots,        // connected, identity known
    calibrations,  // every sensor's in use: good or usable, of this device, fresh
    taught,        // every enabled spot has its reference, where its feature was
    frozen,        // every enabled spot's contour stands still, within the required 3 sigma
    observable,    // every region, within the required 3 sigma
    zero_shift,    // the unmoved part reads zero
    known_shift,   // displacements were recovered within the required 3 sigma, over the required range
    limits,        // no region lets through more than was proven
    headless       // a run without a screen ended ok
};
inline constexpr std::array<CheckStep, 10> kCheckSteps{
    CheckStep::sensors, CheckStep::robots,     CheckStep::calibrations, CheckStep::taught,
    CheckStep::frozen,  CheckStep::observable, CheckStep::zero_shift,   CheckStep::known_shift,
    CheckStep::limits,  CheckStep::headless};
std::string_view to_string(CheckStep step);  // "zero-shift"
Text name_of(CheckStep step);                // "Zero shift"

enum class CheckStatus {
    done,
    missing,
    stale  // was done, but what it rests on was changed since
};
std::string_view to_string(CheckStatus status);
Text name_of(CheckStatus status);

struct CheckItem {
    CheckStep step = CheckStep::sensors;
    CheckStatus status = CheckStatus::missing;
    Text why;                    // one sentence: what there is, or what is missing
    std::vector<Text> evidence;  // what it rests on, a line each
    bool done() const { return status == CheckStatus::done; }
};

// What the project alone does not tell.
struct DeviceFact {
    std::string id;
    bool answers = false;
    Text trouble;  // why it does not deliver; empty when it does
};
struct Facts {
    // Absent: nobody asked the devices; then those count that answered last (their identity is in the
    // project).
    std::optional<std::vector<DeviceFact>> sensors, robots;
    std::string now_utc;             // ISO 8601; empty = the clock's
    std::vector<Evidence> evidence;  // oldest first
    std::map<std::int64_t, std::shared_ptr<const Project>> setups;
    std::string file;  // for the command that is to be run
};

// Adds what the file holds beyond `facts`: evidence and the setups that it refers to. Evidence is never
// edited, so that a second call reads little. Facts of another file must be emptied first.
Expected<void> gather(const ProjectFile& file, Facts& facts);

// In a project with part types a step is done when it is for each of them; else the first that it is not for speaks.
std::vector<CheckItem> checklist(const Project& project, const Facts& facts);

// What is open of one spot in the steps `taught` and `frozen`; nullopt: nothing. `frozen` asks for an accepted pass of the
// spot as it stands, whose expected error and tolerance lie within Requirements::sigma3_mm.
std::optional<CheckItem> taught_open(const Project& project, const Spot& spot);
std::optional<CheckItem> frozen_open(const Project& project, const Facts& facts, const Spot& spot);
// Whether a pass judged by it says less than the project requires.
bool widened_tolerance(const Project& project, double tolerance_mm);

// The newest evidence of a kind; nullptr when there is none. A spot's pass: newest_pass (present_names.h).
template <class T>
const Evidence* newest(const Facts& facts) {
    for (auto e = facts.evidence.rbegin(); e != facts.evidence.rend(); ++e)
        if (std::holds_alternative<T>(e->what)) return &*e;
    return nullptr;
}

// What differs in what a measurement rests on: "spot S3", "sensor A", ...; empty when nothing does. Limits,
// names of frames and settings of the simulation do not count.
Text changed_since(const Project& then, const Project& now);
// The same of one spot's pass.
bool pass_changed(const Project& then, const Project& now, const std::string& spot_id);

// Whole days from one date to another; nullopt where one cannot be read.
std::optional<double> days_between(const std::string& from_utc, const std::string& to_utc);

}  // namespace seamwright
