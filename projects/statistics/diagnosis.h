#pragma once
// Which carrier, locator or hinge has moved, and since when: the stored runs of production through core/statistics/moved.h.
//
// A car is a run of production whose regions of six free directions were solved; what several of them say of one part is
// put together by their information (covariance_random). Its place is the motion off that of the first car, work object
// axes, about the work object's origin. Regions with fewer free directions say too little of it and are left out.
//
// The carrier of a part comes from a list of parts and carriers, else from the part's name by Fixture::carrier_pattern.
// With neither there is one fixture that all parts share.

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/statistics/moved.h"
#include "projects/report/html.h"
#include "projects/statistics/production.h"

namespace seamwright {

// {"elements": [{"id": "locator 2", "at_mm": [x, y, z], "directions": [[x, y, z], ...]}, ...], "carrier_pattern"?: "..."}; instead
// of directions "direction": [x, y, z], or "pin_axis": [x, y, z] for the two across it. Directions of any length. Error (input): a
// field, ids that are none or one for two, directions that are none or not at right angles, a pattern that is none.
Expected<Fixture> fixture_from_json(const nlohmann::json& json, const std::string& where);
// The same of one that is kept; and that it holds a part in all six directions: else the Error says how it can move.
Expected<std::vector<Pattern>> patterns_of(const Fixture& fixture);

// Lines "part,carrier" of a CSV with that header. Error (input).
Expected<std::map<std::string, std::string>> read_carriers(const std::string& text, const std::string& where);

struct CarrierDiagnosisOptions {
    RunValuesWanted runs;
    std::optional<Fixture> fixture;               // instead of the project's
    std::map<std::string, std::string> carriers;  // by part
    double alarm = DiagnosisOptions{}.alarm;
};

struct NotTold {  // apart
    std::string one, other;
    double cars = 0;  // on either side of a fault of kToldMm; infinite: never
};
inline constexpr double kToldMm = 0.5;
inline constexpr double kManyCars = 30;  // more than these are said

struct DiagnosedCar {
    std::int64_t run = 0;
    std::string part, utc;
};

struct CarrierDiagnosis {
    Diagnosis numbers;
    std::vector<std::string> carriers;  // names, by index; one without name: all share a fixture
    std::vector<DiagnosedCar> cars;
    int no_carrier = 0;  // runs whose part names none
    int not_solved = 0;  // runs without a region of six free directions that was solved
    std::vector<std::string> partial_regions;
    std::optional<Fixture> fixture;
    std::vector<NotTold> not_told;
    Text verdict;                 // one sentence
    std::vector<Text> sentences;  // one a change
    bool changed() const { return !numbers.changes.empty(); }
};
// Error (usage): a project with several part types and none chosen; (input): a fixture that holds no part.
Expected<CarrierDiagnosis> diagnose_production(const Production& production,
                                               const CarrierDiagnosisOptions& options);

nlohmann::json diagnosis_json(const CarrierDiagnosis& diagnosis);
void write_diagnosis(const CarrierDiagnosis& diagnosis, Language language, report::Page& page);

}  // namespace seamwright
