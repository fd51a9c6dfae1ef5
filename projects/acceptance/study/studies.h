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
#include "core/acceptance/forecast_check.h"
#include "core/acceptance/linearity.h"
#include "core/acceptance/process_uncertainty.h"
#include "core/acceptance/stability.h"
#include "core/acceptance/type1.h"
#include "core/acceptance/type3.h"
#include "core/text.h"
#include "projects/model/project.h"

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

// What the stated covariance of the corrections (projects/proof/budget.h) predicts of the studies, at the measurand:
// of the part as taught the scatter from run to run and what is the same in all of them, and the repeatability EV of
// the parts where they lay. Of rehanging it says nothing.
struct StudyForecast {
    double type1_s_mm = 0, bias_u_mm = 0;
    double ev_mm = 0;  // 0: no parts
};

// Which kept offset acted on the runs, see projects/model/project.h.
struct OffsetOfStudy {
    std::string region_id;
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // of the measurand, work object
    std::optional<KeptOffset> acting;
};

struct StudySource {
    std::string file;  // where the values are from
    Text measurand;    // "region left, spot S3, binormal"; empty: not known
    std::string part_name, sensor, sensor_serial, robot, robot_serial;
    bool simulated = false;
    int runs = 0;  // stored runs that entered; 0: a table
    std::optional<StudyForecast> forecast;
    std::optional<OffsetOfStudy> offset;  // of stored runs
    std::vector<Text> remarks;            // what was left out and why
    std::string unmoved_part;  // the values' name of the part as taught; empty: it was not measured
    bool unmoved_part_is(const std::string& part) const {
        return !unmoved_part.empty() && part == unmoved_part;
    }
};

// Where a requirement is from, for the report.
enum class RequirementFrom { standard, project, given };

struct AcceptanceSettings {
    double tolerance_mm = 0;  // T; the limits lie T / 2 about the nominal
    double nominal_mm = 0;
    std::optional<double> reference_mm;  // of the type 1 part; none: its own
    std::string part;                    // of type 1 and stability; empty: the only one, or the one measured
                                         // kType1Values times or more
    double share = 0.2, width = 6, required = 1.33;
    std::optional<double> required_cgk;  // none: as Cg
    double grr_accepted_percent = 10, grr_refused_percent = 30;
    int ndc = 5;
    double system_percent = 15, process_percent = 30;
    // By the names of acceptance_fields() (projects/measure/fields.h); absent: the default.
    std::map<std::string, RequirementFrom> from;
    int subgroup = 5;  // consecutive runs, where a run holds one value
    double reference_u_mm = 0, resolution_mm = 0;
};

// Error (input): a tolerance, nominal or reference that is none.
Expected<void> check_settings(const AcceptanceSettings& settings);

// Requirements as settings and back. Those that are not the default are marked as the project's.
void require(AcceptanceSettings& settings, const AcceptanceRequirements& requirements);
AcceptanceRequirements requirements_of(const AcceptanceSettings& settings);
RequirementFrom from_of(const AcceptanceSettings& settings, const std::string& name);

// Cg and %GRR of the tolerance as the forecast has them.
double predicted_cg(const StudyForecast& forecast, const AcceptanceSettings& settings);
double predicted_grr_percent(const StudyForecast& forecast, const AcceptanceSettings& settings);

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
    // Against the forecast, where there is one: s and bias of type 1, EV of type 3.
    std::optional<ForecastCheck> type1_check, bias_check, type3_check;
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
