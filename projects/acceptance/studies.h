#pragma once
// The acceptance of a measuring process: which values enter which study, and what came of it. The mathematics and
// its limits are core/acceptance/'s.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/acceptance/correlation.h"
#include "core/acceptance/linearity.h"
#include "core/acceptance/process_uncertainty.h"
#include "core/acceptance/stability.h"
#include "core/acceptance/type1.h"
#include "core/acceptance/type3.h"
#include "core/text.h"

namespace seamwright {

enum class Study { type1, type3, linearity, stability, correlation, vda5 };
inline constexpr Study kStudies[] = {Study::type1,     Study::type3,       Study::linearity,
                                     Study::stability, Study::correlation, Study::vda5};
std::string_view to_string(Study study);
std::optional<Study> study_from(std::string_view name);

// What the studies are made of. A table of the user's is all of them; stored runs are told apart
// (stored_values.h).
struct StudyValues {
    std::vector<StudyValue> type1, type3, linearity, stability, correlation;
    static StudyValues of(const std::vector<StudyValue>& table) {
        return {table, table, table, table, table};
    }
    // Every value once, in the order of the studies above.
    std::vector<StudyValue> all() const;
};

struct StudySource {
    std::string file;  // where the values are from
    Text measurand;    // "region left, spot S3, binormal"; empty: not known
    std::string part_name, sensor, sensor_serial, robot, robot_serial;
    bool simulated = false;
    int runs = 0;               // stored runs that entered; 0: a table
    std::vector<Text> remarks;  // what was left out and why
};

struct AcceptanceSettings {
    double tolerance_mm = 0;  // T; the limits lie T / 2 about the nominal
    double nominal_mm = 0;
    std::optional<double> reference_mm;  // of the type 1 part; none: its own
    std::string part;                    // of type 1 and stability; empty: the only one, or the one measured
                                         // kType1Values times or more
    double share = 0.2, width = 6, required = 1.33;
    int subgroup = 5;  // consecutive runs, where a run holds one value
    double reference_u_mm = 0, resolution_mm = 0;
};

struct Acceptance {
    AcceptanceSettings settings;
    StudySource source;
    StudyValues values;
    std::string type1_part;
    std::vector<StudyValue> type1_values, type3_values;  // those that entered
    bool type1_part_left_out = false;                    // of type 3: measured unlike the others
    int stability_left_out = 0;                          // values that fill no subgroup
    std::optional<Type1> type1;
    std::optional<Type3> type3;
    std::optional<Linearity> linearity;
    std::optional<Stability> stability;
    std::optional<Correlation> correlation;
    std::optional<ProcessUncertainty> vda5;
    std::map<Study, Error> not_done;  // of several studies: those that the data do not allow
    // The worst of those made: not_ok, too_little_data, conditional, ok.
    AcceptanceVerdict verdict() const;
};

// Of a study with too little data, what it has and what it needs; empty otherwise.
Text what_lacks(const Acceptance& acceptance, Study study);

// Error (input, usage): the settings are none; of one study: what that study refuses; of several: the data allow
// none of them (the first one's sentence).
Expected<Acceptance> judge_acceptance(StudyValues values, StudySource source,
                                      const AcceptanceSettings& settings, std::span<const Study> studies);

}  // namespace seamwright
