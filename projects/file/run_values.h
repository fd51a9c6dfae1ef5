#pragma once
// What many runs left behind, in numbers: read by queries from the file's rows, without loading runs, captures or
// images: ten times as fast (tests/bench/bench_statistics.cpp).

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/correction/correction.h"
#include "core/text.h"
#include "projects/model/run.h"

namespace seamwright {

struct RunValuesWanted {
    // Of runs started then or later, and before; as utc_now() writes it. Empty: all.
    std::string since_utc, until_utc;
    std::string type_id = {};  // of this part type alone; empty: all
    bool covariances = false;  // RegionValue::covariance too
    bool sigmas = false;       // RegionValue::sigma too
    std::int64_t run = 0;      // this one alone, whatever else is wanted; 0: all
};

struct RegionValue {
    std::string region_id;
    bool gate_passed = false;
    // Absent where too little was measured to solve.
    std::optional<CorrectionStatus> status;
    Pose workobject_from_movedworkobject = Pose::Identity();  // of status ok and over_limit, else identity
    std::vector<Text> refusals;                               // empty when passed
    Matrix6 covariance = Matrix6::Zero();                     // of one run's noise, where it was wanted
    std::optional<std::array<double, 6>> sigma;               // of X Y Z (mm), A B C (degree), where wanted
};
struct PlaceValue {
    std::string place_id;
    double gap_mm = 0, flush_mm = 0;
};
struct PanelValue {
    std::string job_id;
    bool gate_passed = false;
    std::vector<PlaceValue> before, after;  // measured ones
    std::vector<Text> refusals;
};
struct RunValues {
    std::int64_t number = 0;
    std::string part_id, started_utc, finished_utc;
    std::string type_id;
    bool push = false;
    RunStatus status = RunStatus::ok;
    Text message;
    std::int64_t setup = 0;
    std::vector<RegionValue> regions;
    std::optional<PanelValue> panel;
    // Spots without a measurement.
    std::vector<std::pair<std::string, SpotStatus>> not_measured;
};

}  // namespace seamwright
